/* Turning points by a search outward from the start and bisection; the momenta of both branches by Newton's method
 * about the extremum of H in p. Beside a saddle E - H is small against H: there it is the integral of the force from
 * the start, which has all digits. */
#include "numeric/action_integral.h"

#include <float.h>
#include <math.h>
#include <stddef.h>

#include "numeric/quadrature.h"

enum { POINTS = 10 };
static const double PI = 3.14159265358979323846264338327950288;

typedef struct {
  lag_phase_fn *at;
  void *context;
  double E, middle; /* p where dH/dp = 0, near the last q */
  double q, room;   /* of the start, or of a node */
  double noise;     /* rounding of H at the start */
  int sign;         /* of d2H/dp2 */
  int periodic;     /* q is an angle, and H repeats after a turn */
  double rounding;  /* of the last room */
  double node[POINTS], weight[POINTS]; /* Gauss's, in (0, 1) */
} Curve;

static const char *const goes_round = "it goes round";

/* q, or the same place within half a turn of the start. */
static double beside_start(const Curve *c, double q) {
  return c->periodic ? q - 2 * PI * round((q - c->q) / (2 * PI)) : q;
}

static lag_phase_point point_at(Curve *c, double q, double p) { return c->at(c->context, beside_start(c, q), p); }

/* --- momenta --- */

/* The extremum of H in p, by Newton's method with steps halved until |dH/dp| falls; exact in one step where H is
 * quadratic. */
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

/* H at the distance d from its extremum in p at q, less that extremum: by the integral of dH/dp
 * where rounding of H would show. */
static double height(Curve *c, double q, const lag_phase_point *extremum, double d) {
  double direct = point_at(c, q, c->middle + d).H - extremum->H, sum = 0;
  if (fabs(direct) > 0x1p40 * DBL_EPSILON * fabs(extremum->H)) return direct;
  for (int k = 0; k < POINTS; k++) sum += c->weight[k] * point_at(c, q, c->middle + c->node[k] * d).slope;
  return sum * d;
}

/* E - H at the extremum, positive where the motion may be; q is `way` from c->q. */
static double room_along(Curve *c, double q, double way) {
  lag_phase_point x = at_middle(c, q);
  double middle = c->middle, direct = c->sign * (c->E - x.H), sum = 0, size = 0;
  int beside = fabs(direct) <= 0x1p40 * c->noise;
  for (int k = 0; k < POINTS && beside; k++) {
    double part = c->weight[k] * at_middle(c, c->q + c->node[k] * way).force * way;
    sum += part, size += fabs(part);
  }
  c->middle = middle;
  double along = c->room - c->sign * sum;
  beside = beside && fabs(along - direct) <= 64 * c->noise; /* else H is too rough for so few points */
  c->rounding = DBL_EPSILON * (beside ? size + fabs(x.force * q) : fabs(c->E) + fabs(x.H));
  return beside ? along : direct;
}

static double room(Curve *c, double q) { return room_along(c, q, beside_start(c, q) - c->q); }

/* The momentum on the branch `side` (1, -1) at q, where the room is `left`, as a distance from c->middle; 0: none. */
static double branch(Curve *c, double q, double left, int side, lag_phase_point *at) {
  enum { STEPS = 100 };
  double last = INFINITY;
  lag_phase_point x = at_middle(c, q);
  double d = side * sqrt(fmax(2 * c->sign * left / x.bend, 0));
  *at = x;
  for (int k = 0; k < STEPS && d != 0; k++) {
    *at = point_at(c, q, c->middle + d);
    double step = (height(c, q, &x, d) - c->sign * left) / at->slope;
    if (!isfinite(step) || fabs(step) >= last) break;
    last = fabs(step);
    if (last <= 2 * DBL_EPSILON * fabs(d)) break;
    d -= step;
  }
  return d;
}

/* Whether both branches exist at q, and H rises, or falls, all the way from its extremum to each: with more extrema
 * in p the curve has other parts. */
