/* --sweep --svg: with --section the crossings over the range of one name; the measures over the range of one name,
 * the first measure over those of two, or else a matrix of scatter plots; with --histogram histograms of the
 * measures. Ranges in equal ratios have logarithmic axes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/sweep.h"
#include "numeric/release.h"

enum { MOST_CELLS = 512 * 512, MOST_COLUMNS = 8, MOST_BARS = 500, CLASSES = 6 };

/* Whether a list has equal steps, as that of a constant from FIRST..LAST:NUMBER. */
static int has_steps(const Factor *f) {
  double step = f->n > 1 ? (f->list[f->n - 1] - f->list[0]) / (double)(f->n - 1) : 0;
  for (long long i = 0; i < f->n; i++)
    if (!(fabs(f->list[i] - f->list[0] - (double)i * step) < 1e-9 * step)) return 0;
  return 1;
}

static int is_even(const Factor *f) { return f->n > 1 && (f->kind != FACTOR_LIST || has_steps(f)); }

static int is_map(const SweepPlan *p) {
  return p->n == 2 && !p->dimensions && !p->zip && is_even(&p->factor[0]) && is_even(&p->factor[1]);
}

static int is_curves(const SweepPlan *p) { return p->n == 1 && !p->dimensions; }

static int is_log(const SweepPlan *p, int k) { return p->factor[k].kind == FACTOR_LOG; }

/* --histogram N: N, or 0 after a message. */
static long long bars_of(const Args *a) {
  long long n = 0;
  if (lag_args_count(a, "--histogram", a->histogram, "--histogram 40", &n)) return 0;
  if (!a->svg) return lag_app_error(a, "--histogram %lld needs a picture: --svg FILE.svg", n), 0;
  return n > MOST_BARS ? lag_app_error(a, "--histogram %lld: up to %d bars can be told apart", n, MOST_BARS), 0 : n;
}

static int drawn_column(const SweepApp *s);

int lag_sweep_picture_check(SweepApp *s) {
  const Args *a = &s->app->args;
  const SweepPlan *p = &s->plan;
  int columns = p->n + s->sweep.nmeasures;
  if (a->histogram && !bars_of(a)) return EXIT_USAGE;
  if (a->svg && a->section && !a->histogram && !is_curves(p))
    return lag_app_error(a, "--section --svg: crossings are drawn over the range of one name; let one vary, or leave "
                            "--svg out and write --motions FILE.csv");
  if (a->continued && (!a->svg || !a->section || a->histogram))
    return lag_app_error(a, "--branches %s: branches are drawn over the points of a section: --section 'EXPR rising' "
                            "--svg FILE.svg", a->continued);
  if (a->continued) return lag_sweep_branches_read(s, &s->motions.cols[drawn_column(s)]);
  if (!a->svg || is_curves(p) || a->histogram) return 0;
  if (is_map(p))
    return p->runs > MOST_CELLS
               ? lag_app_error(a, "--svg: a map of more than %d cells is too large; take fewer values", MOST_CELLS)
               : 0;
  return columns > MOST_COLUMNS ? lag_app_error(a,
                                                "--svg: a matrix of %d names and measures is too small to read, up to "
                                                "%d fit; name a few measures, --measure EXPR",
                                                columns, MOST_COLUMNS)
                                : 0;
}

/* Rows of a picture, and where they go. */
typedef struct Drawing {
  SweepApp *s;
  Table table;   /* of curves, or of a matrix: names that vary, and measures */
  double *value; /* of a map: the first measure, [ny * nx] */
} Drawing;

/* The value of name k as a picture has it. */
static double drawn_value(const SweepPlan *p, int k, double x) { return is_log(p, k) ? log10(x) : x; }

static int take_row(void *drawing, long long run, const double *row) {
  Drawing *d = drawing;
  const SweepPlan *p = &d->s->plan;
  (void)run;
  if (lag_table_add(&d->table, row)) return -1;
  double *copy = d->table.data + (d->table.nrows - 1) * (size_t)d->table.ncols;
  for (int k = 0; k < p->n; k++) copy[k] = drawn_value(p, k, row[k]);
  return 0;
}

static int take_cell(void *drawing, long long run, const double *row) {
  Drawing *d = drawing;
  long long nx = d->s->plan.factor[0].n, ny = d->s->plan.factor[1].n; /* the second name runs first */
  d->value[run % ny * nx + run / ny] = row[2];
  return 0;
}

