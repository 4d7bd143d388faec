/* Several scenes, methods or values in one picture. Enters: the command line; leaves: the picture, a line a run, an
 * exit status. Holds: a method that refuses the model is left out, and said; a run that fails is drawn up to its
 * end, with a warning; exit status 3 where all fail.
 *
 * All runs become one table: the rows of a run stand below those of the run before, in columns of their own, NaN in
 * the columns of others. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"
#include "numeric/line_fit.h"
#include "numeric/release.h"
#include "sweep/sweep_grid.h"

/* A run of the picture; curve[k]: its curve that belongs to curve k of the first run, -1: it has none. */
typedef struct OverlaidRun {
  App app;
  char *method; /* its element of --method; NULL: the scene's */
  char **sets;  /* of the command line, and its value of --vs; NULL: has none */
  char label[96];
  int *curve;
  /* of --distance: the first and the largest distance from the first run; its growth up to a time, log10 of the
   * distance = level + rate t/log(10); NaN: none */
  double first, most, rate, level, until;
} OverlaidRun;

typedef struct Overlay {
  App *app; /* the command line; its table and curves are those of the picture */
  OverlaidRun *runs;
  int n;
  /* [nvalues] name=value of each run of one scene and method; NULL: none, as of the first before those of --vs */
  const char **values;
  int nvalues;
  char *starts; /* texts of --starts */
  int digits;   /* of their labels */
  int scaled;   /* of --distance: 1: the outputs have several units */
} Overlay;

/* The given name=value of the name that the first --vs varies, or NULL: `angle=15 --vs angle=30` compares two
 * values. */
static const char *varied_value(const Args *a) {
  for (int i = 0; i < a->nsets && a->nvs; i++) {
    size_t n = strcspn(a->sets[i], "=") + 1;
    if (strncmp(a->sets[i], a->vs[0], n) == 0) return a->sets[i];
  }
  return NULL;
}

/* Label := scene, method and value, as far as the picture has several. digits: of the value; 0: its own text. */
static void set_label(OverlaidRun *r, const Args *a, const char *value, int digits) {
  char rounded[160];
  if (value && digits > 0) {
    int name = (int)strcspn(value, "=") + 1;
    snprintf(rounded, sizeof rounded, "%.*s%.*g", name, value, digits, strtod(value + name, NULL));
    value = rounded;
  }
  const char *parts[] = {a->nscenes > 1 ? r->app.args.scene : NULL, r->method, value ? value : varied_value(a)};
  size_t n = 0;
  for (int i = 0; i < 3; i++)
    if (parts[i] && n < sizeof r->label)
      n += (size_t)snprintf(r->label + n, sizeof r->label - n, "%s%s", n ? ", " : "", parts[i]);
}

/* Runs o->runs[o->n] by the first method of the list, and counts it unless that refuses the model. method, value: NULL
 * for none. 0, or EXIT_USAGE after a message. */
static int add_run(Overlay *o, const char *scene, const char *method, const char *value) {
  const App *whole = o->app;
  size_t length = method ? lag_app_method_length(method) : 0;
  OverlaidRun *r = &o->runs[o->n++];
  App *app = &r->app;
  *r = (OverlaidRun){.app = lag_app_like(whole)};
  app->overlaid = 1;
  app->compared = method && whole->args.method[lag_app_method_length(whole->args.method)] == ',';
  app->args.scene = scene;
  if ((method && !(app->args.method = r->method = calloc(length + 1, 1))) ||
      (value && !(r->sets = calloc((size_t)whole->args.nsets + 1, sizeof *r->sets))))
    return lag_app_error(&whole->args, "out of memory");
  if (method) memcpy(r->method, method, length);
  if (value) {
    for (int i = 0; i < whole->args.nsets; i++) r->sets[i] = whole->args.sets[i];
    r->sets[app->args.nsets++] = (char *)value;
    app->args.sets = r->sets;
  }
  set_label(r, &whole->args, value, o->digits);
  int rc = lag_app_run(app);
  if (!r->label[0] && app->scene) set_label(r, &whole->args, app->scene->name, 0);
  return rc;
}

