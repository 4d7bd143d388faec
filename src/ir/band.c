/* Band width, and the order of Cuthill and McKee, of a symmetric pattern. */
#include "ir/band.h"

#include <string.h>

uint32_t band_width(uint32_t n, const Slot *M) {
  uint32_t widest = 0;
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = 0; j < i; j++)
      if (M[(size_t)i*n + j] && i - j > widest) widest = i - j;
  return widest;
}

static int is_entry(uint32_t n, const Slot *M, uint32_t i, uint32_t j) { return M[i > j ? (size_t)i*n + j : (size_t)j*n + i] != 0; }

static uint32_t *find_degrees(Arena *a, uint32_t n, const Slot *M) {
  uint32_t *degree = ARENA_ARRAY(a, uint32_t, n);
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = 0; j < i; j++)
      if (is_entry(n, M, i, j)) degree[i]++, degree[j]++;
  return degree;
}

/* Breadth-first order from `start`; neighbours of a node by increasing degree. */
static void by_levels(Arena *a, uint32_t n, const Slot *M, const uint32_t *degree, uint32_t start, uint32_t *order) {
  unsigned char *seen = ARENA_ARRAY(a, unsigned char, n);
  uint32_t known = 0;
  order[known++] = start;
  seen[start] = 1;
  for (uint32_t k = 0; k < known; k++) {
    uint32_t first = known;
    for (uint32_t j = 0; j < n; j++) {
      if (seen[j] || !is_entry(n, M, order[k], j)) continue;
      seen[j] = 1;
      uint32_t at = known++;
      for (; at > first && degree[order[at - 1]] > degree[j]; at--) order[at] = order[at - 1];
      order[at] = j;
    }
  }
}

const uint32_t *band_order(Arena *a, uint32_t n, const Slot *M) {
  enum { TURNS = 3 }; /* each begins at the last node of the one before, an end of the graph */
  const uint32_t *degree = find_degrees(a, n, M);
  uint32_t *order = ARENA_ARRAY(a, uint32_t, n), start = 0;
  for (uint32_t i = 1; i < n; i++)
    if (degree[i] < degree[start]) start = i;
  for (int turn = 0; turn < TURNS; turn++) {
    by_levels(a, n, M, degree, start, order);
    start = order[n - 1];
  }
  return order;
}
