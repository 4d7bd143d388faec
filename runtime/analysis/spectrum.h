/* Eigenvalues and eigenvectors of a real matrix; zeros and multiple eigenvalues are told from rounding: a free
 * motion is an exact 0, not a pair of 1e-8. */
#pragma once

#include "analysis/memory_pool.h"
#include "lag.h"

typedef struct Spectrum {
  int n;             /* rows of the matrix */
  int count;         /* number of eigenvalues listed: all, or where the matrix has a kernel those that are not 0 */
  double *re, *im;   /* [count]; a part that may be rounding is 0 */
  double *vre, *vim; /* [n * n], the first count columns */
  double *repeats;   /* [count] > 1: multiplicity of a defective eigenvalue */
  int zeros;         /* multiplicity of the eigenvalue 0 */
  int nkernel;       /* number of its eigenvectors: */
  double *kernel;    /* [n * n], the last nkernel columns */
} Spectrum;

/* Spectrum of A[n * n], whose entries have errors up to noise[n * n] >= 0, at least those of rounding. Both are
 * destroyed. Memory is the pool's. LAG_OK, LAG_ENOMEM, LAG_EMETHOD. */
int lag_spectrum(Spectrum *s, Pool *pool, const lag_algebra *algebra, int n, double *A, double *noise);

/* Whether eigenvalue k is the first of equal defective ones, which are listed as one mode. */
int lag_spectrum_first(const Spectrum *s, int k);
