/* Steady motions: a state whose motion is that of a symmetry, such as a shift of cyclic coordinates at constant
 * rates or a uniform rotation (relative equilibria); rest is the simplest. With constraints, small changes lie in
 * the tangent space of the states that obey them. */
#pragma once

#include "analysis/modes.h"

typedef struct SteadyMotion {
  Pool pool;
  lag_sim *sim;
  const lag_algebra *algebra;
  /* n = 2 nq + nz; rows: the rates of y, then residuals of constraints on positions and on velocities */
  int n, nq, nrows;
  int moving;           /* 0: rest is looked for, and velocities are no unknowns */
  int rank;             /* of the constraints' derivatives, beside the start */
  int without_rates;    /* 1: rows of rates are not computed */
  double *unit;         /* [n] scales of y: a change of one unit is large */
  double *row;          /* [nrows] scales of rows: changes by one unit */
  double *y;            /* [n] the state, in SI */
  double *f, *G, *noise; /* [nrows] and [nrows * n]: rows at y, their derivatives, and errors of these */
  int ncandidates, m;
  double *generators;   /* [m * ncandidates] symmetries found, by coefficients of the candidates */
  double *c;            /* [m] the motion at y as a sum of them */
  double *at, *out, *table; /* scratch: [n], [2 * nrows], extrapolation */
  double *D, *error, *direction; /* scratch: derivatives along directions, with their errors, and a direction */
} SteadyMotion;

/* Finds the steady motion nearest to the simulation's start; moving: 0, rest. rest: its members start, found, scale,
 * y (with velocities) and steps are set, for the report. 1: found, 0: not found, < 0: a status. The model must not
 * depend on time. */
int lag_steady_find(SteadyMotion *s, Equilibrium *rest, lag_sim *sim, const lag_algebra *algebra, int moving);
void lag_steady_free(SteadyMotion *s);

/* X[n] := generator c[m] of symmetries at y[n], and unless NULL DX[n * n] its derivative. */
void lag_steady_generator(const SteadyMotion *s, const double *c, const double *y, double *X, double *DX);

/* Sets f, G and noise at y. 0, or a status. */
int lag_steady_derivatives(SteadyMotion *s);

/* Q[size * size], the kernel of the constraints' derivatives in units, size >= n and their rows. Returns the rank,
 * or a status < 0; LAG_ESINGULAR: there is no clear one. Reads G. */
int lag_tangent_kernel(Pool *pool, const SteadyMotion *s, int size, double *Q);

/* Whether a steady motion lies near y + dx[n], dx in units and made `far` long, nearer than y: then they form a
 * family. */
int lag_steady_continues(SteadyMotion *s, const double *dx, double far);

/* A matrix by rows. */
typedef struct Rectangle {
  int rows, columns;
  const double *at;
} Rectangle;

/* Q[size * size], as lag_algebra.kernel has it, of A[rows * cols] in the corner of a square of `size` >= rows, cols;
 * pivots up to tol count as
 * 0. Returns the rank, or a status < 0. */
int lag_padded_kernel(Pool *pool, const lag_algebra *algebra, int size, Rectangle A, double tol, double *Q);

/* tangent_modes.c: modes about it, in the frame that moves with it. Returns as lag_modes_find. */
int lag_steady_modes(Modes *modes, SteadyMotion *s, Equilibrium *rest);
