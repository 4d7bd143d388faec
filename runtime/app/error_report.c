/* The error of a run, by a second run with a more accurate setting. Enters: a run under way, then finished; leaves: a line or two of the report: the
 * error, how it grows, and the horizon. Holds: the second run makes few steps beside the run; then its law of growth tells the rest. */
#include <float.h>
#include <math.h>

#include "app/app.h"
#include "core/core.h"

static const double tighter = 0.1; /* than the tolerance of the run: its error is then small beside the run's */

int lag_app_error_begin(App *app) {
  const Args *a = &app->args;
  app->watched = (!a->quiet || a->json) && !app->resumed;
  return app->watched && lag_error_estimate_init(&app->error, app->sim) ? lag_app_error(a, "out of memory") : 0;
}

/* `to` takes the method and options of `from`, and its tolerance times `times`. LAG_OK, or a refusal. */
int lag_app_copy_method(const lag_sim *from, lag_sim *to, double times) {
  const lag_method *m = from->method;
  lag_option opt[MOST_OPTIONS];
  for (int i = 0; i < m->noptions; i++) opt[i] = (lag_option){.name = m->options[i].name, .value = from->options[i]};
  int rc = lag_sim_set_method(to, m, opt, m->noptions);
  return rc ? rc : lag_sim_set_tolerance(to, fmax(times * from->tol, 4.5 * DBL_EPSILON));
}

int lag_app_set_more_accurate(const lag_sim *run, lag_sim *other) {
  if (!(lag_equal_step(run) > 0)) /* near the smallest tolerance a run with a larger one shows an error that is too large, not 0 */
    return lag_app_copy_method(run, other, run->tol * tighter >= 4.5 * DBL_EPSILON ? tighter : 3);
  int rc = lag_sim_set_method(other, &lag_dop853, NULL, 0);
  return rc ? rc : lag_sim_set_tolerance(other, pow(DBL_EPSILON, 0.75));
}

lag_sim *lag_app_fresh_bare_sim(App *app) {
  const lag_scene *own = app->scene;
  app->bare = *own;
  app->bare.nmonitors = app->bare.nexact = 0;
  app->scene = &app->bare;
  lag_sim *sim = lag_app_fresh_sim(app);
  app->scene = own;
  return sim;
}

void lag_app_error_end(App *app) {
  enum { STEPS_TIMES_SIZE = 20000, PART = 15 };
  if (!app->watched || app->status < 0 || app->status == LAG_INTERRUPTED) return;
  lag_sim *other = lag_app_fresh_bare_sim(app);
  double most = app->asked > 0 ? 0 : fmax(app->sim->run->steps / PART, STEPS_TIMES_SIZE / (app->sim->pb.n + 1));
  int rc = other ? lag_app_set_more_accurate(app->sim, other) : LAG_ENOMEM;
  if (rc == LAG_OK) rc = lag_error_estimate_compare(&app->error, other, (long long)most, lag_sim_time(app->sim));
  if (rc == LAG_ENOMEM) app->status = rc;
  lag_sim_free(other);
}

static const char *const growth[] = {"", "bounded", "t", "t^2", "exponential"};
static const char *const growth_text[] = {"", ", does not grow", ", grows as t", ", grows as t^2", ", grows exponentially"};

void lag_report_error(const App *app, FILE *f) {
  const ErrorEstimate *e = &app->error;
  if (app->watched && isnan(e->largest) && e->why[0]) fprintf(f, "the error is not known: the second run failed: %s\n", e->why);
  if (!app->watched || isnan(e->largest)) return;
  if (!isnan(e->horizon)) {
    fprintf(f, "after t = %.3g s no digit is left: the motion there is the integrator's; averages may still hold\n", e->horizon);
  } else {
    fprintf(f, "error about %.1g", e->largest);
    if (app->asked > 0) fprintf(f, " (asked %g)", app->asked);
    fprintf(f, "%s\n", growth_text[e->growth]);
  }
}

void lag_report_error_json(const App *app, Json *j) {
  const ErrorEstimate *e = &app->error;
  lag_json_number(j, "error", app->watched ? e->largest : NAN);
  lag_json_string(j, "error_growth", app->watched && e->growth ? growth[e->growth] : NULL);
  lag_json_number(j, "horizon", app->watched ? e->horizon : NAN);
}
