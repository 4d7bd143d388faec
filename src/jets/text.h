/* Ast -> Tape: expressions as the text writes them, without the expression graph.
 *
 * Names mean what the model's scopes say; all else (indices, units, functions, vectors, rotations, sums) is read from the Ast once
 * more, so that what model/ and sym/ make of an expression can be compared with it. */
#ifndef LAGC_TEXT_H
#define LAGC_TEXT_H

#include "jets/tape.h"
#include "model/builder.h"

/* A number, a vector of n = 2 or 3 components, or a rotation, n = ROTATION, times `scale` (0: 1). at[0] is 0 where the expression
 * has no value here: Text.why says for what reason. */
typedef struct {
  Ref at[4], scale;
  uint32_t n;
  int bare; /* made of numbers alone: takes the unit of what it is given to */
} Meaning;

typedef struct Text Text;

struct Text {
  const Model *m;
  const Builder *b;
  Arena *arena;
  Tape *tape;
  Meaning *lets, *observes, *constants; /* by their places in the builder; at[0] = 0: not evaluated yet */
  const char *why;                      /* the first thing that has no meaning here, since the caller set it to NULL */
  Ref lagrangian, kinetic, potential;   /* of `lagrangian`, `T`, `V`, `energy`, `p_x` in outputs: the caller gives them, where `asks` */
  const int64_t *member;                /* of the family that an output names without index; NULL: a family has no value */
  int asks;                             /* one of these names was met before they were given */
  VEC(struct Frame *) idle;             /* evaluations to use again */
};

Text *text_new(const Model *m, Arena *a);

/* The value of an expression inside `effect` (NULL: the model), with these indices around it. */
Meaning text_value(Text *t, AstId id, Name effect, const IndexVars *around);

/* Component k of v, given to a name in `unit`: a bare number is in that unit. */
Ref text_component(Text *t, const Meaning *v, uint32_t k, const Unit *unit);

/* The ends of a range; 0 where they are not known. */
int text_range(Text *t, AstId lo, AstId hi, Name effect, const IndexVars *around, int64_t *from, int64_t *to);

/* a times b of rotations, in the sense of "first b, then a"; what q makes of v. */
Meaning text_turned(Text *t, const Meaning *q, const Meaning *v);

static inline uint32_t meaning_parts(const Meaning *v) { return v->n ? v->n : 1; }

#endif
