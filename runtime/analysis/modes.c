/* Modes of M x'' + C x' + K x = 0, with K = -dr/dq and C = -dr/dv at rest. Without C, and with K = K', as a
 * symmetric eigenvalue problem (J.W. Strutt, Lord Rayleigh, The Theory of Sound, 1877, chapter IV); else, and with
 * states, as y' = A y. Stability: by the first approximation where real parts decide (A.M. Lyapunov, 1892), by the
 * energy where it has a strict minimum (Lagrange; G. Lejeune Dirichlet, J. reine angew. Math. 32 (1846) 85, DOI
 * 10.1515/crll.1846.32.85). */
#include "analysis/modes.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/spectrum.h"
#include "numeric/dense.h"

/* ---- Matrices of small motion, and the noise of their entries */

/* M x'' + C x' + K x = 0 in coordinates of mass 1: the model's times weight. */
typedef struct Matrices {
  int nq;
  double *weight;              /* [nq] sqrt(M_ii); of a row with M_ii <= 0, the root of its size */
  double *K, *C, *M;           /* [nq * nq] */
  double *noise_K, *noise_C, *noise_M;
  int definite, symmetric, undamped; /* to rounding: M is positive definite; K is symmetric; C = 0 */
  int lowering;                /* number of directions in which the energy falls; -1: not known */
  int flat;                    /* number of directions in which it is constant, to rounding */
  /* eigenpairs K x = value M x, where lowering >= 0: [nq] ascending up to rounding, columns [nq * nq] in the model's
   * SI units */
  double *values, *vectors;
  double *zero;                /* [nq] |value| up to this counts as 0 */
} Matrices;

