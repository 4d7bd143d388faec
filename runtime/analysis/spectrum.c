/* Eigenvalues by deflation of zeros and clusters. Zeros are deflated first: an orthogonal Q with A Q = [B | 0] makes Q'A Q block triangular, and
 * the rest may have zeros again where 0 is defective (the staircase of V.N. Kublanovskaya, USSR Comput. Math. Math. Phys. 6 (1966) 1, DOI
 * 10.1016/0041-5553(66)90031-1; G. Golub, J. Wilkinson, SIAM Rev. 18 (1976) 578, DOI 10.1137/1018113). Other eigenvalues that lie within each
 * other's uncertainty (J. Wilkinson, The Algebraic Eigenvalue Problem, 1965, chapter 2: error times sensitivity) are replaced by their mean,
 * which is well determined where they are not. */
#include "analysis/spectrum.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { MOST_STAGES = 8 };

/* One deflation: of a matrix of m rows the upper left block of `rank` rows is left; C[(m - rank) * rank] stands below it. */
typedef struct Stage {
  int m, rank;
  double *Q, *C;
} Stage;

typedef struct SpectrumSearch {
  Spectrum *s;
  Pool *pool;
  const lag_algebra *algebra;
  double *A;    /* [m * m], the matrix after deflation */
  double *scale; /* [n] scales of balancing */
  double size;  /* norm of the balanced matrix */
  double noise; /* norm of its noise */
  int m;
  Stage stage[MOST_STAGES];
  int nstages;
} SpectrumSearch;

static double frobenius(int n, const double *A) {
  double sum = 0;
  for (int i = 0; i < n * n; i++) sum += A[i] * A[i];
  return sqrt(sum);
}

/* ---- Zeros */

/* B := Q'A Q of m rows. */
static int rotate(SpectrumSearch *w, const double *Q, double *B) {
  int m = w->m;
  double *AQ = lag_pool_doubles(w->pool, (size_t)m * (size_t)m);
  if (!AQ) return LAG_ENOMEM;
  for (int i = 0; i < m; i++)
    for (int k = 0; k < m; k++)
      for (int j = 0; j < m && w->A[i * m + k] != 0.0; j++) AQ[i * m + j] += w->A[i * m + k] * Q[k * m + j];
  for (int k = 0; k < m; k++)
    for (int i = 0; i < m; i++)
      for (int j = 0; j < m && Q[k * m + i] != 0.0; j++) B[i * m + j] += Q[k * m + i] * AQ[k * m + j];
  return LAG_OK;
}

/* Deflates the kernel; *more = 0 when there is none. */
static int deflate(SpectrumSearch *w, int *more) {
  int m = w->m, rank = m;
  size_t mm = (size_t)m * (size_t)m;
  double *Q = lag_pool_doubles(w->pool, mm);
  int rc = Q ? w->algebra->kernel(m, w->A, 8 * sqrt(m) * w->noise, Q, &rank) : LAG_ENOMEM;
  *more = rc == LAG_OK && rank < m;
  if (!*more) return rc;
  double *B = lag_pool_doubles(w->pool, mm), *rest = lag_pool_doubles(w->pool, mm), *C = lag_pool_doubles(w->pool, mm);
  if (w->pool->failed || (rc = rotate(w, Q, B)) != 0) return LAG_ENOMEM;
  for (int i = 0; i < m; i++) memcpy(i < rank ? rest + i * rank : C + (i - rank) * rank, B + i * m, (size_t)rank * sizeof(double));
  w->stage[w->nstages++] = (Stage){m, rank, Q, C};
  w->s->zeros += m - rank;
  w->A = rest;
  w->m = rank;
  return LAG_OK;
}

static int take_zeros(SpectrumSearch *w) {
  Spectrum *s = w->s;
  int more = 1, rc = LAG_OK;
  while (rc == LAG_OK && more && w->m > 0 && w->nstages < MOST_STAGES) rc = deflate(w, &more);
  if (rc || w->nstages == 0) return rc;
  const Stage *first = &w->stage[0];
  s->nkernel = s->n - first->rank;
  s->kernel = lag_pool_doubles(w->pool, (size_t)s->n * (size_t)s->nkernel);
  for (int i = 0; i < s->n && s->kernel; i++)
    for (int k = 0; k < s->nkernel; k++) s->kernel[i * s->nkernel + k] = w->scale[i] * first->Q[i * s->n + first->rank + k];
  return s->kernel ? LAG_OK : LAG_ENOMEM;
}

