/* Model -> Eqns: the equations of motion of one scene's model.
 *
 *   p_i = dL/dq_i'                    generalised momenta
 *   M_ij = dp_i/dq_j'                 mass matrix, symmetric, possibly indefinite
 *   f_i = dL/dq_i - (dp_i/dq) q' - (dp_i/dz) z' - dp_i/dt + Q_i
 *   M q'' = f                         solved numerically; M is never inverted symbolically
 *   Q_i = sum F dr/dq_i - dR/dq_i'    generalised forces: point forces, Rayleigh dissipation
 *
 * With constraints r = A q' + b = 0, where r = dc/dt of a holonomic one, c(q, t) = 0 (mech/constrain.h):
 *   M q'' = f + A^T lambda, A q'' = -(A' q' + b')
 * from L' = L + lambda c for holonomic constraints, from Lagrange-d'Alembert's principle for constraints on velocities.
 *
 * (dp/dq) q' + dp/dt is one forward directional derivative of p. Expressions contain q, q', z, t, parameters and
 * inputs; accelerations and rates occur in expects and outputs only. */
#pragma once

#include "model/model.h"

typedef struct {
  uint32_t row, col; /* col <= row */
  Expr e;
} MassEntry;

typedef VEC(MassEntry) Entries;

/* Sorts entries by row and column, sums those at one place in their order, applies `rule` (or NULL) to the sums, and
 * drops zeros. */
void entries_collect(ExprGraph *g, Entries *t, Expr (*rule)(ExprGraph *, Expr));

/* Element (i, j) of a symmetric matrix given by its lower triangle, row by row; the zero node where there is none. */
Expr entries_at(ExprGraph *g, const Entries *t, uint32_t i, uint32_t j);

/* M q'' = f as the program solves it. Variables 0 .. n-1 are the accelerations; variable n + k is the rate of
 * definition k, which contains velocities: C_k times the variables before it (mech/augmented_system.h). Without
 * definitions H = M. */
typedef struct {
  uint32_t n, ndefs;
  const Expr *defs;      /* [ndefs] */
  Entries H;             /* lower triangle, row by row */
  Entries C;             /* row n + k; col < n + k */
  const Expr *f;         /* [n] */
  const uint32_t *order; /* [n + ndefs] elimination order of the variables: mech/elimination_order.h */
  uint64_t ops;          /* operations of elimination and substitution, estimated */
} LinearSystem;

/* M = W^T C W with C = diag(weight): mech/kinetic_squares.h. */
typedef struct {
  uint32_t n;         /* number of forms; 0: M is factored from its entries */
  const Expr *weight; /* [n] */
  const Expr *W;      /* [n * coordinates], 0 where it is zero */
} SquareForms;

/* Constraints in three groups: holonomic; on velocities with r = dF/dt, so that F(q, t) keeps its value at the
 * start; other ones on velocities. */
typedef struct {
  uint32_t n, nholonomic, nkept; /* nkept: the first two groups together */
  const Constraint *const *of; /* [n] */
  const Expr *c;               /* [nkept] c, or F */
  const Expr *r;               /* [n] */
  const Expr *demand;          /* [n] right-hand side of A q'' = demand: -(A' q' + b') */
  Entries A;                   /* row by row, columns ascending */
} Constraints;

/* A Lagrangian that is linear in all velocities, L = theta(q, t) q' - H(q, t): mech/first_order.h. */
typedef struct {
  uint32_t n;            /* number of coordinates; 0: L is not of first order */
  const uint32_t *at;    /* [n] index of each coordinate in Model.states */
  const Expr *theta;     /* [n] momenta */
  Entries form;          /* row by row, columns ascending: the two-form omega, less dQ/dq' */
  const Expr *rhs;       /* [n] right-hand side of form q' = rhs: dH/dq + dtheta/dt - Q at q' = 0 */
  const Expr *rates;     /* [n] q' as solved; Eqns.flow has the forms that are shortest together */
  /* [Model.pairs] q' in q and p of a model that gives its Hamiltonian; the rate itself where forces on p contain
   * rates */
  const Expr *velocity;
  const uint32_t *block; /* [n] block number; the form couples coordinates of one block only */
  const Expr *divisors;  /* [ndivisors] divisors of the rates that may be 0 */
  uint32_t ndivisors;
  int closed;            /* the form is omega itself: no force contains velocities */
  int constant;          /* the form is free of coordinates, states and time */
} FirstOrder;

/* A switching function: mech/switches.h. SPEED: nowhere negative, as |v|, and not followed. */
typedef enum { SWITCH_SIDE, SWITCH_FLOOR, SWITCH_SPEED } SwitchKind;
typedef struct {
  Expr side;                  /* 0 on the surface; SWITCH_FLOOR: a whole number there */
  SwitchKind kind;
  int jumps;                  /* a force jumps there with the velocities or states: a motion may slide */
  Expr grip;                  /* a sliding motion ends where its mode is this large; 0: where it is 1 */
  Span span;                  /* of the expression in the text, or of its statement */
  const char *text, *surface; /* "sign(x')", "x'" */
} Switch;

