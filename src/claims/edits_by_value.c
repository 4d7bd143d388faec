/* Edits from the value that a place needs for the equation to hold: its difference from, or ratio to, the written value, recognised as a monomial,
 * is the missing term or factor. */
#include <math.h>

#include "claims/suggest_correction_impl.h"

#define COST_VALUE 3.0
#define COST_FACTOR 0.25 /* each factor of the missing monomial */

/* --- the needed value --- */

/* The root of the function x -> (x - r)/(c x + d) through three points: exact where the equation is
 * linear in the place, or a quotient of linear functions of it (Jarratt and Nudds 1965,
 * DOI 10.1093/comjnl/8.1.62). */
static long double next_guess(const long double *x, const long double *f) {
  long double y0 = x[0] - x[2], y1 = x[1] - x[2];
  long double det = f[0] * y0 * (f[1] - f[2]) - f[1] * y1 * (f[0] - f[2]);
  return x[2] - f[2] * y0 * y1 * (f[0] - f[1]) / det;
}

/* The value at the place for which the equation holds at a state; NAN: the iteration does not converge. */
static long double needed_value(EditSearch *md, Spot *p, uint32_t state, long double written) {
  enum { STEPS = 12 };
  long double step = 0.1L * fabsl(written) + 0.01L;
  long double x[3] = {written, written + step, written - step}, f[3];
  for (int i = 0; i < 3; i++) f[i] = edit_residual(md, p, state, x[i]);
  for (int k = 0; k < STEPS; k++) {
    long double next = next_guess(x, f);
    if (!isfinite(next)) return NAN;
    long double r = edit_residual(md, p, state, next);
    if (fabsl(r) <= 1e-11L * fabsl(md->residual[state])) return next;
    for (int i = 0; i < 2; i++) x[i] = x[i + 1], f[i] = f[i + 1];
    x[2] = next, f[2] = r;
  }
  return NAN;
}

typedef struct {
  long double needed[FEATURE_STATES], written[FEATURE_STATES], difference[FEATURE_STATES], ratio[FEATURE_STATES];
} Need;

static int find_need(EditSearch *md, Spot *p, EvalTape *value, Need *need) {
  for (uint32_t i = 0; i < FEATURE_STATES; i++) {
    eval_run(value, md->state[i], &need->written[i]);
    need->needed[i] = needed_value(md, p, i, need->written[i]);
    if (!isfinite(need->needed[i])) return 0;
    need->difference[i] = need->needed[i] - need->written[i];
    need->ratio[i] = need->needed[i] / need->written[i];
    /* the difference is rounding */
    if (fabsl(need->difference[i]) < 1e-12L * fabsl(need->written[i])) return 0;
  }
  return 1;
}

/* --- features --- */

typedef struct {
  Expr at[FEATURES_MAX];
  uint32_t n;
} Pool;

static void pool_add(Pool *pool, Expr e) {
  if (pool->n == FEATURES_MAX) return;
  for (uint32_t i = 0; i < pool->n; i++)
    if (pool->at[i] == e) return;
  pool->at[pool->n++] = e;
}

static int is_quantity(const Symbol *s) {
  return s->kind == SYM_PARAM || s->kind == SYM_COORD || s->kind == SYM_VEL || s->kind == SYM_STATE || s->kind == SYM_TIME ||
         s->kind == SYM_INPUT || s->kind == SYM_ACC || s->kind == SYM_RATE;
}

/* Whether e is a whole side: it may not correct the other, or any x'' = formula could become x'' = x''. */
static int is_a_side(const EditSearch *md, Expr e) { return e == md->x->lhs || e == md->x->rhs; }

static int contains_a_side(EditSearch *md, Expr e) {
  for (int right = 0; right < 2; right++) {
    Expr side = right ? md->x->rhs : md->x->lhs;
    if (expr_op(md->g, side) == EX_SYM && expr_contains_sym(md->g, e, expr_sym_id(md->g, side))) return 1;
  }
  return 0;
}

static void pool_symbols(Pool *pool, EditSearch *md, ExprList nodes, int accelerations) {
  for (uint32_t i = 0; i < nodes.n; i++) {
    Expr e = nodes.at[i];
    if (expr_op(md->g, e) != EX_SYM || is_a_side(md, e)) continue;
    const Symbol *s = expr_sym_of(md->g, e);
    if (is_quantity(s) && (accelerations || s->kind != SYM_ACC)) pool_add(pool, e);
  }
}

static void pool_angles(Pool *pool, EditSearch *md, ExprList nodes) {
  for (uint32_t i = 0; i < nodes.n; i++) {
    ExprOp op = expr_op(md->g, nodes.at[i]);
    if (op != EX_SIN && op != EX_COS) continue;
    Expr arg = expr_arg(md->g, nodes.at[i], 0);
    Expr sine = expr_fn(md->g, EX_SIN, arg), cosine = expr_fn(md->g, EX_COS, arg);
    pool_add(pool, sine);
    pool_add(pool, cosine);
  }
}

