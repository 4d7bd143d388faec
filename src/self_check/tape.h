/* Tape: straight-line program of operations on jets, in the order of the text. Nothing is simplified, except that
 * arithmetic of exact numbers is folded, as indices and conditions of families need it. */
#pragma once

#include "base/arena.h"
#include "base/num.h"
#include "base/vec.h"
#include "self_check/jet.h"

typedef uint32_t Ref; /* index of an instruction, and so its value; 0: none */

typedef enum {
  TAPE_NUMBER,   /* number */
  TAPE_PI,
  TAPE_INPUT,    /* input, index */
  TAPE_ADD, TAPE_SUB, TAPE_MUL, TAPE_DIV, TAPE_NEG,
  TAPE_RATE,     /* da/dt along the motion */
  TAPE_POWER,    /* a^number */
  TAPE_POW,      /* a^b */
  TAPE_FUNCTION, /* text(a) */
  TAPE_ATAN2, TAPE_HYPOT, TAPE_MIN, TAPE_MAX, TAPE_SIGN, TAPE_FLOOR,
  TAPE_LT, TAPE_LE, TAPE_EQ, TAPE_NOT, TAPE_AND, TAPE_OR,
  TAPE_SELECT    /* a ? b : c */
} TapeOp;

typedef enum { INPUT_TIME, INPUT_COORD, INPUT_STATE, INPUT_PARAM, INPUT_SIGNAL, INPUT_MULTIPLIER } InputKind;

/* Tapes are as long as what the text writes out: 32 bytes. */
typedef struct {
  uint8_t op, input; /* TapeOp, InputKind */
  uint8_t fraction;  /* of a number: no integer */
  Ref a, b, c;
  uint32_t slot; /* place of the value in at[] until its last use: set by tape_finish */
  uint32_t at;   /* AstId of the node it was made for */
  union {
    int64_t integer;
    const Num *number; /* a fraction */
    uint32_t index;    /* of an input */
    const char *text;
  };
} TapeIns;

typedef struct {
  Arena *arena;
  VEC(TapeIns) ins; /* [0] unused */
  uint32_t slots;   /* number of slots: most values alive at once */
  int too_long;     /* TAPE_LIMIT was reached: nothing more is appended */
  uint32_t node;    /* AstId of the node being evaluated: set by the caller */
  struct Partial *partial; /* working memory of tape_partial */
} Tape;

/* Most instructions of a tape; past it the functions below return 0. */
enum { TAPE_LIMIT = 700000 };

Tape *tape_new(Arena *a);
Ref tape_number(Tape *t, Num n);
Ref tape_pi(Tape *t);
Ref tape_input(Tape *t, InputKind kind, uint32_t index);
Ref tape_op(Tape *t, TapeOp op, Ref a, Ref b, Ref c); /* 0 where an operand is 0 */
Ref tape_function(Tape *t, const char *name, Ref a);
Ref tape_power(Tape *t, Ref a, Num exponent);

/* Partial derivative of a value by an input or its rates, by = x, x', x''. 0: `by` is none of these, or the tape is
 * too long. */
Ref tape_partial(Tape *t, Ref of, Ref by);

/* Energy p q' - L of a Lagrangian whose coordinates are the inputs of one kind. */
Ref tape_energy(Tape *t, Ref lagrangian, InputKind kind);

/* The number of TAPE_NUMBER, the exponent of TAPE_POWER. */
static inline Num tape_ins_number(const TapeIns *i) { return i->fraction ? *i->number : num_int(i->integer); }

/* 1 if a value is an exact number; *n is that number. */
int tape_is_number(const Tape *t, Ref a, Num *n);

/* Assigns slots by liveness; the roots keep theirs to the end. Nothing may be appended afterwards. */
void tape_finish(Tape *t, const Ref *roots, uint32_t n);

/* Callback: the jet of an input. */
typedef void TapeInput(void *data, InputKind kind, uint32_t index, Jet *out);

/* Evaluates the tape into at[slots]. *unsure is set by comparisons within rounding error, and by values beyond the
 * range of doubles. */
void tape_run(const Tape *t, TapeInput *input, void *data, Jet *at, int *unsure);

/* Evaluates the instructions up to one, whose value is then in at[]. */
void tape_run_to(const Tape *t, Ref last, TapeInput *input, void *data, Jet *at);

/* First instruction with finite operands whose value exceeds the range of doubles (derivatives: or whose jet is not
 * finite); 0: none. Its value and its operands are in at[slots]. */
Ref tape_first_nonfinite(const Tape *t, TapeInput *input, void *data, int derivatives, Jet *at);

static inline const Jet *tape_value(const Tape *t, const Jet *at, Ref a) { return &at[t->ins.at[a].slot]; }
