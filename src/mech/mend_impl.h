/* The inside of mend_find, shared by mend.c, mend_local.c and mend_value.c only. */
#ifndef LAGC_MEND_IMPL_H
#define LAGC_MEND_IMPL_H

#include "mech/mend.h"
#include "mech/monomial.h"
#include "mech/sites.h"
#include "mech/states.h"

enum { FEW = 4 }; /* states at which a guess is tried */

/* A site, and the equation as a function of what stands there. */
typedef struct {
  const Site *site;
  const AstExpr *ast;
  Expr value;              /* as written */
  long double written[FEW]; /* its values */
  EvalTape *tape;          /* both sides with the stand-in; NULL when it cannot stand there */
  int at;                  /* the state of the last whole run of the tape, or -1 */
} Spot;

typedef struct {
  const Spot *spot;
  Expr with;
  long double cost; /* simple and likely edits are cheap */
  Span caret;
  const char *edit;
} Guess;

typedef struct {
  const Eqns *e;
  const Model *m;
  const Expect *x;
  ExprGraph *g;
  Arena *arena;
  StateSolver *solver;
  SymId stand_in;
  long double *state[FEATURE_STATES]; /* FEW of them until mend_more_states */
  uint32_t nstates, tried;
  long double residual[FEATURE_STATES]; /* of the equation as written */
  Spot *spots;
  uint32_t nspots;
  VEC(Guess) guesses;
} Mender;

/* One more state of those that the solver accepts; 0 when none is found. */
int mend_add_state(Mender *md);

/* Left side minus right side at a state, with `value` at the place. */
long double mend_residual(Mender *md, Spot *p, uint32_t state, long double value);

/* Whether the equation holds at the first states with these values at the place. */
int mend_holds(Mender *md, Spot *p, const long double *values);

void mend_guess(Mender *md, const Spot *p, Expr with, double cost, Span caret, const char *edit);

/* Where the same factor could be put in several places: small differences that choose a product over
 * a name in it, and a term or numerator over the whole side. */
double mend_product_cost(const Mender *md, const Spot *p);

const char *mend_expr_text(const Mender *md, Expr e);
const char *mend_spot_text(const Mender *md, const Spot *p);

/* mend_local.c: edits that change what is written at one place: signs, numbers, exponents,
 * functions, names, superfluous terms and factors. */
void mend_guess_local(Mender *md);

/* mend_value.c: edits found from the value that a place needs: missing terms and factors; and,
 * when all else fails, the place whose need depends on the fewest quantities. */
void mend_guess_by_value(Mender *md);
Span mend_likeliest(Mender *md);

#endif
