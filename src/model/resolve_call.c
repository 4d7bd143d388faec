/* Function calls: built-in functions of numbers and vectors, if, d(expr, name); others are dispatched to
 * resolve_function.c (user functions), rotation.c, constraint.c (lambda) and resolve_exact.c. */
#include "base/words.h"
#include "model/resolve_impl.h"
#include "sym/diff.h"

static Value call_unary(Eval *ev, const AstExpr *x, ExprOp op) {
  Builder *b = ev->b;
  const Value *v = value_of(ev, x->args);
  if (!v->e) return FAILED;
  if (op == EX_ABS) return a_value(expr_fn(b->g, op, v->e), v->dim, v->bare);
  if (op == EX_SIGN) return a_value(record_jump(ev, x, expr_fn(b->g, op, v->e)), DIM_NONE, v->bare);
  if (op == EX_CBRT) return a_value(expr_fn(b->g, op, v->e), dim_pow(b->dims, v->dim, num_ratio(1, 3)), v->bare);
  const char *what = arena_printf(b->arena, "`%s`", x->name);
  if (!need_pure(ev, x->args, what)) return FAILED;
  return a_value(record_jump(ev, x, expr_fn(b->g, op, v->e)), DIM_NONE, v->bare);
}

static Value call_binary(Eval *ev, const AstExpr *x, ExprOp op) {
  Builder *b = ev->b;
  AstId second = ast_expr(b->ast, x->args)->next;
  const Value *v = value_of(ev, x->args), *w = value_of(ev, second);
  if (!v->e || !w->e) return FAILED;
  if (!operands_agree(ev, x->span, x->args, second)) return FAILED;
  Dim dim = v->dim != DIM_ANY ? v->dim : w->dim;
  return a_value(record_jump(ev, x, expr_fn2(b->g, op, v->e, w->e)), op == EX_ATAN2 ? DIM_NONE : dim,
                 v->bare && w->bare);
}

/* With a constant condition the other branch was not evaluated (see enter in resolve.c). */
static Value call_if(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  AstId yes = ast_expr(b->ast, x->args)->next, no = ast_expr(b->ast, yes)->next;
  const Value *c = value_of(ev, x->args), *v = value_of(ev, yes), *w = value_of(ev, no);
  if (!c->e) return FAILED;
  if (!c->condition)
    return refuse(b, ast_expr(b->ast, x->args)->span,
                  "`%s` is not a condition" HELP "`if(condition, a, b)` takes a condition first, such as `x > 0`",
                  ast_short(b, x->args));
  if (expr_is_num(b->g, c->e)) return expr_is_zero(b->g, c->e) ? *w : *v;
  if (!v->e || !w->e || !same_shape(ev, x->span, yes, no)) return FAILED;
  if (!operands_agree(ev, x->span, yes, no)) return FAILED;
  Value r = {.dim = v->dim != DIM_ANY ? v->dim : w->dim, .n = v->n};
  for (uint32_t k = 0; k < component_count(v); k++) r.at[k] = expr_select(b->g, c->e, v->at[k], w->at[k]);
  return r;
}

/* --- vectors --- */

/* The arguments of dot and cross; 0, reported, unless they are two vectors of one shape. */
static int two_vectors(Eval *ev, const AstExpr *x, const Value **v, const Value **w) {
  Builder *b = ev->b;
  AstId second = ast_expr(b->ast, x->args)->next;
  *v = value_of(ev, x->args);
  *w = value_of(ev, second);
  if (!(*v)->e || !(*w)->e || !same_shape(ev, x->span, x->args, second)) return 0;
  if ((*v)->n == ROTATION) {
    refuse_rotation(b, ast_expr(b->ast, x->args)->span, ast_short(b, x->args), TURN_NUMBER);
    return 0;
  }
  if ((*v)->n) return 1;
  return diag_error(b->diags, x->span, "`%s` takes vectors, and these are numbers", x->name);
}

