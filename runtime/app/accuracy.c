/* --accuracy: the setting whose error over the whole run is below a number. Enters: a simulation with its values;
 * leaves: its method and tolerance or step. Each trial is a run and a second, more accurate one
 * (analysis/error_estimate.h); the setting is refined until the estimated error is a third of what was asked. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "app/app.h"
#include "core/core.h"

static const double share = 0.3; /* of the error that was asked: an estimate is right within a factor of 3 or so */
enum { MOST_TRIALS = 10 };

/* Method with tolerance or step of the next trial. */
static int set_knob(App *app, double knob) {
  lag_sim *s = app->sim;
  if (!(lag_equal_step(s) > 0)) {
    int rc = lag_sim_set_tolerance(s, knob);
    return rc || app->args.method ? rc : lag_app_choose_automatically(app, NULL, 0);
  }
  return lag_app_set_option(s, "step", knob);
}

typedef struct Trial {
  ErrorEstimate *e;
  lag_sim *sim;
} Trial;

static int note(void *trial, const lag_sim *sim) {
  const Trial *x = trial;
  lag_error_estimate_note(x->e, x->sim);
  return sim->run->steps >= LAG_ACCURACY_STEPS;
}

/* *e := the error of a run with the present setting. LAG_OK, or the failure of the run with app->sim's message. */
static int try_setting(App *app, ErrorEstimate *e) {
  /* with the scene's monitors: a setting that they stop is not accurate enough */
  lag_sim *trial = lag_app_fresh_sim(app);
  int rc = trial ? lag_error_estimate_init(e, trial) : LAG_ENOMEM;
  rc = rc ? rc : lag_app_copy_method(app->sim, trial, 1);
  if (rc == 0) {
    lag_sim_on_step(trial, note, &(Trial){e, trial});
    rc = lag_sim_advance(trial, app->until);
    if (rc < 0) lag_fail(app->sim, rc, "%s", lag_sim_message(trial));
    if (rc == LAG_INTERRUPTED)
      rc =
          lag_fail(app->sim, LAG_ESTEP, "%s would take more than %g steps", app->sim->method->name, LAG_ACCURACY_STEPS);
  }
  /* more of it creeps where errors are rounding */
  if (rc >= 0) rc = lag_app_compare_errors(app, e, trial, 1e6 + 30 * lag_app_work(trial));
  lag_sim_free(trial);
  return rc < 0 ? rc : LAG_OK;
}

static int refuse(const App *app, double asked, double best, double horizon) {
  char reach[600] = "";
  /* the message has its own advice */
  int failed = isnan(horizon) && !(best < HUGE_VAL) && lag_sim_message(app->sim)[0];
  if (!isnan(horizon))
    snprintf(reach, sizeof reach, ": after t = %.3g s no digit is left in " LAG_PRECISION " precision", horizon);
  else if (best < HUGE_VAL)
    snprintf(reach, sizeof reach, ": the smallest error found is %.2g%s", best,
             best <= asked ? ", too near to be sure" : "");
  else if (failed) snprintf(reach, sizeof reach, ": %s", lag_sim_message(app->sim));
  return lag_app_error(&app->args, "--accuracy %g is not reached to t = %g s%s%s%s", asked, app->until, reach,
                       failed ? "" : "; end the run earlier (--until)",
                       !failed && strcmp(LAG_PRECISION, "double") == 0 ? ", or write --precision quad" : "");
}

int lag_app_choose_by_accuracy(App *app) {
  const Args *a = &app->args;
  ErrorEstimate e = {0};
  double asked, best = HUGE_VAL, horizon = NAN;
  if (!lag_args_number(a, "--accuracy", a->accuracy, "--accuracy 1e-8", &asked)) return EXIT_USAGE;
  if (!(asked > 0 && asked < 1))
    return lag_app_error(a, "--accuracy %s: a relative error between 0 and 1, for example --accuracy 1e-8",
                         a->accuracy);
  if (app->sim->pb.contacts && lag_equal_step(app->sim) > 0)
    return lag_app_error(a,
                         "--accuracy: %s meets impacts at its steps, so no step gives a small error of velocities near "
                         "them; %s",
                         app->sim->method->name,
                         app->scene->model->families ? "compare runs with half the step" : "dop853 locates impacts");
  int equal = lag_equal_step(app->sim) > 0;
  double least = equal ? 0 : 4.5 * DBL_EPSILON,
         knob = equal ? lag_equal_step(app->sim) : fmax(least, fmin(0.1 * asked, 1e-3)),
         order = equal ? app->sim->method->order : 1;
  app->asked = asked;
  for (int i = 0, vain = 0; i < MOST_TRIALS && vain < 2; i++) {
    double steps = fabs(app->until - app->scene->t0) / knob;
    if (equal && steps > LAG_ACCURACY_STEPS)
      return lag_app_error(a,
                           "--accuracy %g would take about %.1e steps of %s; leave out --method, and an adaptive "
                           "method of higher order is chosen",
                           asked, steps, app->sim->method->name);
    int rc = set_knob(app, knob);
    if (rc) return app->args.method ? lag_app_error(a, "%s", lag_sim_message(app->sim)) : rc;
    rc = try_setting(app, &e);
    int unknown = rc || !isnan(e.horizon) || isnan(e.largest) || e.continued || lag_formula_is_lossy(&e);
    double error = unknown ? HUGE_VAL : lag_error_size(&e);
    horizon = rc ? NAN : e.horizon;
    lag_error_estimate_free(&e);
    vain = best < HUGE_VAL && !(error < 0.5 * best) ? vain + 1 : 0; /* rounding, which smaller tolerances make larger */
    best = fmin(best, error);
    if (error <= share * asked) return 0;
    if (knob <= least || (equal && best < HUGE_VAL && error > 2 * best)) break;
    double wanted = 0.5 * share * asked / error, step_factor = pow(fmax(fmin(wanted, 0.5), 1e-3), 1 / order);
    /* refused at once */
    if (equal && error < HUGE_VAL && steps > 10 * LAG_ACCURACY_STEPS * pow(wanted, 1 / order))
      step_factor = pow(wanted, 1 / order);
    knob = fmax(least, knob * step_factor);
  }
  return refuse(app, asked, best, horizon);
}
