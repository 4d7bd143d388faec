/* Independence of sparse rows that arrive one by one: each is projected onto the span of the rows before it. */
#pragma once

#include "base/vec.h"

typedef struct {
  uint32_t col;
  long double value;
} RowElement;

typedef VEC(RowElement) SparseVector;

typedef struct {
  Arena *arena;
  uint32_t width, rank, room;
  SparseVector *rows;     /* [rank] independent rows A */
  SparseVector *triangle; /* [rank] R of A^T = Q R by columns, above the diagonal */
  long double *diagonal;  /* [rank] diagonal of R */
  long double *left;      /* [width] the last row minus its projection, normalised unless 0 */
  long double *y;         /* [rank] scratch */
} RowSpan;

RowSpan row_span(Arena *arena, uint32_t width);

/* Relative length, from 0 to 1, of the row minus its projection onto the span; above `independent` the row joins the
 * span. Q is not stored: corrected semi-normal equations, A. Bjorck, Linear Algebra Appl. 88/89 (1987) 31, DOI
 * 10.1016/0024-3795(87)90101-7. */
long double row_span_add(RowSpan *s, const RowElement *row, uint32_t n, long double independent);
