/* Expressions: each builder appends one node.
 *
 * In: children that were appended before. Out: their parent's id.
 * Must hold: children before parents; exprs.at[id].first is the lowest id below id. */
#include "syntax/ast_build.h"

#include "base/words.h"

Ast *ast_new(Arena *a, Interner *names, Sources *sources, Diags *diags) {
  Ast *ast = ARENA_NEW(a, Ast);
  *ast = (Ast){.arena = a, .names = names, .sources = sources, .diags = diags};
  AstExpr none = {.kind = AST_ERROR};
  vec_push(a, &ast->exprs, none);
  return ast;
}

static AstExpr *at(Ast *ast, AstId id) { return &ast->exprs.at[id]; }

static AstId lower(const Ast *ast, AstId first, AstId child) {
  if (!child) return first;
  AstId below = ast_expr(ast, child)->first;
  return below < first ? below : first;
}

/* Appends a node; its `first` follows from its children (the first of its arguments is lowest). */
static AstId append(Ast *ast, AstExpr e) {
  AstId id = ast->exprs.n;
  e.first = lower(ast, lower(ast, lower(ast, lower(ast, id, e.a), e.b), e.c), e.args);
  vec_push(ast->arena, &ast->exprs, e);
  return id;
}

AstId ast_number(Ast *ast, Span span, Num number) {
  return append(ast, (AstExpr){.kind = AST_NUM, .span = span, .op_span = span, .number = number});
}

AstId ast_string(Ast *ast, AstText text) {
  Name name = intern(ast->names, text.text);
  return append(ast, (AstExpr){.kind = AST_STRING, .span = text.span, .op_span = text.span, .name = name});
}

AstId ast_name(Ast *ast, Ident name) {
  return append(ast, (AstExpr){.kind = AST_NAME, .span = name.span, .op_span = name.span, .name = name.name});
}

void check_declared(Ast *ast, Ident name) {
  int is_t = strcmp(name.name, "t") == 0;
  if (!is_t && strcmp(name.name, "pi") != 0) return;
  diag_error(ast->diags, name.span, "`%s` is %s, and cannot be declared" HELP "choose another name", name.name,
             is_t ? "the time" : "the number pi");
}

AstId ast_declared(Ast *ast, Ident name) {
  check_declared(ast, name);
  return ast_name(ast, name);
}

/* A unit belongs to the whole literal before it: -5 [degC] is minus five degrees, 1/2 [m] half a
 * metre. The parser attached the unit to the last number; here it becomes the parent of the literal. */
static AstId lift_unit(Ast *ast, AstExpr outer, AstId unit_id) {
  AstExpr unit = *at(ast, unit_id);
  AstId id = append(ast, unit); /* the unit, now the parent of the node at its old id */
  AstId number = unit.a;
  if (outer.a == unit_id) outer.a = number;
  if (outer.b == unit_id) outer.b = number;
  outer.span.end = at(ast, number)->span.end;
  outer.first = lower(ast, lower(ast, unit_id, outer.a), outer.b);
  *at(ast, unit_id) = outer;
  AstExpr *top = at(ast, id);
  top->a = unit_id;
  top->first = outer.first;
  top->span.begin = outer.span.begin;
  return id;
}

static int is_number_with_unit(const Ast *ast, AstId id) {
  const AstExpr *e = ast_expr(ast, id);
  return e->kind == AST_UNIT && ast_expr(ast, e->a)->kind == AST_NUM && id + 1 == ast->exprs.n;
}

AstId ast_unary(Ast *ast, AstKind kind, Span span, Span op, AstId a) {
  AstExpr e = {.kind = kind, .span = span, .op_span = op, .a = a};
  if (kind == AST_NEG && is_number_with_unit(ast, a)) return lift_unit(ast, e, a);
  return append(ast, e);
}

/* 1 or -1: numerator of a fraction with a unit. */
static int is_signed_number(const Ast *ast, AstId id) {
  while (ast_expr(ast, id)->kind == AST_NEG) id = ast_expr(ast, id)->a;
  return ast_expr(ast, id)->kind == AST_NUM;
}

AstId ast_binary(Ast *ast, AstKind kind, Span span, Span op, AstId a, AstId b) {
  AstExpr e = {.kind = kind, .span = span, .op_span = op, .a = a, .b = b};
  if (kind == AST_DIV && is_signed_number(ast, a) && is_number_with_unit(ast, b))
    return lift_unit(ast, e, b);
  return append(ast, e);
}

/* Reports an index on anything but a name, a member or an index: `(1, 2)[m]`, `x'[i]`. */
static void check_indexed(Ast *ast, Span span, AstId a) {
  AstKind kind = ast_expr(ast, a)->kind;
  if (kind == AST_PRIME) {
    diag_error(ast->diags, span,
               "the index stands after the prime" HELP
               "write the prime last: `x[i]'`; a unit stands apart: `x' [m/s]`");
  } else if (kind != AST_NAME && kind != AST_MEMBER && kind != AST_INDEX)
    diag_error(ast->diags, span,
               "only a name has an index" HELP "a unit stands apart from the `)` before it: `(a, b) [m]`");
}

