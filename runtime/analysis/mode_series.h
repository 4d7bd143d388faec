/* Series of motions about a rest in powers of their amplitude: coefficients of the rates along a curve, and linear
 * equations of harmonics, for mode_amplitude.c and mode_coupling.c. Units: 1/w of one mode, and one of each unknown. */
#pragma once

#include "analysis/modes.h"
#include "core/rhs.h"

enum { SERIES_ORDER = 5, SERIES_HARMONICS = SERIES_ORDER + 1 };

typedef struct Series {
  Pool pool;
  const Modes *modes;
  lag_problem *pb;
  const double *rest; /* [n] */
  double t, w;
  int k, n, leads;    /* the mode; its leading unknown in the state */
  double *scale, *x, *held; /* [n] units; rows of coefficients; inputs that follow a formula: none */
  double *B;                /* [n * n] */
  double *y, *r;            /* [HARMONICS][HARMONICS][2 n], [HARMONICS][2 n]: harmonics of y_k, of rates: re, im */
  double *curve, *rates;    /* [HARMONICS * n], [n] */
  double *M, *rhs;          /* a linear system of up to 2 n + 2 unknowns */
  double *perm;
  double c[SERIES_HARMONICS], c_im[SERIES_HARMONICS];
  struct ModeAmplitude *out;
} Series;

/* Whether a mode is an undamped oscillation with a shape of its own. */
int lag_mode_oscillates(const Mode *m);
/* Harmonic h of y_order, [2 n]. */
double *lag_series_harmonic(const Series *s, int order, int h);
/* Of mode k; *u: its shape [2 n], re and im, with amplitude 1 of the leading unknown. LAG_OK, a status, or
 * 1: it shares its rate without a shape of its own. Free the pool in any case. */
int lag_series_open(Series *s, const Modes *modes, int k, Equilibrium *rest, double **u);
/* rates[n] := coefficient `order` of the rates along the curve y0 + sum of e^j curve[j * n]. LAG_OK or a status. */
int lag_series_rates(Series *s, int order);
/* M of the harmonic with frequency h: (i h - B) Y = rhs, `real` for Y real; with u also one unknown more, c of c i u,
 * and the part of Y along unknown `leads` is 0. Returns the number of unknowns. */
int lag_series_equations(Series *s, double h, int real, const double *u, int leads);
/* rhs := M^-1 rhs, where the last `free` pivots may vanish: 1 if the equations contradict each other by more than
 * `rounding`, which is a resonance; unknowns that nothing determines become 0. */
int lag_series_solve(Series *s, int N, int free, double rounding);
/* Number of modes but `own` with the frequency h w but for the part `near` of w; *with := the nearest one, *divisor
 * its distance over w. */
int lag_series_resonant(const Series *s, int own, double h, double near, int *with, double *divisor);
