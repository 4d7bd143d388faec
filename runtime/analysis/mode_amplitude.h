/* How the frequency of a mode depends on its amplitude: w (1 + a2 A^2 + a4 A^4 + ...), with A half the swing of one
 * coordinate, along the family of periodic motions that begins with the mode (Lyapunov's centre theorem). It is
 * Birkhoff's normal form, restricted to this mode. */
#pragma once

#include "analysis/modes.h"

typedef enum AmplitudeLimit {
  AMPLITUDE_WHOLE,
  AMPLITUDE_NO_OSCILLATION, /* the mode does not oscillate undamped, or shares its rate without a shape of its own */
  AMPLITUDE_RESONANCE,      /* `times` its frequency is that of mode `with`, which the motion excites */
  AMPLITUDE_GROWTH          /* A' = growth A^3: there is no family */
} AmplitudeLimit;

typedef struct ModeAmplitude {
  int leads;             /* unknown whose amplitude is A, that which moves most */
  double a2, a4;         /* per square and fourth power of SI units; NAN: not reached */
  double error2, error4; /* rounding: changes by other points of evaluation */
  AmplitudeLimit limit;
  int with, times;       /* the smallest divisor: `times` w less the frequency of mode `with`, */
  double divisor;        /* over w; NAN: none is small */
  double growth;
} ModeAmplitude;

/* Of mode k about the rest, whose model has series. LAG_OK, LAG_ENOMEM or a status of the model. */
int lag_mode_amplitude(ModeAmplitude *a, const Modes *modes, int k, Equilibrium *rest);
