/* radau: Radau IIA of order 5, implicit and L-stable, with adaptive steps and the exact Jacobian that the compiler
 * emits: for stiff models. Enters: t, y; leaves: the next accepted t, y. Holds: a rejected step leaves t and y
 * unchanged; f at the end of a step serves as f at the start of the next; the Jacobian and its factors are kept
 * while Newton's method converges fast. Constraints: the index-1 form within a step, projection at its end, and a
 * Jacobian by differences.
 *
 * Source: E. Hairer, G. Wanner, Solving Ordinary Differential Equations II, 2nd ed. (1996), DOI
 * 10.1007/978-3-642-05221-7, IV.8 and code RADAU5: simplified Newton iteration in coordinates in which the inverse
 * Butcher matrix is block diagonal (one real and one complex eigenvalue), its stopping rule, start values from the
 * last collocation polynomial, error estimate with a second, filtered one after a rejected step, predictive step
 * control (K. Gustafsson, ACM Trans. Math. Softw. 20 (1994) 496, DOI 10.1145/198429.198437). The tolerances are
 * transformed as in RADAU5, 0.1 tol^(2/3), because the estimate has order 3. Dense output: the collocation
 * polynomial. */
#include "lag.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "kernels/band_matrix.h"
#include "methods/step_control.h"
#include "methods/adaptive_rk.h"
#include "methods/steps.h"
#include "methods/method_tangent.h"
#include "numeric/workspace.h"

enum { MOST_CORRECTIONS = 7, MOST_WHEN_FIXED = 30, STAGES = 3 };

/* Results of an attempt besides LAG_ERETRY (the model left its domain): the error was too large; Newton's method
 * diverged. */
enum { REJECTED = LAG_ERETRY + 1, DIVERGED };

static const double safety = 0.9, shrink_most = 0.2, grow_most = 8;
static const double contracts_well = 1e-3; /* contraction rate below which the Jacobian is kept */
/* growth of h within these factors is ignored, to keep the LU factors */
static const double keep_least = 1, keep_most = 1.2;

/* The method: nodes, Butcher matrix (table IV.5.6), the eigenvalues of its inverse, and the eigenvectors T. */
static const double node[STAGES] = {0.155051025721682190180271592529410861, 0.644948974278317809819728407470589139, 1};
static const double butcher[STAGES][STAGES] = {
    {0.19681547722366042586838614299182989, -0.0655354258501983881085227825696086918,
     0.023770974348220152420408232107189663},
    {0.394424314739087276997411671458497581, 0.292073411665228463020502745897058999,
     -0.0415487521259979301981860098849674408},
    {0.376403062700467275050075442369280795, 0.512485826188421613838813446519608094,
     0.111111111111111111111111111111111111}};
static const double real_eigenvalue = 3.6378342527444957322084185135777758;
static const double eigenvalue[2] = {2.6810828736277521338957907432111121, 3.0504301992474105694263776247875679};
static const double T[STAGES][STAGES] = {
    {0.0912323948708929427914945808409637767, -0.141255295020954208427990383807797309,
     -0.0300291941051474244918611170890538667},
    {0.241717932707107018957332888253560007, 0.204129352293799931995990810298338174,
     0.38294211275726193779543823359987321},
    {0.96604818261509293619, 1, 0}};
static const double inverse_T[STAGES][STAGES] = {
    {4.32557989006315535102689011541746916, 0.339199251815809869543024087704992642,
     0.541770539935874871186841058693939352},
    {-4.17871859155190472734646265851205623, -0.327682820761062387082533272429616234,
     0.476623554500550451960069084091012498},
    {-0.502872634945786875951247343139544293, 2.57192694985560542918678535360167505,
     -0.596039204828224924968821911099302403}};
/* Weights of z/h in the error estimate, (-13 -+ 7 sqrt 6)/3 and -1/3. */
static const double error_weight[STAGES] = {-10.0488093998274155624603295076470799,
                                            1.38214273316074889579366284098041325, -1.0 / 3};

