/* Rates of charges and Taylor coefficients, against finite differences of values that were compared with the text
 * before. */
#include <math.h>

#include "self_check/self_check_impl.h"

/* A saved state. */
typedef struct {
  Real t, *q, *v, *z, *zd;
} SavedState;

static Real *copied(const Check *c, const Real *x, uint32_t n) {
  Real *r = ARENA_ARRAY(c->arena, Real, n + 1);
  for (uint32_t i = 0; i < n; i++) r[i] = x[i];
  return r;
}

static SavedState copy_state(const Check *c) {
  uint32_t nz = c->m->states.n;
  return (SavedState){c->t, copied(c, c->q, c->n), copied(c, c->v, c->n), copied(c, c->z, nz), copied(c, c->zd, nz)};
}

/* Sets the state to the saved one plus s times (dq, dv, dz, dt). */
static void move_to(Check *c, const SavedState *k, Real s, const Real *dq, const Real *dv, const Real *dz, Real dt) {
  for (uint32_t i = 0; i < c->n; i++) {
    c->q[i] = k->q[i] + s * dq[i];
    c->v[i] = k->v[i] + s * dv[i];
  }
  for (uint32_t i = 0; i < c->m->states.n; i++) c->z[i] = k->z[i] + s * dz[i];
  c->t = k->t + s * dt;
}

static void restore_state(Check *c, const SavedState *k) {
  for (uint32_t i = 0; i < c->m->states.n; i++) c->zd[i] = k->zd[i];
  move_to(c, k, 0, k->q, k->v, k->z, 0);
}

/* Step of time that is short compared with the motion's rates. */
static Real short_time(const Check *c) {
  Real rate = 1;
  for (uint32_t i = 0; i < c->n; i++) rate += fabsl(c->v[i]) + sqrtl(fabsl(c->a[i]));
  for (uint32_t i = 0; i < c->m->states.n; i++) rate += fabsl(c->zd[i]);
  return 1e-4L / rate;
}

/* Derivative by Richardson extrapolation of central differences, at = f(-h), f(h), f(-2h), f(2h). Error: a quarter
 * of their difference, plus 1/h times the known error `rounding` and the rounding of values of magnitude `size`. */
BoundedSum check_derivative(const Real at[4], Real h, Real size, Real rounding) {
  Real near = (at[1] - at[0]) / (2 * h), far = (at[3] - at[2]) / (4 * h), spread = fabsl(near - far);
  Real error = spread / 4 + (1024 * jet_unit * size + rounding) / h;
  return (BoundedSum){{near + (near - far) / 3, error}, size, fabsl(near) + 1};
}

/* d/dt of each charge against the program of its power. */
static CheckVerdict check_charges(Check *c) {
  const ProgramSet *u = c->u;
  uint32_t n = u->charges.n;
  Real *value = ARENA_ARRAY(c->arena, Real, 2 * n + 4), *power = ARENA_ARRAY(c->arena, Real, n + 1), h = short_time(c);
  Real(*at)[4] = arena_alloc(c->arena, (n + 1) * sizeof *at), *size = ARENA_ARRAY(c->arena, Real, n + 1);
  CheckVerdict v = AGREES;
  if (n < 2 || !u->charge_values || c->m->inputs.n > 0 ||
      (u->charge_powers && !check_run(c, u->charge_powers, (Real *const[]){power})))
    return AGREES;
  SavedState kept = copy_state(c);
  for (int k = 0; k < 4; k++) { /* -h, h, -2h, 2h; q to second order in s */
    Real s = (k % 2 ? h : -h) * (k < 2 ? 1 : 2);
    move_to(c, &kept, s, kept.v, c->a, c->zd, 1);
    for (uint32_t i = 0; i < c->n; i++) c->q[i] += s * s / 2 * c->a[i];
    int ran = check_run(c, u->charge_values, (Real *const[]){value});
    for (uint32_t i = 1; i < n; i++) at[i][k] = ran ? value[2 * (i - 1)] : NAN;
    for (uint32_t i = 1; i < n; i++) size[i] = fabsl(value[2 * (i - 1) + 1]);
  }
  restore_state(c, &kept);
  for (uint32_t i = 1; i < n; i++) {
    if (!(u->charges.at[i].flags & 2) || u->charges.at[i].flags & 8) continue;
    BoundedSum t = check_derivative(at[i], h, size[i], 0);
    t.sum.e /= 64; /* an estimate, not a rounding bound: takes part of the factor SLACK of check_compare back */
    v = worse(v, check_compare(c, &t, power[i], c->m->span, "the rate of the charge", u->charges.at[i].name));
  }
  return v;
}

/* --- Taylor coefficients --- */

