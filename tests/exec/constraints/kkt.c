/* lag_kkt.h against GSL: random systems [M -A^T; A 0] [x; l] = [f; g], with constraints that are independent, redundant, nearly so, badly
 * scaled, or zero, M definite, indefinite, or singular where A fixes what it leaves open. Expected: the solution of least norm in l by
 * the singular value decomposition of the whole matrix. Prints the largest differences; exit status 1 when one is too large. */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lag_kkt.h"

enum { N = 7, M = 5, MAX = 400 };
enum { PLAIN, REDUNDANT, SCALED, ZERO, INDEFINITE, SINGULAR, PERMUTED, KINDS };
static const char *const names[] = {"independent", "redundant", "redundant, scaled by 1e-3 to 1e3", "with a zero row", "indefinite M", "singular M", "redundant, in another order"};

static unsigned long long seed = 42;
static double next(void)
{
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (double)(seed >> 11) / 9007199254740992.0 * 2 - 1;
}

typedef struct System {
  double m[N * N], a[M * N], f[N], g[M];
} System;

static void make(System *s, int kind)
{
  double b[N * N];
  int definite = kind != INDEFINITE;

  for (int i = 0; i < N * N; i++) b[i] = next();
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) {
      double sum = 0;
      for (int k = 0; k < N; k++) sum += (definite || k % 2 ? 1 : -1) * b[i * N + k] * b[j * N + k];
      s->m[i * N + j] = sum + (i == j && definite);
    }
  for (int i = 0; i < M * N; i++) s->a[i] = next();
  for (int i = 0; i < N; i++) s->f[i] = next();
  for (int i = 0; i < M; i++) s->g[i] = next();
  if (kind == SINGULAR) { /* the first coordinate has no inertia; constraint 0 moves it */
    for (int i = 0; i < N; i++) s->m[i] = s->m[i * N] = 0;
    s->a[0] = 2;
  }
  for (int j = 3; j < M && (kind == REDUNDANT || kind == SCALED || kind == PERMUTED); j++) {
    double c0 = next(), c1 = next();
    for (int i = 0; i < N; i++) s->a[j * N + i] = c0 * s->a[i] + c1 * s->a[N + i];
    s->g[j] = c0 * s->g[0] + c1 * s->g[1];
  }
  if (kind == ZERO) {
    memset(s->a + 2 * N, 0, N * sizeof(double));
    s->g[2] = 0;
  }
  for (int j = 0; j < M && kind == SCALED; j++) {
    double scale = pow(10, 1.5 * j - 3);
    for (int i = 0; i < N; i++) s->a[j * N + i] *= scale;
    s->g[j] *= scale;
  }
}

static void ours(const System *s, double *x, double *l)
{
  static double w[MAX];

  memcpy(w, s->m, sizeof s->m);
  memcpy(w + N * N, s->a, sizeof s->a);
  memcpy(w + N * N + M * N, s->f, sizeof s->f);
  memcpy(w + N * N + M * N + N, s->g, sizeof s->g);
  if (!lag_kkt(N, M, 0, w)) printf("refused\n");
  memcpy(x, w + N * N + M * N, N * sizeof *x);
  memcpy(l, w + N * N + M * N + N, M * sizeof *l);
}

