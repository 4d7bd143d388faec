/* Work space: one block cut into parts; under the address sanitizer with a poisoned gap behind each part. */
#include "numeric/workspace.h"

#include <stdlib.h>

#ifdef __has_feature
#if __has_feature(address_sanitizer)
#define __SANITIZE_ADDRESS__ 1
#endif
#endif
#ifdef __SANITIZE_ADDRESS__
void __asan_poison_memory_region(void const volatile *p, size_t n);
#define POISON __asan_poison_memory_region
enum { GAP = 2 };
#else
#define POISON(p, n) ((void)(p), (void)(n))
enum { GAP = 0 };
#endif

double *lag_workspace(size_t n, double **const parts[], const size_t sizes[]) {
  size_t total = 1;
  for (size_t i = 0; i < n; i++) total += sizes[i] + GAP;
  double *block = calloc(total, sizeof *block), *x = block;
  for (size_t i = 0; i < n && block; i++) {
    *parts[i] = x;
    x += sizes[i] + GAP;
    POISON(x - GAP, GAP * sizeof *x);
  }
  return block;
}