/* All rows, but their status. */
static int read_table(Drawing *d) {
  const Table *all = &d->s->table;
  d->table = (Table){.ncols = all->ncols - 1, .cols = all->cols, .keep = 1};
  return lag_sweep_each_row(d->s, take_row, d);
}

static int draw_curves(const Picture *picture, void *drawing) {
  Drawing *d = drawing;
  int n = d->s->sweep.nmeasures, *columns = calloc(2 * (size_t)n + 1, sizeof *columns);
  PlottedCurves curves = {.n = n, .x = columns, .y = columns ? columns + n : NULL, .xlog = is_log(&d->s->plan, 0)};
  int rc = columns ? read_table(d) : -1;
  for (int k = 0; k < n && columns; k++) curves.y[k] = k + 1;
  if (rc == 0) lag_svg_write(picture, &d->table, &curves);
  lag_free_all(d->table.data, columns);
  return rc;
}

/* ---- Crossings of a section over the range of a name: a bifurcation diagram */

/* The class of each run by the first measure, among equal parts of its range. */
typedef struct RunClasses {
  int n; /* 1: all runs alike, as without --measure */
  double lo, hi, *value;
} RunClasses;

static int take_class(void *classes, long long run, const double *row) {
  RunClasses *c = classes;
  c->value[run] = row[1];
  if (isfinite(row[1])) c->lo = fmin(c->lo, row[1]), c->hi = fmax(c->hi, row[1]);
  return 0;
}

static int choose_classes(SweepApp *s, RunClasses *c) {
  *c = (RunClasses){1, INFINITY, -INFINITY, NULL};
  if (s->names) return 0;
  c->value = malloc((size_t)s->plan.runs * sizeof *c->value);
  if (!c->value || lag_sweep_each_row(s, take_class, c)) return -1;
  if (c->hi > c->lo) c->n = CLASSES;
  return 0;
}

static int class_of(const RunClasses *c, long long run) {
  if (c->n == 1 || !isfinite(c->value[run])) return 0;
  int k = (int)((c->value[run] - c->lo) / (c->hi - c->lo) * c->n);
  return k < c->n ? k : c->n - 1;
}

/* The column of motions that is drawn: --plot-y, or the first output. */
static int drawn_column(const SweepApp *s) {
  const char *name = s->app->args.nplot_ys ? s->app->args.plot_ys[0] : NULL;
  for (int i = 2; name && i < s->motions.ncols; i++)
    if (strcmp(s->motions.cols[i].name, name) == 0) return i;
  return 2;
}

/* Columns: the value, and the drawn output for each class. */
static int name_classes(Drawing *d, const RunClasses *c) {
  const Column *of = &d->s->table.cols[1];
  const int joined = d->s->branches.cols ? 2 : 0;
  d->table = (Table){.ncols = c->n + 1 + joined, .cols = calloc((size_t)c->n + 3, sizeof *d->table.cols), .keep = 1,
                     .points = 1, .joined = joined};
  if (!d->table.cols) return -1;
  d->table.cols[0] = d->s->table.cols[0];
  for (int k = 0; k < c->n + joined; k++) {
    Column *y = &d->table.cols[k + 1];
    *y = d->s->motions.cols[drawn_column(d->s)];
    if (k >= c->n) snprintf(y->name, sizeof y->name, "continued, %s", k == c->n ? "stable" : "unstable");
    else if (c->n > 1)
      snprintf(y->name, sizeof y->name, "%.40s %.3g..%.3g", of->name, c->lo + (c->hi - c->lo) * k / c->n,
               c->lo + (c->hi - c->lo) * (k + 1) / c->n);
  }
  return 0;
}

