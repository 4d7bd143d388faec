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
  double *scale;           /* [reference.n] divisors of errors */
  CostMethod *method;      /* [nmethods] */
  int nmethods;
  double target;           /* error of --target; 0: none */
} Cost;

/* ---- The reference */

/* s := samples of a run by `method` at a tolerance. 0, or an exit status after a message. */
static int record_samples(App *app, const lag_method *method, double tol, Samples *s) {
  const Args *a = &app->args;
  lag_sim *sim = lag_app_fresh_sim(app);
  if (!sim) return lag_app_error(a, "out of memory");
  int rc = lag_sim_set_method(sim, method, NULL, 0);
  rc = rc ? rc : lag_sim_set_tolerance(sim, tol);
  rc = rc ? rc : lag_samples_take(s, sim);
  if (rc) lag_app_error(a, "the reference run by %s(tol=%g) failed: %s", method->name, tol, lag_sim_message(sim));
  lag_sim_free(sim);
  return rc ? EXIT_RUN : 0;
}

/* Reference by taylor, or by dop853 where the model has no Taylor series, at two tolerances; their difference is its uncertainty. */
static int compute_reference(App *app, Cost *c) {
  const lag_model *m = app->scene->model;
  int series = m->taylor && !m->constraints;
  const lag_method *method = series ? &lag_taylor_method : &lag_dop853;
  /* --reference serves at most 19 digits, so 22 suffice: for 1e-26 dop853 takes 2.6 times as many steps. */
  double rough_enough = app->args.reference ? 1e-22 : 0, tol = series ? 9 * DBL_EPSILON : fmax(pow(DBL_EPSILON, 0.75), rough_enough);
  Samples rough;
  int rc = lag_samples_init(&rough, c->reference.rows, c->reference.n) ? lag_app_error(&app->args, "out of memory") : 0;
  if (rc == 0) {
    memcpy(rough.t, c->reference.t, (size_t)rough.rows * sizeof(double));
    rc = record_samples(app, method, tol, &c->reference);
    rc = rc ? rc : record_samples(app, method, 10 * tol, &rough);
  }
  if (rc == 0) {
    lag_cost_scales(&c->reference, app->sim, c->scale);
    c->reference.uncertainty = fmax(lag_cost_error(&rough, &c->reference, c->scale), DBL_EPSILON);
  }
  lag_samples_free(&rough);
  snprintf(c->reference_name, sizeof c->reference_name, "%s, %d digits", method->name, (int)(DBL_MANT_DIG * 0.30103));
  return rc;
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
  if (good) lag_cost_scales(s, app->sim, c->scale);
  return good ? 0 : lag_app_error(a, "%s holds no reference for this scene; `--reference` of a simulator of the same model writes one",
                              strcmp(a->against, "-") == 0 ? "standard input" : a->against);
}

/* ---- Measurements */

/* Methods whose order is an option; each value is measured as a separate method. */
static const struct {
  const char *method, *option;
  int from, to, by;
} families[] = {{"variational", "order", 2, 8, 2}, {"gauss", "stages", 1, 4, 1}};
enum { NFAMILIES = sizeof families / sizeof *families };

static const char *knob_of(const lag_method *m) { return m->flags & LAG_METHOD_ADAPTIVE ? "tol" : "step"; }

static int add(Cost *c, const lag_method *m, lag_option option) {
  CostMethod *all = realloc(c->method, ((size_t)c->nmethods + 1) * sizeof *all);
  if (!all) return LAG_ENOMEM;
  c->method = all;
  CostMethod *new = &c->method[c->nmethods++];
  *new = (CostMethod){.method = m, .option = option};
  if (option.name) snprintf(new->name, sizeof new->name, "%s(%s=%g)", m->name, option.name, option.value);
  else snprintf(new->name, sizeof new->name, "%s", m->name);
  return LAG_OK;
}

