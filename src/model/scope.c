#include "model/scope.h"

/* Names are interned: their addresses are their hashes. */
static uint32_t bucket(Name name) { return (uint32_t)(((uintptr_t)name >> 4) % SCOPE_BUCKETS); }

static const Entity *next_of(const Scope *s, uint32_t i, Name name) {
  while (i && s->all.at[i - 1].name != name) i = s->all.at[i - 1].next;
  return i ? &s->all.at[i - 1] : NULL;
}

const Entity *scope_own(const Scope *s, Name name, Name effect) {
  const Entity *e = next_of(s, s->heads[bucket(name)], name);
  while (e && e->effect != effect) e = next_of(s, e->next, name);
  return e;
}

const Entity *scope_find(const Scope *s, Name name, Name effect, int *ambiguous) {
  *ambiguous = 0;
  const Entity *own = effect ? scope_own(s, name, effect) : NULL;
  if (!own) own = scope_own(s, name, NULL);
  if (own) return own;
  const Entity *found = next_of(s, s->heads[bucket(name)], name);
  if (found && next_of(s, found->next, name)) *ambiguous = 1;
  return found;
}

void scope_add(Scope *s, Entity e) {
  uint32_t *head = &s->heads[bucket(e.name)];
  e.next = *head;
  vec_push(s->arena, &s->all, e);
  *head = s->all.n;
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
