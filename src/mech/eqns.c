/* Access to the equations. */
#include "mech/eqns.h"

#include <stdlib.h>

#include "sym/prove.h"
#include "sym/simplify.h"

typedef struct {
  MassEntry x;
  uint32_t order;
} Placed;

static int by_place(const void *a, const void *b) {
  const Placed *p = a, *q = b;
  if (p->x.row != q->x.row) return p->x.row < q->x.row ? -1 : 1;
  if (p->x.col != q->x.col) return p->x.col < q->x.col ? -1 : 1;
  return (p->order > q->order) - (p->order < q->order);
}

void entries_collect(ExprGraph *g, Entries *t, Expr (*rule)(ExprGraph *, Expr)) {
  uint32_t n = t->n;
  Placed *all = ARENA_ARRAY(expr_arena(g), Placed, n + 1);
  for (uint32_t i = 0; i < n; i++) all[i] = (Placed){t->at[i], i};
  qsort(all, n, sizeof *all, by_place);
  t->n = 0;
  for (uint32_t i = 0; i < n;) {
    MassEntry sum = all[i++].x;
    for (; i < n && all[i].x.row == sum.row && all[i].x.col == sum.col; i++) sum.e = expr_add(g, sum.e, all[i].x.e);
    if (rule) sum.e = rule(g, sum.e);
    if (!expr_is_zero(g, sum.e)) t->at[t->n++] = sum;
  }
}

Expr entries_at(ExprGraph *g, const Entries *t, uint32_t i, uint32_t j) {
  uint32_t row = i > j ? i : j, col = i > j ? j : i, lo = 0, hi = t->n;
  while (lo < hi) {
    uint32_t mid = lo + (hi - lo) / 2;
    const MassEntry *x = &t->at[mid];
    if (x->row < row || (x->row == row && x->col < col)) lo = mid + 1;
    else hi = mid;
  }
  int found = lo < t->n && t->at[lo].row == row && t->at[lo].col == col;
  return found ? t->at[lo].e : expr_int(g, 0);
}

Expr eqns_mass(const Eqns *e, uint32_t i, uint32_t j) { return entries_at(e->g, &e->mass, i, j); }

uint32_t eqns_coordinates(const Eqns *e) { return e->n ? e->n : e->first.n; }

SymId eqns_coordinate(const Eqns *e, uint32_t i) {
  return e->n ? e->m->coords.at[i].q : e->m->states.at[e->first.at[i]].z;
}

SymId *eqns_symbols(const Eqns *e, int velocities) {
  uint32_t n = eqns_coordinates(e);
  SymId *s = ARENA_ARRAY(e->m->arena, SymId, n + 1);
  for (uint32_t i = 0; i < n; i++)
    s[i] = !velocities ? eqns_coordinate(e, i) : e->n ? e->m->coords.at[i].v : e->m->states.at[e->first.at[i]].rate;
  return s;
}

const Expr *eqns_momenta(const Eqns *e) { return e->first.n ? e->first.theta : e->m->regularising ? e->momenta : e->p; }

Expr eqns_at_rest(const Eqns *e, Expr x) {
  uint32_t n = expr_symbol_count(e->g) + 1;
  Expr *rest = ARENA_ARRAY(e->m->arena, Expr, n);
  for (uint32_t i = 0; i < e->n; i++) rest[e->m->coords.at[i].v] = expr_int(e->g, 0);
  return simplify(e->g, expr_substitute(e->g, x, rest, n, "_at_rest"));
}

int eqns_has_forces(const Eqns *e) {
  for (uint32_t i = 0; e->Q && i < eqns_coordinates(e); i++)
    if (!expr_is_zero(e->g, e->Q[i])) return 1;
  return 0;
}

long double eqns_potential_at(const Eqns *e, const long double *symbols, long double *bound) {
  return value_with_bound(e->g, e->potential, symbols, NULL, bound);
}