static int add_crossings(Drawing *d, const RunClasses *c) {
  const Sweep *w = &d->s->sweep;
  MotionReader r;
  int drawn = drawn_column(d->s);
  double row[CLASSES + 3], value, period = lag_app_period(d->s->app, d->s->motions.cols[drawn].name);
  int rc = lag_sweep_motion_reader(&r, d->s);
  for (long long i = 0; i < d->s->plan.runs && rc == 0; i++) {
    const double *motion = lag_sweep_next_motion(&r);
    lag_plan_values(&d->s->plan, i, &value);
    for (int k = 0; k <= CLASSES + 2; k++) row[k] = NAN;
    row[0] = drawn_value(&d->s->plan, 0, value);
    rc = motion ? 0 : -1;
    for (int k = 0; rc == 0 && !isnan(motion[k * w->width]); k++) {
      double y = motion[k * w->width + drawn - 1];
      row[1 + class_of(c, i)] = period > 0 ? remainder(y, period) : y;
      rc = lag_table_add(&d->table, row);
    }
  }
  free(r.chunk);
  return rc || !d->s->branches.cols
             ? rc
             : lag_sweep_branches_draw(d->s, &d->table, 1 + c->n, period, is_log(&d->s->plan, 0));
}

static int draw_crossings(const Picture *picture, void *drawing) {
  Drawing *d = drawing;
  static const int x[CLASSES + 2] = {0}, y[CLASSES + 2] = {1, 2, 3, 4, 5, 6, 7, 8};
  RunClasses c;
  int rc = choose_classes(d->s, &c) ? -1 : name_classes(d, &c) ? -1 : add_crossings(d, &c);
  const PlottedCurves curves = {.n = c.n + d->table.joined, .x = (int *)x, .y = (int *)y,
                                .xlog = is_log(&d->s->plan, 0), .ordered = 1, .xname = d->s->table.cols[0].name,
                                .yname = d->s->motions.cols[drawn_column(d->s)].name};
  if (rc == 0) lag_svg_write(picture, &d->table, &curves);
  lag_free_all(d->table.cols, d->table.data, c.value);
  return rc;
}

static int draw_matrix(const Picture *picture, void *drawing) {
  Drawing *d = drawing;
  const SweepPlan *p = &d->s->plan;
  int log[MOST_COLUMNS];
  for (int k = 0; k < p->n; k++) log[k] = is_log(p, k);
  int rc = read_table(d);
  if (rc == 0) lag_matrix_write(picture, &(ScatterMatrix){.table = &d->table, .first = p->n, .log = log});
  free(d->table.data);
  return rc;
}

static int draw_histograms(const Picture *picture, void *drawing) {
  Drawing *d = drawing;
  int rc = read_table(d);
  if (rc == 0) rc = lag_histograms_write(picture, &d->table, d->s->plan.n, (int)bars_of(&d->s->app->args));
  free(d->table.data);
  return rc;
}

static int draw_map(const Picture *picture, void *drawing) {
  Drawing *d = drawing;
  SweepApp *s = d->s;
  const SweepPlan *p = &s->plan;
  char label[3][sizeof(Column) + 4];
  int nx = (int)p->factor[0].n, ny = (int)p->factor[1].n;
  double *axis = malloc((size_t)(nx + ny) * sizeof *axis), both[2];
  d->value = malloc((size_t)(nx * ny) * sizeof *d->value);
  int rc = axis && d->value ? lag_sweep_each_row(s, take_cell, d) : -1;
  for (int i = 0; i < nx && axis; i++)
    lag_plan_values(p, (long long)i * ny, both), axis[i] = drawn_value(p, 0, both[0]);
  for (int i = 0; i < ny && axis; i++) lag_plan_values(p, i, both), axis[nx + i] = drawn_value(p, 1, both[1]);
  for (int k = 0; k < 3; k++) lag_column_label(&s->table.cols[k], label[k], sizeof label[k]);
  const ValueMap map = {.nx = nx,
                        .ny = ny, .x = axis, .y = axis + nx, .xlog = is_log(p, 0), .ylog = is_log(p, 1),
                        .value = d->value, .xlabel = label[0], .ylabel = label[1],
                        .label = label[2]};
  if (rc == 0) lag_map_write(picture, &map);
  lag_free_all(axis, d->value);
  return rc;
}

int lag_sweep_picture(SweepApp *s) {
  Drawing d = {.s = s};
  char title[300];
  snprintf(title, sizeof title, "%s: %s", s->app->scene->model->name, s->app->scene->name);
  const Args *a = &s->app->args;
  return a->svg ? lag_app_picture(s->app, a->svg, title,
                                  a->histogram          ? draw_histograms
                                  : a->section          ? draw_crossings
                                  : is_curves(&s->plan) ? draw_curves
                                  : is_map(&s->plan)    ? draw_map
                                                        : draw_matrix,
                                  &d)
                : 0;
}
