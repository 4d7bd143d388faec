/* Branches of solutions, their points, and the equations that they solve. */
#pragma once

#include "analysis/memory_pool.h"

/* Eigenvalues that decide on stability: of a state of rest rates, of a periodic motion multipliers. */
typedef struct Spectrum {
  int n;
  double *re, *im;
} Spectrum;

/* The equations: u[cols] are unknowns in units, of which the last is the parameter; rows of rank cols - 1 at regular
 * points. */
typedef struct BranchProblem {
  void *of;
  int rows, cols, eigenvalues; /* the most of them */
  int forms; /* of the rows the last, which choose among forms of one solution, as the phase does */
  int maps;  /* 1: eigenvalues are multipliers, with stability inside the unit circle; 0: rates */
  int pairs; /* 1: eigenvalues come in pairs, as of Hamilton's equations */
  int (*place)(void *of, const double *u); /* takes the unknowns. LAG_OK, or > 0: no values there */
  /* J[rows cols] and b[rows], the negative residual, at the unknowns that are placed */
  int (*system)(void *of, double *J, double *b);
  /* b at u, which is placed, where that costs much less than J; or NULL */
  int (*residual)(void *of, const double *u, double *b);
  double (*noise)(void *of); /* rounding of J, as a part of its largest singular value; NULL: 1e-8 */
  int (*spectrum)(void *of, Spectrum *s);
  int (*stands)(void *of, const double *u, const double *d); /* whether d leads to the same solution, or NULL */
} BranchProblem;

typedef enum BranchKind {
  BRANCH_REGULAR,
  BRANCH_FOLD,
  BRANCH_POINT,
  BRANCH_DOUBLING,
  BRANCH_HOPF,
  BRANCH_TORUS,
  BRANCH_COLLISION
} BranchKind;

typedef struct BranchPoint {
  struct BranchPoint *next;
  double *u, *tangent; /* [cols] */
  Spectrum spectrum;
  int unstable, stable;           /* numbers of eigenvalues that grow, that decay */
  int stays;                      /* 1: a multiplier is 1 to rounding, as along a family */
  double fold, zero, minus, pair; /* test functions, and the growth of the complex pair nearest to the border */
  BranchKind kind;
  double *shown;          /* [n] state of a motion that begins later, at the scene's begin; NULL: that of u */
  const char *unfollowed; /* why no branch that leaves it is followed; NULL: one is, or none was asked for */
} BranchPoint;

/* Why a branch ends. */
typedef enum BranchEnd { BRANCH_AT_RANGE, BRANCH_AT_NUMBER, BRANCH_CLOSED, BRANCH_LOST, BRANCH_NO_MEMORY } BranchEnd;

typedef struct Branch {
  Pool pool;
  BranchPoint *first, *last;
  int npoints;
  BranchEnd end;
} Branch;
