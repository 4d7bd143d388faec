/* JSON text (RFC 8259). Enters: a value; leaves: its text. */
#include <math.h>

#include "io/io.h"

void json_string(FILE *f, const char *s)
{
  if (!s) {
    fputs("null", f);
    return;
  }
  putc('"', f);
  for (; *s; s++) {
    unsigned char c = (unsigned char)*s;
    if (c == '"' || c == '\\') {
      fprintf(f, "\\%c", c);
    } else if (c < 0x20 || c == 0x7f) {
      fprintf(f, "\\u%04x", c);
    } else {
      putc(c, f);
    }
  }
  putc('"', f);
}

void json_number(FILE *f, double x)
{
  if (isfinite(x)) {
    fprintf(f, "%.17g", x);
  } else {
    fputs("null", f);
  }
}
