/* Calls of user functions, and of functions that functions.def defines by a text. A body is evaluated once per
 * choice of argument shapes, with local symbols and unknown dimensions as arguments (an Instance); a call
 * substitutes its arguments, and checks their dimensions against those inferred from the body. */
#include "model/resolve_impl.h"
#include "syntax/parse.h"

const Value *function_argument(const Builder *b, const Instance *function, Name name) {
  if (!function) return NULL;
  AstId id = b->functions.at[function->function].stmt->args;
  for (uint32_t i = 0; i < function->nargs; i++, id = ast_expr(b->ast, id)->next)
    if (ast_expr(b->ast, id)->name == name) return &function->args[i];
  return NULL;
}

/* Declares the symbols of an argument, one per component. */
static Value new_argument(Builder *b, Instance *in, Name name, uint32_t shape) {
  Value v = {.n = shape, .dim = b->unitless ? DIM_ANY : dim_unknown(b->dims, name)};
  for (uint32_t k = 0; k < component_count(&v); k++) {
    Name part = shape ? intern_printf(b, "%s.%c", name, component_letter(shape, k)) : name;
    SymId s = declare_symbol(b, SYM_LOCAL, in->symbols.n, part, SIGN_UNKNOWN, v.dim);
    vec_push(b->arena, &in->symbols, s);
    v.at[k] = expr_symbol(b->g, s)->node;
  }
  return v;
}

void need_rates(Builder *b, Instance *in) {
  uint32_t n = in->nplain;
  for (uint32_t i = 0; in->symbols.n < 3 * n; i++) {
    const Symbol *of = expr_symbol(b->g, in->symbols.at[i]);
    Dim rate = dim_per_second(b->dims, b->dim_of.at[in->symbols.at[i]]);
    SymId s = declare_symbol(b, SYM_LOCAL, in->symbols.n, intern_printf(b, "%s'", of->name), SIGN_UNKNOWN, rate);
    vec_push(b->arena, &in->symbols, s);
  }
}

/* Appends an instance of a function for argument shapes 0 (number), 2, 3 or ROTATION, without evaluating it. */
static Instance *new_instance(Builder *b, uint32_t function, const uint32_t *shapes) {
  const Definition *f = &b->functions.at[function];
  Instance *in = ARENA_NEW(b->arena, Instance);
  *in = (Instance){
      .function = function, .nargs = ast_list_length(b->ast, f->stmt->args), .first_unknown = dim_unknowns(b->dims)};
  in->args = ARENA_ARRAY(b->arena, Value, in->nargs + 1);
  AstId id = f->stmt->args;
  for (uint32_t i = 0; i < in->nargs; i++, id = ast_expr(b->ast, id)->next)
    in->args[i] = new_argument(b, in, ast_expr(b->ast, id)->name, shapes[i]);
  in->nplain = in->symbols.n;
  vec_push(b->arena, &b->instances, in);
  return in;
}

/* Index of the instance for these shapes; appends one if there is none. */
static uint32_t find_instance(Builder *b, uint32_t function, uint32_t nargs, const uint32_t *shapes, Span call) {
  for (uint32_t k = 0; k < b->instances.n; k++) {
    const Instance *in = b->instances.at[k];
    uint32_t i = 0;
    while (in->function == function && i < nargs && in->args[i].n == shapes[i]) i++;
    if (in->function == function && i == nargs) return k;
  }
  new_instance(b, function, shapes)->call = call;
  return b->instances.n - 1;
}

void finish_instance(Builder *b, Instance *in, Value v) {
  in->value = v;
  in->done = 1;
  const Diag *last = b->diags->errors > in->errors ? &b->diags->list.at[b->diags->latest] : NULL;
  if (!v.e && in->call.end && last && !last->note) diag_also(b->diags, in->call, "in this call");
}

static void report_argument(Eval *ev, const AstExpr *x, const Instance *in, uint32_t i, AstId arg, Dim want) {
  Builder *b = ev->b;
  const Value *v = value_of(ev, arg);
  AstId id = b->functions.at[in->function].stmt->args;
  for (uint32_t k = 0; k < i; k++) id = ast_expr(b->ast, id)->next;
  const char *unit = dim_text(b->dims, want), *text = ast_short(b, arg);
  diag_error(b->diags, ast_expr(b->ast, arg)->span, "units do not match: the argument `%s` of `%s` is %s here, `%s` %s",
             ast_expr(b->ast, id)->name, x->name, in_unit(b, unit), text,
             v->bare ? "has no unit" : in_unit(b, shown_unit(b, v)));
  if (v->bare) diag_help(b->diags, "give the number its unit: `%s [%s]`", text, unit);
  DimCause c;
  if (dim_cause(b->dims, in->args[i].dim, &c)) diag_also(b->diags, c.why, "because of this");
}

/* with[i] := dimension of argument i; 0, reported, where the body requires another one. */
static int bind_dims(Eval *ev, const AstExpr *x, const Instance *in, Dim *with) {
  Builder *b = ev->b;
  AstId arg = x->args;
  for (uint32_t i = 0; i < in->nargs; i++, arg = ast_expr(b->ast, arg)->next)
    with[i] = is_zero(b, value_of(ev, arg)) ? DIM_ANY : value_of(ev, arg)->dim;
  arg = x->args;
  for (uint32_t i = 0; i < in->nargs && !b->unitless; i++, arg = ast_expr(b->ast, arg)->next) {
    Dim own = in->args[i].dim, found = dim_resolved(b->dims, own);
    if (found == own) continue; /* the body does not determine it */
    Dim want = dim_replace(b->dims, found, in->first_unknown, in->nargs, with);
    if (dim_equate(b->dims, with[i], want, ast_expr(b->ast, arg)->span)) continue;
    report_argument(ev, x, in, i, arg, want);
    return 0;
  }
  return 1;
}

