/* Lyapunov exponents by repeated orthonormalisation of the tangent (lyapunov.h), with their errors, and the
 * dimension and entropy that follow. */
#include "analysis/lyapunov.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "analysis/fastest_rate.h"
#include "analysis/orthonormalise.h"
#include "core/core.h"

/* Largest step times spectral radius: a step of order 5 is then wrong by some 1e-9 of each vector. */
static const double resolution = 0.1;

void lag_lyapunov_free(Lyapunov *l) { lag_pool_free(&l->pool); }

/* Pseudo-random vectors, the same in every run: axes of a model may be directions that its flow never leaves.
 * Generator: D.E. Knuth, MMIX; the upper bits of its states. */
static void random_vectors(Lyapunov *l) {
  uint64_t x = 1;
  for (int i = 0; i < l->n * l->k; i++) {
    x = x * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    l->Y[i] = ldexp((double)(x >> 32), -31) - 1;
  }
}

int lag_lyapunov_begin(Lyapunov *l, lag_sim *sim, int k, double from, double until) {
  size_t n = (size_t)sim->pb.n, kk = (size_t)k, nn = n * n;
  *l = (Lyapunov){
      .n = sim->pb.n, .d = sim->pb.n, .k = k, .from = from, .until = until, .begun = NAN, .t = NAN, .half = NAN};
  const lag_part parts[] = {{&l->sum, kk}, {&l->at_half, kk}, {&l->block_sum, kk},
      {&l->block, LAG_LYAPUNOV_BLOCKS * (kk + 1)}, {&l->Y, n * kk}, {&l->J, nn}, {&l->A, nn}, {&l->B, nn},
      {&l->work, lag_linear_work(sim->pb.model) + 1}};
  lag_pool_parts(&l->pool, sizeof parts / sizeof *parts, parts);
  if (l->pool.failed) return LAG_ENOMEM;
  random_vectors(l);
  lag_orthonormalise(l->n, k, l->Y, l->sum, 0, 0);
  int rc = lag_sim_set_tangent(sim, k, l->Y);
  l->d = rc ? rc : lag_tangent_dimension(sim);
  return l->d < 0 ? l->d : LAG_OK;
}

/* Closes the present block: its mean rates. */
static void close_block(Lyapunov *l) {
  double *rate = l->block + l->nblocks * (l->k + 1), length = l->t - l->block_from;
  rate[l->k] = 0;
  for (int a = 0; a < l->k; a++) {
    rate[a] = (l->sum[a] - l->block_sum[a]) / length;
    rate[l->k] += rate[a];
  }
  memcpy(l->block_sum, l->sum, (size_t)l->k * sizeof(double));
  l->block_from = l->t;
  l->nblocks++;
}

/* Df at y, t: adds its trace to the divergence since the last call, once that counts, and sets the longest next
 * step. */
static int examine_jacobian(Lyapunov *l, lag_sim *sim, double t, const double *y) {
  lag_problem *pb = &sim->pb;
  int n = l->n, nq = pb->nq;
  double before = l->trace, dt = isnan(l->begun) ? 0 : t - l->traced;
  if (!pb->model->linear && !pb->model->constraints) return LAG_OK;
  if (lag_jacobian(pb, t, y, l->J, l->work) || lag_not_finite((n - nq) * n, l->J) >= 0) return LAG_EDOMAIN;
  memset(l->A, 0, (size_t)(n * n) * sizeof(double));
  memcpy(l->A + nq * n, l->J, (size_t)((n - nq) * n) * sizeof(double));
  l->trace = 0;
  for (int i = 0; i < n; i++) {
    l->trace += l->A[i * n + i];
    if (i < nq) l->A[i * n + nq + i] = 1;
  }
  l->traced = t;
  l->divergence += dt * (before + l->trace) / 2;
  double rate = lag_fastest_rate(n, l->A, l->B);
  pb->longest = rate > 0 ? resolution / rate : 0;
  return LAG_OK;
}

void lag_lyapunov_event(Lyapunov *l, lag_sim *sim, double t, const double *before) {
  examine_jacobian(l, sim, t, before); /* a failure shows at the end of this step, too */
}

