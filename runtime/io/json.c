/* JSON writer (RFC 8259). Enters: names and values in order; leaves: their text, with hidden characters escaped. */
#include <math.h>

#include "io/io.h"
#include "io/visible.h"

void lag_json_quote(FILE *f, const char *s) {
  putc('"', f);
  for (size_t n = strlen(s), at = 0; at < n;) {
    unsigned long code;
    size_t len = utf8_at(s + at, n - at, &code);
    if (code == '"' || code == '\\') {
      fprintf(f, "\\%c", (int)code);
    } else if (is_hidden(code) || code == '<') { /* in a page no character of a string begins a tag */
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

void lag_json_name(Json *j, const char *name) {
  if (j->comma) fputs(", ", j->f);
  if (name) {
    lag_json_quote(j->f, name);
    fputs(": ", j->f);
  }
  j->comma = 1;
}

void lag_json_begin(Json *j, const char *name, char bracket) {
  lag_json_name(j, name);
  putc(bracket, j->f);
  j->comma = 0;
}

void lag_json_end(Json *j, char bracket) {
  putc(bracket, j->f);
  j->comma = 1;
}

void lag_json_string(Json *j, const char *name, const char *s) {
  lag_json_name(j, name);
  if (s) lag_json_quote(j->f, s);
  else fputs("null", j->f);
}

void lag_json_number(Json *j, const char *name, double x) {
  lag_json_name(j, name);
  fputs(isfinite(x) ? lag_number_text(x, (char[64]){0}) : "null", j->f);
}

void lag_json_count(Json *j, const char *name, long long n) {
  lag_json_name(j, name);
  fprintf(j->f, "%lld", n);
}

void lag_json_truth(Json *j, const char *name, int yes) {
  lag_json_name(j, name);
  fputs(yes < 0 ? "null" : yes ? "true" : "false", j->f);
}

void lag_json_row(Json *j, const char *name, int n, const double *x) {
  JSON_EACH(j, name, '[', i, n) lag_json_number(j, NULL, x[i]);
}

void lag_json_matrix(Json *j, const char *name, int rows, int columns, const double *x) {
  JSON_EACH(j, name, '[', i, rows) lag_json_row(j, NULL, columns, x + i * columns);
}

Json lag_json_open(FILE *f) {
  Json j = {.f = f};
  lag_json_begin(&j, NULL, '{');
  return j;
}

void lag_json_close(Json *j) {
  lag_json_end(j, '}');
  putc('\n', j->f);
}

void lag_json_number_list(Json *j, const JsonNumber *of) {
  for (; of->name; of++) lag_json_number(j, of->name, of->x);
}

void lag_json_count_list(Json *j, const JsonCount *of) {
  for (; of->name; of++) lag_json_count(j, of->name, of->n);
}

void lag_json_string_list(Json *j, const JsonString *of) {
  for (; of->name; of++) lag_json_string(j, of->name, of->s);
}
