/* How the amplitudes of other modes shift the frequency of a mode: w_i (1 + sum of shift_ij A_j^2), with A_j as in
 * mode_amplitude.h. It is Birkhoff's normal form to the fourth order of the energy, whose second derivatives by the
 * actions are d w_i/d J_j. */
#pragma once

#include "analysis/mode_amplitude.h"

enum { COUPLING_MOST = 12 }; /* modes whose pairs are computed: the first that oscillate */

typedef struct ModeCoupling {
  double shift, error;  /* per square of SI units; NAN: none. Rounding: its change by other points of evaluation */
  /* resonance: times[0] w_a + times[1] w_b = w_with of the pair a < b; growth: A_i' ~ A_i A_j^2 */
  AmplitudeLimit limit;
  int with, times[2];
  double divisor; /* how far the resonance is missed, over w_a */
} ModeCoupling;

typedef struct Couplings {
  int n, mode[COUPLING_MOST];
  ModeCoupling pair[COUPLING_MOST][COUPLING_MOST];
  double action[COUPLING_MOST]; /* action over A^2, < 0 where the energy falls with it; NAN: no energy is conserved */
} Couplings;

/* Of modes about the rest, whose own series are `bends`. LAG_OK, LAG_ENOMEM or a status of the model. */
int lag_mode_couplings(Couplings *c, const Modes *modes, const ModeAmplitude *bends, Equilibrium *rest);
