/* Curves of differences, on a logarithmic axis: of the energy, less the work of forces, from its first value
 * (--energy-error). (multi_run_plot.c: the distance of runs, --distance.) */
#include <math.h>
#include <string.h>

#include "app/app.h"

int lag_app_equal_times(const Args *a) { return (a->distance || a->energy_error) && !a->every; }

void lag_energy_kept(App *app) {
  lag_charge_stats energy;
  lag_sim_charge(app->sim, 0, &energy);
  for (int i = 0; i < app->drawn.n; i++) {
    int col = app->drawn.y[i];
    app->row[col] -= (energy.at_events + energy.work) / lag_sim_output_info(app->sim, col - 1, NULL, 0, NULL, 0);
  }
}

/* The first value of a column that has one. */
static double first_value(const Table *t, int col) {
  double first = NAN;
  for (size_t i = 0; i < t->nrows && isnan(first); i++) first = lag_table_cell(t, i, col);
  return first;
}

/* Column col := log10 |value - first|/size; NaN where they are equal. */
static void replace_energy(Table *t, int col, double first, double size) {
  for (size_t i = 0; i < t->nrows; i++) {
    double *value = &t->data[i * (size_t)t->ncols + (size_t)col], off = fabs(*value - first) / size;
    *value = off > 0 ? log10(off) : NAN;
  }
}

void lag_energy_errors(App *app, lag_sim *sim) {
  Table *t = &app->table;
  PlottedCurves *d = &app->drawn;
  lag_charge_stats energy;
  int relative = 1;
  lag_sim_charge(sim, 0, &energy);
  for (int i = 0; i < d->n; i++) relative &= first_value(t, d->y[i]) != 0;
  if ((energy.flags & (LAG_CONSERVED | LAG_BALANCED)) == LAG_BALANCED)
    d->yname = relative ? "|(E - work)/E(0) - 1|" : "|E - work - E(0)|";
  else d->yname = relative ? "|E/E(0) - 1|" : "|E - E(0)|";
  for (int i = 0; i < d->n; i++) {
    double first = first_value(t, d->y[i]);
    replace_energy(t, d->y[i], first, relative ? fabs(first) : 1);
    if (relative) strcpy(t->cols[d->y[i]].unit, "");
    if (d->runs < 2) strcpy(t->cols[d->y[i]].name, d->yname);
  }
  d->ylog = 1;
}
