/* Values with a bound of their rounding error: the running error analysis of Wilkinson (Higham,
 * Accuracy and Stability of Numerical Algorithms, 2002, section 3.3), with first-order bounds for
 * the functions. */
#include <float.h>
#include <math.h>

#include "sym/eval.h"
#include "sym/prove.h"

typedef long double Real;

/* --- states --- */

/* SplitMix64 (Steele, Lea, Flood 2014, DOI 10.1145/2714064.2660195), as a fraction of 1. */
static Real fraction(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  x ^= x >> 31;
  return (Real)(x >> 11) / (Real)(1ull << 53);
}

static Real state_value(const Symbol *s, uint32_t id, uint32_t seed) {
  if (strcmp(s->name, "pi") == 0) return acosl(-1);
  uint64_t place = ((uint64_t)seed << 32) + id;
  Real x = fraction(2 * place), size = 0.3L + 1.7L * x;
  switch (s->sign) {
    case SIGN_POSITIVE: case SIGN_NONNEGATIVE: return size;
    case SIGN_NEGATIVE: case SIGN_NONPOSITIVE: return -size;
    case SIGN_UNKNOWN: break;
  }
  return fraction(2 * place + 1) < 0.5L ? size : -size;
}

long double prove_symbol(const ExprGraph *g, SymId s, uint32_t seed) { return state_value(expr_symbol(g, s), s, seed); }

void prove_state(const ExprGraph *g, uint32_t seed, long double *symbols) {
  for (SymId s = 1; s <= expr_symbol_count(g); s++) symbols[s] = prove_symbol(g, s, seed);
}

void prove_state_wide(const ExprGraph *g, uint32_t seed, long double *symbols) {
  prove_state(g, seed, symbols);
  for (SymId s = 1; s <= expr_symbol_count(g); s++) {
    SymKind kind = expr_symbol(g, s)->kind;
    if (kind == SYM_COORD || kind == SYM_STATE || kind == SYM_TIME) symbols[s] *= 4;
  }
}

/* --- bounds --- */

/* Values and bounds of the nodes in question, by place in their list. */
typedef struct {
  ExprGraph *g;
  const Real *value;
  Real *bound;
  const ExprMap *place; /* plus one */
} Bounds;

static Real value_of(const Bounds *b, Expr e) { return b->value[expr_map_get(b->place, e) - 1]; }
static Real bound_of(const Bounds *b, Expr e) { return b->bound[expr_map_get(b->place, e) - 1]; }

static Real sum_bound(const Bounds *b, Expr e) {
  Real bound = 0, size = 0;
  uint32_t n = expr_pairs(b->g, e, EX_SUM);
  for (uint32_t i = 0; i < n; i++) {
    Num c;
    Expr t = expr_pair(b->g, e, EX_SUM, i, &c);
    bound += fabsl((Real)num_value(c)) * bound_of(b, t) + (num_error(c) > 0 ? (Real)num_error(c) * (fabsl(value_of(b, t)) + bound_of(b, t)) : 0);
    size += fabsl((Real)num_value(c) * value_of(b, t));
  }
  return bound + (Real)(n + 2) * LDBL_EPSILON * size;
}

static Real prod_bound(const Bounds *b, Expr e, Real value) {
  Real relative = 0;
  for (uint32_t i = 0; i < expr_pairs(b->g, e, EX_PROD); i++) {
    Num k;
    Expr x = expr_pair(b->g, e, EX_PROD, i, &k);
    Real size = fabsl((Real)num_value(k));
    relative += size * bound_of(b, x) / fabsl(value_of(b, x)) + (size + 4) * LDBL_EPSILON;
    if (num_error(k) > 0) relative += (Real)num_error(k) * fabsl(logl(fabsl(value_of(b, x))));
  }
  return isnan(relative) ? INFINITY : relative * fabsl(value);
}

/* |f'(x)| for functions of one argument. */
static Real slope(ExprOp op, Real x, Real f) {
  switch (op) {
    case EX_SIN: case EX_COS: case EX_ATAN: case EX_ABS: case EX_TANH: case EX_DEF: return 1;
    case EX_TAN: return 1 + f * f;
    case EX_ASIN: case EX_ACOS: return 1 / sqrtl(1 - x * x);
    case EX_SINH: case EX_COSH: return coshl(x);
    case EX_EXP: return fabsl(f);
    case EX_LOG: return 1 / fabsl(x);
    case EX_CBRT: return 1 / (3 * f * f);
    case EX_SIGN: case EX_NOT: case EX_NUM: case EX_SYM: case EX_SUM: case EX_PROD: case EX_POW:
    case EX_ATAN2: case EX_HYPOT: case EX_MIN: case EX_MAX: case EX_LT: case EX_LE: case EX_EQ:
    case EX_AND: case EX_OR: case EX_SELECT: case EX_COUNT: break;
  }
  return INFINITY;
}

