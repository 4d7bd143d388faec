/* One evaluation of an expression of the text, shared by text*.c. */
#ifndef LAGC_TEXT_IMPL_H
#define LAGC_TEXT_IMPL_H

#include "jets/text.h"

/* A sum or a product whose body is being evaluated, once for each value of its index. */
typedef struct {
  AstId construct;
  int64_t at, hi;
  Meaning sum; /* of so many terms so far */
  uint64_t terms;
} TextLoop;

/* A definition, by its place in the builder; ENT_NONE: nobody's. */
typedef struct {
  EntKind kind;
  uint32_t index;
} Awaited;

enum { FRAMES_MAX = 50000 }; /* definitions that wait for each other */

typedef struct Frame {
  AstId first, root, pc;
  Name effect;
  Awaited what, needs;        /* is being defined; must be evaluated before node pc */
  int waits, returned;        /* for `needs`; its value is in `result` */
  Meaning result;
  const Definition *function; /* whose arguments are in scope, or NULL */
  Meaning *args;
  uint32_t nargs;
  IndexVars index;
  VEC(TextLoop) loops;
  uint32_t cap;
  Meaning *value; /* of node first + i */
  AstId *guard;   /* the sum, product or `if` whose body or branch begins at node first + i, or 0 */
} Frame;

/* text_node.c: the value of node `id`, whose operands have theirs; sets f->waits and f->needs where a definition is needed first. */
Meaning text_node(Text *t, Frame *f, AstId id);

/* x op y: AST_ADD, AST_SUB, AST_MUL or AST_DIV of numbers, vectors, rotations. */
Meaning text_pair(Text *t, AstKind op, const Meaning *x, const Meaning *y);

#endif
