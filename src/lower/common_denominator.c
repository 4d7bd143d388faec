/* A common denominator for coefficients that are graded along a family, i/N or 0.1*i. In lowest terms (1/6, 1/3, 1/2, 2/3) the members
 * differ; over one denominator their numerators count up, and the members are turns of one loop. */
#include "lower/lower_impl.h"

enum { FEWEST = 32, SHARED_BY = 8, LARGEST = 1 << 20 };

/* Whether few terms have the coefficient, as one member's own. */
static int is_own(Lower *l, Num c) {
  Expr x = expr_num(l->g, c);
  return expr_map_get(&l->term_count, x) < SHARED_BY;
}

typedef struct {
  Lower *l;
  VEC(Num) own; /* distinct coefficients whose denominators are no powers of 2 */
} OwnCoefficients;

static void count(OwnCoefficients *d, Expr sum) {
  ExprGraph *g = d->l->g;
  for (uint32_t i = 0; i < expr_pairs(g, sum, EX_SUM); i++) {
    Num c;
    expr_pair(g, sum, EX_SUM, i, &c);
    c = num_abs(c);
    if (!num_is_exact(c)) continue;
    Expr x = expr_num(g, c);
    uint32_t n = expr_map_get(&d->l->term_count, x);
    expr_map_set(&d->l->term_count, x, n + 1);
    if (!n && (c.den & (c.den - 1)) != 0) vec_push(d->l->p->arena, &d->own, c);
  }
}

void lower_find_denominator(Lower *l, const Expr *roots, uint32_t n) {
  if (l->denominator || l->e->n + l->e->m->states.n < FEWEST) return;
  OwnCoefficients d = {.l = l};
  l->term_count = expr_map(l->p->arena);
  ExprList nodes = expr_topo(l->g, roots, n);
  for (uint32_t k = 0; k < nodes.n; k++)
    if (expr_op(l->g, nodes.at[k]) == EX_SUM) count(&d, nodes.at[k]);
  uint32_t own = 0;
  int64_t all = 1;
  for (uint32_t k = 0; k < d.own.n; k++) {
    Num c = d.own.at[k];
    if (!is_own(l, c)) continue;
    own++;
    if (all % c.den == 0) continue;
    int64_t shared = num_gcd(num_int(all), num_int(c.den)).num;
    if (c.den > LARGEST || all / shared * c.den > LARGEST) return;
    all = all / shared * c.den;
  }
  if (own >= FEWEST) l->denominator = all;
}

int64_t lower_denominator_scale(Lower *l, Num c) {
  const int64_t most = 1LL << 40;
  if (!l->denominator || !num_is_exact(c) || l->denominator % c.den != 0 || c.num >= most || !is_own(l, c)) return 1;
  return l->denominator / c.den;
}