static void free_run(OverlaidRun *r) {
  lag_app_free(&r->app);
  lag_free_all(r->method, r->sets, r->curve);
}

/* Judges the last run, which returned rc: one that was refused is left out, one that failed stays, with a warning.
 * 0, or EXIT_USAGE after a message. */
static int judge_run(Overlay *o, int rc) {
  const Args *a = &o->app->args;
  OverlaidRun *r = &o->runs[o->n - 1];
  char note[300];
  int status = rc ? LAG_OK : r->app.status, refused = r->app.refused || status == LAG_EMETHOD;
  if (status == LAG_EINVAL || status == LAG_ENOMEM || status == LAG_EIO)
    return lag_app_error(a, "%s", status == LAG_ENOMEM ? "out of memory" : lag_sim_message(r->app.sim));
  if (rc == 0) lag_sampling_warn(&r->app, note, sizeof note);
  if (!refused && status < 0)
    lag_app_error(a, "warning: %s: %s; the picture shows the run up to its end%s", r->label,
                  lag_sim_message(r->app.sim), lag_app_way_on(&r->app));
  if (!refused) return rc;
  if (rc == 0) lag_app_error(a, "%s", lag_sim_message(r->app.sim));
  lag_app_error(a, "note: %s is left out of the picture", r->label);
  free_run(r);
  o->n--;
  return 0;
}

/* Digits of labels that tell neighbours x and y of a range apart. */
static int digits_apart(double x, double y) {
  double size = fmax(fabs(x), fabs(y));
  return x == y ? 4 : (int)fmin(fmax(3 + ceil(log10(size / fabs(x - y))), 4), 17);
}

/* o->values := those of the range of --starts. 0, or EXIT_USAGE after a message. */
static int read_starts(Overlay *o) {
  enum { MOST = 1000, ROOM = 160 };
  const Args *a = &o->app->args;
  SweepPlan plan = {0};
  char why[300];
  double first = 0;
  int rc = 0;
  if (!lag_plan_is_range(a->starts))
    return lag_app_error(a, "--starts %s: write a range, for example --starts q=0..3:20", a->starts);
  if (lag_plan_add(&plan, a->starts, why, sizeof why)) rc = lag_app_error(a, "--starts: %s", why);
  else if (plan.factor[0].n == 0)
    rc =
        lag_app_error(a, "--starts %s: the number of runs is missing; write for example --starts q=0..3:20", a->starts);
  else if (lag_plan_finish(&plan, 0, why, sizeof why)) rc = lag_app_error(a, "--starts: %s", why);
  else if (plan.runs > MOST) rc = lag_app_error(a, "--starts %s: %d runs in one picture at most", a->starts, MOST);
  o->nvalues = rc ? 0 : (int)plan.runs;
  o->starts = calloc((size_t)o->nvalues + 1, ROOM);
  o->values = calloc((size_t)o->nvalues + 1, sizeof *o->values);
  if (rc == 0 && (!o->starts || !o->values)) rc = lag_app_error(a, "out of memory");
  for (int i = 0; i < o->nvalues && rc == 0; i++) {
    double x;
    char number[64];
    lag_plan_values(&plan, i, &x);
    snprintf(o->starts + i * ROOM, ROOM, "%s=%s", plan.factor[0].name, lag_number_text(x, number));
    o->values[i] = o->starts + i * ROOM;
    if (i == 1) o->digits = digits_apart(first, x);
    if (i == 0) first = x;
  }
  lag_plan_free(&plan);
  return rc;
}