enum { ORDERS = 10 };

/* Taylor coefficients up to ORDERS in x[order][column], by the recurrences of series/series.h as emitted code runs
 * them, with T = 1. */
static int taylor_rows(Check *c, const Series *s, Real *x) {
  uint32_t columns = s->columns, nq = s->nq, nz = s->nz, time = 3 * nq + 2 * nz, wide = s->width + s->group + 4;
  Real *constants = ARENA_ARRAY(c->arena, Real, s->constants + 1), *sum = ARENA_ARRAY(c->arena, Real, wide),
       *follows = ARENA_ARRAY(c->arena, Real, c->m->inputs.n + 1);
  Real *a = ARENA_ARRAY(c->arena, Real, (size_t)wide * (ORDERS + 1)),
       *b = ARENA_ARRAY(c->arena, Real, (size_t)wide * (ORDERS + 1));
  const Real *in[ARR_COUNT] = {0};
  in[ARR_T] = &c->t, in[ARR_Q] = c->q, in[ARR_V] = c->v, in[ARR_Z] = c->z, in[ARR_P] = c->p, in[ARR_U] = c->signal,
  in[ARR_FREE] = follows;
  if (prog_eval(s->first, in, (Real *const[]){x, constants}) != 0) return 0;
  for (uint32_t i = 0; i < nq; i++) x[i] = c->q[i], x[nq + i] = c->v[i];
  for (uint32_t i = 0; i < nz; i++) x[2 * nq + i] = c->z[i];
  Real *next = x + columns;
  for (uint32_t i = 0; i < nq; i++) next[i] = x[nq + i], next[nq + i] = x[2 * nq + nz + i];
  for (uint32_t i = 0; i < nz; i++) next[2 * nq + i] = x[3 * nq + nz + i];
  if (s->uses_time) next[time] = 1;
  in[ARR_SUMS] = sum;
  in[ARR_STEP] = constants;
  for (int k = 1; k < ORDERS; k++) {
    Real order = k, per_order = 1 / order, up = 1 / (order + 1), *row = x + (size_t)k * columns;
    for (uint32_t i = 0; i < wide; i++) {
      sum[i] = 0;
      for (int j = 1; j < k; j++)
        sum[i] += a[(size_t)j * wide + i] * (s->squares && i >= s->first_square ? a : b)[(size_t)(k - j) * wide + i];
    }
    in[ARR_COEF] = row, in[ARR_ORDER] = &order, in[ARR_PER_ORDER] = &per_order, in[ARR_UP] = &up;
    if (prog_eval(s->next, in, (Real *const[]){row, row + columns, a + (size_t)k * wide, b + (size_t)k * wide}) != 0)
      return 0;
  }
  return 1;
}

/* Value (slope 0) or derivative (slope 1) of column i's polynomial at s. */
static Real polynomial(const Real *x, uint32_t columns, uint32_t i, Real s, int slope) {
  Real r = 0;
  for (int k = ORDERS; k >= slope; k--) r = r * s + x[(size_t)k * columns + i] * (slope ? k : 1);
  return r;
}

/* Rows of Taylor coefficients, and the accelerations and rates a, zd of the program at their state
 * after a step h; behind each the same without the last two terms. */
typedef struct {
  const Series *s;
  Real *x, h, *a, *zd;
} TaylorStep;

/* Runs the accelerations at the state of the polynomials of degree `orders`, for part 0 or 1 of their room. */
static int run_at(Check *c, const TaylorStep *y, int orders, const SavedState *kept, int part) {
  const Series *s = y->s;
  Real *x = y->x, h = y->h, *a = y->a + (part ? s->nq : 0), *zd = y->zd + (part ? s->nz : 0);
  Real *top = x + (size_t)(orders + 1) * s->columns, *cut = copied(c, top, s->columns * (uint32_t)(ORDERS - orders));
  for (uint32_t i = 0; i < s->columns * (uint32_t)(ORDERS - orders); i++) top[i] = 0;
  for (uint32_t i = 0; i < s->nq; i++)
    c->q[i] = polynomial(x, s->columns, i, h, 0), c->v[i] = polynomial(x, s->columns, s->nq + i, h, 0);
  for (uint32_t i = 0; i < s->nz; i++) c->z[i] = polynomial(x, s->columns, 2 * s->nq + i, h, 0);
  c->t = kept->t + h;
  const int samples = c->samples;
  c->samples = 0; /* a series has all terms of its sums */
  int ran = check_run(c, c->u->accel, (Real *const[]){a, zd});
  c->samples = samples;
  restore_state(c, kept);
  for (uint32_t i = 0; i < s->columns * (uint32_t)(ORDERS - orders); i++) top[i] = cut[i];
  return ran;
}

