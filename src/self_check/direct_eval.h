/* Ast -> Tape: expressions as written, without the expression graph.
 *
 * Names are looked up in the model's scopes; all else (indices, units, functions, vectors, rotations, sums) is
 * evaluated from the Ast by independent code, so that it can be compared with model/ and sym/. */
#pragma once

#include "self_check/tape.h"
#include "model/declarations.h"
#include "model/model.h"

/* Value of an expression: a number (n = 0), a vector of n = 2 or 3 components, or a rotation, n = ROTATION, times
 * `scale` (0: none). at[0] = 0: not evaluated here; DirectEval.why has the reason. */
typedef struct {
  Ref at[4], scale;
  uint32_t n;
  int bare; /* made of plain numbers: takes the unit of the name it is given to */
} TextValue;

typedef struct DirectEval DirectEval;

struct DirectEval {
  const Model *m;
  const Declarations *b;
  Arena *arena;
  Tape *tape;
  TextValue *lets, *observes, *constants; /* values, indexed as in Declarations; at[0] = 0: not evaluated yet */
  const char *why;                      /* first construct that could not be evaluated; the caller resets it to NULL */
  /* energies for `lagrangian`, `T`, `V`, `energy`, `p_x` in outputs: set by the caller if `needs_energies` */
  Ref lagrangian, kinetic, potential;
  /* indices for a family named without any, in outputs; NULL: such a family has no value */
  const int64_t *member;
  int samples;                                    /* as in text_new */
  int needs_energies;                             /* an energy was needed before it was set */
  VEC(struct Frame *) idle;             /* free list of frames */
};

/* samples: sums over pairs that are not written out (Model.sums) have a sample of their terms. */
DirectEval *text_new(const Model *m, int samples, Arena *a);

/* Evaluates an expression inside `effect` (NULL: the model), with the enclosing indices `around`. */
TextValue text_value(DirectEval *t, AstId id, Name effect, const IndexVars *around);

/* Component k of v in SI, as assigned to a name with `unit`: a bare number is in that unit. */
Ref text_component(DirectEval *t, const TextValue *v, uint32_t k, const Unit *unit);

/* Evaluates the ends of a range; 0: not integer constants. */
int text_range(DirectEval *t, AstId lo, AstId hi, Name effect, const IndexVars *around, int64_t *from, int64_t *to);

static inline uint32_t text_components(const TextValue *v) { return v->n ? v->n : 1; }
