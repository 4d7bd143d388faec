/* --cloud: starts on an ellipse around the scene's start, carried along by each method, drawn at several times in
 * the plane of two quantities. Enters: the command line; leaves: the picture, the area inside the cloud at each
 * time, an exit status. Holds: the plane is that of the drawn columns, where these are components of the state; with
 * one coordinate it is that of the coordinate and its rate or momentum, whatever is drawn over it. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/effect_variants.h"
#include "app/app.h"
#include "core/core.h"

enum { LEAST_STARTS = 8, MOST_STARTS = 10000, MOST_TIMES = 100, SAMPLES = 400, TIMES = 5 };

typedef struct Cloud {
  App *app;          /* the command line; its table and curves are those of the picture */
  App run;           /* the method at work: set up, its table without rows */
  int asked, n, times, reached; /* starts of the command line; of the method at work; times at which they are drawn;
                                   those that all starts of the method at work have reached */
  double part;       /* half-axes of the ellipse, as a part of the half-range of the motion */
  double until, every;
  int component[2];  /* of the state, that are displaced, */
  double centre[2], half[2]; /* their starts and half-axes, in declared units */
  double *xy;        /* [times][2][n] drawn values of the method at work */
  char **names;      /* [methods]; NULL: the scene's */
  int methods;
  char title[300];
} Cloud;

/* Area inside the smooth closed curve through every k-th point of x[n], y[n], the contour integral of (x dy - y
 * dx)/2 with derivatives of the trigonometric interpolant (L.N. Trefethen, Spectral Methods in MATLAB (2000), ch. 3,
 * DOI 10.1137/1.9780898719598). */
static double area_of(int n, int k, const double *x, const double *y) {
  const double pi = acos(-1);
  double sum = 0;
  int m = n / k;
  for (int i = 0; i < m; i++)
    for (int j = i + 1; j < m; j++) {
      double half = (j - i) * pi / m, slope = ((j - i) % 2 ? -1 : 1) / (2 * (m % 2 ? sin(half) : tan(half)));
      sum += slope * (x[k * j] * y[k * i] - x[k * i] * y[k * j]);
    }
  return 2 * pi / m * sum;
}

/* ---- Setup */

/* N, or N:PART. */
static int read_size(Cloud *c) {
  const Args *a = &c->app->args;
  char number[64];
  const char *colon = strchr(a->cloud, ':');
  long long n;
  snprintf(number, sizeof number, "%.*s", (int)(colon ? colon - a->cloud : 60), a->cloud);
  if (lag_args_count(a, "--cloud", number, "--cloud 60", &n)) return EXIT_USAGE;
  if (n < LEAST_STARTS || n > MOST_STARTS)
    return lag_app_error(a, "--cloud %s: from %d to %d starts", a->cloud, LEAST_STARTS, MOST_STARTS);
  if (lag_args_positive(a, "--cloud", colon ? colon + 1 : NULL, "--cloud 60:0.1",
                        "after the colon stands the size of the cloud, as a part of the motion's", &c->part))
    return EXIT_USAGE;
  c->asked = c->n = (int)n;
  return 0;
}

static int read_times(Cloud *c) {
  const Args *a = &c->app->args;
  c->until = c->run.until;
  c->every = (c->until - c->run.scene->t0) / (TIMES - 1);
  if (lag_args_positive(a, "--every", a->every, "--every 1", "the time between two clouds must be positive", &c->every))
    return EXIT_USAGE;
  c->every = copysign(c->every, c->until - c->run.scene->t0);
  double times = floor(lag_app_row_at(&c->run, (double[]){c->run.scene->t0, fabs(c->every)}, c->until)) + 1;
  if (times > MOST_TIMES)
    return lag_app_error(a, "--every %g: that makes %.0f clouds; %d can be told apart at most", c->every, times,
                         MOST_TIMES);
  c->times = (int)times;
  c->xy = calloc((size_t)c->times * 2 * (size_t)c->n, sizeof *c->xy);
  return c->xy ? 0 : lag_app_error(a, "out of memory");
}