/* Saved state of the method, doubles only; RadauArrays has pointers into x. */
typedef struct Radau {
  double h;            /* the next step to try, > 0; 0: not chosen yet */
  lag_step_limits limits;
  double rtol;         /* tolerance of the error estimate, which has order 3 */
  double ready;        /* 1: f0 = f(t, y) is known */
  double jacobian_age; /* 0: no Jacobian, 1: at this y, 2: at an earlier y */
  double factored;     /* signed h of the LU factors; 0: none */
  double have_path;    /* 1: the collocation polynomial of the last step is known, for start values */
  double rate, unsettled; /* last Newton iteration: contraction rate theta, and eta = theta/(1 - theta) */
  double h_accepted, err_accepted; /* size and error of the last accepted step; 0: none */
  double again;        /* 1: the last attempt was rejected */
  double t0, dt;       /* the last step */
  double tc;           /* compensation of t: rounding lost so far */
  double x[];
} Radau;

typedef struct RadauArrays {
  double *f0, *y0, *y1, *comp, *comp1, *scale, *ys, *fs, *err; /* [n] */
  /* [3 n] z = stages - y; w = T^-1 z; its correction; differences of the collocation polynomial */
  double *z, *w, *dw, *path;
  double *jacobian;              /* [(nq + nz) n] */
  double *row;                   /* [2 n] scratch */
  double *linear;                /* scratch of lag_jacobian */
  /* gamma/h - J, and the real form [alpha/h - J, -beta/h; beta/h, alpha/h - J] of the complex one */
  lag_band_matrix real, complex;
} RadauArrays;

/* Sets the pointers, unless x is NULL; returns the length of Radau.x. */
static size_t layout(RadauArrays *a, const lag_problem *pb, double *x) {
  size_t n = (size_t)pb->n, m = STAGES * n;
  const lag_part parts[] = {{&a->f0, n}, {&a->y0, n}, {&a->y1, n}, {&a->comp, n}, {&a->comp1, n}, {&a->scale, n},
      {&a->ys, n}, {&a->fs, n}, {&a->err, n}, {&a->real.pivot, n}, {&a->z, m}, {&a->w, m}, {&a->dw, m},
      {&a->path, m}, {&a->jacobian, (size_t)(pb->nq + pb->nz) * n}, {&a->row, 2 * n}, {&a->complex.pivot, 2 * n},
      {&a->real.a, n * n}, {&a->complex.a, 4 * n * n}, {&a->linear, lag_linear_work(pb->model)}};
  a->real.n = pb->n;
  a->complex.n = 2 * pb->n;
  a->real.band = pb->n - 1;
  a->complex.band = 2 * pb->n - 1;
  return lag_workspace_slice(x, sizeof parts / sizeof *parts, parts);
}

static RadauArrays arrays(Radau *w, const lag_problem *pb) {
  RadauArrays a;
  layout(&a, pb, w->x);
  return a;
}

static size_t work_size(const lag_problem *pb) {
  RadauArrays a;
  return sizeof(Radau) / sizeof(double) + layout(&a, pb, NULL);
}

static void reset(void *work, lag_problem *pb) {
  Radau *w = work;
  w->h = w->limits.h_option;
  w->ready = w->jacobian_age = w->factored = w->have_path = w->h_accepted = w->again = w->tc = 0;
  w->rate = 1;
  w->unsettled = 1;
  memset(arrays(w, pb).comp, 0, (size_t)pb->n * sizeof(double));
}

static int init(void *work, lag_problem *pb, const double *opt) {
  Radau *w = work;
  lag_step_limits_init(&w->limits, pb, opt);
  w->rtol = 0.1 * cbrt(pb->tol * pb->tol);
  reset(work, pb);
  return LAG_OK;
}

/* ---- Linear systems */

/* a->jacobian := df/dy at (t, y); the LU factors become invalid. */
static int update_jacobian(Radau *w, const RadauArrays *a, lag_problem *pb, double t, const double *y) {
  int rc = lag_jacobian(pb, t, y, a->jacobian, a->linear);
  if (rc) return lag_step_refused(pb, rc, t);
  w->jacobian_age = 1;
  w->factored = 0;
  return LAG_OK;
}

