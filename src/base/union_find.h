/* Union-find: disjoint sets of 0 .. n-1, each with its least element as root; paths are halved. */
#pragma once

#include <stdint.h>

#include "base/arena.h"

/* parent[n]: n sets of one element each. */
static inline uint32_t *union_find_new(Arena *a, uint32_t n) {
  uint32_t *parent = ARENA_ARRAY(a, uint32_t, n);
  for (uint32_t i = 0; i < n; i++) parent[i] = i;
  return parent;
}

static inline uint32_t union_find_root(uint32_t *parent, uint32_t i) {
  while (parent[i] != i) i = parent[i] = parent[parent[i]];
  return i;
}

static inline void union_find_join(uint32_t *parent, uint32_t i, uint32_t j) {
  uint32_t a = union_find_root(parent, i), b = union_find_root(parent, j);
  if (a < b) parent[b] = a;
  else parent[a] = b;
}
