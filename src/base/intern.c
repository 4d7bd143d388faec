/* Interner: a hash table of strings. */
#include "base/intern.h"

#include <string.h>

#include "base/hash.h"
#include "base/id_table.h"
#include "base/vec.h"

struct Interner {
  Arena *arena;
  VEC(Name) names;
  IdTable table; /* of `names` */
};

Interner *interner_new(Arena *a) {
  Interner *in = ARENA_NEW(a, Interner);
  in->arena = a;
  in->table = idtable(a, 128);
  return in;
}

Name intern_n(Interner *in, const char *s, size_t n) {
  uint64_t h = lag_fnv1a(LAG_FNV1A_START, s, n);
  uint32_t hash = (uint32_t)(h ^ h >> 32), slot = idtable_start(&in->table, hash), id;
  while (idtable_next(&in->table, hash, &slot, &id)) {
    Name known = in->names.at[id];
    if (strncmp(known, s, n) == 0 && known[n] == '\0') return known;
  }
  vec_push(in->arena, &in->names, arena_strndup(in->arena, s, n));
  idtable_add(&in->table, hash, in->names.n - 1);
  return in->names.at[in->names.n - 1];
}

Name intern(Interner *in, const char *s) { return intern_n(in, s, strlen(s)); }
