/* Matrices of small motion about a state of rest, the noise of each entry, and the signature of the energy. */
#ifndef LAG_ANALYSIS_MATRICES_H
#define LAG_ANALYSIS_MATRICES_H

#include "analysis/equilibrium.h"

/* M x'' + C x' + K x = 0 in coordinates of mass 1: the model's times weight. */
typedef struct Matrices {
  int nq;
  double *weight;              /* [nq] sqrt(M_ii); of a row with M_ii <= 0, the root of its size */
  double *K, *C, *M;           /* [nq * nq] */
  double *noise_K, *noise_C, *noise_M;
  int definite, symmetric, undamped; /* to rounding: M is positive definite; K is symmetric; C = 0 */
  int lowering;                /* number of directions in which the energy falls; -1: not known */
  int flat;                    /* number of directions in which it is constant, to rounding */
  double *values, *vectors;    /* eigenpairs K x = value M x, where lowering >= 0: [nq] ascending up to rounding, columns [nq * nq] in the model's SI units */
  double *zero;                /* [nq] |value| up to this counts as 0 */
} Matrices;

/* Computes *m at the state at rest. Memory is the pool's. LAG_OK, LAG_ENOMEM, the model's status, LAG_EMETHOD. */
int lag_matrices_find(Matrices *m, Pool *pool, Equilibrium *rest, const lag_algebra *algebra);

/* A[n * n] of y' = A y at rest, n = 2 nq + nz, and the noise of its entries. Memory and errors as above. */
int lag_state_matrix(Pool *pool, Equilibrium *rest, double **A, double **noise);

#endif
