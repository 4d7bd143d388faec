/* Finds long sums of velocities in nonlinear products, sorts them by length, and defines each as partial sums on top of the longest known sum
 * that it contains. */
#include "mech/velocity_sums.h"

#include <stdlib.h>

#include "mech/degree.h"
#include "sym/diff.h"

/* Least number of terms with velocities of a sum: up to 12 coordinates a dense system takes no more operations. */
enum { FEWEST = 13 };

typedef struct {
  Expr e, def;
  uint32_t pairs, base; /* number of terms; index from 1 of the sum that this one is built on, or 0 */
} Sum;

typedef struct {
  ExprGraph *g;
  Arena *a;
  VEC(Sum) sums;
  ExprMap owner;  /* by term: index from 1 of the last sum that contains it */
  ExprMap number; /* by term of the current sum: its index from 1 */
} Sums;

static int is_long(const ExprGraph *g, Expr e) {
  uint32_t some = 0;
  for (uint32_t k = 0; expr_op(g, e) == EX_SUM && k < expr_pairs(g, e, EX_SUM) && some < FEWEST; k++) {
    Num unused;
    some += has_velocities(g, expr_pair(g, e, EX_SUM, k, &unused)) != 0;
  }
  return some == FEWEST;
}

/* Adds the long linear sums among the factors of a product that is nonlinear in velocities. */
static void find_in_product(Sums *s, Expr product, uint32_t n, ExprMap *seen) {
  uint32_t pairs = expr_pairs(s->g, product, EX_PROD), moving = 0;
  for (uint32_t k = 0; k < pairs; k++) {
    Num power;
    Expr x = expr_pair(s->g, product, EX_PROD, k, &power);
    moving += has_velocities(s->g, x) ? num_equal(power, num_int(1)) ? 1 : 2 : 0;
  }
  for (uint32_t k = 0; k < pairs && moving > 1; k++) {
    Num power;
    Expr x = expr_pair(s->g, product, EX_PROD, k, &power);
    if (expr_map_get(seen, x) || !is_long(s->g, x) || !is_linear_in_velocities(s->g, x, n)) continue;
    expr_map_set(seen, x, 1);
    vec_push(s->a, &s->sums, ((Sum){.e = x, .pairs = expr_pairs(s->g, x, EX_SUM)}));
  }
}

static int by_length(const void *a, const void *b) {
  const Sum *x = a, *y = b;
  if (x->pairs != y->pairs) return x->pairs < y->pairs ? -1 : 1;
  return (x->e > y->e) - (x->e < y->e);
}

/* Whether all terms of x are terms of the current sum `in`, with the same coefficients. */
static int is_contained(const Sums *s, const Sum *x, Expr in) {
  for (uint32_t k = 0; k < x->pairs; k++) {
    Num a, b;
    uint32_t at = expr_map_get(&s->number, expr_pair(s->g, x->e, EX_SUM, k, &a));
    if (!at) return 0;
    expr_pair(s->g, in, EX_SUM, at - 1, &b);
    if (!num_equal(a, b)) return 0;
  }
  return 1;
}

/* Index from 1 of the longest known sum contained in x, among the last sums with a term of x and their bases; 0: none. */
static uint32_t find_base(const Sums *s, const Sum *x) {
  enum { TRIED = 4 };
  uint32_t best = 0;
  for (uint32_t k = x->pairs, tried = 0; k-- > 0 && tried < TRIED;) {
    Num unused;
    uint32_t c = expr_map_get(&s->owner, expr_pair(s->g, x->e, EX_SUM, k, &unused));
    tried += c != 0;
    while (c && !is_contained(s, &s->sums.at[c - 1], x->e)) c = s->sums.at[c - 1].base;
    if (c && (!best || s->sums.at[c - 1].pairs > s->sums.at[best - 1].pairs)) best = c;
  }
  return best;
}

/* x as the base plus its other terms, one by one: each partial sum is a definition, so that coordinates and definitions can be
 * eliminated by turns. A single definition of the whole sum would be eliminated before all its coordinates, and couple them all. */
static Expr built_on(Sums *s, const Sum *x, const Sum *base) {
  expr_map_clear(&s->number);
  for (uint32_t k = 0; base && k < base->pairs; k++) {
    Num unused;
    expr_map_set(&s->number, expr_pair(s->g, base->e, EX_SUM, k, &unused), 1);
  }
  Expr sum = base ? base->def : 0;
  for (uint32_t k = 0; k < x->pairs; k++) {
    Num number;
    Expr term = expr_pair(s->g, x->e, EX_SUM, k, &number);
    if (expr_map_get(&s->number, term)) continue;
    term = expr_scale(s->g, number, term);
    Expr longer = sum ? expr_add(s->g, sum, term) : term;
    sum = sum ? expr_def_unique(s->g, "sum", longer) : longer;
  }
  return sum;
}

static void define(Sums *s, uint32_t k) {
  Sum *x = &s->sums.at[k];
  Num unused;
  expr_map_clear(&s->number);
  for (uint32_t j = 0; j < x->pairs; j++) expr_map_set(&s->number, expr_pair(s->g, x->e, EX_SUM, j, &unused), j + 1);
  x->base = find_base(s, x);
  x->def = built_on(s, x, x->base ? &s->sums.at[x->base - 1] : NULL);
  for (uint32_t j = 0; j < x->pairs; j++) expr_map_set(&s->owner, expr_pair(s->g, x->e, EX_SUM, j, &unused), k + 1);
}

Expr define_velocity_sums(ExprGraph *g, Expr L, uint32_t n) {
  Arena *a = expr_arena(g);
  Sums s = {.g = g, .a = a, .owner = expr_map(a), .number = expr_map(a)};
  ExprMap seen = expr_map(a);
  ExprList all = expr_topo_shallow(g, &L, 1);
  for (uint32_t k = 0; k < all.n; k++)
    if (expr_op(g, all.at[k]) == EX_PROD && has_velocities(g, all.at[k])) find_in_product(&s, all.at[k], n, &seen);
  if (!s.sums.n) return L;
  qsort(s.sums.at, s.sums.n, sizeof *s.sums.at, by_length);
  Expr *nodes = ARENA_ARRAY(a, Expr, s.sums.n), *with = ARENA_ARRAY(a, Expr, s.sums.n), r;
  for (uint32_t k = 0; k < s.sums.n; k++) {
    define(&s, k);
    nodes[k] = s.sums.at[k].e;
    with[k] = s.sums.at[k].def;
  }
  expr_replace_nodes(g, &L, 1, nodes, with, s.sums.n, &r);
  return r;
}
