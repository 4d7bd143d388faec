/* Perturbation noise: how rounding of parameters and unknowns changes values of a model. */
#include "analysis/perturbation_noise.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_TURNS = 32 };

/* Relative perturbation: differences of values then keep half of their digits. */
static const double MOVE = 1.0 / (1 << 26);

/* Perturbs the elements of z[n] that belong to pass `turn`: those whose number, counted from `first`, is `turn`
 * modulo MOST_TURNS. */
static void perturb(double *z, int n, int first, int turn) {
  for (int i = 0; i < n; i++) {
    int at = first + i;
    if (at % MOST_TURNS == turn) z[i] *= at / MOST_TURNS % 2 ? 1 - MOVE : 1 + MOVE;
  }
}

int lag_perturbation_noise(Equilibrium *r, lag_values *values, const double *x, size_t count, double *base, double *noise, double *scratch) {
  lag_problem *pb = &r->sim->pb;
  const double *given = pb->p;
  int np = pb->model->np, n = r->n, turns = np + n < MOST_TURNS ? np + n : MOST_TURNS;
  double *out = scratch, *p = out + count, *at = p + np + pb->model->nderived;
  int rc = values(r, x, base);
  memset(noise, 0, count * sizeof *noise);
  for (int turn = 0; turn < turns && rc == 0; turn++) {
    memcpy(p, given, (size_t)np * sizeof *p);
    memcpy(at, x, (size_t)n * sizeof *at);
    perturb(p, np, 0, turn);
    if (pb->model->derive) pb->model->derive(p);
    perturb(at, n, np, turn);
    pb->p = p;
    if (values(r, at, out) == 0 && lag_not_finite((int)count, out) < 0)
      for (size_t i = 0; i < count; i++) noise[i] += fabs(out[i] - base[i]) * (DBL_EPSILON / MOVE);
    pb->p = given;
  }
  return rc;
}
