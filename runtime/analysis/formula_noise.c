/* Rounding of the formulas of the rates of change, which all runs of a precision share: their values in other rounding
 * modes. W. Kahan, How futile are mindless assessments of roundoff in floating-point computation? (2006), section 4. */
#include "analysis/formula_noise.h"

#include <fenv.h>
#include <math.h>
#include <stdlib.h>

#include "core/core.h"

/* dy[n] := rates in a rounding mode. */
static int rates(lag_sim *sim, int mode, double t, const double *y, double *dy) {
  int before = fegetround(), rc = fesetround(mode) || lag_rhs(&sim->pb, t, y, dy);
  return fesetround(before) || rc;
}

/* noise[n] += rounding of the rates at t, y; size[n] := the largest of itself and of their sizes. scratch[5 n]. Not 0: no
 * values. */
static int add_noise(lag_sim *sim, double t, const double *y, double *noise, double *size, double *scratch) {
#if defined FE_UPWARD && defined FE_DOWNWARD && defined FE_TONEAREST
  const double moved = 1. / 1024, usual = 1. / 3; /* these roundings are twice as large as others, and of one sign */
  int n = sim->pb.n;
  double *up = scratch, *down = up + n, *beside = down + n, *state = beside + n, *f = state + n;
  for (int i = 0; i < n; i++) state[i] = y[i] * (1 + moved);
  if (rates(sim, FE_TONEAREST, t, y, f) || rates(sim, FE_TONEAREST, t, state, beside)) return 1;
  if (rates(sim, FE_UPWARD, t, y, up) || rates(sim, FE_DOWNWARD, t, y, down)) return 1;
  for (int i = 0; i < n; i++) {
    double over = fabs(up[i] - f[i]), under = fabs(down[i] - f[i]);
    /* One of the modes costs lag_math.h digits of a small angle, by its sign. */
    double off = over > 0 && under > 0 ? fmin(over, under) : fmax(over, under);
    noise[i] += usual * off;
    size[i] = fmax(size[i], lag_above_rounding(fabs(f[i]) + off, fabs(beside[i] - f[i]) / moved));
  }
  return 0;
#else
  return 1;
#endif
}

/* The rate whose rounding is the largest part of the sizes of its kind. beside[nq]: size of accelerations that are
 * rounding: velocities of the energy's size, in the time of the run. */
static FormulaNoise worst_rate(lag_sim *sim, const double *noise, double *size, const double *beside, int states) {
  FormulaNoise worst = {.of = -1};
  int nq = sim->pb.nq, n = sim->pb.n;
  for (int pass = 0; pass < 2; pass++)
    for (int k = nq; k < n; k++) {
      int i = pass ? n - 1 - (k - nq) : k, alike = lag_previous_alike(sim, i);
      if (alike >= 0) size[pass ? alike : i] = fmax(size[i], size[alike]);
    }
  for (int i = nq; i < n; i++) {
    if (i < 2 * nq) size[i] = lag_above_rounding(size[i], beside[i - nq]);
    double part = size[i] > 0 ? noise[i] / states / size[i] : 0;
    if (part > worst.part) worst = (FormulaNoise){.of = i, .part = part};
  }
  return worst;
}

int lag_formula_noise(lag_sim *sim, const Samples *motion, FormulaNoise *worst) {
  enum { STATES = 16, FEW = 2 };
  const lag_model *m = sim->scene->model;
  int n = sim->pb.n, most = m->ops < 10000 ? STATES : FEW, states = 0, rows = motion->rows;
  double *noise = calloc(7 * (size_t)n + 1, sizeof *noise), *size = noise + n;
  *worst = (FormulaNoise){.of = -1};
  if (!noise) return LAG_ENOMEM;
  if (m->nmodes || m->ncontacts || n != motion->n) rows = 0; /* other branches, at other states */
  for (int k = 0; k < most && k < rows; k++) {
    int row = most < rows ? (int)((2 * k + 1) * (long long)rows / (2 * most)) : k;
    states += !add_noise(sim, motion->t[row], motion->y + (size_t)row * (size_t)n, noise, size, size + n);
  }
  if (states) {
    double *v = size + n, span = fabs(motion->t[rows - 1] - sim->scene->t0);
    lag_velocity_terms(sim, motion->t[rows / 2], motion->y + (size_t)(rows / 2) * (size_t)n, v);
    for (int i = 0; i < sim->pb.nq; i++) v[i] = span > 0 ? v[i] / span : HUGE_VAL;
    *worst = worst_rate(sim, noise, size, v, states);
  }
  free(noise);
  return LAG_OK;
}
