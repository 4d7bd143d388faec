/* The search for point symmetries of L: generators affine in q, with coefficients that are functions of time, and gauge functions that
 * are polynomials of q. Lie's method, restricted to that ansatz and done in numbers (P. J. Olver, Applications of Lie Groups to
 * Differential Equations, 2nd ed. (1993), 2.4 and 5.2): random states give linear equations, the space of their solutions is
 * brought to echelon form at two choices of parameters, its entries are recognised as rationals times powers of parameters,
 * and each member is then proved by mech/noether.h. What is not proved is counted, and not listed. */
#ifndef LAGC_NOETHER_FIND_H
#define LAGC_NOETHER_FIND_H

#include "mech/noether.h"
#include "mech/noether_forms.h"

typedef enum {
  SYMMETRY_OTHER,
  SYMMETRY_ENERGY,
  SYMMETRY_MOMENTUM,    /* of a body, of all of them, of a cyclic coordinate */
  SYMMETRY_ROTATION,
  SYMMETRY_BOOST,
  SYMMETRY_SCALING
} SymmetryKind;

typedef struct {
  SymmetryKind kind;
  const char *name;     /* "angular momentum", "boost along x" */
  int of_all;           /* it moves all coordinates of its directions alike */
  uint32_t axis;        /* momentum, boost: the component; rotation: the component that stays */
  Generator by;
  const LinearForms *forms; /* what by.eta moves; or NULL */
  Expr rate;            /* w of sin(w t), cos(w t), s of exp(s t); 0: it goes with powers of t, or functions of a list */
  Noether is;
} FoundSymmetry;

typedef struct {
  VEC(FoundSymmetry) all;
  uint32_t unproved;    /* directions of the space of solutions that were seen, but not written in closed form or not proved */
  int searched;         /* 0: not, for the reason in `note` */
  uint32_t attempt;     /* with which values of the parameters, see mech/noether_number.h */
  int galilean;         /* the ten charges of Galileo's group are among them */
  const char *ansatz;   /* in words */
  const char *note;     /* or NULL: what else is to be said */
} FoundSymmetries;

/* What the report says of impacts, and of events that set velocities or coordinates, which are no part of L; NULL: there are none. */
const char *noether_note_on_impacts(const Model *m);

/* For all values of the parameters. Needs a Lagrangian. */
FoundSymmetries noether_find(Eqns *e);

/* A scaling q_i -> s^alpha_i q_i, t -> s^beta t that multiplies L dt by s^kappa with kappa not 0: it maps solutions to solutions
 * and has no charge. 0: there is none, or there are several. */
typedef struct {
  const Num *alpha; /* [n] */
  Num beta, kappa;
} Scaling;

int noether_scaling(const Eqns *e, Scaling *found);

#endif
