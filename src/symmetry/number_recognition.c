/* Recognition by continued fractions, by quotients at two choices, and by logarithmic differences where one
 * parameter is moved. */
#include "symmetry/number_recognition.h"

#include <math.h>

#include "base/tolerance.h"
#include "sym/expr_eval.h"
#include "sym/prove.h"

/* Values of all symbols at a choice. */
static void draw(const ExprGraph *g, uint32_t attempt, uint32_t choice, long double *to) {
  sample_state(g, choice == CHOICE_SECOND && attempt == 0 ? 2 : 1 + 2 * attempt, to);
  for (SymId s = 1; s <= expr_symbol_count(g) && choice == CHOICE_SECOND && attempt > 0; s++)
    to[s] *= 1 + 0.03L * sample_symbol(g, s, 2 + 2 * attempt);
}

Choices choices_new(Arena *a, const Eqns *e, uint32_t attempt, int moved) {
  ExprGraph *g = e->g;
  VEC(SymId) params = {0};
  VEC(Expr) roots = {0};
  uint32_t count = expr_symbol_count(g) + 1;
  vec_push(a, &roots, e->lagrangian);
  for (uint32_t i = 0; i < e->constraints.n; i++) vec_push(a, &roots, e->constraints.r[i]);
  ExprList all = expr_topo(g, roots.at, roots.n);
  for (uint32_t i = 0; i < all.n; i++)
    if (expr_op(g, all.at[i]) == EX_SYM && expr_sym_of(g, all.at[i])->kind == SYM_PARAM)
      vec_push(a, &params, expr_sym_id(g, all.at[i]));
  const uint32_t n = CHOICE_MOVED + (moved ? params.n : 0);
  long double **at = ARENA_ARRAY(a, long double *, n);
  for (uint32_t k = 0; k < n; k++) {
    at[k] = ARENA_ARRAY(a, long double, count);
    draw(g, attempt, k, at[k]);
    /* A parameter of unknown sign is taken positive: most are, and identities do not depend on it. */
    for (SymId s = 1; s < count; s++)
      if (expr_symbol(g, s)->sign == SIGN_UNKNOWN && expr_symbol(g, s)->kind == SYM_PARAM) at[k][s] = fabsl(at[k][s]);
    if (k >= CHOICE_MOVED) at[k][params.at[k - CHOICE_MOVED]] *= 1.01L;
  }
  return (Choices){e, params.n, params.at, at};
}

/* Continued fraction p/q within `error` of x, p*q up to `most`: of random numbers, one in |x|/(error*most) is that
 * close to one. */
static int fraction_of(long double x, long double error, long double most, Num *out) {
  long double rest = x, p0 = 1, q0 = 0, p1 = floorl(x), q1 = 1;
  while (fabsl(x - p1 / q1) > error) {
    rest = 1 / (rest - floorl(rest));
    long double whole = floorl(rest), p2 = whole * p1 + p0, q2 = whole * q1 + q0;
    if (!(fabsl(p2) * q2 <= most)) return 0;
    p0 = p1;
    q0 = q1;
    p1 = p2;
    q1 = q2;
  }
  if (!(fabsl(p1) * q1 <= most)) return 0;
  *out = num_ratio((int64_t)p1, (int64_t)q1);
  return 1;
}

/* Longer fractions need more digits of x, which only values without accumulated rounding have. */
int recognise_rational(long double x, Num *out) {
  if (!(fabsl(x) < 1e14L)) return 0;
  return fraction_of(x, 1e-12L * fmaxl(fabsl(x), 1), 1e10L, out) ||
         fraction_of(x, LONG_TOLERANCE(1e-17L) * fabsl(x), 1e14L, out);
}

/* Whether the value is the same rational at the first two choices. */
static int recognise_same(const long double *value, Num *out) {
  return fabsl(value[CHOICE_FIRST] - value[CHOICE_SECOND]) < 1e-9L * fabsl(value[CHOICE_FIRST]) &&
         recognise_rational(value[CHOICE_FIRST], out);
}

static long double value_at(const Choices *c, uint32_t choice, uint32_t k) { return c->at[choice][c->param[k]]; }

static Expr parameter(const Choices *c, uint32_t k, Num power) {
  return expr_pow_num(c->e->g, expr_symbol(c->e->g, c->param[k])->node, power);
}

/* A rational times p or 1/p of one parameter, or times a ratio or product of two; 0: none. */
static Expr recognise_ratio(const Choices *c, const long double *value) {
  ExprGraph *g = c->e->g;
  for (uint32_t i = 0; i < c->n; i++)
    for (uint32_t k = 0; k <= i; k++)
      for (int powers = 0; powers < 4; powers++) {
        int a = powers & 1 ? -1 : 1, b = k == i ? 0 : powers & 2 ? -1 : 1;
        long double first = powl(value_at(c, CHOICE_FIRST, i), a) * powl(value_at(c, CHOICE_FIRST, k), b);
        long double second = powl(value_at(c, CHOICE_SECOND, i), a) * powl(value_at(c, CHOICE_SECOND, k), b),
                    ratio = value[CHOICE_FIRST] / first;
        Num number;
        if (!(fabsl(ratio - value[CHOICE_SECOND] / second) < 1e-10L * fabsl(ratio)) ||
            !recognise_rational(ratio, &number))
          continue;
        Expr one = parameter(c, i, num_int(a)), other = parameter(c, k, num_int(b));
        return expr_scale(g, number, expr_mul(g, one, other));
      }
  return 0;
}

