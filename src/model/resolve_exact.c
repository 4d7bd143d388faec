/* Closed forms, `exact th = th(0)*cos(w*t)`, and their outputs `exact(th)`, `error(th)`.
 *
 * A closed form contains t, parameters, inputs and start values. While it is resolved, th(0) is a local symbol, and
 * th itself is refused. Then each local is replaced by its coordinate: in a finished closed form th means th(0). In
 * outputs, exact(th) is a symbol of kind SYM_INPUT numbered after the model's inputs: the runtime evaluates closed
 * forms like inputs. */
#include "model/resolve_impl.h"

/* --- values at the start --- */

/* Declares the local symbols th(0), and the substitutions at_start (th -> th(0)) and from_start (back). */
static void start_symbols(Builder *b) {
  const Model *m = b->m;
  if (b->at_start) return;
  VEC(SymId) of = {0};
  for (uint32_t i = 0; i < m->coords.n; i++) {
    vec_push(b->arena, &of, m->coords.at[i].q);
    vec_push(b->arena, &of, m->coords.at[i].v);
  }
  for (uint32_t i = 0; i < m->states.n; i++) vec_push(b->arena, &of, m->states.at[i].z);
  b->nbefore = expr_symbol_count(b->g);
  b->at_start = ARENA_ARRAY(b->arena, Expr, b->nbefore + 1);
  b->nstart = b->nbefore + of.n + 1;
  b->from_start = ARENA_ARRAY(b->arena, Expr, b->nstart + 1);
  b->at_start[m->time] = expr_int(b->g, 0);
  for (uint32_t i = 0; i < of.n; i++) {
    const Symbol *s = expr_symbol(b->g, of.at[i]);
    Expr node = s->node;
    SymId local =
        declare_symbol(b, SYM_LOCAL, 0, intern_printf(b, "%s(0)", s->name), SIGN_UNKNOWN, b->dim_of.at[of.at[i]]);
    b->at_start[of.at[i]] = expr_symbol(b->g, local)->node;
    b->from_start[local] = node;
  }
}

void report_start(Builder *b, Span span) {
  diag_error(b->diags, span, "a value at the start may stand only in `exact`");
  diag_help(b->diags, "a start that a formula needs is a parameter: `param x0 = 1`, `start x = x0`");
}

Value start_value(Eval *ev, Value v, Span span, const Value *when) {
  Builder *b = ev->b;
  if (!v.e || !when->e) return FAILED;
  if (ev->where != IN_EXACT) {
    report_start(b, span);
    return FAILED;
  }
  if (when->n || !expr_is_zero(b->g, when->e)) return refuse(b, span, "only the start value is known here: `x(0)`");
  start_symbols(b);
  for (uint32_t k = 0; k < component_count(&v); k++)
    v.at[k] = expr_substitute(b->g, v.at[k], b->at_start, b->nbefore, "_0");
  v.bare = 0;
  return v;
}

/* --- the statement --- */

static int moves(const Symbol *s, const void *data) {
  (void)data;
  return s->kind == SYM_COORD || s->kind == SYM_VEL || s->kind == SYM_ACC || s->kind == SYM_STATE ||
         s->kind == SYM_RATE;
}

void set_closed_form(Builder *b, SymId target, const Unit *unit, int periodic, Expr value, Span span) {
  Scene *sc = &b->m->scene;
  const Symbol *s = expr_symbol(b->g, target);
  if (expr_contains(b->g, value, moves, NULL)) {
    diag_error(b->diags, span,
               "a closed form may contain t, parameters and values at the start, and not the motion itself");
    diag_help(b->diags, "`%s(0)` is the value of `%s` at the start", s->name, s->name);
    return;
  }
  if (b->at_start) value = expr_substitute(b->g, value, b->from_start, b->nstart, "");
  for (uint32_t i = 0; i < sc->exacts.n; i++)
    if (sc->exacts.at[i].target == target) {
      sc->exacts.at[i].value = value;
      return;
    }
  Exact x = {.name = s->name, .target = target, .unit = *unit, .periodic = periodic, .value = value};
  Name name = intern_printf(b, "%s_exact", s->name);
  x.sym = declare_symbol(b, SYM_INPUT, b->m->inputs.n + sc->exacts.n, name, SIGN_UNKNOWN, b->dim_of.at[target]);
  vec_push(b->arena, &sc->exacts, x);
}

/* --- outputs --- */

const Exact *find_closed_form(const Builder *b, Expr e) {
  const Scene *sc = &b->m->scene;
  for (uint32_t i = 0; i < sc->exacts.n && expr_op(b->g, e) == EX_SYM; i++)
    if (sc->exacts.at[i].target == expr_sym_id(b->g, e)) return &sc->exacts.at[i];
  return NULL;
}

/* Angle e reduced to -pi..pi. */
static Expr wrapped(ExprGraph *g, Expr e) {
  Expr s = expr_fn(g, EX_SIN, e), c = expr_fn(g, EX_COS, e);
  return expr_fn2(g, EX_ATAN2, s, c);
}

Expr closed_form_error(Builder *b, const Exact *x) {
  Expr is = expr_symbol(b->g, x->target)->node, should = expr_symbol(b->g, x->sym)->node,
       off = expr_sub(b->g, is, should);
  return x->periodic ? wrapped(b->g, off) : off;
}

int call_is_exact(const Eval *ev, Name name) {
  return ev->where == IN_OUTPUT && (strcmp(name, "exact") == 0 || strcmp(name, "error") == 0);
}

Value exact_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  AstId arg = x->args;
  if (!arg || ast_expr(b->ast, arg)->next) return refuse(b, x->span, "`%s` takes one argument", x->name);
  Value v = *value_of(ev, arg);
  int error = strcmp(x->name, "error") == 0;
  for (uint32_t k = 0; v.e && k < component_count(&v); k++) {
    const Exact *form = find_closed_form(b, v.at[k]);
    if (!form) {
      diag_error(b->diags, ast_expr(b->ast, arg)->span, "the scene gives `%s` no closed form", ast_short(b, arg));
      if (expr_op(b->g, v.at[k]) == EX_SYM) diag_help(b->diags, "`exact %s = ...` gives one", ast_short(b, arg));
      else diag_help(b->diags, "coordinates, velocities and states have closed forms: `%s(x)`", x->name);
      return FAILED;
    }
    v.at[k] = error ? closed_form_error(b, form) : expr_symbol(b->g, form->sym)->node;
  }
  v.point &= !error;
  return v;
}
