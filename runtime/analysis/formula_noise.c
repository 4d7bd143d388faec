/* Rounding of the formulas of the rates of change, which all runs of a precision share: core/sizes.c at states of
 * the run. */
#include "analysis/formula_noise.h"

#include <math.h>
#include <stdlib.h>

#include "core/core.h"

/* noise[n] += rounding of the rates at t, y; size[n] := the largest of itself and of their sizes. scratch[5 n]. Not
 * 0: no values. */
static int add_noise(lag_sim *sim, double t, const double *y, double *noise, double *size, double *scratch) {
  const double moved = 1. / 1024, usual = 1. / 3; /* these roundings are twice as large as others, and of one sign */
  int n = sim->pb.n, nq = sim->pb.nq;
  double *off = scratch, *up = off + n, *beside = up + n, *state = beside + n, *f = state + n;
  for (int i = 0; i < n; i++) state[i] = y[i] * (1 + moved);
  if (lag_rhs(&sim->pb, t, state, beside) || lag_rhs(&sim->pb, t, y, f)) return 1;
  if (lag_formula_rounding(sim, LAG_FORMULA_RATES, t, y, off + nq, up, state)) return 1;
  for (int i = nq; i < n; i++) {
    noise[i] += usual * off[i];
    size[i] = fmax(size[i], lag_above_rounding(fabs(f[i]) + off[i], fabs(beside[i] - f[i]) / moved));
  }
  return 0;
}

/* The largest size of each kind of rate. */
static void share_sizes(const lag_sim *sim, double *size) {
  int nq = sim->pb.nq, n = sim->pb.n;
  for (int pass = 0; pass < 2; pass++)
    for (int k = nq; k < n; k++) {
      int i = pass ? n - 1 - (k - nq) : k, alike = lag_previous_alike(sim, i);
      if (alike >= 0) size[pass ? alike : i] = fmax(size[i], size[alike]);
    }
}

/* Accelerations of rounding alone have a third, and those that are seen have no floor. */
static int is_all_noise(double noise, double size) { return noise > 0.2 * size; }

/* size[] of accelerations that are rounding := at least what velocities of the energy's size make in the time of the
 * run, at its middle. v[nq]: scratch. */
static void raise_sizes(lag_sim *sim, const Samples *motion, const double *noise, double *size, int states, double *v) {
  int nq = sim->pb.nq, last = motion->rows - 1, row = motion->rows / 2, some = 0;
  double span = fabs(motion->t[last] - sim->scene->t0);
  for (int i = nq; i < 2 * nq; i++) some |= is_all_noise(noise[i] / states, size[i]);
  if (!some) return;
  lag_velocity_terms(sim, motion->t[row], motion->y + (size_t)row * (size_t)motion->n, lag_step_so_far(sim), v);
  for (int i = nq; i < 2 * nq; i++)
    if (is_all_noise(noise[i] / states, size[i]))
      size[i] = lag_above_rounding(size[i], span > 0 ? v[i - nq] / span : HUGE_VAL);
}

/* The rate whose rounding is the largest part of the sizes of its kind. */
static FormulaNoise worst_rate(const lag_sim *sim, const double *noise, const double *size, int states) {
  FormulaNoise worst = {.of = -1};
  for (int i = sim->pb.nq; i < sim->pb.n; i++) {
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
    share_sizes(sim, size);
    raise_sizes(sim, motion, noise, size, states, size + n);
    *worst = worst_rate(sim, noise, size, states);
  }
  free(noise);
  return LAG_OK;
}
