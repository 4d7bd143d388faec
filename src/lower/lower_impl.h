/* Shared by the files that lower Eqns: lower*.c (expressions, one program each), linear_solve.c, eliminate.c,
 * gram_schmidt.c (the linear system). */
#pragma once

#include "ir/factorization_record.h"
#include "ir/passes.h"
#include "lower/lower.h"

typedef struct {
  const Eqns *e;
  ExprGraph *g;
  Prog *p;
  ExprMap slots;   /* node -> slot + 1 */
  ExprMap circular; /* u -> 1 where sin u or cos u occurs among the roots */
  int by_text;      /* switches follow the state, as the text says, never a held mode: events, actions, closed forms */
  int by_slips;     /* so do those on whose surface no motion slides: the releases of contacts */
  int direct;       /* no addition theorem for sin(a - b): a series of its own is cheaper */
  /* receives the factors of the linear system, and x its solution [n + ndefs]; NULL: not recorded */
  FactorRecord *factored;
  Slot *x;
  int coarse;         /* as in Solve: for outputs, which shall stay finite where constraints become dependent */
  Slot *multipliers; /* [number of constraints], set by lower_solution */
  VEC(Expr) values;  /* outputs that lower_output has named */
  VEC(Name) names;
} Lower;

static inline Slot op(Lower *l, IrOp o, Slot a, Slot b) { return prog_op(l->p, o, a, b); }

Lower lower_new(const Eqns *e);
Lower lower_by_text(const Eqns *e);

/* Output array of a state that an event or the start sets; the store of its value, which is lowered. */
uint32_t lower_array_of_target(SymKind k);
void lower_store_target(Lower *l, SymId target, Expr value);

/* Lowers the roots and all nodes below them; lower_slot then gives their slots. */
void lower_roots(Lower *l, const Expr *roots, uint32_t n);
Slot lower_slot(const Lower *l, Expr e);

/* nest_halves.c: the sums of a nest over all pairs of a square with j below i alone, each turn of which adds to the
 * sums of both; NULL: the two have little in common, or it has another form. */
const SumNest *nest_half(ExprGraph *g, Expr nest);

/* lower_nest.c: the cells of a nest that occur in the list and have no slot yet. */
void lower_nest(Lower *l, Expr nest, const ExprList *list);

/* The element of an array that holds the value of a symbol. */
Slot lower_load(Lower *l, IrArray array, const Symbol *s);

/* held_branch.c: a switching node on the branch that a run holds; NOT_A_SLOT: it has no mode. */
Slot lower_held_branch(Lower *l, Expr e);

/* lower_roots for expressions that may contain q'', z' and multipliers, which are computed first. */
void lower_with_accelerations(Lower *l, const Expr *roots, uint32_t n);

/* The next output of a program, and its name in comments. */
void lower_output(Lower *l, Expr value, Name name);

/* Stores these outputs, which are lowered. */
void lower_store_outputs(Lower *l, uint32_t array);

/* Lowers these outputs, which may contain q'', z' and multipliers, and stores them as output 0; the program is called
 * as in lower_finish_seldom. */
Prog *lower_outputs_seldom(Lower *l);

/* The program after its passes; the memory of the lowering is given up. */
Prog *lower_finish(const Lower *l, const PassPlan *plan, StrBuf *trace);

/* The finished program of a function that is called once a step, or once a row of output. */
Prog *lower_finish_seldom(const Lower *l);

/* Lowers M q'' = f and its solution; acc[n] receives the slots of q''. */
void lower_solution(Lower *l, Slot *acc);

/* The change d[n] with A d = g for the first nrows constraints that is least in the metric M, and force = A^T mu = M
 * d, or NULL. coarse: as in Solve; factor[nrows]: of rows of A, 0: 1; or NULL. */
void lower_correction(Lower *l, uint32_t nrows, int coarse, const Slot *g, const Slot *factor, Slot *d, Slot *force);

/* The solution w[n] of M w - A^T l = x, A w = 0 for the first nrows constraints, and l[nrows]; coarse: as in Solve. */
void lower_held_weights(Lower *l, uint32_t nrows, int coarse, const Slot *x, Slot *w, Slot *multipliers);

/* eliminate.c: q'' by elimination without pivoting; entries of H and C and forces must be lowered. */
void lower_elimination(Lower *l, Slot *acc);

/* gram_schmidt.c: q'' where M = W^T C W; weights, W and forces must be lowered. */
void lower_gram_schmidt(Lower *l, Slot *acc);

/* Names s "M12", "f1" by numbers of coordinates, from 1 (j UINT32_MAX: i alone); the stem alone when there is one
 * coordinate. */
void lower_name(Lower *l, Slot s, const char *stem, uint32_t i, uint32_t j);

/* Check that d is positive, or (positive 0) not zero; none where d is a number that passes. */
void lower_pivot(Lower *l, Slot d, int positive);
/* band_order.c: renumbers place[] within the blocks of M that begin with the coordinates first[blocks], where their
 * band becomes half as wide. */
void lower_band_order(Lower *l, const uint32_t *first, uint32_t blocks, uint32_t *place);
