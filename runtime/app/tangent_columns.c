/* --tangent: derivative of the state by the state at the start. Enters: a run with a tangent; leaves: additional columns
 * dx/dy(0), row-major, in declared units, and the matrix at the end for the report. */
#include <stdlib.h>
#include <string.h>

#include "app/app.h"

/* Most components of the state for the matrix in the report, and for columns. */
enum { SHOWN = 8, MOST_COMPONENTS = 64 };

static int components(const App *app) {
  const lag_model *m = app->scene->model;
  return 2 * m->nq + m->nz;
}

/* s[n] := unit as numerator or denominator of a fraction, in parentheses if compound. */
static void put_in_fraction(char *s, size_t n, const char *unit) {
  int several = strpbrk(unit, "/*") != NULL;
  snprintf(s, n, "%s%s%s", several ? "(" : "", unit[0] ? unit : "1", several ? ")" : "");
}

/* *c := name and unit of dx/dy(0) for components i and j. */
static void describe(const App *app, int i, int j, Column *c) {
  char name[2][96], unit[2][64];
  for (int k = 0; k < 2; k++) lag_sim_state_info(app->sim, k ? j : i, name[k], sizeof name[k], unit[k], sizeof unit[k]);
  snprintf(c->name, sizeof c->name, "d%.40s/d%.40s(0)", name[0], name[1]);
  if (strcmp(unit[0], unit[1]) == 0) {
    c->unit[0] = '\0';
    return;
  }
  put_in_fraction(name[0], sizeof name[0], unit[0]);
  put_in_fraction(name[1], sizeof name[1], unit[1]);
  snprintf(c->unit, sizeof c->unit, "%.30s/%.30s", name[0], name[1]);
}

int lag_tangent_columns_open(App *app) {
  const Args *a = &app->args;
  Table *t = &app->table;
  int n = components(app), before = t->ncols;
  if (!a->tangent) return 0;
  if (lag_sim_set_tangent(app->sim, n, NULL)) return lag_app_error(a, "%s", lag_sim_message(app->sim));
  if (n > MOST_COMPONENTS) {
    return lag_app_error(a, "--tangent: %d coordinates, velocities and states would make %d columns; %d are allowed. lag_sim_set_tangent of "
                        "liblag takes as many as you give it", n, n * n, MOST_COMPONENTS);
  }
  Column *cols = realloc(t->cols, (size_t)(before + n * n) * sizeof *cols);
  double *row = realloc(app->row, (size_t)(before + n * n) * sizeof *row);
  t->cols = cols ? cols : t->cols;
  app->row = row ? row : app->row;
  if (!cols || !row) return lag_app_error(a, "out of memory");
  t->ncols = before + n * n;
  for (int k = 0; k < n * n; k++) {
    cols[before + k] = (Column){0};
    describe(app, k / n, k % n, &cols[before + k]);
  }
  return 0;
}

int lag_tangent_columns_row(App *app) {
  int n = components(app);
  double *J = app->row + app->table.ncols - n * n;
  if (!app->args.tangent) return LAG_OK;
  int rc = lag_sim_tangent(app->sim, J);
  for (int i = 0; i < n && rc == 0; i++)
    for (int j = 0; j < n; j++) J[i * n + j] *= lag_sim_state_info(app->sim, j, NULL, 0, NULL, 0) / lag_sim_state_info(app->sim, i, NULL, 0, NULL, 0);
  return rc;
}

/* ---- The report */

void lag_report_tangent(App *app, FILE *f) {
  int n = components(app);
  char name[96];
  if (!app->args.tangent || app->status < 0 || lag_tangent_columns_row(app)) return;
  const double *J = app->row + app->table.ncols - n * n;
  if (n > SHOWN) {
    fprintf(f, "tangent: %d by %d, in the rows of -o and in --json\n", n, n);
    return;
  }
  fprintf(f, "tangent: derivative of the state by the state at the start\n  %-14s", "");
  for (int j = 0; j < n; j++) {
    lag_sim_state_info(app->sim, j, name, sizeof name, NULL, 0);
    fprintf(f, " %14.10s(0)", name);
  }
  for (int i = 0; i < n; i++) {
    lag_sim_state_info(app->sim, i, name, sizeof name, NULL, 0);
    fprintf(f, "\n  %-14s", name);
    for (int j = 0; j < n; j++) fprintf(f, " %17.10g", J[i * n + j]);
  }
  putc('\n', f);
}

void lag_report_tangent_json(App *app, Json *out) {
  int n = components(app);
  char name[96];
  if (!app->args.tangent || app->status < 0 || lag_tangent_columns_row(app)) return;
  const double *J = app->row + app->table.ncols - n * n;
  lag_json_begin(out, "tangent", '{');
  for (int i = 0; i < n; i++) {
    lag_sim_state_info(app->sim, i, name, sizeof name, NULL, 0);
    lag_json_begin(out, name, '{');
    for (int j = 0; j < n; j++) {
      lag_sim_state_info(app->sim, j, name, sizeof name, NULL, 0);
      lag_json_number(out, name, J[i * n + j]);
    }
    lag_json_end(out, '}');
  }
  lag_json_end(out, '}');
}
