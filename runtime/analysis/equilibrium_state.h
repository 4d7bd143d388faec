/* The model at rest: the state of the search for an equilibrium, and what is judged of the place. */
#ifndef LAG_ANALYSIS_EQUILIBRIUM_STATE_H
#define LAG_ANALYSIS_EQUILIBRIUM_STATE_H

#include "analysis/memory_pool.h"
#include "core/core.h"

/* The model at rest. Unknowns x[n], n = nq + nz, are coordinates and states over their scale; equations are forces times that scale, so
 * energies, and rates over it. */
typedef struct Equilibrium {
  Pool pool;
  lag_sim *sim;
  int n;
  double *start;  /* [n] start of the simulation, in SI */
  double *y;      /* [2 nq + nz] the state at rest, or the last one tried */
  double *rate;   /* [2 nq + nz] y' there */
  double *scale;  /* [n] scales: of angles 1 rad, else the largest start in that unit, or one unit */
  int steps;      /* that it took */
  int worst;      /* not found: the equation with the largest unbalanced force, */
  int away;       /* 1: forces only fade, far away */
  double *x, *begin, *from, *first, *trial, *near, *kept; /* [n] unknowns: now, at the start, and points of the search */
  double *f, *row, *J, *W; /* equations, their row scales, their derivatives; friction matrix */
  double *dx, *step;       /* [n] Newton step; right-hand side */
  double *values, *noise, *scratch; /* [n + n * n] f and J, and their perturbation noise */
  double *spread; /* [n] uncertainty of the root x, by rounding */
  int rank;       /* of J there */
  int pole, rough; /* lag_is_coordinate_pole, lag_is_nonsmooth */
  double delta;
  double *dr, *M, *work;   /* of lag_linearise */
} Equilibrium;

/* An lag_equations: forces M a (a from the model, so that both vanish together) and rates, of a Equilibrium at x[n]. Leaves the state in y,
 * y' in rate, and M. */
int lag_equilibrium_equations(void *rest, const double *x, double *f, double *J);

/* y := the state at rest for the unknowns x[n]. */
void lag_equilibrium_state(Equilibrium *rest, const double *x);

/* Whether the mass matrix is nearly singular at r->x and not nearby: a coordinate loses its meaning, as longitude does at a pole. This test and
 * the next evaluate the state at rest and nearby, and leave rest's values undefined. */
int lag_is_coordinate_pole(Equilibrium *rest);
/* Whether derivatives of forces jump here, or have no limit. */
int lag_is_nonsmooth(Equilibrium *rest);

#endif
