/* Files of measurements (data_file.h). Enters: a path; leaves: names and numbers. Holds: each field is a finite number
 * or empty, or the file is refused with its line. */
#include "io/data_file.h"

#include <errno.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/posix.h"

enum { MOST_BYTES = 256000000 };

/* A file as it is read. */
typedef struct Reader {
  DataFile *d;
  const char *path;
  long long line; /* its number; 0: the file as a whole */
  char *why;
  size_t size;
} Reader;

static int refuse(const Reader *r, const char *format, ...) {
  va_list args;
  int n =
      r->line ? snprintf(r->why, r->size, "%s:%lld: ", r->path, r->line) : snprintf(r->why, r->size, "%s ", r->path);
  va_start(args, format);
  if (n >= 0 && (size_t)n < r->size) vsnprintf(r->why + n, r->size - (size_t)n, format, args);
  va_end(args);
  return -1;
}

static int read_text(const Reader *r) {
  FILE *f = lag_open_to_read(r->path);
  DataFile *d = r->d;
  size_t n = 0, room = 0, got = 1;
  if (!f) return refuse(r, "cannot be read: %s", lag_read_error());
  while (got && n <= MOST_BYTES) {
    if (n + 1 >= room) {
      char *more = realloc(d->text, room = 2 * room + 65536);
      if (!more) break;
      d->text = more;
    }
    got = fread(d->text + n, 1, room - n - 1, f);
    n += got;
  }
  int failed = ferror(f) || got || !d->text;
  fclose(f);
  if (failed) return refuse(r, "cannot be read, or has more than 256 MB");
  d->text[n] = '\0';
  return strlen(d->text) == n ? 0 : refuse(r, "is no text: it has a byte 0; save it as CSV");
}

/* Ends the line at its end; returns the next line, or NULL. */
static char *end_line(char *line) {
  char *end = line + strcspn(line, "\r\n"), *next = *end ? end + 1 + (end[0] == '\r' && end[1] == '\n') : NULL;
  *end = '\0';
  return next;
}

/* Takes a field, in quotes or not, without the spaces around it; *at := the next one, NULL: none. */
static char *take_field(char **at) {
  char *s = *at + strspn(*at, " \t"), *from = s, *end;
  if (*s == '"') {
    from = ++s;
    s += strcspn(s, "\"");
    end = s;
    s += *s == '"';
    s += strcspn(s, ",");
  } else {
    s += strcspn(s, ",");
    end = s;
    while (end > from && (end[-1] == ' ' || end[-1] == '\t')) end--;
  }
  *at = *s ? s + 1 : NULL;
  *end = '\0';
  return from;
}

static int is_blank(const char *line) { return !line[strspn(line, " \t")]; }

static int take_names(const Reader *r, char *line) {
  DataFile *d = r->d;
  int n = 1;
  char *end;
  for (const char *c = line; *c; c++) n += *c == ',';
  if (!(d->names = calloc((size_t)n, sizeof *d->names))) return refuse(r, "out of memory");
  for (char *at = line; at; d->ncols++) d->names[d->ncols] = take_field(&at);
  strtod(d->names[0], &end);
  return end == d->names[0]
             ? 0
             : refuse(
                   r,
                   "the first line has numbers; write the names of the columns above them, with units: t [s],th [deg]");
}

/* *x := the number of a field, NaN where it is empty. */
static int take_number(const Reader *r, int col, const char *field, double *x) {
  char *end;
  double value = strtod(field, &end);
  *x = *field ? value : NAN;
  if (!*field || (!*end && isfinite(value))) return 0;
  return refuse(r, "column %s: \"%.40s\" is not a finite number; leave the field empty where nothing was measured",
                r->d->names[col], field);
}

static int take_row(const Reader *r, char *text) {
  DataFile *d = r->d;
  double *row = d->x + d->nrows * (size_t)d->ncols;
  int n = 0;
  for (char *at = text; at; n++) {
    char *field = take_field(&at);
    if (n < d->ncols && take_number(r, n, field, &row[n])) return -1;
  }
  if (n != d->ncols) return refuse(r, "%d fields, and the first line has %d names", n, d->ncols);
  d->line[d->nrows++] = r->line;
  return 0;
}

int lag_data_read(const char *path, DataFile *d, char *why, size_t size) {
  Reader r = {d, path, 0, why, size};
  *d = (DataFile){0};
  if (read_text(&r)) return -1;
  size_t lines = 1;
  for (const char *c = d->text; *c; c++) lines += *c == '\n' || *c == '\r';
  char *line = d->text + (strncmp(d->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0), *next = end_line(line);
  r.line = 1;
  if (take_names(&r, line)) return -1;
  d->x = calloc(lines * (size_t)d->ncols, sizeof *d->x);
  d->line = calloc(lines, sizeof *d->line);
  if (!d->x || !d->line) return refuse(&r, "out of memory");
  while ((line = next) != NULL) {
    next = end_line(line);
    r.line++;
    if (!is_blank(line) && take_row(&r, line)) return -1;
  }
  r.line = 0;
  return d->nrows ? 0 : refuse(&r, "has no rows below its names");
}

void lag_data_free(DataFile *d) {
  free(d->names);
  free(d->x);
  free(d->line);
  free(d->text);
  *d = (DataFile){0};
}
