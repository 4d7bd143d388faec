/* --branches FILE.csv of a sweep: rows of `lagc continue -o`, drawn over the points of its --section. They hold the
 * state where the period begins, so it should begin in the section. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/sweep.h"
#include "io/csv_file.h"

enum { X, Y, BRANCH, GROWING, KEPT };

static int column_of(const CsvFile *f, const char *label) {
  for (int i = 0; i < f->ncols; i++)
    if (strcmp(f->names[i], label) == 0) return i;
  return lag_csv_refuse(f, "there is no column `%s`: the file is none of this NAME and output by `lagc continue -o`",
                        label);
}

int lag_sweep_branches_read(SweepApp *s, const Column *y) {
  const Args *a = &s->app->args;
  CsvFile f;
  char why[2000], xlabel[sizeof(Column) + 4], ylabel[sizeof(Column) + 4];
  double row[KEPT];
  int at[KEPT], more = 0;
  lag_column_label(&s->table.cols[0], xlabel, sizeof xlabel);
  lag_column_label(y, ylabel, sizeof ylabel);
  const char *const labels[] = {xlabel, ylabel, "branch", "growing"};
  s->branches = (Table){.ncols = KEPT, .keep = 1, .cols = calloc(KEPT, sizeof *s->branches.cols)};
  if (!s->branches.cols) return lag_app_error(a, "out of memory");
  int rc = lag_csv_open(&f, a->continued, why, sizeof why);
  for (int k = 0; k < KEPT && rc == 0; k++) rc = (at[k] = column_of(&f, labels[k])) < 0 ? -1 : 0;
  while (rc == 0 && (more = lag_csv_row(&f)) == 1) {
    for (int k = 0; k < KEPT && rc == 0; k++) rc = lag_csv_number(&f, at[k], f.names[at[k]], &row[k]);
    if (rc == 0 && lag_table_add(&s->branches, row)) rc = lag_csv_refuse(&f, "out of memory");
  }
  lag_csv_close(&f);
  return rc || more < 0 ? lag_app_error(a, "--branches %s", why) : 0;
}

int lag_sweep_branches_draw(const SweepApp *s, Table *t, int first, double period, int logarithmic) {
  const Table *of = &s->branches;
  double row[16], last[KEPT] = {NAN, NAN, NAN, NAN}, low = HUGE_VAL, high = -HUGE_VAL;
  lag_table_range(t, 0, &low, &high);
  for (size_t r = 0; r < of->nrows; r++) {
    double now[KEPT];
    for (int k = 0; k < KEPT; k++) now[k] = lag_table_cell(of, r, k);
    if (logarithmic) now[X] = log10(now[X]);
    if (period > 0) now[Y] = remainder(now[Y], period);
    if (!(now[X] >= low && now[X] <= high)) now[Y] = NAN;
    int joins = now[BRANCH] == last[BRANCH] && !(period > 0 && fabs(now[Y] - last[Y]) > period / 2);
    for (int gap = 1; gap >= 0; gap--) { /* a row without values parts two lines */
      if (gap && joins) continue;
      for (int k = 0; k < t->ncols; k++) row[k] = NAN;
      row[0] = isnan(now[Y]) ? low : now[X];
      for (int unstable = 0; unstable < 2 && !gap; unstable++) /* both where one kind becomes the other */
        if ((now[GROWING] > 0) == unstable || (joins && (last[GROWING] > 0) == unstable))
          row[first + unstable] = now[Y];
      if (lag_table_add(t, row)) return -1;
    }
    memcpy(last, now, sizeof last);
  }
  return 0;
}
