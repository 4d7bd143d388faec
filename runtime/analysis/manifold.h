/* Stable and unstable manifolds of periodic motions and of saddles at rest: starts a little beside, along the exact
 * eigenvectors of the linearised flow; runs from there, of stable ones backwards, trace the manifold. */
#pragma once

#include "analysis/periodic_orbit.h"

typedef struct ManifoldStart {
  struct ManifoldStart *next;
  int stable;  /* 1: is followed backwards */
  int phase;   /* place along the motion, from 0 */
  int side;    /* 1 or -1 */
  double rate; /* of growth [1/s], > 0 */
  double t, *y; /* time and state [n] */
  double *at, *v; /* [n] state of the motion there, and the direction, of length 1 in units of the motion */
} ManifoldStart;

typedef struct Manifold {
  Pool pool;
  ManifoldStart *first, *last;
  int rest_of; /* directions left out: eigenvalues in complex pairs */
} Manifold;

/* Adds the starts of all real multipliers outside the unit circle, or for `stable` inside it: at `phases` times of the
 * period, `part` of the motion's size away, on both sides. LAG_OK, or a status. */
int lag_manifold_of_orbit(Manifold *m, PeriodicOrbit *o, int stable, int phases, double part);
/* The same of the state of rest y[n]: all real rates that grow, or decay. */
int lag_manifold_of_rest(Manifold *m, FlowMap *f, const lag_algebra *algebra, const double *y, int stable, double part);
void lag_manifold_free(Manifold *m);
