/* Values from the command line, `th=90[deg]`, converted to the unit that the simulator takes: the declared one. */
#include <math.h>
#include <string.h>

#include "model/builder.h"

/* Unit of the symbol x, a coordinate, velocity, state, parameter or input; 0: x is something else. */
static int setting_unit(Builder *b, Expr x, Unit *unit) {
  const Model *m = b->m;
  const Symbol *s = x && expr_op(b->g, x) == EX_SYM ? expr_sym_of(b->g, x) : NULL;
  if (!s) return 0;
  switch (s->kind) {
    case SYM_COORD: *unit = m->coords.at[s->index].unit; return 1;
    case SYM_VEL: *unit = unit_per_second(b, &m->coords.at[s->index].unit); return 1;
    case SYM_STATE: *unit = m->states.at[s->index].unit; return 1;
    case SYM_PARAM: *unit = m->params.at[s->index].unit; return 1;
    case SYM_INPUT: *unit = m->inputs.at[s->index].unit; return 1;
    case SYM_ACC: case SYM_RATE: case SYM_TIME: case SYM_CONST: case SYM_MULTIPLIER: case SYM_LOCAL: break;
  }
  return 0;
}

/* Converts x from SI to unit u, exactly in rationals up to the final rounding: 90 deg gives 90. */
static double in_declared(Builder *b, Expr x, const Unit *u, const char **digits) {
  ExprGraph *g = b->g;
  Expr pi = expr_symbol(g, b->m->pi)->node;
  Expr from_zero = num_is_zero(u->offset) ? x : expr_sub(g, x, expr_num(g, u->offset));
  Expr scaled = expr_scale(g, num_div(num_int(1), u->factor), from_zero),
       turns = expr_pow_num(g, pi, num_int(-u->pi_power));
  Expr e = expr_mul(g, scaled, turns);
  *digits = expression_digits(b, e);
  return (double)constant_value(b, e);
}

/* Whether the target is the `period` of a family of motions, a name that the model does not declare. */
static int is_period(Builder *b, const CommandValue *of) {
  const AstExpr *x = of->target ? ast_expr(b->ast, of->target) : NULL;
  return of->follows && x && x->kind == AST_NAME && strcmp(x->name, "period") == 0 && !entity_named(b, x->name);
}

/* Unit of the energy or of the charge that x is: of SI; 0: it is something else. */
static int charge_unit(Builder *b, const Value *x, Unit *unit) {
  const Model *m = b->m;
  const Symbol *s = expr_op(b->g, x->e) == EX_SYM ? expr_sym_of(b->g, x->e) : NULL;
  int is_charge = s && x->e == expr_symbol(b->g, m->energy_sym)->node;
  for (uint32_t i = 0; s && i < m->symmetries.n; i++)
    is_charge |= x->e == expr_symbol(b->g, m->symmetries.at[i].charge)->node;
  if (is_charge) *unit = unit_si(x->dim, "");
  return is_charge;
}

static void command_value(Builder *b, CommandValue *of) {
  Unit unit = unit_si(dim_base(b->dims, DIM_TIME), "s");
  if (of->target && !is_period(b, of)) {
    Value target = resolve(b, of->target, IN_OBSERVE, NULL);
    if (!target.e) return;
    if (target.n || (!setting_unit(b, target.e, &unit) && !(of->follows && charge_unit(b, &target, &unit)))) {
      diag_error(b->diags, ast_expr(b->ast, of->target)->span, "a run cannot set `%s`", ast_short(b, of->target));
      if (target.n)
        diag_help(b->diags, "it is %s: set its components, `%s.x=...`", shape_text(b, target.n),
                  ast_text(b, of->target));
      else diag_help(b->diags, "parameters, inputs, and the starts of coordinates, velocities and states are set so");
      return;
    }
  }
  Expr e = resolve_in(b, of->value, IN_CONST, NULL, &unit);
  if (!e) return;
  of->number = in_declared(b, e, &unit, &of->digits);
  if (!isfinite(of->number)) diag_error(b->diags, ast_expr(b->ast, of->value)->span, "this is not a finite number");
}

void command_values(Builder *b, CommandValue *values, uint32_t n) {
  for (uint32_t i = 0; i < n; i++) command_value(b, &values[i]);
}
