/* Each switch has two branches; a proof takes one switch after another, inner ones first. */
#include "sym/sides.h"

#include "sym/prove.h"

/* Branches of a switch at u = 0; u 0: no switch. */
typedef struct {
  Expr u, above, below;
} Branches;

static Branches branches_of(ExprGraph *g, Expr e) {
  ExprOp op = expr_op(g, e);
  Expr yes = expr_int(g, 1), no = expr_int(g, 0);
  if (op == EX_ABS || op == EX_SIGN) {
    Expr u = expr_arg(g, e, 0), size = op == EX_ABS ? u : yes;
    return (Branches){u, size, expr_neg(g, size)};
  }
  if (op != EX_MIN && op != EX_MAX && op != EX_LT && op != EX_LE) return (Branches){0};
  Expr a = expr_arg(g, e, 0), b = expr_arg(g, e, 1), u = expr_sub(g, b, a);
  if (op == EX_LT || op == EX_LE) return (Branches){u, yes, no};
  return op == EX_MIN ? (Branches){u, a, b} : (Branches){u, b, a};
}

Expr switch_in(ExprGraph *g, Expr x, SymId s) {
  ExprList l = expr_topo(g, &x, 1);
  for (uint32_t i = 0; i < l.n; i++) {
    Expr u = branches_of(g, l.at[i]).u;
    if (u && (!s || expr_contains_sym(g, u, s))) return u;
  }
  return 0;
}

Expr on_side(ExprGraph *g, Expr x, Expr u, int sign) {
  VEC(Expr) node = {0}, with = {0};
  ExprList l = expr_topo(g, &x, 1);
  for (uint32_t i = 0; i < l.n; i++) {
    Branches b = branches_of(g, l.at[i]);
    Expr ratio = b.u ? expr_div(g, b.u, u) : 0;
    if (!ratio || !expr_is_num(g, ratio)) continue;
    vec_push(expr_arena(g), &node, l.at[i]);
    vec_push(expr_arena(g), &with, num_sign(expr_number(g, ratio)) * sign > 0 ? b.above : b.below);
  }
  expr_replace_nodes(g, &x, 1, node.at, with.at, node.n, &x);
  return x;
}

static int is_zero_within(ExprGraph *g, Expr x, int depth) {
  if (prove_zero(g, x, NULL) == PROVED_ZERO) return 1;
  Expr u = depth > 0 ? switch_in(g, x, 0) : 0;
  return u && is_zero_within(g, on_side(g, x, u, 1), depth - 1) && is_zero_within(g, on_side(g, x, u, -1), depth - 1);
}

int zero_on_sides(ExprGraph *g, Expr x) {
  enum { SWITCHES_MOST = 6 };
  return is_zero_within(g, expr_expand_defs(g, x), SWITCHES_MOST);
}
