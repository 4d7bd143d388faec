/* The cut of sum(j in near(i, r_cut), f): what pairs at that distance have, from values of f there. */
#include "mech/near_cut.h"

#include <math.h>

#include "mech/consistent_start.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"

typedef long double Real;

/* A pair at distances cut*part along a line: its value, and the force along the line. */
typedef struct {
  const Eqns *e;
  const NearTest *t;
  Expr inside, slope[3];
  Real *symbols, cut;
} Pair;

static void pair_at(Pair *p, Real part, int line, Real *value, Real *force) {
  static const Real direction[2][3] = {{0.6L, 0.64L, 0.48L}, {-0.28L, 0.96L, 0}};
  ExprGraph *g = p->e->g;
  Real length = 0;
  *force = 0;
  for (uint32_t c = 0; c < p->t->n; c++) length += direction[line][c] * direction[line][c];
  for (uint32_t c = 0; c < p->t->n; c++) {
    p->symbols[expr_sym_id(g, p->t->at_j[c])] = 0;
    p->symbols[expr_sym_id(g, p->t->at_i[c])] = part * p->cut * direction[line][c] / sqrtl(length);
  }
  expr_eval(g, &p->inside, 1, p->symbols, value);
  for (uint32_t c = 0; c < p->t->n; c++) {
    Real slope;
    expr_eval(g, &p->slope[c], 1, p->symbols, &slope);
    *force += slope * direction[line][c] / sqrtl(length);
  }
}

static Real value_of(const Eqns *e, Expr x, const Real *symbols) {
  Real v;
  expr_eval(e->g, &x, 1, symbols, &v);
  return v;
}

NearCut near_cut(const Eqns *e, const SumNest *s, Expr value) {
  enum { LINES = 2, PARTS = 8 };
  const NearTest *t = s->near;
  Expr yes = expr_int(e->g, 1);
  Pair p = {.e = e, .t = t, .symbols = start_requested(e)};
  NearCut r = {0};
  Real most = 0, strongest = 0;
  expr_replace_nodes(e->g, &value, 1, &t->test, &yes, 1, &p.inside);
  p.cut = value_of(e, t->cut, p.symbols);
  for (uint32_t c = 0; c < t->n; c++) p.slope[c] = expr_diff(e->g, p.inside, expr_sym_id(e->g, t->at_i[c]));
  for (int line = 0; line < LINES; line++)
    for (int k = PARTS / 2; k <= PARTS; k++) {
      Real v, f;
      pair_at(&p, (Real)k / PARTS, line, &v, &f);
      most = fmaxl(most, fabsl(v));
      strongest = fmaxl(strongest, fabsl(f));
      if (k == PARTS && fabsl(v) > fabsl(r.value)) r.value = v;
      if (k == PARTS && fabsl(f) > fabsl(r.force)) r.force = f;
    }
  if (!(fabsl(r.value) > 1e-9L * most)) r.value = 0; /* rounding */
  if (!(fabsl(r.force) > 1e-9L * strongest)) r.force = 0;
  return r;
}