/* noise[count] := at least the changes of values when the root moves to four corners of its uncertainty. */
static void add_spread(Equilibrium *r, lag_values *values, size_t count, const double *base, double *noise,
                       double *scratch) {
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

/* A[n * n] of y' = A y at rest, n = 2 nq + nz, and the noise of its entries. Memory and errors as of find_matrices. */
static int state_matrix(Pool *pool, Equilibrium *rest, double **A, double **noise) {
  size_t n = (size_t)rest->sim->pb.n;
  return with_noise(pool, rest, jacobian, n * n, A, noise);
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
      double size = fmin(lag_largest(nq, m->K + i * nq), lag_largest(nq, m->K + j * nq));
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
    double own = M[i * nq + i], size = lag_largest(nq, M + i * nq);
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

/* Computes *m at the state at rest. Memory is the pool's. LAG_OK, LAG_ENOMEM, the model's status, LAG_EMETHOD. */
static int find_matrices(Matrices *m, Pool *pool, Equilibrium *rest, const lag_algebra *algebra) {
  *m = (Matrices){.nq = rest->sim->pb.nq, .lowering = -1};
  int rc = entries(m, pool, rest);
  return rc || !m->symmetric || !m->definite || m->nq == 0 ? rc : signature(m, pool, algebra);
}

/* ---- The energy of a model of first order */

/* The energy at x moved by a along i and b along j; NAN: none. */
static double energy_at(Equilibrium *r, int i, double a, int j, double b) {
  lag_problem *pb = &r->sim->pb;
  double e[2] = {0};
  memcpy(r->trial, r->x, (size_t)r->n * sizeof *r->x);
  r->trial[i] += a;
  r->trial[j] += b;
  lag_equilibrium_state(r, r->trial);
  const double *y = r->y;
  int rc = pb->model->energy(pb->model, r->sim->run->t, y, y + pb->nq, y + 2 * pb->nq, pb->p, pb->u, e, pb->work);
  return rc ? NAN : e[0];
}

/* H[n * n] := second differences of the energy with step h, divided by the roots of their diagonal. 1 or -1: the
 * sign of the diagonal; 0: of no sign beyond rounding. */
static int energy_differences(Equilibrium *r, double h, double *H) {
  int n = r->n, sign = 0;
  double here = energy_at(r, 0, 0, 0, 0), noise = 1e5 * DBL_EPSILON * fabs(here) / (h * h);
  for (int i = 0; i < n; i++)
    for (int j = 0; j <= i; j++) {
      double second = i == j ? energy_at(r, i, h, i, 0) - 2 * here + energy_at(r, i, -h, i, 0)
                             : (energy_at(r, i, h, j, h) - energy_at(r, i, h, j, -h) - energy_at(r, i, -h, j, h) +
                                energy_at(r, i, -h, j, -h)) / 4;
      H[i * n + j] = second / (h * h);
    }
  for (int i = 0; i < n; i++) {
    double own = H[i * n + i];
    if (!(fabs(own) > noise) || (sign && (own > 0) != (sign > 0))) return 0;
    sign = own > 0 ? 1 : -1;
  }
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++) H[i * n + j] *= sign / sqrt(H[i * n + i] * H[j * n + j]);
  for (int i = 0; i < n; i++) H[i * n + i] = 1;
  return sign;
}

/* 1: the energy has a strict minimum at rest; -1: a strict maximum; 0: neither is seen, with differences of two
 * steps that agree. */
static int energy_extremum(Pool *pool, Equilibrium *r, const lag_algebra *algebra) {
  const double step = 1e-3, agree = 1e-4, definite = 1e-3;
  size_t n = (size_t)r->n, nn = n * n;
  double *H = lag_pool_doubles(pool, nn), *half = lag_pool_doubles(pool, nn), *one = lag_pool_doubles(pool, nn);
  double *values = lag_pool_doubles(pool, n), *vectors = lag_pool_doubles(pool, nn);
  if (pool->failed) return 0;
  int sign = energy_differences(r, step, H);
  if (!sign || energy_differences(r, step / 2, half) != sign) return 0;
  for (size_t i = 0; i < nn; i++)
    if (!(fabs(H[i] - half[i]) < agree)) return 0;
  for (size_t i = 0; i < n; i++) one[i * n + i] = 1;
  lag_equilibrium_state(r, r->x);
  return algebra->symmetric(r->n, H, one, values, vectors) == LAG_OK && values[0] > definite ? sign : 0;
}

/* ---- Modes */

typedef struct ModeSearch {
  Modes *out;
  Equilibrium *rest;
  const lag_algebra *algebra;
  lag_problem *pb;
  int nq, n, ny;        /* n = nq + nz, ny = 2 nq + nz */
  Matrices m;
  int loses;            /* the model has no states, and its energy, less the work of constant forces, never grows */
  int conserves;        /* the model has a conserved energy, and no states beside it */
  double *kernel;       /* [n * nkernel] zero modes in SI, columns */
  int nkernel;
} ModeSearch;

/* ---- Shapes */

/* Index in y of unknown i: coordinates, then states. */
static int place(const ModeSearch *w, int i) { return i < w->nq ? i : w->nq + i; }

/* Amplitude of component i of a shape (coordinates, then states), in scales. */
static double amplitude(const ModeSearch *w, int i, double re, double im) { return hypot(re, im) / w->rest->scale[i]; }

/* The component to be normalised to 1: the coordinate with the largest kinetic energy; if only states move, the
 * state with the largest amplitude. Of equal ones the first, whatever rounding says. */
static int reference(const ModeSearch *w, const double *re, const double *im) {
  int best[2] = {0, w->nq};
  double most[2] = {-1, 0}, far[2] = {0, 0};
  for (int i = 0; i < w->n; i++) {
    int state = i >= w->nq;
    double amount = amplitude(w, i, re[i], im[i]), size = state ? amount : hypot(re[i], im[i]) * w->m.weight[i];
    far[state] = fmax(far[state], amount);
    if (size > most[state] * (1 + 1e-9)) {
      most[state] = size;
      best[state] = i;
    }
  }
  return best[!(far[0] > 1e-12 * far[1])];
}

void lag_add_mode(Modes *to, const lag_model *m, Mode mode, int n, double *re, double *im, int ref) {
  double factor = ref < m->nq ? m->q[ref].factor : m->z[ref - m->nq].factor, a = re[ref], b = im[ref],
      size = a * a + b * b;
  for (int i = 0; i < n && size > 0; i++) {
    double x = re[i], y = im[i];
    re[i] = factor * (x * a + y * b) / size;
    im[i] = factor * (y * a - x * b) / size;
  }
  mode.shape_re = re;
  mode.shape_im = im;
  to->mode[to->n++] = mode;
}

/* Adds a mode with the shape re + i im, [n] with a stride. */
static int add_mode(ModeSearch *w, Mode mode, const double *re, const double *im, int stride) {
  double *shape_re = lag_pool_doubles(&w->out->pool, (size_t)w->n),
         *shape_im = lag_pool_doubles(&w->out->pool, (size_t)w->n);
  if (w->out->pool.failed) return LAG_ENOMEM;
  for (int i = 0; i < w->n; i++) {
    shape_re[i] = re[i * stride];
    shape_im[i] = im ? im[i * stride] : 0;
  }
  lag_add_mode(w->out, w->pb->model, mode, w->n, shape_re, shape_im, reference(w, shape_re, shape_im));
  return LAG_OK;
}

/* ---- Zero modes */

void lag_reduce_columns(int n, int k, const double *scale, double *v) {
  for (int done = 0; done < k; done++) {
    int row = 0, col = done;
    double most = 0;
    for (int i = 0; i < n; i++)
      for (int j = done; j < k; j++) {
        double e = fabs(v[i * k + j]) / scale[i];
        if (e > most * (1 + 1e-9)) {
          most = e;
          row = i;
          col = j;
        }
      }
    double pivot = v[row * k + col];
    if (pivot == 0.0) return;
    for (int i = 0; i < n; i++) {
      lag_swap(&v[i * k + done], &v[i * k + col]);
      v[i * k + done] /= pivot;
    }
    for (int j = 0; j < k; j++) {
      double factor = v[row * k + j];
      for (int i = 0; i < n && j != done; i++) v[i * k + j] -= factor * v[i * k + done];
    }
  }
}

/* Whether all forces stay 0 along x[n], or along a curve that begins so (a rotation): tested near and as far as
 * `most` scales, on both sides. */
static int is_free(ModeSearch *w, const double *x, double most) {
  const double steps[] = {-most / 3, most / 3, -most, most};
  double far = 0;
  for (int i = 0; i < w->n; i++) far = fmax(far, amplitude(w, i, x[i], 0));
  for (size_t k = 0; k < sizeof steps / sizeof *steps && far > 0; k++) {
    double c = steps[k] / far;
    if (!lag_equilibrium_continues(w->rest, x, c)) return 0;
  }
  return far > 0;
}

void lag_mix_columns(int n, int k, const double *v, int pattern, double *x) {
  for (int i = 0; i < n; i++) {
    x[i] = 0;
    for (int j = 0; j < k; j++) {
      int minus = (pattern & 1 && j & 1) != (pattern & 2 && j & 2);
      x[i] += v[i * k + j] * (minus ? -1 : 1) * (0.7 + 0.11 * (j * 3 % 4));
    }
  }
}

/* Whether zero modes that are free one by one are free together, which x^2 y^2 is not along x and y. */
static int free_together(ModeSearch *w, double *x) {
  for (int pattern = 0; pattern < LAG_MIXTURES && w->nkernel > 1; pattern++) {
    lag_mix_columns(w->n, w->nkernel, w->kernel, pattern, x);
    if (!is_free(w, x, 0.1)) return 0;
  }
  return 1;
}

static int add_zero_modes(ModeSearch *w) {
  double *x = lag_pool_doubles(&w->out->pool, (size_t)w->n);
  int rc = x ? LAG_OK : LAG_ENOMEM, all = 1;
  if (rc == LAG_OK) lag_reduce_columns(w->n, w->nkernel, w->rest->scale, w->kernel);
  for (int k = 0; k < w->nkernel && rc == LAG_OK; k++) {
    for (int i = 0; i < w->n; i++) {
      x[i] = w->kernel[i * w->nkernel + k];
      x[i] = amplitude(w, i, x[i], 0) < 1e-12 ? 0 : x[i]; /* after reduction the largest is about 1 */
    }
    Mode mode = {.repeats = 1};
    mode.free = is_free(w, x, 0.3);
    all &= mode.free;
    rc = add_mode(w, mode, x, NULL, 1);
  }
  w->out->together = rc == LAG_OK && all && free_together(w, x);
  return rc;
}

/* ---- Two ways to the modes */

/* Modes from the eigenvalues w^2 of the symmetric problem: a negative one is a pair +-s. */
static int modes_of_values(ModeSearch *w) {
  const Matrices *m = &w->m;
  int nq = w->nq, rc = LAG_OK;
  w->nkernel = m->flat;
  w->kernel = lag_pool_doubles(&w->out->pool, (size_t)w->n * (size_t)w->nkernel);
  if (!w->kernel) return LAG_ENOMEM;
  for (int k = 0, zeros = 0; k < nq && rc == LAG_OK; k++) {
    double value = m->values[k];
    if (fabs(value) > m->zero[k]) {
      Mode mode = {.re = value < 0 ? sqrt(-value) : 0, .im = value > 0 ? sqrt(value) : 0, .repeats = 1};
      rc = add_mode(w, mode, m->vectors + k, NULL, nq);
      continue;
    }
    for (int i = 0; i < nq; i++) w->kernel[i * w->nkernel + zeros] = m->vectors[i * nq + k];
    zeros++;
  }
  w->out->drifts = w->nkernel > 0;
  w->out->pairs = 1;
  return rc ? rc : add_zero_modes(w);
}

/* Whether the eigenvalue is the conjugate, or the negative, of one that is listed. */
static int is_second_half(const ModeSearch *w, const Spectrum *s, int k) {
  return s->im[k] < 0 || (w->out->pairs && s->re[k] < 0);
}

static int modes_of_matrix(ModeSearch *w) {
  Pool *pool = &w->out->pool;
  Spectrum s;
  size_t n = (size_t)w->n;
  double *A, *noise, *re = lag_pool_doubles(pool, n), *im = lag_pool_doubles(pool, n);
  int rc = state_matrix(pool, w->rest, &A, &noise);
  rc = rc ? rc : pool->failed ? LAG_ENOMEM : lag_spectrum(&s, pool, w->algebra, w->ny, A, noise);
  if (rc) return rc;
  int minimum = w->conserves && w->m.lowering == 0 && w->m.flat == 0; /* then real parts are rounding */
  w->nkernel = s.nkernel;
  w->out->drifts = s.zeros > s.nkernel;
  w->kernel = lag_pool_doubles(pool, n * (size_t)s.nkernel);
  for (int i = 0; i < w->n && w->kernel; i++)
    for (int k = 0; k < s.nkernel; k++)
      w->kernel[i * s.nkernel + k] = s.kernel[place(w, i) * s.n + s.n - s.nkernel + k];
  for (int k = 0; k < s.count && rc == LAG_OK && !pool->failed; k++) {
    Mode mode = {.re = minimum ? 0 : s.re[k], .im = s.im[k], .repeats = (int)s.repeats[k]};
    for (int i = 0; i < w->n; i++) {
      re[i] = s.vre[place(w, i) * s.n + k];
      im[i] = s.vim[place(w, i) * s.n + k];
    }
    rc = is_second_half(w, &s, k) || !lag_spectrum_first(&s, k) ? LAG_OK : add_mode(w, mode, re, im, 1);
  }
  rc = pool->failed ? LAG_ENOMEM : rc;
  return rc || w->nkernel == 0 ? rc : add_zero_modes(w);
}

/* ---- Stability */

static Verdict decide_stability(const ModeSearch *w) {
  const Modes *out = w->out;
  int grows = 0, stays = 0, zeros = 0, defective = 0;
  for (int i = 0; i < out->n; i++) {
    const Mode *m = &out->mode[i];
    int zero = m->re == 0.0 && m->im == 0.0;
    grows |= m->re > 0;
    stays += m->re == 0.0 && !zero;
    zeros += zero;
    defective |= m->re == 0.0 && m->repeats > 1;
  }
  if (w->rest->held) return LAG_HELD;
  if (grows) return LAG_UNSTABLE;
  if (w->rest->pole) return LAG_COORDINATE_POLE;
  if (w->rest->rough) return LAG_NONSMOOTH;
  if (stays == 0 && zeros == 0) return LAG_DECAYS;
  if (defective) return LAG_DEFECTIVE;
  if (zeros && !out->together) return LAG_DEGENERATE;
  if (w->conserves && out->lowering == 0)
    return zeros != w->m.flat ? LAG_DEGENERATE : zeros ? LAG_NEUTRAL : LAG_MINIMUM;
  if (w->loses && out->lowering == 0 && zeros == 0 && w->m.flat == 0) return LAG_DISSIPATIVE_MINIMUM;
  if (w->conserves && out->lowering > 0) return LAG_GYROSCOPIC;
  return stays == 0 ? LAG_NEUTRAL : LAG_CENTRE;
}

static int class_of(const Mode *m) { return m->re == 0.0 && m->im == 0.0 ? 0 : m->re > 0 ? 1 : 2; }

static int by_class(const void *a, const void *b) {
  const Mode *x = a, *y = b;
  int c = class_of(x) - class_of(y);
  if (c) return c;
  if (x->im != y->im) return x->im < y->im ? -1 : 1;
  return (x->re < y->re) - (x->re > y->re);
}

void lag_modes_sort(Modes *s) { qsort(s->mode, (size_t)s->n, sizeof *s->mode, by_class); }

int lag_modes_find(Modes *out, Equilibrium *rest, const lag_algebra *algebra) {
  lag_problem *pb = &rest->sim->pb;
  ModeSearch w = {.out = out, .rest = rest, .algebra = algebra, .pb = pb, .nq = pb->nq, .n = rest->n, .ny = pb->n};
  w.conserves = pb->nz == 0 && lag_conserves_energy(rest->sim);
  w.loses = (pb->model->flags & LAG_LOSES_ENERGY) != 0 && pb->nz == 0;
  *out = (Modes){.lowering = -1, .pairs = w.conserves, .conserves = w.conserves};
  out->mode = calloc((size_t)w.ny + 1, sizeof *out->mode);
  int rc = out->mode ? find_matrices(&w.m, &out->pool, rest, algebra) : LAG_ENOMEM;
  if (rc) return rc;
  if (pb->nq == 0 && pb->model->flags & LAG_CONSERVES_ENERGY) {
    out->extremum = energy_extremum(&out->pool, rest, algebra);
    w.conserves = out->extremum != 0;
    w.m.lowering = out->extremum ? 0 : -1;
  }
  out->lowering = w.m.lowering;
  rc = pb->nz == 0 && w.m.undamped && out->lowering >= 0 ? modes_of_values(&w) : modes_of_matrix(&w);
  lag_modes_sort(out);
  out->verdict = decide_stability(&w);
  return rc;
}

void lag_modes_free(Modes *modes) {
  free(modes->mode);
  lag_pool_free(&modes->pool);
}
