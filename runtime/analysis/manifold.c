/* Stable and unstable manifolds (manifold.h). T. S. Parker, L. O. Chua, Practical Numerical Algorithms for Chaotic
 * Systems (1989), chapter 6. */
#include "analysis/manifold.h"

#include <math.h>
#include <string.h>

#include "numeric/dense.h"

static const double same = 1e-6; /* multipliers nearer to 1 belong to no manifold */

/* One start, from y along v, both in SI; units: of the length of v. */
static int add_start(Manifold *m, ManifoldStart like, int n, const double *y, const double *v, double part) {
  size_t size = (size_t)n, room = sizeof(ManifoldStart) / sizeof(double) + 1;
  ManifoldStart *s = (ManifoldStart *)(void *)lag_pool_doubles(&m->pool, room + 3 * size);
  if (!s) return LAG_ENOMEM;
  *s = like;
  s->y = (double *)(void *)s + room;
  s->at = memcpy(s->y + size, y, size * sizeof *y);
  s->v = memcpy(s->at + size, v, size * sizeof *v);
  for (int i = 0; i < n; i++) s->y[i] = y[i] + like.side * part * v[i];
  if (m->last) m->last->next = s;
  else m->first = s;
  m->last = s;
  return LAG_OK;
}

static int add_both(Manifold *m, ManifoldStart like, int n, const double *y, const double *v, double part) {
  like.side = 1;
  int rc = add_start(m, like, n, y, v, part);
  like.side = -1;
  return rc ? rc : add_start(m, like, n, y, v, part);
}

/* v[n] of length 1 in units. */
static void normalise(int n, const double *unit, double *v) {
  double size = 0;
  for (int i = 0; i < n; i++) size += v[i] / unit[i] * (v[i] / unit[i]);
  for (int i = 0; i < n && size > 0; i++) v[i] /= sqrt(size);
}

/* The side + of a direction: its first component that is not small is positive. */
static void orient(int n, const double *unit, double *v) {
  const double small = 1e-6;
  int i = 0;
  normalise(n, unit, v);
  while (i < n - 1 && fabs(v[i]) < small * unit[i]) i++;
  for (int j = 0; v[i] < 0 && j < n; j++) v[j] = j == i ? v[j] : -v[j];
  v[i] = fabs(v[i]);
}

/* The derivatives between phases of a period, and states there. */
typedef struct Course {
  int phases;
  double *y, *Phi; /* [phases + 1][n], [phases][n n] */
} Course;

/* Along the motion from node to node, so that its error does not grow: phases is a multiple of the segments. */
static int run_course(PeriodicOrbit *o, Course *c) {
  int n = o->n, within = c->phases / o->m, rc = LAG_OK;
  for (int k = 0; k < c->phases && rc == LAG_OK; k++) {
    if (k % within == 0) memcpy(c->y + k * n, o->y + k / within * n, (size_t)n * sizeof *o->y);
    double t = o->flow.t0 + o->T * k / c->phases;
    rc = lag_flow_run(&o->flow, t, o->T / c->phases, c->y + k * n, c->y + (k + 1) * n, c->Phi + k * n * n);
  }
  return rc;
}

static void multiply(int n, const double *A, const double *B, double *AB) {
  for (int e = 0; e < n * n; e++) {
    AB[e] = 0;
    for (int l = 0; l < n; l++) AB[e] += A[e / n * n + l] * B[l * n + e % n];
  }
}

/* M[n n] := the derivative over the period in units, closed: G^-1 Phi. */
static int monodromy(PeriodicOrbit *o, const Course *c, Pool *pool, double *M) {
  int n = o->n;
  double *P = lag_pool_doubles(pool, (size_t)(n * n)), *G = lag_pool_doubles(pool, (size_t)(n * n));
  if (pool->failed) return LAG_ENOMEM;
  for (int e = 0; e < n * n; e++) M[e] = e % (n + 1) == 0;
  for (int k = 0; k < c->phases; k++) {
    multiply(n, c->Phi + k * n * n, M, P);
    memcpy(M, P, (size_t)(n * n) * sizeof *M);
  }
  memcpy(G, o->G, (size_t)(n * n) * sizeof *G);
  if (lag_solve_dense((size_t)n, (size_t)n, G, M)) return LAG_ESINGULAR;
  for (int e = 0; e < n * n; e++) M[e] *= o->unit[e % n] / o->unit[e / n];
  return LAG_OK;
}

/* v[n] := A v. */
static void apply(int n, const double *A, double *v, double *scratch) {
  for (int i = 0; i < n; i++) {
    scratch[i] = 0;
    for (int j = 0; j < n; j++) scratch[i] += A[i * n + j] * v[j];
  }
  memcpy(v, scratch, (size_t)n * sizeof *v);
}

/* Adds the starts along v[n], the eigenvector at phase 0: carried forward, or of a stable one backwards, as it
 * grows. */
