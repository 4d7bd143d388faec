/* Eigenvalues, their multiplicity and the kernel (spectrum.h). An eigenvalue is known up to the noise of the matrix
 * times its sensitivity (J. Wilkinson, The Algebraic Eigenvalue Problem, 1965, chapter 2). Eigenvalues within each
 * other's uncertainty are replaced by their mean, which is well determined where they are not; those within their
 * uncertainty of 0 are 0. */
#include "analysis/spectrum.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>

/* Sensitivity of a multiple eigenvalue above which it lacks eigenvectors: one that has all is some thousands at
 * most. */
static const double defective = 1e5;

static double frobenius(int n, const double *A) {
  double sum = lag_dot(n * n, A, A);
  return sqrt(sum);
}

/* cluster[i] := the first eigenvalue of the cluster of eigenvalue i. Close ones are joined until nothing changes. */
static void find_clusters(const Spectrum *s, const double *uncertain, double *cluster) {
  int changed = 1;
  for (int i = 0; i < s->n; i++) cluster[i] = i;
  while (changed) {
    changed = 0;
    for (int i = 0; i < s->n; i++)
      for (int j = 0; j < i; j++) {
        double distance = hypot(s->re[i] - s->re[j], s->im[i] - s->im[j]);
        if (cluster[i] != cluster[j] && distance <= fmin(uncertain[i], uncertain[j])) {
          cluster[i] = cluster[j] = fmin(cluster[i], cluster[j]);
          changed = 1;
        }
      }
  }
}

/* Replaces the members of a cluster by their mean, whose error is `error`; repeats := their number where
 * eigenvectors are missing. */
static void settle_cluster(Spectrum *s, int first, const double *cluster, const double *sensitivity, double error,
                           double *uncertain) {
  double re = 0, im = 0, most = 0;
  int members = 0;
  for (int i = 0; i < s->n; i++)
    if ((int)cluster[i] == first) {
      members++;
      re += s->re[i];
      im += s->im[i];
      most = fmax(most, sensitivity[i]);
    }
  for (int i = 0; i < s->n && members > 1; i++)
    if ((int)cluster[i] == first) {
      s->re[i] = re / members;
      s->im[i] = im / members;
      s->repeats[i] = most > defective ? members : 1;
      uncertain[i] = error;
    }
}

static double modulus(const Spectrum *s, int k) { return hypot(s->re[k], s->im[k]); }

/* Where A has a kernel: sets eigenvalues to 0 until there are as many zeros as it has vectors, the smallest first,
 * and moves the others to the front. */
static void separate_zeros(Spectrum *s) {
  int least = 0;
  for (int k = 0; k < s->n; k++) s->zeros += modulus(s, k) == 0.0;
  for (; s->zeros < s->nkernel; s->zeros++) {
    for (int k = 0; k < s->n; k++)
      if (modulus(s, k) > 0 && (modulus(s, least) == 0.0 || modulus(s, k) < modulus(s, least))) least = k;
    s->re[least] = s->im[least] = 0;
  }
  for (int k = 0; k < s->n; k++) {
    int to = s->count;
    if (s->nkernel > 0 && modulus(s, k) == 0.0) continue;
    s->re[to] = s->re[k];
    s->im[to] = s->im[k];
    s->repeats[to] = s->repeats[k];
    for (int i = 0; i < s->n; i++) {
      s->vre[i * s->n + to] = s->vre[i * s->n + k];
      s->vim[i * s->n + to] = s->vim[i * s->n + k];
    }
    s->count++;
  }
}

/* A := D^-1 A D, and noise likewise, with the D = diag(scale) that balances the terms of the entries. terms[n * n]
 * is scratch. */
static int balance(const lag_algebra *algebra, int n, double *A, double *noise, double *scale, double *terms) {
  for (int i = 0; i < n * n; i++) terms[i] = fmax(fabs(A[i]), noise[i] / DBL_EPSILON);
  int rc = algebra->balance(n, terms, scale);
  for (int i = 0; i < n * n && rc == LAG_OK; i++) {
    double d = scale[i % n] / scale[i / n];
    A[i] *= d;
    noise[i] *= d;
  }
  return rc;
}

int lag_spectrum(Spectrum *s, Pool *pool, const lag_algebra *algebra, int n, double *A, double *noise) {
  double *scale, *sensitivity, *uncertain, *cluster;
  double **const parts[] = {&scale, &sensitivity, &uncertain, &cluster, &s->re,
                            &s->im, &s->repeats,  &s->vre,    &s->vim,  &s->kernel};
  size_t size = (size_t)n;
  int rank = n;
  *s = (Spectrum){.n = n};
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++)
    *parts[i] = lag_pool_doubles(pool, i < 7 ? size : size * size);
  if (pool->failed) return LAG_ENOMEM;
  int rc = balance(algebra, n, A, noise, scale, s->kernel);
  double norm = frobenius(n, A), error = fmax(DBL_EPSILON * norm, frobenius(n, noise));
  rc = rc ? rc : algebra->kernel(n, A, 8 * sqrt(n) * error, s->kernel, &rank);
  rc = rc ? rc : algebra->general(n, A, s->re, s->im, s->vre, s->vim, sensitivity);
  if (rc) return rc;
  for (int k = 0; k < n; k++) {
    uncertain[k] = fmin(8 * sensitivity[k] * error, 1e-3 * norm);
    s->repeats[k] = 1;
  }
  find_clusters(s, uncertain, cluster);
  for (int k = 0; k < n; k++) /* error of a mean: far above rounding, far below the distances of the members */
    if ((int)cluster[k] == k) settle_cluster(s, k, cluster, sensitivity, fmax(1e-11 * norm, error), uncertain);
  for (int k = 0; k < n; k++) {
    s->re[k] = fabs(s->re[k]) <= uncertain[k] ? 0 : s->re[k];
    s->im[k] = fabs(s->im[k]) <= uncertain[k] ? 0 : s->im[k];
  }
  s->nkernel = n - rank;
  separate_zeros(s);
  for (int i = 0; i < n * n; i++) {
    s->vre[i] *= scale[i / n];
    s->vim[i] *= scale[i / n];
    s->kernel[i] *= scale[i / n];
  }
  return LAG_OK;
}

int lag_spectrum_first(const Spectrum *s, int k) {
  for (int i = 0; i < k && s->repeats[k] > 1; i++)
    if (s->re[i] == s->re[k] && s->im[i] == s->im[k]) return 0;
  return 1;
}