/* Highest time derivative in which the body contains symbols first .. n - 1: 0, 1 or 2. */
static uint32_t order_of(const Builder *b, const Instance *in, uint32_t first, uint32_t n) {
  uint32_t order = 0;
  for (uint32_t i = in->nplain; i < in->symbols.n; i++)
    for (uint32_t k = 0; i % in->nplain >= first && i % in->nplain < n && k < component_count(&in->value); k++)
      if (expr_contains_sym(b->g, in->value.at[k], in->symbols.at[i])) order = i / in->nplain;
  return order;
}

/* with[] := values for the symbols of an instance: arguments, and their rates where the body contains them.
 * 0, reported, when an argument has no rate. */
static int bind_symbols(Eval *ev, const AstExpr *x, const Instance *in, Expr *with) {
  uint32_t n = 0;
  for (AstId arg = x->args; arg; arg = ast_expr(ev->b->ast, arg)->next) {
    Value v = *value_of(ev, arg);
    uint32_t first = n, parts = component_count(&v), order = order_of(ev->b, in, first, n += parts);
    for (uint32_t i = 0;; i++) {
      for (uint32_t k = 0; k < parts; k++) with[i * in->nplain + first + k] = v.at[k];
      if (i == order) break;
      v = time_derivative(ev->b, v, x->span, ev->where);
      if (!v.e) return 0;
    }
  }
  return 1;
}

static Value call_instance(Eval *ev, const AstExpr *x, const Instance *in) {
  Builder *b = ev->b;
  Dim *dims = ARENA_ARRAY(b->arena, Dim, in->nargs + 1);
  Expr *with = ARENA_ARRAY(b->arena, Expr, in->symbols.n + 1);
  if (!in->value.e || !bind_dims(ev, x, in, dims) || !bind_symbols(ev, x, in, with)) return FAILED;
  Value r = in->value;
  r.dim = dim_replace(b->dims, r.dim, in->first_unknown, in->nargs, dims);
  r.bare = b->functions.at[in->function].composed;
  for (AstId arg = x->args; arg; arg = ast_expr(b->ast, arg)->next) r.bare &= value_of(ev, arg)->bare;
  for (uint32_t k = 0; k < component_count(&r); k++)
    r.at[k] = expr_replace(b->g, r.at[k], in->symbols.at, with, in->symbols.n);
  if (r.domain) r.domain = expr_replace(b->g, r.domain, in->symbols.at, with, in->symbols.n);
  return r;
}

void declare_composed(Builder *b) {
  note_composed(b->ast);
  for (uint32_t k = 0; k < b->ast->called.n; k++) {
    const AstStmt *s = b->ast->called.at[k];
    if (entity_named(b, s->name) || declared_in_use(b, s->name, NULL)) continue;
    Entity f = {.kind = ENT_FUNCTION, .index = b->functions.n, .name = s->name, .span = s->name_span};
    vec_push(b->arena, &b->scope.behind, f);
    add_definition(b, ENT_FUNCTION, (Definition){.stmt = s, .name = s->name, .composed = 1});
  }
}

/* Whether an argument of a function of the language is a vector: reported. */
static int takes_vector(Eval *ev, const AstExpr *x, AstId arg) {
  Builder *b = ev->b;
  const Value *v = value_of(ev, arg);
  if (!v->n) return 0;
  diag_error(b->diags, ast_expr(b->ast, arg)->span, "`%s` takes numbers, but `%s` is %s", x->name, ast_short(b, arg),
             shape_text(b, v->n));
  diag_help(b->diags, "take its components one by one: `%s(v.x, ...)`", x->name);
  return 1;
}

Value call_function(Eval *ev, const AstExpr *x, const Entity *e) {
  Builder *b = ev->b;
  const Definition *f = &b->functions.at[e->index];
  uint32_t nargs = ast_list_length(b->ast, f->stmt->args), n = 0, *shapes = ARENA_ARRAY(b->arena, uint32_t, nargs + 1);
  if (ev->where < IN_START && !f->composed)
    return refuse(b, x->span, "`%s` is a function of the model's own, and may not be used here", x->name);
  if (!arity_is(ev, x, nargs)) return FAILED;
  for (AstId arg = x->args; arg; arg = ast_expr(b->ast, arg)->next) {
    if (!value_of(ev, arg)->e || (f->composed && takes_vector(ev, x, arg))) return FAILED;
    shapes[n++] = value_of(ev, arg)->n;
  }
  uint32_t place = find_instance(b, e->index, nargs, shapes, x->span);
  if (b->instances.at[place]->done)
    return known_at_start(ev, call_instance(ev, x, b->instances.at[place]), x->name, x->span);
  suspend_for(ev, ENT_FUNCTION, place, b->state[ENT_FUNCTION].at[e->index].progress, x->name, x->span);
  return FAILED;
}
