/* Function calls: the built-in functions, if, d(expr, name), and the user's own. */
#include "base/suggest.h"
#include "model/resolve_impl.h"
#include "sym/diff.h"

static uint32_t list_length(const Builder *b, AstId first) {
  uint32_t n = 0;
  for (AstId i = first; i; i = ast_expr(b->ast, i)->next) n++;
  return n;
}

static const struct {
  const char *name;
  ExprOp op;
} unary_functions[] = {
  {"sin", EX_SIN}, {"cos", EX_COS}, {"tan", EX_TAN}, {"asin", EX_ASIN}, {"acos", EX_ACOS}, {"atan", EX_ATAN},
  {"sinh", EX_SINH}, {"cosh", EX_COSH}, {"tanh", EX_TANH}, {"exp", EX_EXP}, {"log", EX_LOG}, {"cbrt", EX_CBRT},
  {"abs", EX_ABS}, {"sign", EX_SIGN},
}, binary_functions[] = {{"atan2", EX_ATAN2}, {"hypot", EX_HYPOT}, {"min", EX_MIN}, {"max", EX_MAX}};

static const char *const other_functions[] = {"sqrt", "pow", "if", "d", "dot", "cross", "norm", "omega", "lambda"};

static int arity_is(Eval *ev, const AstExpr *x, uint32_t want) {
  uint32_t n = list_length(ev->b, x->args);
  if (n == want) return 1;
  diag_error(ev->b->diags, x->span, "`%s` takes %u argument%s, here it has %u", x->name, want, want == 1 ? "" : "s", n);
  return 0;
}

static Value call_unary(Eval *ev, const AstExpr *x, ExprOp op) {
  Builder *b = ev->b;
  if (!arity_is(ev, x, 1)) return FAILED;
  const Value *v = value_of(ev, x->args);
  if (!v->e) return FAILED;
  if (op == EX_ABS) return (Value){expr_fn(b->g, op, v->e), v->dim, v->bare};
  if (op == EX_SIGN) return (Value){expr_fn(b->g, op, v->e), DIM_NONE, v->bare};
  if (op == EX_CBRT) return (Value){expr_fn(b->g, op, v->e), dim_pow(v->dim, num_ratio(1, 3)), v->bare};
  const char *what = arena_printf(b->arena, "`%s`", x->name);
  if (!need_pure(ev, x->args, what)) return FAILED;
  return (Value){expr_fn(b->g, op, v->e), DIM_NONE, v->bare};
}

static Value call_binary(Eval *ev, const AstExpr *x, ExprOp op) {
  Builder *b = ev->b;
  if (!arity_is(ev, x, 2)) return FAILED;
  AstId second = ast_expr(b->ast, x->args)->next;
  const Value *v = value_of(ev, x->args), *w = value_of(ev, second);
  if (!v->e || !w->e) return FAILED;
  if (!dims_agree(b, v, w)) {
    report_mismatch(ev, x->span, "combine", x->args, second);
    return FAILED;
  }
  Dim dim = v->dim.known ? v->dim : w->dim;
  return (Value){expr_fn2(b->g, op, v->e, w->e), op == EX_ATAN2 ? DIM_NONE : dim, v->bare && w->bare};
}

static Value call_if(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  if (!arity_is(ev, x, 3)) return FAILED;
  AstId yes = ast_expr(b->ast, x->args)->next, no = ast_expr(b->ast, yes)->next;
  const Value *c = value_of(ev, x->args), *v = value_of(ev, yes), *w = value_of(ev, no);
  if (!c->e || !v->e || !w->e) return FAILED;
  if (!expr_is_bool(b->g, c->e) && !expr_is_num(b->g, c->e)) {
    diag_error(b->diags, ast_expr(b->ast, x->args)->span, "`if` takes a condition first, such as `x > 0`");
    return FAILED;
  }
  if (!dims_agree(b, v, w)) {
    report_mismatch(ev, x->span, "choose between", yes, no);
    return FAILED;
  }
  return (Value){expr_select(b->g, c->e, v->e, w->e), v->dim.known ? v->dim : w->dim, 0};
}

