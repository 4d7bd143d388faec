/* Exact derivatives of steps by their start, from the derivatives that the compiler emits: a step maps k small
 * changes of the state, the columns of Y[n * k] (row-major; row i belongs to component i of y). */
#pragma once

#include <float.h>
#include <math.h>

#include "lag.h"
#include "kernels/band_matrix.h"
#include "methods/tableau.h"

/* Doubles of scratch of lag_tangent_explicit; with 0 stages: for lag_tangent_layout, two vectors [n] and two
 * matrices [n k]. */
size_t lag_tangent_size(const lag_problem *pb, int stages, int k);

/* A step from t0 of length dt. y: the state y0[n] at its start; of an implicit method its solved stages [stages n]. */
typedef struct lag_step_taken {
  lag_problem *pb;
  double t0, dt;
  const double *y;
} lag_step_taken;

/* Y := dy1/dy0 Y for a step of an explicit method: the method applied to y' = f, Y' = Df Y. LAG_OK, or a failure with
 * its time in pb; Y is then undefined. */
int lag_tangent_explicit(const lag_tableau *tab, lag_step_taken step, int k, double *Y, double *scratch);

/* An implicit Runge-Kutta method whose last stage is the result: matrix A[stages * stages], nodes c. */
typedef struct lag_implicit_rk {
  int stages;
  const double *A, *c;
} lag_implicit_rk;
/* The same for its step, by the implicit function theorem. */
size_t lag_tangent_implicit_size(const lag_problem *pb, int stages, int k);
int lag_tangent_implicit(lag_implicit_rk of, lag_step_taken step, int k, double *Y, double *scratch);

/* The same along a given motion path(t), from any method: Y' = Df(t, path(t)) Y by dop853 with its own steps. The
 * error of each entry of Y, relative to the entry and its change over dt, is below max(pb->tol, 1e-14). */
typedef void lag_tangent_path(void *work, lag_problem *pb, double t, double *y);
size_t lag_tangent_along_size(const lag_problem *pb, int k);
int lag_tangent_along(lag_tangent_path *path, void *work, lag_step_taken step, int k, double *Y, double *scratch);

/* The Jacobian at a stage. */
typedef struct lag_tangent {
  lag_problem *pb;
  int k;
  double *jacobian; /* [(nq + nz) width] */
  double *linear;   /* scratch of lag_jacobian */
  const lag_parameter_columns *by; /* columns by parameters; NULL: none */
  int listed;                      /* only the listed elements of jacobian are known: lag_listed_jacobian */
} lag_tangent;

static inline int lag_tangent_width(const lag_tangent *w) { return w->pb->n + (w->by ? w->by->n : 0); }

/* A lag_tangent in scratch; *rest := the unused remainder of scratch. products: its Jacobian serves only in
 * lag_tangent_times. */
lag_tangent lag_tangent_layout(lag_problem *pb, int k, int products, double *scratch, double **rest);
/* w->jacobian := df/dy, and behind it in each row df by the parameters of columns, at (t, y), and f[n], unless NULL, :=
 * f(t, y). LAG_OK, or a failure. */
int lag_tangent_at(const lag_tangent *w, double t, const double *y, double *f);

/* Sets the rows of stage s of m = 1 - dt A (x) df/dy, the matrix of an implicit Runge-Kutta method; a[stages]: row s
 * of A. */
void lag_tangent_put_stage(const lag_tangent *w, const lag_band_matrix *m, int stages, int s, double dt,
                           const double *a);

/* out[n k] := df/dy Y, and df by its parameter in each column that has one. */
void lag_tangent_times(const lag_tangent *w, const double *Y, double *out);

/* Length of the step from t0 to t: exactly dt where t is the end of the last step, up to rounding. */
static inline double lag_tangent_span(double t0, double t, double dt) {
  double span = t - t0, rounding = 4 * DBL_EPSILON * (fabs(t0) + fabs(t));
  return fabs(span - dt) <= rounding ? dt : span;
}

/* out[m] += c x[m] */
static inline void lag_tangent_add(int m, double c, const double *restrict x, double *restrict out) {
  for (int i = 0; i < m; i++) out[i] += c * x[i];
}

/* ---- Reverse mode */

/* Scratch of a reverse sweep over so many stages: y and f of each, weights of each; products. */
size_t lag_reverse_size(const lag_problem *pb, int stages);

/* Length of f below: the rates, and the multipliers of constraints. */
int lag_reverse_width(const lag_problem *pb);
/* f := f(t, y) with the multipliers. */
int lag_reverse_rates(lag_problem *pb, double t, const double *y, double *f);

/* Where products by inputs and parameters are added up, g[nu + np]; a vector k[n]; a product out[n]; room[nu + np +
 * formulas + width]. */
typedef struct lag_reverse {
  lag_problem *pb;
  double *g, *k, *out, *room;
} lag_reverse;
/* The parts behind g in scratch. */
lag_reverse lag_reverse_layout(lag_problem *pb, double *g, double *scratch);

/* out[n] := (df/dy)^T x at (t, y), where f = f(t, y) is known, and g += (df/du, df/dp)^T x. LAG_OK, or a failure. */
int lag_reverse_at(const lag_reverse *w, double t, const double *y, const double *f, const double *x, double *out);

/* lag_method.adjoint of an explicit method. */
int lag_reverse_explicit(const lag_tableau *tab, lag_step_taken step, double *x, double *g, double *scratch);

/* The same of an implicit one, by the transposed equations of lag_tangent_implicit. */
size_t lag_reverse_implicit_size(const lag_problem *pb, int stages);
int lag_reverse_implicit(lag_implicit_rk of, lag_step_taken step, double *x, double *g, double *scratch);