/* m := c 1 - J in the block of rows and columns from `at` on. */
static void put_minus_jacobian(const RadauArrays *a, const lag_problem *pb, const lag_band_matrix *m, int at,
                               double c) {
  int n = pb->n, nq = pb->nq;
  for (int i = 0; i < n; i++) {
    double *row = lag_band_matrix_at(m, at + i, at);
    const double *j = i < nq ? NULL : a->jacobian + (i - nq) * n;
    for (int k = 0; k < n; k++) row[k] = (i == k ? c : 0) - (j ? j[k] : k == nq + i);
  }
}

/* Builds and factors both matrices for steps of signed size h. -1: singular. */
static int factor(Radau *w, RadauArrays *a, const lag_problem *pb, double h) {
  int n = pb->n;
  put_minus_jacobian(a, pb, &a->real, 0, real_eigenvalue / h);
  memset(a->complex.a, 0, (size_t)(4 * n * n) * sizeof(double));
  put_minus_jacobian(a, pb, &a->complex, 0, eigenvalue[0] / h);
  put_minus_jacobian(a, pb, &a->complex, n, eigenvalue[0] / h);
  for (int i = 0; i < n; i++) {
    *lag_band_matrix_at(&a->complex, i, n + i) = -eigenvalue[1] / h;
    *lag_band_matrix_at(&a->complex, n + i, i) = eigenvalue[1] / h;
  }
  w->factored = 0;
  if (lag_band_matrix_factor(&a->real, a->row) || lag_band_matrix_factor(&a->complex, a->row)) return -1;
  w->factored = h;
  return 0;
}

/* out := (m (x) 1) in, for three stages of n components. */
static void apply_to_stages(const double (*m)[STAGES], int n, const double *in, double *out) {
  for (int i = 0; i < n; i++)
    for (int s = 0; s < STAGES; s++) out[s * n + i] = m[s][0] * in[i] + m[s][1] * in[n + i] + m[s][2] * in[2 * n + i];
}

/* ---- Newton's method */

/* Start values: z, w := the last collocation polynomial, extrapolated; zero where there is none. */
static void guess(const Radau *w, const RadauArrays *a, int n, double dt) {
  memset(a->z, 0, (size_t)(STAGES * n) * sizeof(double));
  for (int s = 0; s < STAGES && w->have_path != 0.0; s++) {
    double c = node[s] * dt / w->dt;
    for (int i = 0; i < n; i++)
      a->z[s * n + i] =
          c * (a->path[i] + (c - (node[1] - 1)) * (a->path[n + i] + (c - (node[0] - 1)) * a->path[2 * n + i]));
  }
  apply_to_stages(inverse_T, n, a->z, a->w);
}

/* dw := f at the stages. > 0: a smaller step may help. */
static int stages(const RadauArrays *a, lag_problem *pb, double t, const double *y, double dt) {
  int n = pb->n;
  for (int s = 0; s < STAGES; s++) {
    for (int i = 0; i < n; i++) a->ys[i] = y[i] + (a->comp[i] + a->z[s * n + i]);
    int rc = lag_rhs(pb, t + node[s] * dt, a->ys, a->dw + s * n);
    if (rc) {
      pb->bad_t = t + node[s] * dt;
      return rc < -1 ? LAG_EMODEL : rc;
    }
    if ((pb->bad_index = lag_not_finite(n, a->dw + s * n)) >= 0) {
      pb->bad_t = t + node[s] * dt;
      return LAG_ERETRY;
    }
  }
  return LAG_OK;
}

