/* Rows of a run: their times, their values, the first that has none. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"

double lag_app_row_at(const App *app, const double *grid, double t) {
  double dir = app->until < app->scene->t0 ? -1 : 1, at = dir * (t - grid[0]) / grid[1], whole = nearbyint(at);
  return fabs(at - whole) * grid[1] <= 4 * DBL_EPSILON * (fabs(grid[0]) + fabs(t)) ? whole : at;
}

/* Time of the next row k: k/(1/every) where 1/every is whole, so that times are 0.3, not 0.1*3. */
double lag_app_row_time(const App *app, const double *grid) {
  double dir = app->until < app->scene->t0 ? -1 : 1, whole = 1 / grid[1], n = nearbyint(whole);
  if (n >= 1 && fabs(whole - n) <= 4e-16 * n) return grid[0] + dir * (grid[2] / n);
  return grid[0] + dir * (grid[2] * grid[1]);
}

/* Counts a row, and records its first output that is not finite. */
static void note_empty(App *app, double t) {
  int i = 1, n = lag_sim_noutputs(app->sim);
  while (i <= n && isfinite(app->row[i])) i++;
  app->rows_put++;
  if (i <= n && app->empty_rows++ == 0) {
    const size_t size = (size_t)(2 * app->scene->model->nq + app->scene->model->nz) * sizeof(double);
    app->empty_column = i;
    app->empty_t = t;
    if ((app->empty_state = malloc(size + 1)) != NULL) memcpy(app->empty_state, lag_sim_q(app->sim), size);
  }
}

int lag_app_write_row(App *app, int drawn) {
  if (app->rows.open && lag_rows_write(&app->rows, app->row)) return lag_app_bad_file(app, app->args.out);
  if (drawn && app->args.energy_error) lag_energy_kept(app);
  return drawn && lag_table_add(&app->table, app->row) ? LAG_ENOMEM : LAG_OK;
}

int lag_app_put_row(App *app) {
  double t = lag_sim_time(app->sim);
  app->row[0] = app->last_row = t;
  int rc = lag_sim_outputs(app->sim, app->row + 1);
  rc = rc ? rc : lag_marks_note(app);
  rc = rc ? rc : lag_tangent_columns_row(app);
  rc = rc ? rc : lag_sensitivity_row(app);
  if (rc) return rc;
  note_empty(app, t);
  /* otherwise picture_sampling.c chooses the rows of pictures */
  return lag_app_write_row(app, app->args.every || !app->sampling.on);
}

int lag_app_write_table(const App *app, const char *path, const Table *t) {
  Rows rows;
  if (lag_rows_open(&rows, path, t)) return lag_app_io_error(app, path);
  int bad = 0;
  for (size_t k = 0; k < t->nrows && !bad; k++) bad = lag_rows_write(&rows, t->data + k * (size_t)t->ncols);
  return lag_rows_close(&rows, !bad) || bad ? lag_app_io_error(app, path) : 0;
}