/* ---- Multiple eigenvalues */

/* cluster[i] := the first eigenvalue of the cluster of eigenvalue i. Close ones are joined until nothing changes. */
static void find_clusters(int m, const double *re, const double *im, const double *uncertain, double *cluster) {
  int changed = 1;
  for (int i = 0; i < m; i++) cluster[i] = i;
  while (changed) {
    changed = 0;
    for (int i = 0; i < m; i++)
      for (int j = 0; j < i; j++) {
        double distance = hypot(re[i] - re[j], im[i] - im[j]);
        if (cluster[i] != cluster[j] && distance <= fmin(uncertain[i], uncertain[j])) {
          cluster[i] = cluster[j] = fmin(cluster[i], cluster[j]);
          changed = 1;
        }
      }
  }
}

/* *count := number of eigenvectors of the eigenvalue re + i im: the kernel of A - re - i im as a real matrix of 2m rows. */
static int eigenvectors(SpectrumSearch *w, double re, double im, int *count) {
  int m = w->m, m2 = 2 * m, rank = m2;
  double *E = lag_pool_doubles(w->pool, 4 * (size_t)m * (size_t)m), *Q = lag_pool_doubles(w->pool, 4 * (size_t)m * (size_t)m);
  if (w->pool->failed) return LAG_ENOMEM;
  for (int i = 0; i < m; i++) {
    for (int j = 0; j < m; j++) {
      double x = w->A[i * m + j] - (i == j ? re : 0);
      E[i * m2 + j] = E[(m + i) * m2 + m + j] = x;
    }
    E[i * m2 + m + i] = im;
    E[(m + i) * m2 + i] = -im;
  }
  int rc = w->algebra->kernel(m2, E, 1e-8 * w->size, Q, &rank);
  *count = (m2 - rank) / 2;
  return rc;
}

/* Replaces the members of a cluster by their mean; repeats := their number where eigenvectors are missing. */
static int settle_cluster(SpectrumSearch *w, int first, const double *cluster, double *uncertain) {
  Spectrum *s = w->s;
  double re = 0, im = 0;
  int members = 0, found = 0;
  for (int i = 0; i < w->m; i++)
    if ((int)cluster[i] == first) {
      members++;
      re += s->re[i];
      im += s->im[i];
    }
  if (members < 2) return LAG_OK;
  re /= members;
  im /= members;
  int rc = eigenvectors(w, re, im, &found);
  for (int i = 0; i < w->m; i++)
    if ((int)cluster[i] == first) {
      s->re[i] = re;
      s->im[i] = im;
      s->repeats[i] = found < members ? members : 1;
      uncertain[i] = fmax(1e-11 * w->size, w->noise); /* error of a mean: far above rounding, far below the distances of the members */
    }
  return rc;
}

/* ---- All of them */

static int solve(SpectrumSearch *w) {
  Spectrum *s = w->s;
  size_t m = (size_t)w->m;
  double *A = lag_pool_doubles(w->pool, m * m), *uncertain = lag_pool_doubles(w->pool, m), *cluster = lag_pool_doubles(w->pool, m);
  if (w->pool->failed) return LAG_ENOMEM;
  memcpy(A, w->A, m * m * sizeof *A);
  int rc = w->algebra->general(w->m, A, s->re, s->im, s->vre, s->vim, uncertain);
  for (size_t i = 0; i < m; i++) {
    uncertain[i] = fmin(8 * uncertain[i] * w->noise, 1e-3 * w->size);
    s->repeats[i] = 1;
  }
  if (rc == LAG_OK) find_clusters(w->m, s->re, s->im, uncertain, cluster);
  for (int i = 0; i < w->m && rc == LAG_OK; i++) rc = (int)cluster[i] == i ? settle_cluster(w, i, cluster, uncertain) : LAG_OK;
  for (size_t i = 0; i < m; i++) {
    s->re[i] = fabs(s->re[i]) <= uncertain[i] ? 0 : s->re[i];
    s->im[i] = fabs(s->im[i]) <= uncertain[i] ? 0 : s->im[i];
  }
  return rc;
}

