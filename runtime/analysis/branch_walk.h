/* Solutions along a branch, for continuation.c: enters equations and a solution near; leaves points with their tangents
 * and test functions. */
#pragma once

#include <math.h>

#include "analysis/branch.h"

typedef struct Walk {
  Branch *b;
  const BranchProblem *p;
  int rows, cols; /* of the equations with the row across the tangent */
  double *J, *rhs, *V, *sigma, *x;
  /* the system at the point that was made last, without the row across the tangent, which is the last column of its V;
   * 0: there is none */
  struct { double *J, *V, *sigma; int known; } made_at;
  double enough; /* steps end where the next would be shorter: the system at the point takes it, too; 0: at rounding */
  int newton;  /* steps of the last correction */
  double made; /* arclength of the last step */
  int border;  /* 1: that step ends at the border of the range */
} Walk;

static const double no_growth = 1e-7;

static inline double lag_growth_sign(double growth) { return fabs(growth) < no_growth ? 0 : growth; }

int lag_walk_open(Walk *w, Branch *b, const BranchProblem *p);
/* Steps from u, each across the direction d: u := a solution. 0: none. */
int lag_walk_correct(Walk *w, double *u, const double *d);
/* The tangent of the branch at the solution that is placed: the unit vector that the equations leave free, with a
 * positive part along d. LAG_ESINGULAR: there are several. */
int lag_walk_tangent(Walk *w, const double *d, double *tangent);
/* A point at the solution u that is placed. NULL: no memory, or no values. */
BranchPoint *lag_walk_point(Walk *w, const double *u, const double *d);
/* The point at arclength s from `from` along its tangent, on the parabola with the tangent of another point, `apart`
 * from it, or NULL. NULL: there is none. */
BranchPoint *lag_walk_point_at(Walk *w, const BranchPoint *from, double s, const BranchPoint *other, double apart);
