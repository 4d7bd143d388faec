/* Turning points by a search outward from the start and bisection; the momenta of both branches by Newton's method about the extremum of H in p. */
#include "symmetry/action_variables.h"

#include <float.h>
#include <math.h>

#include "mech/consistent_start.h"
#include "mech/discontinuity.h"
#include "sym/diff.h"
#include "sym/eval.h"
#include "sym/simplify.h"

typedef long double Real;

static const Real PI = 3.14159265358979323846264338327950288L;

/* H of one pair, the others as at the start. */
typedef struct {
  EvalTape *tape; /* H, dH/dp, d2H/dp2, dH/dq */
  Real *symbols;
  SymId q, p;
  Real E, middle; /* p where dH/dp = 0, near the last q */
  int sign;       /* of d2H/dp2 */
  int periodic;
} Curve;

typedef struct {
  Real H, slope, bend, force; /* dH/dp, d2H/dp2, dH/dq */
} Point;

static Point point_at(Curve *c, Real q, Real p) {
  Real out[4];
  c->symbols[c->q] = q;
  c->symbols[c->p] = p;
  eval_run(c->tape, c->symbols, out);
  return (Point){out[0], out[1], out[2], out[3]};
}

/* --- momenta --- */

/* The extremum of H in p, by Newton's method with steps halved until |dH/dp| falls; exact in one step where H is quadratic. */
static Point at_middle(Curve *c, Real q) {
  enum { STEPS = 60, HALVES = 60 };
  Point x = point_at(c, q, c->middle);
  for (int k = 0; k < STEPS && x.slope != 0 && isfinite(x.slope / x.bend); k++) {
    Real step = x.slope / x.bend;
    Point to = point_at(c, q, c->middle - step);
    for (int h = 0; h < HALVES && !(fabsl(to.slope) < fabsl(x.slope)); h++) to = point_at(c, q, c->middle - (step /= 2));
    if (!(fabsl(to.slope) < fabsl(x.slope))) break;
    c->middle -= step;
    x = to;
  }
  return x;
}

/* E - H at the extremum, positive where the motion may be. */
static Real room(Curve *c, Real q) {
  Point x = at_middle(c, q);
  return c->sign * (c->E - x.H);
}

/* The momentum on the branch `side` (1, -1) at q, as a distance from c->middle; 0: none. */
static Real branch(Curve *c, Real q, int side, Point *at) {
  enum { STEPS = 100 };
  Point x = at_middle(c, q);
  Real left = c->E - x.H, d = side * sqrtl(fmaxl(2 * left / x.bend, 0)), last = INFINITY;
  *at = x;
  for (int k = 0; k < STEPS && d != 0; k++) {
    *at = point_at(c, q, c->middle + d);
    Real step = (at->H - c->E) / at->slope;
    if (!isfinite(step) || fabsl(step) >= last) break;
    last = fabsl(step);
    if (last <= 2 * LDBL_EPSILON * fabsl(d)) break;
    d -= step;
  }
  return d;
}

/* Whether both branches exist at q, and H rises, or falls, all the way from its extremum to each: with more extrema in p the curve has other parts. */
static int has_two_branches(Curve *c, Real q) {
  enum { PLACES = 16 };
  Real extremum = at_middle(c, q).H, left = fabsl(c->E - extremum), rounding = 64 * LDBL_EPSILON * (fabsl(c->E) + fabsl(extremum));
  for (int side = -1; side <= 1; side += 2) {
    Point at;
    Real d = branch(c, q, side, &at);
    if (!(fabsl(point_at(c, q, c->middle + d).H - c->E) <= 1e-6L * left + rounding)) return 0;
    for (int k = 1; k <= PLACES && left > rounding; k++)
      if (!(point_at(c, q, c->middle + d * k / PLACES).slope * d * c->sign > 0)) return 0;
  }
  return 1;
}

/* Reason against the curve through q, a place between its ends; NULL: none. */
static const char *reason_at(Curve *c, Real q) {
  if (!(room(c, q) > 0)) return "H has a narrow barrier between the turning points that were found";
  return has_two_branches(c, q) ? NULL : "H is not convex in its momentum along the curve";
}

/* --- turning points --- */

/* A length over which the room changes, from its value and slope at q. */
static Real scale_at(Curve *c, Real q) {
  Point x = at_middle(c, q);
  Real size = fabsl(q) > 0 ? fabsl(q) : 1, h = 1e-4L * size, slope = fabsl(x.force), bend = fabsl(point_at(c, q + h, c->middle).force - point_at(c, q - h, c->middle).force) / (2 * h);
  Real here = fabsl(c->E - x.H), length = slope > 0 ? here / slope : INFINITY, other = bend > 0 ? fmaxl(sqrtl(here / bend), slope / bend) : INFINITY;
  length = fmaxl(isfinite(length) ? length : 0, isfinite(other) ? other : 0);
  return length > 0 ? length : size;
}

