/* Nodes of expressions, filtered, into a list without repetitions. */
#include "claims/feature_pool.h"

void pool_add(FeaturePool *pool, Expr e) {
  for (uint32_t i = 0; i < pool->n; i++)
    if (pool->at[i] == e) return;
  if (pool->n < FEATURES_MAX) pool->at[pool->n++] = e;
}

void pool_angle(FeaturePool *pool, Expr angle) {
  Expr sine = expr_fn(pool->g, EX_SIN, angle), cosine = expr_fn(pool->g, EX_COS, angle);
  pool_add(pool, expr_op(pool->g, sine) == EX_SIN ? sine : expr_neg(pool->g, sine));
  pool_add(pool, cosine);
}

void pool_nodes(FeaturePool *pool, ExprList nodes, unsigned what, unsigned kinds) {
  for (uint32_t i = 0; i < nodes.n; i++) {
    Expr e = nodes.at[i];
    ExprOp op = expr_op(pool->g, e);
    int symbol = op == EX_SYM && kinds & expr_kinds(pool->g, e);
    int compound = op == EX_SUM || op == EX_HYPOT || op == EX_EXP || op == EX_TAN || op == EX_LOG;
    if (what & POOL_ANGLES && (op == EX_SIN || op == EX_COS)) pool_angle(pool, expr_arg(pool->g, e, 0));
    if (!((what & POOL_SYMBOLS && symbol) || (what & POOL_COMPOUNDS && compound))) continue;
    if (!pool->barred || !pool->barred(pool->data, e)) pool_add(pool, e);
  }
}
