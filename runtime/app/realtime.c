/* --cost --realtime H: which method of equal steps suits a program that must make a step of H in time. Enters: a
 * reference; leaves: for each method the error with step H, the largest step that stays with the motion, and the
 * time a step takes, at worst. Holds: the time of each step is the least of five runs of it, so that what the system
 * does in between counts only if it meets the same step five times. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/cost.h"
#include "core/core.h"
#include "numeric/clock.h"

enum { MOST_METHODS = 24, RUNS = 5, WATCHED = 1 << 18 };
/* A motion with this error has left the reference. */
static const double lost = 0.3;

typedef struct FixedStep {
  const lag_method *method;
  lag_option option[3];
  int noptions;
  char name[64];
  double error;         /* with the step that was asked; NaN: no result (why) */
  double largest;       /* step [s]; 0: none was found */
  double mean, worst;   /* processor time of a step [s] */
  double latest;        /* end of its part of --seconds: processor time */
  char why[160];
  /* 1: `lagc run` would refuse this run (why): a monitor of the scene, or an energy that is lost */
  int refused;
  int cut; /* 1: longer steps were not tried, for want of time */
} FixedStep;

/* Processor time of each step, or only the time that a run may take. */
typedef struct StepClock {
  double last, latest;        /* end of the last step; when the run is left [s] */
  double *least;              /* [WATCHED] or NULL: of each step, the least time so far */
  double whole;               /* of the run [s] */
  long long steps;
} StepClock;

static int note_step(void *clock, const lag_sim *sim) {
  enum { SOME = 64 };
  StepClock *c = clock;
  (void)sim;
  if (!c->least && ++c->steps % SOME) return 0; /* reading the clock takes as long as many steps */
  double now = lag_processor_seconds();
  if (c->least && c->steps < WATCHED) c->least[c->steps] = fmin(c->least[c->steps], now - c->last);
  c->steps++;
  c->last = lag_processor_seconds();
  return c->last > c->latest || lag_app_interrupted() != EXIT_SIGNAL;
}

/* The least time between two readings of the clock. */
static double clock_cost(void) {
  double least = HUGE_VAL;
  for (int i = 0; i < 1000; i++) {
    double a = lag_processor_seconds(), b = lag_processor_seconds();
    least = fmin(least, b - a);
  }
  return least;
}

/* The error of a run with this step; NAN, and why := its failure. each: 1: each step is timed, to clock->least. */
static double run_with(App *app, const Cost *c, FixedStep *x, double step, int each, Samples *own, StepClock *clock) {
  double error = NAN;
  lag_sim *sim = lag_app_fresh_bare_sim(app);
  lag_stats st;
  x->option[x->noptions] = (lag_option){.name = "step", .value = step};
  int rc = sim ? lag_sim_set_method(sim, x->method, x->option, x->noptions + 1) : LAG_ENOMEM;
  if (rc == LAG_OK) {
    double now = lag_processor_seconds();
    *clock = (StepClock){.last = now, .latest = now + 0.1 * c->seconds, .least = clock->least};
    if (each) lag_sim_on_step(sim, note_step, clock);
    own->rows = c->reference.rows;
    rc = lag_samples_take(own, sim);
    clock->whole = lag_processor_seconds() - now;
    lag_sim_stats(sim, &st);
    clock->steps = st.steps;
  }
  if (rc == LAG_INTERRUPTED) snprintf(x->why, sizeof x->why, "a run took longer than %.2g s", 0.1 * c->seconds);
  else if (rc) snprintf(x->why, sizeof x->why, "%.150s", sim ? lag_sim_message(sim) : "out of memory");
  else error = lag_cost_error(own, &c->reference, c->scale);
  lag_sim_free(sim);
  return rc == LAG_OK && own->rows == c->reference.rows ? error : NAN;
}

static void measure(App *app, const Cost *c, FixedStep *x, double step, double overhead, double *least, Samples *own) {
  StepClock clock = {.least = least};
  double error = NAN;
  x->error = NAN;
  for (int i = 0; i < WATCHED; i++) least[i] = HUGE_VAL;
  for (int i = 0; i < RUNS; i++) {
    double now = lag_processor_seconds();
    if (i > 0 && now > (i == 1 ? c->seconds : x->latest)) break;
    if (isnan(error = run_with(app, c, x, step, 1, own, &clock))) break;
    x->error = error;
  }
  if (isnan(x->error)) return;
  for (int i = 0; i < WATCHED && least[i] < HUGE_VAL; i++) x->worst = fmax(x->worst, least[i] - overhead);
  clock.least = NULL;
  if (!isnan(run_with(app, c, x, step, 0, own, &clock))) x->mean = clock.whole / (double)clock.steps;
  x->why[0] = '\0';
}

