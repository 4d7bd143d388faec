/* Small changes of a state, in the space that is left when the levels of charges and the directions of symmetries are
 * taken out. */
#pragma once

#include "analysis/memory_pool.h"

/* A basis of vectors, the columns of B[n * k], orthonormal. */
typedef struct Basis {
  int n, k;
  double *B;
} Basis;

/* The basis := its part orthogonal to the columns of C[n * c]. LAG_OK, or LAG_ENOMEM. */
int lag_basis_take_out(Pool *pool, Basis *b, int c, const double *C);
/* Scales the columns of C[n * c] to unit length; those that vanish stay. */
void lag_normalise_columns(int n, int c, double *C);
/* C[n *nr] := those combinations of its columns along which no charge of L[n c] changes. LAG_OK, or LAG_ENOMEM. */
int lag_within_levels(Pool *pool, int n, int c, const double *L, int *nr, double *C);