/* Step at which the last two terms are 1e-12 of each velocity or state. */
static Real taylor_step(const Series *s, const Real *x) {
  Real h = 0.1L;
  for (uint32_t i = 0; i < s->nq + s->nz; i++)
    for (int k = ORDERS - 1; k <= ORDERS; k++) {
      Real last = fabsl(x[(size_t)k * s->columns + s->nq + i]),
           size = fabsl(x[s->nq + i]) + fabsl(x[s->columns + s->nq + i]);
      if (last > 0 && size > 0) h = fminl(h, powl(1e-12L * size / last, 1.0L / k));
    }
  return h;
}

/* Returns |rate - slope|: rate i of the program at h, and the slope of polynomial i there. *t: the slope with its
 * truncation error, estimated by leaving out two terms; off: rounding error of the rate; *said: the rate. */
static Real taylor_difference(const TaylorStep *y, uint32_t i, Real off, BoundedSum *t, Real *said) {
  const Series *s = y->s;
  const Real *x = y->x, h = y->h, *at = i < s->nq ? y->a + i : y->zd + (i - s->nq),
      less = at[i < s->nq ? s->nq : s->nz];
  Real slope = polynomial(x, s->columns, s->nq + i, h, 1),
       last = fabsl(x[(size_t)ORDERS * s->columns + s->nq + i]) * ORDERS * powl(h, ORDERS - 1);
  Real rounding = 1e12L * jet_unit * fabsl(x[s->nq + i]) / h;
  *t = (BoundedSum){{slope, (fabsl(*at - less) + last) / 1024 + off}, fabsl(slope) + rounding, 0};
  *said = *at;
  return fabsl(slope - *at);
}

/* Rounding of rate i by the text's own bounds: a formula that cancels loses digits at each state. part: of forces. */
static Real rate_rounding(const Check *c, uint32_t i, uint32_t nq, Real part) {
  const TextDynamics *d = c->dynamics;
  const Real *rates = c->m->first_order ? c->zd : c->a;
  Real most = 0;
  for (uint32_t k = 0; k < check_components(c); k++) most = fmaxl(most, fabsl(rates[k]));
  if (i < nq) return c->a_error[i] + part * most;
  Bounded flow = check_coefficient(d->tape, c->at, d->flows[i - nq], 0, 0);
  return c->zd_error[i - nq] + (c->m->first_order ? part * most : 0) + (isfinite(flow.e) ? flow.e : 0);
}

/* At time h, the derivative of the velocities' Taylor polynomials must be the program's acceleration at the
 * polynomials' state, up to truncation. As a step may cross a corner or a jump, a difference counts only if a step
 * 64 times shorter shows it, too. */
static CheckVerdict check_taylor(Check *c) {
  const Series *s = c->u->taylor;
  TaylorStep y = {.s = s, .x = ARENA_ARRAY(c->arena, Real, (size_t)s->columns * (ORDERS + 2)),
                  .a = ARENA_ARRAY(c->arena, Real, 2 * s->nq + 1),
                  .zd = ARENA_ARRAY(c->arena, Real, 2 * s->nz + 1)};
  SavedState kept = copy_state(c);
  CheckVerdict v = AGREES;
  if (!taylor_rows(c, s, y.x)) return AGREES;
  Real part = check_rounding_part(c);
  y.h = taylor_step(s, y.x);
  for (int shorter = 0; shorter < 2; shorter++, y.h /= 64) {
    int differs = 0;
    if (!run_at(c, &y, ORDERS - 2, &kept, 1) || !run_at(c, &y, ORDERS, &kept, 0)) return AGREES;
    for (uint32_t i = 0; i < s->nq + s->nz; i++) {
      BoundedSum t;
      Real said, difference = taylor_difference(&y, i, rate_rounding(c, i, s->nq, part), &t, &said);
      differs |= difference > 64 * 1024 * t.sum.e + 1e-9L * t.size;
      if (shorter)
        v = worse(v, check_compare(c, &t, said, c->m->span, "the rate from Taylor coefficients of",
                                   i < s->nq ? c->m->coords.at[i].name : c->m->states.at[i - s->nq].name));
    }
    if (!differs) return AGREES;
  }
  return v;
}

CheckVerdict check_motion(Check *c) {
  CheckVerdict v = c->far ? AGREES : check_charges(c);
  if (v != DISAGREES && !c->far) v = worse(v, check_matrices(c));
  if (v != DISAGREES && !c->far && c->u->taylor && c->e->smooth && c->n <= LONG_TAPE / 100)
    v = worse(v, check_taylor(c));
  return v == DISAGREES ? v : AGREES;
}
