/* The message of a run that ended: when, where, why and what to do. Enters: a status, and what a method or the model
 * noted in lag_problem. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/core.h"

static const char *reason(const lag_model *m, int status) {
  switch (status) {
  case LAG_ESINGULAR:
    return m->flags & LAG_FIRST_ORDER ? "the two-form of L is singular"
           : m->constraints
               ? "the mass matrix is singular along motions that the constraints allow, or no longer positive definite"
               : "the mass matrix is singular, or no longer positive definite";
  case LAG_ENAN: return "the model gives no finite value";
  case LAG_EDOMAIN: return "the model left its domain";
  case LAG_ESTEP: return "the step became too small: a singularity, or the tolerance is too strict";
  case LAG_ESTALL: return "the motion gets stuck";
  case LAG_EMODEL: return "the model failed";
  case LAG_EMETHOD: return "the method failed";
  default: return lag_status_name(status);
  }
}

int lag_explain(lag_sim *s, int status) {
  const lag_model *m = s->scene->model;
  const lag_problem *pb = &s->pb;
  char text[256] = "", name[64] = "", advice[160] = "";
  size_t used = 0;
  double h = lag_equal_step(s);
  int which;
  if (status == LAG_ENAN && pb->bad_index >= 0) {
    lag_sim_state_info(s, pb->bad_index, name, sizeof name - 1, NULL, 0);
    strcat(name, "'");
  }
  if ((status == LAG_ESINGULAR || status == LAG_ESTEP) && !(m->flags & LAG_FIRST_ORDER)) {
    double condition = lag_mass_condition(&s->pb, s->run->t, s->now, &which);
    if (condition > (status == LAG_ESTEP ? 1e6 : 0)) {
      snprintf(advice, sizeof advice, "; the condition of %s is %s%.2g at the last good state, by the inertia of %s",
               status == LAG_ESTEP ? "the mass matrix" : "that", condition > 1e15 ? "above " : "",
               fmin(condition, 1e15), m->q[which].name);
    }
  }
  for (int i = 0; i < pb->n && i < 8 && used < sizeof text; i++) {
    char of[128];
    lag_sim_state_info(s, i, of, sizeof of, NULL, 0);
    used +=
        (size_t)snprintf(text + used, sizeof text - used, "%s%s = %.6g", i ? ", " : "", of, lag_sim_state_value(s, i));
  }
  if (status == LAG_ESTEP && fabs(pb->bad_t) * DBL_EPSILON > 1e-9)
    snprintf(advice, sizeof advice, ", or the time too late: times are %.1g s apart here",
             fabs(pb->bad_t) * DBL_EPSILON);
  if ((status == LAG_ENAN || status == LAG_EDOMAIN) && s->run->begun != 0.0) {
    if (h > 0)
      snprintf(advice, sizeof advice, "; steps of %.3g s may be too long for it: take smaller ones, or dop853", h);
    else if (status == LAG_EDOMAIN) snprintf(advice, sizeof advice, ", and no smaller step helps");
  }
  return lag_fail(s, status, "at t = %.9g s: %s%s%s%s%s%s%s; last good state, t = %.9g s: %s%s", pb->bad_t,
                  reason(m, status), name[0] ? " for " : "", name, pb->detail ? " (" : "", pb->detail ? pb->detail : "",
                  pb->detail ? ")" : "", advice, s->run->t, text, pb->n > 8 ? ", ..." : "");
}
