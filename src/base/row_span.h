/* The span of sparse rows that come one by one: which of them are independent of those before. */
#ifndef LAGC_ROW_SPAN_H
#define LAGC_ROW_SPAN_H

#include "base/vec.h"

typedef struct {
  uint32_t col;
  long double value;
} RowElement;

typedef VEC(RowElement) SparseVector;

typedef struct {
  Arena *arena;
  uint32_t width, rank, room;
  SparseVector *rows;     /* [rank] the rows that were taken, */
  SparseVector *triangle; /* [rank] R of A^T = Q R by columns, above its diagonal, */
  long double *diagonal;  /* [rank] and this */
  long double *left;      /* [width] the row at hand less its projection; of length 1 where anything is left */
  long double *y;         /* [rank] scratch */
} RowSpan;

RowSpan row_span(Arena *arena, uint32_t width);

/* How much of a row its projection onto the span leaves, from 0 to 1; above `independent`, the row joins the span. Neither Q nor a product with Q is kept: the
 * corrected semi-normal equations, Å. Björck, Linear Algebra Appl. 88/89 (1987) 31, DOI 10.1016/0024-3795(87)90101-7. */
long double row_span_add(RowSpan *s, const RowElement *row, uint32_t n, long double independent);

#endif
