/* Compatibility of constraints that are dependent at the start. Enters: a start on the constraints; leaves: LAG_OK, or the constraint that
 * contradicts the others soon after. x = 0 and x' = a t agree at t = 0 and nowhere else: without this check such a run would write its first row
 * and end after 1e-13 s. lagc check (claims/mobility.c) tests at the same time. */
#include <math.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"

int lag_constraint_compatibility(lag_sim *s)
{
  lag_problem *pb = &s->pb;
  const lag_constraints *of = pb->model->constraints;
  const lag_scene *scene = s->scene;
  double after = (scene->has_span ? scene->t1 - scene->t0 : 1) / 1024;
  int dependent = s->run->rank < of->n - pb->model->ncontacts, singular = s->run->beside > s->run->rank;

  if (!dependent || singular) {
    return LAG_OK;
  }
  lag_copy(pb->n, s->now, s->yc);
  int rc = lag_project(pb, scene->t0 + after, s->yc, NULL);
  const char *why = pb->detail;
  pb->detail = NULL;
  return rc > 0 && why ? lag_fail(s, LAG_EINVAL, "constraints contradict each other soon after the start: at t = %.3g s %s; leave one of them out, or make "
                                  "them agree", scene->t0 + after, why) : LAG_OK;
}
