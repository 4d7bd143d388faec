/* Jumps of L, of momenta, constraints and forces, each as a warning at its place in the text. */
#include "mech/discontinuity.h"

ExprJumps discontinuities_of(const Eqns *e, Expr x) {
  const Model *m = e->m;
  ExprGraph *g = e->g;
  if (expr_kinds(g, x) & 1u << SYM_INPUT) {
    Expr *formula = ARENA_ARRAY(m->arena, Expr, expr_symbol_count(g) + 1);
    for (uint32_t i = 0; i < m->inputs.n; i++) formula[m->inputs.at[i].sym] = m->inputs.at[i].value;
    x = expr_substitute(g, x, formula, expr_symbol_count(g) + 1, "");
  }
  return expr_jumps(g, x);
}
