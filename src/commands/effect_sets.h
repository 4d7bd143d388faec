/* Sets of effects compared with a scene's own set, as planned. A variant is the scene with another set of effects. An
 * effect is left out together with those that require it, and added together with what it requires. */
#pragma once

#include "commands/compiler.h"
#include "model/effect.h"
#include "model/model.h"

typedef uint64_t EffectSet; /* bit i: effect i of the file, in order of text */
enum { EFFECTS_SEARCHED = 10 }; /* effects of which all sets are run, at most */

typedef VEC(EffectSet) EffectSets;

/* Measurements of one variant. */
typedef struct {
  int ops;
  /* time of a call [s]; the others: runtime/analysis/effect_variants.h; NaN: not measured */
  double time, difference, weight;
  const char *why;                 /* why its run failed, or NULL */
} EffectMeasurement;

/* One effect. The variants upper and lower differ by this effect alone; the variant apart is compared with the
 * scene. */
typedef struct {
  uint32_t effect;
  int on;
  uint32_t upper, lower, apart;
  EffectSet together; /* effects left out, or added, with it */
  Name excluded_by;   /* effect of the scene that excludes it, so that nothing is measured; or NULL */
} EffectRow;

typedef struct {
  Arena *arena;
  const Ast *ast;
  EffectGraph graph;
  const Model *scene;
  EffectSet used;
  EffectSets variants; /* the first is the scene's own set */
  uint32_t base;       /* variant of the empty set */
  VEC(EffectRow) rows;

  const char *method;
  double span, error; /* length of the run [s]; error of integration, NaN: not known */
  EffectMeasurement *measured; /* [variants.n] */
  int evaluated;               /* times are those of evaluated functions */

  double accuracy;    /* --accuracy; 0: not given */
  EffectSet least;    /* smallest set within the accuracy */
  double least_difference;
  uint32_t tried;     /* number of sets that were run */
} EffectStudy;

/* Plans the study of a scene's model. NULL, with a diagnostic, when there are no effects, or too many. */
EffectStudy *effect_study_plan(const Model *scene);

uint32_t effect_count(EffectSet set);
EffectList effect_names(const EffectStudy *s, EffectSet set);

/* Whether the set contains the requirements of each of its effects. */
int effect_set_complete(const EffectStudy *s, EffectSet set);
/* Whether the set has what its effects require, and no two that exclude each other. */
int effect_set_valid(const EffectStudy *s, EffectSet set);
