/* State of an evaluation of an expression of the text, shared by direct_eval.c and direct_eval_node.c. */
#pragma once

#include "self_check/direct_eval.h"

/* A `sum` or `product` in progress: its body is evaluated once per index value. */
typedef struct {
  AstId construct;
  int64_t lo, at, hi;
  int inner; /* the sum inside one of which only some terms take part: loop_samples */
  TextValue sum; /* sum or product of the first `terms` terms */
  uint64_t terms;
} TextLoop;

/* A definition: kind, and index in Declarations; ENT_NONE: an expression that is no definition. */
typedef struct {
  EntKind kind;
  uint32_t index;
} PendingDefinition;

enum { FRAMES_MAX = 50000 }; /* depth of definitions that wait for each other */

typedef struct Frame {
  AstId first, root, pc;
  Name effect;
  PendingDefinition what, needs;        /* definition being evaluated; definition needed before node pc */
  int waits, returned;        /* suspended until `needs` has a value; `result` holds that value */
  TextValue result;
  const Definition *function; /* function whose arguments are in scope, or NULL */
  TextValue *args;
  uint32_t nargs;
  IndexVars index;
  VEC(TextLoop) loops;
  uint32_t cap;
  TextValue *value; /* [i] value of node first + i */
  AstId *guard;   /* [i] the sum, product or `if` whose body or branch begins at node first + i, or 0 */
} Frame;

static const TextValue NOTHING = {0};

static inline TextValue unknown(DirectEval *t, const char *why) {
  if (!t->why) t->why = why;
  return NOTHING;
}

/* Reads a whole number, as of an index or a range; 0: v is none. */
static inline int whole(const DirectEval *t, const TextValue *v, int64_t *out) {
  Num n;
  if (v->n || !tape_is_number(t->tape, v->at[0], &n) || n.den != 1) return 0;
  *out = n.num;
  return 1;
}

/* direct_eval_node.c: value of node `id` from its operands' values; sets f->waits and f->needs where a definition is
 * needed first. */
TextValue text_node(DirectEval *t, Frame *f, AstId id);

/* x op y: AST_ADD, AST_SUB, AST_MUL or AST_DIV of numbers, vectors, rotations. */
TextValue text_pair(DirectEval *t, AstKind op, const TextValue *x, const TextValue *y);
