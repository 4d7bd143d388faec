/* The hash FNV-1a, 64 bits (G. Fowler, L. C. Noll, K.-P. Vo), in the compiler, too. */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <string.h>

#define LAG_FNV1A_START UINT64_C(0xcbf29ce484222325)

/* The hash of what h is the hash of, followed by s[n]. */
static inline uint64_t lag_fnv1a(uint64_t h, const char *s, size_t n) {
  for (size_t i = 0; i < n; i++) h = (h ^ (unsigned char)s[i]) * UINT64_C(0x100000001b3);
  return h;
}

/* Text with its final 0, so that "ab","c" and "a","bc" differ. */
static inline uint64_t lag_hash_text(uint64_t h, const char *s) { return lag_fnv1a(h, s, strlen(s) + 1); }