/* Notes whether `lagc run` would refuse the run with this step. */
static void judge(App *app, const Cost *c, FixedStep *x, double step) {
  const lag_scene *own = app->scene;
  app->scene = app->whole;
  lag_sim *sim = lag_app_fresh_sim(app);
  app->scene = own;
  x->option[x->noptions] = (lag_option){.name = "step", .value = step};
  int rc = sim ? lag_sim_set_method(sim, x->method, x->option, x->noptions + 1) : LAG_ENOMEM;
  rc = rc ? rc : lag_sim_advance(sim, c->reference.t[c->reference.rows - 1]);
  rc = rc < 0 ? rc : lag_sim_judge(sim);
  x->refused = rc < 0;
  if (rc < 0) snprintf(x->why, sizeof x->why, "refused: %.140s", sim ? lag_sim_message(sim) : "out of memory");
  lag_sim_free(sim);
}

/* The largest step of H 2^k/2 that stays with the motion, upwards from one that does, or downwards to one. */
static void find_largest(App *app, const Cost *c, FixedStep *x, double step, Samples *own) {
  const double factor = sqrt(2), span = fabs(c->reference.t[c->reference.rows - 1] - app->scene->t0);
  double h = step;
  StepClock clock = {0};
  int stays = x->error < lost;
  x->largest = stays ? h : 0;
  for (int i = 0; i < 40 && h < span && lag_app_interrupted() == EXIT_SIGNAL; i++) {
    if ((x->cut = lag_processor_seconds() > x->latest)) return;
    h *= stays ? factor : 1 / factor;
    int good = run_with(app, c, x, h, 1, own, &clock) < lost;
    if (good) x->largest = h;
    if (good != stays) return;
  }
}

static int add_method(App *app, FixedStep *all, int n, const lag_method *m, const char *option, double value) {
  const Args *a = &app->args;
  FixedStep *x = &all[n];
  int adaptive = (m->flags & LAG_METHOD_ADAPTIVE) != 0, can = !adaptive;
  for (int i = 0; i < m->noptions; i++) can |= strcmp(m->options[i].name, "adapt") == 0;
  if (n == MOST_METHODS || !can || (a->methods && !lag_app_has_word(a->methods, m->name, strlen(m->name)))) return n;
  *x = (FixedStep){.method = m};
  if (adaptive) x->option[x->noptions++] = (lag_option){.name = "adapt", .text = "off"};
  if (option) x->option[x->noptions++] = (lag_option){.name = option, .value = value};
  if (option) snprintf(x->name, sizeof x->name, "%s(%s=%g)", m->name, option, value);
  else snprintf(x->name, sizeof x->name, adaptive ? "%s(adapt=off)" : "%s", m->name);
  return n + 1;
}

static int by_error(const void *a, const void *b) {
  double x = ((const FixedStep *)a)->error, y = ((const FixedStep *)b)->error;
  return isnan(x) ? !isnan(y) : isnan(y) ? -1 : (x > y) - (x < y);
}

static int by_time(const void *a, const void *b) {
  double x = ((const FixedStep *)a)->mean, y = ((const FixedStep *)b)->mean;
  return (x > y) - (x < y);
}

/* Sorts by error; with a target, those that meet it come first, by time. */
static void rank(FixedStep *all, int n, double target) {
  size_t meet = 0;
  qsort(all, (size_t)n, sizeof *all, by_error);
  while (meet < (size_t)n && all[meet].error <= target) meet++;
  qsort(all, meet, sizeof *all, by_time);
}

/* The first whose worst step is made in half of its time: with a target, of those that meet it; else one that takes
 * at most half as long wins if its error is at most twice as large. */
static const FixedStep *choose(const FixedStep *all, int n, double step, double target) {
  const FixedStep *best = NULL;
  for (int i = 0; i < n; i++) {
    const FixedStep *x = &all[i];
    if (isnan(x->error) || x->error >= (target > 0 ? fmin(target, lost) : lost) || x->refused || x->worst > 0.5 * step)
      continue;
    if (!best || (!(target > 0) && x->error <= 2 * best->error && x->mean <= 0.5 * best->mean)) best = x;
  }
  return best;
}

