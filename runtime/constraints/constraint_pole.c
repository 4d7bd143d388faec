/* Detects steps across a pole of the motion that constraints prescribe in time, as x = 1/(t - 1)^2 and x = tan(t). Enters: a step whose ends
 * obey the constraints; leaves: whether the prescribed motion goes through infinity in between. A sign cannot tell: not of a pole of even order,
 * nor of a step as long as a branch of the tangent.
 *
 * A step is examined where the constraints put its middle elsewhere than the cubic through its ends: for a smooth motion of frequency w the
 * difference is (w step)^3/384 of the way. Then the interval is bisected towards the larger velocity, down to the last digits of t. Over a pole
 * of order p its length times the smaller velocity of its ends grows by 2^p a turn; over anything finite, however steep, it falls by 2 from some
 * turn on. */
#include <float.h>
#include <math.h>
#include <stdio.h>

#include "core/core.h"
#include "core/rhs.h"

enum { MOST_TURNS = 64, LEAST_TURNS = 16, LOOK_BACK = 8 };

/* q and v of y[n] := the middle of the cubic through the ends of a step of length dt; z: the mean. */
static void middle(const lag_problem *pb, double dt, const double *y0, const double *y1, double *y)
{
  int nq = pb->nq;

  for (int i = 0; i < nq; i++) {
    double v0 = y0[nq + i], v1 = y1[nq + i];
    y[i] = y0[i] + (y1[i] - y0[i]) / 2 + dt * (v0 - v1) / 8;
    y[nq + i] = 1.5 * ((y1[i] - y0[i]) / dt) - (v0 + v1) / 4;
  }
  for (int i = 2 * nq; i < pb->n; i++) {
    y[i] = y0[i] + (y1[i] - y0[i]) / 2;
  }
}

/* The coordinate whose position or velocity in the middle y of a step the constraints put farthest from the cubic, relative to the motion of the
 * step; both are compared, as either may agree by chance. -1: none is farther than in a smooth motion whose period is more than two steps. c[],
 * r[], d[] and force[] are scratch. */
static int find_doubtful(lag_problem *pb, double t, double dt, const double *y0, const double *y1, const double *y, double *c, double *r, double *d,
                         double *force)
{
  const double doubtful = 0.05, rounding = 1e-6;
  const lag_constraints *of = pb->model->constraints;
  int nq = pb->nq, which = -1;
  double most = doubtful;

  for (int holonomic = 1; holonomic >= 0; holonomic--) {
    double *off = holonomic ? c : r, part = holonomic ? fabs(dt) : 1;
    if (holonomic && of->nholonomic == 0) {
      continue;
    }
    if (lag_residuals(pb, t, y, c, r)) {
      return 0;
    }
    for (int k = 0; k < of->n; k++) {
      off[k] = -off[k];
    }
    if (lag_least_change(pb, t, y, holonomic, off, d, force) || lag_not_finite(nq, d) >= 0) {
      return 0;
    }
    for (int i = 0; i < nq; i++) {
      double size = part * fmax(fmax(fabs(y0[nq + i]), fabs(y1[nq + i])), fabs((y1[i] - y0[i]) / dt));
      double reach = lag_typical_magnitude(pb, y0, 1, i), lost = 64 * DBL_EPSILON * reach / fabs(dt); /* lost: rounding of the velocity of a short chord */
      double small = holonomic ? rounding * reach : fmax(rounding * fmax(lag_unit_magnitude(pb, y0 + nq, i), lag_unit_magnitude(pb, y1 + nq, i)), lost);
      if (fabs(d[i]) > most * size && fabs(d[i]) > small) {
        most = fabs(d[i]) / size;
        which = i;
      }
    }
  }
  return which;
}

/* The constraint that changes fastest in time at y; sets v of y to 0. */
static int find_driver(lag_problem *pb, double t, double *y, double *c, double *r)
{
  int which = 0;

  for (int i = 0; i < pb->nq; i++) {
    y[pb->nq + i] = 0;
  }
  if (lag_residuals(pb, t, y, c, r)) {
    return 0;
  }
  for (int k = 1; k < pb->model->constraints->n; k++) {
    which = !(fabs(r[k]) <= fabs(r[which])) ? k : which;
  }
  return which;
}

