/* Scope: which declaration a name means. A name belongs to the model, or to an effect; inside an
 * effect its own names come first, and outside `drag.c` reaches them, or `c` where that is unique. */
#ifndef LAGC_SCOPE_H
#define LAGC_SCOPE_H

#include "base/source.h"
#include "base/intern.h"

/* Families: the entity of `th[N]` has index ranges, and its members stand one after the other in the
 * model's array, row by row, the components of a vector together. Of families whose members are
 * declared one by one (lets, observables) each member is an entity of its own, in a second scope. */

typedef enum {
  ENT_NONE, /* declared, but refused as "not yet": its uses are not reported again */
  ENT_COORD, ENT_STATE, ENT_PARAM, ENT_CONST, ENT_INPUT, ENT_LET, ENT_FUNCTION, ENT_OBSERVE, ENT_SYMMETRY,
  ENT_BUILTIN /* lagrangian, energy, T, V */
} EntKind;

typedef struct {
  EntKind kind;
  uint32_t index; /* into the model's array of that kind */
  Name name, effect; /* effect NULL: the model's own */
  Span span;
  uint8_t ndims;     /* a family has one index, or two */
  uint8_t parts;     /* components of a vector: 2 or 3; otherwise 0 */
  int64_t lo[2], hi[2]; /* the range of each index */
  uint32_t next; /* in its bucket, from 1; 0: none */
} Entity;

typedef struct {
  Arena *arena;
  VEC(Entity) all;
  uint32_t *heads, nheads; /* newest entity of a bucket, from 1; a power of 2 of them, or none */
} Scope;

/* The entity declared as `name` in exactly that place, or NULL. */
const Entity *scope_own(const Scope *s, Name name, Name effect);

/* What `name` means when written inside `effect` (NULL: outside all). *ambiguous is set when two
 * effects in use declare it and nothing nearer does. */
const Entity *scope_find(const Scope *s, Name name, Name effect, int *ambiguous);

void scope_add(Scope *s, Entity e);

/* How many scalars it stands for. */
static inline uint32_t entity_size(const Entity *e) {
  uint64_t n = e->parts ? e->parts : 1;
  for (int k = 0; k < e->ndims; k++) n *= (uint64_t)(e->hi[k] - e->lo[k] + 1);
  return (uint32_t)n;
}

const char *ent_kind_text(EntKind kind); /* "a coordinate", ... */

#endif
