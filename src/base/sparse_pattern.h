/* Pattern of a symmetric sparse matrix under elimination; the caller gives entries their meaning (a mark, a slot).
 *
 * A row keeps its entries, the diagonal included, in the order of insertion; rows are short
 * where elimination makes sense, so a look-up is a linear search. */
#pragma once

#include "base/vec.h"

typedef struct {
  uint32_t col, value; /* value 0: no entry */
} SparseEntry;

typedef VEC(SparseEntry) SparseRow;

typedef struct {
  Arena *arena;
  uint32_t n;
  SparseRow *rows;
} Sparse;

static inline Sparse sparse_new(Arena *a, uint32_t n) { return (Sparse){a, n, ARENA_ARRAY(a, SparseRow, n + 1)}; }

static inline uint32_t *sparse_find(const Sparse *s, uint32_t i, uint32_t j) {
  const SparseRow *r = &s->rows[i];
  for (uint32_t k = 0; k < r->n; k++)
    if (r->at[k].col == j) return &r->at[k].value;
  return NULL;
}

static inline uint32_t sparse_get(const Sparse *s, uint32_t i, uint32_t j) {
  const uint32_t *at = sparse_find(s, i, j);
  return at ? *at : 0;
}

static inline void sparse_set_half(Sparse *s, uint32_t i, uint32_t j, uint32_t value) {
  uint32_t *at = sparse_find(s, i, j);
  if (at) *at = value;
  else if (value) vec_push(s->arena, &s->rows[i], ((SparseEntry){j, value}));
}

/* Sets entries (i, j) and (j, i). */
static inline void sparse_set(Sparse *s, uint32_t i, uint32_t j, uint32_t value) {
  sparse_set_half(s, i, j, value);
  if (i != j) sparse_set_half(s, j, i, value);
}

static inline void sparse_drop_half(Sparse *s, uint32_t i, uint32_t j) {
  SparseRow *r = &s->rows[i];
  for (uint32_t k = 0; k < r->n; k++)
    if (r->at[k].col == j) {
      r->at[k] = r->at[--r->n];
      return;
    }
}

/* Removes variable i from all rows but its own. */
static inline void sparse_eliminate(Sparse *s, uint32_t i) {
  const SparseRow *r = &s->rows[i];
  for (uint32_t k = 0; k < r->n; k++)
    if (r->at[k].col != i) sparse_drop_half(s, r->at[k].col, i);
}
