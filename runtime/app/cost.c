/* --cost: error and time of every method at many settings, against a reference. --reference: writes that reference,
 * for a simulator of lower precision. Enters: the command line; leaves: the runs, for cost_report.c and
 * cost_picture.c; or samples as text. Holds: times are processor time of this process. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/cost.h"
#include "core/core.h"
#include "io/posix.h"
#include "numeric/clock.h"

int lag_cost_begin(Cost *c, int rows, int n, double t0, double span) {
  if (lag_samples_init(&c->reference, rows, n) || !(c->scale = calloc((size_t)n + 1, sizeof *c->scale)))
    return LAG_ENOMEM;
  for (int i = 0; i < rows; i++) c->reference.t[i] = t0 + span * i / (rows - 1);
  return LAG_OK;
}

void lag_cost_end(Cost *c) {
  lag_samples_free(&c->reference);
  free(c->scale);
  free(c->method);
}

static int has_gone_far(void *steps, const lag_sim *sim) {
  (void)sim;
  return --*(long *)steps < 0 || lag_app_interrupted() != EXIT_SIGNAL;
}

double lag_cost_event_end(App *app) {
  const double tol = 1e-6;
  long steps = 50000;
  double t = app->until;
  lag_sim *sim = app->scene->model->nev ? lag_app_fresh_sim(app) : NULL;
  if (sim && lag_sim_set_method(sim, &lag_dop853, NULL, 0) == LAG_OK && lag_sim_set_tolerance(sim, tol) == LAG_OK) {
    lag_sim_on_step(sim, has_gone_far, &steps);
    if (lag_sim_advance(sim, app->until) == LAG_STOPPED) t = lag_sim_time(sim);
  }
  lag_sim_free(sim);
  return t;
}

/* ---- The reference */

/* Two runs of one method at two tolerances, side by side. */
typedef struct Pair {
  lag_sim *fine, *coarse;
  Samples *reference; /* of `fine` */
  double latest, used; /* processor time at which they are left, and that of `fine` [s] */
} Pair;

/* A simulation by this method at a tolerance; NULL after a message. */
static lag_sim *begin_run(App *app, const lag_method *method, double tol) {
  lag_sim *sim = lag_app_fresh_sim(app);
  int rc = sim ? lag_sim_set_method(sim, method, NULL, 0) : LAG_ENOMEM;
  rc = rc ? rc : lag_sim_set_tolerance(sim, tol);
  if (rc == 0) return sim;
  lag_app_error(&app->args, "the reference run by %s(tol=%g) failed: %s", method->name, tol,
                sim ? lag_sim_message(sim) : "out of memory");
  lag_sim_free(sim);
  return NULL;
}

static int note_step(void *pair, const lag_sim *sim) {
  Pair *p = pair;
  if (sim == p->fine) lag_samples_note(p->reference, p->fine);
  return lag_clock_seconds() > p->latest || lag_app_interrupted() != EXIT_SIGNAL;
}

/* y := state of sim at time t, or the output that is judged. LAG_OK, or what ended the run. */
static int take_row(lag_sim *sim, const Samples *like, double t, double *y) {
  Samples row = {.rows = 1, .n = like->n, .output = like->output, .t = &t, .y = y};
  int rc = lag_samples_take(&row, sim);
  return rc == LAG_OK && row.rows == 0 ? LAG_STOPPED : rc;
}

/* Rows of c->reference from both runs, as long as their difference, the uncertainty, stays small enough to judge
 * others by. Returns what ended it. */
static int fill_rows(Pair *p, Cost *c, lag_sim *like) {
  const double judges = c->target > 0 ? fmin(1e-4, 0.1 * c->target) : 1e-4;
  Samples *s = &c->reference;
  double *other = calloc((size_t)s->rows * (size_t)s->n + 1, sizeof *other);
  int rc = other ? LAG_OK : LAG_ENOMEM, asked = s->rows;
  Samples coarse = {.rows = s->rows, .n = s->n, .t = s->t, .y = other};
  s->uncertainty = DBL_EPSILON;
  for (int i = 0; i < asked && rc == LAG_OK; i++) {
    size_t at = (size_t)i * (size_t)s->n;
    double begin = lag_processor_seconds();
    rc = take_row(p->fine, s, s->t[i], s->y + at);
    p->used += lag_processor_seconds() - begin;
    rc = rc ? rc : take_row(p->coarse, s, s->t[i], other + at);
    s->rows = coarse.rows = i + (rc == LAG_OK);
    if (rc || (rc = lag_cost_scales(s, like, c->scale))) break;
    double uncertainty = fmax(lag_cost_error(&coarse, s, c->scale), DBL_EPSILON);
    if (i > 1 && uncertainty > judges) {
      s->rows = i;
      break;
    }
    s->uncertainty = uncertainty;
  }
  int scaled = s->rows ? lag_cost_scales(s, like, c->scale) : LAG_OK;
  free(other);
  return scaled ? scaled : rc;
}