static Expr dot(ExprGraph *g, const Value *v, const Value *w) {
  Expr part[3];
  for (uint32_t k = 0; k < v->n; k++) part[k] = expr_mul(g, v->at[k], w->at[k]);
  return expr_add_n(g, part, v->n);
}

static Value call_dot(Eval *ev, const AstExpr *x) {
  const Value *v, *w;
  if (!two_vectors(ev, x, &v, &w)) return FAILED;
  return a_value(dot(ev->b->g, v, w), dim_mul(ev->b->dims, v->dim, w->dim), v->bare && w->bare);
}

/* Cross product; a number for plane vectors. */
static Value call_cross(Eval *ev, const AstExpr *x) {
  ExprGraph *g = ev->b->g;
  const Value *v, *w;
  if (!two_vectors(ev, x, &v, &w)) return FAILED;
  Value r = {.dim = dim_mul(ev->b->dims, v->dim, w->dim), .bare = v->bare && w->bare};
  if (v->n == 2) {
    r.e = cross_component(g, v->at, w->at, 2);
    return r;
  }
  r.n = 3;
  for (int k = 0; k < 3; k++) r.at[k] = cross_component(g, v->at, w->at, k);
  return r;
}

static Value call_norm(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const Value *v = value_of(ev, x->args);
  if (!v->e) return FAILED;
  if (v->n == ROTATION) return refuse_rotation(b, ast_expr(b->ast, x->args)->span, ast_short(b, x->args), TURN_NUMBER);
  if (!v->n)
    return refuse(b, x->span, "`norm` takes a vector, and `%s` is a number" HELP "`abs(x)` is the size of a number",
                  ast_short(b, x->args));
  Expr square = dot(b->g, v, v);
  return a_value(expr_sqrt(b->g, square), v->dim, v->bare);
}

static int is_local(const Symbol *s, const void *data) {
  (void)data;
  return s->kind == SYM_LOCAL;
}

/* Warns of d(x, t) = 0, where x' may have been meant. */
static void warn_no_rate(Eval *ev, const AstExpr *x, const Value *derivative) {
  Builder *b = ev->b;
  const AstExpr *of = ast_expr(b->ast, x->args), *by = ast_expr(b->ast, of->next);
  if (by->kind != AST_NAME || strcmp(by->name, "t") != 0 || expr_is_num(b->g, value_of(ev, x->args)->e)) return;
  for (uint32_t k = 0; k < component_count(derivative); k++)
    if (!expr_is_zero(b->g, derivative->at[k])) return;
  diag_warning(b->diags, x->span, "this is 0: `d` is the partial derivative, and `%s` does not contain t itself",
               ast_short(b, x->args));
  diag_help(b->diags, of->kind == AST_NAME ? "its rate is written `%s'`" : "its rate is written `(%s)'`",
            ast_short(b, x->args));
}

/* d(expr, name): a partial derivative. */
static Value call_d(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  AstId by = ast_expr(b->ast, x->args)->next;
  const Value *v = value_of(ev, x->args), *w = value_of(ev, by);
  if (!v->e || !w->e) return FAILED;
  if (v->n == ROTATION) return refuse_rotation(b, ast_expr(b->ast, x->args)->span, ast_short(b, x->args), TURN_NUMBER);
  if (w->n)
    return refuse(b, ast_expr(b->ast, by)->span, "`%s` is %s: differentiate by its components", ast_short(b, by),
                  shape_text(b, w->n));
  SymKind kind = expr_op(b->g, w->e) == EX_SYM ? expr_sym_of(b->g, w->e)->kind : SYM_CONST;
  if (kind == SYM_CONST || w->e == expr_symbol(b->g, b->m->energy_sym)->node)
    return refuse(b, ast_expr(b->ast, by)->span,
                  "`d(expr, name)` differentiates by a coordinate, a velocity, a parameter or t");
  Value r = {.dim = dim_div(b->dims, v->dim, w->dim), .n = v->n};
  for (uint32_t k = 0; k < component_count(v); k++) {
    if (kind != SYM_LOCAL && expr_contains(b->g, v->at[k], is_local, NULL))
      return refuse(b, x->span,
                    "a partial derivative of the energy, or of the arguments of a function, is not supported" HELP
                    "differentiate `T` and `V`, or `lagrangian`; of a function, its value: `d(f(x), x)`");
    r.at[k] = expr_diff(b->g, v->at[k], expr_sym_id(b->g, w->e));
  }
  warn_no_rate(ev, x, &r);
  return r;
}

