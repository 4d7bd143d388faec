/* Dimension checks of operands, their messages, offsets of degC, and inferred units. Zero fits every dimension. */
#include <string.h>

#include "base/words.h"
#include "model/resolve_impl.h"

int is_zero(const Builder *b, const Value *v) {
  for (uint32_t k = 0; k < component_count(v); k++)
    if (!expr_is_zero(b->g, v->at[k])) return 0;
  return 1;
}

int dims_agree(Builder *b, const Value *x, const Value *y, Span why) {
  return is_zero(b, x) || is_zero(b, y) || dim_equate(b->dims, x->dim, y->dim, why);
}

const char *shown_unit(const Builder *b, const Value *v) {
  return v->unit && v->unit[0] ? v->unit : dim_text(b->dims, v->dim);
}

const char *in_unit(const Builder *b, const char *unit) {
  return strcmp(unit, "1") == 0 ? "a pure number" : arena_printf(b->arena, "in [%s]", unit);
}

const char *in_dim(const Builder *b, Dim d) { return in_unit(b, dim_text(b->dims, d)); }

void explain_dims(Builder *b, Dim x, Dim y) {
  DimCause c;
  Name open = dim_open_name(b->dims, x) ? dim_open_name(b->dims, x) : dim_open_name(b->dims, y);
  if (open && y != DIM_ANY)
    diag_help(b->diags, "for any unit of `%s` they differ by [%s]", open, dim_text(b->dims, dim_div(b->dims, x, y)));
  if (!dim_cause(b->dims, x, &c) && !dim_cause(b->dims, y, &c)) return;
  diag_also(b->diags, c.why, "here `%s`, which is declared without a unit, is %s", c.name, in_dim(b, c.is));
}

/* Reports operands of different dimensions; for a bare number, the unit to write. */
static void report_mismatch(Eval *ev, Span span, AstId x, AstId y) {
  Builder *b = ev->b;
  AstId bare = value_of(ev, x)->bare ? x : value_of(ev, y)->bare ? y : 0, other = bare == x ? y : x;
  const Value *v = value_of(ev, bare ? other : x), *w = value_of(ev, y);
  if (bare) {
    const char *unit = v->point ? dim_text(b->dims, v->dim) : shown_unit(b, v);
    diag_error(b->diags, span, "units do not match: `%s` is in [%s], `%s` has no unit", ast_short(b, other), unit,
               ast_short(b, bare));
    if (!dim_open_name(b->dims, v->dim))
      diag_help(b->diags, "give the number its unit: `%s [%s]`", ast_short(b, bare), unit);
  } else
    diag_error(b->diags, span, "units do not match: `%s` is %s, `%s` %s", ast_short(b, x), in_unit(b, shown_unit(b, v)),
               ast_short(b, y), in_unit(b, shown_unit(b, w)));
  explain_dims(b, v->dim, w->dim);
}

/* Warns of th - 90 with th in degrees: the dimensions agree, but 90 would be radians. */
static void warn_angle(Eval *ev, AstId angle, AstId number) {
  Builder *b = ev->b;
  const Value *v = value_of(ev, angle), *w = value_of(ev, number);
  if (!v->unit || (strcmp(v->unit, "deg") != 0 && strcmp(v->unit, "rev") != 0)) return;
  if (!w->bare || w->n || !expr_is_num(b->g, w->e) || expr_is_zero(b->g, w->e)) return;
  diag_warning(b->diags, ast_expr(b->ast, number)->span, "`%s` is in [%s], and `%s` here is a number of radians",
               ast_short(b, angle), v->unit, ast_short(b, number));
  diag_help(b->diags, "give the number its unit: `%s [%s]` or `%s [rad]`", ast_short(b, number), v->unit,
            ast_short(b, number));
}

int operands_agree(Eval *ev, Span span, AstId x, AstId y) {
  if (dims_agree(ev->b, value_of(ev, x), value_of(ev, y), span)) {
    warn_angle(ev, x, y);
    warn_angle(ev, y, x);
    return 1;
  }
  report_mismatch(ev, span, x, y);
  return 0;
}