/* A rational (ratio 0), or a result of recognise_ratio, times a power of the rate. */
static Expr rate_multiple(const Choices *c, const long double *value, Expr rate, int ratio) {
  static const int powers[4] = {1, -1, 2, -2};
  for (int k = 0; k < 4; k++) {
    Expr factor = expr_pow_num(c->e->g, rate, num_int(powers[k])), found = 0;
    long double rest[2] = {value[CHOICE_FIRST] / choice_value(c, CHOICE_FIRST, factor),
                           value[CHOICE_SECOND] / choice_value(c, CHOICE_SECOND, factor)};
    Num number;
    if (ratio) found = recognise_ratio(c, rest);
    else if (recognise_same(rest, &number)) found = expr_num(c->e->g, number);
    if (found) return expr_mul(c->e->g, found, factor);
  }
  return 0;
}

Expr recognise_by_two(const Choices *c, const long double *value, const Expr *rate, uint32_t n) {
  Num number;
  if (value[CHOICE_FIRST] == 0 && value[CHOICE_SECOND] == 0) return expr_int(c->e->g, 0);
  if (recognise_same(value, &number)) return expr_num(c->e->g, number);
  Expr found = recognise_ratio(c, value);
  for (int ratio = 0; ratio < 2; ratio++)
    for (uint32_t k = 0; k < n && !found; k++) found = rate_multiple(c, value, rate[k], ratio);
  return found;
}

static int half_of(long double exponent, Num *out) {
  long double twice = roundl(2 * exponent);
  if (!(fabsl(2 * exponent - twice) < 1e-6L) || fabsl(twice) > 24) return 0;
  *out = num_ratio((int64_t)twice, 2);
  return 1;
}

/* Product of powers of parameters that value[choice] is proportional to, and the factor *number. 0: none. */
static Expr monomial_part(const Choices *c, const long double *value, long double *number) {
  ExprGraph *g = c->e->g;
  Num exponent;
  long double rest = value[CHOICE_FIRST], other = value[CHOICE_SECOND];
  VEC(Expr) factors = {0};
  for (uint32_t k = 0; k < c->n; k++) {
    if (!half_of(logl(value[CHOICE_MOVED + k] / value[CHOICE_FIRST]) / logl(1.01L), &exponent)) return 0;
    if (num_is_zero(exponent)) continue;
    Expr p = expr_symbol(g, c->param[k])->node, power = expr_pow_num(g, p, exponent);
    rest /= powl(c->at[CHOICE_FIRST][c->param[k]], (long double)num_value(exponent));
    other /= powl(c->at[CHOICE_SECOND][c->param[k]], (long double)num_value(exponent));
    vec_push(c->e->m->arena, &factors, power);
  }
  if (!(fabsl(rest - other) < 1e-9L * fabsl(rest))) return 0;
  *number = rest;
  return expr_mul_n(g, factors.at, factors.n);
}

Expr recognise_monomial(const Choices *c, const long double *value) {
  ExprGraph *g = c->e->g;
  long double rest;
  Num number;
  Expr product = monomial_part(c, value, &rest);
  if (!product) return 0;
  if (recognise_rational(rest, &number)) return expr_scale(g, number, product);
  if (!recognise_rational(rest * rest, &number)) return 0;
  Expr root = expr_mul(g, expr_sqrt(g, expr_num(g, number)), product);
  return rest < 0 ? expr_neg(g, root) : root;
}

/* x, known from a difference, as a multiple of 1/12; 0: it is none. */
static int twelfth_of(long double x, Num *out) {
  long double whole = roundl(12 * x);
  if (!(fabsl(12 * x - whole) < 1e-6L) || fabsl(whole) > 1e6L) return 0;
  *out = num_ratio((int64_t)whole, 12);
  return 1;
}

Expr recognise_linear(const Choices *c, const long double *value) {
  ExprGraph *g = c->e->g;
  Expr sum = expr_int(g, 0);
  Num number;
  for (uint32_t k = 0; k < c->n; k++) {
    long double step = 0.01L * c->at[CHOICE_FIRST][c->param[k]];
    if (!twelfth_of((value[CHOICE_MOVED + k] - value[CHOICE_FIRST]) / step, &number)) return 0;
    Expr term = expr_scale(g, number, parameter(c, k, num_int(1)));
    sum = expr_add(g, sum, term);
  }
  long double rest = value[CHOICE_FIRST] - choice_value(c, CHOICE_FIRST, sum);
  if (fabsl(rest) < 1e-10L) rest = 0;
  if (!recognise_rational(rest, &number)) return 0;
  sum = expr_add(g, sum, expr_num(g, number));
  return fabsl(choice_value(c, CHOICE_SECOND, sum) - value[CHOICE_SECOND]) < 1e-9L * fabsl(value[CHOICE_SECOND]) ? sum
                                                                                                                 : 0;
}

Expr recognise_quotient(const Choices *c, const long double *value) {
  enum { PARAMETERS_MOST = 12, VALUES_MOST = 2 + PARAMETERS_MOST };
  long double x[VALUES_MOST];
  if (c->n > PARAMETERS_MOST) return 0;
  Expr sum = recognise_linear(c, value);
  if (sum) return sum;
  for (uint32_t k = 0; k < c->n; k++) {
    for (uint32_t i = 0; i < 2 + c->n; i++) x[i] = value[i] * c->at[i][c->param[k]];
    if (!(sum = recognise_linear(c, x))) continue;
    return expr_div(c->e->g, sum, parameter(c, k, num_int(1)));
  }
  return 0;
}

long double choice_value(const Choices *c, uint32_t choice, Expr e) {
  long double value;
  expr_eval(c->e->g, &e, 1, c->at[choice], &value);
  return value;
}
