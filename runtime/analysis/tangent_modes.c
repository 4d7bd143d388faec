/* Modes about a steady motion y(t) = g(t) y, g the flow of a symmetry X (steady_motion.h). In the frame that moves
 * with it a small change obeys u' = (Df - DX) u, and lies in the tangent space of the constraints, which the flow
 * keeps: u = T x, x' = T' (Df - DX) T x = B x with an orthonormal basis T. Its first columns are displacements by
 * symmetries, which B keeps; what is left of B without them decides stability, and its zeros belong to other steady
 * motions, such as those at another speed, where they have all eigenvectors (A. M. Lyapunov, 1892; for families: I.
 * G. Malkin, Theory of Stability of Motion, 1952, par. 93). */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/spectrum.h"
#include "analysis/steady_motion.h"
#include "numeric/dense.h"

typedef struct TangentModes {
  Modes *out;
  SteadyMotion *s;
  const Equilibrium *rest;
  int d, shifts;  /* dimensions of the tangent space, and of displacements by symmetries in it */
  double *T;      /* [n * d] */
  double *B, *noise; /* [d * d], and errors of its entries */
  double *X, *DX; /* generator of the motion, in SI */
  Spectrum spectrum;
  int family;     /* 1: zeros of the spectrum lead to other steady motions */
} TangentModes;

/* T := kernel of the constraints' derivatives, in units. */
static int find_tangent_space(TangentModes *w) {
  const SteadyMotion *s = w->s;
  Pool *pool = &w->out->pool;
  int n = s->n, rows = s->nrows - n, size = rows > n ? rows : n;
  double *Q = lag_pool_doubles(pool, (size_t)size * (size_t)size);
  if (pool->failed) return LAG_ENOMEM;
  int rank = lag_tangent_kernel(pool, s, size, Q);
  /* a singular configuration: fewer constraints than beside it, and more tangents than motions */
  if (rank >= 0 && rank < s->rank) return LAG_ESINGULAR;
  w->d = n - rank;
  w->T = rank < 0 ? NULL : lag_pool_doubles(pool, (size_t)n * (size_t)w->d);
  for (int i = 0; i < n && w->T; i++)
    for (int k = 0; k < w->d; k++) w->T[i * w->d + k] = Q[i * size + rank + k];
  return rank < 0 ? rank : pool->failed ? LAG_ENOMEM : LAG_OK;
}

/* Turns T so that its first columns span the displacements by symmetries. */
static int separate_symmetries(TangentModes *w) {
  const SteadyMotion *s = w->s;
  int n = s->n, d = w->d, m = s->m, size = d > m ? d : m;
  Pool pool = {0};
  double *P = lag_pool_doubles(&pool, (size_t)m * (size_t)d), *one = lag_pool_doubles(&pool, (size_t)m),
         *X = lag_pool_doubles(&pool, (size_t)n);
  double *Q = lag_pool_doubles(&pool, (size_t)size * (size_t)size), *T = lag_pool_doubles(&pool, (size_t)n * (size_t)d);
  for (int k = 0; k < m && !pool.failed; k++) {
    memset(one, 0, (size_t)m * sizeof *one);
    one[k] = 1;
    /* an axis of turns is no displacement, to rounding: generators have the size 1 */
    lag_steady_generator(s, one, s->y, X, NULL);
    for (int l = 0; l < d; l++)
      for (int i = 0; i < n; i++) P[k * d + l] += w->T[i * d + l] * X[i] / s->unit[i];
  }
  w->shifts = pool.failed ? LAG_ENOMEM : lag_padded_kernel(&pool, s->algebra, size, (Rectangle){m, d, P}, 1e-8, Q);
  for (int i = 0; i < n && w->shifts >= 0; i++)
    for (int k = 0; k < d; k++)
      for (int l = 0; l < d; l++) T[i * d + k] += w->T[i * d + l] * Q[l * size + k];
  if (w->shifts >= 0) memcpy(w->T, T, (size_t)n * (size_t)d * sizeof *T);
  lag_pool_free(&pool);
  return w->shifts < 0 ? w->shifts : LAG_OK;
}

