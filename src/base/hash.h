/* Hashes: FNV-1a of bytes, the runtime's; and a mixing step for numbers. */
#pragma once

#include "numeric/fnv1a.h"

static inline uint32_t hash_mix(uint32_t h, uint32_t x) {
  h ^= x + 0x9e3779b9u + (h << 6) + (h >> 2);
  h *= 0x85ebca6bu;
  return h ^ (h >> 15);
}
