/* `lagc effects`: one simulator of several sets of effects, run and compared. */
#include "commands/commands.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "commands/effects_study.h"
#include "commands/required_derivatives.h"
#include "commands/simulator.h"
#include "toolchain/process.h"
#include "ir/hoist.h"
#include "lower/lower.h"

/* The scene with another set of effects, as a unit of its own. */
static IrUnit *lower_variant(Compiler *c, EffectList effects, unsigned *wants) {
  Eqns *e = compiler_derive_wanted(c, &(ModelChoice){.scene = c->o.scene, .only = &effects, .given = c->given.at, .ngiven = c->given.n});
  if (!e) return NULL;
  IrUnit *u = compiler_new_unit(c, e);
  *wants |= derivatives_required(e, &c->o); /* all variants run by the method of the first */
  unit_require(u, e, *wants);
  unit_add_scene(u, e);
  unit_hoist(u);
  return compiler_agrees(e, u, 0) ? u : NULL;
}

/* Builds a program of these variants, runs it, and parses its measurements. */
static int run_variants(Compiler *c, EffectStudy *s, const EffectSets *sets, const char *what, EffectMeasurement **measured) {
  Toolchain tools;
  Units units = {0};
  unsigned wants = 0;
  const char *error = NULL, *path, *rest;
  char *said = NULL;
  for (uint32_t i = 0; i < sets->n; i++) {
    IrUnit *u = lower_variant(c, effects_of(s, sets->at[i]), &wants);
    if (!u) return STATUS_MODEL;
    vec_push(c->arena, &units, u);
  }
  if (!toolchain_find(c->arena, c->argv0, !c->o.no_gsl, &tools, &error)) return usage_error(error);
  if (strcmp(what, "runs") == 0) tools.optimise = "-O0"; /* same bits; compilation takes longer than the runs */
  Texts texts = simulator_texts(c, &units, tools.gsl);
  int status = simulator_make(c, &tools, &texts, NULL, &path);
  if (status != STATUS_OK) return status;
  char *const program = arena_strdup(c->arena, path), **argv = ARENA_ARRAY(c->arena, char *, c->picture.argv.n);
  memcpy(argv, c->picture.argv.at, c->picture.argv.n * sizeof *argv);
  argv[2] = arena_strdup(c->arena, what);
  status = process_run_as(c->arena, program, argv, &said);
  *measured = effects_read(s, said, sets->n, &rest);
  fputs(rest, stderr);
  if (status == STATUS_OK && !*measured) return usage_error("the simulator of `lagc effects` printed no measurements");
  return status;
}

/* --accuracy: searches the smallest set of effects. */
static int find_least(Compiler *c, EffectStudy *s) {
  EffectMeasurement *measured = NULL;
  if (!num_parse_double(c->o.accuracy, &s->accuracy) || !(s->accuracy > 0)) return usage_error(arena_printf(c->arena, "--accuracy %s: a difference that does not matter, relative and positive; for example 1e-6", c->o.accuracy));
  if (!(s->error <= s->accuracy / 10)) {
    fprintf(stderr, "lagc: --accuracy %g: the error of integration, %.2g, is not well below it; add --tol with a smaller number, or --step\n", s->accuracy, s->error);
    return STATUS_RUN;
  }
  for (EffectSets sets = effects_next_sets(s, NULL, NULL); sets.n;) {
    int status = run_variants(c, s, &sets, "runs", &measured);
    if (status != STATUS_OK) return status;
    EffectSets next = effects_next_sets(s, &sets, measured);
    sets = next;
  }
  return STATUS_OK;
}

int command_effects(Compiler *c) {
  int status = simulator_prepare(c);
  Model *m = status == STATUS_OK ? model_build(c->ast, &(ModelChoice){.scene = c->o.scene, .defines = c->o.defines.at, .ndefines = c->o.defines.n}) : NULL;
  EffectStudy *s = m ? effects_plan(m) : NULL;
  if (!s) return status == STATUS_OK ? STATUS_MODEL : status;
  status = run_variants(c, s, &s->variants, "report", &s->measured);
  if (status == STATUS_OK && c->o.accuracy) status = find_least(c, s);
  if (status != STATUS_OK) return status;
  StrBuf out = strbuf(c->arena);
  if (c->o.json) effects_json(s, &out);
  else effects_text(s, &out);
  return compiler_write(c, NULL, &out);
}
