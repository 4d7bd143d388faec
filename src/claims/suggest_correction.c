/* At a few dozen states each place of the formula is solved for the value that it needs. The needed value, its
 * difference from the written one, or their ratio is recognised as a monomial of the model's quantities, and named
 * as an edit: the cheapest one that is proved is the correction. */
#include "claims/suggest_correction.h"

#include <math.h>
#include <stdlib.h>

#include "claims/case_proofs.h"
#include "claims/mutation_sites.h"
#include "claims/feature_pool.h"
#include "mech/states.h"
#include "sym/prove.h"
#include "model/printed_text.h"
#include "sym/print.h"

/* Costs of edits: slips of the pen first, then larger changes. */
#define COST_SLIP 1.0
#define COST_POWER 1.2
#define COST_EXTRA 1.5  /* a superfluous term, factor or divisor */
#define COST_INVERSE 1.6
#define COST_NAME 1.8
#define COST_SCALE 2.0  /* a missing number */
#define COST_VALUE 3.0  /* a missing term or factor */
#define COST_FACTOR 0.25 /* each factor of what is missing */

typedef struct {
  const Site *site;
  Expr with;
  long double cost;
  Span caret;
  const char *edit;  /* the sentence; of a replacement its begin, up to the new text */
  const char *text;  /* what replaces the text at `at`; NULL: the sentence has no text to paste */
  const char *after; /* of the text in the sentence */
  Span at;
  uint32_t own;      /* text has the site's own text from here on; 0: it has not */
} Guess;

/* Values of a site at the states. */
typedef struct {
  long double written[FEATURE_STATES], needed[FEATURE_STATES], difference[FEATURE_STATES], ratio[FEATURE_STATES];
} Need;

typedef struct {
  const Eqns *e;
  const Model *m;
  const Expect *x;
  ExprGraph *g;
  Arena *arena;
  SymId stand_in;
  SiteList sites;
  long double *state[FEATURE_STATES], residual[FEATURE_STATES]; /* residual: left minus right side, as written */
  const Features *features;
  VEC(Guess) guesses;
} EditSearch;

/* --- states --- */

/* States that obey the equations of motion and at which the sides differ; 0: too few are found. */
static int find_states(EditSearch *md) {
  enum { ATTEMPTS = 400 };
  Expr sides[2] = {md->x->lhs, md->x->rhs};
  EvalTape *tape = eval_tape(md->g, sides, 2);
  StateSolver *solver = states_new(md->e);
  uint32_t n = 0;
  long double out[2];
  for (uint32_t seed = 1; seed <= ATTEMPTS && n < FEATURE_STATES; seed++) {
    if (!md->state[n]) md->state[n] = ARENA_ARRAY(md->arena, long double, expr_symbol_count(md->g) + 1);
    sample_state(md->g, seed, md->state[n]);
    if (!states_complete(solver, md->state[n])) continue;
    eval_run(tape, md->state[n], out);
    md->residual[n] = out[0] - out[1];
    n += isfinite(md->residual[n]) && md->residual[n] != 0;
  }
  return n == FEATURE_STATES;
}

/* --- the needed value --- */

/* Left minus right side at a state, with `value` at the site whose tape this is. */
static long double residual_with(EditSearch *md, EvalTape *tape, uint32_t state, long double value) {
  long double out[2], *symbols = md->state[state];
  symbols[md->stand_in] = value;
  eval_run(tape, symbols, out);
  return out[0] - out[1];
}

/* The root of the function x -> (x - r)/(c x + d) through three points: exact where the equation is linear in the
 * place, or a quotient of linear functions of it (Jarratt and Nudds 1965, DOI 10.1093/comjnl/8.1.62). */
static long double next_guess(const long double *x, const long double *f) {
  long double y0 = x[0] - x[2], y1 = x[1] - x[2];
  long double det = f[0] * y0 * (f[1] - f[2]) - f[1] * y1 * (f[0] - f[2]);
  return x[2] - f[2] * y0 * y1 * (f[0] - f[1]) / det;
}