/* One Newton correction dw of w; z := T w. Returns its norm relative to the tolerance. */
static double correct(const RadauArrays *a, int n, double h) {
  double g = real_eigenvalue / h, re = eigenvalue[0] / h, im = eigenvalue[1] / h, sum = 0;
  for (int i = 0; i < n; i++) {
    double f[STAGES] = {a->dw[i], a->dw[n + i], a->dw[2 * n + i]}, r[STAGES];
    for (int s = 0; s < STAGES; s++) r[s] = inverse_T[s][0] * f[0] + inverse_T[s][1] * f[1] + inverse_T[s][2] * f[2];
    a->dw[i] = r[0] - g * a->w[i];
    a->dw[n + i] = r[1] - (re * a->w[n + i] - im * a->w[2 * n + i]);
    a->dw[2 * n + i] = r[2] - (re * a->w[2 * n + i] + im * a->w[n + i]);
  }
  lag_band_matrix_solve(&a->real, a->dw);
  lag_band_matrix_solve(&a->complex, a->dw + n);
  for (int i = 0; i < STAGES * n; i++) {
    double e = a->dw[i] / a->scale[i % n];
    a->w[i] += a->dw[i];
    sum += e * e;
  }
  apply_to_stages(T, n, a->w, a->z);
  return sqrt(sum / (STAGES * n));
}

/* Result of a Newton iteration. */
typedef struct Outcome {
  int rc;          /* LAG_OK; LAG_ERETRY, DIVERGED: a step smaller by `shrink` may converge; < 0: failure */
  double shrink;
  int corrections;
} Outcome;

static Outcome newton(Radau *w, const RadauArrays *a, lag_problem *pb, double t, const double *y, double dt) {
  double goal = fmax(10 * DBL_EPSILON / w->rtol, fmin(0.03, sqrt(w->rtol))), last = 0, last_rate = 0;
  Outcome o = {0, 0.5, 0};
  w->unsettled = pow(fmax(w->unsettled, DBL_EPSILON), 0.8);
  w->rate = contracts_well;
  pb->systems++;
  while (o.corrections < (w->limits.fixed != 0.0 ? MOST_WHEN_FIXED : MOST_CORRECTIONS)) {
    if ((o.rc = stages(a, pb, t, y, dt)) != 0) return o;
    double size = correct(a, pb->n, dt);
    o.corrections++;
    pb->iterations++;
    if (!isfinite(size)) break;
    if (o.corrections > 1) {
      double rate = size / last;
      w->rate = o.corrections == 2 ? rate : sqrt(rate * last_rate);
      last_rate = rate;
      if (w->rate >= 0.99) {
        if (size <= goal) { /* corrections are rounding and do not shrink */
          w->rate = contracts_well;
          return o;
        }
        break;
      }
      w->unsettled = w->rate / (1 - w->rate);
      int left = MOST_CORRECTIONS - 1 - o.corrections;
      /* predicted error after the last correction allowed */
      double end = w->unsettled * size * pow(w->rate, left) / goal;
      if (end >= 1 && w->limits.fixed == 0.0) {
        o.shrink = 0.8 * pow(fmax(1e-4, fmin(20, end)), -1.0 / (4 + left));
        break;
      }
    }
    last = fmax(size, DBL_EPSILON);
    if (w->unsettled * size <= goal) return o;
  }
  o.rc = DIVERGED;
  return o;
}

/* ---- Error estimate and step size */

/* a->err := (gamma/h - J)^-1 (f + sum error_weight_k z_k/h). Returns its norm, at least 1e-10. */
static double estimate(const RadauArrays *a, const lag_problem *pb, const double *f, double dt) {
  int n = pb->n;
  double s = 0;
  for (int i = 0; i < n; i++) {
    a->err[i] = f[i];
    for (int k = 0; k < STAGES; k++) a->err[i] += error_weight[k] / dt * a->z[k * n + i];
  }
  lag_band_matrix_solve(&a->real, a->err);
  for (int i = 0; i < n; i++) {
    double e = a->err[i] / a->scale[i];
    s += e * e;
  }
  return fmax(sqrt(s / n), 1e-10);
}

/* The error estimate; where it is large in the first step or after a rejected one, a second estimate, filtered for
 * stiff f. */
