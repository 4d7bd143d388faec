/* What `lagc noether` says of a model: symmetries, charges, their algebra, and what effects break. */
#ifndef LAGC_NOETHER_REPORT_H
#define LAGC_NOETHER_REPORT_H

#include "mech/brackets.h"
#include "sym/print.h"

typedef VEC(uint32_t) Indices;

/* What a symmetry of the model becomes once an effect is on. */
typedef struct {
  Name effect;
  const Eqns *e;       /* of the model with that effect, and what it requires */
  const Noether *is;   /* [found.all.n]; charge 0: the model with the effect lacks a name of the generator */
} EffectVerdict;

typedef struct {
  Eqns *e;
  FoundSymmetries found;
  Algebra algebra;
  int scales;          /* the next one holds */
  Scaling scaling;
  Indices cyclic;      /* coordinates that L does not contain */
  VEC(EffectVerdict) effects;
} NoetherReport;

/* Needs a Lagrangian. */
NoetherReport *noether_report(Eqns *e);

/* The symmetry of the model's text with the same charge as found symmetry k, or its opposite; NULL: none is declared. */
Name noether_declared(const NoetherReport *r, uint32_t k);

/* Adds a verdict on the model with one more effect. */
void noether_report_effect(NoetherReport *r, Name effect, const Eqns *with);

/* What must be positive for the roots in found symmetry k to have values: constants whose signs the model does not tell. */
typedef VEC(Expr) Conditions;
Conditions noether_conditions(const NoetherReport *r, uint32_t k);

/* Whether found symmetry k has the same charge with the effect on: at random states, whose symbols are known by their names. */
int noether_same_charge(const NoetherReport *r, const EffectVerdict *v, uint32_t k);

/* Coordinates that L does not contain. */
Indices noether_cyclic(const Eqns *e);

/* Appends "cyclic coordinate: x; L does not contain it, and p_x is conserved", if there is one. */
void show_cyclic(const Eqns *e, StrBuf *out);

/* The report as text or LaTeX, and as one JSON object in which formulas are text. */
void show_noether(const NoetherReport *r, PrintStyle style, StrBuf *out);
void show_noether_json(const NoetherReport *r, StrBuf *out);

#endif