/* Lists the methods of --methods, or all. */
static int list_methods(App *app, Cost *c) {
  const Args *a = &app->args;
  const lag_method *m;
  char name[64];
  int bad = 0;
  for (const char *s = a->methods; s && *s; s += strcspn(s, ", "), s += strspn(s, ", ")) {
    snprintf(name, sizeof name, "%.*s", (int)strcspn(s, ", "), s);
    if (!lag_app_find_method(app, name)) return lag_app_unknown_method(app, name);
  }
  for (int i = 0; (m = lag_app_method_at(app, i)) != NULL; i++) {
    size_t k = 0;
    if (a->methods && !lag_app_has_word(a->methods, m->name, strlen(m->name))) continue;
    while (k < NFAMILIES && strcmp(families[k].method, m->name) != 0) k++;
    if (k == NFAMILIES) bad |= add(c, m, (lag_option){0});
    for (int x = k < NFAMILIES ? families[k].from : 0; k < NFAMILIES && x <= families[k].to; x += families[k].by)
      bad |= add(c, m, (lag_option){.name = families[k].option, .value = x});
  }
  return bad ? lag_app_error(a, "out of memory") : 0;
}

static lag_sim *fresh(void *app) { return lag_app_fresh_sim(app); }

static int measure(App *app, Cost *c, double longest) {
  CostScene scene = {fresh, app, app->scene->t0};
  int rc = LAG_OK;
  for (int i = 0; i < c->nmethods && rc == LAG_OK; i++) {
    if (app->progress >= 0) fprintf(stderr, "\r\33[K%s (%d of %d)", c->method[i].method->name, i + 1, c->nmethods);
    rc = lag_cost_measure(&c->method[i], &scene, &c->reference, c->scale, longest);
  }
  if (app->progress >= 0) fputs("\r\33[K", stderr);
  lag_pareto_front(c->method, c->nmethods);
  return rc ? lag_app_error(&app->args, "out of memory") : 0;
}

/* ---- The report */

static void table(FILE *f, const Cost *c) {
  char setting[160], order[32], spread[32];
  fprintf(f, "  %-44s %-9s %12s %6s %10s %11s  %s\n", "", "error", "time [ms]", "+-", "steps", "calls", "order");
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    snprintf(order, sizeof order, isnan(m->order) ? "  -" : m->method->flags & LAG_METHOD_ADAPTIVE ? "  %.1f" : "  %.2f", m->order);
    for (int k = 0; k < m->nruns; k++) {
      const CostRun *r = &m->run[k];
      snprintf(setting, sizeof setting, "%.*s%s%s=%.9g)", (int)strcspn(m->name, ")"), m->name, m->option.name ? ", " : "(", knob_of(m->method),
               r->knob);
      snprintf(spread, sizeof spread, isnan(r->spread) ? "-" : "%.0f %%", 50 * r->spread);
      fprintf(f, "%c %-44s %-9.2e %12.4g %6s %10lld %11lld%s\n", r->best ? '*' : ' ', setting, r->error, 1e3 * r->time, spread, r->steps, r->calls,
              k == 0 ? order : "");
    }
  }
  fputs("* no other run is both faster and more accurate. time: median processor time; +- half of the interquartile range of the\n"
        "times. order: slope of log error against log steps, at the smallest errors above rounding\n", f);
}

/* A line for each method: its time for errors of 1e-2, 1e-4, ... */
static void print_time_table(FILE *f, const Cost *c) {
  enum { COLUMNS = 7 };
  fprintf(f, "\n  %-30s", "time [ms] for an error of");
  for (int e = 2; e <= 2 * COLUMNS; e += 2) fprintf(f, "%*s1e-%d", e < 10 ? 6 : 5, "", e);
  putc('\n', f);
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    if (m->nruns == 0) continue;
    fprintf(f, "  %-30s", m->name);
    for (int e = 1; e <= COLUMNS; e++) {
      const CostRun *own, *any;
      if (lag_cost_cheapest(m, 1, pow(10, -2 * e), &own)) {
        lag_cost_cheapest(c->method, c->nmethods, pow(10, -2 * e), &any);
        fprintf(f, " %8.3g%c", 1e3 * own->time, own == any ? '*' : ' ');
      } else {
        fprintf(f, " %8s ", "-");
      }
    }
    putc('\n', f);
  }
}

