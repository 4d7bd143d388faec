/* Outputs of a state: what a scene observes. Near a position where constraints become dependent, s being how independent they still are,
 * multipliers and accelerations of the state there have an error of at least eps/s^2, and of what the state is off by over s^2 (measured:
 * 1e-8 at s = 0.01, 2e21 at 1e-11): where s < 1e-3 their values are those that they tend to along the motion.
 *
 * Holds: outputs that contain no force are those of the state, everywhere. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"

/* How much of the terms of constraint k, size, its derivatives make when each coordinate moves as far as some of its unit are: at most 1. */
static double slope(const lag_problem *pb, const double *y, const double *row, double size)
{
  double s = 0;

  for (int i = 0; i < pb->nq; i++) {
    s += row[i] != 0.0 ? fabs(row[i]) * lag_reach(pb, y, 1, i) : 0;
  }
  return size > 0 ? fmin(s / size, 1) : 1;
}

double lag_independence(lag_problem *pb, double t, const double *y, int *weakest)
{
  const lag_constraints *of = pb->model->constraints;
  const double follows = pb->redundant ? 1e-9 : 0; /* what is less follows always */
  int nq = pb->nq, n = of->n, r = 0;
  double least = 1, *A = lag_independence_room(pb), *unit = A + n * nq, *size = unit + nq;
  int rc = lag_constraint_rows(pb, t, y, A, unit, NULL);

  *weakest = -1;
  rc = rc || (of->nholonomic > 0 && lag_constraint_terms(pb, t, y, 1, size));
  for (int k = 0; k < n && rc == 0; k++) {
    double *row = A + k * nq, part = k < of->nholonomic ? slope(pb, y, row, size[k]) : 1, left = fmax(lag_own_part(nq, r, follows, unit, A, row), 0);
    if (left * part > follows && left * part < least) {
      least = left * part;
      *weakest = k;
    }
    r += left > follows;
  }
  return least;
}

static int observe(lag_sim *s, double t, const double *y, double *out)
{
  const lag_scene *c = s->scene;
  int rc = lag_inputs(&s->pb, t);

  rc = rc ? rc : lag_exact_at(s, t);
  return rc ? rc : c->observe(t, y, y + s->pb.nq, y + 2 * s->pb.nq, s->p, s->u, out, s->work);
}

/* How far apart in time, and on which side of t, to look at four places within the step that are far from the singular one; 0: there is no step,
 * or it has no such places. y[n] is scratch. */
static double find_side(lag_sim *s, double t, double *y)
{
  const double good = 5e-2, enough = 1e-4; /* the latter where a step is no longer */
  const Run *r = s->run;
  double back = r->have_step != 0.0 ? r->step_t0 - t : 0, on = r->have_step != 0.0 ? r->limit - t : 0, room = (fabs(back) > fabs(on) ? back : on) / 4;
  int weakest;

  for (double part = 0x1p-20; part <= 1 && room != 0.0; part *= 2) {
    double apart = part * room;
    if (fabs(apart) > 64 * DBL_EPSILON * fabs(t) && lag_between(s, t + apart, y) == 0 &&
        lag_independence(&s->pb, t + apart, y, &weakest) >= (part < 1 ? good : enough)) {
      return apart;
    }
  }
  return 0;
}

/* Forces among out[nout] := what they tend to along the motion, by a cubic through four places, or NaN where that is not known. */
static int replace_forces(lag_sim *s, double t, double *out)
{
  static const double weight[] = {4, -6, 4, -1};
  const lag_scene *c = s->scene;
  size_t n = (size_t)s->pb.n, nout = (size_t)c->nout;
  double *y = calloc(n + nout, sizeof *y), *there = y + n, apart = y ? find_side(s, t, y) : 0;
  int rc = y ? 0 : LAG_ENOMEM;

  for (int i = 0; i < c->nout; i++) {
    out[i] = c->forces[i] ? (apart != 0.0 ? 0 : NAN) : out[i];
  }
  for (int k = 0; k < 4 && apart != 0.0 && rc == 0; k++) {
    rc = lag_between(s, t + (k + 1) * apart, y);
    rc = rc ? rc : observe(s, t + (k + 1) * apart, y, there);
    for (int i = 0; i < c->nout && rc == 0; i++) {
      out[i] += c->forces[i] ? weight[k] * there[i] : 0;
    }
  }
  free(y);
  return rc;
}

int lag_observe(lag_sim *s, double t, const double *y, double *out)
{
  const double doubtful = 1e-3;
  int weakest, rc = observe(s, t, y, out);

  if (rc == 0 && s->scene->forces && s->scene->model->constraints && lag_independence(&s->pb, t, y, &weakest) < doubtful) {
    rc = replace_forces(s, t, out);
  }
  return rc;
}
