/* Edits of what is written at one place; each is tried by its value at a few states. */
#include <math.h>
#include <stdlib.h>

#include "claims/suggest_correction_impl.h"

/* Costs of edits: slips of the pen first, then larger changes. */
#define COST_SLIP 1.0
#define COST_POWER 1.2
#define COST_EXTRA 1.5  /* a superfluous term, factor or divisor */
#define COST_INVERSE 1.6
#define COST_FUNCTION 1.7
#define COST_NAME 1.8
#define COST_SCALE 2.0
#define COST_ARGUMENT 2.4

static int is_name_like(const Spot *p) {
  return p->ast->kind == AST_NAME || p->ast->kind == AST_PRIME || p->ast->kind == AST_CALL || p->ast->kind == AST_MEMBER;
}

static const Spot *spot_of(const EditSearch *md, AstId node) {
  for (uint32_t i = 0; i < md->nspots; i++)
    if (md->spots[i].site->node == node) return &md->spots[i];
  return NULL;
}

/* --- signs --- */

static int begins_with_minus(const EditSearch *md, const Site *s) {
  const AstExpr *x = ast_expr(md->m->ast, s->node);
  while (x->kind == AST_ADD || x->kind == AST_SUB || x->kind == AST_MUL || x->kind == AST_DIV) x = ast_expr(md->m->ast, x->a);
  return x->kind == AST_NEG;
}

static void try_sign(EditSearch *md, Spot *p) {
  const Site *s = p->site;
  if (s->role != SITE_TERM && s->role != SITE_ROOT && s->role != SITE_ARGUMENT) return;
  long double v[FEW];
  for (int i = 0; i < FEW; i++) v[i] = -p->written[i];
  if (p->ast->kind == AST_NUM && p->written[0] == 0) return;
  if (!edit_holds(md, p, v)) return;
  const AstExpr *up = s->up ? ast_expr(md->m->ast, s->up) : NULL;
  int second = s->role == SITE_TERM && up->b == s->node;
  const char *how = !second ? "should have the opposite sign" : up->kind == AST_SUB ? "should be added, not subtracted" : "should be subtracted, not added";
  Expr with = expr_neg(md->g, p->value);
  double cost = COST_SLIP;
  if (!second) cost += begins_with_minus(md, s) ? -0.05 : 0.1; /* a written sign is the likelier mistake */
  if (s->role == SITE_ARGUMENT && cost > COST_SLIP) cost += 0.2; /* -sin(x) before sin(-x) */
  if (site_is_sum(md->m, s) && s->role != SITE_TERM) cost += 0.6;
  edit_guess(md, p, with, cost, s->with_op, arena_printf(md->arena, "`%s` %s", edit_spot_text(md, p), how));
}

/* --- numbers --- */

/* The number written at a place, alone or with a unit. */
static const AstExpr *number_at(const EditSearch *md, const Spot *p) {
  const AstExpr *x = p->ast->kind == AST_UNIT ? ast_expr(md->m->ast, p->ast->a) : p->ast;
  return x->kind == AST_NUM && num_is_exact(x->number) && !num_is_zero(x->number) ? x : NULL;
}

static void try_number(EditSearch *md, Spot *p, Num was, Num n) {
  if (num_equal(n, was)) return;
  Num ratio = num_div(n, was);
  long double v[FEW];
  for (int i = 0; i < FEW; i++) v[i] = p->written[i] * (long double)num_value(ratio);
  if (!edit_holds(md, p, v)) return;
  const char *text = edit_spot_text(md, p);
  Expr with = expr_scale(md->g, ratio, p->value), number = expr_num(md->g, n);
  const char *edit, *n_text = edit_expr_text(md, number);
  if (p->ast->kind == AST_UNIT) edit = arena_printf(md->arena, "`%s` should be `%s [%s]`", text, n_text, p->ast->unit.text);
  else if (num_is_one(n) && p->site->role == SITE_FACTOR) edit = arena_printf(md->arena, "the factor `%s` should not be there", text);
  else edit = arena_printf(md->arena, "`%s` should be `%s`", text, n_text);
  edit_guess(md, p, with, COST_SLIP, p->site->span, edit);
}

static void try_numbers(EditSearch *md, Spot *p) {
  const AstExpr *x = number_at(md, p);
  if (!x) return;
  Num n = x->number, two = num_int(2), one = num_int(1);
  Num near[] = {num_add(n, one), num_sub(n, one), num_mul(n, two), num_div(n, two)};
  for (int i = 1; i <= 9; i++) try_number(md, p, n, num_int(i));
  for (int i = 2; i <= 6; i++) try_number(md, p, n, num_ratio(1, i));
  for (int i = 0; i < 4; i++)
    if (num_cmp(near[i], num_int(9)) > 0 || num_cmp(near[i], one) < 0) try_number(md, p, n, near[i]);
}

