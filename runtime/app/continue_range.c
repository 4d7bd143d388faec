/* NAME=A..B of --continue: what runs over a range, its ends, and the value to begin with. */
#include <math.h>
#include <string.h>

#include "app/continue_branches.h"

int lag_continue_take_range(Job *job) {
  Args *a = &job->app->args;
  const char *found = NULL;
  int kept = 0;
  for (int i = 0; i < a->nsets; i++) {
    const char *eq = strchr(a->sets[i], '=');
    if (!eq || !strstr(eq, "..")) {
      a->sets[kept++] = a->sets[i];
      continue;
    }
    if (found) return lag_app_error(a, "%s and %s: one value runs over a range; leave one out", found, a->sets[i]);
    found = a->sets[i];
  }
  a->nsets = kept;
  if (!found) return lag_app_error(a, "a range is missing: NAME=A..B, for example mu=0.1..3");
  size_t n = strcspn(found, "=");
  char low[64];
  const char *dots = strstr(found, "..");
  snprintf(job->name, sizeof job->name, "%.*s", (int)n, found);
  snprintf(low, sizeof low, "%.*s", (int)(dots - found - (long)n - 1), found + n + 1);
  if (!lag_args_number(a, job->name, low, "mu=0.1..3", &job->low) ||
      !lag_args_number(a, job->name, dots + 2, "mu=0.1..3", &job->high))
    return EXIT_USAGE;
  const double rounding = 1e-12;
  double size = fmax(fabs(job->low), fabs(job->high));
  if (fabs(job->high - job->low) > rounding * size) return 0;
  return lag_app_error(a, "%s: the ends of the range are equal", found);
}

int lag_continue_find_parameter(Job *job) {
  App *app = job->app;
  int index = 0, kind, charge = lag_charge_named(app, job->name, strlen(job->name)),
      state = lag_state_named(app, job->name, strlen(job->name));
  job->factor = 1;
  job->led_kind = -1;
  if (strcmp(job->name, "period") == 0) job->led_kind = ORBIT_PERIOD;
  else if (state >= 0) {
    job->led_kind = ORBIT_STATE, job->led_of = state;
    job->offset = 0 - lag_sim_declared(app->sim, state, 0);
    job->factor = 1 / (lag_sim_declared(app->sim, state, 1) - lag_sim_declared(app->sim, state, 0));
    job->offset *= job->factor;
  } else if (charge >= 0) job->led_kind = ORBIT_CHARGE, job->led_of = charge;
  else if ((kind = lag_find_name(app->scene->model, job->name, &index, &job->unit)) == LAG_IS_U)
    return lag_app_error(&app->args,
                         "%s is an input: declare a parameter, `param`, and set the input to it, `input %s = ...`; "
                         "that runs over a range", job->name, job->name);
  else if (kind != LAG_IS_P)
    return lag_app_error(&app->args,
                         "%s: the model has no parameter of this name; of periodic motions also `energy`, a conserved "
                         "charge, `period`, a coordinate, velocity or state can run over a range",
                         job->name);
  else job->begin = lag_declared(job->unit, app->sim->p[index]);
  return 0;
}

int lag_continue_choose_begin(Job *job) {
  double low = fmin(job->low, job->high), high = fmax(job->low, job->high);
  job->size = high - low;
  if (!(job->begin >= low && job->begin <= high)) job->begin = job->low;
  return lag_sim_set(job->app->sim, job->name, job->begin)
             ? lag_app_error(&job->app->args, "%s", lag_sim_message(job->app->sim))
             : 0;
}
