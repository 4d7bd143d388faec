/* Bodies one at a time (kepler_lanes.h): compilers without vectors, other precisions; motions that vectors leave. */
#include "methods/kepler_moves.h"

KeplerMove *const lag_kepler_move_1 = kepler_move;

void lag_kepler_move_far(const double orbit[6], double h, double motion[4]) {
  const lag_kepler_orbit o = {orbit[0], orbit[1], orbit[2], orbit[3], orbit[4], orbit[5]};
  const lag_kepler_motion m = lag_kepler_far(&o, h);
  motion[0] = m.f, motion[1] = m.g, motion[2] = m.df, motion[3] = m.dg;
}

void lag_kepler_distances(int m, const double *mu, double *x) {
  for (int i = 0; i < m; i++) kepler_distances(m, mu + i, x + i);
}