/* The value at the place for which the equation holds at a state; NAN: the iteration does not converge. */
static long double needed_value(EditSearch *md, EvalTape *tape, uint32_t state, long double written) {
  enum { STEPS = 12 };
  long double step = 0.1L * fabsl(written) + 0.01L;
  long double x[3] = {written, written + step, written - step}, f[3];
  for (int i = 0; i < 3; i++) f[i] = residual_with(md, tape, state, x[i]);
  for (int k = 0; k < STEPS; k++) {
    long double next = next_guess(x, f);
    if (!isfinite(next)) return NAN;
    long double r = residual_with(md, tape, state, next);
    if (fabsl(r) <= 1e-11L * fabsl(md->residual[state])) return next;
    for (int i = 0; i < 2; i++) x[i] = x[i + 1], f[i] = f[i + 1];
    x[2] = next, f[2] = r;
  }
  return NAN;
}

static int find_need(EditSearch *md, const Site *s, Need *need) {
  Expr stand_in = expr_symbol(md->g, md->stand_in)->node, changed = edit_replaced(&md->sites, s, stand_in),
       value = s->value;
  Expr sides[2] = {s->side ? md->x->lhs : changed, s->side ? changed : md->x->rhs};
  if (!changed) return 0;
  EvalTape *tape = eval_tape(md->g, sides, 2), *as_written = eval_tape(md->g, &value, 1);
  for (uint32_t i = 0; i < FEATURE_STATES; i++) {
    eval_run(as_written, md->state[i], &need->written[i]);
    need->needed[i] = needed_value(md, tape, i, need->written[i]);
    if (!isfinite(need->needed[i])) return 0;
    need->difference[i] = need->needed[i] - need->written[i];
    need->ratio[i] = need->needed[i] / need->written[i];
    if (fabsl(need->difference[i]) < 1e-12L * fabsl(need->written[i])) return 0; /* the difference is rounding */
  }
  return 1;
}

/* --- features --- */

/* Whether e is or contains a whole side: that may not correct the other, or any x'' = formula could become x'' =
 * x''. */
static int contains_a_side(const void *data, Expr e) {
  const EditSearch *md = data;
  const Expr sides[2] = {md->x->lhs, md->x->rhs};
  for (int k = 0; k < 2; k++)
    if (e == sides[k] ||
        (expr_op(md->g, sides[k]) == EX_SYM && expr_contains_sym(md->g, e, expr_sym_id(md->g, sides[k]))))
      return 1;
  return 0;
}

/* Quantities that the needed value of a place may be made of; simple ones first. What is missing often stands
 * elsewhere in the expectations. */
static const Features *gather_features(EditSearch *md) {
  const Model *m = md->m;
  VEC(Expr) own = {0}, all = {0}, dynamics = {0}, inertia = {0};
  vec_push(md->arena, &own, md->x->lhs);
  vec_push(md->arena, &own, md->x->rhs);
  for (uint32_t i = 0; i < m->expects.n; i++) {
    vec_push(md->arena, &all, m->expects.at[i].lhs);
    vec_push(md->arena, &all, m->expects.at[i].rhs);
  }
  for (uint32_t i = 0; i < md->e->n; i++) vec_push(md->arena, &dynamics, md->e->f[i]);
  for (uint32_t i = 0; i < m->states.n; i++) vec_push(md->arena, &dynamics, md->e->flow[i]);
  for (uint32_t i = 0; i < md->e->mass.n; i++) vec_push(md->arena, &inertia, md->e->mass.at[i].e);
  ExprList nodes[] = {expr_topo(md->g, own.at, own.n), expr_topo(md->g, inertia.at, inertia.n),
                      expr_topo(md->g, all.at, all.n), expr_topo(md->g, dynamics.at, dynamics.n)};
  const unsigned quantities = 1u << SYM_PARAM | 1u << SYM_COORD | 1u << SYM_VEL | 1u << SYM_STATE | 1u << SYM_TIME |
                              1u << SYM_INPUT | 1u << SYM_RATE;
  const unsigned simple = POOL_SYMBOLS | POOL_ANGLES, all_of = simple | POOL_COMPOUNDS;
  FeaturePool pool = {.g = md->g, .barred = contains_a_side, .data = md};
  for (int k = 0; k < 4; k++) pool_nodes(&pool, nodes[k], simple, quantities);
  pool_nodes(&pool, nodes[0], simple, 1u << SYM_ACC); /* may be monomials of the others */
  pool_nodes(&pool, nodes[1], all_of, quantities);
  pool_nodes(&pool, nodes[0], all_of, quantities);
  pool_nodes(&pool, nodes[2], all_of, quantities);
  return features_new(md->g, pool.at, pool.n, md->state);
}

/* --- guesses --- */

static const AstExpr *ast_of(const EditSearch *md, const Site *s) { return ast_expr(md->m->ast, s->node); }

