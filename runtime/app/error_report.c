/* The error of a run, by a second run with a more accurate setting. Enters: a run under way, then finished; leaves:
 * a line or two of the report: the error, how it grows, and the horizon. Holds: the second run makes few steps
 * beside the run; then its law of growth tells the rest. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"
#include "core/rhs.h"

static const double tighter = 0.03; /* than the tolerance of the run: its error is then small beside the run's */
static const double least_tolerance = 4.5 * DBL_EPSILON;
static const double cheap = 5e7; /* work: a twentieth of a second, and a whole second run */

int lag_app_error_begin(App *app) {
  const Args *a = &app->args;
  /* impacts are at other steps in a run with other steps */
  int impulses = (lag_sim_method(app->sim)->flags & LAG_METHOD_IMPULSES) &&
                 (app->scene->model->ncontacts || app->scene->model->families);
  app->watched = !impulses && (!a->quiet || a->json || a->svg || a->html) && !app->resumed && !app->overlaid;
  return app->watched && lag_error_estimate_init(&app->error, app->sim) ? lag_app_error(a, "out of memory") : 0;
}

int lag_app_copy_method(const lag_sim *from, lag_sim *to, double times) {
  lag_option opt[MOST_OPTIONS];
  lag_app_options(from->method, from->options, 1, opt);
  int rc = lag_sim_set_method(to, from->method, opt, from->method->noptions);
  return rc ? rc : lag_sim_set_tolerance(to, fmax(times * from->tol, least_tolerance));
}

/* Operations of an evaluation, of a series of this order. Constraints add the factors of a matrix. Contacts that are
 * open are no constraints. */
static double work_of_call(const lag_sim *run, double order) {
  const lag_model *m = run->scene->model;
  double size = m->constraints ? m->nq + m->constraints->n - m->ncontacts : 0;
  return m->ops * (1 + order * order / 8) + 5 * run->pb.n + size * size * size / 3;
}

/* Work of a run so far, in operations: a nanosecond or so each. Events add their functions at each step, a Taylor
 * series the square of its order at each call. */
double lag_app_work(const lag_sim *run) {
  const double each_event = 1000;
  const lag_model *m = run->scene->model;
  int series = m->taylor && run->method == &lag_taylor_method && run->method_work;
  double call = work_of_call(run, series ? lag_taylor_order(run->method_work) : 0);
  return run->pb.rhs_calls * call + run->run->steps * (each_event * m->nev + 20 * run->pb.n);
}

/* Fewer steps of the second run show no law of growth; evaluations of as many steps of dop853. */
enum { FEWEST = 24, FEWEST_CALLS = 12 * FEWEST };

/* Ends the second run after its share of work, or on Ctrl-C. */
static int enough(void *app, const lag_sim *other) {
  const App *a = app;
  double work = lag_app_work(other);
  int done = work >= a->second_most && (other->run->steps >= FEWEST || work >= a->second_few);
  return done || lag_app_interrupted() != EXIT_SIGNAL;
}

/* Whether rounding counts as truncation does. */
static int is_long_series(const lag_sim *run) {
  return run->method == &lag_taylor_method && !run->scene->model->constraints && lag_equal_step(run) <= 0 &&
         run->tol < 1e-11;
}

/* taylor with a smaller tolerance, a lower order and at most half the run's mean step: the roundings of long series
 * have one sign along a motion, with any tolerance, and are in proportion to steps. */
static int set_shorter_series(const ErrorEstimate *e, const lag_sim *run, lag_sim *other) {
  const double lower = 3;
  const lag_option shorter[] = {{.name = "order", .value = fmax(lag_taylor_order(run->method_work) - lower, 1)},
                                {.name = "max_step", .value = 0.5 * fabs(lag_sim_time(run) - e->t0) / run->run->steps}};
  int rc = lag_sim_set_method(other, &lag_taylor_method, shorter, sizeof shorter / sizeof *shorter);
  return rc ? rc : lag_sim_set_tolerance(other, fmax(tighter * run->tol, least_tolerance));
}

/* dop853 beside a method of equal steps. */
static int set_adaptive(const ErrorEstimate *e, lag_sim *other) {
  const double small = 8 * DBL_EPSILON;
  lag_option atol = {.name = "atol"};
  int rc = lag_error_least_scale(e, other, &atol.value);
  atol.value *= small;
  rc = rc ? rc : lag_sim_set_method(other, &lag_dop853, &atol, atol.value < HUGE_VAL);
  return rc ? rc : lag_sim_set_tolerance(other, small);
}

