/* Scope: symbol table, from names to declarations. A name belongs to the model or to an effect. Inside an effect
 * its own names hide the model's; elsewhere `drag.c` reaches them, or `c` where only one effect in use declares it. */
#pragma once

#include "base/id_table.h"
#include "base/intern.h"
#include "base/source.h"

/* Families: the entity of `th[N]` has index ranges; its members are adjacent in the model's array, row by row, the
 * components of a vector together. Members of lets and observables are entities of their own, in a second scope
 * (Builder.members), as they are declared one by one. */

typedef enum {
  ENT_NONE, /* declaration refused: uses are not reported again */
  ENT_COORD, ENT_STATE, ENT_PARAM, ENT_CONST, ENT_INPUT, ENT_LET, ENT_FUNCTION, ENT_OBSERVE, ENT_SYMMETRY,
  ENT_BUILTIN /* lagrangian, energy, T, V */
} EntKind;

typedef struct {
  EntKind kind;
  uint32_t index; /* into the model's array of that kind */
  Name name, effect; /* effect NULL: declared by the model itself */
  Span span;
  uint8_t ndims;     /* number of indices: 0, 1 or 2 */
  uint8_t parts;     /* number of components: 2 or 3 for vectors, 4 for rotations, else 0 */
  int64_t lo[2], hi[2]; /* range of each index */
} Entity;

typedef struct {
  Arena *arena;
  VEC(Entity) all;
  IdTable table; /* of `all` */
  VEC(Entity) behind; /* functions of the language, for names that nothing else declares */
} Scope;

/* The entity that `effect` (NULL: the model itself) declares as `name`, or NULL. */
const Entity *scope_own(const Scope *s, Name name, Name effect);

/* The entity that `name` means inside `effect` (NULL: outside of effects), or NULL. *ambiguous, unless NULL: neither
 * the effect nor the model declares it, and several effects in use do. */
const Entity *scope_find(const Scope *s, Name name, Name effect, int *ambiguous);

void scope_add(Scope *s, Entity e);

/* Number of scalars: members times components; 0: a family without members, whose index names nothing. */
static inline uint32_t entity_size(const Entity *e) {
  uint64_t n = e->parts ? e->parts : 1;
  for (int k = 0; k < e->ndims; k++) n *= e->hi[k] < e->lo[k] ? 0 : (uint64_t)(e->hi[k] - e->lo[k] + 1);
  return (uint32_t)n;
}

const char *ent_kind_text(EntKind kind); /* "a coordinate", ... */
