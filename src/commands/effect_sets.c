/* Sets of effects: closed under requirements, and those that are compared with a scene's own. */
#include "commands/effect_sets.h"

#include <math.h>

enum { MOST_EFFECTS = 64 };

/* --- sets --- */

static EffectSet one(uint32_t i) { return (EffectSet)1 << i; }

uint32_t effect_count(EffectSet set) {
  uint32_t n = 0;
  for (; set; set &= set - 1) n++;
  return n;
}

/* The effect and all effects that it requires, directly or not (up: all that require it). */
static EffectSet closure_of(const EffectStudy *s, uint32_t effect, int up) {
  uint8_t *in = ARENA_ARRAY(s->arena, uint8_t, s->graph.n);
  EffectSet set = 0;
  effect_reach(s->ast, &s->graph, effect, up, in);
  for (uint32_t i = 0; i < s->graph.n; i++) set |= in[i] ? one(i) : 0;
  return set;
}

EffectList effect_names(const EffectStudy *s, EffectSet set) {
  VEC(Name) names = {0};
  for (uint32_t i = 0; i < s->graph.n; i++)
    if (set & one(i)) vec_push(s->arena, &names, s->graph.at[i].stmt->name);
  return (EffectList){names.at, names.n};
}

int effect_set_complete(const EffectStudy *s, EffectSet set) {
  for (uint32_t i = 0; i < s->graph.n; i++)
    for (uint32_t k = 0; set & one(i) && k < s->graph.at[i].requires.n; k++)
      if (!(set & one(s->graph.at[i].requires.at[k]))) return 0;
  return 1;
}

/* Finds two effects of the set that exclude each other, and returns the one that the scene uses; NULL: no conflict. */
static Name excluding_effect(const EffectStudy *s, EffectSet set) {
  for (uint32_t i = 0; i < s->graph.n; i++)
    for (uint32_t k = 0; set & one(i) && k < s->graph.at[i].excludes.n; k++) {
      uint32_t other = s->graph.at[i].excludes.at[k];
      if (set & one(other)) return s->graph.at[s->used & one(other) ? other : i].stmt->name;
    }
  return NULL;
}

int effect_set_valid(const EffectStudy *s, EffectSet set) {
  return effect_set_complete(s, set) && !excluding_effect(s, set);
}

/* --- variants --- */

static uint32_t variant(EffectStudy *s, EffectSet set) {
  for (uint32_t i = 0; i < s->variants.n; i++)
    if (s->variants.at[i] == set) return i;
  vec_push(s->arena, &s->variants, set);
  return s->variants.n - 1;
}

static void plan_row(EffectStudy *s, uint32_t effect) {
  EffectRow row = {.effect = effect, .on = (s->used & one(effect)) != 0};
  if (row.on) {
    EffectSet gone = closure_of(s, effect, 1) & s->used;
    row.together = gone & ~one(effect);
    row.upper = variant(s, s->used & ~row.together);
    row.lower = row.apart = variant(s, s->used & ~gone);
  } else {
    EffectSet added = closure_of(s, effect, 0) & ~s->used;
    row.together = added & ~one(effect);
    row.excluded_by = excluding_effect(s, s->used | added);
    row.upper = row.apart = row.excluded_by ? 0 : variant(s, s->used | added);
    row.lower = row.excluded_by ? 0 : variant(s, (s->used | added) & ~one(effect));
  }
  vec_push(s->arena, &s->rows, row);
}

EffectStudy *effect_study_plan(const Model *scene) {
  EffectStudy *s = ARENA_NEW(scene->arena, EffectStudy);
  *s = (EffectStudy){
      .arena = scene->arena, .ast = scene->ast, .graph = effect_graph(scene->ast), .scene = scene, .error = NAN};
  if (!s->graph.n || s->graph.n > MOST_EFFECTS) {
    diag_error(scene->diags, scene->span,
               s->graph.n ? "the model has %u effects; `lagc effects` compares up to %d"
                          : "the model has no effects to compare",
               s->graph.n, MOST_EFFECTS);
    diag_help(scene->diags, "declare an effect with `effect drag { ... }`, and turn it on with `use drag` in a scene");
    return NULL;
  }
  for (uint32_t i = 0; i < s->graph.n; i++)
    for (uint32_t k = 0; k < scene->effects.n; k++)
      if (scene->effects.at[k] == s->graph.at[i].stmt->name) s->used |= one(i);
  variant(s, s->used);
  s->base = variant(s, 0);
  for (uint32_t i = 0; i < s->graph.n; i++)
    if (s->used & one(i)) plan_row(s, i);
  for (uint32_t i = 0; i < s->graph.n; i++)
    if (!(s->used & one(i))) plan_row(s, i);
  return s;
}