/* A setting whose error is small beside the run's; near the smallest tolerance, one whose error is of another
 * making, and about as small, or a larger tolerance, which shows an error that is too large, but not 0. */
static int set_more_accurate(const ErrorEstimate *e, const lag_sim *run, lag_sim *other) {
  const double apart = 3; /* tolerances whose errors differ enough */
  if (lag_equal_step(run) > 0) return set_adaptive(e, other);
  if (is_long_series(run)) return set_shorter_series(e, run, other);
  return lag_app_copy_method(run, other, run->tol >= apart * least_tolerance ? tighter : apart);
}

/* Near rounding, that of the second run is part of the error, and its law is not the run's. */
static int is_rounding(const ErrorEstimate *e) { return e->largest < fmax(5e4 * DBL_EPSILON, e->floor); }

/* Moves the start by some roundings, up and down in turns. What cannot be set stays, and so does 0: what is set is no
 * longer open to the assembly of constraints. */
static void nudge(lag_sim *sim, double roundings) {
  const double few = roundings * DBL_EPSILON;
  const lag_model *m = lag_sim_scene(sim)->model;
  char name[256];
  for (int i = 0; i < 2 * m->nq + m->nz; i++) {
    (void)lag_sim_state_info(sim, i, name, sizeof name, NULL, 0);
    double value = lag_sim_state_value(sim, i);
    if (value != 0) (void)lag_sim_set(sim, name, value * (i % 2 ? 1 - few : 1 + few));
  }
}

int lag_app_set_option(lag_sim *sim, const char *name, double value) {
  lag_option opt[MOST_OPTIONS];
  lag_app_options(sim->method, sim->options, 1, opt);
  for (int i = 0; i < sim->method->noptions; i++)
    if (strcmp(opt[i].name, name) == 0) opt[i].value = value;
  return lag_sim_set_method(sim, sim->method, opt, sim->method->noptions);
}

/* The run's method with equal steps, a part of the run's. */
static int set_shorter_steps(const lag_sim *run, lag_sim *other, double part) {
  int rc = lag_app_copy_method(run, other, 1);
  return rc ? rc : lag_app_set_option(other, "step", part * lag_equal_step(run));
}

/* How the second run differs from a more accurate setting alone; steps and work: that it took. */
typedef struct Second {
  double nudged;  /* roundings of the start; 0: none */
  double longest; /* step [s]; 0: any */
  double part;    /* of the run's equal steps, by its method; 0: another method or tolerance */
  int halves;     /* 1: part is a half, and what it differs by is a part of the error */
  double steps, work;
} Second;

/* Events are found just behind their times, by about a rounding of the time in any run: the second run
 * finds them later. */
static const double late = DBL_EPSILON;

/* Half the step where even the fewest steps of dop853 are beyond its share, as of many bodies. */
static void choose_halves(const lag_sim *run, double most, Second *second) {
  second->halves = lag_equal_step(run) > 0 && FEWEST_CALLS * work_of_call(run, 0) > most;
  if (second->halves) second->part = 0.5;
}

/* Half the step leaves a part 2^-order of the error. */
static double unseen(const lag_sim *run) {
  const lag_method *m = run->method;
  return 1 / (1 - pow(0.5, m->order_of ? m->order_of(run->options) : m->order));
}

static int compare_once(App *app, ErrorEstimate *e, const lag_sim *run, double most, Second *second) {
  const double few = 3; /* times the run's work, where its steps are fewer than FEWEST */
  lag_sim *other = lag_app_fresh_bare_sim(app);
  int rc = !other             ? LAG_ENOMEM
           : second->part > 0 ? set_shorter_steps(run, other, second->part)
                              : set_more_accurate(e, run, other);
  app->second_most = is_long_series(run) ? 3 * most : most; /* with as many more steps */
  if (second->halves) app->second_most = fmax(most, FEWEST_CALLS * work_of_call(run, 0));
  app->second_few = few * lag_app_work(run);
  e->whole = second->halves ? unseen(run) : 1;
  if (rc == LAG_OK && second->longest > 0) rc = lag_app_set_option(other, "max_step", second->longest);
  if (rc == LAG_OK) {
    if (second->nudged > 0) nudge(other, second->nudged);
    other->late = late;
    other->unreported = 1;
    lag_sim_on_step(other, enough, app);
    rc = lag_error_estimate_compare(e, other, lag_sim_time(run));
    second->steps = other->run->steps;
    second->work = lag_app_work(other);
  } else if (other) {
    snprintf(e->why, sizeof e->why, "%s", lag_sim_message(other));
  }
  lag_sim_free(other);
  return rc == LAG_ENOMEM ? rc : LAG_OK;
}