static void try_scales(EditSearch *md, Spot *p) {
  SiteRole role = p->site->role;
  if (role == SITE_FACTOR || role == SITE_PART || p->ast->kind == AST_NUM) return;
  static const int ratios[][2] = {{2, 1}, {3, 1}, {4, 1}, {1, 2}, {1, 3}, {1, 4}, {3, 2}, {2, 3}};
  for (size_t k = 0; k < sizeof ratios / sizeof *ratios; k++) {
    Num c = num_ratio(ratios[k][0], ratios[k][1]);
    long double v[FEW];
    for (int i = 0; i < FEW; i++) v[i] = p->written[i] * ratios[k][0] / ratios[k][1];
    if (!edit_holds(md, p, v)) continue;
    Expr with = expr_scale(md->g, c, p->value), factor = expr_num(md->g, c);
    double cost = COST_SCALE + (ratios[k][1] > 1 ? 0.2 : 0) + edit_product_cost(md, p);
    const char *edit = arena_printf(md->arena, "`%s` lacks the factor `%s`", edit_spot_text(md, p), edit_expr_text(md, factor));
    edit_guess(md, p, with, cost, p->site->span, edit);
  }
}

/* --- exponents --- */

static void try_exponent(EditSearch *md, Spot *p, const Spot *base, Num n) {
  const AstExpr *exponent = ast_expr(md->m->ast, p->ast->b);
  if (num_equal(n, exponent->number)) return;
  long double v[FEW];
  for (int i = 0; i < FEW; i++) v[i] = powl(base->written[i], (long double)num_value(n));
  if (!edit_holds(md, p, v)) return;
  Expr with = expr_pow_num(md->g, base->value, n), number = expr_num(md->g, n);
  const char *text = span_text(md->m, exponent->span);
  const char *edit = num_is_one(n) ? arena_printf(md->arena, "the exponent `%s` should not be there", text)
                                   : arena_printf(md->arena, "the exponent `%s` should be `%s`", text, edit_expr_text(md, number));
  edit_guess(md, p, with, COST_SLIP, num_is_one(n) ? span_join(p->ast->op_span, exponent->span) : exponent->span, edit);
}

static void try_exponents(EditSearch *md, Spot *p) {
  if (p->ast->kind != AST_POW) return;
  const AstExpr *exponent = ast_expr(md->m->ast, p->ast->b);
  const Spot *base = spot_of(md, p->ast->a);
  if (exponent->kind != AST_NUM || !base || !base->value) return;
  for (int i = -4; i <= 6; i++)
    if (i) try_exponent(md, p, base, num_int(i));
  try_exponent(md, p, base, num_ratio(1, 2));
  try_exponent(md, p, base, num_ratio(3, 2));
}

static void try_missing_power(EditSearch *md, Spot *p) {
  int closed = p->site->span.begin < p->ast->span.begin; /* in parentheses */
  if (p->site->role == SITE_BASE || (!is_name_like(p) && !closed)) return;
  for (int n = 2; n <= 3; n++) {
    long double v[FEW];
    for (int i = 0; i < FEW; i++) v[i] = powl(p->written[i], n);
    if (!edit_holds(md, p, v)) continue;
    Expr with = expr_pow_num(md->g, p->value, num_int(n));
    const char *text = edit_spot_text(md, p);
    edit_guess(md, p, with, COST_POWER, p->site->span, arena_printf(md->arena, "`%s` should be `%s^%d`", text, text, n));
  }
}

/* --- functions --- */

typedef long double Function(long double);

static const struct {
  const char *name;
  ExprOp op;
  Function *value;
  int family; /* functions often taken for one another */
} functions[] = {
  {"sin", EX_SIN, sinl, 1}, {"cos", EX_COS, cosl, 1}, {"tan", EX_TAN, tanl, 1},
  {"sinh", EX_SINH, sinhl, 1}, {"cosh", EX_COSH, coshl, 1}, {"tanh", EX_TANH, tanhl, 1},
  {"asin", EX_ASIN, asinl, 2}, {"acos", EX_ACOS, acosl, 2}, {"atan", EX_ATAN, atanl, 2},
  {"exp", EX_EXP, expl, 3}, {"log", EX_LOG, logl, 3},
};
enum { NFUNCTIONS = sizeof functions / sizeof *functions };

static int function_index(const AstExpr *x) {
  if (x->kind != AST_CALL || !x->args) return -1;
  for (int k = 0; k < NFUNCTIONS; k++)
    if (strcmp(x->name, functions[k].name) == 0) return k;
  return -1;
}

