/* Spaces of small changes without those that symmetries and charges fix (quotient_space.h). */
#include "analysis/quotient_space.h"

#include <math.h>
#include <string.h>

#include "lag.h"
#include "numeric/singular_values.h"

/* The columns of C[n * c] in the coordinates of the basis := X[k * c]. */
void lag_basis_coordinates(const Basis *b, int c, const double *C, double *X) {
  for (int i = 0; i < b->k; i++)
    for (int j = 0; j < c; j++) {
      double sum = 0;
      for (int r = 0; r < b->n; r++) sum += b->B[r * b->k + i] * C[r * c + j];
      X[i * c + j] = sum;
    }
}

/* The basis := its part orthogonal to the columns of C[n * c]. Singular values below `least` of the largest count as
 * 0. */
int lag_basis_take_out(Pool *pool, Basis *b, int c, const double *C) {
  const double least = 1e-7;
  int k = b->k, rank = 0;
  double *X = lag_pool_doubles(pool, (size_t)(k * c) + 1), *R = lag_pool_doubles(pool, (size_t)(k * c) + 1);
  double *V = lag_pool_doubles(pool, (size_t)(k * k) + 1), *sigma = lag_pool_doubles(pool, (size_t)k + 1),
         *left = lag_pool_doubles(pool, (size_t)(b->n * k) + 1);
  if (pool->failed) return LAG_ENOMEM;
  lag_basis_coordinates(b, c, C, X);
  for (int i = 0; i < k; i++)
    for (int j = 0; j < c; j++) R[j * k + i] = X[i * c + j];
  lag_singular_values(c, k, R, V, sigma);
  while (rank < k && sigma[rank] > least) rank++;
  for (int r = 0; r < b->n; r++)
    for (int j = rank; j < k; j++)
      for (int i = 0; i < k; i++) left[r * (k - rank) + j - rank] += b->B[r * k + i] * V[i * k + j];
  b->B = left;
  b->k = k - rank;
  return LAG_OK;
}

/* Scales the columns of C[n * c] to unit length; those that vanish stay. */
void lag_normalise_columns(int n, int c, double *C) {
  for (int j = 0; j < c; j++) {
    double size = 0;
    for (int r = 0; r < n; r++) size += C[r * c + j] * C[r * c + j];
    for (int r = 0; r < n && size > 0; r++) C[r * c + j] /= sqrt(size);
  }
}

/* C[n *nr] := those combinations of its columns along which no charge of L[n c] changes. */
int lag_within_levels(Pool *pool, int n, int c, const double *L, int *nr, double *C) {
  int k = *nr, rank = 0;
  double *X = lag_pool_doubles(pool, (size_t)(c * k) + 1), *V = lag_pool_doubles(pool, (size_t)(k * k) + 1),
         *sigma = lag_pool_doubles(pool, (size_t)k + 1), *was = lag_pool_doubles(pool, (size_t)(n * k) + 1);
  if (pool->failed) return LAG_ENOMEM;
  for (int i = 0; i < c; i++)
    for (int j = 0; j < k; j++)
      for (int r = 0; r < n; r++) X[i * k + j] += L[r * c + i] * C[r * k + j];
  lag_singular_values(c, k, X, V, sigma);
  while (rank < k && sigma[rank] > 1e-7) rank++;
  memcpy(was, C, (size_t)(n * k) * sizeof *C);
  for (int r = 0; r < n; r++)
    for (int j = rank; j < k; j++) {
      C[r * (k - rank) + j - rank] = 0;
      for (int i = 0; i < k; i++) C[r * (k - rank) + j - rank] += was[r * k + i] * V[i * k + j];
    }
  *nr = k - rank;
  return LAG_OK;
}
