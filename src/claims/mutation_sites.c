/* Walks each side from its root down and gives every operand its role. Values with an edit come from those of the
 * nodes beside the way up. */
#include "claims/mutation_sites.h"

#include "base/words.h"

static int is_product(AstKind k) { return k == AST_MUL || k == AST_DIV; }
int ast_is_sum(AstKind k) { return k == AST_ADD || k == AST_SUB; }

/* The span s with the parentheses around it, if any (one pair, and not a call's). */
static Span with_parentheses(const Model *m, Span s) {
  Place p = source_place(m->ast->sources, s.begin);
  if (!p.file) return s;
  const char *text = p.file->text;
  uint32_t b = s.begin - p.file->base, e = s.end - p.file->base;
  while (b > 0 && is_space(text[b - 1])) b--;
  while (e < p.file->len && is_space(text[e])) e++;
  if (b == 0 || text[b - 1] != '(' || text[e] != ')') return s;
  return (Span){b - 1 + p.file->base, e + 1 + p.file->base};
}

/* --- values with one node replaced --- */

static AstId root_of(const Expect *x, int side) { return side ? x->rhs_ast : x->lhs_ast; }

static Expr *node_at(const SiteList *l, int side, AstId node) {
  return &l->nodes[side][node - ast_expr(l->m->ast, root_of(l->x, side))->first];
}

Expr edit_node(const SiteList *l, int side, AstId node) { return *node_at(l, side, node); }
Expr edit_side(const SiteList *l, int k) { return *node_at(l, k, root_of(l->x, k)); }

ExprOp edit_function(const AstExpr *x) {
  for (ExprOp op = EX_SIN; op <= EX_CBRT && x->kind == AST_CALL && x->args; op++)
    if (strcmp(x->name, expr_op_text(op)) == 0) return op;
  return EX_NUM;
}

/* Value of an operator or a function whose operands have the values a and b. */
static Expr combined(ExprGraph *g, const AstExpr *x, Expr a, Expr b) {
  if (!a || !b || x->kind != AST_CALL) return operation_value(g, x, a, b);
  return strcmp(x->name, "sqrt") == 0 ? expr_sqrt(g, a) : expr_fn(g, edit_function(x), a);
}

Expr edit_replaced(const SiteList *l, const Site *s, Expr with) {
  AstId root = root_of(l->x, s->side), first = ast_expr(l->m->ast, root)->first, node = s->node;
  while (node != root && with) {
    AstId up = l->up[s->side][node - first];
    const AstExpr *x = ast_expr(l->m->ast, up);
    Expr a = x->a && node != x->a ? *node_at(l, s->side, x->a) : with,
         b = x->b && node != x->b ? *node_at(l, s->side, x->b) : with;
    with = combined(l->m->g, x, a, b);
    node = up;
  }
  return with;
}

/* --- the walk --- */

static void put(SiteList *l, AstId node, const Site *above, SiteRole role, Span op) {
  Span span = ast_expr(l->m->ast, node)->span;
  if (role != SITE_ARGUMENT && role != SITE_PART) span = with_parentheses(l->m, span);
  Site *s = &l->at[l->n++];
  *s = (Site){.node = node,
              .up = above->node, .side = above->side, .role = role, .span = span,
              .with_op = op.end ? span_join(op, span) : span};
  l->up[s->side][node - ast_expr(l->m->ast, root_of(l->x, s->side))->first] = above->node;
}

static void put_operands(SiteList *l, const AstExpr *x, const Site *s) {
  AstKind left = ast_expr(l->m->ast, x->a)->kind;
  SiteRole role = ast_is_sum(x->kind) ? SITE_TERM : x->kind == AST_MUL ? SITE_FACTOR : SITE_DIVISOR;
  int goes_on = ast_is_sum(x->kind) ? ast_is_sum(left) : x->kind == AST_MUL ? is_product(left) : left == AST_DIV;
  put(l, x->b, s, role, x->op_span);
  put(l, x->a, s, goes_on ? SITE_PART : role == SITE_DIVISOR ? SITE_NUMERATOR : role, (Span){0, 0});
}

static void put_below(SiteList *l, const Site *s) {
  const AstExpr *x = ast_expr(l->m->ast, s->node);
  if (ast_is_sum(x->kind) || is_product(x->kind)) put_operands(l, x, s);
  else if (x->kind == AST_NEG) put(l, x->a, s, s->role == SITE_FACTOR ? SITE_FACTOR : SITE_NUMERATOR, (Span){0, 0});
  else if (x->kind == AST_POW) put(l, x->a, s, SITE_BASE, (Span){0, 0});
  else if (x->kind == AST_CALL && (edit_function(x) != EX_NUM || strcmp(x->name, "sqrt") == 0))
    put(l, x->args, s, SITE_ARGUMENT, (Span){0, 0});
}

static void walk_side(SiteList *l, int side) {
  AstId root = root_of(l->x, side), first = ast_expr(l->m->ast, root)->first;
  uint32_t from = l->n;
  l->nodes[side] = ARENA_ARRAY(l->m->arena, Expr, root - first + 1);
  l->up[side] = ARENA_ARRAY(l->m->arena, AstId, root - first + 1);
  memcpy(l->nodes[side], l->x->nodes[side], (root - first + 1) * sizeof(Expr));
  Span span = ast_expr(l->m->ast, root)->span;
  l->at[l->n++] = (Site){.node = root, .side = side, .role = SITE_ROOT, .span = span, .with_op = span};
  for (uint32_t i = from; i < l->n; i++) {
    Site above = l->at[i];
    put_below(l, &above);
  }
  for (uint32_t i = l->n; i-- > from;) {
    Site *s = &l->at[i];
    const AstExpr *x = ast_expr(l->m->ast, s->node);
    int chained = ast_is_sum(x->kind) || is_product(x->kind); /* the resolver gives values to whole chains alone */
    if (chained && !*node_at(l, side, s->node))
      *node_at(l, side, s->node) = combined(l->m->g, x, *node_at(l, side, x->a), *node_at(l, side, x->b));
    s->value = *node_at(l, side, s->node);
  }
}

SiteList mutation_sites_of(const Model *m, const Expect *x) {
  uint32_t left = x->lhs_ast - ast_expr(m->ast, x->lhs_ast)->first + 1;
  uint32_t right = x->rhs_ast - ast_expr(m->ast, x->rhs_ast)->first + 1;
  SiteList l = {.m = m, .x = x, .at = ARENA_ARRAY(m->arena, Site, left + right)};
  for (int side = 0; side < 2; side++) walk_side(&l, side);
  return l;
}
