/* Sparse linear systems in long double: solutions and ranks that the compiler decides numerically. */
#pragma once

#include "base/vec.h"

/* Element (row, col) of a matrix. Elements at one place add up; zeros are left out. */
typedef struct {
  uint32_t row, col;
  long double value;
} SparseElement;

typedef VEC(SparseElement) SparseElements;

static inline void sparse_put(Arena *arena, SparseElements *a, uint32_t row, uint32_t col, long double value) {
  if (value != 0) vec_push(arena, a, ((SparseElement){row, col, value}));
}

/* Equilibrates a, n by n: exponents of 2 for its columns, and its rows (row: [n] or NULL), that bring the elements
 * near 1 by least squares of their exponents: A. R. Curtis, J. K. Reid, IMA J. Appl. Math. 10 (1972) 118, DOI
 * 10.1093/imamat/10.1.118. Elements at the level of double rounding beside the largest of their row and column do
 * not count. Same rule as lag_scales of runtime/include/lag_kkt.h, used in runs. */
void sparse_equilibrate(Arena *arena, uint32_t n, const SparseElements *a, int *row, int *column);

/* Solves a x = b, n by n, and returns the rank; b[n] becomes x (NULL: only the rank). The system is equilibrated
 * first, so that units of unknowns and factors of equations do not matter. Threshold pivoting: a pivot is at least a
 * sixteenth of the largest element of its row and of the largest remaining or initial element, whichever is less, in
 * the shortest such row, for little fill, or smaller where a far shorter row offers it: I. S. Duff, A. M. Erisman,
 * J. K. Reid, Direct Methods for Sparse Matrices, 2nd ed. (2017), 7.2. Elimination ends where no element exceeds
 * `tolerance` times the initial largest; undetermined unknowns are 0. Rank below n: null[n] (or NULL) gets a vector
 * of the kernel. */
uint32_t sparse_solve(Arena *arena, uint32_t n, const SparseElements *a, long double *b, long double tolerance,
                      long double *null);

/* Whether M, n by n, is regular on the kernel of A, m by n, for a = [M -A^T; A 0]; elements that are not finite
 * count as 0. If not, null[n] is a vector of both kernels, in the equilibrated unknowns. */
int sparse_is_regular_on_kernel(Arena *arena, uint32_t n, uint32_t m, const SparseElements *a, long double *null);
