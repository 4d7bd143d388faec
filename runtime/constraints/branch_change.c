/* Detects a step of equal size, or of radau, that continues another motion than the one that led to it. Enters: a
 * step that a method has made, from s->now to s->y; leaves: whether the run is to end, and why.
 *
 * Several motions meet where constraints become dependent, as of bars that come to lie in one line. A step that ends
 * there, or near there on another branch, has velocities at its ends whose mean is not the displacement over the
 * time. Without this check a rhomb went on with another energy. rk45 and dop853 choose the ends of their steps so
 * that they pass (methods/adaptive_rk.c), except with adapt=off. */
#include <math.h>

#include "core/core.h"

/* |displacement/dt - mean of the velocities at the ends|, relative to these velocities; of order step^2 where the
 * motion is smooth. 0 at rest, where all of it is rounding. */
static double detour(const lag_problem *pb, double dt, const double *y0, const double *y) {
  const double rounding = 1e-12;
  const int nq = pb->nq;
  const lag_var *q = pb->model->q;
  double most = 0, size = 0, typical = 0;
  for (int i = 0, of = -1; i < nq; i++) {
    double off = fabs((y[i] - y0[i]) / dt - (y[nq + i] + y0[nq + i]) / 2);
    /* else velocities of the same unit cannot make it larger */
    if (off > most * fmax(fabs(y[nq + i]), fabs(y0[nq + i]))) {
      if (of < 0 || !lag_are_alike(&q[i], &q[of])) {
        size = fmax(lag_unit_magnitude(pb, y + nq, i), lag_unit_magnitude(pb, y0 + nq, i));
        typical = lag_typical_magnitude(pb, y0, 1, i);
        of = i;
      }
      most = off * fabs(dt) > rounding * typical ? fmax(most, off / size) : most;
    }
  }
  return most;
}

/* Whether constraint *k is a tenth as independent at y, t as the weakest one was at the start; of a start in a
 * singular position, as any could be. */
static int is_near_singular(lag_sim *s, double t, const double *y, int *k, double *apart) {
  const double near_by = 0.1;
  int weakest;
  double at_start = s->run->beside > s->run->rank ? 1 : lag_independence(&s->pb, s->scene->t0, s->begin, &weakest);
  *apart = lag_independence(&s->pb, t, y, k);
  return *apart < near_by * at_start;
}

int lag_changes_branch(lag_sim *s, double t) {
  const double wrong = 0.05;
  lag_problem *pb = &s->pb;
  int k;
  double apart;
  char line[32];
  if (!pb->model->constraints || !(s->steps_equal || s->method->flags & LAG_METHOD_JACOBIAN) ||
      detour(pb, t - s->run->t, s->now, s->y) <= wrong ||
      !(is_near_singular(s, t, s->y, &k, &apart) || is_near_singular(s, s->run->t, s->now, &k, &apart))) {
    return LAG_OK;
  }
  const lag_constraint *weakest = &pb->model->constraints->of[k];
  return lag_note(pb, LAG_EMETHOD, t,
                  "several motions meet here, and the step continues another one than the present: constraint %s%s is "
                  "within %.1g of "
                  "being redundant; take rk45 or dop853, which choose steps that pass, or another step",
                  weakest->name, lag_line_text(weakest, line), apart);
}