AstId ast_index(Ast *ast, Span span, AstId a, AstList indices) {
  check_indexed(ast, span, a);
  return append(ast, (AstExpr){.kind = AST_INDEX, .span = span, .op_span = span, .a = a, .args = indices.first});
}

AstId ast_member(Ast *ast, Span span, AstId a, Ident member) {
  return append(ast, (AstExpr){.kind = AST_MEMBER, .span = span, .op_span = member.span, .a = a, .name = member.name});
}

AstId ast_prime(Ast *ast, Span span, Span op, AstId a) {
  return append(ast, (AstExpr){.kind = AST_PRIME, .span = span, .op_span = op, .a = a});
}

AstId ast_unit(Ast *ast, Span span, AstId a, AstUnit unit) {
  return append(ast, (AstExpr){.kind = AST_UNIT, .span = span, .op_span = unit.span, .a = a, .unit = unit});
}

AstId ast_call(Ast *ast, Span span, Ident function, AstList args) {
  return append(ast, (AstExpr){.kind = AST_CALL, .span = span, .op_span = function.span, .name = function.name,
                               .args = args.first});
}

AstId ast_option(Ast *ast, Span span, const char *word, AstId value) {
  return ast_call(ast, span, (Ident){intern(ast->names, word), span}, ast_list(value));
}

AstId ast_at(Ast *ast, Span span, AstId a, AstId time) {
  return append(ast, (AstExpr){.kind = AST_AT, .span = span, .op_span = span, .a = a, .b = time});
}

AstId ast_reduce(Ast *ast, AstKind kind, Span span, Span op, AstTurns over, AstId body) {
  check_declared(ast, over.index);
  return append(ast, (AstExpr){.kind = kind, .span = span, .op_span = op, .name = over.index.name, .a = over.lo,
                               .b = over.hi, .c = body});
}

AstId ast_copy(Ast *ast, AstId id) {
  AstId from = ast_expr(ast, id)->first, by = ast->exprs.n - from;
  for (AstId k = from; k <= id; k++) {
    AstExpr e = *ast_expr(ast, k);
    AstId *const links[] = {&e.a, &e.b, &e.c, &e.args, &e.next, &e.first};
    for (size_t i = 0; i < sizeof links / sizeof *links; i++)
      if (*links[i]) *links[i] += by;
    if (k == id) e.next = 0;
    vec_push(ast->arena, &ast->exprs, e);
  }
  return id + by;
}

AstId ast_collect(Ast *ast, AstKind kind, Span span, AstList items) {
  return append(ast, (AstExpr){.kind = kind, .span = span, .op_span = span, .args = items.first});
}

AstId ast_tuple(Ast *ast, Span span, AstId head, AstList rest) {
  at(ast, head)->next = rest.first;
  return ast_collect(ast, AST_TUPLE, span, (AstList){head, rest.last});
}

/* The gap of a contact: g >= 0 is kept as g, a >= b as a - b. */
AstId ast_contact_gap(Ast *ast, Span span, Span op, AstId gap, AstId least) {
  const AstExpr *e = ast_expr(ast, least);
  int zero = e->kind == AST_NUM && num_is_zero(e->number);
  return zero ? gap : ast_binary(ast, AST_SUB, span, op, gap, least);
}

AstId ast_bind(Ast *ast, Span span, Ident index, AstId lo, AstId hi) {
  check_declared(ast, index);
  return append(ast, (AstExpr){.kind = AST_BIND, .span = span, .op_span = index.span, .name = index.name, .a = lo,
                               .b = hi});
}

AstList ast_list(AstId item) { return (AstList){item, item}; }

AstList ast_list_add(Ast *ast, AstList list, AstId item) {
  at(ast, list.last)->next = item;
  return (AstList){list.first, item};
}

/* 10..20 of max(x, 10..20): a range without a name; 0: an end that is left out. */
AstId ast_window(Ast *ast, Span span, AstId lo, AstId hi) {
  Name none = intern(ast->names, "");
  return append(ast, (AstExpr){.kind = AST_BIND, .span = span, .op_span = span, .name = none, .a = lo, .b = hi});
}

AstList ast_list_before(Ast *ast, AstId item, AstList list) {
  at(ast, item)->next = list.first;
  return (AstList){item, list.last};
}

AstId ast_happening(Ast *ast, Span span, Ident contact, Ident does) {
  if (!has_word("opens sticks slips", does.name)) {
    diag_error(ast->diags, does.span,
               "expected an operator, `)` or `,` after `%s`, found `%s`" HELP "a product is written with `*`",
               contact.name, does.name);
    return append(ast, (AstExpr){.kind = AST_ERROR, .span = span});
  }
  return append(ast, (AstExpr){.kind = AST_NAME,
                               .span = span,
                               .op_span = span,
                               .name = intern(ast->names, arena_printf(ast->arena, "%s %s", contact.name, does.name))});
}
