/* Turning points by a search outward from the start and bisection; the momenta of both branches by Newton's method about the extremum of H in p. */
#include "numeric/action_integral.h"

#include <float.h>
#include <math.h>
#include <stddef.h>
#include <stdint.h>

static const double PI = 3.14159265358979323846264338327950288;

typedef struct {
  lag_phase_fn *at;
  void *context;
  double E, middle; /* p where dH/dp = 0, near the last q */
  int sign;         /* of d2H/dp2 */
  int periodic;     /* q is an angle, and H repeats after a turn */
} Curve;

static const char *const goes_round = "it goes round";

static lag_phase_point point_at(Curve *c, double q, double p) { return c->at(c->context, q, p); }

/* --- momenta --- */

/* The extremum of H in p, by Newton's method with steps halved until |dH/dp| falls; exact in one step where H is quadratic. */
static lag_phase_point at_middle(Curve *c, double q) {
  enum { STEPS = 60, HALVES = 60 };
  lag_phase_point x = point_at(c, q, c->middle);
  for (int k = 0; k < STEPS && x.slope != 0 && isfinite(x.slope / x.bend); k++) {
    double step = x.slope / x.bend;
    if (fabs(step) <= DBL_EPSILON * fabs(c->middle)) break;
    lag_phase_point to = point_at(c, q, c->middle - step);
    for (int h = 0; h < HALVES && !(fabs(to.slope) < fabs(x.slope)); h++) to = point_at(c, q, c->middle - (step /= 2));
    if (!(fabs(to.slope) < fabs(x.slope))) break;
    c->middle -= step;
    x = to;
  }
  return x;
}

/* E - H at the extremum, positive where the motion may be. */
static double room(Curve *c, double q) {
  lag_phase_point x = at_middle(c, q);
  return c->sign * (c->E - x.H);
}

/* The momentum on the branch `side` (1, -1) at q, as a distance from c->middle; 0: none. */
static double branch(Curve *c, double q, int side, lag_phase_point *at) {
  enum { STEPS = 100 };
  lag_phase_point x = at_middle(c, q);
  double left = c->E - x.H, d = side * sqrt(fmax(2 * left / x.bend, 0)), last = INFINITY;
  *at = x;
  for (int k = 0; k < STEPS && d != 0; k++) {
    *at = point_at(c, q, c->middle + d);
    double step = (at->H - c->E) / at->slope;
    if (!isfinite(step) || fabs(step) >= last) break;
    last = fabs(step);
    if (last <= 2 * DBL_EPSILON * fabs(d)) break;
    d -= step;
  }
  return d;
}

/* Whether both branches exist at q, and H rises, or falls, all the way from its extremum to each: with more extrema in p the curve has other parts. */
static int has_two_branches(Curve *c, double q) {
  enum { PLACES = 16 };
  double extremum = at_middle(c, q).H, left = fabs(c->E - extremum), rounding = 64 * DBL_EPSILON * (fabs(c->E) + fabs(extremum));
  for (int side = -1; side <= 1; side += 2) {
    lag_phase_point at;
    double d = branch(c, q, side, &at);
    if (!(fabs(point_at(c, q, c->middle + d).H - c->E) <= 1e-6 * left + rounding)) return 0;
    for (int k = 1; k <= PLACES && left > rounding; k++)
      if (!(point_at(c, q, c->middle + d * k / PLACES).slope * d * c->sign > 0)) return 0;
  }
  return 1;
}

/* Reason against the curve through q, a place between its ends; NULL: none. */
static const char *reason_at(Curve *c, double q) {
  if (!(room(c, q) > 0)) return "H has a narrow barrier between the turning points that were found";
  return has_two_branches(c, q) ? NULL : "H is not convex in its momentum along the curve";
}

/* --- turning points --- */