static void print_omitted(FILE *f, const Cost *c) {
  for (int i = 0; i < c->nmethods; i++) {
    const CostMethod *m = &c->method[i];
    const char *why = m->why[0] ? m->why : "no run had an error below 0.3 in the time allowed (--longest)";
    if (m->nruns == 0) fprintf(f, "not in the table: %s: %s\n", m->name, why);
  }
}

static void target(FILE *f, const App *app, const Cost *c) {
  const CostRun *run;
  const CostMethod *m = lag_cost_cheapest(c->method, c->nmethods, c->target, &run);
  char options[160];
  if (m) {
    const char *quote = m->option.name ? "\"" : "";
    snprintf(options, sizeof options, "--method %s%s%s --%s %.9g", quote, m->name, quote, knob_of(m->method), run->knob);
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
    lag_json_begin(&j, NULL, '{');
    lag_json_string(&j, "method", m->name);
    lag_json_number(&j, "order", m->order);
    lag_json_string(&j, "refused", m->why[0] ? m->why : NULL);
    lag_json_begin(&j, "runs", '[');
    for (int k = 0; k < m->nruns; k++) {
      const CostRun *r = &m->run[k];
      lag_json_begin(&j, NULL, '{');
      lag_json_number(&j, m->method->flags & LAG_METHOD_ADAPTIVE ? "tolerance" : "step", r->knob);
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
    strcpy(t.cols[y].name, m->name);
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

static int run_cost(App *app, Cost *c) {
  const Args *a = &app->args;
  double longest = 0.5;
  int rc = list_methods(app, c);
  if (rc == 0 && a->target && (!lag_args_number(a, "--target", a->target, "--target 1e-8", &c->target) || c->target <= 0))
    rc = lag_app_error(a, "--target %s: an error to reach, relative and positive; for example --target 1e-8", a->target);
  if (rc == 0 && a->longest && (!lag_args_number(a, "--longest", a->longest, "--longest 10", &longest) || longest <= 0))
    rc = lag_app_error(a, "--longest %s: a time in seconds, for example --longest 10", a->longest);
  rc = rc ? rc : a->against ? read_reference(app, c) : compute_reference(app, c);
  if (rc == 0 && c->reference.rows == 0)
    rc = lag_app_error(a, "an event ends the run before t = %g s, the first time of comparison; write --until with an earlier time", c->reference.t[0]);
  app->progress = isatty(2) && !a->quiet ? 0 : -1;
  rc = rc ? rc : measure(app, c, longest);
  return rc ? rc : show(app, c);
}

int lag_app_cost(App *app) {
  Cost cost = {0};
  int rc = lag_app_set_up_start(app);
  if (rc) return rc;
  double t0 = app->scene->t0, span = app->until - t0;
  int n = app->sim->pb.n, failed = lag_samples_init(&cost.reference, SAMPLES, n) || !(cost.scale = calloc((size_t)n + 1, sizeof *cost.scale));
  rc = failed ? lag_app_error(&app->args, "out of memory")
       : span == 0.0 ? lag_app_error(&app->args, "nothing to compute: the run begins and ends at t = %g s; write --until with another time", t0) : 0;
  for (int i = 0; i < SAMPLES && rc == 0; i++) cost.reference.t[i] = t0 + span * (i + 1) / SAMPLES;
  if (rc == 0 && !app->args.reference) {
    rc = run_cost(app, &cost);
  } else if (rc == 0 && (rc = compute_reference(app, &cost)) == 0) {
    write_reference(stdout, &cost);
    rc = fflush(stdout) ? lag_app_io_error(app, "standard output") : EXIT_FINE;
  }
  lag_samples_free(&cost.reference);
  free(cost.scale);
  free(cost.method);
  return rc;
}