/* d(expr, name): a partial derivative. */
static Value call_d(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  if (!arity_is(ev, x, 2)) return FAILED;
  AstId by = ast_expr(b->ast, x->args)->next;
  const Value *v = value_of(ev, x->args), *w = value_of(ev, by);
  if (!v->e || !w->e) return FAILED;
  if (expr_op(b->g, w->e) != EX_SYM) {
    diag_error(b->diags, ast_expr(b->ast, by)->span, "`d(expr, name)` differentiates by a coordinate, a velocity, a parameter or t");
    return FAILED;
  }
  return (Value){expr_diff(b->g, v->e, expr_sym_id(b->g, w->e)), dim_div(v->dim, w->dim), 0};
}

static Value call_function(Eval *ev, const AstExpr *x, const Definition *f) {
  Builder *b = ev->b;
  if (!arity_is(ev, x, f->nargs) || !f->value) return FAILED;
  Expr *with = ARENA_ARRAY(b->arena, Expr, expr_symbol_count(b->g) + 1);
  AstId arg = x->args;
  for (uint32_t i = 0; i < f->nargs; i++, arg = ast_expr(b->ast, arg)->next) {
    if (!value_of(ev, arg)->e) return FAILED;
    with[f->args[i]] = value_of(ev, arg)->e;
  }
  Expr e = expr_substitute(b->g, f->value, with, expr_symbol_count(b->g) + 1, "");
  return (Value){e, f->nargs ? DIM_UNKNOWN : f->dim, 0};
}

static Value call_sqrt(Eval *ev, const AstExpr *x) {
  if (!arity_is(ev, x, 1) || !value_of(ev, x->args)->e) return FAILED;
  const Value *v = value_of(ev, x->args);
  return (Value){expr_sqrt(ev->b->g, v->e), dim_pow(v->dim, num_ratio(1, 2)), v->bare};
}

static Value unknown_function(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  enum { NU = sizeof unary_functions / sizeof *unary_functions, NB = 4, NO = sizeof other_functions / sizeof *other_functions };
  Name *known = ARENA_ARRAY(b->arena, Name, NU + NB + NO + b->scope.all.n);
  uint32_t n = 0;
  for (int i = 0; i < NU; i++) known[n++] = unary_functions[i].name;
  for (int i = 0; i < NB; i++) known[n++] = binary_functions[i].name;
  for (int i = 0; i < NO; i++) {
    if (strcmp(x->name, other_functions[i]) == 0) {
      not_yet(b, x->span, arena_printf(b->arena, "`%s`", x->name));
      return FAILED;
    }
    known[n++] = other_functions[i];
  }
  for (uint32_t i = 0; i < b->scope.all.n; i++)
    if (b->scope.all.at[i].kind == ENT_FUNCTION) known[n++] = b->scope.all.at[i].name;
  int ambiguous;
  const Entity *e = scope_find(&b->scope, x->name, ev->effect, &ambiguous);
  diag_error(b->diags, x->op_span.end ? x->op_span : x->span, "unknown function `%s`", x->name);
  Name near = suggest(x->name, known, n);
  if (e) diag_help(b->diags, "`%s` is a %s; for a product write `%s*(...)`", x->name, ent_kind_text(e->kind), x->name);
  else if (near) diag_help(b->diags, "did you mean `%s`?", near);
  return FAILED;
}

Value call_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  int ambiguous;
  const Entity *e = scope_find(&b->scope, x->name, ev->effect, &ambiguous);
  if (e && e->kind == ENT_FUNCTION) return call_function(ev, x, &b->functions.at[e->index]);
  for (size_t i = 0; i < sizeof unary_functions / sizeof *unary_functions; i++)
    if (strcmp(x->name, unary_functions[i].name) == 0) return call_unary(ev, x, unary_functions[i].op);
  for (size_t i = 0; i < sizeof binary_functions / sizeof *binary_functions; i++)
    if (strcmp(x->name, binary_functions[i].name) == 0) return call_binary(ev, x, binary_functions[i].op);
  if (strcmp(x->name, "sqrt") == 0) return call_sqrt(ev, x);
  if (strcmp(x->name, "if") == 0) return call_if(ev, x);
  if (strcmp(x->name, "d") == 0) return call_d(ev, x);
  if (strcmp(x->name, "pow") == 0)
    return arity_is(ev, x, 2) ? power_value(ev, x, x->args, ast_expr(b->ast, x->args)->next) : FAILED;
  return unknown_function(ev, x);
}
