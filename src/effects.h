/* `lagc effects`: which sets of effects are compared with a scene's own, and what the measurements say.
 *
 * A variant is the scene with another set of effects. main.c makes a program of variants, and a run of it measures them
 * (runtime/app/effects.c). An effect is left out together with those that require it, and added together with what it requires. */
#ifndef LAGC_EFFECTS_H
#define LAGC_EFFECTS_H

#include "model/effect.h"
#include "model/model.h"

typedef uint64_t EffectSet; /* bit i: effect i of the file, in order of text */
enum { MOST_EFFECTS = 64, MOST_EXHAUSTIVE = 10 };

typedef VEC(EffectSet) EffectSets;

/* What was measured of a variant. */
typedef struct {
  int ops;
  double time, difference, weight; /* [s] a call; as in runtime/analysis/variants.h; NaN: not measured */
  const char *why;                 /* its run failed; or NULL */
} Measured;

/* One effect. upper and lower are variants: what is between them is the effect alone; apart is the one that is compared with the scene. */
typedef struct {
  uint32_t effect;
  int on;
  uint32_t upper, lower, apart;
  EffectSet together; /* is left out, or added, with it */
  Name excluded_by;   /* an effect of the scene that cannot be with it: nothing is measured; or NULL */
} EffectRow;

typedef struct {
  Arena *arena;
  const Ast *ast;
  EffectGraph graph;
  const Model *scene;
  EffectSet used;
  EffectSets variants; /* the first is the scene's own set */
  uint32_t base;       /* the empty one */
  VEC(EffectRow) rows;

  const char *method, *chosen;
  double span, error; /* of integration; NaN: not known */
  Measured *measured; /* [variants.n] */

  double accuracy;    /* asked for; 0: none */
  EffectSet least;    /* the smallest set */
  double least_difference;
  EffectSet rejected; /* of those that were left out one by one: without them it will not do */
  uint32_t tried;     /* how many sets were run to find it */
  int exhaustive;
} EffectStudy;

/* The study of a scene's model. NULL, reported, when there are no effects, or too many. */
EffectStudy *effects_plan(const Model *scene);
EffectList effects_of(const EffectStudy *s, EffectSet set);

/* Reads what a run printed about `n` variants; lines that are no measurements go to *rest. NULL: there are not as many. */
Measured *effects_read(EffectStudy *s, char *said, uint32_t n, const char **rest);

/* The sets to try next for --accuracy, the scene's own first; .n is 0 when s->least is known. `measured` belongs to the sets that were tried
 * before; NULL at first. Up to MOST_EXHAUSTIVE effects: all sets of 0, 1, 2, ... effects that hold what they require, until one will do;
 * with more, effects are left out one by one, that with the least difference first. */
EffectSets effects_try(EffectStudy *s, const EffectSets *before, const Measured *measured);

/* Below that a difference does not count: the accuracy that was asked for, or the scene's own. */
double effects_limit(const EffectStudy *s);
/* "needed", ... */
const char *effects_verdict(const EffectStudy *s, const EffectRow *row);
/* `use j2, drag(c = 2)`, with the scene's values. */
const char *effects_use(const EffectStudy *s, EffectSet set);

/* effects_text.c */
void effects_text(const EffectStudy *s, StrBuf *out);
void effects_json(const EffectStudy *s, StrBuf *out);

#endif