static void put_text(const App *app, const Cost *c, const FixedStep *all, int n, double step) {
  const FixedStep *best = choose(all, n, step, c->target);
  char setting[128];
  printf("model %s, scene %s, steps of %g s to t = %.15g s\n", app->scene->model->name, app->scene->name, step,
         c->reference.t[c->reference.rows - 1]);
  if (best) {
    snprintf(setting, sizeof setting, "%.*s%sstep=%g)", (int)strcspn(best->name, ")"), best->name,
             strchr(best->name, '(') ? ", " : "(", step);
    printf("%s: %s, error %.1e, %.2g us a step, at worst %.2g us; its steps may be as long as %.2g s\n",
           c->target > 0 ? "fastest" : "best", best->name, best->error, 1e6 * best->mean, 1e6 * best->worst,
           best->largest);
    lag_cost_put_command(stdout, app, c);
    printf(" --method \"%s\"\n", setting);
  } else {
    if (c->target > 0)
      printf("no method of equal steps has an error of %g or less with steps of %g s, in half of that time; take "
             "shorter steps\n",
             c->target, step);
    else
      printf(
          "no method of equal steps follows the motion with steps of %g s, in half of that time; take shorter steps\n",
          step);
  }
  printf("in an emitted header (lagc header): ..._rk4_step(&parameters, &state, %g), which is rk4 below\n\n", step);
  printf("  %-24s %10s %14s %14s %18s\n", "", "error", "a step [us]", "at worst [us]", "largest step [s]");
  for (int i = 0; i < n; i++) {
    const FixedStep *x = &all[i];
    char largest[32];
    snprintf(largest, sizeof largest, x->cut && x->largest > 0 ? "at least %.2g" : x->cut ? "-" : "%.2g", x->largest);
    if (isnan(x->error)) printf("  %-24s %10s %14s %14s %18s  %s\n", x->name, "-", "-", "-", largest, x->why);
    else
      printf("%c %-24s %10.1e %14.3g %14.3g %18s%s%s\n", x == best ? '*' : ' ', x->name, x->error, 1e6 * x->mean,
             1e6 * x->worst, largest, x->why[0] ? "  " : "", x->why);
  }
  printf("error: the largest difference from the reference at 16 times, relative to the largest value of its kind and "
         "unit. largest step: with an error\n"
         "below %g to the end of this run, found in factors of sqrt(2); longer ones are unstable or miss the motion\n",
         lost);
}

static void put_json(const App *app, const Cost *c, const FixedStep *all, int n, double step) {
  const FixedStep *best = choose(all, n, step, c->target);
  Json j = lag_app_json(app, stdout);
  lag_json_number(&j, "step", step);
  lag_json_string(&j, "best", best ? best->name : NULL);
  JSON_OBJECTS(&j, "methods", i, n) {
    const FixedStep *x = &all[i];
    lag_json_string(&j, "method", x->name);
    lag_json_numbers(&j, {"error", x->error}, {"step_s", isnan(x->error) ? NAN : x->mean},
                         {"worst_s", isnan(x->error) ? NAN : x->worst},
                         {"largest_step", x->largest > 0 && !x->cut ? x->largest : NAN});
    lag_json_string(&j, "refused", x->why[0] ? x->why : NULL);
  }
  lag_json_close(&j);
}

int lag_app_realtime(App *app, const Cost *c) {
  const Args *a = &app->args;
  double step, overhead = clock_cost();
  FixedStep *all = calloc(MOST_METHODS, sizeof *all);
  double *least = malloc(WATCHED * sizeof *least);
  Samples own = {0};
  const lag_method *m;
  int n = 0, rc = lag_args_positive(a, "--realtime", a->realtime, "--realtime 1e-3", "the time of a step [s]", &step);
  if (rc == 0 && (!all || !least || lag_samples_init(&own, c->reference.rows, c->reference.n)))
    rc = lag_app_error(a, "out of memory");
  for (int i = 0; rc == 0 && (m = lag_app_method_at(app, i)) != NULL; i++) {
    if (strcmp(m->name, "variational") == 0 || strcmp(m->name, "gauss") == 0)
      for (int k = 1; k <= 2; k++)
        n = add_method(app, all, n, m, m->name[0] == 'g' ? "stages" : "order", m->name[0] == 'g' ? k : 2 * k);
    else n = add_method(app, all, n, m, NULL, 0);
  }
  own.output = c->reference.output;
  if (rc == 0) memcpy(own.t, c->reference.t, (size_t)c->reference.rows * sizeof *own.t);
  for (int i = 0; i < n && rc == 0; i++) {
    double now = lag_processor_seconds();
    all[i].latest = now + fmax(c->seconds - now, 0.2 * c->seconds) / (n - i);
    measure(app, c, &all[i], step, overhead, least, &own);
    if (!isnan(all[i].error)) judge(app, c, &all[i], step);
    if (!isnan(all[i].error) || strstr(all[i].why, "finite")) find_largest(app, c, &all[i], step, &own);
  }
  if (rc == 0) {
    rank(all, n, c->target);
    if (a->json) put_json(app, c, all, n, step);
    else if (!a->quiet) put_text(app, c, all, n, step);
    rc = choose(all, n, step, c->target) ? EXIT_FINE : EXIT_RUN;
  }
  lag_samples_free(&own);
  free(least);
  free(all);
  return rc;
}
