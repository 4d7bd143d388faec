/* IdTable: hash table from content to the id of an entry in the owner's array. Open addressing; the owner compares
 * contents:
 *
 *   uint32_t at = idtable_start(&t, hash), id;
 *   while (idtable_next(&t, hash, &at, &id))
 *     if (things[id] is the one) return id;
 *   idtable_add(&t, hash, new_id); */
#pragma once

#include <stdint.h>

#include "base/arena.h"

typedef struct {
  uint32_t id1, hash; /* id1 is the id plus one; 0 marks an empty slot */
} IdSlot;

typedef struct {
  Arena *arena;
  IdSlot *slots;
  uint32_t cap, n;
} IdTable;

/* An empty table with room for n entries before it grows. */
static inline IdTable idtable(Arena *a, uint32_t n) {
  IdTable t = {.arena = a, .cap = 64};
  while (t.cap < 2 * n) t.cap *= 2;
  t.slots = ARENA_ARRAY(a, IdSlot, t.cap);
  return t;
}

static inline uint32_t idtable_start(const IdTable *t, uint32_t hash) { return t->cap ? hash & (t->cap - 1) : 0; }

/* Finds the next id with this hash from slot *at on; returns 0 at the end. */
static inline int idtable_next(const IdTable *t, uint32_t hash, uint32_t *at, uint32_t *id) {
  if (!t->cap) return 0;
  while (t->slots[*at].id1) {
    IdSlot s = t->slots[*at];
    *at = (*at + 1) & (t->cap - 1);
    if (s.hash == hash) {
      *id = s.id1 - 1;
      return 1;
    }
  }
  return 0;
}

static inline void idtable_put(IdTable *t, IdSlot s) {
  uint32_t i = s.hash & (t->cap - 1);
  while (t->slots[i].id1) i = (i + 1) & (t->cap - 1);
  t->slots[i] = s;
}

static inline void idtable_add(IdTable *t, uint32_t hash, uint32_t id) {
  if (2 * (t->n + 1) > t->cap) {
    IdTable bigger = idtable(t->arena, t->n + 1);
    bigger.n = t->n;
    for (uint32_t i = 0; i < t->cap; i++)
      if (t->slots[i].id1) idtable_put(&bigger, t->slots[i]);
    arena_release(t->arena, t->slots, t->cap * sizeof *t->slots);
    *t = bigger;
  }
  idtable_put(t, (IdSlot){.id1 = id + 1, .hash = hash});
  t->n++;
}