/* Comparisons are certain, or nothing is known; they and what is built of them have bound 0. */
static Real compare_bound(const Bounds *b, Expr e) {
  Expr x = expr_arg(b->g, e, 0), y = expr_arg(b->g, e, 1);
  Real gap = fabsl(value_of(b, x) - value_of(b, y));
  return gap > bound_of(b, x) + bound_of(b, y) ? 0 : INFINITY;
}

static Real binary_bound(const Bounds *b, Expr e, Real f) {
  Expr first = expr_arg(b->g, e, 0), second = expr_arg(b->g, e, 1);
  Real x = value_of(b, first), y = value_of(b, second), dx = bound_of(b, first), dy = bound_of(b, second);
  Real rounding = 8 * LDBL_EPSILON * fabsl(f);
  switch (expr_op(b->g, e)) {
    case EX_POW: return fabsl(f) * (fabsl(y / x) * dx + fabsl(logl(fabsl(x))) * dy) + rounding * (1 + fabsl(y));
    case EX_ATAN2: return (fabsl(y) * dx + fabsl(x) * dy) / (x * x + y * y) + rounding;
    case EX_HYPOT: case EX_MIN: case EX_MAX: return dx + dy + rounding;
    case EX_LT: case EX_LE: case EX_EQ: return compare_bound(b, e);
    case EX_AND: case EX_OR: return dx + dy;
    case EX_SELECT: return dx > 0 ? INFINITY : x != 0 ? dy : bound_of(b, expr_arg(b->g, e, 2));
    case EX_NUM: case EX_SYM: case EX_DEF: case EX_SUM: case EX_PROD: case EX_SIN: case EX_COS:
    case EX_TAN: case EX_ASIN: case EX_ACOS: case EX_ATAN: case EX_SINH: case EX_COSH: case EX_TANH:
    case EX_EXP: case EX_LOG: case EX_CBRT: case EX_ABS: case EX_SIGN: case EX_NOT: case EX_COUNT: break;
  }
  return INFINITY;
}

static Real unary_bound(const Bounds *b, Expr e, Real f) {
  ExprOp op = expr_op(b->g, e);
  Expr arg = expr_arg(b->g, e, 0);
  Real x = value_of(b, arg), dx = bound_of(b, arg);
  if (op == EX_NOT) return dx;
  if (op == EX_SIGN) return fabsl(x) > dx ? 0 : INFINITY;
  if (op == EX_DEF) return dx;
  return (dx > 0 ? slope(op, x, f) * dx : 0) + 8 * LDBL_EPSILON * fabsl(f);
}

static Real node_bound(const Bounds *b, Expr e, Real value, const Real *errors) {
  switch (expr_op(b->g, e)) {
    case EX_NUM: return LDBL_EPSILON * fabsl(value) + (Real)num_error(expr_number(b->g, e));
    case EX_SYM: return errors ? errors[expr_sym_id(b->g, e)] : 0;
    case EX_SUM: return sum_bound(b, e);
    case EX_PROD: return prod_bound(b, e, value);
    case EX_POW: case EX_ATAN2: case EX_HYPOT: case EX_MIN: case EX_MAX: case EX_LT: case EX_LE:
    case EX_EQ: case EX_AND: case EX_OR: case EX_SELECT: return binary_bound(b, e, value);
    case EX_DEF: case EX_SIN: case EX_COS: case EX_TAN: case EX_ASIN: case EX_ACOS: case EX_ATAN:
    case EX_SINH: case EX_COSH: case EX_TANH: case EX_EXP: case EX_LOG: case EX_CBRT: case EX_ABS:
    case EX_SIGN: case EX_NOT: return unary_bound(b, e, value);
    case EX_COUNT: break;
  }
  return INFINITY;
}

long double prove_value(ExprGraph *g, Expr e, const long double *symbols, const long double *errors,
                        long double *bound) {
  *bound = 0;
  if (!e) return 0;
  ExprList nodes = expr_topo(g, &e, 1);
  Arena *a = expr_arena(g);
  Real *value = ARENA_ARRAY(a, Real, nodes.n + 1), *bounds = ARENA_ARRAY(a, Real, nodes.n + 1);
  ExprMap place = expr_map(a);
  expr_eval(g, nodes.at, nodes.n, symbols, value);
  Bounds b = {.g = g, .value = value, .bound = bounds, .place = &place};
  for (uint32_t i = 0; i < nodes.n; i++) {
    expr_map_set(&place, nodes.at[i], i + 1);
    bounds[i] = node_bound(&b, nodes.at[i], value[i], errors);
  }
  *bound = bounds[nodes.n - 1];
  return value[nodes.n - 1];
}
