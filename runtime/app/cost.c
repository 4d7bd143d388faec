/* --cost: error and time of every method at many settings, against a reference. --reference: writes that reference, for a
 * simulator of lower precision. Enters: the command line; leaves: a table, JSON, a picture; or samples as text. Holds: times are
 * processor time of this process. */
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "analysis/work_precision.h"
#include "app/app.h"
#include "core/core.h"

enum { SAMPLES = 16 };

typedef struct Cost {
  Samples reference;
  char reference_name[96]; /* "taylor, 34 digits" */
  CostMethod *method;      /* [nmethods] */
  int nmethods;
  double target;           /* error of --target; 0: none */
} Cost;

/* The scene without monitors and closed forms, which would end a rough run early or cost time besides the method. */
typedef struct BareScene {
  App *app;
  lag_scene scene;
} BareScene;

/* A new simulation of the bare scene with the values of the command line; NULL: no memory, or a message. */
static lag_sim *new_simulation(void *context) {
  BareScene *b = context;
  App *app = b->app;
  app->sim = lag_sim_new(&b->scene);
  if (app->sim && lag_app_set_values(app)) {
    lag_sim_free(app->sim);
    app->sim = NULL;
  }
  lag_sim *sim = app->sim;
  app->sim = NULL;
  return sim;
}

/* ---- The reference */

/* s := samples of a run by `method` at a tolerance. 0, or an exit status after a message. */
static int record_samples(BareScene *b, const lag_method *method, double tol, Samples *s) {
  const Args *a = &b->app->args;
  lag_sim *sim = new_simulation(b);
  if (!sim) return lag_app_error(a, "out of memory");
  int rc = lag_sim_set_method(sim, method, NULL, 0);
  rc = rc ? rc : lag_sim_set_tolerance(sim, tol);
  rc = rc ? rc : lag_samples_take(s, sim);
  if (rc) lag_app_error(a, "the reference run by %s(tol=%g) failed: %s", method->name, tol, lag_sim_message(sim));
  lag_sim_free(sim);
  return rc ? EXIT_RUN : 0;
}

/* Reference by taylor, or by dop853 where the model has no Taylor series, at two tolerances; their difference is its uncertainty. */
static int compute_reference(BareScene *b, Cost *c) {
  App *app = b->app;
  const lag_model *m = b->scene.model;
  int series = m->taylor && !m->constraints, n = c->reference.n;
  const lag_method *method = series ? &lag_taylor_method : &lag_dop853;
  /* --reference serves at most 19 digits, so 22 suffice: for 1e-26 dop853 takes 2.6 times as many steps. */
  double rough_enough = app->args.reference ? 1e-22 : 0;
  double tol = series ? 9 * DBL_EPSILON : fmax(pow(DBL_EPSILON, 0.75), rough_enough), *scale = calloc((size_t)n + 1, sizeof *scale);
  Samples rough;
  int rc = lag_samples_init(&rough, c->reference.rows, n) || !scale ? lag_app_error(&app->args, "out of memory") : 0;
  if (rc == 0) {
    memcpy(rough.t, c->reference.t, (size_t)rough.rows * sizeof(double));
    rc = record_samples(b, method, tol, &c->reference);
    rc = rc ? rc : record_samples(b, method, 10 * tol, &rough);
  }
  if (rc == 0) {
    lag_sim *sim = new_simulation(b);
    if (sim) {
      lag_cost_scales(&c->reference, sim, scale);
      c->reference.uncertainty = fmax(lag_cost_error(&rough, &c->reference, scale), DBL_EPSILON);
    }
    lag_sim_free(sim);
  }
  lag_samples_free(&rough);
  free(scale);
  snprintf(c->reference_name, sizeof c->reference_name, "%s, %d digits", method->name, (int)(DBL_MANT_DIG * 0.30103));
  return rc;
}

/* Sample times, equally spaced over the run. */
static int choose_times(App *app, Cost *c) {
  double t0 = app->scene->t0, t1 = app->until;
  if (t1 == t0) return lag_app_error(&app->args, "nothing to compute: the run begins and ends at t = %g s; write --until with another time", t0);
  for (int i = 0; i < SAMPLES; i++) c->reference.t[i] = t0 + (t1 - t0) * (i + 1) / SAMPLES;
  return 0;
}