static void guess(EditSearch *md, const Site *s, Expr with, double cost, Span caret, const char *edit) {
  /* Mistakes are likelier on the right side, where formulas stand. */
  Guess one = {.site = s, .with = with, .cost = cost + (s->side ? 0 : 0.05L), .caret = caret, .edit = edit};
  vec_push(md->arena, &md->guesses, one);
}

/* The same, where the text at the caret should be `text`. */
static Guess *guess_text(EditSearch *md, const Site *s, Expr with, double cost, Span at, const char *edit,
                         const char *text) {
  guess(md, s, with, cost, at, edit);
  Guess *last = &md->guesses.at[md->guesses.n - 1];
  last->text = text;
  last->at = at;
  last->after = "";
  return last;
}

/* Whether the values are those of a monomial that is a number. */
static int is_number(const EditSearch *md, const Monomial *m) { return m->e && expr_is_num(md->g, m->e); }

static int begins_with_minus(const EditSearch *md, const Site *s) {
  const AstExpr *x = ast_of(md, s);
  while (ast_is_sum(x->kind) || x->kind == AST_MUL || x->kind == AST_DIV) x = ast_expr(md->m->ast, x->a);
  return x->kind == AST_NEG;
}

static void guess_sign(EditSearch *md, const Site *s, const char *text) {
  if (s->role != SITE_TERM && s->role != SITE_ROOT && s->role != SITE_ARGUMENT) return;
  const AstExpr *up = s->up ? ast_expr(md->m->ast, s->up) : NULL;
  int second = s->role == SITE_TERM && up->b == s->node;
  const char *how = !second               ? "should have the opposite sign"
                    : up->kind == AST_SUB ? "should be added, not subtracted"
                                          : "should be subtracted, not added";
  double cost = COST_SLIP;
  if (!second) cost += begins_with_minus(md, s) ? -0.05 : 0.1; /* a written sign is the likelier mistake */
  if (s->role == SITE_ARGUMENT && cost > COST_SLIP) cost += 0.2; /* -sin(x) before sin(-x) */
  if (ast_is_sum(ast_of(md, s)->kind) && s->role != SITE_TERM) cost += 0.6;
  guess(md, s, expr_neg(md->g, s->value), cost, s->with_op, arena_printf(md->arena, "`%s` %s", text, how));
}

/* A number as written, alone or with a unit. */
static void guess_number(EditSearch *md, const Site *s, const char *text, Expr ratio) {
  const AstExpr *x = ast_of(md, s), *number = x->kind == AST_UNIT ? ast_expr(md->m->ast, x->a) : x;
  if (number->kind != AST_NUM) return;
  Num n = num_mul(expr_number(md->g, ratio), number->number);
  Expr with = expr_mul(md->g, s->value, ratio), shown = expr_num(md->g, n);
  int superfluous = num_is_one(n) && s->role == SITE_FACTOR && x == number;
  if (superfluous) {
    guess(md, s, with, COST_SLIP, s->span, arena_printf(md->arena, "the factor `%s` should not be there", text));
    return;
  }
  Guess *g = guess_text(md, s, with, COST_SLIP + (num_sign(n) < 0), number->span,
                        arena_printf(md->arena, "`%s` should be", text), expr_text(md->g, shown));
  g->caret = s->span;
  if (x != number) g->after = arena_printf(md->arena, " [%s]", x->unit.text);
}