/* The distance of the farther turning point of the parabola through the room at q, its slope, and the largest mean curvature from q to places near and far. */
static double scale_at(Curve *c, double q) {
  enum { DECADES = 9 };
  lag_phase_point x = at_middle(c, q);
  double size = fabs(q) > 0 ? fabs(q) : 1, left = fabs(c->E - x.H), slope = fabs(x.force), bend = 0, h = size;
  for (int k = 0; k < DECADES; k += 2, h /= 100)
    for (int side = -1; side <= 1; side += 2) {
      double mean = fabs(point_at(c, q + side * h, c->middle).force - x.force) / h;
      if (isfinite(mean) && mean > bend) bend = mean;
    }
  double length = bend > 0 ? (slope + sqrt(slope * slope + 2 * bend * left)) / bend : left / slope;
  return isfinite(length) && length > 0 ? length : size;
}

/* A place between a and c with no room, by golden section for the least room; NAN: there is none. The room at b, between them, is less than at both. */
static double place_without_room(Curve *curve, double a, double b, double c) {
  enum { STEPS = 60 };
  const double part = 0.381966011250105151795;
  double least = room(curve, b);
  for (int k = 0; k < STEPS && least > 0; k++) {
    double x = fabs(c - b) > fabs(b - a) ? b + part * (c - b) : b - part * (b - a), here = room(curve, x);
    int towards_c = (x > b) == (c > b);
    if (here < least) {
      if (towards_c) a = b;
      else c = b;
      b = x, least = here;
    } else if (towards_c) c = x;
    else a = x;
  }
  return least > 0 ? NAN : b;
}

/* Turning point on one side of q, where there is room; NAN, with the reason in *why: there is none. */
static double turning_point(Curve *c, double q, double step, const char **why) {
  enum { STEPS = 1500, HALVES = 200 };
  double behind = q, good = q, bad = q, last = 0, room_behind = INFINITY, room_good = room(c, q);
  for (int k = 0; k < STEPS; k++) {
    bad = good + step;
    last = room(c, bad);
    double gap = last > room_good && room_good < room_behind && good != q ? place_without_room(c, behind, good, bad) : NAN; /* a narrow barrier */
    if (isfinite(gap)) {
      good = behind, bad = gap, last = 0;
      break;
    }
    if (!(last > 0)) break;
    if (k % 4 == 0 && isfinite(last) && (*why = reason_at(c, bad))) return NAN; /* seldom, since it takes ten times as long; integrate() looks everywhere */
    if (c->periodic && fabs(bad - q) > 4 * PI) return *why = goes_round, NAN;
    behind = good, room_behind = room_good;
    good = bad, room_good = last;
    step *= 1.03;
  }
  if (last > 0 || !isfinite(bad)) return *why = "its motion does not turn", NAN;
  for (int k = 0; k < HALVES; k++) {
    double middle = (good + bad) / 2;
    if (middle == good || middle == bad) break;
    if (room(c, middle) > 0) good = middle;
    else bad = middle;
  }
  double left = room(c, good), size = fabs(c->E) + fabs(at_middle(c, good).H);
  if (left > 1e-9 * size) return *why = "its motion ends where H is singular, before it turns", NAN;
  return good;
}

/* --- the integrals --- */

/* Integrals of p and of dq/q' over the curve, by n points; side: of a curve that goes round, the branch; 0: it turns. */
static void midpoint_rule(Curve *c, double low, double high, int side, uint32_t n, double *J, double *time) {
  double centre = (low + high) / 2, half = (high - low) / 2;
  *J = *time = 0;
  for (uint32_t k = 0; k < n; k++) {
    double u = PI * (((double)k + 0.5) / n - 0.5), q = centre + half * (side ? 2 * u / PI : sin(u)), width = side ? 2 * half / n : half * cos(u) * PI / n;
    for (int branch_of = side ? side : -1; branch_of <= (side ? side : 1); branch_of += 2) {
      lag_phase_point at;
      double d = branch(c, q, branch_of, &at), way = side ? 1 : branch_of;
      *J += (side ? c->middle + d : branch_of * d) * width;
      if (d != 0) *time += way * width / at.slope;
    }
  }
}

