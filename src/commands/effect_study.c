/* Sets of effects (effect_sets.c), built as variants of one program, run, and searched for the smallest that
 * suffices. */
#include "commands/effect_study.h"

#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands/simulator.h"
#include "ir/program_set.h"
#include "lower/lower.h"
#include "mech/switches.h"
#include "toolchain/process.h"

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

/* Parses the output of a run of n variants; lines that are no measurements go to *rest. NULL: fewer than n were
 * measured. */
static EffectMeasurement *read_measurements(EffectStudy *s, char *said, uint32_t n, const char **rest) {
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

/* --- programs --- */

/* The scene with another set of effects, as a unit of its own. */
static ProgramSet *lower_variant(Compiler *c, EffectList effects, unsigned *wants) {
  Eqns *e = compiler_derive_wanted(
      c, &(ModelChoice){.scene = c->o.scene, .only = &effects, .given = c->given.at, .ngiven = c->given.n});
  if (!e) return NULL;
  switches_find(e);
  ProgramSet *u = compiler_new_unit(c, e);
  *wants |= derivatives_required(e, &c->o); /* all variants run by the method of the first */
  unit_require(u, e, *wants);
  unit_add_scene(u, e);
  unit_hoist(u);
  return compiler_agrees(e, u, 0) ? u : NULL;
}

static int lower_variants(Compiler *c, EffectStudy *s, const EffectSets *sets, Units *units) {
  unsigned wants = 0;
  for (uint32_t i = 0; i < sets->n; i++) {
    ProgramSet *u = lower_variant(c, effect_names(s, sets->at[i]), &wants);
    if (!u) return STATUS_MODEL;
    vec_push(c->arena, units, u);
  }
  return STATUS_OK;
}

static int find_tools(Compiler *c, Toolchain *tools) {
  const char *error = NULL;
  if (!toolchain_find(c->arena, c->argv0, !c->o.no_gsl, tools, &error)) return usage_error(error);
  if (c->o.precision && !toolchain_precision(c->arena, tools, c->o.precision, &error)) return usage_error(error);
  return STATUS_OK;
}

int effect_sets_build(Compiler *c, EffectStudy *s, const EffectSets *sets, const char **path) {
  Toolchain tools;
  Units units = {0};
  int status = lower_variants(c, s, sets, &units);
  if (status == STATUS_OK) status = find_tools(c, &tools);
  if (status != STATUS_OK) return status;
  Texts texts = simulator_texts(c, &units, tools.gsl ? PROGRAM_WITH_GSL : PROGRAM_PLAIN);
  return simulator_make(c, &tools, &texts, NULL, path);
}

/* *path := lag-run, which finds the variants as bytes; or else their compiled program. */
static int make_program(Compiler *c, EffectStudy *s, const EffectSets *sets, const char **path) {
  Toolchain tools;
  Units units = {0};
  int status = find_tools(c, &tools);
  if (status != STATUS_OK) return status;
  *path = simulator_evaluator(c, &tools);
  s->evaluated = *path != NULL;
  if (!s->evaluated) return effect_sets_build(c, s, sets, path);
  status = lower_variants(c, s, sets, &units);
  if (status != STATUS_OK) return status;
  StrBuf bytes = simulator_bytes(c, &units);
  if (!process_give("LAG_PROGRAM", &bytes)) return usage_error("cannot write a temporary file: set TMPDIR");
  if (c->o.no_gsl) process_set("LAG_NO_GSL", "1");
  return STATUS_OK;
}

int effect_sets_run(Compiler *c, EffectStudy *s, const EffectSets *sets, char *const *argv,
                    EffectMeasurement **measured) {
  const char *path, *rest;
  char *said = NULL;
  int status = make_program(c, s, sets, &path);
  if (status != STATUS_OK) return status;
  status = process_run(c->arena, path, argv, &said);
  *measured = read_measurements(s, said, sets->n, &rest);
  fputs(rest, stderr);
  if (status == STATUS_OK && !*measured) return usage_error("the simulator of `lagc effects` printed no measurements");
  return status;
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
    if (effect_count(set) == k && effect_set_complete(s, set)) vec_push(s->arena, sets, set);
  }
}

int effect_find_least(Compiler *c, EffectStudy *s, char *const *argv) {
  EffectMeasurement *measured = NULL;
  s->least = s->used;
  for (uint32_t k = 0, all = effect_count(s->used); k < all && s->least == s->used; k++) {
    EffectSets sets = {0};
    int ops = INT_MAX, status;
    vec_push(c->arena, &sets, s->used);
    add_subsets(s, k, &sets);
    if (sets.n == 1) continue;
    if ((status = effect_sets_run(c, s, &sets, argv, &measured)) != STATUS_OK) return status;
    for (uint32_t i = 1; i < sets.n; i++) keep_if_better(s, sets.at[i], &measured[i], &ops);
    s->tried += sets.n - 1;
  }
  return STATUS_OK;
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

const char *effect_use_statement(const EffectStudy *s, EffectSet set) {
  StrBuf b = strbuf(s->arena);
  EffectList names = effect_names(s, set);
  if (!names.n) return "use none";
  for (uint32_t i = 0; i < names.n; i++) {
    sb_printf(&b, "%s%s", i ? ", " : "use ", names.at[i]);
    add_values(s, use_of(s, names.at[i]), &b);
  }
  return sb_text(&b);
}

const char *effect_names_joined(const EffectStudy *s, EffectSet set) {
  StrBuf b = strbuf(s->arena);
  EffectList names = effect_names(s, set);
  for (uint32_t i = 0; i < names.n; i++) sb_printf(&b, "%s%s", i ? ", " : "", names.at[i]);
  return sb_text(&b);
}