/* The site is a power b^n, or a name or a formula in parentheses, and needs another power of it. */
static void guess_power(EditSearch *md, const Site *s, const char *text, const Need *need) {
  const AstExpr *x = ast_of(md, s), *exponent = x->kind == AST_POW ? ast_expr(md->m->ast, x->b) : NULL;
  if (exponent && exponent->kind != AST_NUM) return;
  Num was = exponent ? exponent->number : num_int(1);
  long double r = logl(fabsl(need->needed[0])) / logl(fabsl(need->written[0]));
  if (!(fabsl(r) < 8)) return;
  Num n = num_mul(was, num_ratio((int64_t)roundl(12 * r), 12));
  for (uint32_t i = 0; i < FEATURE_STATES; i++) {
    long double power = powl(fabsl(need->written[i]), roundl(12 * r) / 12);
    if (!(fabsl(power - fabsl(need->needed[i])) <= 1e-8L * power)) return;
  }
  Expr base = exponent ? edit_node(&md->sites, s->side, x->a) : s->value,
       with = base ? expr_pow_num(md->g, base, n) : 0;
  if (exponent) {
    const char *old = short_text(md->m->ast, exponent->span);
    Expr shown = expr_num(md->g, n);
    if (num_is_one(n))
      guess(md, s, with, COST_SLIP, span_join(x->op_span, exponent->span),
            arena_printf(md->arena, "the exponent `%s` should not be there", old));
    else
      guess_text(md, s, with, COST_SLIP, exponent->span, arena_printf(md->arena, "the exponent `%s` should be", old),
                 expr_text(md->g, shown));
    return;
  }
  int product = s->role == SITE_FACTOR || s->role == SITE_DIVISOR;
  if (product && num_equal(n, num_int(-1))) {
    const char *how = s->role == SITE_FACTOR ? "should divide, not multiply" : "should multiply, not divide";
    guess(md, s, with, COST_INVERSE, s->with_op, arena_printf(md->arena, "`%s` %s", text, how));
  }
  if (s->role == SITE_BASE || num_sign(n) <= 0) return;
  const char *power = expr_text(md->g, expr_num(md->g, n)), *whole = num_is_int(n) ? "^%s" : "^(%s)";
  int alone = x->kind == AST_NAME || x->kind == AST_CALL || x->kind == AST_PRIME || x->kind == AST_MEMBER ||
              x->kind == AST_INDEX || s->span.begin < x->span.begin;
  guess_text(md, s, with, COST_POWER, s->span, arena_printf(md->arena, "`%s` should be", text),
             arena_printf(md->arena, alone ? "%s%s" : "(%s)%s", text, arena_printf(md->arena, whole, power)))
      ->own = alone ? 1 : 2;
}

/* Whether all needed values are `value`, up to rounding. */
static int needs(const Need *need, long double value) {
  for (uint32_t i = 0; i < FEATURE_STATES; i++)
    if (fabsl(need->needed[i] - value) > 1e-9L * fabsl(need->written[i])) return 0;
  return 1;
}

static void guess_removal(EditSearch *md, const Site *s, const char *text, const Need *need) {
  int is_number = ast_of(md, s)->kind == AST_NUM, zero = needs(need, 0);
  if (zero && is_number)
    guess_text(md, s, expr_int(md->g, 0), COST_SLIP, s->span, arena_printf(md->arena, "`%s` should be", text), "0");
  if (zero && s->role == SITE_TERM)
    guess(md, s, expr_int(md->g, 0), COST_EXTRA, s->with_op,
          arena_printf(md->arena, "the term `%s` should not be there", text));
  if (is_number || (s->role != SITE_FACTOR && s->role != SITE_DIVISOR) || !needs(need, 1)) return;
  const char *what = s->role == SITE_FACTOR ? "factor" : "divisor";
  guess(md, s, expr_int(md->g, 1), COST_EXTRA, s->with_op,
        arena_printf(md->arena, "the %s `%s` should not be there", what, text));
}

/* Small differences in cost where the same factor fits in several places: a product goes before a name in it, a term
 * or numerator before the whole side. */
static double cost_of_place(const EditSearch *md, const Site *s) {
  AstKind kind = ast_of(md, s)->kind;
  int compound = ast_is_sum(kind) || kind == AST_MUL || kind == AST_DIV;
  return s->role == SITE_NUMERATOR && !compound ? 0.1 : s->role == SITE_ROOT ? 0.05 : 0;
}

/* A missing factor, unless it is long: one that cancels much of the text and puts other things there is no edit. In
 * x'' = formula the formula lacks it, not x''. */
static void guess_factor(EditSearch *md, const Site *s, const char *text, const Monomial *missing) {
  enum { MOST = 12, MOST_MIXED = 5 };
  int alone = s->role == SITE_ROOT && !s->side && expr_op(md->g, s->value) == EX_SYM, number = is_number(md, missing);
  if (s->role == SITE_FACTOR || alone || missing->size > (missing->mixed ? MOST_MIXED : MOST)) return;
  Expr shown = missing->divisor ? missing->divisor : missing->e;
  const char *what = missing->divisor ? "divisor" : "factor", *formula = expr_text(md->g, shown);
  if (!printed_says(md->m, formula, shown)) return;
  double cost = (number ? COST_SCALE + (expr_number(md->g, missing->e).den == 1 ? 0 : 0.2)
                        : COST_VALUE + COST_FACTOR * missing->size) +
                cost_of_place(md, s);
  guess(md, s, expr_mul(md->g, s->value, missing->e), cost, s->span,
        arena_printf(md->arena, "`%s` lacks the %s `%s`", text, what, formula));
}

