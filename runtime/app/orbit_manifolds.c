/* --manifold: runs from beside a periodic motion, or a saddle at rest, along its stable and unstable directions.
 * Enters: the motion (analysis/manifold.h); leaves: rows of the runs, or where they cross a section, and a picture. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/equilibrium.h"
#include "app/orbit_manifolds.h"

enum { PHASES = 60, ROWS = 200, BEFORE = 4 }; /* columns before the state: manifold, phase, side, t */

static const char *const words[] = {"unstable", "stable"};

/* ---- Settings */

int lag_manifolds_settings(Manifolds *m) {
  static const char *const choices[] = {"unstable", "stable", "both"};
  const Args *a = &m->app->args;
  const char *kind = a->manifold ? a->manifold : "both";
  size_t n = strcspn(kind, ":"), choice = 0;
  while (choice < 3 && (strlen(choices[choice]) != n || memcmp(kind, choices[choice], n) != 0)) choice++;
  long long phases = PHASES;
  if (choice == 3 ||
      (kind[n] && lag_args_count(a, "--manifold", kind + n + 1, "--manifold unstable:60", &phases)))
    return lag_app_error(a,
                         "--manifold %s: write unstable, stable or both, with another number of starts than %d behind "
                         "a colon: --manifold unstable:200",
                         kind, PHASES);
  m->wanted[0] = choice != 1;
  m->wanted[1] = choice != 0;
  m->phases = (int)fmin((double)phases, 100000);
  if (lag_args_positive(a, "--follow", a->follow, "--follow 20", "a time above 0", &m->follow)) return EXIT_USAGE;
  if (a->manifold && !a->out && !a->svg && !a->to)
    return lag_app_error(a, "--manifold: the runs need a file: -o FILE.csv, or --svg FILE.svg for a picture");
  return lag_section_choose(m->app);
}

/* ---- Runs */

void lag_manifolds_row(Manifolds *m, double t, const double *y) {
  App *app = m->app;
  double *row = app->row;
  row[0] = m->now->stable;
  row[1] = m->now->phase;
  row[2] = m->now->side;
  row[3] = t;
  for (int i = 0; i < app->sim->pb.n; i++) row[BEFORE + i] = lag_sim_declared(app->sim, i, y[i]);
  if (m->rc == 0 && app->args.out && lag_rows_write(&app->rows, row)) m->rc = lag_app_io_error(app, app->args.out);
  if (m->rc == 0 && lag_table_add(&m->drawn, row)) m->rc = lag_app_error(&app->args, "out of memory");
  m->rows++;
}

static void at_event(void *context, int k, double t, const double *before, const double *after) {
  Manifolds *m = context;
  (void)before;
  if (k == m->app->section) lag_manifolds_row(m, t, after);
}

/* One run, as far as it goes: into a collision, or to an event that ends it. */
static void follow(Manifolds *m, FlowMap *f, const ManifoldStart *s, double time) {
  double along = s->stable ? -time : time;
  lag_sim *sim = lag_flow_sim_along(f, s->t, s->y, along);
  m->now = s;
  if (!sim) m->rc = lag_app_error(&m->app->args, "out of memory");
  if (sim && m->app->section >= 0) {
    sim->forwards = m->app->section + 1;
    lag_sim_on_event(sim, at_event, m);
  }
  for (int k = 0; k <= ROWS && sim && m->rc == 0; k++) {
    if (lag_sim_advance(sim, s->t + along * k / ROWS)) break;
    if (m->app->section < 0) lag_manifolds_row(m, sim->run->t, sim->now);
  }
  lag_sim_free(sim);
}

static int follow_all(Manifolds *m, FlowMap *f, double period, double part) {
  for (const ManifoldStart *s = m->found.first; s && m->rc == 0; s = s->next) {
    double time = m->follow > 0 ? m->follow : -log(part) / s->rate + (period > 0 ? period : 5 / s->rate);
    follow(m, f, s, time);
  }
  return m->rc;
}

/* ---- Rows and picture */