/* Sets up the simulation of a method, and finds the drawn columns. */
static int set_up(Cloud *c, const char *method) {
  App *run = &c->run;
  *run = lag_app_like(c->app);
  run->args.method = method;
  int rc = lag_app_set_up(run);
  if (rc) return rc;
  if (lag_table_init(&run->table, run->sim, 0) || !(run->row = calloc((size_t)run->table.ncols, sizeof *run->row)))
    return lag_app_error(&run->args, "out of memory");
  return lag_app_choose_curves(run);
}

static const char *drawn_name(const Cloud *c, int axis) {
  return c->run.table.cols[(axis ? c->run.drawn.y : c->run.drawn.x)[0]].name;
}

static int choose_plane(Cloud *c) {
  const lag_model *m = c->run.scene->model;
  if (m->constraints)
    return lag_app_error(&c->app->args, "--cloud: the model has constraints, and displaced starts would break them; "
                                        "write it in coordinates without constraints");
  for (int axis = 0; axis < 2; axis++) c->component[axis] = lag_component_index(m, drawn_name(c, axis));
  int x = c->component[0], other = c->run.sim->pb.n == 2 && x >= 0 ? 1 - x : -1;
  if (c->component[1] < 0 || c->component[1] == x) c->component[1] = other;
  for (int axis = 0; axis < 2; axis++)
    if (c->component[axis] < 0)
      return lag_app_error(&c->app->args,
                           "--cloud: starts are displaced along coordinates, velocities or states, and %s is none: "
                           "give two by --x and --y",
                           drawn_name(c, axis));
  return 0;
}

/* Half-axes of the ellipse: parts of half of the range of the displaced components along the scene's motion, by
 * dop853. */
static int find_half_axes(Cloud *c) {
  lag_sim *sim = lag_app_fresh_sim(&c->run);
  double least[2], most[2];
  int rc = sim ? lag_sim_set_method(sim, &lag_dop853, NULL, 0) : LAG_ENOMEM;
  for (int i = 0; i <= SAMPLES && rc >= 0; i++) {
    rc = lag_sim_advance(sim, c->run.scene->t0 + (c->until - c->run.scene->t0) * i / SAMPLES);
    for (int axis = 0; axis < 2 && rc >= 0; axis++) {
      double x = lag_sim_state_value(sim, c->component[axis]);
      c->centre[axis] = i ? c->centre[axis] : x;
      least[axis] = i ? fmin(least[axis], x) : x;
      most[axis] = i ? fmax(most[axis], x) : x;
    }
    if (rc > 0) break;
  }
  if (rc < 0) rc = lag_app_error(&c->app->args, "%s", sim ? lag_sim_message(sim) : "out of memory");
  for (int axis = 0; axis < 2 && rc >= 0 && rc != EXIT_USAGE; axis++) {
    c->half[axis] = c->part * (most[axis] - least[axis]) / 2;
    if (!(c->half[axis] > 0))
      rc =
          lag_app_error(&c->app->args,
                        "--cloud: %s does not change along the motion, which gives the cloud its size; start elsewhere",
                        lag_state_column(sim, c->component[axis]).name);
  }
  lag_sim_free(sim);
  return rc < 0 ? EXIT_RUN : rc == EXIT_USAGE ? rc : 0;
}

/* ---- The runs */

/* Carries start i along; its drawn values into c->xy, up to a failure, which a warning tells. 0, or EXIT_USAGE after
 * a message. */
static int carry(Cloud *c, lag_sim *sim, int i) {
  const double pi = acos(-1), angle = 2 * pi * i / c->n;
  int rc = sim ? lag_app_copy_method(c->run.sim, sim, 1) : LAG_ENOMEM, k = 0;
  for (int axis = 0; axis < 2 && rc == 0; axis++)
    rc = lag_sim_set(sim, lag_state_column(sim, c->component[axis]).name,
                     c->centre[axis] + c->half[axis] * (axis ? sin(angle) : cos(angle)));
  if (rc)
    return lag_app_error(&c->app->args, "start %d of %d: %s", i + 1, c->n,
                         sim ? lag_sim_message(sim) : "out of memory");
  for (; k < c->times && rc == 0; k++) {
    double *to = c->xy + 2 * (size_t)(k * c->n);
    rc = lag_sim_advance(sim, c->run.scene->t0 + k * c->every);
    rc = rc ? rc : lag_sim_outputs(sim, c->run.row + 1);
    if (rc) break;
    to[i] = c->run.row[c->run.drawn.x[0]];
    to[c->n + i] = c->run.row[c->run.drawn.y[0]];
  }
  if (k < c->reached)
    lag_app_error(&c->app->args, "warning: %s, start %d of %d: %s; its cloud is drawn up to then",
                  lag_sim_method(sim)->name, i + 1, c->n, rc < 0 ? lag_sim_message(sim) : "an event stops it");
  c->reached = k < c->reached ? k : c->reached;
  return 0;
}

