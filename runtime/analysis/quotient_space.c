/* Spaces of small changes without those that symmetries and charges fix (quotient_space.h). */
#include "analysis/quotient_space.h"

#include <math.h>

#include "lag.h"
#include "numeric/dense.h"
#include "numeric/singular_values.h"

/* B[n k] := those combinations of its columns, k - rank in number, along which none of R[rows k] changes: singular
 * values below `least` count as 0. R is destroyed. Returns the number that is left, or LAG_ENOMEM. */
static int drop(Pool *pool, int rows, int k, double *R, int n, double *B) {
  const double least = 1e-7;
  int rank = 0;
  double *V = lag_pool_doubles(pool, (size_t)(k * k) + 1), *sigma = lag_pool_doubles(pool, (size_t)k + 1),
         *BV = lag_pool_doubles(pool, (size_t)(n * k) + 1);
  if (pool->failed) return LAG_ENOMEM;
  lag_singular_values(rows, k, R, V, sigma);
  while (rank < k && sigma[rank] > least) rank++;
  lag_multiply(n, k, k, B, V, BV);
  for (int i = 0; i < n * (k - rank); i++) B[i] = BV[i / (k - rank) * k + rank + i % (k - rank)];
  return k - rank;
}

/* The basis := its part orthogonal to the columns of C[n * c]. */
int lag_basis_take_out(Pool *pool, Basis *b, int c, const double *C) {
  double *R = lag_pool_doubles(pool, (size_t)(b->k * c) + 1);
  if (pool->failed) return LAG_ENOMEM;
  lag_multiply_transposed(c, b->n, b->k, C, b->B, R);
  int left = drop(pool, c, b->k, R, b->n, b->B);
  if (left >= 0) b->k = left;
  return left < 0 ? left : LAG_OK;
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
  double *X = lag_pool_doubles(pool, (size_t)(c * *nr) + 1);
  if (pool->failed) return LAG_ENOMEM;
  lag_multiply_transposed(c, n, *nr, L, C, X);
  int left = drop(pool, c, *nr, X, n, C);
  if (left >= 0) *nr = left;
  return left < 0 ? left : LAG_OK;
}
