/* Internals of mend_find, shared by mend.c, mend_local.c and mend_value.c only. */
#ifndef LAGC_CLAIMS_SUGGEST_IMPL_H
#define LAGC_CLAIMS_SUGGEST_IMPL_H

#include "claims/suggest_correction.h"
#include "claims/monomial.h"
#include "claims/edit_sites.h"
#include "mech/states.h"

enum { FEW = 4 }; /* states at which a guess is tried */

/* A site, and the equation as a function of the value there. */
typedef struct {
  const Site *site;
  const AstExpr *ast;
  Expr value;              /* as written */
  long double written[FEW]; /* its values at the first states */
  EvalTape *tape;          /* both sides with the stand-in at the site; NULL: it cannot stand there */
  int at;                  /* the state of the tape's last complete run, or -1 */
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
  long double *state[FEATURE_STATES]; /* FEW of them first, all of them for mend_guess_by_value */
  uint32_t nstates, tried;
  long double residual[FEATURE_STATES]; /* left minus right side, as written */
  Spot *spots;
  uint32_t nspots;
  VEC(Guess) guesses;
} Mender;

/* Adds a state that the solver accepts and at which the sides differ; 0: none is found. */
int mend_add_state(Mender *md);

/* Left minus right side at a state, with `value` at the site. */
long double mend_residual(Mender *md, Spot *p, uint32_t state, long double value);

/* Whether the equation holds at the first FEW states with these values at the site. */
int mend_holds(Mender *md, Spot *p, const long double *values);

/* Records a guess: expression `with` at the site of p, with its cost and text. */
void mend_guess(Mender *md, const Spot *p, Expr with, double cost, Span caret, const char *edit);

/* Small differences in cost where the same factor fits in several places: a product goes before a name in it, a term or numerator before the whole
 * side. */
double mend_product_cost(const Mender *md, const Spot *p);

/* Texts of an expression, and of a site as written. */
const char *mend_expr_text(const Mender *md, Expr e);
const char *mend_spot_text(const Mender *md, const Spot *p);

/* mend_local.c: edits of one place: signs, numbers, exponents, functions, names, superfluous terms and factors. */
void mend_guess_local(Mender *md);

/* mend_value.c: missing terms and factors, from the value that a place needs; and, when all else fails, the place whose correction depends on the
 * fewest quantities. */
void mend_guess_by_value(Mender *md);
Span mend_likeliest(Mender *md);

#endif
