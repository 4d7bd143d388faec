/* Noether's theorem: the change of L under a transformation of coordinates and time, and the charge that it conserves.
 *
 * Enters: the generator of q_i -> q_i + s xi_i(q, t), t -> t + s tau(q, t). With D = d/dt along q',
 *   delta L = sum_i (dL/dq_i xi_i + dL/dq_i' (D xi_i - q_i' D tau)) + dL/dt tau + L D tau
 * is 0, or DF/dt of some F(q, t), or neither. Leaves: that verdict; the charge and its balance,
 *   Q = sum_i p_i xi_i - E tau - F,
 *   dQ/dt = sum_i Q_i (xi_i - q_i' tau) + lambda^T (A xi + b tau) + tau dL/dz z' + (delta L - DF).
 * Must hold: a verdict rests on a proof of sym/prove.h or, where by_value says so, on random states; F is checked by
 * differentiation. E. Noether, Nachr. Ges. Wiss. Goettingen (1918) 235, DOI 10.1080/00411457108231446 (translation);
 * gauge terms: E. Bessel-Hagen, Math. Ann. 84 (1921) 258, DOI 10.1007/BF01459410. */
#pragma once

#include "mech/eqns.h"
#include "sym/verdict.h"

typedef struct {
  const Expr *xi; /* [eqns_coordinates] in q, t and parameters; 0: nothing */
  Expr tau;       /* 0: t stays */
} Generator;

typedef enum {
  INVARIANT,
  INVARIANT_UP_TO_F,
  NOT_INVARIANT,
  INVARIANCE_NOT_DECIDED
} Invariance;

typedef struct {
  Invariance is;
  int by_value;      /* zero on the constraints is seen at random states that obey them, and not proved */
  /* or NULL: a constraint that is a product; random states may miss the zeros of a factor, and nothing is decided */
  const Constraint *product;
  /* gauge function; the number 0 where none is needed; where L is not invariant, an F that shortens the remainder */
  Expr F;
  /* or 0: delta L - DF where it depends on t alone; F then needs its integral, which is not formed: the charge omits
   * it, the power contains this term */
  Expr over_time;
  Expr remainder;    /* delta L - DF, in a short form; where L is invariant: over_time, or the number 0 */
  Expr charge;       /* in q, q', z, t */
  Expr scale;        /* sum |p_i xi_i| + |tau| (|p q'| + |L|) + |F|, the measure for a drift of the charge */
  Expr power;        /* dQ/dt, in q, q', z, t, inputs and multipliers; the number 0: Q is conserved */
  /* the one judgement of conservation. PROVED_ZERO: power is 0 along motions; PROVED_NONZERO: not at a state */
  Verdict drift;
  Expr potential;    /* of all forces and of explicit time, where it completes the energy: Q contains it; 0: none */
  /* drift is not decided, as forces have a potential: 2: whose integral is not found, 1: near each position; 3: that
   * is not looked for */
  int open_integral;
  Expr by_constraints; /* power of the constraint forces, lambda^T (A xi + b tau); the number 0: none */
  /* first holonomic constraint, counted from 1 and no contact, that the generator does not preserve; 0: none */
  uint32_t broken;
  Expr breaks;     /* change of that constraint, A xi + c_t tau */
  /* the verdict holds between jumps of L only: the charge jumps, too, or L is not invariant where it jumps */
  int jumps;
  int by_formulas; /* the power holds only while inputs follow their formulas */
  int power_unknown; /* the generator moves t, and L contains an input of unknown rate: power is not dQ/dt */
} Noether;

/* Whether along the direction seed[symbols], by symbol, each turn of a quantified sum moves as the one in whose symbols
 * its body is written: that body then tells the change of the sum. */
int turns_move_alike(const Eqns *e, Expr nest, const Expr *seed, uint32_t symbols);

/* Verdict, charge and balance of a generator. Needs a Lagrangian. */
Noether noether_prove(const Eqns *e, const Generator *by);

/* Whether the generator moves the surfaces where L jumps: delta L then has contributions that derivatives of its
 * branches miss. */
int noether_moves_jumps(const Eqns *e, const Generator *by);

/* The energy as the charge of t -> t - s, F = 0: p q' - L, and the potential of the forces if they have one; its
 * power is that of forces, moving constraints and explicit time. */
Noether noether_energy(const Eqns *e);

/* Whether the forces outside L, less the dissipation, are constant, do no work, or have a potential. */
int noether_forces_are_potential(const Eqns *e);
