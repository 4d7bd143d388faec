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
