/* A state of rest: q' = 0 and every force balanced. Enters: a simulation before its first step; leaves: where it would
 * stay. */
#ifndef LAG_ANALYSIS_EQUILIBRIUM_H
#define LAG_ANALYSIS_EQUILIBRIUM_H

#include "analysis/pool.h"
#include "core/core.h"

/* The model at rest. Unknowns x[n], n = nq + nz, are coordinates and states over their scale; equations are
 * forces times that scale, so that those of coordinates are energies, and rates over it. */
typedef struct Rest {
  Pool pool;
  lag_sim *sim;
  int n;
  double *start;  /* [n] of the simulation, in SI */
  double *y;      /* [2 nq + nz] the state at rest, or the last one tried */
  double *rate;   /* [2 nq + nz] y' there */
  double *scale;  /* [n] how far is far: of angles 1 rad, else the largest start in that unit, or one unit */
  int steps;      /* that it took */
  int worst;      /* not found: the equation that is farthest from 0, */
  int away;       /* and whether forces only fade, far away */
  double *x, *begin, *from, *first, *trial, *near, *kept; /* [n] unknowns: now, at the start, and of the search */
  double *f, *row, *J, *W; /* equations, what makes them alike in size, their derivatives; friction */
  double *dx, *step;       /* [n] of Newton's method */
  double *values, *noise, *scratch; /* [n + n * n] f and J, and what rounding of the model's numbers makes of them */
  double *spread; /* [n] how far the root may be from x, by rounding */
  int rank;       /* of J there */
  int pole, rough; /* what place.h says of it */
  double delta;
  double *dr, *M, *work;   /* of lag_linearise */
} Rest;

/* Finds an equilibrium from the simulation's start (velocities do not matter) by algebra->root, stable or not. Is there
 * none within one scale of the start, it looks where the system would come to rest if all inertia were
 * friction; and takes any other root last. What nothing pulls at stays where it began. The model must not depend on time.
 * 1: found. 0: not found, see worst and rate. < 0: a status; LAG_EDOMAIN and others from the model: no values at the start. Call
 * lag_rest_free in every case. */
int lag_rest_find(Rest *rest, lag_sim *sim, const lag_algebra *algebra);
void lag_rest_free(Rest *rest);

/* An lag_equations: forces M a (a from the model, so that both vanish together) and rates, of a Rest at x[n]. Leaves the state in y,
 * y' in rate, and M. */
int lag_rest_equations(void *rest, const double *x, double *f, double *J);

/* y := the state, at rest, of the unknowns x[n]. */
void lag_rest_place(Rest *rest, const double *x);

/* Whether a root is at, or so near that it cannot be told from, the state at rest moved by c times dx[n] (in SI). */
int lag_rest_holds(Rest *rest, const double *dx, double c);

/* Whether there is another equilibrium beside that place, nearer to it than to the first one: then they form a curve. */
int lag_rest_continues(Rest *rest, const lag_algebra *algebra, const double *dx, double c);

#endif