/* B and noise. */
static int restrict_to_tangents(TangentModes *w) {
  const SteadyMotion *s = w->s;
  const double rounding = 4 * DBL_EPSILON; /* of an element of T */
  int n = s->n, d = w->d;
  Pool pool = {0};
  double *B = w->B = lag_pool_doubles(&w->out->pool, (size_t)d * (size_t)d),
         *noise = w->noise = lag_pool_doubles(&w->out->pool, (size_t)d * (size_t)d);
  double *AT = lag_pool_doubles(&pool, 2 * (size_t)n * (size_t)d), *error = AT + (size_t)n * (size_t)d;
  for (int i = 0; i < n && AT; i++)
    for (int j = 0; j < n; j++) {
      double per = s->unit[j] / s->unit[i], A = (s->G[i * n + j] - w->DX[i * n + j]) * per,
             e = s->noise[i * n + j] * per;
      for (int k = 0; k < d; k++) {
        AT[i * d + k] += A * w->T[j * d + k];
        error[i * d + k] += e * fabs(w->T[j * d + k]) + rounding * fabs(A);
      }
    }
  for (int i = 0; i < n && AT && B && noise; i++)
    for (int k = 0; k < d; k++)
      for (int l = 0; l < d; l++) {
        B[k * d + l] += w->T[i * d + k] * AT[i * d + l];
        noise[k * d + l] += fabs(w->T[i * d + k]) * error[i * d + l] + rounding * fabs(AT[i * d + l]);
      }
  int rc = AT && !w->out->pool.failed ? LAG_OK : LAG_ENOMEM;
  lag_pool_free(&pool);
  return rc;
}

/* Adds a mode with the shape T (re + i im), whose largest component becomes 1 declared unit. */
static int add_mode(TangentModes *w, Mode mode, const double *re, const double *im) {
  const SteadyMotion *s = w->s;
  int nx = w->rest->n, best = 0;
  double *x = lag_pool_doubles(&w->out->pool, 2 * (size_t)nx), *y = x + nx, most = 0;
  if (!x) return LAG_ENOMEM;
  for (int i = 0; i < nx; i++) {
    int at = i < s->nq ? i : s->nq + i;
    x[i] = re[at] * s->unit[at];
    y[i] = im ? im[at] * s->unit[at] : 0;
    if (hypot(re[at], im ? im[at] : 0) <= most * (1 + 1e-9)) continue;
    most = hypot(re[at], im ? im[at] : 0);
    best = i;
  }
  lag_add_mode(w->out, s->sim->pb.model, mode, nx, x, y, best);
  return LAG_OK;
}

/* Column k of re + i im, whose eigenvalue is value. */
typedef struct Eigenvector {
  double value_re, value_im;
  const double *re, *im; /* im NULL: real */
  int column;
} Eigenvector;

/* shape[2 n], real and imaginary parts, := T u for the eigenvector z of the block of B without
 * symmetries: u = (x, z) with (B - value) u = 0, whose displacement x by symmetries is left out
 * where it is not determined. */
static int lift(const TangentModes *w, const Eigenvector *z, double *shape) {
  int k = z->column, n = w->s->n, d = w->d, m = w->shifts, e = d - m, columns = w->spectrum.n;
  Pool pool = {0};
  double *A = lag_pool_doubles(&pool, 4 * (size_t)m * (size_t)m), *x = lag_pool_doubles(&pool, 2 * (size_t)m);
  for (int i = 0; i < m && !pool.failed; i++) { /* real and imaginary parts of (B_mm - value) x = -B_me z */
    for (int j = 0; j < m; j++)
      A[i * 2 * m + j] = A[(m + i) * 2 * m + m + j] = w->B[i * d + j] - (i == j ? z->value_re : 0);
    A[i * 2 * m + m + i] = z->value_im;
    A[(m + i) * 2 * m + i] = -z->value_im;
    for (int l = 0; l < e; l++) {
      x[i] -= w->B[i * d + m + l] * z->re[l * columns + k];
      x[m + i] -= z->im ? w->B[i * d + m + l] * z->im[l * columns + k] : 0;
    }
  }
  int along = !pool.failed && hypot(z->value_re, z->value_im) > 0 && lag_solve_dense(2 * (size_t)m, 1, A, x) == 0;
  for (int i = 0; i < n; i++) {
    shape[i] = shape[n + i] = 0;
    for (int l = 0; l < e; l++) {
      shape[i] += w->T[i * d + m + l] * z->re[l * columns + k];
      shape[n + i] += z->im ? w->T[i * d + m + l] * z->im[l * columns + k] : 0;
    }
    for (int j = 0; j < m && along; j++) {
      shape[i] += w->T[i * d + j] * x[j];
      shape[n + i] += w->T[i * d + j] * x[m + j];
    }
  }
  int rc = pool.failed ? LAG_ENOMEM : LAG_OK;
  lag_pool_free(&pool);
  return rc;
}

/* Adds k zero modes, columns of v[n * k], in a basis with many zeros; those that displace nothing change speeds
 * alone, and are not listed. */
