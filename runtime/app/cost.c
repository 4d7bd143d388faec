/* --cost: error and time of every method at many settings, against a reference. --reference: writes that reference, for a
 * simulator of lower precision. Enters: the command line; leaves: the runs, for cost_report.c and cost_picture.c; or samples as text. Holds: times
 * are processor time of this process. */
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "app/cost.h"
#include "core/core.h"

enum { SAMPLES = 16 };

/* ---- The reference */

/* Two runs of one method at two tolerances, side by side. */
typedef struct Pair {
  lag_sim *fine, *coarse;
  double latest; /* processor time at which they are left [s] */
} Pair;

/* A simulation by this method at a tolerance; NULL after a message. */
static lag_sim *begin_run(App *app, const lag_method *method, double tol) {
  lag_sim *sim = lag_app_fresh_sim(app);
  int rc = sim ? lag_sim_set_method(sim, method, NULL, 0) : LAG_ENOMEM;
  rc = rc ? rc : lag_sim_set_tolerance(sim, tol);
  if (rc == 0) return sim;
  lag_app_error(&app->args, "the reference run by %s(tol=%g) failed: %s", method->name, tol, sim ? lag_sim_message(sim) : "out of memory");
  lag_sim_free(sim);
  return NULL;
}

static int is_too_late(void *pair, const lag_sim *sim) {
  (void)sim;
  return lag_processor_seconds() > ((Pair *)pair)->latest || lag_app_interrupted() != EXIT_SIGNAL;
}

/* y := state of sim at time t, or the output that is judged. LAG_OK, or what ended the run. */
static int take_row(lag_sim *sim, const Samples *like, double t, double *y) {
  Samples row = {.rows = 1, .n = like->n, .output = like->output, .t = &t, .y = y};
  int rc = lag_samples_take(&row, sim);
  return rc == LAG_OK && row.rows == 0 ? LAG_STOPPED : rc;
}

/* Rows of c->reference from both runs, as long as their difference, the uncertainty, stays small enough to judge others by. Returns what ended it. */
static int fill_rows(Pair *p, Cost *c, const lag_sim *like) {
  const double judges = 1e-4;
  Samples *s = &c->reference;
  double *other = calloc((size_t)s->rows * (size_t)s->n + 1, sizeof *other);
  int rc = other ? LAG_OK : LAG_ENOMEM, asked = s->rows;
  Samples coarse = {.rows = s->rows, .n = s->n, .t = s->t, .y = other};
  s->uncertainty = DBL_EPSILON;
  for (int i = 0; i < asked && rc == LAG_OK; i++) {
    size_t at = (size_t)i * (size_t)s->n;
    rc = take_row(p->fine, s, s->t[i], s->y + at);
    rc = rc ? rc : take_row(p->coarse, s, s->t[i], other + at);
    s->rows = coarse.rows = i + (rc == LAG_OK);
    if (rc) break;
    lag_cost_scales(s, like, c->scale);
    double uncertainty = fmax(lag_cost_error(&coarse, s, c->scale), DBL_EPSILON);
    if (i > 1 && uncertainty > judges) {
      s->rows = i;
      break;
    }
    s->uncertainty = uncertainty;
  }
  if (s->rows) lag_cost_scales(s, like, c->scale);
  free(other);
  return rc;
}

/* Reference by taylor, or by dop853 where the model has no Taylor series, at two tolerances; their difference is its uncertainty. It ends where
 * that is too large or, after `seconds` of processor time, with the rows that it has: then *limited = 1. */
