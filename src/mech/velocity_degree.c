/* One pass over the nodes of x, arguments first, with a map of degrees. */
#include "mech/velocity_degree.h"

#include "sym/diff.h"
#include "sym/sum_nest.h"

/* Degree of x from the map, which keeps degree + 1: 0 is no entry. */
static uint8_t kept(const ExprMap *degrees, Expr x) { return (uint8_t)(expr_map_get(degrees, x) - 1); }

/* Degree of a sum; NO_DEGREE if its terms differ. */
static uint8_t of_sum(const ExprGraph *g, Expr x, const ExprMap *degrees) {
  Num k;
  uint8_t first = kept(degrees, expr_pair(g, x, EX_SUM, 0, &k));
  for (uint32_t i = 1; i < expr_pairs(g, x, EX_SUM); i++)
    if (kept(degrees, expr_pair(g, x, EX_SUM, i, &k)) != first) return NO_DEGREE;
  return first;
}

static uint8_t of_product(const ExprGraph *g, Expr x, const ExprMap *degrees) {
  uint32_t sum = 0;
  for (uint32_t i = 0; i < expr_pairs(g, x, EX_PROD); i++) {
    Num k;
    uint32_t one = kept(degrees, expr_pair(g, x, EX_PROD, i, &k));
    if (!one) continue;
    if (one == NO_DEGREE || !num_is_int(k) || k.num < 0 || k.num >= NO_DEGREE) return NO_DEGREE;
    if ((sum += one * (uint32_t)k.num) >= NO_DEGREE) return NO_DEGREE;
  }
  return (uint8_t)sum;
}

static uint8_t of_node(ExprGraph *g, Arena *arena, Expr x, const ExprMap *degrees) {
  ExprOp op = expr_op(g, x);
  const SumNest *s = op == EX_CELL ? expr_sum_nest(g, expr_cell_nest(g, x)) : NULL;
  if (!has_velocities(g, x)) return 0;
  if (op == EX_SYM) return 1;
  if (s && s->ncells == 1) return velocity_degree(g, arena, s->shares->value);
  if (op == EX_DEF) return kept(degrees, expr_arg(g, x, 0));
  return op == EX_SUM ? of_sum(g, x, degrees) : op == EX_PROD ? of_product(g, x, degrees) : NO_DEGREE;
}

static ExprMap degrees_below(ExprGraph *g, Arena *arena, Expr x) {
  ExprMap degrees = expr_map(arena);
  ExprList all = expr_topo_to_sums(g, &x, 1);
  for (uint32_t i = 0; i < all.n; i++) expr_map_set(&degrees, all.at[i], of_node(g, arena, all.at[i], &degrees) + 1u);
  expr_list_free(g, all);
  return degrees;
}

uint8_t velocity_degree(ExprGraph *g, Arena *arena, Expr x) {
  ExprMap degrees = degrees_below(g, arena, x);
  uint8_t of = kept(&degrees, x);
  expr_map_free(&degrees);
  return of;
}

void velocity_degrees(ExprGraph *g, Arena *arena, Expr x, uint8_t *degrees) {
  ExprMap all = degrees_below(g, arena, x);
  Num k;
  for (uint32_t i = 0; i < expr_pairs(g, x, EX_SUM); i++) degrees[i] = kept(&all, expr_pair(g, x, EX_SUM, i, &k));
  expr_map_free(&all);
}

int is_linear_in_velocities(ExprGraph *g, Expr x, uint32_t n) {
  ExprPartials d = expr_gradient_sparse(g, x, SYM_VEL, n);
  for (uint32_t i = 0; i < d.n; i++)
    if (has_velocities(g, d.at[i].e)) return 0;
  return 1;
}
