/* Decoupled blocks of a matrix: unknowns that no entry links, so that each block is judged by its own size. */
#ifndef LAG_ANALYSIS_DECOUPLED_BLOCKS_H
#define LAG_ANALYSIS_DECOUPLED_BLOCKS_H

#include <stddef.h>

/* block[n] := for each of n unknowns the first unknown of its block: those linked, directly or through others, by non-zero entries of A[n * n]
 * or B[n * n] (NULL: none), in either direction. */
static inline void lag_decoupled_blocks(int n, const double *A, const double *B, int *block)
{
  for (int i = 0; i < n; i++) {
    block[i] = i;
  }
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      if (A[i * n + j] == 0.0 && !(B && B[i * n + j] != 0.0)) {
        continue;
      }
      int low = block[i] < block[j] ? block[i] : block[j], high = block[i] + block[j] - low;
      for (int k = 0; k < n && low != high; k++) {
        block[k] = block[k] == high ? low : block[k];
      }
    }
  }
}

/* at[] := the members of block `first`. Returns their number. */
static inline int lag_block_members(int n, const int *block, int first, int *at)
{
  int m = 0;

  for (int i = 0; i < n; i++) {
    if (block[i] == first) {
      at[m++] = i;
    }
  }
  return m;
}

/* part[m * m] := the rows and columns at[m] of A[n * n]. */
static inline void lag_block_copy(int n, const double *A, int m, const int *at, double *part)
{
  for (int i = 0; i < m; i++) {
    for (int j = 0; j < m; j++) {
      part[i * m + j] = A[at[i] * n + at[j]];
    }
  }
}

#endif