static int compute_reference(App *app, Cost *c, double seconds, int *limited) {
  const lag_model *m = app->scene->model;
  int series = m->taylor && !m->constraints;
  const lag_method *method = series ? &lag_taylor_method : &lag_dop853;
  /* dop853 takes ten times as many steps for eight more digits, and with --reference serves doubles: 1e-17 suffices. */
  double tol = series ? 9 * DBL_EPSILON : app->args.reference ? fmax(100 * DBL_EPSILON, 1e-22) : pow(DBL_EPSILON, 0.75);
  Pair p = {.fine = begin_run(app, method, tol), .latest = lag_processor_seconds() + seconds};
  p.coarse = p.fine ? begin_run(app, method, 10 * tol) : NULL;
  int rc = p.coarse ? LAG_OK : LAG_EINVAL;
  *limited = 0;
  if (rc == LAG_OK) {
    lag_sim_on_step(p.fine, is_too_late, &p);
    lag_sim_on_step(p.coarse, is_too_late, &p);
    rc = fill_rows(&p, c, app->sim);
    *limited = rc == LAG_INTERRUPTED;
    if (rc == LAG_ENOMEM) rc = lag_app_error(&app->args, "out of memory");
    else if (rc < 0 && c->reference.rows < 2)
      rc = lag_app_error(&app->args, "the reference run by %s(tol=%g) failed: %s", method->name, tol,
                         lag_sim_message(lag_sim_message(p.fine)[0] ? p.fine : p.coarse)) ? EXIT_RUN : 0;
    else if (*limited && c->reference.rows < 2)
      rc = lag_app_error(&app->args, "the reference run by %s(tol=%g) takes more than %.3g s to t = %g s; allow more time: --seconds %g, or end earlier: --until",
                         method->name, tol, seconds, c->reference.t[1], 10 * seconds) ? EXIT_RUN : 0;
    else rc = 0;
  }
  lag_sim_free(p.fine);
  lag_sim_free(p.coarse);
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

static int is_wanted(const Args *a, const char *name) { return !a->methods || lag_app_has_word(a->methods, name, strlen(name)); }

/* Whether each word of --methods is a method, or one at a value of its option that was listed. */
static int check_methods(App *app, const Cost *c) {
  char word[64], base[64];
  for (const char *s = app->args.methods; s && *s; s += strcspn(s, ", "), s += strspn(s, ", ")) {
    int known = 0;
    snprintf(word, sizeof word, "%.*s", (int)strcspn(s, ", "), s);
    snprintf(base, sizeof base, "%.*s", (int)strcspn(word, "("), word);
    if (!lag_app_find_method(app, base)) return lag_app_unknown_method(app, base);
    for (int i = 0; i < c->nmethods; i++) known |= strcmp(c->method[i].name, word) == 0 || strcmp(c->method[i].method->name, word) == 0;
    if (!known) return lag_app_error(&app->args, "--methods %s: write %s, or a value of its option that lagc cost tries: variational(order=2), 4, 6, 8; gauss(stages=1) to 4", word, base);
  }
  return 0;
}

/* Lists the methods of --methods, or all. */
static int list_methods(App *app, Cost *c) {
  const Args *a = &app->args;
  const lag_method *m;
  char name[64];
  int bad = 0;
  for (int i = 0; (m = lag_app_method_at(app, i)) != NULL; i++) {
    size_t k = 0;
    while (k < NFAMILIES && strcmp(families[k].method, m->name) != 0) k++;
    if (k == NFAMILIES && is_wanted(a, m->name)) bad |= add(c, m, (lag_option){0});
    for (int x = k < NFAMILIES ? families[k].from : 0; k < NFAMILIES && x <= families[k].to; x += families[k].by) {
      snprintf(name, sizeof name, "%s(%s=%d)", m->name, families[k].option, x);
      if (is_wanted(a, m->name) || is_wanted(a, name)) bad |= add(c, m, (lag_option){.name = families[k].option, .value = x});
    }
  }
  return bad ? lag_app_error(a, "out of memory") : check_methods(app, c);
}

static lag_sim *fresh(void *app) { return lag_app_fresh_sim(app); }

/* ProgressLine line, at most ten times a second; Ctrl-C ends the sweep. */
typedef struct ProgressLine {
  App *app;
  double seconds, part, shown; /* to spend [s]; part used; its value as shown */
} ProgressLine;

static int note_progress(void *progress, const CostMethod *m, double part) {
  enum { WIDTH = 30 };
  static const char bar[] = "##############################..............................";
  ProgressLine *p = progress;
  if (part >= 0) p->part = fmin(part, 1);
  if (p->app->progress >= 0 && p->part - p->shown > 0.1 / p->seconds) {
    int done = (int)(p->part * WIDTH);
    fprintf(stderr, "\r\33[K[%.*s] %.0f s left: %s", WIDTH, bar + WIDTH - done, p->seconds * (1 - p->part), m->name);
    p->shown = p->part;
  }
  return lag_app_interrupted() != EXIT_SIGNAL;
}

static int measure(App *app, Cost *c) {
  ProgressLine p = {app, c->seconds, 0, -1};
  CostSweep sweep = {.method = c->method, .n = c->nmethods, .scene = {fresh, app, app->scene->t0}, .reference = &c->reference, .scale = c->scale,
                     .seconds = c->seconds, .target = c->target, .note = note_progress, .context = &p};
  lag_app_catch_interrupt();
  int rc = lag_cost_sweep(&sweep);
  c->stopped = lag_app_interrupted() != EXIT_SIGNAL;
  if (app->progress >= 0) fputs("\r\33[K", stderr);
  return rc ? lag_app_error(&app->args, "out of memory") : 0;
}

/* ---- The command */

static int show(App *app, const Cost *c) {
  const Args *a = &app->args;
  const CostRun *run;
  if (a->json) lag_cost_put_json(stdout, app, c);
  else if (!a->quiet) lag_cost_put_text(stdout, app, c);
  if (a->out) {
    int svg = lag_outfile_has_suffix(a->out, "svg"), rc = svg ? lag_cost_put_picture(a->out, app, c) : lag_cost_put_rows(a->out, app, c);
    if (rc) return lag_app_io_error(app, a->out);
  }
  if (fflush(stdout)) return lag_app_io_error(app, "standard output");
  if (c->stopped) return lag_app_interrupted();
  if (c->target > 0 && !lag_cost_cheapest(c->method, c->nmethods, c->target, &run)) return EXIT_RUN;
  return EXIT_FINE;
}

static int run_cost(App *app, Cost *c) {
  const Args *a = &app->args;
  int limited = 0, rc = list_methods(app, c);
  if (rc == 0 && a->target && (!lag_args_number(a, "--target", a->target, "--target 1e-8", &c->target) || c->target <= 0))
    rc = lag_app_error(a, "--target %s: an error to reach, relative and positive; for example --target 1e-8", a->target);
  rc = rc ? rc : lag_app_check_outputs(app);
  double asked = c->reference.t[c->reference.rows - 1];
  app->progress = isatty(2) && !a->quiet ? 0 : -1;
  rc = rc ? rc : a->against ? read_reference(app, c) : compute_reference(app, c, 0.4 * c->seconds, &limited);
  if (rc == 0 && c->reference.rows < 2)
    rc = lag_app_error(a, "an event ends the run before t = %g s, the first time of comparison; write --until with an earlier time", c->reference.t[1]);
  if (rc == 0) {
    double last = c->reference.t[c->reference.rows - 1];
    c->reached = last == asked ? NAN : last;
  }
  if (rc == 0 && a->realtime) {
    lag_app_catch_interrupt();
    return lag_app_realtime(app, c);
  }
  rc = rc ? rc : measure(app, c);
  return rc ? rc : show(app, c);
}

/* 1 + number of the output of this name; -1: there is none. */
static int find_output(const App *app, const char *name) {
  for (int i = 0; i < app->scene->nout; i++)
    if (strcmp(app->scene->outputs[i].name, name) == 0) return i + 1;
  return -1;
}

int lag_app_cost(App *app) {
  Cost cost = {.seconds = 10, .reached = NAN};
  const Args *a = &app->args;
  int limited, rc = lag_app_set_up_start(app);
  if (rc) return rc;
  double t0 = app->scene->t0, span = app->until - t0;
  int final = a->error && strcmp(a->error, "final") == 0, output = a->error && !final ? find_output(app, a->error) : 0, rows = (final ? 1 : SAMPLES) + 1; /* the start among them, for the scales */
  if (output < 0) return lag_app_error(a, "--error %s: no such output; lagc cost takes any expression of the model, `energy` among them, or `final`", a->error);
  int n = output ? 1 : app->sim->pb.n, failed = lag_samples_init(&cost.reference, rows, n) || !(cost.scale = calloc((size_t)n + 1, sizeof *cost.scale));
  rc = failed ? lag_app_error(a, "out of memory")
       : span == 0.0 ? lag_app_error(a, "nothing to compute: the run begins and ends at t = %g s; write --until with another time", t0) : 0;
  if (rc == 0 && a->seconds && (!lag_args_number(a, "--seconds", a->seconds, "--seconds 60", &cost.seconds) || cost.seconds <= 0))
    rc = lag_app_error(a, "--seconds %s: the time to spend, for example --seconds 60", a->seconds);
  cost.reference.output = output;
  for (int i = 0; i < rows && rc == 0; i++) cost.reference.t[i] = t0 + span * i / (rows - 1);
  if (rc == 0 && !a->reference) {
    rc = run_cost(app, &cost);
  } else if (rc == 0 && (rc = compute_reference(app, &cost, cost.seconds, &limited)) == 0) {
    write_reference(stdout, &cost);
    rc = fflush(stdout) ? lag_app_io_error(app, "standard output") : limited ? EXIT_RUN : EXIT_FINE;
  }
  lag_samples_free(&cost.reference);
  free(cost.scale);
  free(cost.method);
  return rc;
}
