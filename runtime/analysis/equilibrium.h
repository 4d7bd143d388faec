/* Equilibria: q' = 0 and every force balanced. Enters: a simulation before its first step; leaves: the state where it would stay. */
#ifndef LAG_ANALYSIS_EQUILIBRIUM_H
#define LAG_ANALYSIS_EQUILIBRIUM_H

#include "analysis/pool.h"
#include "core/core.h"

/* The model at rest. Unknowns x[n], n = nq + nz, are coordinates and states over their scale; equations are forces times that scale, so
 * energies, and rates over it. */
typedef struct Rest {
  Pool pool;
  lag_sim *sim;
  int n;
  double *start;  /* [n] start of the simulation, in SI */
  double *y;      /* [2 nq + nz] the state at rest, or the last one tried */
  double *rate;   /* [2 nq + nz] y' there */
  double *scale;  /* [n] scales: of angles 1 rad, else the largest start in that unit, or one unit */
  int steps;      /* steps of the search */
  int worst;      /* not found: the equation with the largest unbalanced force, */
  int away;       /* 1: forces only fade, far away */
  double *x, *begin, *from, *first, *trial, *near, *kept; /* [n] unknowns: now, at the start, and points of the search */
  double *f, *row, *J, *W; /* equations, their row scales, their derivatives; friction matrix */
  double *dx, *step;       /* [n] Newton step; right-hand side */
  double *values, *noise, *scratch; /* [n + n * n] f and J, and their perturbation noise */
  double *spread; /* [n] uncertainty of the root x, by rounding */
  int rank;       /* rank of J there */
  int pole, rough; /* results of place.h */
  double delta;
  double *dr, *M, *work;   /* linearisation (lag_linearise) and its scratch */
} Rest;

/* Finds an equilibrium from the simulation's start (velocities do not matter) by algebra->root, stable or not. If none is within one scale of
 * the start, it follows the overdamped motion, with all inertia replaced by friction, to rest; it takes any other root last. Unknowns that no
 * force determines keep their start. The model must not depend on time. 1: found. 0: not found, see worst and rate. < 0: a status; LAG_EDOMAIN
 * and others from the model: no values at the start. Call lag_rest_free in every case. */
int lag_rest_find(Rest *rest, lag_sim *sim, const lag_algebra *algebra);
void lag_rest_free(Rest *rest);

/* An lag_equations function: forces M a (a from the model, so that both vanish together) and rates of a Rest at x[n]. Leaves the state in y, y'
 * in rate, and M. */
int lag_rest_equations(void *rest, const double *x, double *f, double *J);

/* y := the state at rest for the unknowns x[n]. */
void lag_rest_place(Rest *rest, const double *x);

/* Whether the state at rest moved by c dx[n] (in SI) is a root, or indistinguishable from one. */
int lag_rest_holds(Rest *rest, const double *dx, double c);

/* Whether another equilibrium lies near that place, nearer to it than to the first one: then they form a curve. */
int lag_rest_continues(Rest *rest, const lag_algebra *algebra, const double *dx, double c);

#endif