static void guess_term(EditSearch *md, const Site *s, const char *text, const Monomial *missing) {
  int is_sum = ast_is_sum(ast_of(md, s)->kind);
  if (!is_sum && s->role == SITE_TERM) return;
  if (!printed_says(md->m, expr_text(md->g, missing->e), missing->e)) return;
  const char *edit = arena_printf(md->arena, "`%s` lacks the term `%s`", text, expr_text(md->g, missing->e));
  guess(md, s, expr_add(md->g, s->value, missing->e), COST_VALUE + COST_FACTOR * missing->size + (is_sum ? 0 : 0.1),
        ast_of(md, s)->span, edit);
}

static void guess_replacement(EditSearch *md, const Site *s, Expr with, double cost, Span caret) {
  const char *was = short_text(md->m->ast, caret);
  guess_text(md, s, with, cost, caret, arena_printf(md->arena, "`%s` should be", was), expr_text(md->g, with));
}

/* The argument of a function, or a single term of it, should be another. */
static void guess_argument(EditSearch *md, const Site *argument, Expr needed) {
  Expr lacking = expr_sub(md->g, needed, argument->value);
  const AstExpr *x = ast_of(md, argument);
  vec_each(const Site, t, md->sites) {
    if (t->side != argument->side || t->role != SITE_TERM || t->node < x->first || t->node > argument->node ||
        !t->value)
      continue;
    const AstExpr *up = ast_expr(md->m->ast, t->up);
    Expr with = up->kind == AST_SUB && up->b == t->node ? expr_sub(md->g, t->value, lacking)
                                                        : expr_add(md->g, t->value, lacking);
    if (!expr_is_zero(md->g, with) && expr_pairs(md->g, with, EX_SUM) == 1)
      guess_replacement(md, t, with, COST_NAME - 0.1, t->span);
  }
  guess_replacement(md, argument, needed, COST_NAME, x->span);
}

static const Site *site_of(const EditSearch *md, AstId node) {
  uint32_t i = 0;
  while (i < md->sites.n && md->sites.at[i].node != node) i++;
  return i < md->sites.n ? &md->sites.at[i] : NULL;
}

/* Another name, another function, or the same function of another argument: the needed value is one quantity. */
static void guess_name(EditSearch *md, const Site *s, Expr needed) {
  const AstExpr *x = ast_of(md, s);
  ExprOp op = expr_op(md->g, needed), was = edit_function(x);
  int is_function = op == EX_SIN || op == EX_COS || op == EX_TAN || op == EX_EXP || op == EX_LOG;
  int name = x->kind == AST_NAME || x->kind == AST_PRIME || x->kind == AST_MEMBER;
  const Site *argument = was == EX_NUM ? NULL : site_of(md, x->args);
  if (argument && op == was) {
    guess_argument(md, argument, expr_arg(md->g, needed, 0));
  } else if (argument && is_function && expr_arg(md->g, needed, 0) == argument->value) {
    guess_replacement(md, s, needed, COST_SLIP, x->span);
  } else if ((argument || name) && (is_function || op == EX_SYM)) {
    int alike = op == EX_SYM && expr_kinds(md->g, s->value) == expr_kinds(md->g, needed);
    guess_replacement(md, s, needed, COST_NAME + (alike ? 0 : 0.1), x->span);
  }
}

/* Where a power needs the same power of one quantity, its base needs that quantity. */
static void guess_names(EditSearch *md, const Site *s, Expr needed) {
  const AstExpr *x = ast_of(md, s);
  Num power = num_int(1);
  Expr one = expr_pairs(md->g, needed, EX_PROD) == 1 ? expr_pair(md->g, needed, EX_PROD, 0, &power) : needed;
  const Site *base = x->kind == AST_POW ? site_of(md, x->a) : NULL;
  const AstExpr *exponent = base ? ast_expr(md->m->ast, x->b) : NULL;
  if (num_is_one(power)) guess_name(md, s, one);
  else if (base && exponent->kind == AST_NUM && num_equal(exponent->number, power)) guess_name(md, base, one);
}

