/* Sparse systems in extended precision, for what is decided by value. */
#ifndef LAGC_SPARSE_SOLVE_H
#define LAGC_SPARSE_SOLVE_H

#include "base/vec.h"

/* Element (row, col) of a matrix. Elements at one place add up; an element of value 0 is none. */
typedef struct {
  uint32_t row, col;
  long double value;
} SparseElement;

typedef VEC(SparseElement) SparseElements;

static inline void sparse_put(Arena *arena, SparseElements *a, uint32_t row, uint32_t col, long double value) {
  if (value != 0) vec_push(arena, a, ((SparseElement){row, col, value}));
}

/* Powers of 2 by which the columns of a, n by n, are to be multiplied, and the rows (row: NULL, or [n]), for its elements to be as near to 1 as can be, by least
 * squares of their exponents: A. R. Curtis, J. K. Reid, IMA J. Appl. Math. 10 (1972) 118, DOI 10.1093/imamat/10.1.118. An element that is
 * rounding of a double beside the largest of its row and of its column has no say. As lag_scales of runtime/include/lag_kkt.h, which decides in a run. */
void sparse_scales(Arena *arena, uint32_t n, const SparseElements *a, int *row, int *column);

/* Solves a x = b, n by n; b[n] becomes x (NULL: only the rank is wanted). The system is scaled first, so that neither units of unknowns nor factors of
 * equations matter. A pivot is at least a tenth of the largest element that is left, in a row as short as can be, so that few elements are added: I. S. Duff,
 * A. M. Erisman, J. K. Reid, Direct Methods for Sparse Matrices, 2nd ed. (2017), 7.2. Elimination ends where no element is above `rest` times the
 * largest at the beginning; unknowns that nothing determines are 0 then. Returns the rank. Below n, null[n] (or NULL) spans a direction of the kernel. */
uint32_t sparse_solve(Arena *arena, uint32_t n, const SparseElements *a, long double *b, long double rest, long double *null);

/* Whether M, n by n, is regular on the kernel of A, m by n, for a = [M -A^T; A 0], in which an element that is not finite counts as 0. If not,
 * null[n] is a direction there, in unknowns that are scaled as the system is. */
int sparse_is_regular_on_kernel(Arena *arena, uint32_t n, uint32_t m, const SparseElements *a, long double *null);

#endif