static int carry_all(Cloud *c) {
  int rc = 0;
  c->reached = c->times;
  for (int i = 0; i < c->n && rc == 0; i++) {
    lag_sim *sim = lag_app_fresh_sim(&c->run);
    rc = carry(c, sim, i);
    lag_sim_free(sim);
  }
  return rc;
}

static double area_at(const Cloud *c, int k, int *coarse);

/* Carries the starts that were asked for along, and twice as many as often as areas are not determined, up to
 * MOST_AREA. */
static int carry_enough(Cloud *c) {
  enum { MOST_AREA = 4000 };
  for (c->n = c->asked;; c->n *= 2) {
    double *room = realloc(c->xy, (size_t)c->times * 2 * (size_t)c->n * sizeof *c->xy);
    if (!room) return lag_app_error(&c->app->args, "out of memory");
    c->xy = room;
    int rc = carry_all(c), coarse = 0;
    for (int k = 1; k < c->reached && rc == 0 && !coarse; k++) area_at(c, k, &coarse);
    if (rc || !coarse || 2 * c->n > MOST_AREA || lag_app_interrupted() != EXIT_SIGNAL) return rc;
  }
}

/* ---- The picture and the report */

static int open_table(Cloud *c) {
  Table *t = &c->app->table;
  PlottedCurves *d = &c->app->drawn;
  size_t m = (size_t)c->methods;
  *t = (Table){.ncols = 1 + 2 * c->methods, .cols = calloc(1 + 2 * m, sizeof *t->cols), .keep = 1};
  *d = (PlottedCurves){.n = c->methods,
                       .x = calloc(2 * m, sizeof *d->x),
                       .xname = c->app->args.plot_x,
                       .yname = c->app->args.plot_y,
                       .runs = c->methods};
  c->app->row = calloc(1 + 2 * m, sizeof *c->app->row);
  if (!t->cols || !d->x || !c->app->row) return lag_app_error(&c->app->args, "out of memory");
  d->y = d->x + c->methods;
  t->cols[0] = c->run.table.cols[0];
  return 0;
}

/* Writes the times beside the clouds of the last method: each in the middle of its cloud. */
static int note_times(Cloud *c) {
  PlottedCurves *d = &c->app->drawn;
  free(d->note);
  d->nnotes = 0;
  if (!(d->note = calloc((size_t)c->reached + 1, sizeof *d->note)))
    return lag_app_error(&c->app->args, "out of memory");
  for (int k = 0; k < c->reached; k++) {
    const double *from = c->xy + 2 * (size_t)(k * c->n);
    PictureNote *note = &d->note[d->nnotes++];
    for (int i = 0; i < c->n; i++) {
      note->x += from[i] / c->n;
      note->y += from[c->n + i] / c->n;
    }
    snprintf(note->text, sizeof note->text, "%.4g s", c->run.scene->t0 + k * c->every);
  }
  return 0;
}

/* The closed curve of each time, with an empty row behind it. */
static int add_curves(Cloud *c, int method) {
  Table *t = &c->app->table;
  PlottedCurves *d = &c->app->drawn;
  t->cols[d->x[method] = 1 + 2 * method] = c->run.table.cols[c->run.drawn.x[0]];
  t->cols[d->y[method] = 2 + 2 * method] = c->run.table.cols[c->run.drawn.y[0]];
  if (c->methods > 1) snprintf(t->cols[d->y[method]].name, sizeof t->cols->name, "%.95s", c->names[method]);
  for (int k = 0; k < c->reached; k++)
    for (int i = 0; i <= c->n + 1; i++) {
      const double *from = c->xy + 2 * (size_t)(k * c->n);
      for (int col = 1; col < t->ncols; col++) c->app->row[col] = NAN;
      c->app->row[0] = c->run.scene->t0 + k * c->every;
      c->app->row[d->x[method]] = i > c->n ? NAN : from[i % c->n];
      c->app->row[d->y[method]] = i > c->n ? NAN : from[c->n + i % c->n];
      if (lag_table_add(t, c->app->row)) return lag_app_error(&c->app->args, "out of memory");
    }
  return 0;
}

