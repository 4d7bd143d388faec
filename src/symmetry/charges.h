/* The charges of a model: its energy and those of its declared symmetries, each with its balance. */
#pragma once

#include "symmetry/noether_theorem.h"

struct Charge {
  const Symmetry *of; /* NULL: the energy, the charge of translations of time */
  Name name;
  Unit unit;
  Noether proof;
  Expr value, scale; /* in the form that programs compute */
};

/* Model -> Eqns, complete: the equations of motion, their charges, and outputs that name the energy or a charge.
 * NULL, with the reason in the model's diagnostics, as eqns_derive, or when a declared symmetry does not hold. */
Eqns *equations_of(const Model *m);

/* The complete equations of the same model with a regular mass matrix (eqns_derive_regularised). */
Eqns *equations_regularised(const Eqns *singular);

/* "energy is conserved", "energy changes: dE/dt = ..." or "not decided whether the energy is conserved: ...". */
const char *charges_energy_text(const Eqns *e);
/* The word of a verdict on dQ/dt: conserved, changes, not decided. */
const char *charges_drift_word(Verdict drift);
/* The word for the energy; "" where there is none. */
const char *charges_energy_word(const Eqns *e);

/* x with the symbols of declared charges and of brackets replaced by their expressions. */
Expr charges_substitute(const Eqns *e, Expr x);

/* Whether the symmetries declared in `effect` (NULL: outside effects) hold. Others are reported in the model's
 * diagnostics, with the remainder of delta L and, where one map has the wrong sign, that map. e: the model without
 * effects, or with that effect and what it requires. */
int charges_judge(const Eqns *e, Name effect);

/* Appends a line for each symmetry of `effect` to what `lagc check` prints. */
void charges_print(const Eqns *e, Name effect, StrBuf *out);

/* Appends a line for each charge, of the energy too, that is not conserved with the effects and inputs of the scene. */
void charges_show_broken(const Eqns *e, StrBuf *out);