static Value call_sqrt(Eval *ev, const AstExpr *x) {
  const Value *v = value_of(ev, x->args);
  if (!v->e) return FAILED;
  return a_value(expr_sqrt(ev->b->g, v->e), dim_pow(ev->b->dims, v->dim, num_ratio(1, 2)), v->bare);
}

static Value call_pow(Eval *ev, const AstExpr *x) {
  return power_value(ev, x, x->args, ast_expr(ev->b->ast, x->args)->next);
}

static const struct {
  const char *name;
  Value (*value)(Eval *ev, const AstExpr *x); /* NULL: the operation `op` of its numbers */
  ExprOp op;
  uint32_t arguments;
  int takes_vectors; /* vectors or rotations */
} functions[] = {
#define ROW(OP, name, ...) {#name, NULL, EX_##OP, 1, 0},
    FUNCTIONS(ROW){"abs", NULL, EX_ABS, 1, 0}, {"sign", NULL, EX_SIGN, 1, 0}, {"floor", NULL, EX_FLOOR, 1, 0},
    {"atan2", NULL, EX_ATAN2, 2, 0}, {"hypot", NULL, EX_HYPOT, 2, 0}, {"min", NULL, EX_MIN, 2, 0},
    {"max", NULL, EX_MAX, 2, 0}, {"sqrt", call_sqrt, 0, 1, 0}, {"pow", call_pow, 0, 2, 0}, {"if", call_if, 0, 3, 1},
    {"d", call_d, 0, 2, 1}, {"dot", call_dot, 0, 2, 1}, {"cross", call_cross, 0, 2, 1}, {"norm", call_norm, 0, 1, 1},
    {"lambda", multiplier_value, 0, 1, 1}, {"omega", omega_value, 0, 1, 1}, {"turn", turn_value, 0, 2, 1},
    {"transpose", transpose_value, 0, 1, 1}, {"action", action_value, 0, 1, 1},
};

enum { BUILT_IN = sizeof functions / sizeof *functions };

const char *function_name(size_t i) {
#define NAME(name, arguments, text) #name,
  static const char *const composed[] = {COMPOSED(NAME) NULL};
  return i < BUILT_IN ? functions[i].name : composed[i - BUILT_IN];
}

int function_index(const char *name) {
  for (size_t i = 0; i < BUILT_IN; i++)
    if (strcmp(name, functions[i].name) == 0) return (int)i;
  return -1;
}

int call_takes_vectors(const Eval *ev, const AstExpr *x) {
  int i = function_index(x->name);
  return (i >= 0 && functions[i].takes_vectors) || strcmp(x->name, "exact") == 0 || strcmp(x->name, "error") == 0 ||
         own_function(ev, x);
}

/* The coordinate, state or let in `th(0)`, which the parser takes for a call; or NULL. */
static const Entity *called_motion(const Eval *ev, const AstExpr *x) {
  const Entity *e = scope_find(&ev->b->scope, x->name, ev->effect, NULL);
  int moves = e && (e->kind == ENT_COORD || e->kind == ENT_STATE || e->kind == ENT_LET);
  return moves && ast_list_length(ev->b->ast, x->args) == 1 ? e : NULL;
}

