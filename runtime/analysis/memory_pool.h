/* Memory pool of one analysis: blocks are allocated one by one, failure is checked once, all are freed at once. */
#pragma once

#include <stdlib.h>

#include "numeric/workspace.h"

typedef struct Pool {
  void *last;  /* the newest block; each begins with a pointer to the one before it */
  int failed;  /* 1: an allocation failed */
} Pool;

/* n zeros; NULL without memory, and failed is set. */
static inline double *lag_pool_doubles(Pool *p, size_t n) {
  void **block = calloc(1, sizeof(double) * (n + 2));
  if (!block) {
    p->failed = 1;
    return NULL;
  }
  *block = p->last;
  p->last = block;
  return (double *)(void *)block + 2;
}

static inline void lag_pool_parts(Pool *p, size_t n, const lag_part parts[]) {
  for (size_t i = 0; i < n; i++) *parts[i].at = lag_pool_doubles(p, parts[i].n);
}

static inline void lag_pool_free(Pool *p) {
  while (p->last) {
    void *before = *(void **)p->last;
    free(p->last);
    p->last = before;
  }
}
