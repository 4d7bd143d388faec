/* VEC(T): a growable array in an arena. Growing copies, so pointers into a VEC do not outlive a
 * push; the old block is given up. */
#pragma once

#include <stdint.h>
#include <string.h>

#include "base/arena.h"
#include "numeric/poison.h"

#define VEC(T)       \
  struct {           \
    T *at;           \
    uint32_t n, cap; \
  }

/* Room for one more element of `size` bytes; returns the (possibly new) block. */
static inline void *vec_grow(Arena *a, void *at, uint32_t n, uint32_t *cap, size_t size) {
  if (n == *cap) {
    if (*cap > UINT32_MAX / 2) arena_fail(a);
    uint32_t bigger = *cap ? *cap * 2 : 8;
    void *block = arena_alloc(a, (size_t)bigger * size);
    if (n) memcpy(block, at, (size_t)n * size);
    if (n) arena_release(a, at, (size_t)n * size);
    POISON((char *)block + (size_t)n * size, (bigger - n) * size);
    *cap = bigger;
    at = block;
  }
  UNPOISON((char *)at + (size_t)n * size, size);
  return at;
}

#define vec_push(a, v, x)                                                            \
  ((v)->at = vec_grow((a), (v)->at, (v)->n, &(v)->cap, sizeof *(v)->at), \
   (v)->at[(v)->n++] = (x))

/* Loop over the elements, vec_each(const Coord, c, m->coords); the list does not grow meanwhile. */
#define vec_each(T, x, v) for (T *x = (v).at, *x##_end = (v).n ? x + (v).n : x; x != x##_end; x++)
