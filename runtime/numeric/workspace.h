/* Work space: one block, cut into parts. */
#pragma once

#include <stddef.h>

/* A part, and its length. */
typedef struct lag_part {
  double **at;
  size_t n;
} lag_part;

/* Cuts block into n parts; returns the sum of their lengths. block NULL: only that. */
static inline size_t lag_workspace_slice(double *block, size_t n, const lag_part parts[]) {
  size_t at = 0;
  for (size_t i = 0; i < n; i++) {
    if (block) *parts[i].at = block + at;
    at += parts[i].n;
  }
  return at;
}

/* A block of zeros with these n parts. Give it to free(). NULL: no memory. Under the address sanitizer a gap that must
 * not be touched follows each part. */
double *lag_workspace(size_t n, const lag_part parts[]);
/* Sets all of its parts to 0. */
void lag_workspace_clear(size_t n, const lag_part parts[]);