static double error_of(const Radau *w, const RadauArrays *a, lag_problem *pb, double t, const double *y, double dt) {
  double err = estimate(a, pb, a->f0, dt);
  if (!(err >= 1) || !(w->h_accepted == 0.0 || w->again != 0.0)) return err;
  for (int i = 0; i < pb->n; i++) a->ys[i] = y[i] + a->err[i];
  if (lag_rhs(pb, t, a->ys, a->fs) || lag_not_finite(pb->n, a->fs) >= 0) return err;
  return estimate(a, pb, a->fs, dt);
}

/* Factor by which h is divided for this error and this number of corrections. */
static double step_divisor(const Radau *w, double err, int corrections, int accepted) {
  double slow = fmin(safety, safety * (1 + 2 * MOST_CORRECTIONS) / (corrections + 2 * MOST_CORRECTIONS));
  double quot = fmax(1 / grow_most, fmin(1 / shrink_most, sqrt(sqrt(err)) / slow));
  if (accepted && w->h_accepted > 0) {
    double seen = w->h_accepted / w->h * sqrt(sqrt(err * err / w->err_accepted)) / safety;
    quot = fmax(quot, fmax(1 / grow_most, fmin(1 / shrink_most, seen)));
  }
  return quot;
}

/* Size of the step after an accepted one; h is kept where the LU factors then can be. */
static void next_size(Radau *w, double quot, double err) {
  double h = w->h / quot;
  w->h_accepted = w->h;
  w->err_accepted = fmax(1e-2, err);
  if (w->again != 0.0) h = fmin(h, w->h);
  w->again = 0;
  int well = w->rate <= contracts_well, same = h >= keep_least * w->h && h <= keep_most * w->h;
  w->jacobian_age = well ? 2 : 0;
  if (!(well && same)) w->h = h;
}

/* ---- Step */

/* a->path := divided differences of the collocation polynomial from the end of the step (code RADAU5, CONT). */
static void store_polynomial(const RadauArrays *a, int n) {
  double c1 = node[0], c2 = node[1];
  for (int i = 0; i < n; i++) {
    double z1 = a->z[i], z2 = a->z[n + i], z3 = a->z[2 * n + i], k = (z1 - z2) / (c1 - c2);
    a->path[i] = (z2 - z3) / (c2 - 1);
    a->path[n + i] = (k - a->path[i]) / (c1 - 1);
    a->path[2 * n + i] = a->path[n + i] - (k - z1 / c1) / c2;
  }
}

static void accept(Radau *w, const RadauArrays *a, lag_problem *pb, double *t, double *y, const lag_aimed *to) {
  size_t bytes = (size_t)pb->n * sizeof(double);
  store_polynomial(a, pb->n);
  memcpy(a->y0, y, bytes);
  memcpy(y, a->y1, bytes);
  memcpy(a->comp, a->comp1, bytes);
  memcpy(a->f0, a->fs, bytes);
  w->have_path = 1;
  w->t0 = *t;
  w->dt = pb->dir * to->h;
  w->tc = to->lost;
  *t = to->t;
}

/* y1 := end of the step, projected to the constraints; fs := f there. > 0: a smaller step may help. */
static int finish(const RadauArrays *a, lag_problem *pb, double tb, const double *y) {
  int n = pb->n, rc;
  for (int i = 0; i < n; i++) {
    a->comp1[i] = a->comp[i];
    a->y1[i] = lag_compensated_sum(y[i], a->z[2 * n + i], &a->comp1[i]);
  }
  rc = lag_project_step(pb, tb, y, a->y1, a->comp1);
  rc = rc ? rc : lag_rhs(pb, tb, a->y1, a->fs);
  if (rc || (pb->bad_index = lag_not_finite(n, a->fs)) >= 0) {
    pb->bad_t = tb;
    return rc < -1 ? LAG_EMODEL : rc ? rc : LAG_ERETRY;
  }
  return LAG_OK;
}

