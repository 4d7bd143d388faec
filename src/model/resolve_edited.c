/* Resolves an expression of an expectation again with one node replaced: the trial edits of corrections. Contract: model.h. */
#include "model/builder.h"

/* Messages about the edited expression are dropped. */
Expr model_resolve_edited(const Model *m, const Expect *x, AstId root, AstId node, Expr with) {
  Builder *b = m->builder;
  if (x->is_repeated) return 0;
  Diags *heard = b->diags;
  b->diags = diags_new(b->arena, b->ast->sources);
  b->replaced_node = node;
  b->replacement_expr = with;
  Value v = resolve(b, root, IN_OBSERVE, x->effect);
  Expr e = b->diags->errors ? 0 : v.e;
  b->diags = heard;
  b->replaced_node = 0;
  return e;
}
