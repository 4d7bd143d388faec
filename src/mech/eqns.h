/* Model -> Eqns: the equations of motion of one scene's model.
 *
 *   p_i = dL/dq_i'                    generalised momenta
 *   M_ij = dp_i/dq_j'                 mass matrix, symmetric, possibly indefinite
 *   f_i = dL/dq_i - (dp_i/dq) q' - (dp_i/dz) z' - dp_i/dt + Q_i
 *   M q'' = f                         solved numerically, never inverted symbolically
 *   Q_i = sum F dr/dq_i - dR/dq_i'    generalised forces: point forces, Rayleigh dissipation
 *
 * With constraints r = A q' + b = 0, where r = dc/dt of a holonomic one, c(q, t) = 0 (mech/constrain.h):
 *   M q'' = f + A^T lambda, A q'' = -(A' q' + b')
 * that is L' = L + lambda c, and Lagrange-d'Alembert's principle for those on velocities.
 *
 * (dp/dq) q' + dp/dt is one forward directional derivative of p. Every expression here is in q, q',
 * z, t, parameters and inputs; accelerations and rates occur in expects and outputs only. */
#ifndef LAGC_EQNS_H
#define LAGC_EQNS_H

#include "model/model.h"

typedef struct {
  uint32_t row, col; /* col <= row */
  Expr e;
} MassEntry;

typedef VEC(MassEntry) Entries;

/* M q'' = f as the program solves it. Variables 0 .. n-1 are the accelerations; n + k is the rate of
 * a definition that contains velocities, which is C_k times the variables before it (mech/lift.h).
 * Without definitions H is M. */
typedef struct {
  uint32_t n, ndefs;
  const Expr *defs;      /* [ndefs] */
  Entries H;             /* lower triangle, row by row */
  Entries C;             /* row n + k; col < n + k */
  const Expr *f;         /* [n] */
  const uint32_t *order; /* [n + ndefs] in which variables are eliminated: see mech/order.h */
  uint64_t ops;          /* of elimination and substitution, about */
} LinearSystem;

/* M = W^T C W with C = diag(weight): mech/squares.h. */
typedef struct {
  uint32_t n;         /* forms; 0: M is solved by its entries */
  const Expr *weight; /* [n] */
  const Expr *W;      /* [n * coordinates], 0 where it is zero */
} SquareForms;

/* Constraints: the holonomic ones first; then those on velocities that are the rate of a function of positions, r = dF/dt, and so keep F
 * as it is at the start; then the others. */
typedef struct {
  uint32_t n, nholonomic, nkept; /* nkept: the first two kinds together */
  const Constraint *const *of; /* [n] */
  const Expr *c;               /* [nkept] c, or F */
  const Expr *r;               /* [n] */
  const Expr *demand;          /* [n] what A q'' must be */
  Entries A;                   /* row by row, columns ascending */
} Constraints;

/* Of a Lagrangian that is linear in all velocities, L = theta(q, t) q' - H(q, t): see mech/first_order.h. */
typedef struct {
  uint32_t n;            /* number of coordinates; 0: L is not of first order */
  const uint32_t *at;    /* [n] their states */
  const Expr *theta;     /* [n] momenta */
  Entries form;          /* row by row, columns ascending: the two-form omega, less dQ/dq' */
  const Expr *rhs;       /* [n] what it makes of the velocities: dH/dq + dtheta/dt - Q */
  const Expr *rates;     /* [n] what they are, each for itself; together they may be shorter: Eqns.flow */
  const uint32_t *block; /* [n] coordinates of one number are coupled by the form, those of two are not */
  const Expr *divisors;  /* [ndivisors] what rates are divided by, and may be 0 */
  uint32_t ndivisors;
  int closed;            /* the form is omega itself: no force contains velocities */
  int constant;          /* it is free of coordinates, states and time */
} FirstOrder;