/* The mean step of the run where a limit, rows of a table or kicks set its steps, and the second run's, not the
 * tolerance; else 0. */
static double forced_step(const ErrorEstimate *e, const lag_sim *run, double steps) {
  double part = e->motion.rows ? (double)e->compared / e->motion.rows : 0, own = run->run->steps * part;
  int follows = (run->method->flags & LAG_METHOD_ADAPTIVE) && run->method->order_most == 0 && e->compared;
  int forced = follows && isnan(e->horizon) && own > 0 && steps < 1.1 * own;
  return forced ? fabs(lag_sim_time(run) - e->t0) / run->run->steps : 0;
}

/* Compares a second time with a start that is off by a rounding, where both runs may have errors of one size and
 * direction: rounding, in motions that part. */
static int compare_again(App *app, ErrorEstimate *e, const lag_sim *run, double most, Second *second) {
  const double little = 1e7, close = 1e-12, seen = 1e-14; /* work of a second run; tolerance of the first */
  int near = lag_equal_step(run) > 0 || run->tol < close;
  int parts = e->growth == LAG_ERROR_EXPONENTIAL || e->growth == LAG_ERROR_UNKNOWN;
  if (!near || !parts || !isnan(e->horizon) || !(e->largest > seen) || second->work > little) return LAG_OK;
  double before = e->largest;
  lag_error_estimate_reset(e);
  second->nudged = 2;
  int rc = compare_once(app, e, run, most, second);
  e->largest = isnan(e->largest) ? before : hypot(e->largest, before);
  return rc;
}

/* Largest difference from the run's method with other equal steps; NaN: not compared to the end. *e stays. */
static double compare_steps(App *app, const ErrorEstimate *e, const lag_sim *run, double part) {
  Second second = {.part = part};
  double largest = NAN;
  ErrorEstimate *other = malloc(sizeof *other);
  if (!other) return NAN;
  *other = *e;
  lag_error_estimate_reset(other);
  if (!compare_once(app, other, run, HUGE_VAL, &second) && !other->continued) largest = other->largest;
  free(other);
  return largest;
}

/* The error of equal steps of a high order at rounding, which over many periods is less than the rounding of dop853,
 * whose coefficients are large: by the same method with shorter steps; of a long run a bound. Implicit methods share
 * a part of their rounding, some units of the time's: that of their coefficients. */
static void compare_rounding(App *app, ErrorEstimate *e, const lag_sim *run) {
  const double seen = 1e-14, small = 1e-8, shorter[] = {0.5, 0.77}, coefficients = 32;
  const lag_method *m = run->method;
  int implicit = (m->flags & (LAG_METHOD_NEWTON | LAG_METHOD_SPLITS)) == LAG_METHOD_NEWTON;
  int high = lag_equal_step(run) > 0 && (m->order_of ? m->order_of(run->options) : m->order) >= 4;
  int regular = isnan(e->horizon) && run->run->events == 0, is_long = e->continued || lag_app_work(run) > cheap;
  if (!high || !regular || !(e->largest > seen && e->largest < small)) return;
  e->at_most = is_long && is_rounding(e);
  if (is_long) return;
  double a = compare_steps(app, e, run, shorter[0]), b = compare_steps(app, e, run, shorter[1]);
  double safety = e->growth == LAG_ERROR_EXPONENTIAL ? 3 : 2, error = safety * fmax(a, b);
  if (implicit) error = fmax(error, coefficients * e->floor);
  if (isnan(a) || isnan(b) || !(error < e->largest)) return;
  e->largest = error;
  e->growth = LAG_ERROR_UNKNOWN;
}

static int compare_methods(App *app, ErrorEstimate *e, lag_sim *run, double most) {
  Second second = {0};
  lag_error_estimate_note_end(e, run);
  choose_halves(run, most, &second);
  int rc = compare_once(app, e, run, most, &second);
  double step = rc ? 0 : forced_step(e, run, second.steps);
  if (step > 0) {
    lag_error_estimate_reset(e);
    second.longest = 0.5 * step;
    rc = compare_once(app, e, run, 2 * most, &second);
  }
  /* Flights on straight lines have the same roundings with any setting; what impacts make of these, a start that is
   * off by one shows. */
  if (rc) return rc;
  const double tiny = 1e-11;
  int blind = lag_error_estimate_is_blind(e), exact = !blind && run->run->events > 0 && e->largest < tiny;
  if (!blind && !exact) return compare_again(app, e, run, most, &second);
  if (exact) lag_error_estimate_reset(e); /* states that only events change have the same roundings, too */
  second = (Second){.nudged = 4, .part = second.part, .halves = second.halves}; /* the first sum may take one away */
  return compare_once(app, e, run, most, &second);
}