/* o->values := none, for the first run, and those of --vs; or of --starts. */
static int read_values(Overlay *o) {
  const Args *a = &o->app->args;
  if (a->starts) return read_starts(o);
  o->nvalues = a->nvs + 1;
  if (!(o->values = calloc((size_t)o->nvalues, sizeof *o->values))) return lag_app_error(a, "out of memory");
  for (int i = 0; i < a->nvs; i++) o->values[i + 1] = a->vs[i];
  return 0;
}

/* Counts the methods of --method, all of which the program knows; 0 after a message. */
static int count_methods(const Overlay *o) {
  int n = 0;
  for (const char *m = o->app->args.method; m; m = lag_app_next_method(m), n++) {
    char name[64];
    snprintf(name, sizeof name, "%.*s", (int)strcspn(m, " ,("), m);
    if (!lag_app_find_method(o->app, name)) return lag_app_unknown_method(o->app, name), 0;
  }
  return n ? n : 1;
}

static int run_all(Overlay *o) {
  const Args *a = &o->app->args;
  int scenes = a->nscenes ? a->nscenes : 1, methods = count_methods(o), rc = methods ? read_values(o) : EXIT_USAGE,
      interrupted = 0;
  if (rc) return rc;
  o->runs = calloc((size_t)(scenes * methods * o->nvalues), sizeof *o->runs);
  if (!o->runs) return lag_app_error(a, "out of memory");
  for (int s = 0; s < scenes; s++) {
    const char *method = a->method;
    for (int m = 0; m < methods; m++, method = method ? lag_app_next_method(method) : NULL)
      for (int v = 0; v < o->nvalues && rc == 0 && !interrupted; v++) {
        rc = judge_run(o, add_run(o, a->nscenes ? a->scenes[s] : NULL, method, o->values[v]));
        interrupted = o->n > 0 && o->runs[o->n - 1].app.status == LAG_INTERRUPTED;
      }
  }
  return rc ? rc : o->n ? 0 : lag_app_error(a, "no run is left to draw");
}

/* ---- The table of all */

static int same_column(const Column *a, const Column *b, int units) {
  return strcmp(a->name, b->name) == 0 && (!units || strcmp(a->unit, b->unit) == 0);
}

/* The curve of `of` whose columns have the names, and with units the units, of curve k of `first`; -1: none. */
static int same_curve(const App *first, int k, const App *of, int units) {
  const Column *a = first->table.cols, *b = of->table.cols;
  for (int i = 0; i < of->drawn.n; i++)
    if (same_column(&a[first->drawn.x[k]], &b[of->drawn.x[i]], units) &&
        same_column(&a[first->drawn.y[k]], &b[of->drawn.y[i]], units))
      return i;
  return -1;
}

/* Notes curve k of `has`, which the other run lacks, or has in another unit. */
static void note_lacking(const Overlay *o, const OverlaidRun *has, int k, const OverlaidRun *lacks) {
  const App *app = &has->app;
  const Column *x = &app->table.cols[app->drawn.x[k]], *y = &app->table.cols[app->drawn.y[k]],
               *other = lacks->app.table.cols;
  int i = same_curve(app, k, &lacks->app, 0);
  if (o->app->args.quiet) return;
  if (i < 0)
    lag_app_error(&o->app->args, "note: %s is no output of %s: the picture shows outputs of all scenes", y->name,
                  lacks->label);
  else {
    int of_x = same_column(y, &other[lacks->app.drawn.y[i]], 1);
    const Column *c = of_x ? x : y, *d = &other[of_x ? lacks->app.drawn.x[i] : lacks->app.drawn.y[i]];
    lag_app_error(&o->app->args,
                  "note: %s is in [%s] in %s and in [%s] in %s: one curve beside the other would mean nothing, and it "
                  "is left out",
                  c->name, c->unit, has->label, d->unit, lacks->label);
  }
}

/* Finds each curve of the first run in the others; curve[k] of the first := -1 where one lacks it. *common: the
 * number of others. 0, or EXIT_USAGE after a message. */