static void write_reference(FILE *f, const Cost *c) {
  const Samples *s = &c->reference;
  fprintf(f, "samples %d %d\nby %s\nuncertainty %.17g\n", s->rows, s->n, c->reference_name, s->uncertainty);
  for (int i = 0; i < s->rows; i++) {
    fprintf(f, "%.17g", s->t[i]);
    for (int k = 0; k < s->n; k++) fprintf(f, " %.17g", s->y[(size_t)i * (size_t)s->n + (size_t)k]);
    putc('\n', f);
  }
}

/* *x := next number in the file. 0: there is none. */
static int read_number(FILE *f, double *x) {
  char word[128], *end;
  if (fscanf(f, "%127s", word) != 1) return 0;
  *x = strtod(word, &end);
  return *end == '\0';
}

static int read_reference(App *app, Cost *c) {
  const Args *a = &app->args;
  Samples *s = &c->reference;
  FILE *f = strcmp(a->against, "-") == 0 ? stdin : fopen(a->against, "r");
  int rows, n, good;
  if (!f) return lag_app_error(a, "cannot read %s: %s", a->against, strerror(errno));
  good = fscanf(f, "samples %d %d by %95[^\n]", &rows, &n, c->reference_name) == 3 && rows > 0 && rows <= s->rows && n == s->n;
  good = good && fscanf(f, " uncertainty") == 0 && read_number(f, &s->uncertainty);
  for (int i = 0; good && i < rows; i++) {
    good = read_number(f, &s->t[i]);
    for (int k = 0; good && k < n; k++) good = read_number(f, &s->y[(size_t)i * (size_t)n + (size_t)k]);
  }
  s->rows = rows;
  if (f != stdin) fclose(f);
  return good ? 0 : lag_app_error(a, "%s holds no reference for this scene; `--reference` of a simulator of the same model writes one",
                              strcmp(a->against, "-") == 0 ? "standard input" : a->against);
}

/* ---- Measurements */

/* Methods whose order is an option; each value is measured as a separate method. */
static const struct {
  const char *method, *option;
  int from, to, by;
} families[] = {{"variational", "order", 2, 8, 2}, {"gauss", "stages", 1, 4, 1}};

/* Whether --methods names the method, or is not given. */
static int is_selected(const Args *a, const lag_method *m) {
  size_t n = strlen(m->name);
  for (const char *s = a->methods ? a->methods : m->name; *s; s += strcspn(s, ", "), s += strspn(s, ", "))
    if (strcspn(s, ", ") == n && strncmp(s, m->name, n) == 0) return 1;
  return 0;
}

static int add(Cost *c, const lag_method *m, lag_option option) {
  CostMethod *all = realloc(c->method, ((size_t)c->nmethods + 1) * sizeof *all);
  if (!all) return LAG_ENOMEM;
  c->method = all;
  c->method[c->nmethods++] = (CostMethod){.method = m, .option = option};
  return LAG_OK;
}

static int list_methods(App *app, Cost *c) {
  const lag_method *m;
  int bad = 0;
  for (int i = 0; (m = lag_app_method_at(app, i)) != NULL; i++) {
    int plain = 1;
    for (size_t k = 0; is_selected(&app->args, m) && k < sizeof families / sizeof *families; k++)
      for (int x = families[k].from; strcmp(families[k].method, m->name) == 0 && x <= families[k].to; x += families[k].by) {
        bad |= add(c, m, (lag_option){.name = families[k].option, .value = x});
        plain = 0;
      }
    if (plain && is_selected(&app->args, m)) bad |= add(c, m, (lag_option){0});
  }
  if (c->nmethods == 0) return lag_app_error(&app->args, "--methods %s: none of them is a method; --method help lists them", app->args.methods);
  return bad ? lag_app_error(&app->args, "out of memory") : 0;
}

/* Refuses unknown names in --methods. */
static int check_methods(App *app) {
  const Args *a = &app->args;
  char name[64];
  for (const char *s = a->methods; s && *s; s += strcspn(s, ", "), s += strspn(s, ", ")) {
    snprintf(name, sizeof name, "%.*s", (int)strcspn(s, ", "), s);
    if (!lag_app_find_method(app, name)) return lag_app_unknown_method(app, name);
  }
  return 0;
}