static void guess_at(EditSearch *md, const Site *s, Need *need) {
  if (s->role == SITE_PART || !s->value || edit_replaced(&md->sites, s, s->value) != edit_side(&md->sites, s->side) ||
      !find_need(md, s, need))
    return;
  const char *text = short_text(md->m->ast, s->span);
  Monomial ratio = features_fit(md->features, need->ratio), needed = features_fit(md->features, need->needed);
  Monomial difference = features_fit(md->features, need->difference);
  guess_removal(md, s, text, need);
  guess_power(md, s, text, need);
  if (is_number(md, &ratio) && num_equal(expr_number(md->g, ratio.e), num_int(-1))) guess_sign(md, s, text);
  else if (ratio.e) guess_factor(md, s, text, &ratio);
  if (is_number(md, &ratio)) guess_number(md, s, text, ratio.e);
  if (needed.e) guess_names(md, s, needed.e);
  if (difference.e) guess_term(md, s, text, &difference);
}

/* --- the search --- */

/* Whether the formula is too long: with a tape for every place, the work grows with its square. */
static int is_too_large(const EditSearch *md) {
  enum { PLACES_MAX = 2000, STEPS_MAX = 1000000 };
  Expr sides[2] = {md->x->lhs, md->x->rhs};
  return md->sites.n > PLACES_MAX || (uint64_t)md->sites.n * expr_topo(md->g, sides, 2).n > STEPS_MAX;
}

static int by_cost(const void *a, const void *b) {
  const Guess *x = a, *y = b;
  if (x->cost != y->cost) return x->cost < y->cost ? -1 : 1;
  uint32_t wide_x = x->caret.end - x->caret.begin, wide_y = y->caret.end - y->caret.begin;
  if (wide_x != wide_y) return wide_x < wide_y ? -1 : 1;
  return (x->caret.begin > y->caret.begin) - (x->caret.begin < y->caret.begin);
}

static int guess_is_proved(EditSearch *md, const Guess *guess) {
  const Site *s = guess->site;
  Expr side = edit_replaced(&md->sites, s, guess->with);
  return side && prove_by_motion(md->e, s->side ? md->x->lhs : side, s->side ? side : md->x->rhs) == PROVED_ZERO;
}

/* --- the text as pasted --- */

/* A side with an edit; offsets into its new text. */
typedef struct {
  const EditSearch *md;
  const Guess *guess;
  const AstExpr *side;  /* its root, as written */
  AstId root;
  uint32_t begin, end;  /* the new text */
  uint32_t was;         /* end of the old one */
  uint32_t own, own_end; /* the site's own text within the new one; 0: none */
} Paste;

/* Value as written of the node of this kind and place; 0: none. */
static AstId written_node(const Paste *p, AstKind kind, uint32_t begin, uint32_t end) {
  const Ast *ast = p->md->m->ast;
  for (AstId id = p->side->first; id <= p->root; id++) {
    const AstExpr *x = ast_expr(ast, id);
    if (x->kind == kind && x->span.begin - p->side->span.begin == begin && x->span.end - p->side->span.begin == end)
      return id;
  }
  return 0;
}

/* Whether the node is a number, or a fraction of two. */
static int is_number_text(const Ast *ast, AstId id, Num *n) {
  int minus = ast_expr(ast, id)->kind == AST_NEG;
  const AstExpr *x = ast_expr(ast, minus ? ast_expr(ast, id)->a : id),
                *top = x->kind == AST_DIV ? ast_expr(ast, x->a) : x;
  const AstExpr *below = x->kind == AST_DIV ? ast_expr(ast, x->b) : NULL;
  int negative = top->kind == AST_NEG;
  if (negative) top = ast_expr(ast, top->a);
  if (top->kind != AST_NUM || (below && (below->kind != AST_NUM || num_is_zero(below->number)))) return 0;
  *n = below ? num_div(top->number, below->number) : top->number;
  if (minus != negative) *n = num_neg(*n);
  return 1;
}

/* Nodes beside the edit have their values; so has the site's own text within it; a number before a unit has the
 * unit's scale. */