typedef struct Charge Charge; /* mech/charges.h */

typedef struct {
  const Model *m;
  ExprGraph *g;
  FirstOrder first;
  uint32_t n;            /* number of coordinates with accelerations */
  Expr summed;           /* L with long sums of velocities as definitions: what is differentiated (mech/sums.h) */
  const Expr *p;         /* [n] momenta, as differentiated */
  const Expr *dLdq;      /* [n] as differentiated */
  const Expr *momenta;   /* [n] the same, as a person would write them */
  Entries mass;          /* the entries of the lower triangle that are not zero, row by row */
  int mass_known;        /* 0: too many, and the system below does without; see eqns_derive_mass */
  const Expr *f;         /* [n]; with A^T lambda, made of the symbols of multipliers */
  LinearSystem system;   /* the cheapest form of M q'' = f found; without multipliers */
  SquareForms squares;   /* where M is almost singular somewhere */
  Constraints constraints;
  const Expr *Q;         /* [n], of first order [first.n], with rates: generalised forces, inside f, or rhs and form, already */
  const Expr *flow;      /* [number of states]; free of rates */
  Expr energy;           /* p q' - L, to show; 0 without coordinates */
  Expr energy_stable;    /* the same, to compute */
  Expr energy_scale;     /* |p q'| + |L|: what a drift of the energy is compared with */
  const Charge *charges; /* [ncharges] the energy, then those of the symmetries in order; none without L */
  uint32_t ncharges;
  const Output *outputs; /* of the scene, with the energy and charges filled in */
  uint32_t noutputs;
  const Expr *definitions; /* by symbol: what stands for parameters given by others, where that was put in; or NULL */
  int definite_by_values; /* definite_mass, or it would be if parameters declared the signs of their values: pivots tell */
  int constant_mass, definite_mass, singular_mass, conserves_energy, autonomous, smooth;
  int energy_jumps;      /* as L does, somewhere: what is said of it holds between such places */
  int loses_energy;      /* not conserved; but no force beside L can raise it, less the work of those that are constant */
  int timeless;          /* t enters by the formulas of inputs, if at all */
  int separable;         /* constant mass, no velocity in f, no states: a splitting method can integrate it */
} Eqns;

/* Derives the equations. NULL, with the reason in m->diags, when the mass matrix is singular for
 * every state, or when the momenta depend on an input (its derivative would be needed). */
Eqns *eqns_derive(Model *m);

/* A partial derivative of residual `row` by component `col` of y = (q, q', z). */
typedef struct {
  uint32_t row, col;
  Expr e;
} Partial;

typedef struct {
  const Partial *at;
  uint32_t n;
} Partials;

/* The linearisation, exact: those that are not zero of the derivatives of the residuals
 *   r_i = f_i - sum_j M_ij q_j''   (i < n),   r_(n + k) = flow_k
 * at fixed q'', row by row, columns ascending. With M they give the Jacobian of the accelerations,
 * dq''/dy = M^-1 dr/dy. They contain the symbols q''. */
Partials eqns_linearise(Eqns *e);

/* What an event does to small changes of the state: derivatives of its function (row < 0: of g) and of the values that its actions give
 * (row: the component of [q|v|z] that they are given to), by components of the state, and by the time (col 2 n + states).
 * Of g those that are not zero; of a value, those, and that by its own component, so that each row that is set is there.
 * An event that depends on an input has none: what the input is, is for the runtime to say. */
typedef struct {
  uint32_t event;
  int row;
  uint32_t col;
  Expr e;
} Jump;

typedef struct {
  const Jump *at;
  uint32_t n;
} Jumps;

Jumps eqns_jumps(const Eqns *e);

/* Fills e->mass where the program does without. */
void eqns_derive_mass(Eqns *e);

/* M[i][j]; the zero node where the entry is zero. */
Expr eqns_mass(const Eqns *e, uint32_t i, uint32_t j);

#endif