int lag_manifolds_columns(Manifolds *m, const char *number) {
  const char *const heads[] = {"manifold", number, "side", "t"};
  App *app = m->app;
  int n = app->sim->pb.n;
  Table *t = &app->table;
  *t = (Table){.ncols = BEFORE + n, .cols = calloc((size_t)(BEFORE + n), sizeof *t->cols)};
  app->row = calloc((size_t)t->ncols, sizeof *app->row);
  m->drawn = (Table){.ncols = BEFORE + n, .keep = 1, .cols = calloc((size_t)(BEFORE + n), sizeof *t->cols)};
  if (!t->cols || !app->row || !m->drawn.cols) return lag_app_error(&app->args, "out of memory");
  for (int k = 0; k < BEFORE; k++) snprintf(t->cols[k].name, sizeof t->cols[k].name, "%s", heads[k]);
  t->cols[0].words = words;
  strcpy(t->cols[3].unit, "s");
  for (int i = 0; i < n; i++) t->cols[BEFORE + i] = lag_state_column(app->sim, i);
  if (app->args.out && lag_rows_open(&app->rows, app->args.out, t)) return lag_app_io_error(app, app->args.out);
  return 0;
}

static double spread(const Table *t, int column) {
  double low = HUGE_VAL, high = -HUGE_VAL;
  lag_table_range(t, column, &low, &high);
  return t->nrows ? high - low : 0;
}

/* The two components that are drawn: of paths the first two coordinates; of one coordinate, and of a section, the
 * coordinate that varies most, and its velocity. */
static void choose_axes(const Manifolds *m, int *x, int *y) {
  int nq = m->app->sim->pb.nq, n = m->app->sim->pb.n, best = 0;
  *x = 0, *y = n > 1;
  if (!nq || (m->app->section < 0 && nq > 1)) return;
  for (int i = 1; i < nq; i++)
    if (spread(&m->drawn, BEFORE + i) > spread(&m->drawn, BEFORE + best)) best = i;
  *x = best, *y = nq + best;
}

/* Rows of the picture: number, x, y of unstable and of stable manifolds; rows without values part the runs. */
static int draw_rows(Manifolds *m, Table *t, int x, int y) {
  const Table *d = &m->drawn;
  int rc = 0;
  for (size_t r = 0; r < d->nrows && rc == 0; r++) {
    const double *row = d->data + r * (size_t)d->ncols, *before = r ? row - d->ncols : row;
    int other = row[0] != before[0] || row[1] != before[1] || row[2] != before[2];
    double gap[] = {(double)r, NAN, NAN, NAN}, point[] = {(double)r, row[BEFORE + x], NAN, NAN};
    point[row[0] > 0 ? 3 : 2] = row[BEFORE + y];
    if (other) rc = lag_table_add(t, gap);
    rc = rc ? rc : lag_table_add(t, point);
  }
  return rc;
}

int lag_manifolds_draw(Manifolds *m, const char *words_of) {
  App *app = m->app;
  char title[300];
  int x = 0, y = 0;
  if (!app->args.svg) return 0;
  choose_axes(m, &x, &y);
  lag_table_free(&app->table);
  app->table = (Table){.ncols = 4, .keep = 1, .points = app->section >= 0, .cols = calloc(4, sizeof *app->table.cols)};
  if (!app->table.cols || draw_rows(m, &app->table, x, y)) return lag_app_error(&app->args, "out of memory");
  app->table.cols[1] = lag_state_column(app->sim, x);
  for (int k = 0; k < 2; k++) {
    Column *c = &app->table.cols[2 + k], of = lag_state_column(app->sim, y);
    snprintf(c->name, sizeof c->name, "%.40s, %s", of.name, words[k]);
    memcpy(c->unit, of.unit, sizeof of.unit);
  }
  snprintf(title, sizeof title, "%s: %s, %s", app->scene->model->name, app->scene->name,
           words_of);
  if (lag_app_choose_curves(app)) return EXIT_USAGE;
  PlottedCurves *d = &app->drawn;
  snprintf(app->drawn_ys, sizeof app->drawn_ys, "%.60s", lag_state_column(app->sim, y).name);
  d->n = 2;
  for (int k = 0; k < 2; k++) d->x[k] = 1, d->y[k] = 2 + k;
  d->xname = app->table.cols[1].name;
  d->yname = app->drawn_ys;
  return lag_app_draw_table(app, title);
}