int need_pure(Eval *ev, AstId arg, const char *what) {
  Builder *b = ev->b;
  const Value *v = value_of(ev, arg);
  Span span = ast_expr(b->ast, arg)->span;
  if (dim_equate(b->dims, v->dim, DIM_NONE, span)) return 1;
  diag_error(b->diags, span, "%s takes a pure number or an angle; `%s` is in [%s]", what, ast_short(b, arg),
             shown_unit(b, v));
  if (strcmp(what, "an exponent") == 0 && ast_expr(b->ast, arg)->kind == AST_UNIT)
    diag_help(b->diags, "a unit belongs to the operand directly before it, here to the exponent: write `5 "
                        "[N/s^2]*t^2`, or `(5*t^2) [...]`");
  else if (!dim_is_open(b->dims, dim_resolved(b->dims, v->dim)))
    diag_help(b->diags, "a factor with a unit makes it one: `2 [%s]`",
              dim_text(b->dims, dim_pow(b->dims, v->dim, num_int(-1))));
  explain_dims(b, v->dim, DIM_ANY);
  return 0;
}

/* --- temperatures in degC --- */

int refuse_point(Eval *ev, AstId operand, const char *why) {
  Builder *b = ev->b;
  const AstExpr *x = ast_expr(b->ast, operand);
  const char *number = x->kind == AST_UNIT ? ast_short(b, x->a) : "...";
  Expr e = value_of(ev, operand)->e;
  StrBuf kelvin = strbuf(b->arena);
  if (expr_is_num(b->g, e)) num_print(&kelvin, num_double(num_value(expr_number(b->g, e))));
  return diag_error(b->diags, x->span,
                    "`%s` is a temperature on a scale with an offset, and %s" HELP
                    "for a difference write `%s [K]`, for the temperature itself `%s [K]`",
                    ast_short(b, operand), why, number, kelvin.n ? sb_text(&kelvin) : "...");
}

int point_fits(Eval *ev, const AstExpr *x, AstId operand) {
  switch (x->kind) {
  case AST_ADD: case AST_SUB: case AST_LT: case AST_LE: case AST_GT: case AST_GE: case AST_EQ: case AST_NE:
  case AST_UNIT: return 1;
  case AST_CALL:
    return has_word("if min max", x->name) || own_function(ev, x) ||
           refuse_point(ev, operand, "no argument of a function");
  default: return refuse_point(ev, operand, "cannot be multiplied");
  }
}

/* --- units of names and statements --- */

Unit unit_per_second(const Builder *b, const Unit *u) {
  Unit rate = *u;
  rate.dim = dim_per_second(b->dims, u->dim);
  rate.offset = num_int(0);
  if (!u->text[0]) return rate;
  size_t n = strlen(u->text);
  const char *stem = num_is_zero(u->offset) ? u->text : "K"; /* 1 degC of difference is 1 K */
  const char *power = n > 2 ? strstr(stem, "/s") : NULL;
  rate.text = power && !power[2] ? arena_printf(b->arena, "%s^2", stem) : arena_printf(b->arena, "%s/s", stem);
  return rate;
}

Unit unit_of_difference(const Unit *u) {
  Unit d = *u;
  d.offset = num_int(0);
  if (!num_is_zero(u->offset)) d.text = "K";
  return d;
}

static void fill_unit(Builder *b, Unit *u) {
  if (!u->text[0]) *u = unit_of_dim(b->dims, u->dim);
}

void fill_inferred_units(Builder *b) {
  Model *m = b->m;
  for (uint32_t i = 0; i < m->coords.n; i++) fill_unit(b, &m->coords.at[i].unit);
  for (uint32_t i = 0; i < m->states.n; i++) fill_unit(b, &m->states.at[i].unit);
  for (uint32_t i = 0; i < m->params.n; i++) fill_unit(b, &m->params.at[i].unit);
  for (uint32_t i = 0; i < m->inputs.n; i++) fill_unit(b, &m->inputs.at[i].unit);
  for (uint32_t i = 0; i < m->symmetries.n; i++) fill_unit(b, &m->symmetries.at[i].unit);
  m->energy_unit = unit_of_dim(b->dims, b->unitless ? DIM_ANY : b->energy);
  for (uint32_t i = 0; i < m->observes.n; i++) fill_unit(b, &m->observes.at[i].unit);
  for (uint32_t i = 0; i < m->scene.outputs.n; i++) fill_unit(b, &m->scene.outputs.at[i].unit);
  for (uint32_t i = 0; i < m->scene.measures.n; i++) fill_unit(b, &m->scene.measures.at[i].unit);
  for (uint32_t i = 0; i < m->asked_measures.n; i++) fill_unit(b, &m->asked_measures.at[i].unit);
  for (uint32_t i = 0; i < b->undeclared.n; i++) {
    Dim d = dim_resolved(b->dims, b->undeclared.at[i].dim);
    if (dim_is_open(b->dims, d)) continue;
    vec_push(b->arena, &m->found, ((FoundUnit){b->undeclared.at[i].name, dim_text(b->dims, d)}));
  }
}
