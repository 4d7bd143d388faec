/* Files of measurements (data_file.h). Enters: a path; leaves: names and numbers. Holds: each field is a finite number
 * or empty, or the file is refused with its line. */
#include "io/data_file.h"

#include <math.h>
#include <stdlib.h>

/* *x := the number of column k in the row, NaN where the field is empty. */
static int take_number(const CsvFile *f, int k, double *x) {
  char *end;
  double value = strtod(f->field[k], &end);
  *x = *f->field[k] ? value : NAN;
  if (!*f->field[k] || (!*end && isfinite(value))) return 0;
  return lag_csv_refuse(
      f, "column %s: \"%.40s\" is not a finite number; leave the field empty where nothing was measured", f->names[k],
      f->field[k]);
}

int lag_data_read(const char *path, DataFile *d, char *why, size_t size) {
  CsvFile *f = &d->file;
  char *end;
  size_t lines = 1;
  int more;
  *d = (DataFile){0};
  if (lag_csv_open(f, path, why, size)) return -1;
  strtod(f->names[0], &end);
  if (end != f->names[0])
    return lag_csv_refuse(
        f, "the first line has numbers; write the names of the columns above them, with units: t [s],th [deg]");
  for (const char *c = f->at; *c; c++) lines += *c == '\n' || *c == '\r';
  d->x = calloc(lines * (size_t)f->ncols, sizeof *d->x);
  d->line = calloc(lines, sizeof *d->line);
  if (!d->x || !d->line) return lag_csv_refuse(f, "out of memory");
  while ((more = lag_csv_row(f)) > 0) {
    for (int k = 0; k < f->ncols; k++)
      if (take_number(f, k, &d->x[d->nrows * (size_t)f->ncols + (size_t)k])) return -1;
    d->line[d->nrows++] = f->line;
  }
  return more || d->nrows ? more : lag_csv_refuse(f, "there are no rows below the names");
}

void lag_data_free(DataFile *d) {
  lag_csv_close(&d->file);
  free(d->x);
  free(d->line);
  *d = (DataFile){0};
}