static int along_course(Manifold *m, PeriodicOrbit *o, const Course *c, ManifoldStart like, double *v, double part) {
  int n = o->n, rc = LAG_OK;
  double *A = lag_pool_doubles(&m->pool, (size_t)(n * n) + (size_t)n), *next = A + n * n;
  if (!A) return LAG_ENOMEM;
  orient(n, o->unit, v);
  rc = add_both(m, like, n, c->y, v, part);
  if (like.stable) apply(n, o->G, v, next); /* at the end of the period */
  for (int k = 1; k < c->phases && rc == LAG_OK; k++) {
    int step = like.stable ? c->phases - k : k - 1;
    memcpy(A, c->Phi + step * n * n, (size_t)(n * n) * sizeof *A);
    if (like.stable && lag_solve_dense((size_t)n, 1, A, v)) return LAG_ESINGULAR;
    if (!like.stable) apply(n, A, v, next);
    normalise(n, o->unit, v);
    like.phase = like.stable ? c->phases - k : k;
    like.t = o->flow.t0 + o->T * like.phase / c->phases;
    rc = add_both(m, like, n, c->y + like.phase * n, v, part);
  }
  return rc;
}

/* The eigenvectors of M for real multipliers outside, or inside, the unit circle. */
static int add_directions(Manifold *m, PeriodicOrbit *o, const Course *c, int stable, double part, Pool *pool) {
  size_t n = (size_t)o->n;
  double *M = lag_pool_doubles(pool, n * n), *re = lag_pool_doubles(pool, 2 * n), *im = re ? re + n : NULL,
         *v = lag_pool_doubles(pool, 3 * n * n), *along = lag_pool_doubles(pool, n);
  int rc = pool->failed ? LAG_ENOMEM : monodromy(o, c, pool, M);
  rc = rc ? rc : o->algebra->general(o->n, M, re, im, v, v + n * n, v + 2 * n * n);
  for (int k = 0; k < o->n && rc == LAG_OK; k++) {
    double size = hypot(re[k], im[k]);
    if (stable ? !(size < 1 - same && size > 1e-13) : !(size > 1 + same)) continue;
    int known = 0; /* a multiplier of 1 by symmetry is off by the root of rounding here */
    for (int i = 0; i < o->nmultipliers; i++)
      known |= hypot(re[k] - o->re[i], im[k] - o->im[i]) < 1e-3 * size &&
               fabs(hypot(o->re[i], o->im[i]) - 1) > same;
    if (!known) continue;
    m->rest_of += im[k] != 0.0;
    if (im[k] != 0.0) continue;
    for (int i = 0; i < o->n; i++) along[i] = v[i * o->n + k] * o->unit[i];
    ManifoldStart like = {.stable = stable, .rate = fabs(log(size)) / o->T, .t = o->flow.t0};
    rc = along_course(m, o, c, like, along, part);
  }
  return rc;
}

int lag_manifold_of_orbit(Manifold *m, PeriodicOrbit *o, int stable, int phases, double part) {
  Pool pool = {0};
  size_t n = (size_t)o->n;
  Course c = {.phases = (phases + o->m - 1) / o->m * o->m};
  c.y = lag_pool_doubles(&pool, ((size_t)c.phases + 1) * n);
  c.Phi = lag_pool_doubles(&pool, (size_t)c.phases * n * n);
  int rc = pool.failed ? LAG_ENOMEM : run_course(o, &c);
  rc = rc ? rc : add_directions(m, o, &c, stable, part, &pool);
  lag_pool_free(&pool);
  return rc;
}

int lag_manifold_of_rest(Manifold *m, FlowMap *f, const lag_algebra *algebra, const double *y, int stable,
                         double part) {
  int n = f->n, nq = f->nq;
  Pool pool = {0};
  double *J = lag_pool_doubles(&pool, (size_t)(n * n)), *re = lag_pool_doubles(&pool, 4 * (size_t)n),
         *im = re ? re + n : NULL, *along = re ? im + n : NULL, *unit = re ? along + n : NULL,
         *v = lag_pool_doubles(&pool, 3 * (size_t)(n * n));
  int rc = pool.failed ? LAG_ENOMEM : LAG_OK;
  rc = rc ? rc : lag_fine_jacobian(&f->probe->pb, NULL, f->t0, y, J + nq * n, f->linear);
  for (int i = 0; i < nq && rc == LAG_OK; i++) J[i * n + nq + i] = 1;
  rc = rc ? rc : algebra->general(n, J, re, im, v, v + n * n, v + 2 * n * n);
  for (int i = 0; i < n && rc == LAG_OK; i++) unit[i] = lag_difference_scale(&f->probe->pb, y, i);
  for (int k = 0; k < n && rc == LAG_OK; k++) {
    double rate = stable ? -re[k] : re[k];
    if (!(rate > same * hypot(re[k], im[k]))) continue;
    m->rest_of += im[k] != 0.0;
    if (im[k] != 0.0) continue;
    for (int i = 0; i < n; i++) along[i] = v[i * n + k];
    orient(n, unit, along);
    rc = add_both(m, (ManifoldStart){.stable = stable, .rate = rate, .t = f->t0}, n, y, along, part);
  }
  lag_pool_free(&pool);
  return rc;
}

void lag_manifold_free(Manifold *m) { lag_pool_free(&m->pool); }
