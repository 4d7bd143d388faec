/* Modes of small motion about an equilibrium: frequencies, shapes, damping, and the stability that follows. Enters:
 * a state of rest; leaves: its modes and a verdict. */
#pragma once

#include "analysis/equilibrium.h"

/* A motion exp((re + i im) t) shape, im >= 0. */
typedef struct Mode {
  double re, im;      /* [1/s]; both 0: a zero mode */
  int repeats;        /* > 1: multiplicity of a defective eigenvalue, which has fewer shapes */
  int free;           /* zero mode: all forces stay 0 far along it */
  const double *shape_re, *shape_im; /* [nq + nz] in SI; its largest component, by kinetic energy, is 1 declared unit */
} Mode;

/* Verdict on the stability of an equilibrium. */
typedef enum Verdict {
  LAG_UNSTABLE,    /* a mode grows */
  LAG_DECAYS,      /* all modes decay: asymptotically stable */
  /* a strict minimum of a conserved energy, of first order also a maximum: stable (Lagrange, Dirichlet) */
  LAG_MINIMUM,
  /* a strict minimum of an energy that nothing raises: stable (Thomson & Tait; Chetaev) */
  LAG_DISSIPATIVE_MINIMUM,
  LAG_NEUTRAL,     /* free motions; otherwise a minimum, or all modes decay */
  LAG_GYROSCOPIC,  /* not decided: all modes oscillate, but the energy has no minimum */
  LAG_DEGENERATE,        /* not decided: a zero mode that is no free motion, or several that are not free together */
  LAG_COORDINATE_POLE,        /* not decided: a coordinate loses its meaning here */
  LAG_HELD,        /* not decided: dry friction holds what rests */
  LAG_NONSMOOTH,       /* not decided: derivatives of forces jump here, or have no limit */
  LAG_DEFECTIVE,   /* not decided: a multiple imaginary eigenvalue that lacks shapes */
  LAG_CENTRE       /* not decided: some modes neither grow nor decay, and no energy is known to be conserved */
} Verdict;

typedef struct Modes {
  Pool pool;
  Mode *mode;    /* [n]: zero modes, then growing ones, then by frequency */
  int n;
  Verdict verdict;
  int pairs;     /* each mode stands for both +-(re + i im) */
  int conserves; /* dE/dt = 0, or is 0 at these values of parameters */
  int drifts;    /* 1: a push along a zero mode drifts for ever */
  int together;  /* 1: free zero modes are free in any combination */
  int steady;    /* 1: about a steady motion, in the frame that moves with it */
  int lowering;  /* number of directions in which the energy falls; -1: not known */
  int extremum;  /* of the energy of a model of first order: 1 a strict minimum, -1 a strict maximum; 0: not known */
} Modes;

/* The modes about the state at rest. LAG_OK, LAG_ENOMEM, LAG_ESINGULAR, LAG_EMETHOD: eigenvalues did not
 * converge. Call lag_modes_free in every case. */
int lag_modes_find(Modes *modes, Equilibrium *rest, const lag_algebra *algebra);
void lag_modes_free(Modes *modes);

/* Adds a mode with the shape re + i im, [n], whose component `ref` becomes 1 declared unit. */
void lag_add_mode(Modes *to, const lag_model *m, Mode mode, int n, double *re, double *im, int ref);

/* Orders modes as they are listed. */
void lag_modes_sort(Modes *modes);

/* Columns v[n * k] := a basis of the same space with as many zeros as possible: Gauss-Jordan elimination, components
 * measured in scale[n]. */
void lag_reduce_columns(int n, int k, const double *scale, double *v);

/* x[n] := a sum of the columns v[n * k] with coefficients in no simple ratio, their signs by pattern: what holds for
 * each column and all mixtures holds for all sums. */
enum { LAG_MIXTURES = 4 };
void lag_mix_columns(int n, int k, const double *v, int pattern, double *x);