/* Before a step: f0, scale of errors, and w->h, the step to try. */
static int prepare(Radau *w, const RadauArrays *a, lag_problem *pb, double t, const double *y) {
  lag_tolerance tol = {w->rtol, &w->limits};
  int rc = w->ready != 0.0 ? 0 : lag_step_rhs(pb, t, y, a->f0);
  if (rc) return rc;
  w->ready = 1;
  for (int i = 0; i < pb->n; i++) a->scale[i] = w->rtol * lag_tolerance_floor(&w->limits, pb, i) + w->rtol * fabs(y[i]);
  lag_step_limits_begin(&w->limits, t);
  if (w->h == 0.0)
    w->h = lag_first_step(pb, &tol, (lag_first_try){.order = 5, .t = t, .y = y, .f = a->f0, .y1 = a->ys, .f1 = a->fs});
  return LAG_OK;
}

/* Computes the end of an accepted step and the size of the next. > 0: a smaller step may help. */
static int conclude(Radau *w, const RadauArrays *a, lag_problem *pb, double tb, const double *y, double err,
                    int corrections) {
  int rc = finish(a, pb, tb, y);
  if (rc) w->h /= 2;
  else if (w->limits.fixed != 0.0) w->jacobian_age = 0;
  else next_size(w, step_divisor(w, err, corrections, 1), err);
  return rc;
}

/* One attempt at a step of dt. 0: it can be accepted. > 0: rejected, and w->h is the next size to try. */
static int attempt(Radau *w, RadauArrays *a, lag_problem *pb, double t, double tb, const double *y, double dt) {
  int rc = w->jacobian_age == 0.0 ? update_jacobian(w, a, pb, t, y) : 0;
  if (rc) return rc;
  if (w->factored != dt && factor(w, a, pb, dt)) {
    w->h /= 2;
    return DIVERGED;
  }
  guess(w, a, pb->n, dt);
  Outcome o = newton(w, a, pb, t, y, dt);
  if (o.rc) {
    w->h *= o.shrink;
    return o.rc;
  }
  double err = w->limits.fixed != 0.0 ? 0 : error_of(w, a, pb, t, y, dt);
  if (err < 1) return conclude(w, a, pb, tb, y, err, o.corrections);
  w->h = w->h_accepted == 0.0 ? 0.1 * w->h : w->h / (isfinite(err) ? step_divisor(w, err, o.corrections, 0) : 2);
  return REJECTED;
}

/* Status after the last attempt failed for `why`: h is at its minimum, or steps are of fixed size. */
static int failure_status(const Radau *w, lag_problem *pb, double t, int why) {
  if (why == LAG_ERETRY) {
    return pb->bad_index >= 0 ? LAG_ENAN : LAG_EDOMAIN; /* bad_t is set */
  }
  if (why == DIVERGED) {
    pb->detail = w->limits.fixed != 0.0 ? "Newton's method did not converge; take smaller steps, or leave out adapt=off"
                                 : "Newton's method does not converge, however small the step";
  }
  return lag_step_failed(pb, why == DIVERGED ? LAG_EMETHOD : LAG_ESTEP, t);
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  Radau *w = work;
  RadauArrays a = arrays(w, pb);
  int rc = prepare(w, &a, pb, *t, y), why = REJECTED;
  (void)t_stop;
  w->h = w->limits.fixed != 0.0 ? w->limits.h_option : w->h;
  while (rc == 0) {
    double wanted = fmin(w->h, lag_longest_step(&w->limits, *t, pb->longest)), kick, gap = lag_next_kick(pb, *t, &kick);
    const lag_aimed next = lag_aim(*t, w->tc, pb->dir, wanted, gap, kick);
    const double dt = pb->dir * next.h;
    w->h = next.h;
    if (w->h <= 4 * DBL_EPSILON * fabs(*t) || w->h < DBL_MIN / DBL_EPSILON) return failure_status(w, pb, *t, why);
    pb->bad_index = -1;
    why = attempt(w, &a, pb, *t, next.t, y, dt);
    if (why == 0) {
      accept(w, &a, pb, t, y, &next);
      w->h = next.clipped ? fmax(w->h, wanted) : w->h;
      return LAG_OK;
    }
    if (why < 0) return why;
    if (w->limits.fixed != 0.0) return failure_status(w, pb, *t, why);
    w->jacobian_age = w->jacobian_age == 1.0 ? 1 : 0;
    w->again = 1;
    pb->rejected++;
  }
  return rc;
}

