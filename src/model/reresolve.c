#include "model/builder.h"

/* What a node turned into something else would have the user told is of no interest. */
Expr model_reresolve(const Model *m, const Expect *x, AstId root, AstId node, Expr with) {
  Builder *b = m->builder;
  if (x->elsewhere) return 0;
  Diags *heard = b->diags;
  b->diags = diags_new(b->arena, b->ast->sources);
  b->stand_in = node;
  b->stands_for = with;
  Value v = resolve(b, root, IN_OBSERVE, x->effect);
  Expr e = b->diags->errors ? 0 : v.e;
  b->diags = heard;
  b->stand_in = 0;
  return e;
}
