/* --sweep -o FILE.h5, --motions FILE.h5: rows and motions as arrays, an axis for each range. */
#include <stdlib.h>
#include <string.h>

#include "app/sweep.h"
#include "io/posix.h"
#include "numeric/release.h"

typedef struct Arrays {
  SweepApp *s;
  lag_axis axis[LAG_GRID_MOST], *column;
  double *memory, *next; /* of all numbers; where the next array begins */
  int naxes, ncolumns, *from; /* from[ncolumns]: column of the table */
  char (*renamed)[sizeof(Column)]; /* [names that vary]: x(start) where a motion has a column x */
} Arrays;

static double *take_room(Arrays *g, long long n) {
  double *x = g->next;
  g->next += n;
  return x;
}

/* Names that are walked together, or are samples, stand over runs or samples. */
static int is_column(const SweepPlan *p, int k) { return p->zip || !p->factor[k].n; }

/* Numbers of all axes, with one of so many rows. */
static long long axes_room(const SweepPlan *p, long long rows) {
  long long n = p->grid + p->samples + rows;
  for (int k = 0; k < p->n; k++) n += p->factor[k].n;
  return n;
}

/* Room for the axes, `columns` columns over all runs, and as many names. -1: no memory. */
static int open_arrays(Arrays *g, SweepApp *s, int columns, int over_runs, long long rows) {
  *g = (Arrays){.s = s,
                .column = calloc((size_t)columns, sizeof *g->column),
                .from = calloc((size_t)columns, sizeof *g->from),
                .renamed = calloc((size_t)s->plan.n, sizeof *g->renamed),
                .memory = malloc((size_t)(axes_room(&s->plan, rows) + over_runs * s->plan.runs) * sizeof *g->memory)};
  g->next = g->memory;
  return g->column && g->from && g->renamed && g->memory ? 0 : -1;
}

static void close_arrays(Arrays *g) {
  lag_free_all(g->column, g->from, g->renamed, g->memory);
}

static void add_axis(Arrays *g, const char *name, const char *unit, long long n) {
  double *x = take_room(g, n);
  for (long long i = 0; i < n; i++) x[i] = (double)(i + 1);
  g->axis[g->naxes++] = (lag_axis){name, unit, n, x};
}

static int is_named(const Table *t, int from, const char *name) {
  for (int i = from; i < t->ncols; i++)
    if (strcmp(t->cols[i].name, name) == 0) return 1;
  return 0;
}

/* An axis that counts runs, samples or rows; called otherwise where the model, or a measure, has its name. */
static void add_count(Arrays *g, const char *name, const char *otherwise, long long n) {
  const SweepApp *s = g->s;
  add_axis(g, is_named(&s->table, 0, name) || is_named(&s->motions, 1, name) ? otherwise : name, "", n);
}

static int add_axes(Arrays *g) {
  const SweepPlan *p = &g->s->plan;
  const Column *c = g->s->table.cols;
  double *value = malloc((size_t)p->n * sizeof *value);
  long long stride = p->runs;
  for (int k = 0; k < p->n && value; k++) {
    if (is_column(p, k)) continue;
    double *x = g->next;
    add_axis(g, g->renamed[k][0] ? g->renamed[k] : c[k].name, c[k].unit, p->factor[k].n);
    stride /= p->factor[k].n;
    for (long long i = 0; i < p->factor[k].n; i++) lag_plan_values(p, i * stride, value), x[i] = value[k];
  }
  if (p->zip) add_count(g, "run", "run(axis)", p->grid);
  if (p->samples > 1) add_count(g, "sample", "sample(axis)", p->samples);
  free(value);
  return value ? 0 : -1;
}

/* The first n columns of the table, but for those that are axes. */
static void add_columns(Arrays *g, int n) {
  const Table *t = &g->s->table;
  for (int k = 0; k < n; k++) {
    int varies = k < g->s->plan.n;
    if (varies && !is_column(&g->s->plan, k)) continue;
    g->from[g->ncolumns] = k;
    g->column[g->ncolumns++] = (lag_axis){varies && g->renamed[k][0] ? g->renamed[k] : t->cols[k].name, t->cols[k].unit,
                                          g->s->plan.runs, take_room(g, g->s->plan.runs)};
  }
}

