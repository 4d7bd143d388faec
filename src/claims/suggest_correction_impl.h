/* Internals of suggest_correction, shared by suggest_correction.c, local_edits.c and edits_by_value.c only. */
#ifndef LAGC_CLAIMS_SUGGEST_IMPL_H
#define LAGC_CLAIMS_SUGGEST_IMPL_H

#include "claims/suggest_correction.h"
#include "claims/monomial_fit.h"
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
  long double *state[FEATURE_STATES]; /* FEW of them first, all of them for guess_edits_by_value */
  uint32_t nstates, tried;
  long double residual[FEATURE_STATES]; /* left minus right side, as written */
  Spot *spots;
  uint32_t nspots;
  VEC(Guess) guesses;
} EditSearch;

/* Adds a state that the solver accepts and at which the sides differ; 0: none is found. */
int edit_add_state(EditSearch *md);

/* Left minus right side at a state, with `value` at the site. */
long double edit_residual(EditSearch *md, Spot *p, uint32_t state, long double value);

/* Whether the equation holds at the first FEW states with these values at the site. */
int edit_holds(EditSearch *md, Spot *p, const long double *values);

/* Records a guess: expression `with` at the site of p, with its cost and text. */
void edit_guess(EditSearch *md, const Spot *p, Expr with, double cost, Span caret, const char *edit);

/* Small differences in cost where the same factor fits in several places: a product goes before a name in it, a term or numerator before the whole
 * side. */
double edit_product_cost(const EditSearch *md, const Spot *p);

/* Texts of an expression, and of a site as written. */
const char *edit_expr_text(const EditSearch *md, Expr e);
const char *edit_spot_text(const EditSearch *md, const Spot *p);

/* local_edits.c: edits of one place: signs, numbers, exponents, functions, names, superfluous terms and factors. */
void guess_local_edits(EditSearch *md);

/* edits_by_value.c: missing terms and factors, from the value that a place needs; and, when all else fails, the place whose correction depends on the
 * fewest quantities. */
void guess_edits_by_value(EditSearch *md);
Span likeliest_place(EditSearch *md);

#endif