static int match_curves(Overlay *o, int *common) {
  OverlaidRun *first = o->runs;
  *common = first->app.drawn.n;
  for (int i = 0; i < o->n; i++) {
    OverlaidRun *r = &o->runs[i];
    r->curve = calloc((size_t)first->app.drawn.n + 1, sizeof *r->curve);
    if (!r->curve) return lag_app_error(&o->app->args, "out of memory");
    for (int k = 0; k < first->app.drawn.n; k++) {
      r->curve[k] = same_curve(&first->app, k, &r->app, 1);
      if (r->curve[k] >= 0 || first->curve[k] < 0) continue;
      note_lacking(o, first, k, r);
      first->curve[k] = -1;
      --*common;
    }
    int fresh = i > 0 && r->app.scene != o->runs[i - 1].app.scene;
    for (int k = 0; k < r->app.drawn.n && fresh; k++)
      if (same_curve(&r->app, k, &first->app, 0) < 0) note_lacking(o, r, k, first);
  }
  return *common ? 0 : lag_app_error(&o->app->args, "the scenes have no output in common; name one: --x EXPR --y EXPR");
}

/* Column 0 is the time; each common curve of a run has a column for y, and one for x where this is not the time. */
static int open_table(Overlay *o, int common) {
  const App *first = &o->runs[0].app;
  Table *t = &o->app->table;
  PlottedCurves *d = &o->app->drawn;
  size_t most = (size_t)(common * o->n);
  *t = (Table){.ncols = 1, .cols = calloc(1 + 2 * most, sizeof *t->cols), .keep = 1, .points = first->table.points};
  *d = (PlottedCurves){.x = calloc(2 * most, sizeof *d->x),
                       .xname = first->drawn.xname,
                       .yname = first->drawn.yname,
                       .beneath = first->drawn.beneath,
                       .runs = o->n,
                       .ordered = o->app->args.starts != NULL};
  if (!t->cols || !d->x) return lag_app_error(&o->app->args, "out of memory");
  d->y = d->x + most;
  t->cols[0] = first->table.cols[0];
  for (int k = 0; k < first->drawn.n; k++) {
    const Column *x = &first->table.cols[first->drawn.x[k]], *y = &first->table.cols[first->drawn.y[k]];
    for (int i = 0; i < o->n && o->runs[0].curve[k] >= 0; i++) {
      const char *label = o->runs[i].label;
      if (first->drawn.x[k]) t->cols[d->x[d->n] = t->ncols++] = *x;
      Column *to = &t->cols[d->y[d->n++] = t->ncols++];
      *to = *y;
      if (common == 1 && d->yname) snprintf(to->name, sizeof to->name, "%s", label);
      else snprintf(to->name, sizeof to->name, "%.46s, %.46s", y->name, label);
      to->plain = common == 1 && d->yname ? 0 : snprintf(NULL, 0, "%.46s", y->name);
    }
  }
  return 0;
}

static int add_rows(Overlay *o, int i, double *row) {
  const OverlaidRun *r = &o->runs[i];
  const PlottedCurves *d = &o->app->drawn, *own = &r->app.drawn;
  for (size_t at = 0; at < r->app.table.nrows; at++) {
    for (int c = 0; c < o->app->table.ncols; c++) row[c] = NAN;
    row[0] = lag_table_cell(&r->app.table, at, 0);
    for (int k = 0, c = i; c < d->n; k++) {
      if (o->runs[0].curve[k] < 0) continue;
      if (d->x[c]) row[d->x[c]] = lag_table_cell(&r->app.table, at, own->x[r->curve[k]]);
      row[d->y[c]] = lag_table_cell(&r->app.table, at, own->y[r->curve[k]]);
      c += o->n;
    }
    if (lag_table_add(&o->app->table, row)) return lag_app_error(&o->app->args, "out of memory");
  }
  return 0;
}

