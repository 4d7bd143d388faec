/* Mass, damping and stiffness matrices at a state of rest, the noise of each entry, and the signature of the energy. */
#include "analysis/matrices.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "analysis/perturbation_noise.h"

/* ---- Entries */

/* noise[count] := at least the changes of values when the root moves to four corners of its uncertainty. */
static void add_spread(Equilibrium *r, lag_values *values, size_t count, const double *base, double *noise, double *scratch) {
  double *at = scratch + count;
  for (int corner = 0; corner < 4; corner++) {
    for (int i = 0; i < r->n; i++) {
      double sign = (corner & 1 ? -1 : 1) * (corner & 2 && i % 2 ? -1 : 1);
      at[i] = r->x[i] + sign * r->spread[i];
    }
    if (values(r, at, scratch) || lag_not_finite((int)count, scratch) >= 0) continue;
    for (size_t i = 0; i < count; i++) noise[i] = fmax(noise[i], fabs(scratch[i] - base[i]));
  }
}

/* Values at the state at rest and their noise: of the model's numbers, of the values themselves, and of the state. */
static int with_noise(Pool *pool, Equilibrium *r, lag_values *values, size_t count, double **base, double **noise) {
  size_t more = (size_t)(r->sim->pb.model->np + r->sim->pb.model->nderived) + (size_t)r->n;
  double *scratch = lag_pool_doubles(pool, count + more);
  *base = lag_pool_doubles(pool, count);
  *noise = lag_pool_doubles(pool, count);
  if (pool->failed) return LAG_ENOMEM;
  int rc = lag_perturbation_noise(r, values, r->x, count, *base, *noise, scratch);
  if (rc) return rc;
  for (size_t i = 0; i < count; i++) (*noise)[i] += DBL_EPSILON * fabs((*base)[i]);
  add_spread(r, values, count, *base, *noise, scratch);
  lag_equilibrium_state(r, r->x);
  return LAG_OK;
}

/* out := dr, then M. */
static int linearisation(Equilibrium *r, const double *x, double *out) {
  size_t rows = (size_t)r->n * (size_t)r->sim->pb.n;
  lag_equilibrium_state(r, x);
  return lag_linearise(&r->sim->pb, r->sim->run->t, r->y, NULL, out, out + rows, r->work);
}

static int jacobian(Equilibrium *r, const double *x, double *A) {
  lag_problem *pb = &r->sim->pb;
  lag_equilibrium_state(r, x);
  memset(A, 0, (size_t)pb->nq * (size_t)pb->n * sizeof *A);
  for (int i = 0; i < pb->nq; i++) A[i * pb->n + pb->nq + i] = 1;
  return lag_jacobian(pb, r->sim->run->t, r->y, A + pb->nq * pb->n, r->work);
}

int lag_state_matrix(Pool *pool, Equilibrium *rest, double **A, double **noise) {
  size_t n = (size_t)rest->sim->pb.n;
  return with_noise(pool, rest, jacobian, n * n, A, noise);
}

static double row_size(const double *row, int n) {
  double most = 0;
  for (int i = 0; i < n; i++) most = fmax(most, fabs(row[i]));
  return most;
}

/* K, C, M := entries divided by the weights of row and column. */
static void divide_by_weights(Matrices *m, int ny, const double *dr, double *K, double *C, double *M) {
  int nq = m->nq;
  const double *mass = dr + (size_t)(ny - nq) * (size_t)ny;
  for (int i = 0; i < nq; i++)
    for (int j = 0; j < nq; j++) {
      double d = m->weight[i] * m->weight[j];
      K[i * nq + j] = -dr[i * ny + j] / d;
      C[i * nq + j] = -dr[i * ny + nq + j] / d;
      M[i * nq + j] = mass[i * nq + j] / d;
    }
}

/* Whether K is symmetric, and C zero, to rounding. */
static void classify(Matrices *m) {
  int nq = m->nq;
  m->symmetric = m->undamped = 1;
  for (int i = 0; i < nq; i++)
    for (int j = 0; j < nq; j++) {
      int a = i * nq + j, b = j * nq + i;
      double size = fmin(row_size(m->K + i * nq, nq), row_size(m->K + j * nq, nq));
      m->symmetric &= fabs(m->K[a] - m->K[b]) <= 8 * (fabs(m->noise_K[a]) + fabs(m->noise_K[b])) + 1e-13 * size;
      m->undamped &= fabs(m->C[a]) <= 8 * fabs(m->noise_C[a]) + 4 * DBL_EPSILON * sqrt(size);
    }
}

