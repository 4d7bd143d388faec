/* The matrices of small motion about a state of rest, with what rounding makes of each entry, and the energy's signature. */
#ifndef LAG_ANALYSIS_MATRICES_H
#define LAG_ANALYSIS_MATRICES_H

#include "analysis/equilibrium.h"

/* M x'' + C x' + K x = 0 in coordinates of mass 1: those of the model times weight. */
typedef struct Matrices {
  int nq;
  double *weight;              /* [nq] sqrt(M_ii); of a row without, its size */
  double *K, *C, *M;           /* [nq * nq] */
  double *noise_K, *noise_C, *noise_M;
  int definite, symmetric, undamped; /* M positive definite; K; C = 0: to rounding */
  int lowering;                /* directions in which the energy falls; -1: not known */
  int flat;                    /* and in which it neither falls nor rises, to rounding */
  double *values, *vectors;    /* of K x = value M x, where lowering >= 0: [nq] ascending, columns [nq * nq] in the model's SI units */
  double *zero;                /* [nq] |value| up to this is 0 */
} Matrices;

/* At the state at rest. Memory is the pool's. LAG_OK, LAG_ENOMEM, what the model returned, LAG_EMETHOD. */
int lag_matrices_find(Matrices *m, Pool *pool, Rest *rest, const lag_algebra *algebra);

/* A[n * n] of y' = A y at rest, n = 2 nq + nz, and how much rounding makes of its entries. Memory and errors as above. */
int lag_state_matrix(Pool *pool, Rest *rest, double **A, double **noise);

#endif
