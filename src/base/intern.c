/* Interner: an open-addressing hash table of strings (FNV-1a). */
#include "base/intern.h"

#include <stdint.h>
#include <string.h>

struct Interner {
  Arena *arena;
  Name *slots;
  size_t n, cap; /* cap is a power of two */
};

Interner *interner_new(Arena *a) {
  Interner *in = ARENA_NEW(a, Interner);
  in->arena = a;
  in->cap = 256;
  in->slots = ARENA_ARRAY(a, Name, in->cap);
  return in;
}

static size_t hash_bytes(const char *s, size_t n) {
  uint64_t h = 1469598103934665603u;
  for (size_t i = 0; i < n; i++) h = (h ^ (unsigned char)s[i]) * 1099511628211u;
  return (size_t)(h ^ (h >> 32));
}

/* The slot that holds s, or the empty one where it belongs. */
static Name *find_slot(Name *slots, size_t cap, const char *s, size_t n) {
  size_t i = hash_bytes(s, n) & (cap - 1);
  while (slots[i] && (strncmp(slots[i], s, n) != 0 || slots[i][n] != '\0')) i = (i + 1) & (cap - 1);
  return &slots[i];
}

static void rehash(Interner *in) {
  size_t cap = in->cap * 2;
  Name *slots = ARENA_ARRAY(in->arena, Name, cap);
  for (size_t i = 0; i < in->cap; i++)
    if (in->slots[i]) *find_slot(slots, cap, in->slots[i], strlen(in->slots[i])) = in->slots[i];
  in->slots = slots;
  in->cap = cap;
}

Name intern_n(Interner *in, const char *s, size_t n) {
  if (in->n * 2 >= in->cap) rehash(in);
  Name *slot = find_slot(in->slots, in->cap, s, n);
  if (!*slot) {
    *slot = arena_strndup(in->arena, s, n);
    in->n++;
  }
  return *slot;
}

Name intern(Interner *in, const char *s) { return intern_n(in, s, strlen(s)); }
