/* Projections onto the span of sparse rows A by the triangle R of A^T = Q R alone. */
#include "base/row_span.h"

#include <math.h>

RowSpan row_span(Arena *arena, uint32_t width) {
  return (RowSpan){.arena = arena, .width = width, .left = ARENA_ARRAY(arena, long double, width + 1)};
}

static void make_room(RowSpan *s) {
  if (s->rank < s->room) return;
  RowSpan was = *s;
  s->room = 2 * s->room + 8;
  s->rows = ARENA_ARRAY(s->arena, SparseVector, s->room);
  s->triangle = ARENA_ARRAY(s->arena, SparseVector, s->room);
  s->diagonal = ARENA_ARRAY(s->arena, long double, s->room);
  s->y = ARENA_ARRAY(s->arena, long double, s->room);
  for (uint32_t k = 0; k < s->rank; k++) {
    s->rows[k] = was.rows[k];
    s->triangle[k] = was.triangle[k];
    s->diagonal[k] = was.diagonal[k];
  }
}

static long double length_of(const long double *x, uint32_t n) {
  long double sum = 0;
  for (uint32_t j = 0; j < n; j++) sum += x[j] * x[j];
  return sqrtl(sum);
}

/* y := R^-T A x = Q^T x: the coordinates of x along the columns of Q. */
static void along(RowSpan *s, const long double *x) {
  for (uint32_t k = 0; k < s->rank; k++) {
    const SparseVector *row = &s->rows[k], *above = &s->triangle[k];
    long double sum = 0;
    for (uint32_t j = 0; j < row->n; j++) sum += row->at[j].value * x[row->at[j].col];
    for (uint32_t j = 0; j < above->n; j++) sum -= above->at[j].value * s->y[above->at[j].col];
    s->y[k] = sum / s->diagonal[k];
  }
}

/* x -= A^T R^-1 y = Q y; y is destroyed. */
static void subtract_projection(RowSpan *s, long double *x) {
  for (uint32_t k = s->rank; k-- > 0;) {
    const SparseVector *row = &s->rows[k], *above = &s->triangle[k];
    if (s->y[k] == 0) continue;
    long double part = s->y[k] / s->diagonal[k];
    for (uint32_t j = 0; j < above->n; j++) s->y[above->at[j].col] -= above->at[j].value * part;
    for (uint32_t j = 0; j < row->n; j++) x[row->at[j].col] -= row->at[j].value * part;
  }
}

long double row_span_add(RowSpan *s, const RowElement *row, uint32_t n, long double independent) {
  SparseVector above = {0}, kept = {0};
  make_room(s);
  for (uint32_t j = 0; j < s->width; j++) s->left[j] = 0;
  for (uint32_t j = 0; j < n; j++) s->left[row[j].col] += row[j].value;
  long double was = length_of(s->left, s->width);
  if (!(was > 0)) return 0;
  for (int turn = 0; turn < 3; turn++) { /* once to project, twice to correct */
    along(s, s->left);
    for (uint32_t k = 0; k < s->rank && turn == 0; k++)
      if (s->y[k] != 0) vec_push(s->arena, &above, ((RowElement){k, s->y[k]}));
    subtract_projection(s, s->left);
  }
  long double left = length_of(s->left, s->width);
  for (uint32_t j = 0; j < s->width && left > 0; j++) s->left[j] /= left;
  if (!(left / was > independent)) return left / was;
  for (uint32_t j = 0; j < n; j++) vec_push(s->arena, &kept, row[j]);
  s->rows[s->rank] = kept;
  s->triangle[s->rank] = above;
  s->diagonal[s->rank++] = left;
  return left / was;
}
