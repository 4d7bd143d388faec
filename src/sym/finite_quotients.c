/* Rewrites products that overflow to inf/inf or 0*inf for large arguments into forms that stay finite: sinh/cosh,
 * exp/exp, exp/(sum with exp), (1 - tanh^2)*cosh^2. */
#include "sym/expr_impl.h"

Expr expr_cosh_of_tanh(ExprGraph *g, Expr sum) {
  Num one, minus, two;
  if (expr_pairs(g, sum, EX_SUM) != 2 || expr_pair(g, sum, EX_SUM, 0, &one) != g->one || !num_is_one(one)) return 0;
  Expr square = expr_pair(g, sum, EX_SUM, 1, &minus), tanh = expr_pair(g, square, EX_PROD, 0, &two);
  int fits = num_equal(minus, num_int(-1)) && expr_pairs(g, square, EX_PROD) == 1 && num_equal(two, num_int(2)) &&
             expr_op(g, tanh) == EX_TANH;
  return fits ? expr_fn(g, EX_COSH, expr_arg(g, tanh, 0)) : 0;
}

/* (1 - tanh(u)^2)^k cosh(u)^m -> cosh(u)^(m - 2k), which is not 0 times infinity. Returns 1 when r changed. */
static int use_tanh_square(ExprGraph *g, Product *r) {
  for (uint32_t i = 0; i < r->p.n; i++) {
    if (expr_op(g, r->p.at[i].node) != EX_COSH || num_sign(r->p.at[i].number) < 0) continue;
    for (uint32_t k = 0; k < r->p.n; k++) {
      if (expr_op(g, r->p.at[k].node) != EX_SUM || expr_cosh_of_tanh(g, r->p.at[k].node) != r->p.at[i].node) continue;
      r->p.at[k] = (Pair){r->p.at[i].node, num_mul(num_int(-2), r->p.at[k].number)};
      return 1;
    }
  }
  return 0;
}

/* sinh(u)/cosh(u) as tanh(u), exp(u)/exp(v) as exp(u - v); 0 for other quotients. */
static Expr quotient_of(ExprGraph *g, Expr above, Expr below) {
  ExprOp a = expr_op(g, above), b = expr_op(g, below);
  Expr u = a == EX_SINH || a == EX_EXP ? expr_arg(g, above, 0) : 0;
  if (a == EX_SINH && b == EX_COSH && expr_arg(g, below, 0) == u) return expr_fn(g, EX_TANH, u);
  return a == EX_EXP && b == EX_EXP ? expr_fn(g, EX_EXP, expr_sub(g, u, expr_arg(g, below, 0))) : 0;
}

/* Applies quotient_of to one pair of factors. Returns 1 when r changed. */
static int use_pair_quotient(ExprGraph *g, Product *r) {
  for (uint32_t i = 0; i < r->p.n; i++) {
    Pair *x = &r->p.at[i];
    ExprOp op = expr_op(g, x->node);
    for (uint32_t k = 0; (op == EX_SINH || op == EX_EXP) && k < r->p.n; k++) {
      Pair *y = &r->p.at[k];
      Expr quotient = num_sign(x->number) == -num_sign(y->number) ? quotient_of(g, x->node, y->node) : 0;
      if (!quotient) continue;
      int all = num_cmp(num_abs(x->number), num_abs(y->number)) < 0 ||
                (op == EX_SINH && !(num_is_int(x->number) && num_is_int(y->number)));
      /* sinh(u) may be negative: a fractional power of it is moved whole */
      Num shared = all ? x->number : num_neg(y->number);
      x->number = num_sub(x->number, shared);
      y->number = num_add(y->number, shared);
      expr_push_power(g, r, quotient, shared);
      return 1;
    }
  }
  return 0;
}

/* Exponent of E in a term of a sum. */
static Num exponent_of(const ExprGraph *g, Expr term, Expr E) {
  Num e = num_int(0), k;
  for (uint32_t i = 0; i < expr_pairs(g, term, EX_PROD); i++)
    if (expr_pair(g, term, EX_PROD, i, &k) == E) e = k;
  return e;
}

/* Whether e is an exponential not known to be <= 1: exp(-x^2) is not large. */
static int is_large_exp(const ExprGraph *g, Expr e) {
  ExprSign s = expr_op(g, e) == EX_EXP ? expr_sign(g, expr_arg(g, e, 0)) : SIGN_NEGATIVE;
  return s != SIGN_NEGATIVE && s != SIGN_NONPOSITIVE;
}

/* Highest power of E = exp(u) in the terms of a sum whose lowest power of E is 0; 0 for other sums. */
static int64_t top_exponent(const ExprGraph *g, Expr sum, Expr E) {
  int64_t top = 0, bottom = INT64_MAX;
  for (uint32_t i = 0; i < expr_pairs(g, sum, EX_SUM); i++) {
    Num c, e = exponent_of(g, expr_pair(g, sum, EX_SUM, i, &c), E);
    if (!num_is_exact(e) || e.den != 1) return 0;
    if (e.num > top) top = e.num;
    if (e.num < bottom) bottom = e.num;
  }
  return bottom == 0 ? top : 0;
}

