/* Logarithms make a monomial a linear combination of its features' logarithms: found by least
 * squares over more states than features, and accepted only with integer coefficients and no
 * remainder. By orthogonalisation (Bjorck 1996, Numerical Methods for Least Squares Problems,
 * section 2.4). */
#include "claims/monomial_fit.h"

#include <math.h>

#include "base/dense_matrix.h"

enum { COLUMNS = FEATURES_MAX + 1, EXPONENT_MAX = 8 };

struct Features {
  ExprGraph *g;
  uint32_t n;                   /* columns in use */
  Expr feature[COLUMNS];        /* 0 for the first: the constant */
  long double value[COLUMNS][FEATURE_STATES];
  long double q[COLUMNS][FEATURE_STATES];  /* orthonormal */
  long double r[COLUMNS][COLUMNS];         /* log|value[k]| = sum over i <= k of r[i][k] q[i] */
};

static long double dot(const long double *a, const long double *b) {
  long double s = 0;
  for (int i = 0; i < FEATURE_STATES; i++) s += a[i] * b[i];
  return s;
}

/* c[n] := parts of v along q[0 .. n-1]; v := its direction across them. Returns the length of the part across. */
static long double split(const Features *f, uint32_t n, long double *v, long double *c) {
  long double length = sqrtl(dot(v, v));
  for (uint32_t k = 0; k < n; k++) c[k] = dot(f->q[k], v);
  return length * dense_gram_schmidt(FEATURE_STATES, v, f->q[0], n);
}

/* Adds a column, unless it depends on those before. */
static void add_column(Features *f, Expr feature, const long double *values) {
  long double v[FEATURE_STATES], c[COLUMNS] = {0};
  uint32_t n = f->n;
  for (int i = 0; i < FEATURE_STATES; i++) {
    v[i] = feature ? logl(fabsl(values[i])) : 1;
    if (!isfinite(v[i])) return;
  }
  long double before = sqrtl(dot(v, v));
  long double norm = split(f, n, v, c);
  if (!(norm > 1e-9L * before)) return;
  for (uint32_t k = 0; k < n; k++) f->r[k][n] = c[k];
  f->r[n][n] = norm;
  for (int i = 0; i < FEATURE_STATES; i++) {
    f->q[n][i] = v[i];
    f->value[n][i] = values[i];
  }
  f->feature[n] = feature;
  f->n++;
}

Features *features_new(ExprGraph *g, const Expr *features, uint32_t n, long double *const *states) {
  Features *f = ARENA_NEW(expr_arena(g), Features);
  f->g = g;
  long double ones[FEATURE_STATES], *all = ARENA_ARRAY(expr_arena(g), long double, FEATURE_STATES * (n + 1));
  for (int i = 0; i < FEATURE_STATES; i++) ones[i] = 1;
  add_column(f, 0, ones);
  EvalTape *tape = eval_tape(g, features, n);
  long double *out = ARENA_ARRAY(expr_arena(g), long double, n + 1);
  for (int i = 0; i < FEATURE_STATES; i++) {
    eval_run(tape, states[i], out);
    for (uint32_t k = 0; k < n; k++) all[k * FEATURE_STATES + (uint32_t)i] = out[k];
  }
  for (uint32_t k = 0; k < n; k++) add_column(f, features[k], all + k * FEATURE_STATES);
  return f;
}

/* x as a rational with a denominator up to 36, to 10 digits; 0: it is none. */
static int small_rational(long double x, Num *out) {
  enum { LARGEST = 1000 };
  for (int64_t den = 1; den <= 36; den++) {
    long double num = roundl(x * (long double)den);
    if (fabsl(num) > LARGEST * (long double)den || num == 0) continue;
    if (fabsl(num - x * (long double)den) > 1e-10L * fabsl(num)) continue;
    *out = num_ratio((int64_t)num, den);
    return 1;
  }
  return 0;
}

/* Integer exponents of the columns after the first; 0: they are no integers. */
static int exponents(const Features *f, const long double *values, int *e) {
  long double v[FEATURE_STATES], c[COLUMNS] = {0};
  for (int i = 0; i < FEATURE_STATES; i++) {
    v[i] = logl(fabsl(values[i]));
    if (!isfinite(v[i])) return 0;
  }
  if (split(f, f->n, v, c) > 1e-7L) return 0;
  for (uint32_t k = f->n; k-- > 1;) {
    for (uint32_t j = k + 1; j < f->n; j++) c[k] -= f->r[k][j] * (long double)e[j];
    long double x = c[k] / f->r[k][k], whole = roundl(x);
    if (fabsl(x - whole) > 1e-5L || fabsl(whole) > EXPONENT_MAX) return 0;
    e[k] = (int)whole;
  }
  return 1;
}

/* Whether feature k may stand in a denominator. */
static int may_divide(const Features *f, uint32_t k) {
  const unsigned motion = 1u << SYM_VEL | 1u << SYM_ACC | 1u << SYM_RATE, kinds = expr_kinds(f->g, f->feature[k]);
  return (expr_op(f->g, f->feature[k]) == EX_SYM && kinds == 1u << SYM_VEL) || !(kinds & motion);
}

/* The monomial of these exponents; e = 0 where a feature may not stand in the denominator. */
static Monomial build(const Features *f, const int *e, Num number) {
  Expr product[COLUMNS];
  Monomial m = {.size = num_is_one(num_abs(number)) ? 0 : 1};
  uint32_t n = 0, above = 0, below = 0;
  for (uint32_t k = 1; k < f->n; k++) {
    if (!e[k]) continue;
    if (e[k] < 0 && !may_divide(f, k)) return (Monomial){0};
    product[n++] = expr_pow_num(f->g, f->feature[k], num_int(e[k]));
    if (e[k] > 0) above += (uint32_t)e[k];
    else below += (uint32_t)-e[k];
  }
  Expr all = expr_mul_n(f->g, product, n);
  m.e = expr_scale(f->g, number, all);
  if (below && !above) m.divisor = expr_pow_num(f->g, m.e, num_int(-1));
  m.mixed = above && below;
  m.size += above + (above ? 3 * below : below + 1);
  return m;
}

Monomial features_fit(const Features *f, const long double *values) {
  int e[COLUMNS] = {0};
  Monomial none = {0};
  if (!exponents(f, values, e)) return none;
  long double c = 0;
  for (int i = 0; i < FEATURE_STATES; i++) {
    long double p = 1;
    for (uint32_t k = 1; k < f->n; k++) p *= powl(f->value[k][i], e[k]);
    if (i == 0) c = values[i] / p;
    else if (fabsl(values[i] - c * p) > 1e-9L * fabsl(values[i])) return none;
  }
  Num number;
  if (!small_rational(c, &number)) return none;
  return build(f, e, number);
}
