/* --tangent: derivative of the state by the state at the start. Enters: a run with a tangent; leaves: additional
 * columns dx/dy(0), row-major, in declared units, and the matrix at the end for the report. */
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"

/* Most components of the state for the matrix in the report, and for columns. */
enum { SHOWN = 8, MOST_COMPONENTS = 64 };

static int components(const App *app) { return app->sim->pb.n; }

void lag_unit_in_fraction(char *s, size_t n, const char *unit) {
  int several = strpbrk(unit, "/*") != NULL;
  snprintf(s, n, "%s%s%s", several ? "(" : "", unit[0] ? unit : "1", several ? ")" : "");
}

/* Name and unit of dx/dy(0) for components i and j. */
static Column describe(const App *app, int i, int j) {
  Column x = lag_state_column(app->sim, i), y = lag_state_column(app->sim, j), c = {0};
  char over[72], under[72];
  lag_unit_in_fraction(over, sizeof over, x.unit);
  lag_unit_in_fraction(under, sizeof under, y.unit);
  snprintf(c.name, sizeof c.name, "d%.40s/d%.40s(0)", x.name, y.name);
  if (strcmp(x.unit, y.unit) != 0) snprintf(c.unit, sizeof c.unit, "%.30s/%.30s", over, under);
  return c;
}

Column *lag_app_add_columns(App *app, int n) {
  Table *t = &app->table;
  size_t all = (size_t)(t->ncols + n);
  Column *cols = realloc(t->cols, all * sizeof *cols);
  double *row = realloc(app->row, all * sizeof *row);
  t->cols = cols ? cols : t->cols;
  app->row = row ? row : app->row;
  if (!cols || !row) return NULL;
  t->ncols += n;
  return t->cols + t->ncols - n;
}

int lag_tangent_columns_open(App *app) {
  const Args *a = &app->args;
  int n = components(app);
  if (!a->tangent) return 0;
  if (lag_sim_set_tangent(app->sim, n, NULL)) return lag_app_error(a, "%s", lag_sim_message(app->sim));
  if (n > MOST_COMPONENTS) {
    return lag_app_error(a,
                         "--tangent: %d coordinates, velocities and states would make %d columns; %d are allowed. "
                         "lag_sim_set_tangent of "
                         "liblag takes as many as you give it",
                         n, n * n, MOST_COMPONENTS);
  }
  Column *cols = lag_app_add_columns(app, n * n);
  if (!cols) return lag_app_error(a, "out of memory");
  for (int k = 0; k < n * n; k++) cols[k] = describe(app, k / n, k % n);
  return 0;
}

int lag_tangent_columns_row(App *app) {
  int n = components(app);
  double *J = app->row + app->table.ncols - n * n;
  if (!app->args.tangent) return LAG_OK;
  int rc = lag_sim_tangent(app->sim, J);
  for (int i = 0; i < n && rc == 0; i++)
    for (int j = 0; j < n; j++)
      J[i * n + j] *=
          lag_sim_state_info(app->sim, j, NULL, 0, NULL, 0) / lag_sim_state_info(app->sim, i, NULL, 0, NULL, 0);
  return rc;
}

/* ---- The report */

/* dx/dy(0) at the end of the run; NULL: it is not asked for, or not known. */
static const double *final_tangent(App *app) {
  int n = components(app);
  return !app->args.tangent || app->status < 0 || lag_tangent_columns_row(app) ? NULL
                                                                               : app->row + app->table.ncols - n * n;
}

static long long slides_begun(const App *app) {
  long long all = 0;
  for (int k = 0; k < app->scene->model->nmodes; k++) {
    long long some = 0;
    lag_sim_switch_times(app->sim, k, NULL, &some);
    all += some;
  }
  return all;
}

void lag_report_tangent(App *app, FILE *f) {
  int n = components(app);
  const double *J = final_tangent(app);
  if (J && n > SHOWN) fprintf(f, "tangent: %d by %d, in the rows of -o and in --json\n", n, n);
  if (!J || n > SHOWN) return;
  fprintf(f, "tangent: derivative of the state by the state at the start\n  %-14s", "");
  for (int j = 0; j < n; j++) fprintf(f, " %14.10s(0)", lag_state_column(app->sim, j).name);
  for (int i = 0; i < n; i++) {
    fprintf(f, "\n  %-14s", lag_state_column(app->sim, i).name);
    for (int j = 0; j < n; j++) fprintf(f, " %17.10g", J[i * n + j]);
  }
  putc('\n', f);
  long long slides = slides_begun(app);
  if (slides)
    fprintf(f, "rank of the tangent falls by 1 where a slide begins: %lld time%s\n", slides, slides == 1 ? "" : "s");
}

void lag_report_tangent_json(App *app, Json *out) {
  int n = components(app);
  const double *J = final_tangent(app);
  if (!J) return;
  JSON_EACH(out, "tangent", '{', i, n) {
    JSON_EACH(out, lag_state_column(app->sim, i).name, '{', j, n)
      lag_json_number(out, lag_state_column(app->sim, j).name, J[i * n + j]);
  }
}