static void integrate(Curve *c, int side, lag_action_integral *out) {
  enum { LEAST = 32, MOST = 1 << 16 };
  for (int k = 1; k < 2 * LEAST && !out->why_not; k++) out->why_not = reason_at(c, out->low + (out->high - out->low) * k / (2 * LEAST));
  if (out->why_not) return;
  double J = 0, time = 0, error = INFINITY, centre = (out->low + out->high) / 2, extremum = at_middle(c, centre).H;
  double cancelled = DBL_EPSILON * (fabs(c->E) + fabs(extremum)) / room(c, centre), enough = 1024 * DBL_EPSILON, last; /* the next difference would be its square */
  /* terms that cancel near the ends leave n times their rounding */
  for (uint32_t n = LEAST; n <= MOST && !(error <= fmax(enough, n * cancelled)); n *= 2) {
    double before = J, time_before = time;
    midpoint_rule(c, out->low, out->high, side, n, &J, &time);
    last = error;
    if (n > LEAST) error = fmax(fabs((J - before) / J), fabs((time - time_before) / time));
    if (n > LEAST && error < n * cancelled) error = n * cancelled;
    if (error < 1e-9 && error > last / 2) break; /* rounding of q */
  }
  out->J = (side ? J : fabs(J)) / (2 * PI);
  out->time = side ? time : fabs(time);
  out->error = error; /* at a corner of H the rule is of order 2: the difference is three times its error */
}

/* --- the curve --- */

/* Whether H is the same after a turn, as far as rounding shows. */
static int repeats(Curve *c, double q, double p) {
  enum { PLACES = 8 };
  int same = 1;
  for (int k = 0; k < PLACES; k++) {
    double at = q + 2 * PI * (k + 0.3) / PLACES;
    lag_phase_point x = point_at(c, at, p), y = point_at(c, at + 2 * PI, p);
    same &= fabs(x.H - y.H) <= 256 * DBL_EPSILON * (fabs(x.H) + fabs(c->E) + fabs(x.force) * (fabs(q) + 4 * PI));
  }
  return same;
}

/* Turning points of the curve through q, where it does not rest. */
static void find_ends(Curve *c, double q, double left, double size, double length, lag_action_integral *out) {
  double step = 1e-3 * length;
  if (left > 16 * DBL_EPSILON * size) {
    out->low = turning_point(c, q, -step, &out->why_not);
    if (!out->why_not) out->high = turning_point(c, q, step, &out->why_not);
    return;
  }
  int up = -c->sign * at_middle(c, q).force > 0;
  double inside = step;
  for (int k = 0; k < 40 && !(room(c, q + (up ? inside : -inside)) > 0); k++) inside /= 4;
  double far = turning_point(c, q + (up ? inside : -inside), up ? inside : -inside, &out->why_not);
  out->low = up ? q : far, out->high = up ? far : q;
}

lag_action_integral lag_action_of_curve(lag_phase_fn *at, void *context, double q, double p, int periodic) {
  Curve curve = {.at = at, .context = context, .middle = p}, *c = &curve;
  lag_action_integral out = {0};
  lag_phase_point x = point_at(c, q, p);
  c->E = x.H;
  c->sign = x.bend < 0 ? -1 : 1;
  if (!isfinite(x.H)) out.why_not = "H has no value at this state";
  else if (x.bend == 0 || !isfinite(x.bend)) out.why_not = "H is not curved in its momentum";
  if (out.why_not) return out;
  c->periodic = periodic && repeats(c, q, p);
  double left = room(c, q), size = fabs(c->E) + fabs(at_middle(c, q).H), length = scale_at(c, q);
  out.rests = left <= 16 * DBL_EPSILON * size && fabs(at_middle(c, q).force) * length <= 16 * DBL_EPSILON * size;
  if (out.rests) return out;
  find_ends(c, q, left, size, length, &out);
  out.rotates = out.why_not == goes_round;
  if (out.rotates) {
    at_middle(c, q);
    out.low = q, out.high = q + 2 * PI, out.why_not = NULL;
    integrate(c, p > c->middle ? 1 : -1, &out);
  } else if (!out.why_not) integrate(c, 0, &out);
  return out;
}
