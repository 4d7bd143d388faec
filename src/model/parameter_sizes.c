/* Sizes made of parameters that runs check, as values come from outside: of friction, coefficients, neighbourhoods. */
#include "model/builder.h"
#include "sym/expr_eval.h"

#define LIVELY \
  HELP "a surface that adds energy moves, or is an `event` that sets velocities: " \
       "`event bumper: g falling { x' = -2*x' }`"

static int is_of_parameters(const ExprGraph *g, Expr e) {
  return !(expr_kinds(g, e) & ~(1u << SYM_PARAM | 1u << SYM_CONST));
}

/* The factor of parameters of a size; 0: none, or the rest may be negative. */
static Expr parameter_factor(ExprGraph *g, Expr size) {
  Expr of = expr_int(g, 1), rest = of;
  if (is_of_parameters(g, size)) return size;
  for (ExprPair base = {0}; expr_next_pair(g, size, EX_PROD, &base);) {
    Expr factor = expr_pow_num(g, base.of, base.num);
    if (is_of_parameters(g, factor)) of = expr_mul(g, of, factor);
    else rest = expr_mul(g, rest, factor);
  }
  return sign_is_nonnegative(expr_sign(g, rest)) ? of : 0;
}

void add_size(Builder *b, Expr value, const char *what, Span span, int part) {
  const unsigned beyond = 1u << SYM_ACC | 1u << SYM_RATE | 1u << SYM_MULTIPLIER; /* not known between steps */
  Expr of = parameter_factor(b->g, value);
  int moves = !of && !part && !(expr_kinds(b->g, value) & beyond);
  of = moves ? value : of;
  if (!of || (!part && sign_is_nonnegative(expr_sign(b->g, of)))) return;
  vec_push(b->arena, &b->m->sizes, ((ModelSize){of, what, span, 0, part, moves, NULL}));
}

/* A size of parameters alone that does not drive a motion; once. */
static void add_other_size(Builder *b, Expr value, const char *what, const char *mistake, Span span) {
  if (sign_is_nonnegative(expr_sign(b->g, value))) return;
  for (uint32_t i = 0; i < b->m->sizes.n; i++)
    if (b->m->sizes.at[i].value == value && b->m->sizes.at[i].mistake == mistake) return;
  vec_push(b->arena, &b->m->sizes, ((ModelSize){.value = value, .what = what, .span = span, .mistake = mistake}));
}

void add_near_cut(Builder *b, Expr cut, Span span) {
  static const char mistake[] =
      "the cut-off of `near` is negative" HELP "a distance is at least 0: `param r_cut = 2.5 [m] > 0`";
  add_other_size(b, cut, "the cut-off of `near` has a length", mistake, span);
}

void add_near_box(Builder *b, Expr side, Expr cut, Span span) {
  static const char mistake[] = "the cut-off is above half the box: a pair would be near by several images, of which "
                                "`near` takes one" HELP "take a larger box, with more bodies, or a shorter cut-off";
  Expr twice = expr_mul(b->g, expr_int(b->g, 2), cut), rest = expr_sub(b->g, side, twice);
  add_other_size(b, rest, "the box of `near` less twice its cut-off has a length", mistake, span);
}

void add_opening_angle(Builder *b, Expr theta, Span span) {
  static const char mistake[] = "the opening angle of a tree is from 0, the direct sum, to 1" HELP
                                "0.5 is usual; smaller ones are more accurate, and take longer";
  add_other_size(b, theta, "the opening angle of the tree", mistake, span);
  add_other_size(b, expr_sub(b->g, expr_int(b->g, 1), theta), "1 less the opening angle of the tree", mistake, span);
}

/* The product of the factors with negative exponents, inverted. */
static Expr denominator_of(ExprGraph *g, Expr e) {
  Expr of = expr_int(g, 1);
  if (expr_pairs(g, e, EX_SUM) == 1) e = expr_pair(g, e, EX_SUM, 0, NULL);
  for (ExprPair base = {0}; expr_next_pair(g, e, EX_PROD, &base);)
    if (num_sign(base.num) < 0) of = expr_mul(g, of, expr_pow_num(g, base.of, num_neg(base.num)));
  return of;
}

/* A static limit is at least the friction of a sliding body. Limits that parameters alone do not tell from it are
 * judged where a body rests. */
void add_static_limit(Builder *b, Expr limit, Expr friction, Span span) {
  Expr ratio = expr_div(b->g, limit, friction), of = denominator_of(b->g, ratio);
  Expr excess = expr_sub(b->g, expr_mul(b->g, ratio, of), of);
  static const char mistake[] = "the static limit is smaller than the friction of a sliding body" HELP
                                "static friction is at least as large: `static = mu_s*N` with mu_s >= mu";
  if (is_of_parameters(b->g, ratio))
    add_other_size(b, excess, "the static limit minus the friction of a sliding body has a value", mistake, span);
}

void check_sizes(Builder *b) {
  const Model *m = b->m;
  long double *x = model_constants(m), f;
  for (uint32_t i = 0; i < m->params.n; i++)
    if (m->params.at[i].value) expr_eval(b->g, &m->params.at[i].value, 1, x, &x[m->params.at[i].sym]);
  vec_each(const ModelSize, one, m->sizes) {
    if (one->moves) continue;
    expr_eval(b->g, &one->value, 1, x, &f);
    const char *size = arena_printf(b->arena, "%.6Lg", f);
    if (!(f < 0) && !(one->part && f > 1)) continue;
    if (one->part)
      diag_error(b->diags, one->span, "%s of %s, which must be between 0 and 1%s", one->what, size,
                 f > 1 ? LIVELY : "");
    else if (one->mistake)
      diag_error(b->diags, one->span, "%s", one->mistake);
    else
      diag_error(b->diags, one->span,
                 "%s of %s, and would drive the motion" HELP
                 "it acts against the velocity by itself: let its size be at least 0, `param mu = 0.3 >= 0`",
                 one->what, size);
  }
  arena_release(b->arena, x, (expr_symbol_count(b->g) + 1) * sizeof *x);
}
