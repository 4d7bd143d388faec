/* Shapes of values, numbers of arguments, and refusals of both; the function of the model that a call means. */
#include <string.h>

#include "model/resolve_impl.h"

const char *shape_text(const Builder *b, uint32_t n) {
  if (n == ROTATION) return "a rotation";
  return n ? arena_printf(b->arena, "a vector of %u components", n) : "a number";
}

int need_number(Builder *b, Span span, uint32_t n) {
  return !n || diag_error(b->diags, span, "this is %s, but a number is needed here", shape_text(b, n));
}

int arity_is(Eval *ev, const AstExpr *x, uint32_t want) {
  uint32_t n = ast_list_length(ev->b->ast, x->args);
  if (n == want) return 1;
  diag_error(ev->b->diags, x->span, "`%s` takes %u argument%s, here it has %u", x->name, want, want == 1 ? "" : "s", n);
  if (n == 1 && (strcmp(x->name, "dot") == 0 || strcmp(x->name, "d") == 0))
    diag_help(ev->b->diags, "a time derivative is written with a prime: `x'`");
  return 0;
}

const Entity *own_function(const Eval *ev, const AstExpr *x) {
  const Entity *e = scope_find(&ev->b->scope, x->name, ev->effect, NULL);
  return e && e->kind == ENT_FUNCTION ? e : NULL;
}

int whole_number(Builder *b, const Value *v, AstId id, int64_t *out) {
  if (!v->e) return 0;
  Num n = expr_is_num(b->g, v->e) ? expr_number(b->g, v->e) : num_ratio(1, 2);
  if (v->n || !num_is_exact(n) || n.den != 1 || !dim_equate(b->dims, v->dim, DIM_NONE, ast_expr(b->ast, id)->span))
    return diag_error(b->diags, ast_expr(b->ast, id)->span,
                      "`%s` is not a whole number known at compile time" HELP
                      "indices and ranges are made of numbers, constants (`const N = 3`) and indices",
                      ast_short(b, id));
  *out = n.num;
  return 1;
}

static const struct {
  const char *refusal, *way;
} mistakes[] = {
    [TURN_SUM] = {"rotations are not added",
                  "products of rotations are rotations, sums are none: `R*S` turns by S, then by R"},
    [TURN_INVERSE] = {"it has no sign, and nothing is divided by it",
                      "the inverse rotation is `transpose(R)`: `transpose(R)*v` is v in the body's frame"},
    [TURN_SCALED] = {"it is not multiplied by a number",
                     "vectors that it turns are scaled: `2*(R*v)`; a turn by another angle is `turn(axis, angle)`"},
    [TURN_BEHIND] = {"it stands before the vector that it turns",
                     "`R*v` takes v from the body's frame to space, `transpose(R)*v` from space to the body's frame"},
    [TURN_PRIME] = {"its rate is an angular velocity",
                    "`omega(R)` is its angular velocity, in its own frame; `R.w'` the rate of one of its four numbers"},
    [TURN_EQUATION] = {"two that are equal may differ in the sign of all four numbers",
                       "constrain directions: `constraint hinge: R*(0, 0, 1) = S*(0, 0, 1)`"},
    [TURN_VALUE] = {"it cannot be the value of a parameter", "make it of parameters: `let R0 = turn((0, 0, 1), a)`"},
    [TURN_NUMBER] = {"it is neither a number nor a vector",
                     "its four numbers are `.w`, `.x`, `.y`, `.z`; `R*v` turns a vector of 3 components, `omega(R)` is "
                     "its angular velocity"},
};

Value refuse_rotation(Builder *b, Span span, const char *text, TurnMistake why) {
  return refuse(b, span, "`%s` is a rotation: %s" HELP "%s", text, mistakes[why].refusal, mistakes[why].way);
}
