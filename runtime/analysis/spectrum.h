/* The eigenvalues of a real matrix with their eigenvectors, where zeros and multiple eigenvalues are told apart from what
 * rounding makes of them: a free motion is an exact 0, not a pair of 1e-8. */
#ifndef LAG_ANALYSIS_SPECTRUM_H
#define LAG_ANALYSIS_SPECTRUM_H

#include "analysis/pool.h"
#include "lag.h"

typedef struct Spectrum {
  int n;             /* of the matrix */
  int count;         /* of eigenvalues that are not 0 */
  double *re, *im;   /* [count]; a part that rounding may have made is 0 */
  double *vre, *vim; /* [n * count], columns */
  double *repeats;   /* [count] > 1: of so many equal ones, which have fewer eigenvectors than that */
  int zeros;         /* how often 0 is an eigenvalue */
  int nkernel;       /* how many eigenvectors it has */
  double *kernel;    /* [n * nkernel], columns */
} Spectrum;

/* Of A[n * n], whose entries may be wrong by noise[n * n] >= 0; less than rounding is taken as rounding. Memory is the pool's. LAG_OK, LAG_ENOMEM,
 * LAG_EMETHOD. */
int lag_spectrum(Spectrum *s, Pool *pool, const lag_algebra *algebra, int n, const double *A, const double *noise);

#endif