typedef struct {
  const Switch *at;
  const ExprMap *by_text; /* nodes that follow the state: a branch of theirs has no value past the surface; or NULL */
  uint32_t n, nmodes; /* the first nmodes have a mode: an input behind those of the model */
} Switches;

/* An output `action(x)`: the curve H(q, p) = E whose closed integral of p dq a run computes. */
typedef struct {
  Name name;            /* x */
  Expr roots[4];        /* H, dH/dp, d2H/dp2, dH/dq; of a model that gives L with momenta in the place of velocities */
  uint32_t coordinate, momentum; /* components of [q|v|z] */
  int periodic;
} ActionCurve;

/* Whether the symbol is a state, none of the coordinates of first order; states: Model.states.at. For expr_contains. */
int is_no_coordinate(const Symbol *s, const void *states);

typedef struct Charge Charge; /* symmetry/charges.h */
struct BracketValue; /* phase_space/expression_brackets.h */

typedef struct {
  const Model *m;
  ExprGraph *g;
  Expr lagrangian;       /* that of the model, in a form without t where t drops out; 0: none */
  FirstOrder first;
  uint32_t n;            /* number of coordinates with accelerations */
  const Expr *p;         /* [n] momenta, as differentiated */
  const Expr *dLdq;      /* [n] as differentiated */
  const Expr *momenta;   /* [n] momenta in short forms, to show */
  Entries mass;          /* nonzero entries of M's lower triangle, row by row */
  int mass_known;        /* 0: M has too many entries, and the system below does not need them; see eqns_derive_mass */
  const Expr *f;         /* [n] with A^T lambda, in the symbols of the multipliers */
  LinearSystem system;   /* the cheapest form of M q'' = f found; without multipliers */
  SquareForms squares;   /* factors of an M that is nearly singular somewhere */
  Constraints constraints;
  /* [n] generalised forces, already in f; first order: [first.n], with rates, already in rhs and form */
  const Expr *Q;
  const Expr *flow;      /* [number of states] z', free of rates */
  Expr energy;           /* p q' - L, and the potential below, to show; 0 without coordinates */
  Expr potential;        /* of all forces, where the energy is conserved with it; 0: none (symmetry/charges.c) */
  Expr energy_stable;    /* the energy in a form with small rounding, to compute */
  Expr energy_scale;     /* |p q'| + |L|: scale for drifts of the energy */
  const Charge *charges; /* [ncharges] the energy, then the charges of the symmetries in order; none without L */
  uint32_t ncharges;
  const struct BracketValue *brackets; /* [nbrackets] of Model.brackets */
  uint32_t nbrackets;
  Switches switches;     /* none before switches_find */
  const Expr *outputs;   /* [noutputs] values of the scene's outputs, with the energy and charges filled in */
  uint32_t noutputs;
  /* [nactions] that outputs contain: inputs numbered behind those of the model and closed forms */
  const ActionCurve *actions;
  uint32_t nactions;
  const Expr *definitions; /* by symbol: expressions substituted for parameters that others define; or NULL */
  /* definite_mass, or definite for parameters with the signs of their values; a run checks the pivots */
  int definite_by_values;
  VEC(ModelSize) sizes;  /* of the model, and inertias of parameters alone, each once: what a run checks at its start */
  int constant_mass, definite_mass, singular_mass, autonomous, smooth;
  int conserves_energy;  /* dE/dt = 0 is proved along all motions, for any inputs: charges[0] */
  /* the energy is discontinuous somewhere, as L is; the facts about it hold between such places */
  int energy_jumps;
  /* not proved to be conserved; less the work of forces that are constant or have a potential, the energy cannot
   * rise while inputs stay; derive_equations.c leaves the forces to charges.c */
  int loses_energy;
  int timeless;          /* t occurs in the formulas of inputs only */
  /* constant mass, no velocity in f, no states, or H = T(p) + V(q, t): a splitting method can integrate it */
  int separable;
  int sum_hamiltonian;   /* H = T(p) + V(q, t) is given, whatever the forces */
} Eqns;

/* Coordinates, those of a Lagrangian of first order included: how many, and their symbols. */
uint32_t eqns_coordinates(const Eqns *e);
SymId eqns_coordinate(const Eqns *e, uint32_t i);

/* The symbols of all coordinates, or of their velocities (rates). */
SymId *eqns_symbols(const Eqns *e, int velocities);

/* Momenta of L as the user wrote it: without the term that makes the mass matrix of rotations regular. */
const Expr *eqns_momenta(const Eqns *e);

/* Whether a generalised force stands outside L, or H. */
int eqns_has_forces(const Eqns *e);

/* M[i][j]; the zero node where the entry is zero. */
Expr eqns_mass(const Eqns *e, uint32_t i, uint32_t j);

/* x at q' = 0, simplified. */
Expr eqns_at_rest(const Eqns *e, Expr x);

/* Value of e->potential, and a bound of its rounding, where symbols have these values. */
long double eqns_potential_at(const Eqns *e, const long double *symbols, long double *bound);
