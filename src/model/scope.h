/* Scope: which declaration a name means. A name belongs to the model, or to an effect; inside an
 * effect its own names come first, and outside `drag.c` reaches them, or `c` where that is unique. */
#ifndef LAGC_SCOPE_H
#define LAGC_SCOPE_H

#include "base/source.h"
#include "base/intern.h"

typedef enum {
  ENT_NONE, /* declared, but refused as "not yet": its uses are not reported again */
  ENT_COORD, ENT_STATE, ENT_PARAM, ENT_CONST, ENT_INPUT, ENT_LET, ENT_FUNCTION, ENT_OBSERVE,
  ENT_BUILTIN /* lagrangian, energy, T, V */
} EntKind;

typedef struct {
  EntKind kind;
  uint32_t index; /* into the model's array of that kind */
  Name name, effect; /* effect NULL: the model's own */
  Span span;
  uint32_t next; /* in its bucket, from 1; 0: none */
} Entity;

enum { SCOPE_BUCKETS = 4096 };

typedef struct {
  Arena *arena;
  VEC(Entity) all;
  uint32_t heads[SCOPE_BUCKETS]; /* newest entity of a bucket, from 1 */
} Scope;

/* The entity declared as `name` in exactly that place, or NULL. */
const Entity *scope_own(const Scope *s, Name name, Name effect);

/* What `name` means when written inside `effect` (NULL: outside all). *ambiguous is set when two
 * effects in use declare it and nothing nearer does. */
const Entity *scope_find(const Scope *s, Name name, Name effect, int *ambiguous);

void scope_add(Scope *s, Entity e);

const char *ent_kind_text(EntKind kind); /* "a coordinate", ... */

#endif
