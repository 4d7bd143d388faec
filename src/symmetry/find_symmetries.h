/* The search for point symmetries of L: generators affine in q, with coefficients that are functions of time, and gauge functions that are
 * polynomials of q. Lie's method, restricted to that ansatz and done in numbers (P. J. Olver, Applications of Lie Groups to Differential
 * Equations, 2nd ed. (1993), 2.4 and 5.2): random states give linear equations, the space of their solutions is brought to echelon form at two
 * choices of parameters, its entries are recognised as rationals times powers of parameters, and symmetry/noether.h proves each member. Members that
 * are not proved are counted and not listed. */
#ifndef LAGC_SYMMETRY_FIND_SYMMETRIES_H
#define LAGC_SYMMETRY_FIND_SYMMETRIES_H

#include "symmetry/found_symmetry.h"

/* Remark for the report: impacts, contacts, and events that set coordinates or velocities change charges, and are no part of L. NULL: the model
 * has none. */
const char *noether_note_on_impacts(const Model *m);

/* Finds symmetries that hold for all values of the parameters. Needs a Lagrangian. */
FoundSymmetries noether_find(Eqns *e);

/* A scaling q_i -> s^alpha_i q_i, t -> s^beta t that multiplies L dt by s^kappa with kappa not 0: it maps solutions to solutions and has no
 * charge. noether_scaling returns 0 where there is none, or there are several. */
typedef struct {
  const Num *alpha; /* [n] */
  Num beta, kappa;
} Scaling;

int noether_scaling(const Eqns *e, Scaling *found);

#endif
