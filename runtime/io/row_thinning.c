/* Thinning of rows for pictures by the "swinging door" (E. H. Bristol, Swinging door trending, ISA Transactions 1990). Enters: rows in order
 * of time; leaves: a subset of rows such that the lines between them miss no row by more than a given part of the drawn range. Holds: both
 * sides of a jump are kept, and the first and the last row. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/io.h"

/* Changes below this part of the values count as rounding, not as motion. */
static const double ROUNDING = 1e-11;

int lag_thin_init(RowThinning *w, Table *t, int store, double part, double longest) {
  size_t n = (size_t)t->ncols;
  *w = (RowThinning){.table = t, .store = store, .part = part, .longest = longest, .memory = calloc(7 * n, sizeof(double))};
  if (!w->memory) return -1;
  double **const at[] = {&w->low, &w->high, &w->least, &w->most, &w->from, &w->last, &w->width};
  for (size_t i = 0; i < sizeof at / sizeof *at; i++) *at[i] = w->memory + i * n;
  for (size_t i = 0; i < n; i++) {
    w->least[i] = HUGE_VAL;
    w->most[i] = -HUGE_VAL;
  }
  w->drawn = calloc(n, sizeof *w->drawn);
  return w->drawn ? 0 : -1;
}

void lag_thin_free(RowThinning *w) {
  free(w->memory);
  free(w->drawn);
  *w = (RowThinning){0};
}

void lag_thin_add_column(RowThinning *w, int col) {
  for (int i = 0; i < w->ndrawn; i++)
    if (w->drawn[i] == col) return;
  if (col > 0) w->drawn[w->ndrawn++] = col;
}

void lag_thin_extend_range(RowThinning *w, const double *row) {
  double widest = 0;
  for (int i = 0; i < w->ndrawn; i++) {
    int c = w->drawn[i];
    if (isfinite(row[c])) {
      w->least[c] = fmin(w->least[c], row[c]);
      w->most[c] = fmax(w->most[c], row[c]);
    }
    widest = fmax(widest, w->most[c] - w->least[c]);
  }
  for (int i = 0; i < w->ndrawn; i++) {
    int c = w->drawn[i];
    double range = w->common ? widest : fmax(0, w->most[c] - w->least[c]);
    w->width[c] = fmax(w->part * range, ROUNDING * fmax(fabs(w->least[c]), fabs(w->most[c])));
  }
}

int lag_thin_is_straight(const RowThinning *w, const double *a, const double *b, const double *between) {
  double f = (between[0] - a[0]) / (b[0] - a[0]);
  for (int i = 0; i < w->ndrawn; i++) {
    int c = w->drawn[i];
    if (fabs(between[c] - (a[c] + f * (b[c] - a[c]))) > w->width[c]) { /* a NaN compares false: a row without values is never off the line */
      return 0;
    }
  }
  return 1;
}

/* Keeps a row: the door opens anew from here. -1: no memory. */
static int keep(RowThinning *w, const double *row) {
  size_t bytes = (size_t)w->table->ncols * sizeof(double);
  memcpy(w->from, row, bytes);
  w->have_last = 0;
  w->kept++;
  return w->store ? lag_table_add(w->table, row) : 0;
}

/* Returns 1 if no line from the last kept row passes near all rows since, this one included. Else returns 0 and narrows the door, the slopes
 * low to high of such lines. */
static int door_closes(RowThinning *w, const double *row) {
  double dt = fabs(row[0] - w->from[0]);
  int shut = w->have_last && dt > w->longest;
  for (int i = 0; i < w->ndrawn && !shut; i++) {
    int c = w->drawn[i];
    double rise = row[c] - w->from[c];
    if (isfinite(row[c]) != isfinite(w->from[c]) || (w->have_last && isfinite(row[c]) != isfinite(w->last[c]))) shut = 1;
    else if (isfinite(rise) && w->have_last) shut = rise < w->low[c] * dt || rise > w->high[c] * dt;
  }
  for (int i = 0; i < w->ndrawn && !shut; i++) {
    int c = w->drawn[i];
    double rise = row[c] - w->from[c], low = (rise - w->width[c]) / dt, high = (rise + w->width[c]) / dt;
    w->low[c] = w->have_last ? fmax(w->low[c], low) : low;
    w->high[c] = w->have_last ? fmin(w->high[c], high) : high;
  }
  return shut;
}

int lag_thin_add(RowThinning *w, const double *row) {
  size_t bytes = (size_t)w->table->ncols * sizeof(double);
  const double *before = w->have_last ? w->last : w->from;
  if (w->kept == 0) return keep(w, row);
  if (memcmp(before, row, bytes) == 0) return 0;
  if (row[0] == before[0]) { /* a jump: two rows at one time */
    int rc = lag_thin_flush(w);
    return rc ? rc : keep(w, row);
  }
  if (door_closes(w, row)) {
    int rc = lag_thin_flush(w);
    if (rc) return rc;
    if (door_closes(w, row)) { /* a change between finite and not finite */
      return keep(w, row);
    }
  }
  memcpy(w->last, row, bytes);
  w->have_last = 1;
  return 0;
}

int lag_thin_flush(RowThinning *w) { return w->have_last ? keep(w, w->last) : 0; }

int lag_thin_reduce(RowThinning *w, size_t most) {
  Table *t = w->table;
  double *row = malloc((size_t)t->ncols * sizeof *row);
  if (!row || lag_thin_flush(w)) {
    free(row);
    return -1;
  }
  while (w->store && t->nrows > most && w->part < 0.5) {
    size_t n = t->nrows;
    w->part *= 2;
    t->nrows = w->kept = 0;
    for (size_t i = 0; i < n; i++) { /* kept rows overwrite rows already read */
      memcpy(row, t->data + i * (size_t)t->ncols, (size_t)t->ncols * sizeof *row);
      lag_thin_extend_range(w, row);
      lag_thin_add(w, row);
    }
    lag_thin_flush(w);
    w->longest *= 2;
  }
  free(row);
  return 0;
}
