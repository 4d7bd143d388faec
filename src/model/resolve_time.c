/* Time derivatives (primes), and units written after a value. */
#include "model/resolve_impl.h"
#include "sym/diff.h"

/* Seeds for arguments of functions: each symbol's rate. */
static void local_seeds(const Builder *b, Expr *seed) {
  for (uint32_t i = 0; i < b->instances.n; i++) {
    const Instance *in = b->instances.at[i];
    for (uint32_t k = 0; k + in->nplain < in->symbols.n; k++)
      seed[in->symbols.at[k]] = expr_symbol(b->g, in->symbols.at[k + in->nplain])->node;
  }
}

/* Time derivative of each symbol (0: constant), cached until symbols are added. */
static const Expr *time_seeds(Builder *b) {
  if (b->seeds && b->nseeds == expr_symbol_count(b->g)) return b->seeds;
  b->nseeds = expr_symbol_count(b->g);
  Expr *seed = b->seeds = ARENA_ARRAY(b->arena, Expr, b->nseeds + 1);
  b->rates = expr_map(b->arena);
  const Model *m = b->m;
  model_seed_time(m, seed);
  vec_each(const Coord, c, m->coords) {
    seed[c->q] = expr_symbol(b->g, c->v)->node;
    seed[c->v] = expr_symbol(b->g, c->a)->node;
  }
  for (uint32_t i = 0; i < m->states.n; i++)
    seed[m->states.at[i].z] = expr_symbol(b->g, m->states.at[i].rate)->node;
  local_seeds(b, seed);
  return seed;
}

/* 1 if v contains a symbol without a known rate: the energy, a charge, a second rate of an argument. */
static int has_no_rate(Builder *b, const Value *v) {
  const Expr *seed = time_seeds(b);
  ExprList l = expr_topo(b->g, v->at, component_count(v));
  for (uint32_t i = 0; i < l.n; i++)
    if (expr_op(b->g, l.at[i]) == EX_SYM && expr_sym_of(b->g, l.at[i])->kind == SYM_LOCAL &&
        !seed[expr_sym_id(b->g, l.at[i])])
      return 1;
  return 0;
}

/* Kinds of symbols in a value, as bits 1 << SymKind. */
static unsigned kinds_in(Builder *b, const Value *v) {
  unsigned kinds = 0;
  for (uint32_t i = 0; i < component_count(v); i++) kinds |= expr_kinds(b->g, v->at[i]);
  return kinds;
}

/* Whether the value contains a symbol of a closed form, numbered behind the inputs. */
static int has_closed_form(Builder *b, const Value *v) {
  ExprList l = expr_topo(b->g, v->at, component_count(v));
  for (uint32_t i = 0; i < l.n; i++)
    if (expr_op(b->g, l.at[i]) == EX_SYM && expr_sym_of(b->g, l.at[i])->kind == SYM_INPUT &&
        expr_sym_of(b->g, l.at[i])->index >= b->m->inputs.n)
      return 1;
  return 0;
}

/* Notes the rates of the inputs in v; 0 where one is a second rate. */
static int want_rates(Builder *b, const Value *v) {
  for (uint32_t i = 0; i < b->m->inputs.n; i++)
    for (uint32_t k = 0; k < component_count(v); k++)
      if (b->m->inputs.at[i].order == 2 && expr_contains_sym(b->g, v->at[k], b->m->inputs.at[i].sym)) return 0;
  for (uint32_t k = 0; k < component_count(v); k++) want_rates_of(b, v->at[k], 1);
  return 1;
}