static void try_functions(EditSearch *md, Spot *p) {
  int is = function_index(p->ast);
  const Spot *arg = is < 0 ? NULL : spot_of(md, p->ast->args);
  if (!arg || !arg->value) return;
  for (int k = 0; k < NFUNCTIONS; k++) {
    if (k == is || functions[k].family != functions[is].family) continue;
    long double v[FEW];
    for (int i = 0; i < FEW; i++) v[i] = functions[k].value(arg->written[i]);
    if (!edit_holds(md, p, v)) continue;
    Expr with = expr_fn(md->g, functions[k].op, arg->value);
    const char *text = span_text(md->m, arg->site->span);
    const char *edit = arena_printf(md->arena, "`%s` should be `%s(%s)`", edit_spot_text(md, p), functions[k].name, text);
    edit_guess(md, p, with, COST_SLIP, p->ast->span, edit);
  }
}

/* th for sin(th), and sin(th) for th. */
static void try_small_angle(EditSearch *md, Spot *p) {
  int is = function_index(p->ast);
  const Spot *arg = is < 0 ? NULL : spot_of(md, p->ast->args);
  const char *text = edit_spot_text(md, p);
  if (arg && arg->value && edit_holds(md, p, arg->written)) {
    const char *edit = arena_printf(md->arena, "`%s` should be `%s`", text, span_text(md->m, arg->site->span));
    edit_guess(md, p, arg->value, COST_FUNCTION, p->ast->span, edit);
  }
  for (int k = 0; k < NFUNCTIONS && is_name_like(p); k++) {
    if (functions[k].family != 1) continue;
    long double v[FEW];
    for (int i = 0; i < FEW; i++) v[i] = functions[k].value(p->written[i]);
    if (!edit_holds(md, p, v)) continue;
    Expr with = expr_fn(md->g, functions[k].op, p->value);
    const char *edit = arena_printf(md->arena, "`%s` should be `%s(%s)`", text, functions[k].name, text);
    edit_guess(md, p, with, COST_FUNCTION, p->ast->span, edit);
  }
}

/* --- arguments of sines and cosines --- */

/* Guesses at a single term of the argument, where changing it makes up the difference. */
static void guess_term_of(EditSearch *md, const Spot *argument, Expr with, double cost) {
  Expr lacking = expr_sub(md->g, with, argument->value);
  for (uint32_t i = 0; i < md->nspots; i++) {
    const Spot *p = &md->spots[i];
    AstId first = argument->ast->first, last = argument->site->node;
    if (p->site->role != SITE_TERM || p->site->node < first || p->site->node > last || !p->value) continue;
    const AstExpr *up = ast_expr(md->m->ast, p->site->up);
    int subtracted = up->kind == AST_SUB && up->b == p->site->node;
    Expr needed = subtracted ? expr_sub(md->g, p->value, lacking) : expr_add(md->g, p->value, lacking);
    if (expr_is_zero(md->g, needed) || expr_pairs(md->g, needed, EX_SUM) != 1) continue;
    const char *edit = arena_printf(md->arena, "`%s` should be `%s`", edit_spot_text(md, p), edit_expr_text(md, needed));
    edit_guess(md, p, needed, cost - 0.2, p->site->span, edit);
  }
}

static void try_argument(EditSearch *md, Spot *p, Expr with, const long double *v, double cost) {
  if (with == p->value || !edit_holds(md, p, v)) return;
  guess_term_of(md, p, with, cost);
  const char *edit = arena_printf(md->arena, "`%s` should be `%s`", edit_spot_text(md, p), edit_expr_text(md, with));
  edit_guess(md, p, with, cost, p->ast->span, edit);
}

/* a*q + b*r */
static void try_combination(EditSearch *md, Spot *p, SymId q, SymId r, int a, int b) {
  long double v[FEW];
  for (uint32_t i = 0; i < FEW; i++) v[i] = a * md->state[i][q] + b * md->state[i][r];
  Expr left = expr_scale(md->g, num_int(a), expr_symbol(md->g, q)->node);
  Expr right = expr_scale(md->g, num_int(b), expr_symbol(md->g, r)->node);
  Expr with = expr_add(md->g, left, right);
  try_argument(md, p, with, v, COST_ARGUMENT + 0.02 * (abs(a) + abs(b)));
}

/* The coordinates in the expectation, at most `most`. Returns their number. */
static uint32_t coordinates_used(const EditSearch *md, SymId *out, uint32_t most) {
  uint32_t n = 0;
  Expr both = expr_sub(md->g, md->x->lhs, md->x->rhs);
  for (uint32_t i = 0; i < md->m->coords.n && n < most; i++) {
    const Coord *c = &md->m->coords.at[i];
    if (expr_contains_sym(md->g, both, c->q)) out[n++] = c->q;
  }
  return n;
}

