/* Work space: one block cut into parts; under the address sanitizer with a poisoned gap behind each part. */
#include "numeric/workspace.h"

#include <stdlib.h>
#include <string.h>

#include "numeric/poison.h"

enum { GAP = POISON_GAP / sizeof(double) };

void lag_workspace_clear(size_t n, const lag_part parts[]) {
  size_t total = 0;
  for (size_t i = 0; i < n; i++) {
    if (GAP) memset(*parts[i].at, 0, parts[i].n * sizeof(double));
    total += parts[i].n;
  }
  if (!GAP) memset(*parts[0].at, 0, total * sizeof(double));
}

double *lag_workspace(size_t n, const lag_part parts[]) {
  size_t total = 1;
  for (size_t i = 0; i < n; i++) total += parts[i].n + GAP;
  double *block = calloc(total, sizeof *block), *x = block;
  for (size_t i = 0; i < n && block; i++) {
    *parts[i].at = x;
    x += parts[i].n + GAP;
    POISON(x - GAP, GAP * sizeof *x);
  }
  return block;
}