static int join(Overlay *o) {
  int common, rc = match_curves(o, &common);
  rc = rc ? rc : open_table(o, common);
  double *row = rc ? NULL : calloc((size_t)o->app->table.ncols, sizeof *row);
  if (rc == 0 && !row) rc = lag_app_error(&o->app->args, "out of memory");
  for (int i = 0; i < o->n && rc == 0; i++) rc = add_rows(o, i, row);
  free(row);
  return rc;
}

/* ---- The distance of runs from the first */

static double value_of(const OverlaidRun *r, int k, size_t at) {
  return lag_table_cell(&r->app.table, at, r->app.drawn.y[r->curve[k]]);
}

/* Whether curve k of the first run is common; its unit. */
static const char *unit_of(const Overlay *o, int k) {
  const App *first = &o->runs[0].app;
  return o->runs[0].curve[k] < 0 ? NULL : first->table.cols[first->drawn.y[k]].unit;
}

/* The largest value of curve k, and where this is little, as that of an energy of 0 that drifts, that of the terms that
 * cancel in it. */
static double size_of(const OverlaidRun *first, int k) {
  const double little = 1e-6;
  const App *app = &first->app;
  int out = app->drawn.y[first->curve[k]] - 1;
  double most = 0, terms = 0;
  for (size_t at = 0; at < app->table.nrows; at++) most = fmax(most, fabs(value_of(first, k, at)));
  if (out < lag_sim_noutputs(app->sim)) terms = lag_output_change(app->sim, lag_sim_time(app->sim), app->sim->now, out);
  return most > little * terms || !(terms < HUGE_VAL) ? most : terms;
}

/* scale[k] := what differences of curve k are divided by: 1 where all have one unit, which is returned; else the
 * largest value of this unit in the first run. */
static const char *find_scales(Overlay *o, double *scale) {
  const OverlaidRun *first = &o->runs[0];
  const char *one = NULL;
  int units = 0, n = first->app.drawn.n;
  for (int k = 0; k < n; k++) {
    const char *unit = unit_of(o, k);
    scale[k] = 0;
    if (!unit) continue;
    units += !one || strcmp(unit, one) != 0;
    one = unit;
    for (int j = 0; j < n; j++)
      if (unit_of(o, j) && strcmp(unit_of(o, j), unit) == 0) scale[k] = fmax(scale[k], size_of(first, j));
  }
  for (int k = 0; k < n && units == 1; k++) scale[k] = 1;
  o->scaled = units > 1;
  return units == 1 ? one : "";
}

/* NaN where the runs have no row at the same time. */
static double distance_at(const Overlay *o, const OverlaidRun *r, size_t at, const double *scale) {
  const Table *a = &o->runs[0].app.table, *b = &r->app.table;
  double t = lag_table_cell(a, at, 0), sum = 0;
  if (at >= b->nrows || fabs(t - lag_table_cell(b, at, 0)) > 1e-9 * fabs(t)) return NAN;
  for (int k = 0; k < o->runs[0].app.drawn.n; k++) {
    if (!unit_of(o, k) || scale[k] == 0) continue;
    double d = (value_of(r, k, at) - value_of(&o->runs[0], k, at)) / scale[k];
    sum += d * d;
  }
  return sqrt(sum);
}

/* The growth of a distance, a straight line of its logarithm: from its first row to the one where it reaches a tenth
 * of its largest. t, log10 of it: [n]. */
static void fit_growth(OverlaidRun *r, int n, const double *t, const double *log_distance) {
  int end = 0;
  r->first = r->most = r->rate = r->level = r->until = NAN;
  for (int i = 0; i < n; i++) r->most = fmax(r->most, pow(10, log_distance[i]));
  if (n) r->first = pow(10, log_distance[0]);
  while (end < n && log_distance[end] < log10(r->most) - 1) end++;
  if (end < 10 || log_distance[end - 1] < log_distance[0] + 1) return;
  LineFit f = lag_line_fit(end, t, log_distance);
  r->rate = f.xy / f.xx * log(10);
  r->level = f.my - f.xy / f.xx * f.mx;
  r->until = t[end - 1];
}

