/* Files of measurements (data_file.h). Enters: a path; leaves: names and numbers. Holds: each field is a finite number
 * or empty, or the file is refused with its line. */
#include "io/data_file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/posix.h"

enum { MOST_BYTES = 256000000 };

static int read_text(const char *path, DataFile *d, char *why, size_t size) {
  FILE *f = lag_open_to_read(path);
  size_t n = 0, room = 0, got = 1;
  if (!f) return snprintf(why, size, "%s cannot be read: %s", path, lag_read_error()), -1;
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
  if (failed) return snprintf(why, size, "%s cannot be read, or has more than 256 MB", path), -1;
  d->text[n] = '\0';
  return strlen(d->text) == n ? 0 : (snprintf(why, size, "%s is no text: it has a byte 0; save it as CSV", path), -1);
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

static int take_names(DataFile *d, const char *path, char *line, char *why, size_t size) {
  int n = 1;
  for (const char *c = line; *c; c++) n += *c == ',';
  d->names = calloc((size_t)n, sizeof *d->names);
  for (char *at = line; at && d->names; d->ncols++) d->names[d->ncols] = take_field(&at);
  char *end;
  if (d->names && (strtod(d->names[0], &end), end != d->names[0]))
    return snprintf(why, size,
                    "%s:1: the first line has numbers; write the names of the columns above them, with units: t [s],th "
                    "[deg]",
                    path),
           -1;
  return d->names ? 0 : (snprintf(why, size, "out of memory"), -1);
}

/* *x := the number of a field, NaN where it is empty. */
static int take_number(const DataFile *d, const char *path, long long line, int col, const char *field, double *x,
                       char *why, size_t size) {
  char *end;
  *x = NAN;
  if (!*field) return 0;
  double value = strtod(field, &end);
  if (*end || !isfinite(value))
    return snprintf(why, size,
                    "%s:%lld: column %s: \"%.40s\" is not a finite number; leave the field empty where "
                    "nothing was measured",
                    path, line, d->names[col], field),
           -1;
  *x = value;
  return 0;
}

static int take_row(DataFile *d, const char *path, long long line, char *text, char *why, size_t size) {
  double *row = d->x + d->nrows * (size_t)d->ncols;
  int n = 0;
  for (char *at = text; at; n++) {
    char *field = take_field(&at);
    if (n < d->ncols && take_number(d, path, line, n, field, &row[n], why, size)) return -1;
  }
  if (n != d->ncols)
    return snprintf(why, size, "%s:%lld: %d fields, and the first line has %d names", path, line, n, d->ncols), -1;
  d->line[d->nrows++] = line;
  return 0;
}

int lag_data_read(const char *path, DataFile *d, char *why, size_t size) {
  *d = (DataFile){0};
  if (read_text(path, d, why, size)) return -1;
  size_t lines = 1;
  for (const char *c = d->text; *c; c++) lines += *c == '\n' || *c == '\r';
  char *line = d->text + (strncmp(d->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0), *next = end_line(line);
  if (take_names(d, path, line, why, size)) return -1;
  d->x = calloc(lines * (size_t)d->ncols, sizeof *d->x);
  d->line = calloc(lines, sizeof *d->line);
  if (!d->x || !d->line) return snprintf(why, size, "out of memory"), -1;
  for (long long number = 2; (line = next) != NULL; number++) {
    next = end_line(line);
    if (!is_blank(line) && take_row(d, path, number, line, why, size)) return -1;
  }
  return d->nrows ? 0 : (snprintf(why, size, "%s has no rows below its names", path), -1);
}

void lag_data_free(DataFile *d) {
  free(d->names);
  free(d->x);
  free(d->line);
  free(d->text);
  *d = (DataFile){0};
}
