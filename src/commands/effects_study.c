/* `lagc effects`: plans variants, reads their measurements, searches the smallest sufficient set. A set of effects is a bit mask. */
#include "commands/effects_study.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- sets --- */

static EffectSet one(uint32_t i) { return (EffectSet)1 << i; }

static uint32_t count(EffectSet set) {
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

EffectList effects_of(const EffectStudy *s, EffectSet set) {
  VEC(Name) names = {0};
  for (uint32_t i = 0; i < s->graph.n; i++)
    if (set & one(i)) vec_push(s->arena, &names, s->graph.at[i].stmt->name);
  return (EffectList){names.at, names.n};
}

/* Whether the set contains the requirements of each of its effects. */
static int meets_requirements(const EffectStudy *s, EffectSet set) {
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

EffectStudy *effects_plan(const Model *scene) {
  EffectStudy *s = ARENA_NEW(scene->arena, EffectStudy);
  *s = (EffectStudy){.arena = scene->arena, .ast = scene->ast, .graph = effect_graph(scene->ast), .scene = scene, .error = NAN};
  if (!s->graph.n || s->graph.n > MOST_EFFECTS) {
    diag_error(scene->diags, scene->span, s->graph.n ? "the model has %u effects; `lagc effects` compares up to %d" : "the model has no effects to compare",
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

/* --- measurements --- */

/* The text after `word` and a space at the beginning of the line; NULL: the line begins otherwise. */
static char *text_after(char *line, const char *word) {
  size_t n = strlen(word);
  return strncmp(line, word, n) == 0 && line[n] == ' ' ? line + n + 1 : NULL;
}

static int read_variant(char *text, EffectMeasurement *m, uint32_t n) {
  char *at = text;
  unsigned long i = strtoul(at, &at, 10);
  if (i >= n) return 0;
  m[i].ops = (int)strtol(at, &at, 10);
  m[i].time = strtod(at, &at);
  m[i].difference = strtod(at, &at);
  m[i].weight = strtod(at, &at);
  return 1;
}

EffectMeasurement *effects_read(EffectStudy *s, char *said, uint32_t n, const char **rest) {
  EffectMeasurement *m = ARENA_ARRAY(s->arena, EffectMeasurement, n);
  StrBuf other = strbuf(s->arena);
  uint32_t found = 0;
  for (char *line = said, *next; line && *line; line = next) {
    char *end = strchr(line, '\n'), *text;
    next = end ? end + 1 : NULL;
    if (end) *end = '\0';
    if ((text = text_after(line, "variant")) != NULL) found += (uint32_t)read_variant(text, m, n);
    else if ((text = text_after(line, "failed")) != NULL) {
      unsigned long i = strtoul(text, &text, 10);
      if (i < n) m[i].why = text + 1;
    }
    else if ((text = text_after(line, "method")) != NULL) s->method = text;
    else if ((text = text_after(line, "span")) != NULL) s->span = strtod(text, NULL);
    else if ((text = text_after(line, "error")) != NULL) s->error = strtod(text, NULL);
    else sb_printf(&other, "%s\n", line);
  }
  *rest = sb_text(&other);
  return found == n ? m : NULL;
}

/* A difference of two runs carries the error of each: hence twice. */
double effects_limit(const EffectStudy *s) { return s->accuracy > 0 ? s->accuracy : 2 * s->error; }

const char *effects_verdict(const EffectStudy *s, const EffectRow *row) {
  if (row->excluded_by) return "excluded";
  const EffectMeasurement *m = &s->measured[row->apart];
  int matters = m->why || !(m->difference <= effects_limit(s));
  if (row->on) return matters ? "needed" : s->accuracy > 0 ? "below the accuracy" : "below the scene's accuracy";
  return matters ? "would matter" : "would not matter";
}

/* --- the smallest set --- */

/* Takes the set for the least so far if it meets the accuracy with fewer operations than the best one. */
static void keep_if_better(EffectStudy *s, EffectSet set, const EffectMeasurement *m, int *best_ops) {
  if (m->why || !(m->difference <= s->accuracy) || m->ops >= *best_ops) return;
  *best_ops = m->ops;
  s->least = set;
  s->least_difference = m->difference;
}

/* Adds all proper subsets of the scene's set that have k effects and contain their requirements. */
static void add_subsets(const EffectStudy *s, uint32_t k, EffectSets *sets) {
  for (EffectSet set = s->used; set; ) {
    set = (set - 1) & s->used; /* the next smaller subset */
    if (count(set) == k && meets_requirements(s, set)) vec_push(s->arena, sets, set);
  }
}

/* The untried effect of `set` with the least difference, with the effects that require it. 0: all were tried. */
static EffectSet least_alone(const EffectStudy *s, EffectSet set, EffectSet tried) {
  const EffectRow *least = NULL;
  for (uint32_t i = 0; i < s->rows.n; i++) {
    const EffectRow *row = &s->rows.at[i];
    if (!(set & one(row->effect)) || tried & one(row->effect)) continue;
    if (!least || s->measured[row->apart].difference < s->measured[least->apart].difference) least = row;
  }
  return least ? one(least->effect) | (least->together & set) : 0;
}

static EffectSets try_greedily(EffectStudy *s, const EffectSets *before, const EffectMeasurement *measured) {
  EffectSets sets = {0};
  if (before) {
    int ops = 1 << 30;
    EffectSet gone = s->least & ~before->at[1];
    s->tried++;
    keep_if_better(s, before->at[1], &measured[1], &ops);
    s->rejected |= s->least == before->at[1] ? 0 : gone;
  }
  EffectSet leave = least_alone(s, s->least, s->rejected);
  if (!leave) return sets;
  vec_push(s->arena, &sets, s->used);
  vec_push(s->arena, &sets, s->least & ~leave);
  return sets;
}

EffectSets effects_next_sets(EffectStudy *s, const EffectSets *before, const EffectMeasurement *measured) {
  EffectSets sets = {0};
  uint32_t k = 0, all = count(s->used);
  int ops = 1 << 30;
  s->exhaustive = all <= MOST_EXHAUSTIVE;
  if (!before) s->least = s->used;
  if (!s->exhaustive) return try_greedily(s, before, measured);
  if (before) {
    for (uint32_t i = 1; i < before->n; i++) keep_if_better(s, before->at[i], &measured[i], &ops);
    s->tried += before->n - 1;
    if (s->least != s->used) return sets;
    k = count(before->at[1]) + 1;
  }
  vec_push(s->arena, &sets, s->used);
  for (; k < all && sets.n == 1; k++) add_subsets(s, k, &sets);
  if (sets.n == 1) sets.n = 0;
  return sets;
}

/* --- the `use` statement --- */

/* The `use` statement of the effect in the scene, or in the nearest scene along its chain of `like`; NULL: none. */
static const AstStmt *use_of(const EffectStudy *s, Name effect) {
  Name scene = s->scene->scene.name;
  for (uint32_t guard = 0; scene && guard < 1000; guard++) {
    const AstStmt *st = s->ast->first;
    while (st && !(st->kind == STMT_SCENE && st->name == scene)) st = st->next;
    scene = NULL;
    for (const AstStmt *x = st ? st->body : NULL; x; x = x->next) {
      if (x->kind == STMT_USE && x->name == effect) return x;
      if (x->kind == STMT_LIKE) scene = x->name;
    }
  }
  return NULL;
}

/* Appends the settings of a `use` statement as they were written: `(c = 2)` of `use drag(c = 2)`. */
static void add_values(const EffectStudy *s, const AstStmt *use, StrBuf *out) {
  if (!use || !use->body) return;
  const AstStmt *last = use->body;
  while (last->next) last = last->next;
  Place p = source_place(s->ast->sources, use->body->span.begin);
  if (!p.file) return;
  const char *from = p.file->text + (use->body->span.begin - p.file->base);
  sb_printf(out, "(%.*s)", (int)(last->span.end - use->body->span.begin), from);
}

const char *effects_use(const EffectStudy *s, EffectSet set) {
  StrBuf b = strbuf(s->arena);
  EffectList names = effects_of(s, set);
  if (!names.n) return "use none";
  for (uint32_t i = 0; i < names.n; i++) {
    sb_printf(&b, "%s%s", i ? ", " : "use ", names.at[i]);
    add_values(s, use_of(s, names.at[i]), &b);
  }
  return sb_text(&b);
}