/* Adds a curve for the line of run i, in column o->n - 1 + i, named by its growth. */
static void add_line(Overlay *o, int i) {
  PlottedCurves *d = &o->app->drawn;
  Table *t = &o->app->table;
  const OverlaidRun *r = &o->runs[i];
  int col = o->n - 1 + i;
  if (!isfinite(r->rate)) return;
  t->cols[col] = t->cols[i];
  snprintf(t->cols[col].name, sizeof t->cols[col].name, "exp(%.3g t/s)", r->rate);
  d->x[d->n] = 0;
  d->y[d->n++] = col;
}

/* Column i of the picture's table := the distance of run i. room: [2 rows]. */
static int add_distances(Overlay *o, const double *scale, double *room) {
  Table *t = &o->app->table;
  size_t rows = o->runs[0].app.table.nrows;
  for (int i = 1; i < o->n; i++) {
    int n = 0;
    for (size_t at = 0; at < rows; at++) {
      double d = distance_at(o, &o->runs[i], at, scale);
      if (!(d > 0)) continue;
      room[n] = lag_table_cell(&o->runs[0].app.table, at, 0);
      room[rows + (size_t)n++] = log10(d);
    }
    fit_growth(&o->runs[i], n, room, room + rows);
    add_line(o, i);
    for (int k = 0; k < n; k++) {
      for (int c = 1; c < t->ncols; c++) o->app->row[c] = NAN;
      o->app->row[0] = room[k];
      o->app->row[i] = room[rows + (size_t)k];
      if (room[k] <= o->runs[i].until)
        o->app->row[o->n - 1 + i] = o->runs[i].level + o->runs[i].rate / log(10) * room[k];
      if (lag_table_add(t, o->app->row)) return lag_app_error(&o->app->args, "out of memory");
    }
    if (n == 0)
      lag_app_error(&o->app->args, "note: %s has no row at a time of the first run that differs from it",
                    o->runs[i].label);
  }
  return 0;
}

static int join_distances(Overlay *o) {
  App *app = o->app;
  int common, n = o->runs[0].app.drawn.n, rc = match_curves(o, &common);
  if (rc) return rc;
  if (o->n < 2) return lag_app_error(&app->args, "no other run is left to compare with %s", o->runs[0].label);
  size_t cols = 2 * (size_t)o->n - 1; /* the time, distances and their lines */
  app->table = (Table){.ncols = (int)cols, .cols = calloc(cols, sizeof *app->table.cols), .keep = 1};
  app->drawn = (PlottedCurves){
      .n = o->n - 1, .x = calloc(2 * cols, sizeof *app->drawn.x), .ylog = 1, .xname = "t", .yname = "distance"};
  app->row = calloc(cols, sizeof *app->row);
  double *room = calloc((size_t)n + 2 * o->runs[0].app.table.nrows + 1, sizeof *room);
  if (!app->table.cols || !app->drawn.x || !app->row || !room) rc = lag_app_error(&app->args, "out of memory");
  if (rc == 0) {
    const char *unit = find_scales(o, room);
    app->drawn.y = app->drawn.x + cols;
    app->table.cols[0] = o->runs[0].app.table.cols[0];
    for (int i = 1; i < o->n; i++) {
      Column *c = &app->table.cols[app->drawn.y[i - 1] = i];
      if (o->n > 2) snprintf(c->name, sizeof c->name, "%.95s", o->runs[i].label);
      else if (app->args.plot_y) snprintf(c->name, sizeof c->name, "distance of %.80s", app->args.plot_y);
      else strcpy(c->name, "distance");
      snprintf(c->unit, sizeof c->unit, "%s", unit);
    }
    rc = add_distances(o, room, room + n);
  }
  free(room);
  return rc;
}

/* ---- The report */

