/* Detects steps of equal size across a pole of a force or a flow, as 1/x^2 has at x = 0: what a method computes
 * beyond the pole is no motion of the model. Enters: a step that a method has made, from s->now to s->y; leaves:
 * whether a derivative goes through infinity within it. Adaptive methods stop in front of a pole by themselves, as
 * their steps become too small.
 *
 * A step is examined where the rate of change of a velocity or a state is unlike that of the two steps before: the
 * second difference is a tenth of the largest change (in a resolved motion it is (w step)^2 of it), or the change is
 * a peak, four times that of two steps before. Evaluations are bounded: at most a quarter as many as steps, and
 * rates that are small beside their recent peak, as where a force goes through 0, a sixteenth. Then the straight
 * line between the step's ends is bisected towards the end with the larger derivative. Across a pole of order p, the
 * interval's length times the smaller derivative at its ends grows by 2^(p-1) per bisection; for anything finite,
 * however steep, it is halved from some bisection on, and at the integrable end of a square root divided by sqrt 2.
 * Steps along Kepler ellipses are left out: the line between their ends may go through the centre.
 * */
#include <float.h>
#include <math.h>

#include "core/core.h"

enum { TURNS = 24, LEAST_TURNS = 12, BACK = 4, FREE_CALLS = 12, CALLS_FIRST = 48 };
/* Operations of a model whose first searches would cost more than a short run: some rate of many bodies is rough. */
enum { LARGE = 1000000, CALLS_FIRST_LARGE = 3 };

/* Updates the rates of change of components nq to n; returns the component whose rate is rough (see above) and
 * largest relative to its size; -1: none. slight: rates that are small beside their recent peak count, too. */
static int find_rough(lag_sim *s, double t, int slight) {
  const double rough = 0.1, rounding = 1e-9, steep = 4, fading = 0.99;
  int nq = s->pb.nq, n = s->pb.n, which = -1;
  double most = 0, dt = t - s->run->t, *one = s->rate_history, *two = one + n, *peak = two + n;
  for (int i = nq; i < n; i++) {
    double pace = (s->y[i] - s->now[i]) / dt, size = fabs(pace), bend = fabs(pace - 2 * one[i] + two[i]),
           faded = fading * peak[i];
    double large = slight || isnan(faded) ? 0 : faded;
    int grows = size > steep * fabs(two[i]) && size > peak[i];
    if (grows || !(bend <= rough * size)) { /* NaN after the first two steps: rates not known yet */
      double largest = fmax(fmax(size, large), fmax(fabs(one[i]), fabs(two[i]))),
             part = (isnan(bend) ? largest : bend) / fmax(fabs(s->now[i]), DBL_MIN);
      int counts =
          (grows || !(bend <= rough * largest)) && largest * fabs(dt) > rounding * fabs(s->now[i]) && part > most;
      most = counts ? part : most;
      which = counts ? i : which;
    }
    two[i] = one[i];
    one[i] = pace;
    peak[i] = size > faded || isnan(faded) ? size : faded;
  }
  return which;
}

void lag_reset_rate_history(lag_sim *s) {
  for (int i = 0; i < 3 * s->pb.n; i++) s->rate_history[i] = NAN;
}

/* The derivative of component i at fraction x of the straight line from now to y at t; NaN: no
 * value. Leaves the state in ya; uses yb. Dense output would not do: its velocities are wild beside
 * a pole. */
static double derivative_at(lag_sim *s, double x, double t, int i) {
  for (int k = 0; k < s->pb.n; k++) s->ya[k] = s->now[k] + x * (s->y[k] - s->now[k]);
  return lag_rhs(&s->pb, s->run->t + x * (t - s->run->t), s->ya, s->yb) ? NAN : s->yb[i];
}

/* The fraction of the step at which the derivative of component i has a pole; NaN: it has none. */
static double find_pole(lag_sim *s, double t, int i) {
  static const double parts[] = {0.5, 0.45, 0.55};
  const double falls = 0.4; /* in BACK turns; a pole of first order keeps half or more, a root a third or less */
  /* at both ends and in the middle of a step over a pole derivatives differ by more, or in sign */
  const double alike = 2.5;
  double from = 0, to = 1, a = derivative_at(s, from, t, i), b = derivative_at(s, to, t, i),
         middle = derivative_at(s, 0.5, t, i), before[BACK] = {0};
  double least = fmin(a, fmin(b, middle)), most = fmax(a, fmax(b, middle));
  if (least * most > 0 && fmax(fabs(least), fabs(most)) <= alike * fmin(fabs(least), fabs(most)) &&
      isfinite(a + b + middle))
    return NAN;
  a = fabs(a), b = fabs(b);
  for (int turn = 0; turn < TURNS; turn++) {
    double size = (to - from) * fmin(a, b), x = from, c = NAN;
    if (!(size > 0) || (turn >= BACK && size < falls * before[turn % BACK])) return NAN;
    before[turn % BACK] = size;
    for (size_t k = 0; k < sizeof parts / sizeof *parts && !isfinite(c); k++) {
      x = from + parts[k] * (to - from);
      c = fabs(turn || k ? derivative_at(s, x, t, i) : middle);
    }
    if (!isfinite(c)) return turn > LEAST_TURNS ? x : NAN;
    *(a > b ? &to : &from) = x;
    *(a > b ? &b : &a) = c;
  }
  return from;
}

int lag_crosses_force_pole(lag_sim *s, double t) {
  lag_problem *pb = &s->pb;
  const int first = pb->model->ops < LARGE ? CALLS_FIRST : CALLS_FIRST_LARGE;
  double *spent = &s->run->pole_calls, steps = s->run->steps, calls = pb->rhs_calls;
  const int lines = s->steps_equal && !pb->model->constraints && !(s->method->flags & LAG_METHOD_KEPLER);
  int i = lines ? find_rough(s, t, *spent <= FREE_CALLS + steps / 16) : -1;
  if (i < 0 || *spent > first + steps / 4) return LAG_OK;
  double pole = find_pole(s, t, i);
  *spent += pb->rhs_calls - calls;
  if (isnan(pole)) return LAG_OK;
  char name[128];
  lag_sim_state_info(s, i, name, sizeof name, NULL, 0);
  return lag_note(pb, LAG_EDOMAIN, s->run->t + pole * (t - s->run->t), "a pole of %s', which no motion crosses", name);
}
