/* Hashes: FNV-1a of bytes (G. Fowler, L. C. Noll, K.-P. Vo), and a mixing step for numbers. */
#pragma once

#include <stddef.h>
#include <stdint.h>

#define FNV1A_START 14695981039346656037u

/* FNV-1a hash of n bytes that follow those with hash h (none: FNV1A_START). */
static inline uint64_t hash_bytes(uint64_t h, const char *s, size_t n) {
  for (size_t i = 0; i < n; i++) h = (h ^ (unsigned char)s[i]) * 1099511628211u;
  return h;
}

static inline uint32_t hash_mix(uint32_t h, uint32_t x) {
  h ^= x + 0x9e3779b9u + (h << 6) + (h >> 2);
  h *= 0x85ebca6bu;
  return h ^ (h >> 15);
}