static void report_distance(const Overlay *o, const OverlaidRun *r) {
  const char *unit = o->app->table.cols[1].unit, *space = unit[0] ? " " : "";
  if (isnan(r->first)) printf("  no distance from the first");
  else
    printf("  distance from the first: %.3g%s%s at first, %.3g%s%s at most%s", r->first, space, unit, r->most, space,
           unit, o->scaled ? ", each output over the largest value of its unit" : "");
  if (isfinite(r->rate)) printf("; grows as exp(%.3g t/s) up to t = %.3g s", r->rate, r->until);
  putchar('\n');
}

/* The largest error of the energy as the picture shows it; else the drift or balance as a run reports it. */
static void report_energy(const Overlay *o, int i) {
  const App *whole = o->app;
  const int col = whole->args.energy_error ? whole->drawn.y[i] : 0;
  lag_charge_stats energy;
  double most = NAN;
  lag_sim_charge(o->runs[i].app.sim, 0, &energy);
  for (size_t at = 0; col && at < whole->table.nrows; at++) most = fmax(most, lag_table_cell(&whole->table, at, col));
  if (col)
    printf(", %s up to %.3g%s%s%s", whole->drawn.yname, isnan(most) ? 0 : pow(10, most),
           whole->table.cols[col].unit[0] ? " " : "", whole->table.cols[col].unit,
           energy.flags & (LAG_CONSERVED | LAG_BALANCED) ? "" : ", where the work of forces is not known");
  else if (isfinite(energy.drift))
    printf(i ? ", energy %s %.3g" : ", energy %s %.3g (%s)", lag_charge_word(&energy), energy.drift, lag_energy_scale);
}

static void report(const Overlay *o) {
  size_t widest = 0;
  if (o->app->args.starts) {
    printf("%d runs\npicture in %s\n", o->n, o->app->args.svg);
    return;
  }
  for (int i = 0; i < o->n; i++) widest = strlen(o->runs[i].label) > widest ? strlen(o->runs[i].label) : widest;
  for (int i = 0; i < o->n; i++) {
    const App *app = &o->runs[i].app;
    char method[200];
    lag_stats st;
    lag_sim_stats(app->sim, &st);
    lag_report_method(app, method, sizeof method);
    printf("%-*s  %s t = %.6g s, %lld steps", (int)widest, o->runs[i].label, app->status < 0 ? "FAILED at" : "reached",
           st.t, st.steps);
    report_energy(o, i);
    printf(o->runs[i].method ? "\n" : ", by %s\n", method);
    if (i && o->app->args.distance) report_distance(o, &o->runs[i]);
  }
  printf("picture in %s\n", o->app->args.svg);
}

int lag_app_overlay(App *app) {
  Overlay o = {.app = app};
  const Args *a = &app->args;
  char title[300];
  int rc = run_all(&o), interrupted = 0, failed = 0;
  rc = rc ? rc : a->distance ? join_distances(&o) : join(&o);
  if (rc == 0) {
    const App *first = &o.runs[0].app;
    snprintf(title, sizeof title, "%s%s%s", first->scene->model->name, a->nscenes > 1 ? "" : ": ",
             a->nscenes > 1 ? "" : first->scene->name);
    lag_table_scale_time(&app->table);
    if (a->energy_error) lag_energy_errors(app, first->sim);
    rc = lag_app_draw_table(app, title);
    if (rc == 0 && a->sketch) lag_sketch_write(stdout, &app->table, &app->drawn);
    if (rc == 0 && !a->quiet) report(&o);
  }
  for (int i = 0; i < o.n; i++) {
    interrupted |= o.runs[i].app.status == LAG_INTERRUPTED;
    failed += o.runs[i].app.status < 0;
    free_run(&o.runs[i]);
  }
  lag_free_all(o.runs, o.values, o.starts);
  return rc ? rc : interrupted ? lag_app_interrupted() : failed == o.n ? EXIT_RUN : EXIT_FINE;
}
