/* The search for point symmetries of L: generators affine in q, with coefficients that are functions of time, and
 * gauge functions that are polynomials of q. Lie's method, restricted to that ansatz and done in numbers (P. J.
 * Olver, Applications of Lie Groups to Differential Equations, 2nd ed. (1993), 2.4 and 5.2): random states give
 * linear equations, the space of their solutions is brought to echelon form at two choices of parameters, its
 * entries are recognised as rationals times powers of parameters, and symmetry/noether_theorem.h proves each member.
 * Members that are not proved are counted and not listed. */
#pragma once

#include "symmetry/noether_theorem.h"
#include "symmetry/search_limit.h"

typedef enum {
  SYMMETRY_OTHER,
  SYMMETRY_ENERGY,
  SYMMETRY_MOMENTUM,    /* of a body, of all bodies, of a cyclic coordinate */
  SYMMETRY_ROTATION,
  SYMMETRY_BOOST,
  SYMMETRY_SCALING
} SymmetryKind;

typedef struct {
  SymmetryKind kind;
  const char *name;     /* "angular momentum", "boost along x" */
  int of_all;           /* moves all coordinates along its directions alike */
  uint32_t axis;        /* momentum, boost: the direction; rotation: the axis; or AXIS_NONE */
  Generator by;
  Expr rate;            /* w of sin(w t), cos(w t), s of exp(s t); 0: powers of t, or functions of a list */
  Noether is;
} FoundSymmetry;

typedef struct {
  VEC(FoundSymmetry) all;
  uint32_t unproved;    /* directions of the solution space that are not in closed form, or not proved */
  int searched;         /* 0: no search, for the reason in `note` */
  uint32_t attempt;     /* which random values of the parameters, see symmetry/number_recognition.h */
  int galilean;         /* the ten charges of Galileo's group are among them */
  const char *ansatz;   /* in words */
  const char *note;     /* or NULL: a remark for the report */
} FoundSymmetries;

/* Remark for the report: impacts, contacts, and events that set coordinates or velocities change charges, and are no
 * part of L. NULL: the model has none. */
const char *noether_note_on_impacts(const Model *m);

/* Finds symmetries that hold for all values of the parameters, in the time allowed: `note` says
 * what was not searched. Needs a Lagrangian. */
FoundSymmetries noether_find(Eqns *e, SearchLimit *limit);

/* A scaling q_i -> s^alpha_i q_i, t -> s^beta t that multiplies L dt by s^kappa with kappa not 0: it maps solutions
 * to solutions and has no charge. noether_scaling returns 0 where there is none, or there are several. */
typedef struct {
  const Num *alpha; /* [n] */
  Num beta, kappa;
} Scaling;

int noether_scaling(const Eqns *e, Scaling *found, SearchLimit *limit);
