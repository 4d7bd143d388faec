/* Gauss collocation of first-order systems. Enters: t, y; leaves: t + h, y one step later. Holds: the stage
 * equations are solved to rounding, so that the invariants of the exact method are conserved to rounding, for any
 * step:
 *
 *   every quadratic invariant of the flow (G.J. Cooper, IMA J. Numer. Anal. 7 (1987) 1, DOI 10.1093/imanum/7.1.1),
 *   as the impulse and
 *     the angular impulse of point vortices;
 *   a two-form with constant coefficients that the flow conserves, because it is a quadratic invariant of the
 *   variational equation
 *     (P.B. Bochev, C. Scovel, BIT 34 (1994) 337, DOI 10.1007/BF01935643): L = theta q' - H where the two-form
 *     dtheta is constant. There
 *     the method is symplectic, and the energy stays within a band.
 *
 * Where the two-form varies the method is symmetric: the energy of reversible motions has no trend; for others no
 * bound is known. Why not the discrete Lagrangian of midpoints, of order 2 for any L: where L is linear in the
 * velocities its equations are those of a two-step method, whose second root, -1, lies on the unit circle:
 * neighbouring points separate into two families (C.L. Ellison et al., Phys. Plasmas 25 (2018) 052502, DOI
 * 10.1063/1.5022277; M. Kraus, arXiv:1708.07356). Collocation is a one-step method and has no such mode; for a
 * constant two-form and a linear theta it is the variational integrator whose momenta are theta(q) at every step.
 *
 * Dense output: the cubic through both ends for at most two stages, a shorter step for more. */
#include "methods/collocation.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "kernels/predictor.h"
#include "kernels/galerkin_rule.h"
#include "kernels/newton.h"
#include "methods/steps.h"
#include "methods/method_tangent.h"
#include "numeric/workspace.h"

enum { STAGES_WITH_CUBIC = 2 };

/* Saved state of the method, doubles only; CollocationArrays has pointers into x. */
typedef struct Collocation {
  lag_fixed_step step;
  double ends;   /* 1: f0, f1 belong to the last step; -1: the model has no value there; 0: not computed */
  lag_rule rule;
  double x[];
} Collocation;

typedef struct CollocationArrays {
  double *comp, *y0, *y1, *f0, *f1, *Y; /* [n] compensation of y; y and f at both ends of the last step; a stage */
  double *u, *other;                    /* [stages n] slopes at the stages of the last step, and of a shorter one */
  double *R, *scale;                    /* [stages n] residuals, then corrections; scratch */
  double *jacobian, *linear;            /* [n n]; scratch of lag_jacobian */
  double *history;
  lag_band_matrix J;
} CollocationArrays;

/* Sets the pointers, unless x is NULL; returns the length of Collocation.x. */
static size_t layout(CollocationArrays *a, const lag_problem *pb, int stages, double *x) {
  size_t n = (size_t)pb->n, m = n * (size_t)stages;
  const lag_part parts[] = {{&a->comp, n}, {&a->y0, n}, {&a->y1, n}, {&a->f0, n}, {&a->f1, n}, {&a->Y, n},
      {&a->u, m}, {&a->other, m}, {&a->R, m}, {&a->scale, m}, {&a->J.pivot, m}, {&a->jacobian, n * n},
      {&a->linear, lag_linear_work(pb->model)}, {&a->history, (size_t)LAG_PREDICTOR_SIZE((int)m)}, {&a->J.a, m * m}};
  a->J.n = (int)m;
  a->J.band = (int)m - 1;
  return lag_workspace_slice(x, sizeof parts / sizeof *parts, parts);
}

static CollocationArrays arrays(Collocation *w, const lag_problem *pb) {
  CollocationArrays a;
  layout(&a, pb, (int)w->rule.free, w->x);
  return a;
}

size_t lag_collocation_size(const lag_problem *pb, int stages) {
  CollocationArrays a;
  return sizeof(Collocation) / sizeof(double) + layout(&a, pb, stages, NULL);
}

void lag_collocation_reset(void *work, lag_problem *pb) {
  Collocation *w = work;
  CollocationArrays a = arrays(w, pb);
  int m = pb->n * (int)w->rule.free;
  w->step.tc = w->ends = 0;
  memset(a.comp, 0, (size_t)pb->n * sizeof(double));
  memset(a.history, 0, (size_t)LAG_PREDICTOR_SIZE(m) * sizeof(double));
}

void lag_collocation_init(void *work, lag_problem *pb, double h, int stages) {
  Collocation *w = work;
  w->step.h = h;
  memset(&w->rule, 0, sizeof w->rule);
  lag_rule_gauss(&w->rule, stages);
  lag_collocation_reset(work, pb);
}