static void try_arguments(EditSearch *md, Spot *p) {
  enum { COORDINATES = 5, LARGEST = 3 };
  if (p->site->role != SITE_ARGUMENT) return;
  int f = function_index(ast_expr(md->m->ast, p->site->up));
  if (f < 0 || functions[f].family != 1) return;
  SymId q[COORDINATES];
  uint32_t n = coordinates_used(md, q, COORDINATES);
  for (uint32_t i = 0; i < n; i++)
    for (int a = -LARGEST; a <= LARGEST; a++) {
      if (a == 0) continue;
      try_combination(md, p, q[i], q[i], a, 0);
      for (uint32_t k = i + 1; k < n; k++)
        for (int b = -LARGEST; b <= LARGEST; b++)
          if (b) try_combination(md, p, q[i], q[k], a, b);
    }
}

/* --- superfluous terms and factors --- */

static void try_extra_term(EditSearch *md, Spot *p) {
  static const long double zero[FEW] = {0};
  if (p->site->role != SITE_TERM || !edit_holds(md, p, zero)) return;
  const char *edit = arena_printf(md->arena, "the term `%s` should not be there", edit_spot_text(md, p));
  edit_guess(md, p, expr_int(md->g, 0), COST_EXTRA, p->site->with_op, edit);
}

static void try_extra_factor(EditSearch *md, Spot *p) {
  static const long double one[FEW] = {1, 1, 1, 1};
  SiteRole role = p->site->role;
  if ((role != SITE_FACTOR && role != SITE_DIVISOR) || p->ast->kind == AST_NUM || !edit_holds(md, p, one)) return;
  const char *what = role == SITE_FACTOR ? "factor" : "divisor";
  const char *edit = arena_printf(md->arena, "the %s `%s` should not be there", what, edit_spot_text(md, p));
  edit_guess(md, p, expr_int(md->g, 1), COST_EXTRA, p->site->with_op, edit);
}

static void try_inverse(EditSearch *md, Spot *p) {
  SiteRole role = p->site->role;
  if (role != SITE_FACTOR && role != SITE_DIVISOR) return;
  long double v[FEW];
  for (int i = 0; i < FEW; i++) v[i] = 1 / p->written[i];
  if (!edit_holds(md, p, v)) return;
  Expr with = expr_pow_num(md->g, p->value, num_int(-1));
  const char *how = role == SITE_FACTOR ? "should divide, not multiply" : "should multiply, not divide";
  edit_guess(md, p, with, COST_INVERSE, p->site->with_op, arena_printf(md->arena, "`%s` %s", edit_spot_text(md, p), how));
}

/* --- names --- */

/* Whether s may have been meant: it is of the same kind, or the same coordinate with more or fewer primes. */
static int may_be_meant(const Symbol *was, const Symbol *s) {
  if (s == was) return 0;
  int was_motion = was->kind == SYM_COORD || was->kind == SYM_VEL || was->kind == SYM_ACC;
  int motion = s->kind == SYM_COORD || s->kind == SYM_VEL || s->kind == SYM_ACC;
  return s->kind == was->kind || (motion && was_motion && s->index == was->index);
}

static void try_names(EditSearch *md, Spot *p) {
  enum { MOST = 200 };
  if (p->ast->kind == AST_CALL || !is_name_like(p) || expr_op(md->g, p->value) != EX_SYM) return;
  const Symbol *was = expr_sym_of(md->g, p->value);
  if (was->kind == SYM_LOCAL) return;
  uint32_t count = expr_symbol_count(md->g) < MOST ? expr_symbol_count(md->g) : MOST;
  for (SymId s = 1; s <= count; s++) {
    const Symbol *sym = expr_symbol(md->g, s);
    if (!may_be_meant(was, sym)) continue;
    long double v[FEW];
    for (uint32_t i = 0; i < FEW; i++) v[i] = md->state[i][s];
    if (!edit_holds(md, p, v)) continue;
    const char *edit = arena_printf(md->arena, "`%s` should be `%s`", edit_spot_text(md, p), sym->name);
    edit_guess(md, p, sym->node, COST_NAME, p->ast->span, edit);
  }
}

void guess_local_edits(EditSearch *md) {
  for (uint32_t i = 0; i < md->nspots; i++) {
    Spot *p = &md->spots[i];
    if (!p->tape) continue;
    try_sign(md, p);
    try_numbers(md, p);
    try_scales(md, p);
    try_exponents(md, p);
    try_missing_power(md, p);
    try_functions(md, p);
    try_small_angle(md, p);
    try_arguments(md, p);
    try_extra_term(md, p);
    try_extra_factor(md, p);
    try_inverse(md, p);
    try_names(md, p);
  }
}
