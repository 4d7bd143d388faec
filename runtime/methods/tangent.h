/* Derivatives of steps: what a step does to small changes of the state it begins from, exactly, by the derivatives that the
 * compiler emits. Changes are the columns of a matrix Y[n * k], stored row by row; row i belongs to component i of y. */
#ifndef LAG_METHODS_TANGENT_H
#define LAG_METHODS_TANGENT_H

#include <float.h>
#include <math.h>

#include "lag.h"
#include "methods/tableau.h"

/* Doubles of scratch for lag_tangent_explicit; with 0 stages, for what lag_tangent_layout takes, two vectors and two matrices. */
size_t lag_tangent_size(const lag_problem *pb, int stages, int k);

/* Y := dy1/dy0 Y for the step of an explicit method from (t0, y0), of length dt: the method applied to y' = f, Y' = Df Y.
 * LAG_OK, or a failure with its place in pb; Y is then spoilt. */
int lag_tangent_explicit(const lag_tableau *tab, lag_problem *pb, double t0, double dt, const double *y0, int k, double *Y,
                         double *scratch);

/* The same for an implicit method whose last stage is the result, with the matrix A[stages * stages], its nodes c, and its stages
 * ys[stages * n] as they were found, by the implicit function theorem. */
size_t lag_tangent_implicit_size(const lag_problem *pb, int stages, int k);
int lag_tangent_implicit(int stages, const double *A, const double *c, lag_problem *pb, double t0, double dt, const double *ys, int k,
                         double *Y, double *scratch);

/* What a stage needs: df/dy at (t, y) from here on. f[n], unless NULL: f(t, y), too. */
typedef struct lag_tangent {
  lag_problem *pb;
  int k;
  double *jacobian; /* [(nq + nz) n] */
  double *linear;   /* scratch of lag_jacobian */
} lag_tangent;

/* Lays the parts out in scratch; *rest is what is left of it. */
lag_tangent lag_tangent_layout(lag_problem *pb, int k, double *scratch, double **rest);
int lag_tangent_at(const lag_tangent *w, double t, const double *y, double *f);

/* out[n k] := df/dy Y. */
void lag_tangent_times(const lag_tangent *w, const double *Y, double *out);

/* How long the step from t0 to t is: dt, where t is the end of the step of that length but for rounding. */
static inline double lag_tangent_span(double t0, double t, double dt)
{
  double span = t - t0, rounding = 4 * DBL_EPSILON * (fabs(t0) + fabs(t));

  return fabs(span - dt) <= rounding ? dt : span;
}

/* out[m] += c x[m] */
static inline void lag_tangent_add(int m, double c, const double *restrict x, double *restrict out)
{
  for (int i = 0; i < m; i++) {
    out[i] += c * x[i];
  }
}

#endif