static int add_zeros(TangentModes *w, int k, double *v, int free) {
  int n = w->s->n, rc = LAG_OK;
  double *x = lag_pool_doubles(&w->out->pool, 2 * (size_t)n), *scale = x + n;
  if (!x) return LAG_ENOMEM;
  for (int i = 0; i < n; i++) scale[i] = i >= w->s->nq && i < 2 * w->s->nq ? 1e5 : 1;
  for (int i = 0; i < n * k; i++) v[i] = fabs(v[i]) < 1e-9 ? 0 : v[i];
  lag_reduce_columns(n, k, scale, v);
  for (int j = 0; j < k && rc == LAG_OK; j++) {
    double most = 0;
    for (int i = 0; i < n; i++) {
      x[i] = fabs(v[i * k + j]) < 1e-9 ? 0 : v[i * k + j];
      most = fmax(most, fabs(x[i]) / scale[i]);
    }
    w->out->drifts |= most < 2e-5;
    if (most >= 2e-5) rc = add_mode(w, (Mode){.repeats = 1, .free = free}, x, NULL);
  }
  return rc;
}

/* Whether all zeros that are left, columns of u[n * k], lead to other steady motions, one by one and in sums: only
 * then nonlinear terms do not decide. */
static int is_family(TangentModes *w, int k, const double *u) {
  int n = w->s->n, family = w->spectrum.zeros == k;
  double *x = lag_pool_doubles(&w->out->pool, (size_t)n);
  for (int try = 0; try < k + (k > 1 ? LAG_MIXTURES : 0) && x && family; try++) {
    if (try >= k) lag_mix_columns(n, k, u, try - k, x);
    for (int i = 0; i < n && try < k; i++) x[i] = u[i * k + try];
    family = lag_steady_continues(w->s, x, 0.05) && lag_steady_continues(w->s, x, -0.05);
  }
  return x && family;
}

/* Displacements by symmetries, then the zeros that are left. */
static int add_all_zeros(TangentModes *w) {
  const Spectrum *s = &w->spectrum;
  int n = w->s->n, m = w->shifts, k = s->nkernel, rc = LAG_OK;
  double *v = lag_pool_doubles(&w->out->pool, (size_t)n * (size_t)m),
         *u = lag_pool_doubles(&w->out->pool, (size_t)n * (size_t)k);
  double *re = lag_pool_doubles(&w->out->pool, 2 * (size_t)n);
  if (w->out->pool.failed) return LAG_ENOMEM;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < m; j++) v[i * m + j] = w->T[i * w->d + j];
  for (int j = 0; j < k && rc == LAG_OK; j++) {
    rc = lift(w, &(Eigenvector){.re = s->kernel, .column = s->n - k + j}, re);
    for (int i = 0; i < n; i++) u[i * k + j] = re[i];
  }
  w->family = rc == LAG_OK && is_family(w, k, u);
  rc = rc ? rc : add_zeros(w, m, v, 1);
  return rc ? rc : add_zeros(w, k, u, w->family);
}

static int add_modes(TangentModes *w) {
  const Spectrum *s = &w->spectrum;
  int n = w->s->n, rc = add_all_zeros(w);
  double *re = lag_pool_doubles(&w->out->pool, 2 * (size_t)n), *im = re + n;
  if (!re) return LAG_ENOMEM;
  for (int k = 0; k < s->count && rc == LAG_OK; k++) {
    if (s->im[k] < 0 || !lag_spectrum_first(s, k)) continue;
    rc = lift(w, &(Eigenvector){s->re[k], s->im[k], s->vre, s->vim, k}, re);
    rc = rc ? rc : add_mode(w, (Mode){.re = s->re[k], .im = s->im[k], .repeats = (int)s->repeats[k]}, re, im);
  }
  return rc;
}

/* Spectrum of the block of B without symmetries. */
static int find_spectrum(TangentModes *w) {
  int d = w->d, m = w->shifts, e = d - m;
  Pool *pool = &w->out->pool;
  double *B = lag_pool_doubles(pool, (size_t)e * (size_t)e), *noise = lag_pool_doubles(pool, (size_t)e * (size_t)e);
  if (pool->failed) return LAG_ENOMEM;
  for (int i = 0; i < e; i++)
    for (int j = 0; j < e; j++) {
      B[i * e + j] = w->B[(m + i) * d + m + j];
      noise[i * e + j] = w->noise[(m + i) * d + m + j];
    }
  return e ? lag_spectrum(&w->spectrum, pool, w->s->algebra, e, B, noise) : LAG_OK;
}

/* Whether the mass matrix is positive definite: all pivots of symmetric elimination are positive. */
static int has_positive_mass(const TangentModes *w) {
  lag_problem *pb = &w->s->sim->pb;
  const lag_constraints *of = pb->model->constraints;
  size_t nq = (size_t)pb->nq;
  Pool pool = {0};
  double *M = lag_pool_doubles(&pool, nq * nq), *A = of ? lag_pool_doubles(&pool, (size_t)of->n * nq) : NULL,
         *unit = lag_pool_doubles(&pool, nq);
  int positive = A && M && unit && lag_constraint_jacobian(pb, w->s->sim->run->t, w->s->y, A, unit, M) == 0;
  for (int k = 0; k < pb->nq && positive; k++) {
    positive = M[k * pb->nq + k] > 0;
    for (int i = k + 1; i < pb->nq && positive; i++) lag_eliminate_row(pb->nq, M, k, i);
  }
  lag_pool_free(&pool);
  return positive;
}

