/* A tape for each factor and its gradient; Newton's method on the factor alone, since from a state far from all factors' zeros the
 * product leads to the nearest. */
#include "symmetry/constraint_factors.h"

#include <math.h>

#include "base/tolerance.h"
#include "mech/constrain.h"
#include "sym/diff.h"
#include "sym/eval.h"

typedef struct {
  Expr factor;
  EvalTape *tape; /* the factor, then its gradient */
} Part;

struct ConstraintFactors {
  const Eqns *e;
  VEC(Part) parts;
  SymId *q;
  long double *value; /* [1 + coordinates] */
};

static void add_part(ConstraintFactors *p, Expr factor) {
  const Eqns *e = p->e;
  Expr *roots = ARENA_ARRAY(e->m->arena, Expr, 1 + (size_t)e->n);
  roots[0] = factor;
  expr_gradient(e->g, factor, p->q, e->n, roots + 1);
  vec_push(e->m->arena, &p->parts, ((Part){factor, eval_tape(e->g, roots, 1 + e->n)}));
}

/* Whether base^power is a factor that contains coordinates and may be 0. */
static int may_vanish(const Eqns *e, Expr base, Num power) {
  ExprSign sign = expr_sign(e->g, base);
  return num_sign(power) > 0 && sign != SIGN_POSITIVE && sign != SIGN_NEGATIVE && (expr_kinds(e->g, base) & 1u << SYM_COORD);
}

ConstraintFactors *constraint_factors_new(const Eqns *e) {
  ConstraintFactors *p = ARENA_NEW(e->m->arena, ConstraintFactors);
  const Constraints *k = &e->constraints;
  p->e = e;
  p->q = ARENA_ARRAY(e->m->arena, SymId, e->n + 1);
  p->value = ARENA_ARRAY(e->m->arena, long double, 1 + (size_t)e->n);
  for (uint32_t i = 0; i < e->n; i++) p->q[i] = e->m->coords.at[i].q;
  for (uint32_t i = 0; i < k->nholonomic; i++) {
    Num c, power;
    Expr product = expr_pair(e->g, k->c[i], EX_SUM, 0, &c);
    uint32_t count = 0;
    if (contact_of_constraint(e->m, k->of[i]) || expr_pairs(e->g, k->c[i], EX_SUM) > 1) continue;
    for (uint32_t f = 0; f < expr_pairs(e->g, product, EX_PROD); f++) count += (uint32_t)may_vanish(e, expr_pair(e->g, product, EX_PROD, f, &power), power);
    for (uint32_t f = 0; f < expr_pairs(e->g, product, EX_PROD) && count > 1; f++) {
      Expr base = expr_pair(e->g, product, EX_PROD, f, &power);
      if (may_vanish(e, base, power)) add_part(p, base);
    }
  }
  return p;
}

uint32_t constraint_factors_count(const ConstraintFactors *p) { return p->parts.n; }
Expr constraint_factors_at(const ConstraintFactors *p, uint32_t part) { return p->parts.at[part].factor; }

/* Value of the factor; its gradient in value[1 ..]. */
static long double factor_at(ConstraintFactors *p, uint32_t part, const long double *symbols) {
  eval_run(p->parts.at[part].tape, symbols, p->value);
  return p->value[0];
}

int constraint_factors_solve(ConstraintFactors *p, uint32_t part, long double *symbols) {
  enum { MOST = 60 };
  for (int turn = 0; turn < MOST; turn++) {
    long double f = factor_at(p, part, symbols), square = 0;
    if (fabsl(f) < LONG_TOLERANCE(1e-16L)) return 1;
    for (uint32_t i = 0; i < p->e->n; i++) square += p->value[1 + i] * p->value[1 + i];
    if (!(square > 0) || !isfinite(square) || !isfinite(f)) return 0;
    for (uint32_t i = 0; i < p->e->n; i++) symbols[p->q[i]] -= f / square * p->value[1 + i];
  }
  return constraint_factors_is_zero(p, part, symbols);
}

int constraint_factors_is_zero(ConstraintFactors *p, uint32_t part, const long double *symbols) {
  return fabsl(factor_at(p, part, symbols)) < LONG_TOLERANCE(1e-14L);
}
