/* JSON writer (RFC 8259). Enters: a string or a number; leaves: its text, with hidden characters escaped. */
#include <math.h>

#include "io/io.h"
#include "io/visible.h"

void lag_json_string(FILE *f, const char *s)
{
  if (!s) {
    fputs("null", f);
    return;
  }
  putc('"', f);
  for (size_t n = strlen(s), at = 0; at < n;) {
    unsigned long code;
    size_t len = utf8_at(s + at, n - at, &code);
    if (code == '"' || code == '\\') {
      fprintf(f, "\\%c", (int)code);
    } else if (is_hidden(code)) {
      fprintf(f, "\\u%04lx", code);
    } else if (len == 1 && code >= 0x80) { /* a byte that is not UTF-8: U+FFFD, since JSON must be UTF-8 */
      fputs("\\ufffd", f);
    } else {
      fwrite(s + at, 1, len, f);
    }
    at += len;
  }
  putc('"', f);
}

void lag_json_number(FILE *f, double x)
{
  if (isfinite(x)) {
    fputs(lag_number_text(x, (char[64]){0}), f);
  } else {
    fputs("null", f);
  }
}