/* Whether the state is at rest, the energy is conserved and its kinetic part positive, and forces depend on
 * positions alone: then oscillation in every direction means that the energy is least. */
static int is_potential(const TangentModes *w) {
  const SteadyMotion *s = w->s;
  const lag_model *m = s->sim->pb.model;
  int n = s->n, nq = s->nq, d = w->d;
  double most = 0, velocity = 0;
  int on_velocities = m->constraints ? m->constraints->n - m->constraints->nholonomic : 0;
  for (int i = 0; i < m->ncontacts; i++) on_velocities -= m->contacts[i].constraint >= m->constraints->nholonomic;
  if (on_velocities) return 0;
  for (int i = nq; i < 2 * nq; i++) velocity = fmax(velocity, fabs(s->y[i]));
  if (m->nz || velocity > 0 || !lag_conserves_energy(s->sim)) return 0;
  for (int i = 0; i < nq; i++)
    for (int j = 0; j < nq; j++) most = fmax(most, fabs(s->G[(nq + i) * n + j]) * s->unit[j] / s->unit[i]);
  for (int i = nq; i < 2 * nq; i++)
    for (int k = 0; k < d; k++) {
      double sum = 0;
      for (int j = nq; j < 2 * nq; j++) sum += s->G[i * n + j] * s->unit[j] / s->unit[i - nq] * w->T[j * d + k];
      if (fabs(sum) > 1e-9 * sqrt(most)) return 0;
    }
  return has_positive_mass(w);
}

/* Whether derivatives have no good value: near a jump or a kink differences do not converge. */
static int is_rough(const TangentModes *w) {
  double most = 0, error = 0;
  for (int i = 0; i < w->d * w->d; i++) {
    most = fmax(most, fabs(w->B[i]));
    error = fmax(error, w->noise[i]);
  }
  return error > 1e-5 * most;
}

static Verdict decide(TangentModes *w) {
  const Spectrum *s = &w->spectrum;
  int stays = 0, defective = 0;
  if (w->rest && w->rest->held) return LAG_HELD;
  if (is_rough(w)) return LAG_NONSMOOTH;
  for (int i = 0; i < w->out->n; i++) {
    const Mode *m = &w->out->mode[i];
    if (m->re > 0) return LAG_UNSTABLE;
    stays += m->re == 0.0 && m->im != 0;
    defective |= m->re == 0.0 && m->im != 0 && m->repeats > 1;
  }
  if (defective) return LAG_DEFECTIVE;
  if (s->zeros && !w->family) return LAG_DEGENERATE;
  int least = stays && is_potential(w);
  w->out->lowering = least ? 0 : -1;
  w->out->pairs = least;
  if (stays && !least) return LAG_CENTRE;
  return s->zeros || w->shifts ? LAG_NEUTRAL : stays ? LAG_MINIMUM : LAG_DECAYS;
}

/* Whether rate X of state i is more than what rounding leaves of the rates that changes of the state make. */
static int runs(const SteadyMotion *s, int i, double X) {
  double most = 0;
  for (int j = 0; j < s->n; j++) most = fmax(most, fabs(s->G[i * s->n + j]) * s->unit[j]);
  return fabs(X) > 1e-12 * most;
}

int lag_steady_modes(Modes *out, SteadyMotion *s, Equilibrium *rest) {
  Pool *pool = &out->pool;
  TangentModes w = {.out = out, .s = s, .rest = rest};
  size_t n = (size_t)s->n;
  *out = (Modes){.lowering = -1, .together = 1};
  for (int i = s->nq; i < 2 * s->nq; i++) out->steady |= s->y[i] != 0;
  out->mode = calloc(n + 1, sizeof *out->mode);
  w.X = lag_pool_doubles(pool, n);
  w.DX = lag_pool_doubles(pool, n * n);
  if (!out->mode || pool->failed) return LAG_ENOMEM;
  lag_steady_generator(s, s->c, s->y, w.X, w.DX);
  int rc = lag_steady_derivatives(s);
  for (size_t i = 0; i < n; i++) rest->rate[i] = w.X[i];
  for (int i = 0; i < s->n && !s->nq; i++) out->steady |= runs(s, i, w.X[i]);
  rc = rc ? rc : find_tangent_space(&w);
  rc = rc ? rc : separate_symmetries(&w);
  rc = rc ? rc : restrict_to_tangents(&w);
  rc = rc ? rc : find_spectrum(&w);
  rc = rc ? rc : add_modes(&w);
  if (rc) return rc;
  lag_modes_sort(out);
  out->verdict = decide(&w);
  return LAG_OK;
}