static int report_pole(lag_problem *pb, double t, int i, int k)
{
  const lag_constraint *c = &pb->model->constraints->of[k];
  char line[32];

  snprintf(pb->words, sizeof pb->words, "at t = %.9g s constraint %s%s prescribes a motion of %s with a pole, which no step can cross", t, c->name,
           lag_line_text(c, line), pb->model->q[i].name);
  pb->detail = pb->words;
  pb->bad_t = t;
  return LAG_ERETRY;
}

/* One bisection of the interval from a at *from to b at *to: keeps the half next to the end where coordinate i is faster. y[n] is scratch.
 * Returns 0; > 0: the constraints have no value in the middle, *t; < 0: Newton's method finds no state there, which proves nothing. */
static int halve(lag_problem *pb, int i, double *from, double *to, double *t, double *a, double *b, double *y, double *c, double *r)
{
  static const double parts[] = {0.5, 0.45, 0.55};
  int found = 0, n = pb->n, first = fabs(a[pb->nq + i]) > fabs(b[pb->nq + i]);

  for (size_t k = 0; k < sizeof parts / sizeof *parts && !found; k++) {
    *t = *from + parts[k] * (*to - *from);
    middle(pb, *to - *from, a, b, y);
    if (lag_residuals(pb, *t, y, c, r) || lag_not_finite(pb->model->constraints->n, r) >= 0) {
      return 1;
    }
    found = lag_project(pb, *t, y, NULL) == 0;
  }
  if (found) {
    lag_copy(n, y, first ? b : a);
    *(first ? to : from) = *t;
  }
  return found ? 0 : -1;
}

int lag_crosses_constraint_pole(lag_problem *pb, double t0, const double *y0, double t1, const double *y1)
{
  const lag_constraints *of = pb->model->constraints;

  if (!of || pb->model->flags & LAG_AUTONOMOUS || lag_not_finite(pb->n, y1) >= 0) { /* the method reports states that are not finite */
    return LAG_OK;
  }
  int n = pb->n, nq = pb->nq, rc = 0;
  double *a = pb->held + lag_constraint_scratch_size(pb->model) - 4 * n - 4 * of->n - 2 * nq, *b = a + n, *y = b + n; /* scratch before that of lag_rhs_prepare */
  double *r = y + n, *c = r + of->n, *d = c + of->n, *force = d + nq, *terms = force + nq, from = t0, to = t1, t = t0, sizes[LOOK_BACK] = {0};
  middle(pb, t1 - t0, y0, y1, y);
  int i = find_doubtful(pb, t0 + (t1 - t0) / 2, t1 - t0, y0, y1, y, c, r, d, force);
  if (i < 0) {
    return LAG_OK;
  }
  const char *said = pb->detail;
  lag_copy(n, y0, a);
  lag_copy(n, y1, b);
  lag_copy(2 * of->n, lag_last_term_sizes(pb), terms); /* terms found beside a pole would excuse any residual */
  int pole = 1;
  for (int turn = 0; turn < MOST_TURNS && fabs(to - from) > 8 * DBL_EPSILON * fmax(fabs(from), fabs(to)) && pole && rc == 0; turn++) {
    double now = fabs(to - from) * fmin(fabs(a[nq + i]), fabs(b[nq + i]));
    pole = turn < LEAST_TURNS || (now > 0 && now >= 0x1p4 * sizes[turn % LOOK_BACK]); /* of an expected 2^6 or more */
    sizes[turn % LOOK_BACK] = now;
    rc = halve(pb, i, &from, &to, &t, a, b, y, c, r);
    pole &= rc >= 0;
  }
  lag_copy(2 * of->n, terms, lag_last_term_sizes(pb));
  pb->detail = said;
  return pole ? report_pole(pb, t, i, find_driver(pb, t, y, c, r)) : LAG_OK;
}