/* Functions and sums in the model's expectations: a missing factor often stands elsewhere, too. */
static void pool_compounds(Pool *pool, EditSearch *md, ExprList nodes) {
  for (uint32_t i = 0; i < nodes.n; i++) {
    ExprOp op = expr_op(md->g, nodes.at[i]);
    int compound = op == EX_SUM || op == EX_HYPOT || op == EX_EXP || op == EX_TAN || op == EX_LOG;
    if (compound && !is_a_side(md, nodes.at[i]) && !contains_a_side(md, nodes.at[i])) pool_add(pool, nodes.at[i]);
  }
}

/* Quantities that a missing term or factor may be made of; simple ones first. */
static Features *gather_features(EditSearch *md) {
  const Model *m = md->m;
  VEC(Expr) own = {0}, all = {0};
  vec_push(md->arena, &own, md->x->lhs);
  vec_push(md->arena, &own, md->x->rhs);
  for (uint32_t i = 0; i < m->expects.n; i++) {
    vec_push(md->arena, &all, m->expects.at[i].lhs);
    vec_push(md->arena, &all, m->expects.at[i].rhs);
  }
  VEC(Expr) wide = {0}, inertia = {0};
  for (uint32_t i = 0; i < md->e->n; i++) vec_push(md->arena, &wide, md->e->f[i]);
  for (uint32_t i = 0; i < md->e->mass.n; i++) vec_push(md->arena, &inertia, md->e->mass.at[i].e);
  for (uint32_t i = 0; i < m->states.n; i++) vec_push(md->arena, &wide, md->e->flow[i]);
  ExprList mine = expr_topo(md->g, own.at, own.n), others = expr_topo(md->g, all.at, all.n);
  ExprList dynamics = expr_topo(md->g, wide.at, wide.n), masses = expr_topo(md->g, inertia.at, inertia.n);
  Pool pool = {.n = 0};
  pool_symbols(&pool, md, mine, 1);
  pool_angles(&pool, md, mine);
  pool_symbols(&pool, md, others, 0);
  pool_symbols(&pool, md, dynamics, 0);
  pool_symbols(&pool, md, masses, 0);
  pool_angles(&pool, md, others);
  pool_angles(&pool, md, dynamics);
  pool_compounds(&pool, md, masses);
  pool_compounds(&pool, md, mine);
  pool_compounds(&pool, md, others);
  return features_new(md->g, pool.at, pool.n, md->state);
}

/* --- guesses --- */

/* Whether a place may lack a term: it is a whole sum, or no term of one. */
static int may_lack_term(const EditSearch *md, const Site *s) {
  return s->role != SITE_PART && (site_is_sum(md->m, s) || s->role != SITE_TERM);
}

/* Whether a place may lack a factor: in x'' = formula the formula does, not x''. */
static int may_lack_factor(const EditSearch *md, const Spot *p) {
  SiteRole role = p->site->role;
  int alone = role == SITE_ROOT && p->site->left && expr_op(md->g, p->value) == EX_SYM;
  return role != SITE_PART && role != SITE_FACTOR && !alone;
}

static void guess_term(EditSearch *md, const Spot *p, Monomial missing) {
  Expr with = expr_add(md->g, p->value, missing.e);
  const char *edit = arena_printf(md->arena, "`%s` lacks the term `%s`", edit_spot_text(md, p), edit_expr_text(md, missing.e));
  double cost = COST_VALUE + COST_FACTOR * missing.size + (site_is_sum(md->m, p->site) ? 0 : 0.1);
  edit_guess(md, p, with, cost, p->ast->span, edit);
}

/* Guesses a missing factor, unless it is long: one that cancels much of the text and puts other things there is no edit. */
static void guess_factor(EditSearch *md, const Spot *p, Monomial missing) {
  enum { MOST = 12, MOST_MIXED = 5 };
  if (missing.size > (missing.mixed ? MOST_MIXED : MOST)) return;
  Expr with = expr_mul(md->g, p->value, missing.e);
  const char *what = missing.divisor ? "divisor" : "factor", *formula = edit_expr_text(md, missing.divisor ? missing.divisor : missing.e);
  const char *edit = arena_printf(md->arena, "`%s` lacks the %s `%s`", edit_spot_text(md, p), what, formula);
  double cost = COST_VALUE + COST_FACTOR * missing.size + edit_product_cost(md, p);
  edit_guess(md, p, with, cost, p->ast->span, edit);
}

