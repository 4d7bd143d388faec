/* Symbol table: a hash table over interned names. Contract: scope.h. */
#include "model/scope.h"

/* Names are interned, so the address is hashed. */
static uint32_t hash_of(Name name) { return (uint32_t)(((uintptr_t)name >> 4) * 0x9e3779b97f4a7c15u >> 32); }

/* The newest entity called `name`, of `effect` unless any; *n: the number of such entities. */
static const Entity *newest(const Scope *s, Name name, Name effect, int any, uint32_t *n) {
  const Entity *found = NULL;
  uint32_t hash = hash_of(name), at = idtable_start(&s->table, hash), id;
  for (*n = 0; idtable_next(&s->table, hash, &at, &id);) {
    const Entity *e = &s->all.at[id];
    if (e->name != name || (!any && e->effect != effect)) continue;
    ++*n;
    if (!found || e > found) found = e;
  }
  return found;
}

const Entity *scope_own(const Scope *s, Name name, Name effect) { return newest(s, name, effect, 0, &(uint32_t){0}); }

const Entity *scope_find(const Scope *s, Name name, Name effect, int *ambiguous) {
  uint32_t n;
  if (ambiguous) *ambiguous = 0;
  const Entity *own = effect ? scope_own(s, name, effect) : NULL;
  if (!own) own = scope_own(s, name, NULL);
  if (own) return own;
  const Entity *found = newest(s, name, NULL, 1, &n);
  if (ambiguous) *ambiguous = n > 1;
  for (uint32_t i = 0; !found && i < s->behind.n; i++)
    if (s->behind.at[i].name == name) return &s->behind.at[i];
  return found;
}

void scope_add(Scope *s, Entity e) {
  s->table.arena = s->arena;
  idtable_add(&s->table, hash_of(e.name), s->all.n);
  vec_push(s->arena, &s->all, e);
}

const char *ent_kind_text(EntKind kind) {
  switch (kind) {
    case ENT_COORD: return "a coordinate";
    case ENT_STATE: return "a state";
    case ENT_PARAM: return "a parameter";
    case ENT_CONST: return "a constant";
    case ENT_INPUT: return "an input";
    case ENT_LET: return "a let";
    case ENT_FUNCTION: return "a function";
    case ENT_OBSERVE: return "an observable";
    case ENT_SYMMETRY: return "a symmetry";
    case ENT_BUILTIN: return "a built-in quantity";
    case ENT_NONE: break;
  }
  return "a name";
}