/* ---- The equations u_i = f(t + c_i h, y0 + h sum_k a_ik u_k) */

/* A step to be solved: from y0 at t, of length h; comp[n] is the compensation of y0, or NULL. */
typedef struct Step {
  double t, h;
  const double *y0, *comp;
  double *u;
  int counted; /* 1: its corrections count as iterations of the method */
} Step;

/* Y[n] := y at stage i. */
static void stage(const Collocation *w, const Step *s, int n, int i, double *Y) {
  for (int j = 0; j < n; j++) {
    double moved = 0;
    for (int k = 0; k < (int)w->rule.free; k++) moved += w->rule.integral[i][k] * s->u[k * n + j];
    Y[j] = s->y0[j] + ((s->comp ? s->comp[j] : 0) + s->h * moved);
  }
}

static double time_of(const Collocation *w, const Step *s, int i) { return s->t + w->rule.c[i] * s->h; }

/* R := f - u at all stages. LAG_OK, or a failure. */
static int residual(const Collocation *w, const CollocationArrays *a, lag_problem *pb, const Step *s) {
  int n = pb->n;
  for (int i = 0; i < (int)w->rule.free; i++) {
    stage(w, s, n, i, a->Y);
    int rc = lag_step_rhs(pb, time_of(w, s, i), a->Y, a->R + i * n);
    if (rc) return rc;
    for (int j = 0; j < n; j++) a->R[i * n + j] -= s->u[i * n + j];
  }
  return LAG_OK;
}

/* Factors Newton's matrix 1 - h a_ik J_i at the present stages. */
static int matrix(const Collocation *w, CollocationArrays *a, lag_problem *pb, const Step *s) {
  lag_tangent at = {pb, 0, a->jacobian, a->linear, NULL, 0};
  for (int i = 0; i < (int)w->rule.free; i++) {
    stage(w, s, pb->n, i, a->Y);
    int rc = lag_tangent_at(&at, time_of(w, s, i), a->Y, NULL);
    if (rc) return rc;
    lag_tangent_put_stage(&at, &a->J, (int)w->rule.free, i, s->h, w->rule.integral[i]);
  }
  if (lag_band_matrix_factor(&a->J, a->scale)) {
    pb->detail = "the matrix of Newton's method is singular; take another step size";
    return lag_step_failed(pb, LAG_EMETHOD, s->t);
  }
  return LAG_OK;
}

/* One Newton correction of u. */
static lag_correction correct(const Collocation *w, const CollocationArrays *a, int n, const Step *s) {
  int m = n * (int)w->rule.free;
  lag_correction size = {0, 0};
  lag_band_matrix_solve(&a->J, a->R);
  for (int i = 0; i < m; i++) {
    s->u[i] += a->R[i];
    size.part = fmax(size.part, lag_relative_correction(fabs(w->step.h), a->R[i], s->u[i], s->y0[i % n]));
  }
  size.rounding = size.part;
  return size;
}

/* Newton's method for u, from the guess in u. */
static int solve(const Collocation *w, CollocationArrays *a, lag_problem *pb, const Step *s) {
  lag_correction before = {1, 1};
  pb->systems += s->counted;
  for (int turn = 0; turn <= LAG_MOST_CORRECTIONS; turn++) {
    int fresh = lag_newton_needs_matrix(turn, before), rc = residual(w, a, pb, s);
    rc = rc || !fresh ? rc : matrix(w, a, pb, s);
    if (rc) return rc;
    lag_correction now = correct(w, a, pb->n, s);
    pb->iterations += s->counted;
    if (lag_newton_has_converged(now, before, fresh, turn, DBL_EPSILON)) return LAG_OK;
    before = now;
  }
  snprintf(
      pb->words, sizeof pb->words,
      "in a step of %.3g s Newton's method did not converge in %d corrections; take smaller steps, or radau or dop853",
      fabs(w->step.h), LAG_MOST_CORRECTIONS);
  pb->detail = pb->words;
  return lag_step_failed(pb, LAG_EMETHOD, s->t);
}

/* Initial guess: u := the slope at the start of the step, for all stages. */
static int constant_slope_guess(const Collocation *w, const CollocationArrays *a, lag_problem *pb, const Step *s) {
  int n = pb->n, rc = lag_step_rhs(pb, s->t, s->y0, a->Y);
  for (int i = 0; i < (int)w->rule.free && rc == 0; i++) memcpy(s->u + i * n, a->Y, (size_t)n * sizeof *s->u);
  return rc;
}