static void guess_number(EditSearch *md, const Spot *p, Monomial needed) {
  if (p->ast->kind != AST_NUM || !expr_is_num(md->g, needed.e)) return;
  const char *edit = arena_printf(md->arena, "`%s` should be `%s`", edit_spot_text(md, p), edit_expr_text(md, needed.e));
  edit_guess(md, p, needed.e, 1, p->ast->span, edit);
}

static void guess_at(EditSearch *md, Spot *p, const Features *f) {
  Need *need = ARENA_NEW(md->arena, Need);
  if (!find_need(md, p, eval_tape(md->g, &p->value, 1), need)) return;
  if (p->ast->kind == AST_NUM) {
    Monomial m = features_fit(f, need->needed);
    if (m.e) guess_number(md, p, m);
  }
  if (may_lack_factor(md, p)) {
    Monomial m = features_fit(f, need->ratio);
    if (m.e) guess_factor(md, p, m);
  }
  if (may_lack_term(md, p->site)) {
    Monomial m = features_fit(f, need->difference);
    if (m.e) guess_term(md, p, m);
  }
}

void guess_edits_by_value(EditSearch *md) {
  Features *f = gather_features(md);
  for (uint32_t i = 0; i < md->nspots; i++)
    if (md->spots[i].tape) guess_at(md, &md->spots[i], f);
}

/* --- the likeliest place --- */

/* States at which one quantity in turn is changed, to count those that the correction of a place depends on. */
typedef struct {
  SymId symbol[64];
  uint32_t nsymbols;
  long double *base;       /* the state to start from */
  long double *moved[64];  /* base with one symbol changed */
} Probe;

static int changes(long double a, long double b) { return fabsl(a - b) > 1e-9L * (fabsl(a) + fabsl(b)); }

static long double *moved_state(EditSearch *md, const long double *base, SymId s) {
  uint32_t count = expr_symbol_count(md->g) + 1;
  long double *state = ARENA_ARRAY(md->arena, long double, count);
  memcpy(state, base, count * sizeof *state);
  if (s) state[s] *= 1.0625L;
  return states_complete(md->solver, state) ? state : NULL;
}

static int prepare_probe(EditSearch *md, Probe *probe) {
  Expr sides[2] = {md->x->lhs, md->x->rhs};
  ExprList l = expr_topo(md->g, sides, 2);
  probe->base = md->state[0];
  for (uint32_t i = 0; i < l.n && probe->nsymbols < 64; i++) {
    if (expr_op(md->g, l.at[i]) != EX_SYM || !is_quantity(expr_sym_of(md->g, l.at[i]))) continue;
    if (expr_sym_of(md->g, l.at[i])->kind == SYM_ACC) continue;
    SymId s = expr_sym_id(md->g, l.at[i]);
    probe->moved[probe->nsymbols] = moved_state(md, probe->base, s);
    if (!probe->moved[probe->nsymbols]) return 0;
    probe->symbol[probe->nsymbols++] = s;
  }
  return 1;
}

/* Needed and written value at a state, which takes the place of the first one. */
static int need_at(EditSearch *md, Spot *p, EvalTape *value, long double *state, long double *needed, long double *written) {
  md->state[0] = state;
  p->at = -1;
  eval_run(value, state, written);
  *needed = needed_value(md, p, 0, *written);
  return isfinite(*needed) != 0;
}

static uint32_t dependences(EditSearch *md, Spot *p, const Probe *probe) {
  enum { NEVER = 1000 };
  EvalTape *value = eval_tape(md->g, &p->value, 1);
  long double need0, written0, need, written;
  uint32_t n[3] = {0, 0, 0};
  if (!need_at(md, p, value, probe->base, &need0, &written0)) return NEVER;
  for (uint32_t i = 0; i < probe->nsymbols; i++) {
    if (!need_at(md, p, value, probe->moved[i], &need, &written)) return NEVER;
    n[0] += (uint32_t)changes(need, need0);
    n[1] += (uint32_t)changes(need - written, need0 - written0);
    n[2] += (uint32_t)changes(need / written, need0 / written0);
  }
  uint32_t least = n[0] < n[1] ? n[0] : n[1];
  return n[2] < least ? n[2] : least;
}

Span likeliest_place(EditSearch *md) {
  Probe probe = {.nsymbols = 0};
  Span best = ast_expr(md->m->ast, md->x->rhs_ast)->span;
  uint32_t least = 999;
  if (!prepare_probe(md, &probe)) return best;
  for (uint32_t i = 0; i < md->nspots; i++) {
    Spot *p = &md->spots[i];
    if (!p->tape || p->site->left) continue;
    uint32_t n = dependences(md, p, &probe);
    if (n >= least) continue;
    least = n;
    best = p->ast->span;
  }
  md->state[0] = probe.base;
  return best;
}