static int measure(BareScene *b, Cost *c, double longest) {
  App *app = b->app;
  double *scale = calloc((size_t)c->reference.n + 1, sizeof *scale);
  lag_sim *sim = new_simulation(b);
  int rc = scale && sim ? LAG_OK : LAG_ENOMEM;
  CostScene scene = {new_simulation, b, b->scene.t0};
  if (rc == LAG_OK) lag_cost_scales(&c->reference, sim, scale);
  for (int i = 0; i < c->nmethods && rc == LAG_OK; i++) {
    if (app->progress >= 0) {
      fprintf(stderr, "\r\33[K%s (%d of %d)", c->method[i].method->name, i + 1, c->nmethods);
      fflush(stderr);
    }
    rc = lag_cost_measure(&c->method[i], &scene, &c->reference, scale, longest);
  }
  if (app->progress >= 0) fputs("\r\33[K", stderr);
  lag_sim_free(sim);
  free(scale);
  lag_pareto_front(c->method, c->nmethods);
  return rc ? lag_app_error(&app->args, "out of memory") : 0;
}

/* ---- The report */

static int adaptive(const CostMethod *m) { return (m->method->flags & LAG_METHOD_ADAPTIVE) != 0; }

/* text[n] := the method with its option, "variational(order=4)". */
static void name_of(const CostMethod *m, char *text, size_t n) {
  if (m->option.name) snprintf(text, n, "%s(%s=%g)", m->method->name, m->option.name, m->option.value);
  else snprintf(text, n, "%s", m->method->name);
}

/* text[n] := the setting of a run, "rk45(tol=1e-06)", "variational(order=4, step=0.01)". */
static void setting_of(const CostMethod *m, const CostRun *run, char *text, size_t n) {
  char option[64] = "";
  if (m->option.name) snprintf(option, sizeof option, "%s=%g, ", m->option.name, m->option.value);
  snprintf(text, n, "%s(%s%s=%.9g)", m->method->name, option, adaptive(m) ? "tol" : "step", run->knob);
}

/* text[n] := the same as options of a run, `--method rk45 --tol 1e-06`, `--method "variational(order=4)" --step 0.01`. */
static void options_of(const CostMethod *m, const CostRun *run, char *text, size_t n) {
  char name[96];
  name_of(m, name, sizeof name);
  snprintf(text, n, "--method %s%s%s --%s %.9g", m->option.name ? "\"" : "", name, m->option.name ? "\"" : "", adaptive(m) ? "tol" : "step", run->knob);
}

static const char *order_of(const CostMethod *m, char *text, size_t n) {
  snprintf(text, n, adaptive(m) ? "%.1f" : "%.2f", m->order);
  return isnan(m->order) ? "-" : text;
}

static void table(FILE *f, const Cost *c) {
  char setting[160], order[32], spread[32];
  fprintf(f, "  %-44s %-9s %12s %6s %10s %11s  %s\n", "", "error", "time [ms]", "+-", "steps", "calls", "order");
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    for (int k = 0; k < m->nruns; k++) {
      const CostRun *r = &m->run[k];
      setting_of(m, r, setting, sizeof setting);
      snprintf(spread, sizeof spread, "%.0f %%", 50 * r->spread);
      fprintf(f, "%c %-44s %-9.2e %12.4g %6s %10lld %11lld%s%s\n", r->best ? '*' : ' ', setting, r->error, 1e3 * r->time,
              isnan(r->spread) ? "-" : spread, r->steps, r->calls, k == 0 ? "  " : "", k == 0 ? order_of(m, order, sizeof order) : "");
    }
  }
  fputs("* no other run is both faster and more accurate. time: median processor time; +- half of the interquartile range of the\n"
        "times. order: slope of log error against log steps, at the smallest errors above rounding\n", f);
}

/* The fastest run of a method with at most this error; NULL: none. */
static const CostRun *fastest(const CostMethod *m, double error) {
  const CostRun *best = NULL;
  return lag_cost_cheapest(m, 1, error, &best) ? best : NULL;
}

