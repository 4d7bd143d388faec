/* Poisson brackets {f, g} = sum df/dq dg/dp - df/dp dg/dq of two expressions, at a fixed time.
 *
 * Where the model gives its Lagrangian, q' = dH/dp(q, p) is put into f and g first: the mass matrix needs an inverse
 * in closed form (mech/hamilton.h). A bracket may stand in a bracket. */
#pragma once

#include "mech/eqns.h"

struct BracketValue {
  Expr value; /* in q, q', t, as the equations have them */
  Expr shown; /* in q, p, t */
  Expr domain; /* where f and g have derivatives, in the symbols of value; 0: everywhere */
  int jumps;   /* they jump, or have corners */
};

/* Values of the n names that stand for charges. */
typedef struct {
  const SymId *sym;
  const Expr *value;
  uint32_t n;
} ChargeNames;

/* Coordinates and momenta, as symbols, and velocities as functions of them. */
typedef struct {
  Eqns *e;
  uint32_t n;
  const SymId *q, *p; /* [n] */
  const SymId *v;     /* [n] of a model that gives L */
  const Expr *rate;   /* [n] q' in q, p; NULL: the model gives H */
  Expr H;             /* in q, p, t */
} PhaseSpace;

/* NULL, or the reason where momenta have no closed form in velocities, or velocities in momenta. */
const char *phase_space_try(Eqns *e, PhaseSpace *s);

/* The same; 0, with the reason reported at `span`. */
int phase_space_of(Eqns *e, Span span, PhaseSpace *s);

/* x in q, p, t: velocities, the energy and brackets replaced. */
Expr phase_space_expression(const PhaseSpace *s, Expr x);

/* {f, g} of expressions in n pairs q, p, simplified. */
Expr poisson_bracket(ExprGraph *g, Expr f, Expr h, const SymId *q, const SymId *p, uint32_t n);

/* Fills e->brackets, in the order of Model.brackets. 0, reported, where there is no closed form. */
int expression_brackets_derive(Eqns *e, const ChargeNames *charges);

/* Where what the brackets in x contain has derivatives; 0: everywhere. *jumps: 1 is set where they
 * hold between jumps. */
Expr expression_brackets_domain(const Eqns *e, Expr x, int *jumps);

/* x with the symbols of brackets replaced by their values, or, in_momenta, by their forms in q and p. */
Expr expression_brackets_substitute(const Eqns *e, Expr x, int in_momenta);
