/* `lagc effects`: plans which sets of effects are compared with a scene's own set, and judges the measurements.
 *
 * A variant is the scene with another set of effects. main.c makes a program of variants, and a run of it measures them
 * (runtime/app/effects.c). An effect is left out together with those that require it, and added together with what it requires. */
#ifndef LAGC_COMMANDS_EFFECTS_STUDY_H
#define LAGC_COMMANDS_EFFECTS_STUDY_H

#include "model/effect.h"
#include "model/model.h"

typedef uint64_t EffectSet; /* bit i: effect i of the file, in order of text */
enum { MOST_EFFECTS = 64, MOST_EXHAUSTIVE = 10 };

typedef VEC(EffectSet) EffectSets;

/* Measurements of one variant. */
typedef struct {
  int ops;
  double time, difference, weight; /* time of a call [s]; the others: runtime/analysis/effect_variants.h; NaN: not measured */
  const char *why;                 /* why its run failed, or NULL */
} EffectMeasurement;

/* One effect. The variants upper and lower differ by this effect alone; the variant apart is compared with the scene. */
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

  double accuracy;    /* --accuracy; 0: not given */
  EffectSet least;    /* smallest set within the accuracy */
  double least_difference;
  EffectSet rejected; /* effects that the search one by one found necessary */
  uint32_t tried;     /* number of sets that were run */
  int exhaustive;
} EffectStudy;

/* Plans the study of a scene's model. NULL, with a diagnostic, when there are no effects, or too many. */
EffectStudy *effects_plan(const Model *scene);
EffectList effects_of(const EffectStudy *s, EffectSet set);

/* Parses the output of a run of n variants; lines that are no measurements go to *rest. NULL: fewer than n were measured. */
EffectMeasurement *effects_read(EffectStudy *s, char *said, uint32_t n, const char **rest);

/* Next sets to run for --accuracy, the scene's own first; .n is 0 once s->least is known. measured[before->n] belongs to the sets run before; NULL at
 * first. Up to MOST_EXHAUSTIVE effects: all sets of 0, 1, 2, ... effects that contain their requirements, until one meets the accuracy;
 * with more, effects are left out one by one, the one with the least difference first. */
EffectSets effects_next_sets(EffectStudy *s, const EffectSets *before, const EffectMeasurement *measured);

/* Differences below this limit do not count: the accuracy asked for, or twice the error of integration. */
double effects_limit(const EffectStudy *s);
/* The verdict on an effect: "needed", "would not matter", ... */
const char *effects_verdict(const EffectStudy *s, const EffectRow *row);
/* The `use` statement of a set, with the scene's values: `use j2, drag(c = 2)`. */
const char *effects_use(const EffectStudy *s, EffectSet set);

/* effects_text.c */
void effects_text(const EffectStudy *s, StrBuf *out);
void effects_json(const EffectStudy *s, StrBuf *out);

#endif
