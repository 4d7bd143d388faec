/* Studies of sets of effects: run as variants of one program, which measures them (runtime/app/effect_costs.c), and
 * searched for the smallest that suffices. */
#pragma once

#include "commands/effect_sets.h"

/* "wind, spin". */
const char *effect_names_joined(const EffectStudy *s, EffectSet set);
/* The `use` statement of a set, with the scene's values: `use j2, drag(c = 2)`. */
const char *effect_use_statement(const EffectStudy *s, EffectSet set);

/* *path := a compiled program of these variants, in the cache. Returns a STATUS. */
int effect_sets_build(Compiler *c, EffectStudy *s, const EffectSets *sets, const char **path);
/* Makes such a program, evaluated or compiled, and runs it with these arguments, `--effects report` or
 * `--effects runs` among them; *measured := [sets->n]. Returns a STATUS. */
int effect_sets_run(Compiler *c, EffectStudy *s, const EffectSets *sets, char *const *argv,
                    EffectMeasurement **measured);

/* Runs all sets of 0, 1, 2, ... effects that contain their requirements, beside the scene's own, until one differs
 * by s->accuracy at most: s->least, or the scene's own. argv as above, with "runs". Returns a STATUS. */
int effect_find_least(Compiler *c, EffectStudy *s, char *const *argv);