static Expr known_part(const void *data, const Ast *ast, const AstExpr *x, uint32_t begin, uint32_t end) {
  const Paste *p = data;
  ExprGraph *g = p->md->g;
  const int side = p->guess->site->side;
  uint32_t shift = p->end - p->was; /* may wrap: added and subtracted alike */
  if (p->own && begin == p->own && end == p->own_end) return p->guess->site->value;
  Num n;
  int beside = end <= p->begin || begin >= p->end, number = x->kind == AST_UNIT && is_number_text(ast, x->a, &n);
  if (!beside && !number) return 0;
  AstId id = written_node(p, x->kind, begin >= p->end ? begin - shift : begin, end > p->begin ? end - shift : end);
  if (!id || beside) return id ? edit_node(&p->md->sites, side, id) : 0;
  Expr was = edit_node(&p->md->sites, side, id),
       before = edit_node(&p->md->sites, side, ast_expr(p->md->m->ast, id)->a);
  if (!was || !before || expr_is_zero(g, before)) return 0;
  Expr scale = expr_div(g, was, before);
  return expr_mul(g, expr_num(g, n), scale);
}

/* Whether the expectation is proved as it reads with `text` in its place. */
static int pasted_is_proved(EditSearch *md, const Guess *guess, const char *text, uint32_t own) {
  int right = guess->site->side;
  AstId root = right ? md->x->rhs_ast : md->x->lhs_ast;
  const AstExpr *x = ast_expr(md->m->ast, root);
  const Source *file = source_place(md->m->ast->sources, x->span.begin).file;
  if (!file || guess->at.begin < x->span.begin || guess->at.end > x->span.end) return 0;
  StrBuf b = strbuf(md->arena);
  sb_putn(&b, file->text + (x->span.begin - file->base), guess->at.begin - x->span.begin);
  Paste p = {
      .md = md, .guess = guess, .side = x, .root = root, .begin = (uint32_t)b.n, .was = guess->at.end - x->span.begin};
  sb_puts(&b, text);
  p.end = (uint32_t)b.n;
  if (own) p.own = p.begin + own - 1, p.own_end = p.own + (guess->site->span.end - guess->site->span.begin);
  if (own && text[own - 1] == '(') p.own++, p.own_end--; /* nodes have no parentheses */
  sb_putn(&b, file->text + (guess->at.end - file->base), x->span.end - guess->at.end);
  for (char *s = b.at, *end = b.at + b.n; s < end; s++) /* comments and ends of lines */
    if (*s == '#') while (s < end && *s != '\n') *s++ = ' ';
    else if (*s == '\n' || *s == '\r') *s = ' ';
  Expr value = printed_value(md->m, sb_text(&b), guess->with, known_part, &p);
  return value && prove_by_motion(md->e, right ? md->x->lhs : value, right ? value : md->x->rhs) == PROVED_ZERO;
}

/* The sentence of a guess that is proved, with parentheses around the new text where its place needs them; NULL: the
 * text would say something else. */
static const char *proved_sentence(EditSearch *md, const Guess *guess) {
  if (!guess_is_proved(md, guess)) return NULL;
  if (!guess->text) return guess->edit;
  const char *text = guess->text;
  if (!pasted_is_proved(md, guess, text, guess->own)) {
    text = arena_printf(md->arena, "(%s)", text);
    if (!pasted_is_proved(md, guess, text, guess->own ? guess->own + 1 : 0)) return NULL;
  }
  return arena_printf(md->arena, "%s `%s%s`", guess->edit, text, guess->after);
}

SuggestedEdit suggest_correction(const Eqns *e, const Expect *x) {
  enum { PROOFS = 12 };
  const Model *m = e->m;
  SuggestedEdit nowhere = {.caret = ast_expr(m->ast, x->rhs_ast)->span};
  if (!x->nodes[0]) return nowhere;
  EditSearch md = {.e = e, .m = m, .x = x, .g = e->g, .arena = m->arena, .sites = mutation_sites_of(m, x)};
  Name name = intern(m->ast->names, "?");
  md.stand_in = expr_declare(e->g, SYM_LOCAL, 0, name, SIGN_UNKNOWN);
  if (is_too_large(&md) || !find_states(&md)) return nowhere;
  md.features = gather_features(&md);
  Need *need = ARENA_NEW(md.arena, Need);
  for (uint32_t i = 0; i < md.sites.n; i++) guess_at(&md, &md.sites.at[i], need);
  const Guess *guesses = md.guesses.at;
  if (md.guesses.n) qsort(md.guesses.at, md.guesses.n, sizeof *guesses, by_cost);
  for (uint32_t i = 0; i < md.guesses.n && i < PROOFS; i++) {
    const char *sentence = proved_sentence(&md, &guesses[i]);
    if (sentence) return (SuggestedEdit){guesses[i].caret, sentence};
  }
  return nowhere;
}
