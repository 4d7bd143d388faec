/* Shared by lower.c (expressions), solve.c and eliminate.c (the linear system). */
#ifndef LAGC_LOWER_IMPL_H
#define LAGC_LOWER_IMPL_H

#include "ir/factored.h"
#include "ir/lower.h"

typedef struct {
  const Eqns *e;
  ExprGraph *g;
  Prog *p;
  ExprMap slots;   /* node -> slot + 1 */
  ExprMap circular; /* u -> 1 where sin u or cos u is needed anyway */
  int64_t denominator; /* a multiple of those of coefficients, which are written over it so that they count up evenly; 0: none: lower_grade */
  ExprMap often;   /* coefficients, as nodes -> how many terms have them */
  int direct;       /* sin(a - b) is computed as it stands: for series, it is cheaper than the addition theorem */
  Factored *factored; /* where the solution leaves its factors, and x[n + ndefs] itself; NULL: nowhere */
  Slot *x;
  int coarse;         /* accelerations and multipliers are for the eye: as in Solve, so that they stay finite where constraints become dependent */
  Slot *multipliers; /* of the constraints, once the solution is lowered */
} Lower;

Lower lower_new(const Eqns *e);

/* grade.c. Before anything is lowered: whether the coefficients of the roots are graded along a family, as masses m*(1 + i/N) are. */
void lower_grade(Lower *l, const Expr *roots, uint32_t n);

/* By what the parts of a coefficient (exact or not) are multiplied when it is lowered: 1 where it is not one of those. */
int64_t lower_grade_of(Lower *l, Num c);

/* Lowers all nodes that the roots need; then lower_slot gives each root's slot. */
void lower_roots(Lower *l, const Expr *roots, uint32_t n);
Slot lower_slot(const Lower *l, Expr e);

/* The same for expressions that may contain q'', z' and multipliers: the accelerations are computed first. */
void lower_with_accelerations(Lower *l, const Expr *roots, uint32_t n);

/* The program of a function that is called once a step, or a row of output. */
Prog *lower_seldom(const Lower *l);

/* Lowers M q'' = f and its solution; acc[n] receives the slots of q''. */
void lower_solution(Lower *l, Slot *acc);

/* The least change d[n] with A d = g for the first nrows constraints, and the forces A^T mu that make it. coarse: as in Solve. */
void lower_correction(Lower *l, uint32_t nrows, int coarse, const Slot *g, Slot *d, Slot *force);

/* The same by elimination without pivoting, for entries and forces that are lowered. */
void lower_elimination(Lower *l, Slot *acc);

/* The same for M = W^T C W: gram.c. */
void lower_gram(Lower *l, Slot *acc);

/* "M12", "f1": by the numbers of coordinates; the stem alone when there is one coordinate. */
Name lower_numbered(Lower *l, const char *stem, uint32_t i, uint32_t j);

/* x - a*b, with structural zeros skipped. */
Slot lower_minus_product(Lower *l, Slot x, Slot a, Slot b);

/* Fails when d is not positive, or zero, unless that is known now. */
void lower_pivot(Lower *l, Slot d, int positive);

#endif
