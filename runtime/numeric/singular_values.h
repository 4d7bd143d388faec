/* Singular values of a small dense matrix, row-major, and least-norm solutions by them. One-sided Jacobi rotations:
 * small singular values have their digits (J. Demmel, K. Veselic, SIAM J. Matrix Anal. Appl. 13 (1992) 1204, DOI
 * 10.1137/0613074). */
#pragma once


/* A[rows * cols] := A V, whose columns are orthogonal and sigma[cols] long, longest first; V[cols * cols] is
 * orthogonal. */
void lag_singular_values(int rows, int cols, double *A, double *V, double *sigma);

/* A matrix as lag_singular_values left it. */
typedef struct lag_decomposed {
  int rows, cols;
  const double *AV, *V, *sigma;
} lag_decomposed;

/* x[cols] := the vector that makes |A x - b|^2 + damping |x|^2 least, the shortest one; singular values up to `least`
 * times the first count as 0. Returns their number that do not. */
int lag_least_norm(lag_decomposed of, double least, double damping, const double *b, double *x);