/* x from the decomposition of the whole matrix, scaled so that its rank can be seen; l of least norm from that of A^T, A^T l = M x - f. */
static void by_svd(const System *s, double *x, double *l)
{
  gsl_matrix *k = gsl_matrix_calloc(N + M, N + M), *v = gsl_matrix_alloc(N + M, N + M), *t = gsl_matrix_alloc(N, M), *tv = gsl_matrix_alloc(M, M);
  gsl_vector *d = gsl_vector_alloc(N + M), *w = gsl_vector_alloc(N + M), *b = gsl_vector_alloc(N + M), *y = gsl_vector_alloc(N + M);
  gsl_vector *td = gsl_vector_alloc(M), *tw = gsl_vector_alloc(M), *r = gsl_vector_alloc(N), *lv = gsl_vector_alloc(M);

  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) gsl_matrix_set(k, (size_t)i, (size_t)j, s->m[i * N + j]);
  for (int j = 0; j < M; j++) {
    double size = 0;
    for (int i = 0; i < N; i++) size = fmax(size, fabs(s->a[j * N + i]));
    size = size > 0 ? size : 1;
    for (int i = 0; i < N; i++) {
      gsl_matrix_set(k, (size_t)(N + j), (size_t)i, s->a[j * N + i] / size);
      gsl_matrix_set(k, (size_t)i, (size_t)(N + j), -s->a[j * N + i] / size);
      gsl_matrix_set(t, (size_t)i, (size_t)j, s->a[j * N + i]);
    }
    gsl_vector_set(b, (size_t)(N + j), s->g[j] / size);
  }
  for (int i = 0; i < N; i++) gsl_vector_set(b, (size_t)i, s->f[i]);
  gsl_linalg_SV_decomp(k, v, d, w);
  for (int i = 0; i < N + M; i++)
    if (gsl_vector_get(d, (size_t)i) < 1e-12 * gsl_vector_get(d, 0)) gsl_vector_set(d, (size_t)i, 0);
  gsl_linalg_SV_solve(k, v, d, b, y);
  for (int i = 0; i < N; i++) {
    double sum = -s->f[i];
    x[i] = gsl_vector_get(y, (size_t)i);
    for (int j = 0; j < N; j++) sum += s->m[i * N + j] * gsl_vector_get(y, (size_t)j);
    gsl_vector_set(r, (size_t)i, sum);
  }
  gsl_linalg_SV_decomp(t, tv, td, tw);
  for (int i = 0; i < M; i++)
    if (gsl_vector_get(td, (size_t)i) < 1e-15 * gsl_vector_get(td, 0)) gsl_vector_set(td, (size_t)i, 0);
  gsl_linalg_SV_solve(t, tv, td, r, lv);
  for (int j = 0; j < M; j++) l[j] = gsl_vector_get(lv, (size_t)j);
  gsl_matrix_free(k), gsl_matrix_free(v), gsl_matrix_free(t), gsl_matrix_free(tv);
  gsl_vector_free(d), gsl_vector_free(w), gsl_vector_free(b), gsl_vector_free(y), gsl_vector_free(td), gsl_vector_free(tw), gsl_vector_free(r), gsl_vector_free(lv);
}

static double difference(int n, const double *a, const double *b)
{
  double most = 0, size = 0;

  for (int i = 0; i < n; i++) {
    most = fmax(most, isfinite(a[i]) ? fabs(a[i] - b[i]) : HUGE_VAL);
    size = fmax(size, fabs(b[i]));
  }
  return most / size;
}

int main(void)
{
  enum { TIMES = 300 };
  int bad = 0;

  for (int kind = 0; kind < KINDS; kind++) {
    double most_x = 0, most_l = 0;
    for (int n = 0; n < TIMES; n++) {
      System s;
      double x[N], l[M], x0[N], l0[M];
      make(&s, kind);
      by_svd(&s, x0, l0);
      if (kind == PERMUTED) { /* the last constraint first */
        System r = s;
        for (int j = 0; j < M; j++) {
          memcpy(r.a + j * N, s.a + (M - 1 - j) * N, N * sizeof(double));
          r.g[j] = s.g[M - 1 - j];
        }
        double back[M];
        ours(&r, x, back);
        for (int j = 0; j < M; j++) l[j] = back[M - 1 - j];
      } else {
        ours(&s, x, l);
      }
      most_x = fmax(most_x, difference(N, x, x0));
      most_l = fmax(most_l, difference(M, l, l0));
    }
    /* Both round to 1e-16 times the condition of the system, which is 1e3 to 1e5 among these. */
    printf("%s: x %.1e, l %.1e\n", names[kind], most_x, most_l);
    bad |= !(most_x < 1e-10) || !(most_l < 1e-10);
  }
  return bad;
}
