/* The charges of a model: its energy, and what its declared symmetries conserve; each with its balance. */
#ifndef LAGC_CHARGES_H
#define LAGC_CHARGES_H

#include "mech/noether.h"
#include "sym/print.h"

struct Charge {
  const Symmetry *of; /* NULL: the energy, of translations of time */
  Name name;
  Unit unit;
  Noether proof;
  Expr value, scale; /* as they are computed */
};

/* Fills e->charges: the energy first, then the symmetries in order. Nothing where there is no Lagrangian. */
void charges_derive(Eqns *e);

/* x with the symbols of charges of symmetries replaced by what they are. */
Expr charges_fill(const Eqns *e, Expr x);

/* Whether the symmetries that stand in `effect` (NULL: in none) hold; those that do not are reported in the model's diagnostics, with
 * what they leave of delta L and, where the sign of one map is wrong, that. To be called for the model without effects, or with that
 * effect and what it requires. */
int charges_judge(const Eqns *e, Name effect);

/* Appends a line for each symmetry of `effect` to what `lagc check` prints. */
void charges_print(const Eqns *e, Name effect, StrBuf *out);

/* Appends a line for each charge, of the energy too, that is not conserved with the effects and inputs of the scene. */
void charges_show_broken(const Eqns *e, StrBuf *out);

#endif