/* ---- The command */

/* Exit status of a computation that failed. */
static int failed(const App *app, const char *message) { return lag_app_no_result(&app->args, "%s", message); }

static int finish(Manifolds *m, FlowMap *f, double period, double part, const char *of) {
  App *app = m->app;
  const Manifold *found = &m->found;
  if (!found->first) {
    return lag_app_no_result(&app->args, "--manifold %s: %s has no such direction%s", app->args.manifold, of,
                             found->rest_of ? ": its growing and decaying ones are spirals, in complex pairs" : "");
  }
  int rc = lag_manifolds_columns(m, "phase");
  rc = rc ? rc : follow_all(m, f, period, part);
  if (app->args.out && app->rows.open && lag_rows_close(&app->rows, rc == 0) && rc == 0)
    rc = lag_app_io_error(app, app->args.out);
  rc = rc ? rc : lag_manifolds_draw(m, app->section >= 0 ? app->args.section : "manifolds");
  if (rc == 0 && !app->args.json && !(app->args.out && strcmp(app->args.out, "-") == 0))
    printf("%s: scene %s, manifolds of %s: %zu rows\n", app->scene->model->name, app->scene->name, of, m->rows);
  return rc || m->rows ? rc : failed(app, "--section: no run along the manifold crosses it; a longer time: --follow T");
}

static const double beside = 1e-6; /* distance of the starts, in sizes of the motion */

int lag_app_manifolds(App *app, PeriodicOrbit *o) {
  Manifolds m = {.app = app};
  int rc = lag_manifolds_settings(&m), status = LAG_OK;
  for (int stable = 0; stable < 2 && rc == 0 && status == LAG_OK; stable++)
    if (m.wanted[stable]) status = lag_manifold_of_orbit(&m.found, o, stable, m.phases, beside);
  if (status) rc = failed(app, status == LAG_ENOMEM ? "out of memory" : o->flow.message);
  rc = rc ? rc : finish(&m, &o->flow, o->T, beside, "the periodic motion");
  lag_manifold_free(&m.found);
  lag_table_free(&m.drawn);
  return rc;
}

/* y[n] := the state of rest next to the start. */
static int find_rest(App *app, FlowMap *f, double *y) {
  Equilibrium rest = {0};
  if (app->scene->model->constraints)
    return failed(app, "--manifold of a rest: models with constraints are not supported yet");
  int found = lag_equilibrium_find(&rest, f->probe, app->extras.algebra);
  if (found > 0) memcpy(y, rest.y, (size_t)f->n * sizeof *y);
  lag_equilibrium_free(&rest);
  return found > 0 ? 0 : failed(app, "no state of rest found near the start: start near one: name=VALUE");
}

int lag_app_rest_manifolds(App *app) {
  Manifolds m = {.app = app};
  FlowMap f;
  int rc = lag_manifolds_settings(&m), status = LAG_OK;
  double *y = calloc((size_t)app->sim->pb.n, sizeof *y);
  if (!y) return lag_app_error(&app->args, "out of memory");
  if (lag_flow_open(&f, app->sim) && rc == 0) rc = failed(app, f.message);
  if (rc == 0 && f.forced)
    rc = lag_app_error(&app->args, "--equilibrium: the scene depends on time, so that nothing rests; leave it out");
  rc = rc ? rc : find_rest(app, &f, y);
  for (int stable = 0; stable < 2 && rc == 0 && status == LAG_OK; stable++)
    if (m.wanted[stable]) status = lag_manifold_of_rest(&m.found, &f, app->extras.algebra, y, stable, beside);
  if (status) rc = failed(app, status == LAG_ENOMEM ? "out of memory" : "the rates do not converge");
  rc = rc ? rc : finish(&m, &f, 0, beside, "the state of rest");
  free(y);
  lag_flow_free(&f);
  lag_manifold_free(&m.found);
  lag_table_free(&m.drawn);
  return rc;
}