/* Eigenvector k of the stage's matrix from that of its block: x[m] := Q [x; C x/lambda], in place. */
static int extend_eigenvector(SpectrumSearch *w, const Stage *st, int k) {
  Spectrum *s = w->s;
  double l2 = s->re[k] * s->re[k] + s->im[k] * s->im[k], *x = lag_pool_doubles(w->pool, 4 * (size_t)st->m);
  double *y = x + 2 * st->m;
  if (!x) return LAG_ENOMEM;
  for (int i = 0; i < st->m; i++) {
    double re = 0, im = 0;
    if (i < st->rank) {
      x[2 * i] = s->vre[i * s->count + k];
      x[2 * i + 1] = s->vim[i * s->count + k];
      continue;
    }
    for (int j = 0; j < st->rank; j++) {
      re += st->C[(i - st->rank) * st->rank + j] * x[2 * j];
      im += st->C[(i - st->rank) * st->rank + j] * x[2 * j + 1];
    }
    x[2 * i] = l2 > 0 ? (re * s->re[k] + im * s->im[k]) / l2 : 0; /* eigenvalue 0, to rounding: the vector is not determined */
    x[2 * i + 1] = l2 > 0 ? (im * s->re[k] - re * s->im[k]) / l2 : 0;
  }
  for (int i = 0; i < st->m; i++) {
    for (int j = 0; j < st->m; j++) {
      y[2 * i] += st->Q[i * st->m + j] * x[2 * j];
      y[2 * i + 1] += st->Q[i * st->m + j] * x[2 * j + 1];
    }
    s->vre[i * s->count + k] = y[2 * i];
    s->vim[i * s->count + k] = y[2 * i + 1];
  }
  return LAG_OK;
}

/* Extends eigenvectors of the deflated matrix to those of the whole, and undoes balancing. */
static int extend_eigenvectors(SpectrumSearch *w) {
  Spectrum *s = w->s;
  int rc = LAG_OK;
  for (int k = 0; k < s->count; k++) {
    for (int i = w->nstages; i-- > 0 && rc == LAG_OK;) rc = extend_eigenvector(w, &w->stage[i], k);
    for (int i = 0; i < s->n; i++) {
      s->vre[i * s->count + k] *= w->scale[i];
      s->vim[i * s->count + k] *= w->scale[i];
    }
  }
  return rc;
}

/* Allocates room for the eigenvalues of the deflated matrix. */
static int allocate(SpectrumSearch *w) {
  Spectrum *s = w->s;
  size_t count = (size_t)w->m, size = (size_t)s->n * count;
  s->count = w->m;
  s->re = lag_pool_doubles(w->pool, count);
  s->im = lag_pool_doubles(w->pool, count);
  s->repeats = lag_pool_doubles(w->pool, count);
  s->vre = lag_pool_doubles(w->pool, size);
  s->vim = lag_pool_doubles(w->pool, size);
  return w->pool->failed ? LAG_ENOMEM : LAG_OK;
}

/* A := D^-1 A D, and noise likewise, with the D that balances the terms of the entries. */
static int balance(SpectrumSearch *w, int n, double *A, double *noise) {
  double *terms = lag_pool_doubles(w->pool, (size_t)n * (size_t)n);
  for (int i = 0; i < n * n && terms; i++) terms[i] = fmax(fabs(A[i]), noise[i] / DBL_EPSILON);
  int rc = terms ? w->algebra->balance(n, terms, w->scale) : LAG_ENOMEM;
  for (int i = 0; i < n * n && rc == LAG_OK; i++) {
    double d = w->scale[i % n] / w->scale[i / n];
    A[i] *= d;
    noise[i] *= d;
  }
  return rc;
}

int lag_spectrum(Spectrum *s, Pool *pool, const lag_algebra *algebra, int n, double *A, double *noise) {
  SpectrumSearch w = {.s = s, .pool = pool, .algebra = algebra, .A = A, .m = n};
  *s = (Spectrum){.n = n};
  w.scale = lag_pool_doubles(pool, (size_t)n);
  int rc = w.scale ? balance(&w, n, A, noise) : LAG_ENOMEM;
  if (rc) return rc;
  w.size = frobenius(n, A);
  w.noise = fmax(DBL_EPSILON * w.size, frobenius(n, noise));
  rc = take_zeros(&w);
  rc = rc ? rc : allocate(&w);
  rc = rc || w.m == 0 ? rc : solve(&w);
  return rc ? rc : extend_eigenvectors(&w);
}