/* 1 for `F(t)`, the notation of paper for time-dependent quantities. */
static int is_of_time(const Eval *ev, const AstExpr *x) {
  const AstExpr *argument = x->args ? ast_expr(ev->b->ast, x->args) : NULL;
  return argument && argument->kind == AST_NAME && strcmp(argument->name, "t") == 0 &&
         ast_list_length(ev->b->ast, x->args) == 1;
}

static Value unknown_function(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  static const char *const of_runs[] = {"max", "min", "mean", "rms", "drift", "period", "hit", "count"};
  enum { OF_RUNS = sizeof of_runs / sizeof *of_runs };
  uint32_t n = 0;
  while (function_name(n)) n++;
  Name *known = ARENA_ARRAY(b->arena, Name, n + b->scope.all.n + OF_RUNS);
  for (uint32_t i = 0; i < n; i++) known[i] = function_name(i);
  for (uint32_t i = 0; i < OF_RUNS && b->is_measuring; i++) known[n++] = of_runs[i];
  for (uint32_t i = 0; i < b->scope.all.n; i++)
    if (b->scope.all.at[i].kind == ENT_FUNCTION) known[n++] = b->scope.all.at[i].name;
  const Entity *e = scope_find(&b->scope, x->name, ev->effect, NULL);
  if (called_motion(ev, x) && ast_expr(b->ast, x->args)->kind == AST_NUM &&
      num_is_zero(ast_expr(b->ast, x->args)->number)) {
    report_start(b, x->span);
    return FAILED;
  }
  diag_error(b->diags, x->op_span.end ? x->op_span : x->span, "unknown function `%s`", x->name);
  Name near = suggest(x->name, known, n);
  const char *argument = x->args ? ast_text(b, x->args) : "";
  if (!e && advise_unknown_function(b, x->name)) return FAILED;
  if (strcmp(x->name, "exact") == 0 || strcmp(x->name, "error") == 0)
    diag_help(b->diags, "`%s(q)` may stand in `output` and `monitor`, in a scene that says `exact q = ...`", x->name);
  else if (e && is_of_time(ev, x))
    diag_help(b->diags, "`%s` is %s: write `%s`; its dependence on time is implied", x->name, ent_kind_text(e->kind),
              x->name);
  else if (e && argument[0] == 't' && argument[1] && strchr(" -+", argument[1]))
    diag_help(b->diags,
              "a delay does not exist: equations hold the state of one moment; a lag of first order is a state, `flow "
              "z' = (%s - z)/T`",
              x->name);
  else if (e)
    diag_help(b->diags, "`%s` is %s; for a product write `%s*(...)`", x->name, ent_kind_text(e->kind), x->name);
  else if (near) diag_help(b->diags, "did you mean `%s`?", near);
  else if (b->is_measuring)
    diag_help(b->diags, "of a run there are max, min, mean, rms, drift, period, hit, count and, without parentheses, "
              "end, lyapunov and megno");
  else diag_help(b->diags, "`lagc help functions` lists them; declare your own: `function %s(x) = ...`", x->name);
  return FAILED;
}

Value call_value(Eval *ev, const AstExpr *x) {
  const Entity *own = own_function(ev, x);
  if (own) return call_function(ev, x, own);
  const Entity *moves = ev->where == IN_EXACT ? called_motion(ev, x) : NULL;
  if (moves) {
    Value v = whole_value(ev, moves, x->op_span);
    return ev->waiting ? FAILED : start_value(ev, v, x->span, value_of(ev, x->args));
  }
  if (call_is_exact(ev, x->name)) return exact_value(ev, x);
  int i = function_index(x->name);
  if (i < 0) return unknown_function(ev, x);
  if (!arity_is(ev, x, functions[i].arguments)) return FAILED;
  if (functions[i].value) return functions[i].value(ev, x);
  return (functions[i].arguments == 2 ? call_binary : call_unary)(ev, x, functions[i].op);
}
