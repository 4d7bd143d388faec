/* Noether's theorem: what a transformation of coordinates and time makes of L, and the charge that it conserves.
 *
 * Enters: the generator of q_i -> q_i + s xi_i(q, t), t -> t + s tau(q, t). With D = d/dt along q',
 *   delta L = sum_i (dL/dq_i xi_i + dL/dq_i' (D xi_i - q_i' D tau)) + dL/dt tau + L D tau
 * is 0, or DF/dt of some F(q, t), or neither. Leaves: that verdict; the charge and its balance,
 *   Q = sum_i p_i xi_i - E tau - F,
 *   dQ/dt = sum_i Q_i (xi_i - q_i' tau) + lambda^T (A xi + b tau) + tau dL/dz z' + (delta L - DF).
 * Must hold: what is called proved is proved by sym/prove.h; F is differentiated before it is believed.
 * E. Noether, Nachr. Ges. Wiss. Goettingen (1918) 235, DOI 10.1080/00411457108231446 (translation); gauge terms: E. Bessel-Hagen,
 * Math. Ann. 84 (1921) 258, DOI 10.1007/BF01459410. */
#ifndef LAGC_NOETHER_H
#define LAGC_NOETHER_H

#include "mech/eqns.h"

typedef struct {
  const Expr *xi; /* [noether_coordinates] in q, t and parameters; 0: nothing */
  Expr tau;       /* 0: nothing */
  const Expr *eta; /* [noether_coordinates] the same of the sums of mech/noether_forms.h, for which the symbols of q stand, where these have names: proofs
                    * and charges are short then. NULL: not given */
  const Expr *lowered; /* [noether_coordinates] M xi, where M is made of numbers and p = M q', which keeps charges short; or NULL */
} Generator;

typedef enum {
  INVARIANT,
  INVARIANT_UP_TO_F,
  NOT_INVARIANT,
  INVARIANCE_NOT_DECIDED
} Invariance;

typedef struct {
  Invariance is;
  int by_value;      /* it holds on the constraints, which is not proved but seen at random states that obey them */
  Expr unreached;    /* or 0: nothing is decided, as no states were found where this factor of a constraint is 0 */
  Expr F;            /* 0 (the number) where none is needed; where L is not invariant, what takes off most of delta L */
  Expr over_time;    /* or 0: F has the integral of this over t besides, which has no closed form here. The charge is without it, and this a part of the power */
  Expr remainder;    /* delta L - DF, in a short form; over_time, or the number 0, where L is invariant */
  Expr charge;       /* in q, q', z, t */
  Expr scale;        /* sum |p_i xi_i| + |tau| (|p q'| + |L|) + |F|, which a drift of the charge is compared with */
  Expr power;        /* dQ/dt, in q, q', z, t, inputs and multipliers; the number 0: Q is conserved */
  Expr by_constraints; /* the part of the power that constraints have, lambda^T (A xi + b tau); the number 0: none */
  uint32_t broken; /* the first holonomic constraint, from 1, no contact, that the generator does not keep; 0: none */
  Expr breaks;     /* what it does to that one, A xi + c_t tau */
  int jumps;       /* what is said holds between jumps of L only: the charge jumps, too, or L is not invariant where it jumps */
  int by_formulas; /* the power holds while inputs follow their formulas */
  int power_unknown; /* L depends on an input whose rate of change is not known, and the generator moves time: power is not dQ/dt */
} Noether;

/* How many components a generator has: the coordinates, also those of a Lagrangian of first order; and their symbols. */
uint32_t noether_coordinates(const Eqns *e);
SymId noether_coordinate(const Eqns *e, uint32_t i);

/* Momenta of L as it was written: without the inertia that makes the mass matrix of rotations regular. */
const Expr *noether_momenta(const Eqns *e);

/* Whether it is a contact's: it holds while that is closed. */
int noether_is_contact(const Model *m, const Constraint *k);

/* Needs a Lagrangian. */
Noether noether_prove(const Eqns *e, const Generator *by);

/* Whether the places where L jumps do not stay where they are: then delta L has more there than derivatives of its branches say. */
int noether_moves_jumps(const Eqns *e, const Generator *by);

/* The energy as the charge of t -> t - s, F = 0: the charge is e->energy, the power that of forces, of moving constraints, and of what
 * depends on time. Whether it is conserved is e->conserves_energy. */
Noether noether_energy(const Eqns *e);

#endif
