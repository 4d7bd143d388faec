/* Symmetries as the search for them finds, proves and names them. */
#ifndef LAGC_SYMMETRY_FOUND_SYMMETRY_H
#define LAGC_SYMMETRY_FOUND_SYMMETRY_H

#include "symmetry/noether.h"

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

#endif
