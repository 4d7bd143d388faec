/* Automatic choice of the method where none is named. Enters: a simulation with its values and tolerance; leaves: its method, and
 * the reason. Holds: the choice depends on the model, the values and the tolerance, never on measured times. */
#include <math.h>

#include "analysis/stiffness.h"
#include "app/app.h"

/* Between these tolerances dop853 is the cheapest method, as measured with `lagc cost`. */
static const double below_taylor = 1e-9, above_rk45 = 1e-6;

enum { MOST_OF_TRIAL = 200, MOST_OF_RADAU = 40 }; /* limits on the size of the state: beyond, Jacobians or factorizations take too long */
enum { STEPS_OF_TRIAL = 600 };

/* Trial run with the values of app->sim for the statistics *s. 0: no trial is possible. */
static int run_trial(App *app, const lag_method *method, double bound, int most, Stiffness *s) {
  lag_sim *trial = lag_app_fresh_sim(app);
  int done = trial && lag_sim_set_tolerance(trial, lag_sim_tolerance(app->sim)) == 0 && lag_sim_set_method(trial, method, NULL, 0) == 0 &&
             lag_stiffness(trial, app->until, bound, most, s) == LAG_OK;
  lag_sim_free(trial);
  return done;
}

/* Whether the model is stiff, by a trial of `method`, and if needed of radau; why[size] := the reason. */
static int is_stiff(App *app, const lag_method *method, char *why, size_t size) {
  const lag_model *m = app->scene->model;
  int n = 2 * m->nq + m->nz;
  double bound = method == &lag_rk45 ? 3.3 : 6.1;
  Stiffness s, radau;
  if (!m->linear || m->constraints || n > MOST_OF_TRIAL || !run_trial(app, method, bound, STEPS_OF_TRIAL, &s)) return 0;
  if (lag_is_stiff(&s)) {
    snprintf(why, size, "radau, since the model is stiff: stability, not the tolerance, would limit %.0f %% of the first steps of %s",
             100.0 * s.limited / s.looked, method->name);
    return 1;
  }
  if (!s.unfinished || n > MOST_OF_RADAU || !run_trial(app, &lag_radau, bound, STEPS_OF_TRIAL, &radau) || !lag_exceeds_stability(&radau, n)) return 0;
  snprintf(why, size, "radau, since the model is stiff: stability alone would demand %.2g steps of %s to t = %.3g s, and radau takes %d",
           radau.needed, method->name, radau.until, radau.steps);
  return 1;
}

/* Sets the method; 0 if it refuses this model or these options. */
static int set(App *app, const lag_method *method, const lag_option *opt, int n) { return lag_sim_set_method(app->sim, method, opt, n) == 0; }

int lag_app_choose_automatically(App *app, const lag_option *opt, int n) {
  double tol = lag_sim_tolerance(app->sim);
  const lag_method *plain = tol > above_rk45 ? &lag_rk45 : &lag_dop853;
  char *why = app->why;
  size_t size = sizeof app->why;
  int exponents = app->args.lyapunov; /* taylor integrates tangent vectors by dop853, so dop853 alone is cheaper */
  if (is_stiff(app, plain, why, size) && set(app, &lag_radau, opt, n)) return 0;
  if (tol < below_taylor && !exponents && set(app, &lag_taylor_method, opt, n)) {
    snprintf(why, size, "taylor, since the tolerance is below %g", below_taylor);
  } else if (set(app, plain, opt, n)) {
    if (plain == &lag_rk45) {
      snprintf(why, size, "rk45, since the tolerance is above %g", above_rk45);
    } else if (exponents && tol < below_taylor) {
      snprintf(why, size, "dop853, since tangent vectors cost less with dop853 than with taylor");
    } else if (tol < below_taylor && app->scene->model->constraints) {
      snprintf(why, size, "dop853, since taylor cannot hold constraints, with the tolerance below %g", below_taylor);
    } else {
      snprintf(why, size, "dop853, since %s %g", tol < below_taylor ? "taylor cannot take this run, with its tolerance below"
                                                                      : "the tolerance is at most", tol < below_taylor ? below_taylor : above_rk45);
    }
  } else {
    return lag_app_error(&app->args, "%s", lag_sim_message(app->sim));
  }
  return 0;
}
