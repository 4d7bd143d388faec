/* One evaluation of an expression, shared by resolve.c and resolve_call.c only. */
#ifndef LAGC_RESOLVE_IMPL_H
#define LAGC_RESOLVE_IMPL_H

#include "model/builder.h"

typedef struct {
  Builder *b;
  Context where;
  Name effect;
  const Definition *function; /* whose arguments are in scope, or NULL */
  AstId first;
  Value *value;       /* of node first + i */
  unsigned char *open; /* node first + i is the left part of a longer chain: its parent gathers it */
} Eval;

static const Value FAILED = {0};

/* The value of something that is a number, not a condition. */
static inline Value a_value(Expr e, Dim dim, int bare) { return (Value){e, dim, bare, 0}; }

static inline Value *value_of(const Eval *ev, AstId id) { return &ev->value[id - ev->first]; }

/* Dimensions: whether two values may be added, the message when they may not, and a demand for a
 * pure number (an angle is one); `what` asks for it. */
int dims_agree(const Builder *b, const Value *x, const Value *y);
void report_mismatch(Eval *ev, Span span, AstId x, AstId y);
int need_pure(Eval *ev, AstId arg, const char *what);

/* base ^ exponent, written as node x. */
Value power_value(Eval *ev, const AstExpr *x, AstId base_id, AstId exp_id);

/* Whether the language has a function that this version gives no meaning to. */
int call_is_not_yet(Name name);

/* The value of an AST_CALL. */
Value call_value(Eval *ev, const AstExpr *x);

#endif
