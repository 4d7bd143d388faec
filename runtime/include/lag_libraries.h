/* lag_libraries.h: what liblag asks of other libraries, where a program has them: linear algebra of equilibria,
 * arrays in files, processes that share a sweep. lag.h includes it; its conventions and status codes hold here, too.
 * */
#ifndef LAG_LIBRARIES_H
#define LAG_LIBRARIES_H

#include <stddef.h>

/* n equations in n unknowns: f[n] at x[n] and, where J is not NULL, J[n*n], row-major, their derivatives. Not 0: no
 * values at x. */
typedef int lag_equations(void *context, const double *x, double *f, double *J);

/* The dense linear algebra that the analysis of equilibria takes from a library: row-major; eigenvectors are
 * columns. All return LAG_OK, LAG_ENOMEM, or the status given below; none prints or aborts. */
typedef struct lag_algebra {
  const char *name;

  /* Moves x[n] towards a root by a trust region whose first radius is 0.3 max(1, |x|), in at most `most` steps,
   * until no step gains. The Jacobian may be singular. The caller checks whether x is a root. *steps: steps made.
   * LAG_EDOMAIN: no values at the start. */
  int (*root)(int n, double *x, lag_equations *equations, void *context, int most, int *steps);

  /* K x = value M x; values ascending, x' M x = 1. K and M are symmetric (lower triangles are read) and destroyed.
   * LAG_EINVAL: M is not positive definite. */
  int (*symmetric)(int n, double *K, double *M, double *values, double *vectors);

  /* A x = (re + i im) x, |x| = 1. A is destroyed. sensitivity[k] = |x_k| |y_k| / |y_k x_k| with the left eigenvector
   * y_k: the condition number of the eigenvalue; huge where it is defective. LAG_EMETHOD: no convergence. */
  int (*general)(int n, double *A, double *re, double *im, double *vre, double *vim, double *sensitivity);

  /* Balancing: A := D^-1 A D with D = diag(scale[n]) of powers of 2, so that rows and columns have like norms. */
  int (*balance)(int n, double *A, double *scale);

  /* Orthogonal Q[n*n] with A Q = [B | 0]: its columns from *rank on span the kernel of A; pivots up to tol count as
   * 0. */
  int (*kernel)(int n, const double *A, double tol, double *Q, int *rank);
} lag_algebra;

/* f[m] at x[n]; J[m * n], row-major, their derivatives; either may be NULL. Not 0: no values at x. */
typedef int lag_residuals_at(void *context, const double *x, double *f, double *J);

/* A function *f of x[n], and its gradient g[n] unless that is NULL. Not 0: no value at x. */
typedef int lag_objective_at(void *context, const double *x, double *f, double *g);

/* Nonlinear least squares, and the statistics that go with them. */
typedef struct lag_least_squares {
  /* Moves x[n] to a minimum of |f|^2, m >= n, in at most `most` steps; *steps: made. LAG_OK; LAG_EMETHOD: not reached;
   * LAG_EDOMAIN: no values at the start; LAG_ENOMEM. J may be of lower rank than n. */
  int (*minimise)(int m, int n, double *x, lag_residuals_at *residuals, void *context, int most, int *steps);
  /* A[m * n] = U diag(values) V^T, m >= n, values descending; A := U, V[n * n]. LAG_OK or LAG_EMETHOD. */
  int (*singular_values)(int m, int n, double *A, double *values, double *V);
  /* Probability that chi squared, or Fisher's F, with so many degrees of freedom is larger. */
  double (*chance_of_more)(double chi_squared, double freedom);
  double (*chance_of_f)(double f, double above, double below);
  /* Moves x[n] to lower values of a function by quasi-Newton steps (BFGS); each is followed by goes_on(context, f),
   * which ends the search with 0. LAG_OK: ended so, or no step gains; LAG_EMETHOD: `most` steps; LAG_EDOMAIN: no value
   * at the start; LAG_ENOMEM. */
  int (*descend)(int n, double *x, lag_objective_at *objective, int (*goes_on)(void *, double), void *context, int most,
                 int *steps);
} lag_least_squares;

/* Rows or motions of a sweep as arrays: the columns x[n of all axes, multiplied], the last axis fastest. */
enum { LAG_GRID_MOST = 32 };
typedef struct lag_axis {
  const char *name, *unit;
  long long n;
  const double *x;
} lag_axis;

typedef struct lag_grid {
  const char *title;
  int naxes, ncolumns;
  const lag_axis *axis, *column; /* n of a column: of all axes */
  /* NULL, or block[columns whose x is NULL][n of the last axis] := their values at the next place of the other axes,
   * over which the other columns stand. 0, or -1 */
  int (*next)(void *context, double *block);
  void *context;
} lag_grid;

/* Processes that share a sweep. Rank 0 is the first; one thread at a time calls. */
typedef struct lag_ranks {
  /* Joins the processes that were started together: *rank of this one, *n of all. 0, or -1 */
  int (*join)(int *rank, int *n);
  /* bytes[n] of all := those of rank 0. All call it. 0, or -1 */
  int (*share)(void *bytes, size_t n);
  /* Sends a copy of bytes[n], and does not wait for its arrival. 0, or -1 */
  int (*send)(int rank, const void *bytes, size_t n);
  /* Takes the next message of any rank, which has at most *n bytes; *n := its size. Waits up to `wait` [us]. Its
   * rank, or -1: none came */
  int (*receive)(void *bytes, size_t *n, int wait);
  /* Leaves the others, and waits until all have left. */
  void (*leave)(void);
  /* Ends all processes with this exit status. */
  void (*end)(int status);
} lag_ranks;

#endif