/* Method and tolerance of the reference: taylor, or dop853 where the model has no Taylor series. */
static const lag_method *most_accurate(const App *app, double *tol) {
  const lag_model *m = app->scene->model;
  int series = m->taylor && !m->constraints;
  /* dop853 takes ten times as many steps for eight more digits, and with --reference serves doubles: 1e-17 suffices. */
  *tol = series ? 9 * DBL_EPSILON : app->args.reference ? fmax(100 * DBL_EPSILON, 1e-22) : pow(DBL_EPSILON, 0.75);
  return series ? &lag_taylor_method : &lag_dop853;
}

lag_sim *lag_cost_most_accurate(App *app) {
  double tol;
  const lag_method *method = most_accurate(app, &tol);
  return begin_run(app, method, tol);
}

int lag_cost_reference(App *app, Cost *c, double seconds, int *limited) {
  double tol;
  const lag_method *method = most_accurate(app, &tol);
  Pair p = {
      .fine = begin_run(app, method, tol), .reference = &c->reference, .latest = lag_clock_seconds() + seconds};
  p.coarse = p.fine ? begin_run(app, method, 10 * tol) : NULL;
  int rc = p.coarse ? LAG_OK : LAG_EINVAL;
  *limited = 0;
  if (rc == LAG_OK) {
    lag_sim_on_step(p.fine, note_step, &p);
    lag_sim_on_step(p.coarse, note_step, &p);
    rc = fill_rows(&p, c, app->sim);
    *limited = rc == LAG_INTERRUPTED;
    if (rc == LAG_ENOMEM) rc = lag_app_error(&app->args, "out of memory");
    else if (rc < 0 && c->reference.rows < 2)
      rc = lag_app_error(&app->args, "the reference run by %s(tol=%g) failed: %s", method->name, tol,
                         lag_sim_message(lag_sim_message(p.fine)[0] ? p.fine : p.coarse)) ? EXIT_RUN : 0;
    else if (*limited && c->reference.rows < 2)
      rc = lag_app_error(&app->args,
                         "the reference run by %s(tol=%g) takes more than %.3g s to t = %g s; allow more time: "
                         "--seconds %g, or end earlier: --until",
                         method->name, tol, seconds, c->reference.t[1], 10 * seconds)
               ? EXIT_RUN
               : 0;
    else rc = 0;
    c->precision[0] =
        (CostPrecision){.name = LAG_PRECISION, .epsilon = DBL_EPSILON, .seconds = p.used, .to = lag_sim_time(p.fine)};
  }
  lag_sim_free(p.fine);
  lag_sim_free(p.coarse);
  snprintf(c->reference_name, sizeof c->reference_name, "%s, %d digits", method->name, (int)(DBL_MANT_DIG * 0.30103));
  return rc;
}

/* --error residual: its scales, the largest rates of change along an accurate run. The residual itself should be 0. */
typedef struct Rates {
  lag_sim *sim;
  Samples *reference;
  double *now; /* [n] */
} Rates;

static int note_rates(void *rates, const lag_sim *sim) {
  Rates *w = rates;
  int bad = lag_rhs(&w->sim->pb, sim->run->t, sim->now, w->now);
  for (int i = 0; i < w->reference->n && !bad; i++)
    w->reference->largest[i] = fmax(w->reference->largest[i], fabs(w->now[i]));
  return bad || lag_app_interrupted() != EXIT_SIGNAL;
}

