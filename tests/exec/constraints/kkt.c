/* lag_kkt.h against GSL: random systems [M -A^T; A 0] [x; l] = [f; g], with constraints that are independent,
 * redundant, nearly so, badly scaled, or zero, M definite, indefinite, or singular where A fixes what it leaves
 * open; with coordinates in units that are up to 1e12 apart, which change neither the motion nor the multipliers.
 * Expected: the solution of least norm in l by the singular value decomposition of the whole matrix, in one unit.
 * Those of which M is singular on the kernel of A are refused. Prints the largest differences; exit status 1 when
 * one is too large. */
#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lag_kkt.h"

enum { N = 7, M = 5, MAX = 600 };
enum { PLAIN, REDUNDANT, SCALED, ZERO, INDEFINITE, SINGULAR, PERMUTED, SLACK, KINDS };
static const char *const names[] = {
    "independent",  "redundant",  "redundant, scaled by 1e-3 to 1e3", "with a zero row",
    "indefinite M", "singular M", "redundant, in another order",      "redundant, singular M"};

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
  if (kind == SINGULAR || kind == SLACK) { /* the first coordinate has no inertia; constraint 0 moves it */
    for (int i = 0; i < N; i++) s->m[i] = s->m[i * N] = 0;
    s->a[0] = 2;
  }
  for (int j = 3; j < M && (kind == REDUNDANT || kind == SCALED || kind == PERMUTED || kind == SLACK); j++) {
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

/* The same with coordinate i in a unit of which unit[i] are one of before. */
static void change_units(System *s, const double *unit)
{
  for (int i = 0; i < N; i++) {
    for (int j = 0; j < N; j++) s->m[i * N + j] /= unit[i] * unit[j];
    for (int j = 0; j < M; j++) s->a[j * N + i] /= unit[i];
    s->f[i] /= unit[i];
  }
}

/* Whether M is regular on the kernel of A. */
static int ours(const System *s, double *x, double *l)
{
  static double w[MAX];

  memcpy(w, s->m, sizeof s->m);
  memcpy(w + N * N, s->a, sizeof s->a);
  memcpy(w + N * N + M * N, s->f, sizeof s->f);
  memcpy(w + N * N + M * N + N, s->g, sizeof s->g);
  int regular = lag_kkt(N, M, 0, w);
  memcpy(x, w + N * N + M * N, N * sizeof *x);
  memcpy(l, w + N * N + M * N + N, M * sizeof *l);
  return regular;
}

/* x from the decomposition of the whole matrix, scaled so that its rank can be seen; l of least norm from that of
 * A^T, A^T l = M x - f. */
static void by_svd(const System *s, double *x, double *l)
{
  gsl_matrix *k = gsl_matrix_calloc(N + M, N + M), *v = gsl_matrix_alloc(N + M, N + M), *t = gsl_matrix_alloc(N, M),
             *tv = gsl_matrix_alloc(M, M);
  gsl_vector *d = gsl_vector_alloc(N + M), *w = gsl_vector_alloc(N + M), *b = gsl_vector_alloc(N + M),
             *y = gsl_vector_alloc(N + M);
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
  gsl_vector_free(d), gsl_vector_free(w), gsl_vector_free(b), gsl_vector_free(y), gsl_vector_free(td),
      gsl_vector_free(tw), gsl_vector_free(r), gsl_vector_free(lv);
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

/* The solution in the order and in the units of s: with the last constraint first, and other units. */
static int another_way(const System *s, int permuted, const double *unit, double *x, double *l)
{
  System r = *s;
  double back[M];

  for (int j = 0; j < M && permuted; j++) {
    memcpy(r.a + j * N, s->a + (M - 1 - j) * N, N * sizeof(double));
    r.g[j] = s->g[M - 1 - j];
  }
  change_units(&r, unit);
  int regular = ours(&r, x, back);
  for (int i = 0; i < N; i++) x[i] /= unit[i];
  for (int j = 0; j < M; j++) l[j] = back[permuted ? M - 1 - j : j];
  return regular;
}

/* Some of TIMES systems are not solved as the decomposition does. apart: powers of ten between units. */
static int differ(int kind, double apart)
{
  enum { TIMES = 300 };
  double most_x = 0, most_l = 0;
  int refused = 0;

  for (int n = 0; n < TIMES; n++) {
    System s;
    double x[N], l[M], x0[N], l0[M], unit[N];
    make(&s, kind);
    by_svd(&s, x0, l0);
    for (int i = 0; i < N; i++) unit[i] = apart > 0 ? pow(10, apart / 2 * next()) : 1;
    refused += !another_way(&s, kind == PERMUTED, unit, x, l);
    most_x = fmax(most_x, difference(N, x, x0));
    most_l = fmax(most_l, difference(M, l, l0));
  }
  /* Both round to 1e-16 times the condition of the system, which is 1e3 to 1e5 among these. */
  printf("%s, units 1e%g apart: x %.1e, l %.1e, %d refused\n", names[kind], apart, most_x, most_l, refused);
  return !(most_x < 1e-10) || !(most_l < 1e-10) || refused > 0;
}

/* x[N] without what it has along rows[r], which are orthonormal, and of length 1; returns how long it was. */
static double length_of_rest(int r, const double *rows, double *x)
{
  double length = 0;

  for (int k = 0; k < 2 * r; k++) { /* twice, so that rounding is gone */
    double along = 0;
    for (int i = 0; i < N; i++) along += rows[k % r * N + i] * x[i];
    for (int i = 0; i < N; i++) x[i] -= along * rows[k % r * N + i];
  }
  for (int i = 0; i < N; i++) length = hypot(length, x[i]);
  for (int i = 0; i < N && length > 0; i++) x[i] /= length;
  return length;
}

/* M of s gains what makes its inertia along one direction z of the kernel of A be `left` alone, against all of the
 * kernel. Q is the projector on the kernel. */
static void make_slack(System *s, double left)
{
  double rows[M * N], z[N], u[N], mz[N], zu = 0;
  int r = 0;

  for (int j = 0; j < M; j++) {
    double *row = rows + r * N, size = 0;
    memcpy(row, s->a + j * N, N * sizeof(double));
    for (int i = 0; i < N; i++) size = fmax(size, fabs(row[i]));
    r += length_of_rest(r, rows, row) > 1e-10 * size;
  }
  for (int i = 0; i < N; i++) z[i] = next();
  length_of_rest(r, rows, z);
  for (int i = 0; i < N; i++) {
    mz[i] = 0;
    for (int j = 0; j < N; j++) mz[i] += s->m[i * N + j] * z[j];
    u[i] = mz[i];
  }
  double size = length_of_rest(r, rows, u);
  for (int i = 0; i < N; i++) u[i] *= size, zu += u[i] * z[i];
  for (int i = 0; i < N; i++)
    for (int j = 0; j < N; j++) s->m[i * N + j] += (zu + left) * z[i] * z[j] - u[i] * z[j] - z[i] * u[j];
}

/* Of systems without inertia along a direction that constraints leave free, but for rounding, one is solved; or one
 * is refused, or solved badly, of which the inertia there is 1e-8. */
static int takes_slack(int kind, double apart)
{
  enum { TIMES = 300 };
  double most_x = 0;
  int solved = 0, refused = 0;

  for (int n = 0; n < TIMES; n++) {
    System s, weak;
    double x[N], l[M], x0[N], l0[M], unit[N];
    make(&s, kind);
    for (int i = 0; i < N; i++) unit[i] = apart > 0 ? pow(10, apart / 2 * next()) : 1;
    unsigned long long was = seed;
    weak = s;
    make_slack(&s, 0);
    solved += another_way(&s, kind == PERMUTED, unit, x, l);
    seed = was;
    make_slack(&weak, 1e-8);
    by_svd(&weak, x0, l0);
    refused += !another_way(&weak, kind == PERMUTED, unit, x, l);
    most_x = fmax(most_x, difference(N, x, x0));
  }
  printf("%s, units 1e%g apart, without inertia: %d solved; with 1e-8: %d refused, x %.1e\n", names[kind], apart,
         solved, refused, most_x);
  return solved > 0 || refused > 0 || !(most_x < 1e-5); /* 1e-16 times the condition, of up to 1e11 */
}

int main(void)
{
  int bad = 0;

  for (int kind = 0; kind < KINDS; kind++) {
    bad |= differ(kind, 0);
    bad |= differ(kind, 24);
    bad |= takes_slack(kind, 0);
    bad |= takes_slack(kind, 24);
  }
  return bad;
}