/* A line for each method: its time for errors of 1e-2, 1e-4, ... */
static void print_time_table(FILE *f, const Cost *c) {
  enum { COLUMNS = 7 };
  char name[96];

  fprintf(f, "\n  %-30s", "time [ms] for an error of");
  for (int e = 1; e <= COLUMNS; e++) {
    snprintf(name, sizeof name, "1e-%d", 2 * e);
    fprintf(f, " %9s", name);
  }
  putc('\n', f);
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    if (m->nruns == 0) continue;
    name_of(m, name, sizeof name);
    fprintf(f, "  %-30s", name);
    for (int e = 1; e <= COLUMNS; e++) {
      const double error = pow(10, -2 * e);
      const CostRun *own = fastest(m, error), *any;
      if (own) {
        lag_cost_cheapest(c->method, c->nmethods, error, &any);
        fprintf(f, " %8.3g%c", 1e3 * own->time, own == any ? '*' : ' ');
      } else {
        fprintf(f, " %8s ", "-");
      }
    }
    putc('\n', f);
  }
}

static void print_omitted(FILE *f, const Cost *c) {
  char name[96];
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    if (m->nruns == 0) {
      name_of(m, name, sizeof name);
      fprintf(f, "not in the table: %s: %s\n", name, m->why[0] ? m->why : "no run had an error below 0.3 in the time allowed (--longest)");
    }
  }
}

static void target(FILE *f, const App *app, const Cost *c) {
  const CostRun *run;
  const CostMethod *m = lag_cost_cheapest(c->method, c->nmethods, c->target, &run);
  char options[160];
  if (m) {
    options_of(m, run, options, sizeof options);
    fprintf(f, "\ncheapest setting for an error of %g: %s (error %.2e, %.4g ms)\n  lagc run %s %s %s\n", c->target, options, run->error,
            1e3 * run->time, app->program->source, app->scene->name, options);
  } else {
    fprintf(f, "\nno setting has an error of %g or less; raise --target, or allow longer runs: --longest SECONDS\n", c->target);
  }
}

static void put_text(FILE *f, const App *app, const Cost *c) {
  const Samples *s = &c->reference;
  fprintf(f, "model %s, scene %s, to t = %.15g s\n", app->scene->model->name, app->scene->name, s->t[s->rows - 1]);
  fprintf(f, "error: the largest difference from the reference at %d times, relative to the largest value of its kind and unit\n", s->rows);
  fprintf(f, "reference: %s, itself uncertain by %.1e\n\n", c->reference_name, s->uncertainty);
  table(f, c);
  print_time_table(f, c);
  print_omitted(f, c);
  if (c->target > 0) target(f, app, c);
}

/* ---- JSON */

static void put_json(FILE *f, const App *app, const Cost *c) {
  const Samples *s = &c->reference;
  const CostRun *cheapest = NULL;
  if (c->target > 0) lag_cost_cheapest(c->method, c->nmethods, c->target, &cheapest);
  Json j = {.f = f};
  lag_json_begin(&j, NULL, '{');
  lag_json_string(&j, "model", app->scene->model->name);
  lag_json_string(&j, "scene", app->scene->name);
  lag_json_number(&j, "until", s->t[s->rows - 1]);
  lag_json_string(&j, "reference", c->reference_name);
  lag_json_number(&j, "uncertainty", s->uncertainty);
  lag_json_number(&j, "target", c->target > 0 ? c->target : NAN);
  lag_json_begin(&j, "methods", '[');
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    char name[96];
    name_of(m, name, sizeof name);
    lag_json_begin(&j, NULL, '{');
    lag_json_string(&j, "method", name);
    lag_json_number(&j, "order", m->order);
    lag_json_string(&j, "refused", m->why[0] ? m->why : NULL);
    lag_json_begin(&j, "runs", '[');
    for (int k = 0; k < m->nruns; k++) {
      const CostRun *r = &m->run[k];
      lag_json_begin(&j, NULL, '{');
      lag_json_number(&j, adaptive(m) ? "tolerance" : "step", r->knob);
      lag_json_number(&j, "error", r->error);
      lag_json_number(&j, "seconds", r->time);
      lag_json_number(&j, "spread", r->spread);
      lag_json_count(&j, "steps", r->steps);
      lag_json_count(&j, "calls", r->calls);
      lag_json_truth(&j, "front", r->best);
      lag_json_truth(&j, "cheapest", r == cheapest);
      lag_json_end(&j, '}');
    }
    lag_json_end(&j, ']');
    lag_json_end(&j, '}');
  }
  lag_json_end(&j, ']');
  lag_json_end(&j, '}');
  putc('\n', f);
}

/* ---- Picture */