/* The area at time k; *coarse: half of the points have another one, so that the curve through them is too coarse. */
static double area_at(const Cloud *c, int k, int *coarse) {
  const double rough = 1e-3; /* of the first area */
  const double *x = c->xy + 2 * (size_t)(k * c->n), *first = c->xy;
  double area = area_of(c->n, 1, x, x + c->n);
  *coarse = k && c->n % 2 == 0 &&
            fabs(area_of(c->n, 2, x, x + c->n) - area) > rough * fabs(area_of(c->n, 1, first, first + c->n));
  return area;
}

/* Areas at the times that all starts have reached. */
static void report_areas(const Cloud *c, int method) {
  double first = 0;
  int coarse = 0;
  if (c->app->args.quiet) return;
  printf("%s: area of %d starts", c->names[method] ? c->names[method] : lag_sim_method(c->run.sim)->name, c->n);
  for (int k = 0; k < c->reached; k++) {
    int bad;
    double area = area_at(c, k, &bad), t = c->run.scene->t0 + k * c->every;
    first = k ? first : area;
    coarse |= bad;
    if (k == 0) printf(" %.6g at first; times", fabs(area));
    else if (bad) printf("%s ? at t = %.6g s", k == 1 ? "" : ",", t);
    else printf("%s %.9g at t = %.6g s", k == 1 ? "" : ",", area / first, t);
  }
  printf(coarse ? "; ?: not determined by %d starts: fewer times, --until, or a smaller cloud, --cloud %d:0.01\n"
                : "\n",
         c->n, c->asked);
}

static int one_method(Cloud *c, int method) {
  int rc = set_up(c, c->names[method]);
  if (method == 0) {
    rc = rc ? rc : read_times(c);
    rc = rc ? rc : choose_plane(c);
    rc = rc ? rc : find_half_axes(c);
    rc = rc ? rc : open_table(c);
    if (rc == 0)
      snprintf(c->title, sizeof c->title, "%s: %s, %d starts, drawn each %.6g s", c->run.scene->model->name,
               c->run.scene->name, c->asked, fabs(c->every));
  }
  rc = rc ? rc : carry_enough(c);
  rc = rc ? rc : add_curves(c, method);
  rc = rc ? rc : note_times(c);
  if (rc == 0) report_areas(c, method);
  lag_app_free(&c->run);
  return rc;
}

/* c->names := the methods of --method, with commas between them; NULL: the scene's, named when set up. */
static int split_methods(Cloud *c) {
  const char *list = c->app->args.method;
  c->names = calloc((list ? strlen(list) : 0) + 1, sizeof *c->names);
  for (; c->names && list; list = lag_app_next_method(list)) {
    char *name = calloc(lag_app_method_length(list) + 1, 1);
    if (!(c->names[c->methods++] = name)) return lag_app_error(&c->app->args, "out of memory");
    memcpy(name, list, lag_app_method_length(list));
  }
  if (!c->methods) c->methods = 1;
  return c->names ? 0 : lag_app_error(&c->app->args, "out of memory");
}

int lag_app_cloud(App *app) {
  Cloud c = {.app = app, .part = 0.1};
  int rc = read_size(&c);
  rc = rc ? rc : split_methods(&c);
  rc = rc ? rc : lag_app_try_file(app, app->args.svg);
  for (int k = 0; k < c.methods && rc == 0; k++) rc = one_method(&c, k);
  if (rc == 0) {
    rc = lag_app_draw_table(app, c.title);
    if (rc == 0 && !app->args.quiet) printf("picture in %s\n", app->args.svg);
  }
  for (int k = 0; k < c.methods && c.names; k++) free(c.names[k]);
  free(c.names);
  free(c.xy);
  return rc;
}