int lag_collocation_step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  Collocation *w = work;
  CollocationArrays a = arrays(w, pb);
  int n = pb->n, m = n * (int)w->rule.free;
  lag_next_step next;
  int rc = lag_fixed_step_begin(&w->step, pb, *t, &next);
  Step s = {.t = *t, .h = next.dt, .y0 = y, .comp = a.comp, .u = a.u, .counted = 1};
  (void)t_stop;
  if (rc) return rc;
  rc = LAG_EMETHOD;
  if (lag_predictor_guess(a.history, m, a.u)) rc = solve(w, &a, pb, &s);
  if (rc != 0 && (rc = constant_slope_guess(w, &a, pb, &s)) == 0) rc = solve(w, &a, pb, &s);
  if (rc) return rc;
  pb->detail = NULL;
  lag_predictor_add(a.history, m, a.u);
  memcpy(a.y0, y, (size_t)n * sizeof *y);
  for (int j = 0; j < n; j++) {
    double moved = 0;
    for (int k = 0; k < (int)w->rule.free; k++) moved += w->rule.whole[k] * a.u[k * n + j];
    y[j] = lag_compensated_sum(y[j], next.dt * moved, &a.comp[j]);
  }
  memcpy(a.y1, y, (size_t)n * sizeof *y);
  w->ends = 0;
  lag_fixed_step_end(&w->step, &next, t);
  return LAG_OK;
}

/* ---- Between steps */

/* Solves a step of length dt from the start of the last one; slopes into a->other. */
static int shorter(const Collocation *w, CollocationArrays *a, lag_problem *pb, double dt) {
  Step s = {.t = w->step.t0, .h = dt, .y0 = a->y0, .u = a->other};
  int rc = constant_slope_guess(w, a, pb, &s);
  return rc ? rc : solve(w, a, pb, &s);
}

/* y at s in [0, 1] of the last step: Hermite cubic, or linear where the model has no value at an end. */
static void cubic(Collocation *w, const CollocationArrays *a, lag_problem *pb, double s, double *y) {
  int n = pb->n;
  if (w->ends == 0.0) {
    int rc = lag_rhs(pb, w->step.t0, a->y0, a->f0) || lag_rhs(pb, w->step.t0 + w->step.dt, a->y1, a->f1);
    w->ends = rc || lag_not_finite(n, a->f0) >= 0 || lag_not_finite(n, a->f1) >= 0 ? -1 : 1;
  }
  if (w->ends > 0) {
    lag_hermite(0, n, w->step.dt, s, a->y0, a->f0, a->y1, a->f1, y);
    return;
  }
  for (int j = 0; j < n; j++) y[j] = a->y0[j] + s * (a->y1[j] - a->y0[j]);
}

void lag_collocation_dense(void *work, lag_problem *pb, double t, double *y) {
  Collocation *w = work;
  CollocationArrays a = arrays(w, pb);
  int n = pb->n, stages = (int)w->rule.free;
  double dt = t - w->step.t0, s = dt / w->step.dt;
  if (stages <= STAGES_WITH_CUBIC || s <= 0 || s >= 1 || shorter(w, &a, pb, dt) != 0) {
    cubic(w, &a, pb, s, y);
    return;
  }
  for (int j = 0; j < n; j++) {
    double moved = 0;
    for (int k = 0; k < stages; k++) moved += w->rule.whole[k] * a.other[k * n + j];
    y[j] = a.y0[j] + dt * moved;
  }
}

/* ---- Derivative of a step */

enum { WITH_END = LAG_RULE_FREE + 1 };

size_t lag_collocation_tangent_size(const lag_problem *pb, int k) {
  return lag_tangent_implicit_size(pb, WITH_END, k) + (size_t)(WITH_END * pb->n);
}

/* The end of the step is an additional last stage, on which no other stage depends. */
int lag_collocation_tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch) {
  Collocation *w = work;
  CollocationArrays a = arrays(w, pb);
  int n = pb->n, stages = (int)w->rule.free, all = stages + 1;
  double A[WITH_END * WITH_END] = {0}, c[WITH_END], step = w->step.h * pb->dir,
                      dt = lag_tangent_span(w->step.t0, t, step);
  Step s = {.t = w->step.t0, .h = dt, .y0 = a.y0, .u = a.u};
  if (dt != step) {
    int rc = shorter(w, &a, pb, dt);
    if (rc) return rc;
    s.u = a.other;
  }
  for (int i = 0; i < stages; i++) {
    memcpy(A + i * all, w->rule.integral[i], (size_t)stages * sizeof *A);
    c[i] = w->rule.c[i];
    stage(w, &s, n, i, scratch + i * n);
  }
  memcpy(A + stages * all, w->rule.whole, (size_t)stages * sizeof *A);
  c[stages] = 1;
  lag_collocation_dense(w, pb, t, scratch + stages * n);
  return lag_tangent_implicit((lag_implicit_rk){all, A, c}, (lag_step_taken){pb, w->step.t0, dt, scratch}, k, Y,
                              scratch + WITH_END * n);
}