/* Writes the SVG picture, time against error. -1 with errno set. */
static int put_picture(const char *path, const App *app, const Cost *c) {
  enum { ROWS = LAG_COST_MOST_RUNS };
  size_t width = 2 * (size_t)c->nmethods + 1;
  Table t = {.ncols = (int)width, .nrows = ROWS, .cols = calloc(width, sizeof *t.cols), .data = calloc(ROWS * width, sizeof *t.data)};
  PlottedCurves d = {.x = calloc(2 * width, sizeof *d.x), .xname = "error", .yname = "processor time", .powers = 1};
  char title[300];
  int rc = -1;

  d.y = d.x ? d.x + width : NULL;
  for (int i = 0; t.cols && t.data && d.x && i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    int x = 2 * d.n + 1, y = x + 1;
    if (m->nruns == 0) continue;
    strcpy(t.cols[x].name, "error");
    name_of(m, t.cols[y].name, sizeof t.cols[y].name);
    strcpy(t.cols[y].unit, "s");
    for (int k = 0; k < ROWS; k++) {
      t.data[(size_t)k * width + (size_t)x] = k < m->nruns ? log10(fmax(m->run[k].error, DBL_EPSILON / 1024)) : NAN;
      t.data[(size_t)k * width + (size_t)y] = k < m->nruns ? log10(m->run[k].time) : NAN;
    }
    d.x[d.n] = x;
    d.y[d.n++] = y;
  }
  snprintf(title, sizeof title, "%s, %s: time against error", app->scene->model->name, app->scene->name);
  if (t.cols && t.data && d.x) rc = lag_svg_write(path, &t, title, &d);
  lag_table_free(&t);
  free(d.x);
  return rc;
}

/* ---- The command */

static int show(App *app, const Cost *c) {
  const Args *a = &app->args;
  const CostRun *run;
  if (a->json) put_json(stdout, app, c);
  else if (!a->quiet) put_text(stdout, app, c);
  if (a->svg && put_picture(a->svg, app, c)) return lag_app_io_error(app, a->svg);
  if (fflush(stdout)) return lag_app_io_error(app, "standard output");
  if (c->target > 0 && !lag_cost_cheapest(c->method, c->nmethods, c->target, &run)) return EXIT_RUN;
  return EXIT_FINE;
}

static int run_cost(BareScene *b, Cost *c) {
  App *app = b->app;
  const Args *a = &app->args;
  double longest = 0.5;
  int rc = check_methods(app);
  if (rc == 0 && a->target && (!lag_args_number(a, "--target", a->target, "--target 1e-8", &c->target) || c->target <= 0))
    rc = lag_app_error(a, "--target %s: an error to reach, relative and positive; for example --target 1e-8", a->target);
  if (rc == 0 && a->longest && (!lag_args_number(a, "--longest", a->longest, "--longest 10", &longest) || longest <= 0))
    rc = lag_app_error(a, "--longest %s: a time in seconds, for example --longest 10", a->longest);
  rc = rc ? rc : a->against ? read_reference(app, c) : compute_reference(b, c);
  if (rc == 0 && c->reference.rows == 0)
    rc = lag_app_error(a, "an event ends the run before t = %g s, the first time of comparison; write --until with an earlier time", c->reference.t[0]);
  rc = rc ? rc : list_methods(app, c);
  app->progress = isatty(2) && !a->quiet ? 0 : -1;
  rc = rc ? rc : measure(b, c, longest);
  return rc ? rc : show(app, c);
}

int lag_app_cost(App *app) {
  Cost cost = {0};
  int rc = lag_app_set_up_start(app);
  BareScene b = {.app = app};
  if (rc == 0) {
    b.scene = *app->scene;
    b.scene.nmonitors = b.scene.nexact = 0;
    lag_sim_free(app->sim);
    app->sim = NULL;
    rc = lag_samples_init(&cost.reference, SAMPLES, 2 * b.scene.model->nq + b.scene.model->nz) ? lag_app_error(&app->args, "out of memory") : 0;
  }
  rc = rc ? rc : choose_times(app, &cost);
  if (rc == 0 && app->args.reference) {
    rc = compute_reference(&b, &cost);
    if (rc == 0) {
      write_reference(stdout, &cost);
      rc = fflush(stdout) ? lag_app_io_error(app, "standard output") : EXIT_FINE;
    }
  } else if (rc == 0) {
    rc = run_cost(&b, &cost);
  }
  lag_samples_free(&cost.reference);
  free(cost.method);
  return rc;
}