Value time_derivative(Builder *b, Value of, Span span, Context where) {
  unsigned kinds = kinds_in(b, &of), second = 1u << SYM_ACC | 1u << SYM_RATE;
  if (kinds & 1u << SYM_INPUT && has_closed_form(b, &of))
    return refuse(b, span, "inputs and closed forms have no time derivative" HELP
                  "a velocity has a closed form of its own: `exact x' = ...`, and then `error(x')`");
  if (kinds & 1u << SYM_INPUT && !want_rates(b, &of))
    return refuse(b, span, "a third time derivative of an input is not supported" HELP
                  "a `let` of t has all: `let u = sin(t)` in the place of `input u = sin(t)`");
  if (kinds & second && !(kinds & 1u << SYM_ACC))
    return refuse(
        b, span,
        b->m->hamiltonian ? "the model gives its Hamiltonian, and there is no second derivative" HELP
                            "write the derivative of the right side of Hamilton's equation"
        : b->m->first_order
            ? "L is linear in the velocities: they follow from the coordinates, and there is no second derivative" HELP
              "write the derivative of the right side of its equation of motion"
            : "a state has a rate, and no second one" HELP "write the derivative of the right side of its flow");
  if (kinds & second) return refuse(b, span, "third derivatives do not occur in mechanics");
  if (kinds & 1u << SYM_LOCAL && has_no_rate(b, &of))
    return refuse(
        b, span,
        "a time derivative of the energy, a charge or an action, or a third one of a function's argument, is not "
        "supported" HELP
        "the energy changes by the power of forces: `force x = F` adds the power `F*x'`");
  Value r = {.dim = dim_per_second(b->dims, of.dim), .n = of.n};
  const Expr *seed = time_seeds(b);
  expr_tangent(b->g, of.at, component_count(&of), (ExprSeeds){.at = seed, .n = b->nseeds + 1}, "'", &b->rates, r.at);
  if (b->m->first_order) return r; /* rates are velocities; rates of true states were refused in the first build */
  if (where < IN_OBSERVE && kinds_in(b, &r) & second && !(kinds_in(b, &r) & 1u << SYM_ACC))
    return refuse(b, span, "the rate of a state may stand only in `expect`, `observe` and `output`" HELP
                  "write the right side of its flow; a `let` may stand for both");
  if (where < IN_OBSERVE && kinds_in(b, &r) & second)
    return refuse(b, span, "a second derivative may stand only in `expect` and `observe`" HELP
                  "L and forces are functions of q, q' and t; accelerations follow from them");
  return r;
}

/* --- units on a value --- */

Expr times_unit(Builder *b, Expr e, const Unit *u) {
  Expr pi = expr_symbol(b->g, b->m->pi)->node;
  Expr power = expr_pow_num(b->g, pi, num_int(u->pi_power));
  Expr scaled = expr_scale(b->g, u->factor, e);
  Expr product = expr_mul(b->g, scaled, power);
  return num_is_zero(u->offset) ? product : expr_add(b->g, product, expr_num(b->g, u->offset));
}

Value unit_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const Value *v = value_of(ev, x->a);
  if (ast_expr(b->ast, x->a)->kind != AST_NUM) warn_unit_is_constant(b, &x->unit);
  Unit u = unit_resolve(&x->unit, b->dims, b->diags, b->arena);
  if (v->e && v->n == ROTATION) return refuse_rotation(b, x->span, ast_short(b, x->a), TURN_NUMBER);
  if (!v->e || (x->unit.n && u.dim == DIM_ANY)) return FAILED;
  if (!dim_equate(b->dims, v->dim, DIM_NONE, x->span)) {
    diag_error(b->diags, x->unit.span, "`%s` has a unit already: [%s]", ast_short(b, x->a), shown_unit(b, v));
    diag_help(b->diags, "leave `[%s]` out, or multiply: `... * 1 [%s]`", x->unit.text, x->unit.text);
    explain_dims(b, v->dim, DIM_ANY);
    return FAILED;
  }
  Value r = {.dim = u.dim, .n = v->n, .unit = u.text, .point = !num_is_zero(u.offset)};
  for (uint32_t k = 0; k < component_count(v); k++) r.at[k] = times_unit(b, v->at[k], &u);
  return r;
}
