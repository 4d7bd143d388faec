/* How the frequency of a mode depends on its amplitude: w (1 + a2 A^2 + a4 A^4 + ...), with A half the swing of one
 * coordinate, along the family of periodic motions that begins with the mode (Lyapunov's centre theorem). */
#pragma once

#include "analysis/modes.h"
#include "analysis/periodic_orbit.h"

typedef struct ModeAmplitude {
  int leads;                 /* coordinate whose amplitude is A, that which moves most; -1: there is no such family */
  double a2, a4;             /* per square and fourth power of SI units */
  double error2, error4;     /* changes by one power less */
} ModeAmplitude;

/* Of mode k about the rest y[n]; like: as of lag_flow_open. LAG_OK, or LAG_ENOMEM. leads = -1: the mode does not
 * oscillate undamped, another frequency is a multiple of its own, or no family was found. */
int lag_mode_amplitude(ModeAmplitude *a, const Modes *modes, int k, lag_sim *like, const lag_algebra *algebra,
                       const double *y);