static int entries(Matrices *m, Pool *pool, Equilibrium *r) {
  int nq = m->nq, ny = r->sim->pb.n;
  size_t nn = (size_t)nq * (size_t)nq, rows = (size_t)r->n * (size_t)ny;
  double **const parts[] = {&m->K, &m->C, &m->M, &m->noise_K, &m->noise_C, &m->noise_M}, *values, *noise;
  int rc = with_noise(pool, r, linearisation, rows + nn, &values, &noise);
  m->weight = lag_pool_doubles(pool, (size_t)nq);
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) *parts[i] = lag_pool_doubles(pool, nn);
  if (rc || pool->failed) return rc ? rc : LAG_ENOMEM;
  const double *M = values + rows;
  m->definite = 1;
  for (int i = 0; i < nq; i++) {
    double own = M[i * nq + i], size = row_size(M + i * nq, nq);
    m->definite &= own > 0;
    m->weight[i] = own > 0 ? sqrt(own) : size > 0 ? sqrt(size) : 1;
  }
  divide_by_weights(m, ny, values, m->K, m->C, m->M);
  divide_by_weights(m, ny, noise, m->noise_K, m->noise_C, m->noise_M);
  classify(m);
  return LAG_OK;
}

/* ---- Signature */

/* Eigenvalue k by Rayleigh's quotient, whose error is the square of the vector's; zero[k]: its noise. */
static void settle_value(Matrices *m, int k) {
  int nq = m->nq;
  double top = 0, bottom = 0, of_K = 0, of_M = 0;
  for (int i = 0; i < nq; i++) {
    double x = m->vectors[i * nq + k];
    for (int j = 0; j < nq && x != 0.0; j++) {
      double xx = x * m->vectors[j * nq + k];
      int a = i * nq + j;
      top += xx * (m->K[a] + m->K[j * nq + i]) / 2;
      bottom += xx * m->M[a];
      of_K += fabs(xx * m->noise_K[a]);
      of_M += fabs(xx * m->noise_M[a]);
    }
  }
  m->values[k] = top / bottom;
  m->zero[k] = 2 * (of_K + fabs(m->values[k]) * of_M) / bottom;
}

/* Counts directions of falling and of constant energy; divides vectors by the weights. */
static void count_directions(Matrices *m) {
  int nq = m->nq;
  m->lowering = 0;
  for (int k = 0; k < nq; k++) {
    m->lowering += m->values[k] < -m->zero[k];
    m->flat += fabs(m->values[k]) <= m->zero[k];
    for (int i = 0; i < nq; i++) m->vectors[i * nq + k] /= m->weight[i];
  }
}

static int signature(Matrices *m, Pool *pool, const lag_algebra *algebra) {
  size_t nq = (size_t)m->nq, bytes = nq * nq * sizeof(double);
  double *K = lag_pool_doubles(pool, nq * nq), *M = lag_pool_doubles(pool, nq * nq);
  m->values = lag_pool_doubles(pool, nq);
  m->zero = lag_pool_doubles(pool, nq);
  m->vectors = lag_pool_doubles(pool, nq * nq);
  if (pool->failed) return LAG_ENOMEM;
  memcpy(K, m->K, bytes);
  memcpy(M, m->M, bytes);
  int rc = algebra->symmetric(m->nq, K, M, m->values, m->vectors);
  for (int k = 0; k < m->nq && rc == LAG_OK; k++) settle_value(m, k);
  if (rc == LAG_OK) count_directions(m);
  m->definite &= rc != LAG_EINVAL;
  return rc == LAG_EINVAL ? LAG_OK : rc;
}

int lag_matrices_find(Matrices *m, Pool *pool, Equilibrium *rest, const lag_algebra *algebra) {
  *m = (Matrices){.nq = rest->sim->pb.nq, .lowering = -1};
  int rc = entries(m, pool, rest);
  return rc || !m->symmetric || !m->definite || m->nq == 0 ? rc : signature(m, pool, algebra);
}
