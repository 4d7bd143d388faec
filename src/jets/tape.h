/* Tape: operations on jets in the order in which they are done, as the text writes them. Nothing is simplified: only arithmetic of
 * exact numbers is done at once, as indices and conditions of families need it. */
#ifndef LAGC_TAPE_H
#define LAGC_TAPE_H

#include "base/arena.h"
#include "base/num.h"
#include "base/vec.h"
#include "jets/jet.h"

typedef uint32_t Ref; /* a value on the tape; 0: none */

typedef enum {
  TAPE_NUMBER,   /* number */
  TAPE_PI,
  TAPE_INPUT,    /* input, index */
  TAPE_ADD, TAPE_SUB, TAPE_MUL, TAPE_DIV, TAPE_NEG,
  TAPE_RATE,     /* da/dt along the motion */
  TAPE_POWER,    /* a^number */
  TAPE_POW,      /* a^b */
  TAPE_FUNCTION, /* text(a) */
  TAPE_ATAN2, TAPE_HYPOT, TAPE_MIN, TAPE_MAX, TAPE_SIGN,
  TAPE_LT, TAPE_LE, TAPE_EQ, TAPE_NOT, TAPE_AND, TAPE_OR,
  TAPE_SELECT    /* a ? b : c */
} TapeOp;

typedef enum { INPUT_TIME, INPUT_COORD, INPUT_STATE, INPUT_PARAM, INPUT_SIGNAL, INPUT_MULTIPLIER } InputKind;

typedef struct {
  TapeOp op;
  Ref a, b, c;
  uint32_t slot; /* where its value stands, until its last use: tape_finish */
  Num number;
  InputKind input;
  uint32_t index;
  const char *text;
  uint32_t at;   /* the node of the Ast that it was made for */
} TapeIns;

typedef struct {
  Arena *arena;
  VEC(TapeIns) ins; /* [0] unused */
  uint32_t slots;   /* that are needed at once */
  int too_long;     /* nothing is appended any more */
  uint32_t node;    /* of the Ast, whose value is being appended: the caller sets it */
  struct Partial *partial; /* of tape_partial */
} Tape;

/* limit: TAPE_LIMIT instructions. Past it tape_op returns 0. */
enum { TAPE_LIMIT = 700000 };

Tape *tape_new(Arena *a);
Ref tape_number(Tape *t, Num n);
Ref tape_pi(Tape *t);
Ref tape_input(Tape *t, InputKind kind, uint32_t index);
Ref tape_op(Tape *t, TapeOp op, Ref a, Ref b, Ref c); /* 0 where an operand is 0 */
Ref tape_function(Tape *t, const char *name, Ref a);
Ref tape_power(Tape *t, Ref a, Num exponent);

/* The partial derivative of a value by an input or a rate of one, by = x, x', x''. 0: `by` is none of these, or the tape is too long. */
Ref tape_partial(Tape *t, Ref of, Ref by);

/* p q' - L of a Lagrangian whose coordinates are the inputs of one kind. */
Ref tape_energy(Tape *t, Ref lagrangian, InputKind kind);

/* Whether it is an exact number, and which one. */
int tape_is_number(const Tape *t, Ref a, Num *n);

/* Gives each value a slot; the roots keep theirs. Nothing may be appended after. */
void tape_finish(Tape *t, const Ref *roots, uint32_t n);

/* The value of an input, as a jet. */
typedef void TapeInput(void *data, InputKind kind, uint32_t index, Jet *out);

/* Runs it; at[slots]. A comparison that rounding could turn, and a value that no double holds, set *unsure. */
void tape_run(const Tape *t, TapeInput *input, void *data, Jet *at, int *unsure);

/* The first instruction whose value no double holds (or one of whose derivatives is not finite) while doubles hold what it is made of; 0: there is none. Values stand in
 * at[slots], of those that it is made of too. */
Ref tape_first_not_finite(const Tape *t, TapeInput *input, void *data, int derivatives, Jet *at);

static inline const Jet *tape_value(const Tape *t, const Jet *at, Ref a) { return &at[t->ins.at[a].slot]; }

#endif
