/* Shapes of expressions: which of them read alike but for their indices, without writing them. */
#pragma once

#include "sym/expr.h"

/* Numbers that together determine the text of expressions: a hash of all that has to be equal, and, in order, the
 * indices of names and of quantified sums. Expressions of one structure whose indices differ by the same steps have
 * texts that differ by these steps. */
typedef struct {
  uint64_t structure;
  VEC(int64_t) index;
  uint32_t parts; /* so far; past SHAPE_PARTS_MOST the shape says nothing */
} ExprShape;

enum { SHAPE_PARTS_MOST = 500 };

/* Adds to a shape what the text of e depends on; definitions count by their names. */
void expr_shape_add(ExprGraph *g, Arena *a, Expr e, ExprShape *to);
void expr_shape_add_name(Arena *a, const char *name, ExprShape *to);
void expr_shape_add_number(ExprShape *to, uint64_t x);

static inline int expr_shape_is_known(const ExprShape *s) { return s->parts < SHAPE_PARTS_MOST; }
