/* Magnitudes bottom up over the graph: sums and products of the magnitudes of their parts, |e| for all else. */
#include "symmetry/term_magnitude.h"

static Expr size_of_sum(ExprGraph *g, const Expr *size, Expr x) {
  uint32_t n = expr_pairs(g, x, EX_SUM);
  Expr *terms = ARENA_ARRAY(expr_arena(g), Expr, n);
  for (uint32_t i = 0; i < n; i++) {
    Num c;
    Expr term = expr_pair(g, x, EX_SUM, i, &c);
    terms[i] = expr_scale(g, num_sign(c) < 0 ? num_neg(c) : c, size[term]);
  }
  return expr_add_n(g, terms, n);
}

static Expr size_of_product(ExprGraph *g, const Expr *size, Expr x) {
  uint32_t n = expr_pairs(g, x, EX_PROD);
  Expr *factors = ARENA_ARRAY(expr_arena(g), Expr, n);
  for (uint32_t i = 0; i < n; i++) {
    Num power;
    Expr base = expr_pair(g, x, EX_PROD, i, &power);
    int whole = num_is_int(power) && num_sign(power) > 0;
    if (whole) base = size[base];
    Expr factor = expr_pow_num(g, base, power);
    factors[i] = whole ? factor : expr_fn(g, EX_ABS, factor);
  }
  return expr_mul_n(g, factors, n);
}

Expr term_magnitude(ExprGraph *g, Expr x) {
  Expr *size = ARENA_ARRAY(expr_arena(g), Expr, (size_t)expr_count(g) + 1);
  ExprList l = expr_topo(g, &x, 1);
  for (uint32_t i = 0; i < l.n; i++) {
    Expr e = l.at[i];
    ExprOp op = expr_op(g, e);
    size[e] = op == EX_SUM ? size_of_sum(g, size, e)
            : op == EX_PROD ? size_of_product(g, size, e)
            : op == EX_DEF ? size[expr_arg(g, e, 0)]
            : expr_fn(g, EX_ABS, e);
  }
  return size[x];
}