static int scale_residual(App *app, Cost *c) {
  const double differences = 1e-13; /* rounding of those that give the derivative */
  Samples *s = &c->reference;
  Rates w = {lag_cost_most_accurate(app), s, calloc((size_t)s->n + 1, sizeof(double))};
  int rc = w.sim && w.now ? LAG_OK : LAG_ENOMEM, rows = s->rows;
  if (rc == LAG_OK) lag_sim_on_step(w.sim, note_rates, &w);
  for (int i = 0; i < rows && rc == LAG_OK; i++) {
    rc = lag_sim_advance(w.sim, s->t[i]);
    s->rows = i + (rc == LAG_OK);
  }
  if (rc < 0 && w.sim && s->rows < 2)
    lag_app_error(&app->args, "--error residual: %s; end the run earlier: --until", lag_sim_message(w.sim));
  s->uncertainty = differences;
  if (lag_cost_scales(s, app->sim, c->scale) || !w.sim || !w.now) rc = LAG_ENOMEM;
  lag_sim_free(w.sim);
  free(w.now);
  if (rc == LAG_ENOMEM) return lag_app_error(&app->args, "out of memory");
  return rc < 0 && s->rows < 2 ? EXIT_RUN : 0;
}

static void write_reference(FILE *f, const Cost *c) {
  const Samples *s = &c->reference;
  fprintf(f, "samples %d %d\nby %s\nuncertainty %.17g\n", s->rows, s->n, c->reference_name, s->uncertainty);
  for (int k = 0; k < s->n; k++) fprintf(f, "%s%.17g", k ? " " : "largest ", s->largest[k]);
  putc('\n', f);
  for (int i = 0; i < s->rows; i++) {
    fprintf(f, "%.17g", s->t[i]);
    for (int k = 0; k < s->n; k++) fprintf(f, " %.17g", s->y[(size_t)i * (size_t)s->n + (size_t)k]);
    putc('\n', f);
  }
  const CostPrecision *p = &c->precision[0];
  fprintf(f, "precision %s %.17g %.9g %.17g\n", p->name, p->epsilon, p->seconds, p->to);
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
  FILE *f = strcmp(a->against, "-") == 0 ? stdin : lag_open_to_read(a->against);
  int rows, n, good;
  if (!f) return lag_app_error(a, "cannot read %s: %s", a->against, lag_read_error());
  good = fscanf(f, "samples %d %d by %95[^\n]", &rows, &n, c->reference_name) == 3 && rows > 0 && rows <= s->rows &&
         n == s->n;
  good = good && fscanf(f, " uncertainty") == 0 && read_number(f, &s->uncertainty);
  good = good && fscanf(f, " largest") == 0;
  for (int k = 0; good && k < n; k++) good = read_number(f, &s->largest[k]);
  for (int i = 0; good && i < rows; i++) {
    good = read_number(f, &s->t[i]);
    for (int k = 0; good && k < n; k++) good = read_number(f, &s->y[(size_t)i * (size_t)n + (size_t)k]);
  }
  s->rows = rows;
  for (CostPrecision p; good && c->nprecisions < LAG_COST_PRECISIONS && fscanf(f, " precision %15s", p.name) == 1;
       c->precision[c->nprecisions++] = p)
    good = read_number(f, &p.epsilon) && read_number(f, &p.seconds) && read_number(f, &p.to);
  if (f != stdin) fclose(f);
  if (good && lag_cost_scales(s, app->sim, c->scale)) return lag_app_error(a, "out of memory");
  return good
             ? 0
             : lag_app_error(
                   a, "%s holds no reference for this scene; `--reference` of a simulator of the same model writes one",
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

static int is_wanted(const Args *a, const char *name) {
  return !a->methods || lag_app_has_word(a->methods, name, strlen(name));
}

/* Whether each word of --methods is a method, or one at a value of its option that was listed. */
static int check_methods(App *app, const Cost *c) {
  char word[64], base[64];
  for (const char *s = app->args.methods; s && *s; s += strcspn(s, ", "), s += strspn(s, ", ")) {
    int known = 0;
    snprintf(word, sizeof word, "%.*s", (int)strcspn(s, ", "), s);
    snprintf(base, sizeof base, "%.*s", (int)strcspn(word, "("), word);
    if (!lag_app_find_method(app, base)) return lag_app_unknown_method(app, base);
    for (int i = 0; i < c->nmethods; i++)
      known |= strcmp(c->method[i].name, word) == 0 || strcmp(c->method[i].method->name, word) == 0;
    if (!known)
      return lag_app_error(&app->args,
                           "--methods %s: write %s, or a value of its option that lagc cost tries: "
                           "variational(order=2), 4, 6, 8; gauss(stages=1) to 4",
                           word, base);
  }
  return 0;
}

int lag_cost_list_methods(App *app, Cost *c) {
  const Args *a = &app->args;
  const lag_method *m;
  char name[64];
  int bad = 0;
  for (int i = 0; (m = lag_app_method_at(app, i)) != NULL; i++) {
    size_t k = 0;
    while (k < NFAMILIES && strcmp(families[k].method, m->name) != 0) k++;
    if (m->flags & LAG_METHOD_IMPULSES) {
      if (a->methods && is_wanted(a, m->name))
        return lag_app_error(a,
                             "--methods %s: lagc cost leaves it out, as impacts that it meets at other steps have no "
                             "error that falls with the step",
                             m->name);
      continue;
    }
    if (k == NFAMILIES && is_wanted(a, m->name)) bad |= add(c, m, (lag_option){0});
    for (int x = k < NFAMILIES ? families[k].from : 0; k < NFAMILIES && x <= families[k].to; x += families[k].by) {
      snprintf(name, sizeof name, "%s(%s=%d)", m->name, families[k].option, x);
      if (is_wanted(a, m->name) || is_wanted(a, name))
        bad |= add(c, m, (lag_option){.name = families[k].option, .value = x});
    }
  }
  c->named = a->methods && c->nmethods <= LAG_COST_FAMILIES;
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
  /* what reference and precisions have left */
  double left = fmax(c->seconds - (lag_clock_seconds() - c->begun), 0.3 * c->seconds);
  ProgressLine p = {app, left, 0, -1};
  CostSweep sweep = {.method = c->method,
                     .n = c->nmethods, .scene = {fresh, app, app->scene->t0}, .reference = &c->reference,
                     .scale = c->scale, .seconds = left, .target = c->target, .note = note_progress,
                     .context = &p};
  lag_app_catch_interrupt();
  int rc = lag_cost_sweep(&sweep);
  c->stopped = lag_app_interrupted() != EXIT_SIGNAL;
  if (app->progress >= 0) fputs("\r\33[K", stderr);
  return rc ? lag_app_error(&app->args, "out of memory") : 0;
}

/* LAG_OK where `lagc run` would accept this run: its monitors, and an energy that is kept. */
static int judge_run(App *app, Cost *c, const CostMethod *m, const CostRun *run) {
  CostMethod own = *m;
  int rc;
  lag_sim *sim = lag_cost_prepare(&own, &(CostScene){fresh, app, app->scene->t0}, run->knob, &rc);
  if (!sim) return rc;
  rc = lag_sim_advance(sim, c->reference.t[c->reference.rows - 1]);
  rc = rc < 0 ? rc : lag_sim_judge(sim);
  if (rc < 0) snprintf(c->monitor, sizeof c->monitor, "%s", lag_sim_message(sim));
  lag_sim_free(sim);
  return rc < 0 ? rc : LAG_OK;
}

/* Marks the answers that `lagc run` would refuse, until none is. After MOST of them all runs with such an error are
 * marked. */
static void check_answers(App *app, Cost *c) {
  enum { MOST = 40 };
  static const double errors[] = {1e-3, 1e-6, 1e-9, 1e-12};
  const lag_scene *own = app->scene;
  int n = c->target > 0 ? 1 : sizeof errors / sizeof *errors;
  app->scene = app->whole;
  for (int i = 0, tries = 0; i < n;) {
    const CostRun *run;
    double error = c->target > 0 ? c->target : errors[i];
    const CostMethod *m = lag_cost_answer(c->method, c->nmethods, error, &run);
    int bad = m && tries < MOST && judge_run(app, c, m, run) < 0;
    tries += bad;
    if (bad) ((CostRun *)run)->stopped = 1;
    for (int x = 0; bad && tries == MOST && x < c->nmethods; x++)
      for (int y = 0; y < c->method[x].nruns; y++)
        c->method[x].run[y].stopped |= c->method[x].run[y].error <= errors[0] || c->target > 0;
    i += !bad;
  }
  app->scene = own;
}

/* ---- The command */

static int show(App *app, Cost *c) {
  const Args *a = &app->args;
  const CostRun *run;
  char title[300];
  snprintf(title, sizeof title, "%s, %s: what accuracy costs", app->scene->model->name, app->scene->name);
  if (a->json) lag_cost_put_json(stdout, app, c);
  else if (!a->quiet) lag_cost_put_text(stdout, app, c);
  if (a->out && lag_outfile_has_suffix(a->out, "svg png")) {
    if (lag_app_picture(app, a->out, title, lag_cost_put_picture, c)) return EXIT_USAGE;
  } else if (a->out && lag_cost_put_rows(a->out, app, c)) return lag_app_io_error(app, a->out);
  if (c->stopped) return lag_app_interrupted();
  if (c->target > 0 && !lag_cost_answer(c->method, c->nmethods, c->target, &run)) return EXIT_RUN;
  return EXIT_FINE;
}

static int run_cost(App *app, Cost *c) {
  const Args *a = &app->args;
  int limited = 0, rc = lag_cost_list_methods(app, c);
  if (rc == 0)
    rc = lag_args_positive(a, "--target", a->target, "--target 1e-8", "an error to reach, relative and positive",
                           &c->target);
  rc = rc ? rc : lag_app_check_outputs(app);
  app->progress = isatty(2) && !a->quiet ? 0 : -1;
  rc = rc                                            ? rc
       : c->reference.output == LAG_SAMPLES_RESIDUAL ? scale_residual(app, c)
       : a->against                                  ? read_reference(app, c)
                                                     : lag_cost_reference(app, c, 0.4 * c->seconds, &limited);
  if (rc == 0 && c->reference.rows < 2)
    rc = lag_app_error(
        a, "an event ends the run before t = %g s, the first time of comparison; write --until with an earlier time",
        c->reference.t[1]);
  if (rc == 0) {
    double last = c->reference.t[c->reference.rows - 1];
    c->reached = last == app->until ? NAN : last;
  }
  if (rc == 0 && a->realtime) {
    lag_app_catch_interrupt();
    return lag_app_realtime(app, c);
  }
  if (rc == 0 && c->reference.output != LAG_SAMPLES_RESIDUAL && lag_cost_precisions(app, c, 0.1 * c->seconds))
    rc = lag_app_error(a, "out of memory");
  rc = rc ? rc : measure(app, c);
  if (rc == 0) check_answers(app, c);
  return rc ? rc : show(app, c);
}

/* 1 + number of the output of this name; -1: there is none. */
static int find_output(const App *app, const char *name) {
  for (int i = 0; i < app->scene->nout; i++)
    if (strcmp(app->scene->outputs[i].name, name) == 0) return i + 1;
  return -1;
}

int lag_app_cost(App *app) {
  Cost cost = {.seconds = 10, .begun = lag_clock_seconds(), .reached = NAN};
  const Args *a = &app->args;
  int limited, rc = lag_app_set_up_start(app);
  if (rc) return rc;
  const double before = 0.98; /* of a run that an event ends: coarse settings miss its time a little */
  double t0 = app->scene->t0, span = app->until - t0;
  int final = a->error && strcmp(a->error, "final") == 0, residual = a->error && strcmp(a->error, "residual") == 0,
      rows = final ? 2 : LAG_COST_ROWS;
  int output = residual ? LAG_SAMPLES_RESIDUAL : a->error && !final ? find_output(app, a->error) : 0;
  cost.event = lag_cost_event_end(app);
  if (cost.event != app->until) span = before * (cost.event - t0);
  if (output < 0 && !residual)
    return lag_app_error(a,
                         "--error %s: no such output; lagc cost takes any expression of the model, `energy` among "
                         "them, `final` or `residual`",
                         a->error);
  int failed = lag_cost_begin(&cost, rows, output > 0 ? 1 : app->sim->pb.n, t0, span);
  rc = failed ? lag_app_error(a, "out of memory") : span == 0.0 ? lag_app_no_span(app) : 0;
  if (rc == 0)
    rc = lag_args_positive(a, "--seconds", a->seconds, "--seconds 60", "the time to spend", &cost.seconds);
  cost.reference.output = output;
  if (rc == 0 && !a->reference) {
    rc = run_cost(app, &cost);
  } else if (rc == 0 && (rc = lag_cost_reference(app, &cost, cost.seconds, &limited)) == 0) {
    write_reference(stdout, &cost);
    rc = limited ? EXIT_RUN : EXIT_FINE;
  }
  lag_cost_end(&cost);
  return rc;
}