/* A place between a and c with no room, by golden section for the least room; NAN: there is none. The room at b, between them, is less than at both. */
static Real place_without_room(Curve *curve, Real a, Real b, Real c) {
  enum { STEPS = 60 };
  const Real part = 0.381966011250105151795L;
  Real least = room(curve, b);
  for (int k = 0; k < STEPS && least > 0; k++) {
    Real x = fabsl(c - b) > fabsl(b - a) ? b + part * (c - b) : b - part * (b - a), here = room(curve, x);
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
static Real turning_point(Curve *c, Real q, Real step, const char **why) {
  enum { STEPS = 1500, HALVES = 200 };
  Real behind = q, good = q, bad = q, last = 0, room_behind = INFINITY, room_good = room(c, q);
  for (int k = 0; k < STEPS; k++) {
    bad = good + step;
    last = room(c, bad);
    Real gap = last > room_good && room_good < room_behind && good != q ? place_without_room(c, behind, good, bad) : NAN; /* a narrow barrier */
    if (isfinite(gap)) {
      good = behind, bad = gap, last = 0;
      break;
    }
    if (!(last > 0)) break;
    if (isfinite(last) && (*why = reason_at(c, bad))) return NAN;
    if (c->periodic && fabsl(bad - q) > 4 * PI) return *why = "it goes round, and has no turning points", NAN;
    behind = good, room_behind = room_good;
    good = bad, room_good = last;
    step *= 1.03L;
  }
  if (last > 0 || !isfinite(bad)) return *why = "its motion does not turn", NAN;
  for (int k = 0; k < HALVES; k++) {
    Real middle = (good + bad) / 2;
    if (middle == good || middle == bad) break;
    if (room(c, middle) > 0) good = middle;
    else bad = middle;
  }
  Real left = room(c, good), size = fabsl(c->E) + fabsl(at_middle(c, good).H);
  if (left > 1e-9L * size) return *why = "its motion ends where H is singular, before it turns", NAN;
  return good;
}

/* --- the integrals --- */

/* Integrals of p and of dq/q' over the curve, by n points. */
static void midpoint_rule(Curve *c, Real low, Real high, uint32_t n, Real *J, Real *time) {
  Real centre = (low + high) / 2, half = (high - low) / 2;
  *J = *time = 0;
  for (uint32_t k = 0; k < n; k++) {
    Real u = PI * (((Real)k + 0.5L) / n - 0.5L), q = centre + half * sinl(u), width = half * cosl(u) * PI / n;
    for (int side = -1; side <= 1; side += 2) {
      Point at;
      Real d = branch(c, q, side, &at);
      *J += side * d * width;
      if (d != 0) *time += side * width / at.slope;
    }
  }
}

static void integrate(Curve *c, ActionVariable *out) {
  enum { LEAST = 32, MOST = 1 << 16, DIGITS = 16 };
  for (int k = 1; k < 2 * LEAST && !out->why_not; k++) out->why_not = reason_at(c, out->low + (out->high - out->low) * k / (2 * LEAST));
  if (out->why_not) return;
  Real J = 0, time = 0, error = INFINITY, centre = (out->low + out->high) / 2, extremum = at_middle(c, centre).H, cancelled = LDBL_EPSILON * (fabsl(c->E) + fabsl(extremum)) / room(c, centre);
  for (uint32_t n = LEAST; n <= MOST && !(error <= fmaxl(1e-16L, n * cancelled)); n *= 2) { /* terms that cancel near the ends leave n times their rounding */
    Real before = J, time_before = time;
    midpoint_rule(c, out->low, out->high, n, &J, &time);
    if (n > LEAST) error = fmaxl(fabsl((J - before) / J), fabsl((time - time_before) / time));
    if (n > LEAST && error < n * cancelled) error = n * cancelled;
  }
  out->J = fabsl(J) / (2 * PI);
  out->omega = 2 * PI / fabsl(time);
  /* at a corner of H the rule is of order 2: the difference is three times its error */
  out->digits = error < 1e-12L ? DIGITS : error < 0.1L ? (int)-log10l(error) : 1;
}

/* The action of the curve through (q, p). */
static void curve_action(Curve *c, Real q, Real p, ActionVariable *out) {
  Point x = point_at(c, q, p);
  c->E = x.H;
  c->middle = p;
  c->sign = x.bend < 0 ? -1 : 1;
  if (!isfinite(x.H)) out->why_not = "H has no value at the start";
  else if (x.bend == 0 || !isfinite(x.bend)) out->why_not = "H is not curved in its momentum";
  if (out->why_not) return;
  Real left = room(c, q), size = fabsl(c->E) + fabsl(at_middle(c, q).H), length = scale_at(c, q), step = 1e-3L * length;
  if (left <= 16 * LDBL_EPSILON * size) { /* at rest: at a turning point, or in equilibrium */
    Real force = -c->sign * at_middle(c, q).force;
    if (force == 0 || fabsl(force) * length <= 16 * LDBL_EPSILON * size) {
      out->rests = 1;
      return;
    }
    int up = force > 0;
    Real inside = step;
    for (int k = 0; k < 40 && !(room(c, q + (up ? inside : -inside)) > 0); k++) inside /= 4;
    Real far = turning_point(c, q + (up ? inside : -inside), up ? inside : -inside, &out->why_not);
    out->low = up ? q : far, out->high = up ? far : q;
  } else {
    out->low = turning_point(c, q, -step, &out->why_not);
    if (!out->why_not) out->high = turning_point(c, q, step, &out->why_not);
  }
  if (!out->why_not) integrate(c, out);
}

/* --- the state --- */

static Real *start_state(const PhaseSpace *s) {
  const Model *m = s->e->m;
  Real *found = start_requested(s->e), *symbols = ARENA_ARRAY(m->arena, Real, expr_symbol_count(s->e->g) + 1);
  for (SymId k = 1; k <= expr_symbol_count(s->e->g); k++) symbols[k] = found[k];
  for (uint32_t i = 0; i < m->inputs.n; i++)
    if (m->inputs.at[i].value) expr_eval(s->e->g, &m->inputs.at[i].value, 1, symbols, &symbols[m->inputs.at[i].sym]);
  for (uint32_t i = 0; i < s->n && s->rate; i++) expr_eval(s->e->g, &s->e->p[i], 1, symbols, &symbols[s->p[i]]);
  return symbols;
}

static int is_periodic(const PhaseSpace *s, uint32_t i) {
  const Model *m = s->e->m;
  return s->rate ? m->coords.at[i].periodic : m->states.at[m->pairs.at[i].q].periodic;
}

static void pair_action(const PhaseSpace *s, uint32_t i, const Real *start, ActionVariable *out) {
  ExprGraph *g = s->e->g;
  uint32_t count = expr_symbol_count(g) + 1;
  Curve c = {.q = s->q[i], .p = s->p[i], .periodic = is_periodic(s, i), .symbols = ARENA_ARRAY(expr_arena(g), Real, count)};
  Expr slope = expr_diff(g, s->H, s->p[i]);
  Expr roots[4] = {s->H, slope, expr_diff(g, slope, s->p[i]), expr_diff(g, s->H, s->q[i])};
  for (int k = 0; k < 4; k++) roots[k] = k == 0 ? roots[k] : simplify(g, roots[k]);
  for (uint32_t k = 0; k < count; k++) c.symbols[k] = start[k];
  c.tape = eval_tape(g, roots, 4);
  curve_action(&c, start[c.q], start[c.p], out);
}

static void cyclic_action(const PhaseSpace *s, uint32_t i, const Real *start, ActionVariable *out) {
  out->cyclic = 1;
  out->J = start[s->p[i]];
  out->omega = NAN;
  if (!is_periodic(s, i)) out->why_not = "it is cyclic, and not declared periodic: its motion does not turn";
}

static const char *reason_of_tie(const PhaseSpace *s, const Separation *x) {
  const ExprGraph *g = s->e->g;
  Arena *a = s->e->m->arena;
  Name qi = expr_symbol(g, s->q[x->i])->name, qj = expr_symbol(g, s->q[x->j])->name;
  if (x->i == x->j) return arena_printf(a, "H does not separate in these coordinates: it contains %s, and not its momentum", qi);
  return arena_printf(a, "H does not separate in these coordinates: Levi-Civita's condition for %s and %s %s%s", qi, qj, x->refuted ? "fails" : "is not decided",
                      x->refuted && s->e->m->params.n ? ", for general values of the parameters" : "");
}

/* Whether H jumps where a coordinate or a momentum crosses some value: derivatives do not show it. */
static int jumps_with_the_state(const PhaseSpace *s) {
  ExprJumps jumps = discontinuities_of(s->e, s->H);
  for (uint32_t k = 0; k < jumps.n; k++)
    for (uint32_t i = 0; i < s->n; i++)
      if (expr_contains_sym(s->e->g, jumps.at[k].side, s->q[i]) || expr_contains_sym(s->e->g, jumps.at[k].side, s->p[i])) return 1;
  return 0;
}

int action_variables(Eqns *e, ActionVariables *out) {
  Arena *a = e->m->arena;
  PhaseSpace *s = ARENA_NEW(a, PhaseSpace);
  if (!phase_space_of(e, e->m->span, s)) return 0;
  s->H = expr_expand_defs(e->g, s->H);
  ActionVariable *all = ARENA_ARRAY(a, ActionVariable, s->n + 1);
  *out = (ActionVariables){.space = s, .at = all, .separation = separation_of(s)};
  Separation *x = &out->separation;
  int jumps = jumps_with_the_state(s);
  x->separates = x->separates && !jumps;
  Real *start = start_state(s); /* after all symbols are made */
  expr_eval(e->g, &s->H, 1, start, &out->E);
  for (uint32_t i = 0; i < s->n; i++) {
    if (jumps) all[i].why_not = "H jumps with the coordinates or momenta, and its derivatives do not show it";
    else if (x->kind[i] == PAIR_TIED) all[i].why_not = reason_of_tie(s, x);
    else if (x->kind[i] == PAIR_CYCLIC) cyclic_action(s, i, start, &all[i]);
    else pair_action(s, i, start, &all[i]);
    if (x->tangled[i]) all[i].omega = NAN;
  }
  return 1;
}