/* sum/E^k for E = exp(u), term by term; terms with fewer than k factors E get powers of exp(-u). */
static Expr divide_by_exp(ExprGraph *g, Expr sum, Expr E, int64_t k) {
  Expr minus_u = expr_neg(g, expr_arg(g, E, 0)), inverse = expr_fn(g, EX_EXP, minus_u);
  uint32_t n = expr_pairs(g, sum, EX_SUM);
  Expr *terms = ARENA_ARRAY(g->arena, Expr, n);
  for (uint32_t i = 0; i < n; i++) {
    Num c;
    Expr term = expr_pair(g, sum, EX_SUM, i, &c);
    int64_t e = exponent_of(g, term, E).num, out = e < k ? e : k;
    Expr less = expr_pow_num(g, E, num_int(-out)), more = expr_pow_num(g, inverse, num_int(k - out));
    Expr factors[3] = {term, less, more};
    terms[i] = expr_scale(g, c, expr_mul_n(g, factors, 3));
  }
  return expr_add_n(g, terms, n);
}

/* E^j S^-m for E = exp(u) and a sum S with powers of E: S is divided by E, exp(u)/(1 + exp(u)) -> 1/(exp(-u) + 1).
 * Returns 1 when r changed. */
static int use_exp_quotient(ExprGraph *g, Product *r) {
  for (uint32_t i = 0; i < r->p.n; i++) {
    Expr E = r->p.at[i].node;
    Num j = r->p.at[i].number;
    for (uint32_t k = 0; is_large_exp(g, E) && num_is_int(j) && num_sign(j) > 0 && k < r->p.n; k++) {
      Expr S = r->p.at[k].node;
      Num m = num_neg(r->p.at[k].number), each = num_div(j, m);
      int64_t top = expr_op(g, S) == EX_SUM && num_sign(m) > 0 ? top_exponent(g, S, E) : 0;
      if (!top || (!num_is_int(m) && !num_is_int(each))) continue;
      int64_t low = num_is_int(each) ? each.num : j.num / m.num, extra = num_is_int(each) ? 0 : j.num % m.num;
      if (low >= top) low = top, extra = 0;
      Num left = num_sub(j, num_add(num_mul(m, num_int(low)), num_int(extra)));
      r->p.at[i].number = left;
      r->p.at[k].number = num_int(0);
      Expr some = divide_by_exp(g, S, E, low), others = extra ? divide_by_exp(g, S, E, low + 1) : 0;
      expr_push_power(g, r, some, num_sub(num_int(extra), m));
      if (extra) expr_push_power(g, r, others, num_int(-extra));
      return 1;
    }
  }
  return 0;
}

/* Whether a term of T has the factor E = exp(u); if `below`, whether a term of T is divided by a sum that contains
 * E. */
static int meets_exp(const ExprGraph *g, Expr T, Expr E, int below) {
  Num c, k;
  for (uint32_t i = 0; i < expr_pairs(g, T, EX_SUM); i++) {
    Expr term = expr_pair(g, T, EX_SUM, i, &c);
    if (!below && !num_is_zero(exponent_of(g, term, E))) return 1;
    for (uint32_t j = 0; below && j < expr_pairs(g, term, EX_PROD); j++) {
      Expr S = expr_pair(g, term, EX_PROD, j, &k);
      if (num_sign(k) < 0 && expr_op(g, S) == EX_SUM && top_exponent(g, S, E)) return 1;
    }
  }
  return 0;
}

/* Index of the first factor of r that is a sum for which meets_exp holds; r->p.n if there is none. */
static uint32_t find_mixed_sum(const ExprGraph *g, const Product *r, Expr E, int below) {
  uint32_t i = 0;
  while (i < r->p.n && !(expr_op(g, r->p.at[i].node) == EX_SUM && num_is_one(r->p.at[i].number) &&
                         meets_exp(g, r->p.at[i].node, E, below)))
    i++;
  return i;
}

uint32_t expr_sum_to_distribute(const ExprGraph *g, const Product *r) {
  Num c, k;
  for (uint32_t i = 0; i < r->p.n; i++) {
    Expr x = r->p.at[i].node;
    int sign = num_sign(r->p.at[i].number);
    uint32_t at = sign > 0 && is_large_exp(g, x) ? find_mixed_sum(g, r, x, 1) : r->p.n;
    for (uint32_t j = 0; sign < 0 && expr_op(g, x) == EX_SUM && j < expr_pairs(g, x, EX_SUM) && at == r->p.n; j++) {
      Expr term = expr_pair(g, x, EX_SUM, j, &c);
      for (uint32_t l = 0; l < expr_pairs(g, term, EX_PROD) && at == r->p.n; l++) {
        Expr E = expr_pair(g, term, EX_PROD, l, &k);
        if (is_large_exp(g, E) && top_exponent(g, x, E)) at = find_mixed_sum(g, r, E, 0);
      }
    }
    if (at < r->p.n) return at;
  }
  return r->p.n;
}

int expr_rewrite_quotient(ExprGraph *g, Product *r) {
  return use_pair_quotient(g, r) || use_exp_quotient(g, r) || use_tanh_square(g, r);
}
