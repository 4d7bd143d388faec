/* Contents of `lagc noether`: symmetries, charges, their algebra, and the symmetries that effects break. */
#pragma once

#include "symmetry/involution.h"
#include "symmetry/poisson_brackets.h"
#include "symmetry/polynomial_charges.h"
#include "sym/print.h"

typedef VEC(uint32_t) Indices;

/* Verdicts on the model's symmetries once an effect is on. */
typedef struct {
  Name effect;
  const Eqns *e;       /* the model with that effect, and what it requires */
  const Noether *is;   /* [found.all.n]; charge 0: the model with the effect lacks a name of the generator */
} EffectVerdict;

typedef struct {
  Eqns *e;
  FoundSymmetries found;
  Algebra algebra;
  int scales;          /* there is a scaling */
  Scaling scaling;
  Indices cyclic;      /* coordinates that L does not contain */
  const PolynomialCharges *polynomial; /* of degree 2 and more in the momenta; NULL: not asked for */
  const Involution *involution;        /* NULL: not asked for */
  VEC(EffectVerdict) effects;
} NoetherReport;

/* Finds symmetries, brackets, scaling and cyclic coordinates. Needs a Lagrangian. */
NoetherReport *noether_report(Eqns *e, SearchLimit *limit);

/* Name of the declared symmetry with the charge of found symmetry k, or its opposite; NULL: there is none. */
Name noether_declared(const NoetherReport *r, uint32_t k);

/* Adds the verdicts on the model `with` one more effect. */
void noether_report_effect(NoetherReport *r, Name effect, const Eqns *with);

/* Constants of unknown sign that must be positive for the roots in found symmetry k to have values. */
typedef VEC(Expr) Conditions;
Conditions noether_conditions(const NoetherReport *r, uint32_t k);

/* Whether no state shows that found symmetry k has another charge with the effect on; symbols are matched by name. */
int noether_same_charge(const NoetherReport *r, const EffectVerdict *v, uint32_t k);

/* Appends "cyclic coordinate: x; L does not contain it, and p_x is conserved" for each one, after `before`. */
void show_cyclic(const Eqns *e, const char *before, StrBuf *out);

/* The report as text or LaTeX, and as one JSON object in which formulas are text. */
void show_noether(const NoetherReport *r, PrintStyle style, StrBuf *out);
void show_noether_json(const NoetherReport *r, StrBuf *out);
