/* Volume of the phase space along a motion: the logarithm of the determinant of the tangent in (q, p), which
 * Liouville's theorem keeps at 0 for Hamilton's equations, and a symplectic method to rounding; in general it is the
 * integral of the divergence of the flow. J. Liouville, J. Math. Pures Appl. 3 (1838) 342; E. Hairer, C. Lubich, G.
 * Wanner, Geometric Numerical Integration, 2nd ed. (2006), VI.9, DOI 10.1007/3-540-30666-8.
 *
 * A model with velocities has the tangent in (q, q'): as p = dL/dq', its determinant in (q, p) is that in (q, q')
 * times det M at the end over det M at the start. */
#pragma once

#include "analysis/memory_pool.h"
#include "lag.h"

typedef struct PhaseVolume {
  int n;            /* size of the state; 0: not begun */
  double *sum;      /* [n] logarithms of the growth of each vector, at the end of the last step */
  double mass;      /* log |det M| at the start */
  double log_det;   /* at the end of the last step */
  double largest;   /* the largest |log_det| at ends of steps */
  /* scratch: the vectors [n n] and their sums [n]; M [nq nq], dr and work of lag_linearise */
  double *Y, *grown, *M, *dr, *work;
  Pool pool;
} PhaseVolume;

/* Before the first advance of a simulation with its method set: gives it a tangent of n columns. LAG_OK, LAG_ENOMEM,
 * or the status of a tangent that is missing or of a model with constraints (lag_sim_message). Free with
 * lag_phase_volume_free in any case. */
int lag_phase_volume_begin(PhaseVolume *v, lag_sim *sim);
void lag_phase_volume_free(PhaseVolume *v);

/* At the end of each step: call it from the hook of lag_sim_on_step. LAG_OK or a failure. */
int lag_phase_volume_step(PhaseVolume *v, lag_sim *sim);

/* log |det| of the present state, perhaps within a step; -HUGE_VAL: a slide has joined neighbouring motions; NaN:
 * not known. */
double lag_phase_volume_now(PhaseVolume *v, lag_sim *sim);