static int take_row(void *arrays, long long run, const double *row) {
  const Arrays *g = arrays;
  for (int k = 0; k < g->ncolumns; k++) ((double *)g->column[k].x)[run] = row[g->from[k]];
  return 0;
}

/* Writes the grid, whose rows come from `next` where it is not NULL. 0, or EXIT_USAGE after a message. */
static int write_grid(const Arrays *g, const char *path, int (*next)(void *context, double *block), void *context) {
  const App *app = g->s->app;
  char part[4200], title[300];
  snprintf(part, sizeof part, "%s.part-%ld", path, (long)getpid());
  snprintf(title, sizeof title, "%s: %s", app->scene->model->name, app->scene->name);
  int rc = app->extras.hdf5(part, &(lag_grid){title, g->naxes, g->ncolumns, g->axis, g->column, next, context})
               ? lag_app_error(&app->args, "HDF5 cannot write %s", path)
               : 0;
  if (rc == 0 && rename(part, path)) rc = lag_app_io_error(app, path);
  if (rc) unlink(part);
  return rc;
}

int lag_sweep_write_arrays(SweepApp *s) {
  const App *app = s->app;
  Arrays g;
  int rc = open_arrays(&g, s, s->table.ncols, s->table.ncols, 0) || add_axes(&g)
               ? lag_app_error(&app->args, "out of memory")
               : 0;
  if (rc == 0) {
    add_columns(&g, s->table.ncols);
    rc = lag_sweep_each_row(s, take_row, &g) ? lag_app_io_error(app, s->journal.path) : 0;
  }
  rc = rc ? rc : write_grid(&g, app->args.out, NULL, NULL);
  close_arrays(&g);
  return rc;
}

/* ---- Motions: t and the outputs over the axes of the runs and one of rows; names that are walked together, or are
 * samples, over those of the runs */

static int next_motion(void *reader, double *block) {
  MotionReader *r = reader;
  const Sweep *w = &r->s->sweep;
  const double *motion = lag_sweep_next_motion(r);
  for (int k = 0; k <= w->nrows && motion; k++)
    for (int i = 0; i < w->width; i++) block[i * (w->nrows + 1) + k] = motion[k * w->width + i];
  return motion ? 0 : -1;
}

/* A start that varies, and its output: two arrays may not have one name. */
static void rename_starts(Arrays *g) {
  const SweepApp *s = g->s;
  for (int k = 0; k < s->plan.n; k++)
    for (int i = 1; i < s->motions.ncols; i++)
      if (strcmp(s->motions.cols[i].name, s->table.cols[k].name) == 0)
        snprintf(g->renamed[k], sizeof g->renamed[k], "%s(start)", s->table.cols[k].name);
}

int lag_sweep_write_motion_arrays(SweepApp *s) {
  const App *app = s->app;
  Arrays g;
  MotionReader r = {0};
  int rc =
      open_arrays(&g, s, s->plan.n + s->sweep.width, s->plan.n, s->sweep.nrows + 1) || lag_sweep_motion_reader(&r, s)
          ? lag_app_error(&app->args, "out of memory")
          : 0;
  if (rc == 0) {
    rename_starts(&g);
    rc = add_axes(&g) ? lag_app_error(&app->args, "out of memory") : 0;
  }
  if (rc == 0) {
    add_columns(&g, s->plan.n);
    rc = lag_sweep_each_row(s, take_row, &g) ? lag_app_io_error(app, s->journal.path) : 0;
    add_count(&g, "row", "row(axis)", s->sweep.nrows + 1);
    for (const Column *c = s->motions.cols + 1; c < s->motions.cols + s->motions.ncols; c++)
      g.column[g.ncolumns++] = (lag_axis){c->name, c->unit, 0, NULL};
  }
  rc = rc ? rc : write_grid(&g, app->args.motions, next_motion, &r);
  free(r.chunk);
  close_arrays(&g);
  return rc;
}
