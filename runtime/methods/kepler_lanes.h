/* Kicks and Kepler motions of bodies for wisdom_holman.c, in the widest vectors that the processor has.
 *
 * Enters: mu of m places, then 1 or 0 for each, whether it is not 0; x, the arrays below, of 3 components, each of m
 * places: a multiple of KEPLER_BLOCK, or KEPLER_FEW. Leaves: the same after a kick and a motion. Holds: the bits do not
 * depend on the width. */
#pragma once

/* Positions, velocities, rounding that their sums have lost, accelerations; distances from the centre, their inverses
 * and mu/r^3. */
enum { KEPLER_X, KEPLER_V, KEPLER_LOST_X, KEPLER_LOST_V, KEPLER_ACCEL, KEPLER_DISTANCE, KEPLER_ARRAYS };
/* Places: a multiple of a block, or few. */
enum { KEPLER_FEW = 4, KEPLER_BLOCK = 8 };

typedef void KeplerMove(int m, const double *mu, double kick, double dt, double *x);
/* In vectors of 1, 2, 4, 8; NULL: not compiled. */
extern KeplerMove *const lag_kepler_move_1, *const lag_kepler_move_2, *const lag_kepler_move_4,
    *const lag_kepler_move_8;
/* The motion for the time h from a body's orbit, members of lag_kepler_orbit: f, g, df, dg of lag_kepler_motion. */
void lag_kepler_move_far(const double orbit[6], double h, double motion[4]);
/* Distances of m bodies at x. */
void lag_kepler_distances(int m, const double *mu, double *x);
