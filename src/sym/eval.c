#include "sym/eval.h"

#include <math.h>

static long double power(long double base, Num e) {
  if (!num_is_exact(e)) return powl(base, num_value(e));
  if (e.den == 1) {
    long double r = 1, b = base;
    for (int64_t n = e.num < 0 ? -e.num : e.num; n; n >>= 1, b *= b)
      if (n & 1) r *= b;
    return e.num < 0 ? 1 / r : r;
  }
  if (e.den == 2) return power(sqrtl(base), num_int(e.num));
  return powl(base, (long double)e.num / (long double)e.den);
}

static long double number(Num n) {
  return num_is_exact(n) ? (long double)n.num / (long double)n.den : n.approx;
}

static long double pairs_value(ExprGraph *g, Expr e, const long double *v, const ExprMap *at) {
  ExprOp op = expr_op(g, e);
  long double r = op == EX_SUM ? 0 : 1;
  for (uint32_t i = 0; i < expr_pairs(g, e, op); i++) {
    Num k;
    long double x = v[expr_map_get(at, expr_pair(g, e, op, i, &k))];
    if (op == EX_SUM) r += number(k) * x;
    else r *= power(x, k);
  }
  return r;
}

static long double node_value(ExprGraph *g, Expr e, const long double *symbols, const long double *v,
                              const ExprMap *at) {
  long double x = 0, y = 0;
  ExprOp op = expr_op(g, e);
  if (op != EX_SUM && op != EX_PROD) {
    if (expr_nargs(g, e) > 0) x = v[expr_map_get(at, expr_arg(g, e, 0))];
    if (expr_nargs(g, e) > 1) y = v[expr_map_get(at, expr_arg(g, e, 1))];
  }
  switch (op) {
    case EX_NUM: return number(expr_number(g, e));
    case EX_SYM: return symbols[expr_sym_id(g, e)];
    case EX_DEF: return x;
    case EX_SUM: case EX_PROD: return pairs_value(g, e, v, at);
    case EX_POW: return powl(x, y);
    case EX_SIN: return sinl(x);
    case EX_COS: return cosl(x);
    case EX_TAN: return tanl(x);
    case EX_ASIN: return asinl(x);
    case EX_ACOS: return acosl(x);
    case EX_ATAN: return atanl(x);
    case EX_SINH: return sinhl(x);
    case EX_COSH: return coshl(x);
    case EX_TANH: return tanhl(x);
    case EX_EXP: return expl(x);
    case EX_LOG: return logl(x);
    case EX_CBRT: return cbrtl(x);
    case EX_ABS: return fabsl(x);
    case EX_SIGN: return (long double)((x > 0) - (x < 0));
    case EX_ATAN2: return atan2l(x, y);
    case EX_HYPOT: return hypotl(x, y);
    case EX_MIN: return x < y ? x : y;
    case EX_MAX: return x > y ? x : y;
    case EX_LT: return x < y;
    case EX_LE: return x <= y;
    case EX_EQ: return x == y;
    case EX_NOT: return x == 0;
    case EX_AND: return x != 0 && y != 0;
    case EX_OR: return x != 0 || y != 0;
    case EX_SELECT: return x != 0 ? y : v[expr_map_get(at, expr_arg(g, e, 2))];
    case EX_COUNT: break;
  }
  return NAN;
}

void expr_eval(ExprGraph *g, const Expr *roots, uint32_t n, const long double *symbols, long double *out) {
  ExprList l = expr_topo(g, roots, n);
  ExprMap at = expr_map(expr_arena(g));
  long double *v = ARENA_ARRAY(expr_arena(g), long double, l.n + 1);
  for (uint32_t i = 0; i < l.n; i++) {
    expr_map_set(&at, l.at[i], i + 1);
    v[i + 1] = node_value(g, l.at[i], symbols, v, &at);
  }
  for (uint32_t i = 0; i < n; i++) out[i] = roots[i] ? v[expr_map_get(&at, roots[i])] : 0;
}