/* y[n] := the collocation polynomial that ends at y1, a part s of the step later. */
static void path_at(int n, const double *y1, const double *path, double s, double *y) {
  for (int i = 0; i < n; i++)
    y[i] = y1[i] + s * (path[i] + (s - (node[1] - 1)) * (path[n + i] + (s - (node[0] - 1)) * path[2 * n + i]));
}

static void dense(void *work, lag_problem *pb, double t, double *y) {
  Radau *w = work;
  RadauArrays a = arrays(w, pb);
  path_at(pb->n, a.y1, a.path, (t - (w->t0 + w->dt)) / w->dt, y);
}

/* ---- Derivative of a step */

static size_t tangent_size(const lag_problem *pb, int k) {
  return lag_tangent_implicit_size(pb, STAGES, k) + (size_t)(STAGES * pb->n);
}

/* The stages are values of the collocation polynomial. */
static int tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch) {
  Radau *w = work;
  int n = pb->n;
  double dt = lag_tangent_span(w->t0, t, w->dt);
  for (int s = 0; s < STAGES; s++) dense(w, pb, w->t0 + node[s] * dt, scratch + s * n);
  return lag_tangent_implicit((lag_implicit_rk){STAGES, butcher[0], node}, (lag_step_taken){pb, w->t0, dt, scratch},
                              k, Y, scratch + STAGES * n);
}

static double span(const void *work, const lag_problem *pb, double t) {
  const Radau *w = work;
  (void)pb;
  return lag_tangent_span(w->t0, t, w->dt);
}

/* The length of the whole step and its polynomial. */
static size_t kept(const lag_problem *pb) { return 1 + (size_t)((STAGES + 1) * pb->n); }

static void keep(void *work, const lag_problem *pb, double *x) {
  Radau *w = work;
  RadauArrays a = arrays(w, pb);
  size_t n = (size_t)pb->n;
  x[0] = w->dt;
  memcpy(x + 1, a.y1, n * sizeof *x);
  memcpy(x + 1 + n, a.path, STAGES * n * sizeof *x);
}

static size_t adjoint_size(const lag_problem *pb) {
  return pb->model->constraints ? 0 : lag_reverse_implicit_size(pb, STAGES) + (size_t)(STAGES * pb->n);
}

static int adjoint(lag_problem *pb, double t0, double dt, const double *y0, double *x, double *g, double *scratch) {
  int n = pb->n;
  const double *whole = y0 + n, *y1 = whole + 1;
  for (int s = 0; s < STAGES; s++) path_at(n, y1, y1 + n, node[s] * dt / *whole - 1, scratch + s * n);
  return lag_reverse_implicit((lag_implicit_rk){STAGES, butcher[0], node}, (lag_step_taken){pb, t0, dt, scratch}, x, g,
                              scratch + STAGES * n);
}

const lag_method lag_radau = {
    .name = "radau",
    .order = 5,
    .dense_order = 3,
    .doc = "Radau IIA with the exact Jacobian (of constrained models a differenced one), for stiff models. DOI "
           "10.1007/978-3-642-05221-7, IV.8",
    .flags = LAG_METHOD_ADAPTIVE | LAG_METHOD_NEWTON | LAG_METHOD_JACOBIAN | LAG_METHOD_CONSTRAINTS,
    .noptions = LAG_NADAPTIVE_OPTIONS,
    .options = lag_adaptive_rk_options,
    LAG_METHOD_FUNCTIONS,
    LAG_METHOD_TANGENT,
    .span = span,
    .adjoint_size = adjoint_size,
    .adjoint = adjoint,
    .kept = kept,
    .keep = keep,
};
