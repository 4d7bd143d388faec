/* Symbol table: a chained hash table over interned names, newest entity first. Contract: scope.h. */
#include "model/scope.h"

/* Names are interned, so the address is hashed. */
static uint32_t *bucket(const Scope *s, Name name) { return &s->heads[(((uintptr_t)name >> 4) * 0x9e3779b97f4a7c15u >> 32) & (s->nheads - 1)]; }

static const Entity *next_of(const Scope *s, uint32_t i, Name name) {
  while (i && s->all.at[i - 1].name != name) i = s->all.at[i - 1].next;
  return i ? &s->all.at[i - 1] : NULL;
}

static const Entity *newest(const Scope *s, Name name) { return s->nheads ? next_of(s, *bucket(s, name), name) : NULL; }

static void link_entity(Scope *s, uint32_t i) {
  uint32_t *head = bucket(s, s->all.at[i].name);
  s->all.at[i].next = *head;
  *head = i + 1;
}

/* Doubles the table, so that buckets are at least as many as entities. */
static void make_buckets(Scope *s) {
  s->nheads = s->nheads ? 2 * s->nheads : 8;
  s->heads = ARENA_ARRAY(s->arena, uint32_t, s->nheads);
  for (uint32_t i = 0; i < s->all.n; i++) link_entity(s, i);
}

const Entity *scope_own(const Scope *s, Name name, Name effect) {
  const Entity *e = newest(s, name);
  while (e && e->effect != effect) e = next_of(s, e->next, name);
  return e;
}

const Entity *scope_find(const Scope *s, Name name, Name effect, int *ambiguous) {
  *ambiguous = 0;
  const Entity *own = effect ? scope_own(s, name, effect) : NULL;
  if (!own) own = scope_own(s, name, NULL);
  if (own) return own;
  const Entity *found = newest(s, name);
  if (found && next_of(s, found->next, name)) *ambiguous = 1;
  return found;
}

void scope_add(Scope *s, Entity e) {
  if (s->all.n == s->nheads) make_buckets(s);
  vec_push(s->arena, &s->all, e);
  link_entity(s, s->all.n - 1);
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