int lag_lyapunov_step(Lyapunov *l, lag_sim *sim) {
  int rc = lag_sim_tangent(sim, l->Y), counts = !isnan(l->begun), joins = sim->tangent_log == -HUGE_VAL;
  rc = rc ? rc : lag_orthonormalise(l->n, l->k, l->Y, l->sum, counts, joins);
  rc = rc ? rc : lag_sim_set_tangent(sim, l->k, l->Y);
  l->t = lag_sim_time(sim);
  l->divergence += counts || joins ? sim->tangent_log : 0;
  sim->tangent_log = 0;
  rc = rc ? rc : examine_jacobian(l, sim, l->t, sim->now);
  if (rc) return rc;
  if (!counts) {
    if (l->t >= l->from) l->begun = l->block_from = l->t;
    return LAG_OK;
  }
  l->steps++;
  double part = (l->t - l->begun) / (l->until - l->begun);
  if (isnan(l->half) && part >= 0.5) {
    l->half = l->t;
    memcpy(l->at_half, l->sum, (size_t)l->k * sizeof(double));
  }
  if (l->nblocks < LAG_LYAPUNOV_BLOCKS - 1 && part * LAG_LYAPUNOV_BLOCKS >= l->nblocks + 1) close_block(l);
  return LAG_OK;
}

void lag_lyapunov_end(Lyapunov *l) {
  double whole = (l->until - l->begun) / LAG_LYAPUNOV_BLOCKS;
  if (!isnan(l->begun) && l->nblocks < LAG_LYAPUNOV_BLOCKS && l->t - l->block_from >= whole / 2) close_block(l);
}

/* Mean rate of growth i, or for i = k of all, until t. */
static double mean_rate(const Lyapunov *l, const double *sum, int i, double t) {
  double s = 0;
  for (int a = 0; a < l->k; a++) s += a == i || i == l->k ? sum[a] : 0;
  return t > l->begun ? s / (t - l->begun) : NAN;
}

double lag_lyapunov_exponent(const Lyapunov *l, int i) { return mean_rate(l, l->sum, i, l->t); }

double lag_lyapunov_at_half(const Lyapunov *l, int i) {
  return isnan(l->half) ? 0 : mean_rate(l, l->at_half, i, l->half);
}

/* Whether exponent i, or for i = k their sum, is minus infinity: a slide has joined neighbouring motions. */
static int is_infinite(const Lyapunov *l, int i) { return mean_rate(l, l->sum, i, l->t) == -HUGE_VAL; }

double lag_lyapunov_spread(const Lyapunov *l, int i) {
  if (is_infinite(l, i)) return 0;
  double mean = 0, square = 0;
  int n = l->nblocks;
  for (int b = 0; b < n; b++) mean += l->block[b * (l->k + 1) + i] / n;
  for (int b = 0; b < n; b++) {
    double d = l->block[b * (l->k + 1) + i] - mean;
    square += d * d;
  }
  return n > 1 ? sqrt(square / (n - 1) / n) : NAN;
}

double lag_lyapunov_divergence(const Lyapunov *l) { return l->t > l->begun ? l->divergence / (l->t - l->begun) : NAN; }

double lag_lyapunov_error(const Lyapunov *l, int i) {
  if (is_infinite(l, i)) return 0;
  double time = l->t - l->begun, moved = fabs(lag_lyapunov_exponent(l, i) - lag_lyapunov_at_half(l, i));
  return time > 0 ? fmax(fmax(moved, lag_lyapunov_spread(l, i)), fmax(1, DBL_EPSILON * (double)l->steps) / time) : NAN;
}

int lag_lyapunov_sign(const Lyapunov *l, int i) {
  const double errors = 3;
  double x = lag_lyapunov_exponent(l, i), least = errors * lag_lyapunov_error(l, i);
  return (x > least) - (x < -least);
}

double lag_lyapunov_entropy(const Lyapunov *l, double *error) {
  double sum = 0;
  *error = 0;
  for (int i = 0; i < l->k && lag_lyapunov_sign(l, i) >= 0; i++) {
    sum += lag_lyapunov_sign(l, i) > 0 ? lag_lyapunov_exponent(l, i) : 0;
    *error += lag_lyapunov_error(l, i);
  }
  return sum;
}

double lag_lyapunov_dimension(const Lyapunov *l, double *error) {
  double sum = 0, lost = 0;
  *error = NAN;
  if (l->k < l->d || lag_lyapunov_sign(l, l->k) >= 0) return NAN;
  for (int i = 0; i < l->k; i++) {
    double x = lag_lyapunov_sign(l, i) ? lag_lyapunov_exponent(l, i) : 0, off = lag_lyapunov_error(l, i);
    if (sum + x < 0) {
      *error = (lost + sum / fabs(x) * off) / fabs(x);
      return i + sum / fabs(x);
    }
    sum += x;
    lost += off;
  }
  return NAN; /* all are 0 within their errors, and their sum is not */
}
