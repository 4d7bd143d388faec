/* Work space: one block, cut into parts. */
#pragma once

#include <stddef.h>

/* Cuts block into n parts of these sizes; returns the sum of the sizes. block NULL: only that. */
static inline size_t lag_workspace_slice(double *block, size_t n, double **const parts[], const size_t sizes[]) {
  size_t at = 0;
  for (size_t i = 0; i < n; i++) {
    if (block) *parts[i] = block + at;
    at += sizes[i];
  }
  return at;
}

/* A block of zeros with `n` parts of these sizes, whose places go to `parts`. Give it to free(). NULL: no memory.
 * Under the address sanitizer a gap that must not be touched follows each part. */
double *lag_workspace(size_t n, double **const parts[], const size_t sizes[]);