int lag_app_compare_errors(App *app, ErrorEstimate *e, lag_sim *run, double most) {
  int rc = compare_methods(app, e, run, most);
  if (!rc) compare_rounding(app, e, run);
  return rc;
}

void lag_app_error_end(App *app) {
  const double part = 1. / 15;
  const lag_sim *run = app->sim;
  if (!app->watched || app->status < 0 || app->status == LAG_INTERRUPTED) return;
  double most = app->asked > 0 ? HUGE_VAL : fmax(part * lag_app_work(run), cheap);
  if (lag_app_compare_errors(app, &app->error, app->sim, most)) app->status = LAG_ENOMEM;
}

const char *lag_growth_name(ErrorGrowth growth) {
  static const char *const names[] = {"", "bounded", "t", "t^2", "exponential"};
  return names[growth];
}

static const char *const growth_text[] = {", its growth is not seen", ", does not grow", ", grows as t",
                                          ", grows as t^2", ", grows exponentially"};

static ErrorGrowth growth_of(const ErrorEstimate *e) { return is_rounding(e) ? LAG_ERROR_UNKNOWN : e->growth; }

/* Whether the end of the run is beyond what is known of its error. */
static int is_beyond(const App *app) {
  return isnan(app->error.horizon) && app->error.known_to != lag_sim_time(app->sim);
}

/* A formula cancels, in both runs alike. */
static void put_lost_formula(const App *app, FILE *f) {
  const ErrorEstimate *e = &app->error;
  int nq = app->scene->model->nq, second = e->formula.of < 2 * nq, of = second ? e->formula.of - nq : e->formula.of;
  fprintf(f,
          "the error is not known: the formula of %s%s cancels along this motion, and has lost digits in any run; two "
          "runs agree to %.1g. Write terms that cancel in another form, as 2*sin(x/2)^2 for 1 - cos(x)%s\n",
          lag_state_column(app->sim, of).name, second ? "''" : "'", lag_error_size(e), LAG_MORE_PRECISION);
}

void lag_report_error(const App *app, FILE *f) {
  const ErrorEstimate *e = &app->error;
  char from[96] = "";
  if (app->watched && isnan(e->largest) && e->why[0]) fprintf(f, "the error is not known: %s\n", e->why);
  if (!app->watched || isnan(e->largest)) return;
  if (e->continued && growth_of(e) == LAG_ERROR_EXPONENTIAL)
    snprintf(from, sizeof from, " (continued from t = %.3g s)", (double)e->motion.t[e->compared - 1]);
  if (!isnan(e->horizon)) {
    fprintf(f, "after t = %.3g s no digit is left%s: the motion there is the integrator's; averages may still hold\n",
            e->horizon, from);
    return;
  }
  if (lag_formula_is_lossy(e)) {
    put_lost_formula(app, f);
    return;
  }
  if (is_beyond(app)) fprintf(f, "the error is not known after t = %.3g s; up to there ", e->known_to);
  double size = lag_error_size(e);
  const char *sort = e->at_most ? "at most" : size > DBL_EPSILON ? "about" : "below";
  fprintf(f, "%s%s %.1g", is_beyond(app) ? "" : "error ", sort, size);
  if (app->asked > 0) fprintf(f, " (asked %g)", app->asked);
  fprintf(f, "%s%s\n", is_rounding(e) ? "" : growth_text[growth_of(e)], from);
}

void lag_report_error_json(const App *app, Json *j) {
  const ErrorEstimate *e = &app->error;
  int known = app->watched && !isnan(e->largest);
  lag_json_number(j, "error", known && !is_beyond(app) && !lag_formula_is_lossy(e) ? lag_error_size(e) : NAN);
  lag_json_string(j, "error_growth", known && growth_of(e) ? lag_growth_name(growth_of(e)) : NULL);
  lag_json_number(j, "error_seen_to", app->watched && e->compared ? e->motion.t[e->compared - 1] : NAN);
  double to = lag_formula_is_lossy(e) ? app->scene->t0 : isnan(e->horizon) ? e->known_to : e->horizon;
  lag_json_numbers(j, {"error_known_to", known ? to : NAN}, {"error_up_to_there", known ? lag_error_size(e) : NAN});
  lag_json_truth(j, "error_at_most", e->at_most);
  lag_json_number(j, "formula_noise", known && e->formula.of >= 0 ? e->formula.part : NAN);
  lag_json_number(j, "horizon", app->watched ? e->horizon : NAN);
}