static int has_two_branches(Curve *c, double q) {
  enum { PLACES = 16 };
  double extremum = at_middle(c, q).H, left = fabs(c->E - extremum),
         rounding = 64 * DBL_EPSILON * (fabs(c->E) + fabs(extremum));
  for (int side = -1; side <= 1; side += 2) {
    lag_phase_point at;
    double d = branch(c, q, room(c, q), side, &at);
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

/* The distance of the farther turning point of the parabola through the room at q, its slope, and
 * *most, the largest mean curvature from q to places near and far. */
static double scale_at(Curve *c, double q, double *most) {
  enum { DECADES = 9 };
  lag_phase_point x = at_middle(c, q);
  double size = fabs(q) > 0 ? fabs(q) : 1, left = fabs(room(c, q)), slope = fabs(x.force), bend = 0, h = size;
  for (int k = 0; k < DECADES; k += 2, h /= 100)
    for (int side = -1; side <= 1; side += 2) {
      lag_phase_point there = point_at(c, q + side * h, c->middle);
      double mean = fabs(there.force - x.force) / h;
      int beyond = !(c->sign * (c->E - there.H) > -1e3 * left); /* a wall far outside says nothing about the curve */
      if (isfinite(mean) && mean > bend && !beyond) bend = mean;
    }
  *most = bend;
  double length = bend > 0 ? (slope + sqrt(slope * slope + 2 * bend * left)) / bend : left / slope;
  return isfinite(length) && length > 0 ? length : size;
}

/* A place between a and c with no room, by golden section for the least room; NAN: there is none. The room at b,
 * between them, is less than at both. */
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
  double first = step, behind = q, good = q, bad = q, last = 0, room_behind = INFINITY, room_good = room(c, q);
  for (int k = 0; k < STEPS; k++) {
    bad = good + step;
    last = room(c, bad);
    /* a narrow barrier */
    double gap =
        last > room_good && room_good < room_behind && good != q ? place_without_room(c, behind, good, bad) : NAN;
    if (isfinite(gap)) {
      good = behind, bad = gap, last = 0;
      break;
    }
    if (!(last > 0)) break;
    /* seldom, since it takes ten times as long; integrate() looks everywhere */
    if (k % 4 == 0 && isfinite(last) && (*why = reason_at(c, bad))) return NAN;
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
  double inside = fabs(good - q) > fabs(first) ? good + 1e-3 * (q - good) : good - 1e-3 * first;
  if (room(c, good) > 1e-2 * room(c, inside)) return *why = "its motion ends where H is singular, before it turns", NAN;
  return good;
}

/* --- the integrals --- */

/* A part of the curve, from a node, where the room is least or 0, to a place `step` from it. There
 * q = at + step v^2 about a turning point, with v = near sinh(w), and q = at + step near sinh(w)
 * about a minimum: the square roots that are near the node lie far from the real axis of w. */
typedef struct {
  double at, step, near, room;
  int turns;
} Panel;

enum { NODES_MOST = 16, GAUSS_MOST = 1024 };

/* The largest mean curvature of the room from q to places inside the panel. */
static double bend_at(Curve *c, double q, double step) {
  double bend = 0, force = at_middle(c, q).force;
  for (double h = step; fabs(h) > 1e-12 * fabs(step); h /= 4)
    bend = fmax(bend, fabs((at_middle(c, q + h).force - force) / h));
  return bend;
}

/* The panel from a node. Adds to *doubt the error of the period by rounding of E - H, which decides
 * how long the motion stays beside a saddle. */
static Panel panel_from(Curve *c, double at, double step, int turns, double *doubt) {
  double left = fmax(room(c, at), 0), rounding = c->rounding, bend = bend_at(c, at, step);
  lag_phase_point x = at_middle(c, at);
  double depth = turns ? x.force * x.force / (2 * bend) : left;
  double near = turns ? sqrt(2 * fabs(x.force / (bend * step))) : sqrt(2 * left / bend) / fabs(step);
  double part = rounding / depth; /* a tenth: E may be that of the saddle */
  if (bend > 0) *doubt += part < 0.1 ? part / sqrt(bend * fabs(x.bend)) : INFINITY;
  return (Panel){at, step, isfinite(near) && near < 1 ? fmax(near, 1e-15) : 1, turns ? 0 : left, turns};
}

/* Adds the integrals of p and of dq/q' over a panel to sum[2], by n points and the weights behind them;
 * side: of a curve that goes round, the branch; 0: it turns. */
static void add_panel(Curve *c, const Panel *x, int side, int n, const double *node, double sum[2]) {
  const double *weight = node + GAUSS_MOST;
  double whole = asinh(1 / x->near);
  c->q = x->at, c->room = x->room; /* from here rooms are integrated */
  for (int k = 0; k < n; k++) {
    double w = node[k] * whole, v = x->near * sinh(w), way = x->step * (x->turns ? v * v : v), q = x->at + way,
           left = room_along(c, q, way);
    double width = fabs(x->step) * x->near * cosh(w) * whole * weight[k] * (x->turns ? 2 * v : 1);
    for (int branch_of = side ? side : -1; branch_of <= (side ? side : 1); branch_of += 2) {
      lag_phase_point at;
      double d = branch(c, q, left, branch_of, &at), sense = side ? 1 : branch_of;
      sum[0] += (side ? c->middle + d : branch_of * d) * width;
      if (d != 0) sum[1] += sense * width / at.slope;
    }
  }
}

/* A place between a and b where dH/dq jumps, as at a corner of H; NAN: none. */
static double corner(Curve *c, double a, double b) {
  enum { HALVES = 100 };
  double fa = at_middle(c, a).force, fb = at_middle(c, b).force, jump = fabs(fb - fa);
  if (!(jump > 1e-6 * (fabs(fa) + fabs(fb)))) return NAN;
  for (int k = 0; k < HALVES; k++) {
    double middle = (a + b) / 2, f = at_middle(c, middle).force, first = fabs(f - fa), second = fabs(fb - f);
    if (fmax(first, second) < 0.7 * jump) return NAN; /* half, where H is smooth */
    if (middle == a || middle == b) break;
    if (first > second) b = middle, fb = f;
    else a = middle, fa = f;
  }
  return (a + b) / 2;
}

/* Ends of the curve, and minima of the room and corners of H between them, ascending in node[].
 * Returns their number. */
static int find_nodes(Curve *c, double low, double high, double *node) {
  enum { PLACES = 64, HALVES = 80 };
  double h = (high - low) / PLACES;
  int n = 1;
  node[0] = low;
  for (int k = 1; k < PLACES && n < NODES_MOST - 2; k++) {
    double at = low + k * h, here = room(c, at), bent = corner(c, at, at + h);
    if (isfinite(bent)) node[n++] = bent;
    else if (!(here < room(c, at - h)) || !(here <= room(c, at + h))) continue;
    else {
      double a = fmax(at - h, node[n - 1]), b = at + h;
      for (int i = 0; i < HALVES; i++) *(c->sign * at_middle(c, (a + b) / 2).force > 0 ? &a : &b) = (a + b) / 2;
      node[n++] = (a + b) / 2;
    }
  }
  node[n++] = high;
  return n;
}

static void integrate(Curve *c, int side, lag_action_integral *out) {
  enum { PLACES = 64, LEAST = 16 };
  for (int k = 1; k < PLACES && !out->why_not; k++)
    out->why_not = reason_at(c, out->low + (out->high - out->low) * k / PLACES);
  if (out->why_not) return;
  double ends[NODES_MOST], points[2 * GAUSS_MOST], sum[2] = {0, 0}, doubt = 0, last_J, last_time;
  Panel panels[2 * NODES_MOST];
  int nodes = find_nodes(c, out->low, out->high, ends), count = 0;
  for (int k = 0; k + 1 < nodes; k++) {
    double half = (ends[k + 1] - ends[k]) / 2;
    panels[count++] = panel_from(c, ends[k], half, !side && k == 0, &doubt);
    panels[count++] = panel_from(c, ends[k + 1], -half, !side && k + 2 == nodes, &doubt);
  }
  out->error = out->time_error = INFINITY;
  for (int n = LEAST; n <= GAUSS_MOST; n *= 2) {
    const double before = sum[0], time_before = sum[1];
    last_J = out->error, last_time = out->time_error;
    sum[0] = sum[1] = 0;
    lag_gauss_points(n, points, points + GAUSS_MOST);
    for (int k = 0; k < count; k++) add_panel(c, &panels[k], side, n, points, sum);
    if (n == LEAST) continue;
    out->error = fabs((sum[0] - before) / sum[0]), out->time_error = fabs((sum[1] - time_before) / sum[1]);
    double worst = fmax(out->error, out->time_error);
    if (worst <= 1024 * DBL_EPSILON || (worst < 1e-9 && worst > fmax(last_J, last_time) / 2)) break; /* rounding of q */
  }
  out->J = (side ? sum[0] : fabs(sum[0])) / (2 * PI);
  out->time = side ? sum[1] : fabs(sum[1]);
  out->time_error += fabs((side ? 1 : 2) * doubt / sum[1]);
  if (!isfinite(out->time_error))
    out->why_not = "it lies on a separatrix, as far as the digits of its start tell: the motion takes for ever";
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
static void find_ends(Curve *c, double q, double length, lag_action_integral *out) {
  double step = 1e-3 * length;
  if (c->room > 0) {
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
  Curve curve = {.at = at, .context = context, .middle = p, .q = q}, *c = &curve;
  lag_action_integral out = {0};
  lag_phase_point x = point_at(c, q, p);
  c->E = x.H;
  c->sign = x.bend < 0 ? -1 : 1;
  if (!isfinite(x.H)) out.why_not = "H has no value at this state";
  else if (x.bend == 0 || !isfinite(x.bend)) out.why_not = "H is not curved in its momentum";
  if (out.why_not) return out;
  c->periodic = periodic && repeats(c, q, p);
  lag_gauss_points(POINTS, c->node, c->weight);
  x = at_middle(c, q);
  double d = p - c->middle, bend;
  d = fabs(d) > 16 * DBL_EPSILON * fabs(c->middle) ? d : 0;
  c->room = c->sign * height(c, q, &x, d);
  c->noise = DBL_EPSILON * (fabs(c->E) + fabs(x.H));
  double length = scale_at(c, q, &bend);
  out.rests = d == 0 && fabs(x.force) <= 16 * DBL_EPSILON * bend * fabs(q);
  if (out.rests) return out;
  find_ends(c, q, length, &out);
  out.rotates = out.why_not == goes_round;
  if (out.rotates) {
    at_middle(c, q);
    out.low = q, out.high = q + 2 * PI, out.why_not = NULL;
    integrate(c, p > c->middle ? 1 : -1, &out);
  } else if (!out.why_not) integrate(c, 0, &out);
  return out;
}
