/* Positive definiteness from L = sum of terms: signs of the terms, and squares against products of velocities
 * (Gershgorin). */
#include "mech/mass_definiteness.h"

#include <math.h>

#include "base/sparse_solve.h"
#include "mech/consistent_start.h"
#include "mech/velocity_degree.h"
#include "sym/expr_eval.h"
#include "sym/print.h"
#include "sym/sum_nest.h"

/* --- products of velocities --- */

/* c*factor*form, a part of L. */
typedef struct {
  Num c;
  Expr factor, form;
} Part;

/* L multiplied out into c*factor*u*v. Since |u*v| <= (u^2 + v^2)/2, each product is subtracted from the coefficients
 * of the squares with the same factor; these must stay nonnegative (Gershgorin's circles, one set for each factor).
 * */
typedef struct {
  const Eqns *e;
  VEC(Part) open; /* parts to be multiplied out */
  ExprMap place;  /* factor*u^2 -> its index in left, from 1 */
  VEC(Num) left;  /* remaining coefficients of the squares */
} SquareBounds;

static void add_square(SquareBounds *q, Expr factor, Expr u, Num c) {
  ExprGraph *g = q->e->g;
  Expr square = expr_pow_num(g, u, num_int(2)), key = expr_mul(g, factor, square);
  uint32_t at = expr_map_get(&q->place, key);
  if (!at) {
    vec_push(q->e->m->arena, &q->left, num_int(0));
    expr_map_set(&q->place, key, at = q->left.n);
  }
  q->left.at[at - 1] = num_add(q->left.at[at - 1], c);
}

enum { MOST_PARTS = 100000 }; /* nested lets that each occur twice would multiply out exponentially */

static int squares_dominate(const Eqns *e, Expr l);

/* Adds c*factor*term, at most quadratic in velocities. 0: the term may be negative, or has another form. */
static int add_quadratic_term(SquareBounds *q, Expr factor, Num c, Expr term) {
  const Eqns *e = q->e;
  ExprGraph *g = e->g;
  Expr moving[2] = {0};
  Num power[2];
  uint32_t n = 0;
  for (ExprPair base = {0}; expr_next_pair(g, term, EX_PROD, &base);) {
    if (!has_velocities(e->g, base.of)) {
      Expr still = expr_pow_num(g, base.of, base.num);
      factor = expr_mul(g, factor, still);
    } else {
      if (n == 2) return 0;
      moving[n] = base.of;
      power[n++] = base.num;
    }
  }
  if (!sign_is_nonnegative(expr_sign(g, factor))) return 0;
  if (n == 2) {
    if (!num_is_one(power[0]) || !num_is_one(power[1])) return 0;
    Num half = num_mul(num_abs(c), num_ratio(-1, 2));
    add_square(q, factor, moving[0], half);
    add_square(q, factor, moving[1], half);
    return 1;
  }
  if (num_equal(power[0], num_int(2))) {
    add_square(q, factor, moving[0], c);
    return 1;
  }
  ExprOp op = expr_op(g, moving[0]);
  const SumNest *sum = op == EX_CELL ? expr_sum_nest(g, expr_cell_nest(g, moving[0])) : NULL;
  if (sum && sum->ncells == 1 && num_is_one(power[0]) && num_sign(c) > 0 && squares_dominate(q->e, sum->shares->value))
    return 1; /* one turn stands for all */
  if (sum && num_is_one(power[0])) { /* terms that only squares of others outweigh, as x[i]'*x[i+1]' */
    Expr written = moving[0];
    if (expr_sum_turns(g, expr_cell_nest(g, written)) > MOST_PARTS) return 0;
    expr_write_out(g, &written, 1, &written, 1, &written);
    vec_push(e->m->arena, &q->open, ((Part){c, factor, written}));
    return 1;
  }
  if (num_is_one(power[0]) && (op == EX_SUM || op == EX_DEF)) {
    vec_push(e->m->arena, &q->open, ((Part){c, factor, op == EX_DEF ? expr_arg(g, moving[0], 0) : moving[0]}));
    return 1;
  }
  return num_sign(c) > 0 && sign_is_nonnegative(expr_sign(g, term));
}

static int add_term(SquareBounds *q, Expr factor, Num c, Expr term) {
  return !has_velocities(q->e->g, term) || add_quadratic_term(q, factor, c, term) ||
         is_linear_in_velocities(q->e->g, term, q->e->n);
}

static int squares_dominate(const Eqns *e, Expr l) {
  SquareBounds q = {.e = e, .place = expr_map(e->m->arena)};
  Expr one = expr_int(e->g, 1);
  vec_push(e->m->arena, &q.open, ((Part){num_int(1), one, l}));
  for (uint32_t k = 0; k < q.open.n; k++) {
    Part p = q.open.at[k];
    if (k == MOST_PARTS) return 0;
    for (uint32_t i = 0; i < expr_pairs(e->g, p.form, EX_SUM); i++) {
      Num c;
      Expr term = expr_pair(e->g, p.form, EX_SUM, i, &c);
      if (!add_term(&q, p.factor, num_mul(p.c, c), term)) return 0;
    }
  }
  for (uint32_t k = 0; k < q.left.n; k++)
    if (num_sign(q.left.at[k]) < 0 || !num_sign_is_sure(q.left.at[k])) return 0;
  return 1;
}

int mass_is_definite(const Eqns *e, const LinearSystem *s, Expr lagrangian) {
  /* A nonnegative form that is quadratic in q' has a positive semidefinite Hessian; quadratic: the entries of H and
   * C contain no velocities. */
  for (uint32_t i = 0; i < s->H.n; i++)
    if (has_velocities(e->g, s->H.at[i].e)) return 0;
  for (uint32_t i = 0; i < s->C.n; i++)
    if (has_velocities(e->g, s->C.at[i].e)) return 0;
  return squares_dominate(e, lagrangian);
}

int mass_is_definite_by_values(const Eqns *e, const LinearSystem *s, Expr lagrangian) {
  const Model *m = e->m;
  ExprGraph *g = e->g;
  uint32_t n = expr_symbol_count(g) + 1, some = 0;
  long double *value = model_constants(m);
  Expr *with = ARENA_ARRAY(m->arena, Expr, n);
  for (uint32_t i = 0; i < m->params.n; i++) {
    const Param *p = &m->params.at[i];
    if (p->value) expr_eval(g, &p->value, 1, value, &value[p->sym]);
    if (expr_symbol(g, p->sym)->sign != SIGN_UNKNOWN || value[p->sym] == 0) continue;
    Expr positive = expr_fn(g, EX_EXP, expr_symbol(g, p->sym)->node); /* any number of this sign */
    with[p->sym] = value[p->sym] > 0 ? positive : expr_neg(g, positive);
    some = 1;
  }
  return some && mass_is_definite(e, s, expr_substitute(g, lagrangian, with, n, ""));
}

/* Whether the entry is not negative for all positive parameters; an entry -m is meant to be. */
static int may_be_positive(const Eqns *e, Expr entry) {
  const Model *m = e->m;
  uint32_t n = expr_symbol_count(e->g) + 1;
  Expr *with = ARENA_ARRAY(m->arena, Expr, n);
  for (uint32_t i = 0; i < m->params.n; i++)
    if (expr_symbol(e->g, m->params.at[i].sym)->sign == SIGN_UNKNOWN)
      with[m->params.at[i].sym] = expr_fn(e->g, EX_EXP, expr_symbol(e->g, m->params.at[i].sym)->node);
  ExprSign sign = expr_sign(e->g, expr_substitute(e->g, entry, with, n, ""));
  return sign != SIGN_NEGATIVE && sign != SIGN_NONPOSITIVE;
}

/* Values by symbol of the scene's parameters. */
static long double *parameter_values(const Eqns *e) {
  const Model *m = e->m;
  long double *value = model_constants(m);
  for (uint32_t i = 0; i < m->params.n; i++)
    if (m->params.at[i].value) expr_eval(e->g, &m->params.at[i].value, 1, value, &value[m->params.at[i].sym]);
  return value;
}

static void forget_values(const Eqns *e, long double *value) {
  arena_release(e->m->arena, value, (expr_symbol_count(e->g) + 1) * sizeof *value);
}

static void add_once(Eqns *e, ExprMap *known, ModelSize one) {
  if (expr_is_num(e->g, one.value) || expr_map_get(known, one.value) == (one.part ? 2u : 1u)) return;
  expr_map_set(known, one.value, one.part ? 2u : 1u);
  vec_push(e->m->arena, &e->sizes, one);
}

void sizes_find(Eqns *e) {
  const Model *m = e->m;
  long double *value = parameter_values(e), inertia;
  ExprMap known = expr_map(m->arena);
  for (uint32_t i = 0; i < m->sizes.n; i++) add_once(e, &known, m->sizes.at[i]);
  for (uint32_t i = 0; i < e->mass.n; i++) {
    MassEntry x = e->mass.at[i];
    ExprSign sign = x.row == x.col && expr_is_constant(e->g, x.e) ? expr_sign(e->g, x.e) : SIGN_POSITIVE;
    if (sign == SIGN_POSITIVE || (sign == SIGN_NONNEGATIVE && m->constraints.n)) continue;
    expr_eval(e->g, &x.e, 1, value, &inertia);
    const char *what = arena_printf(m->arena, "the coordinate `%s` has an inertia", m->coords.at[x.row].name);
    Span span = m->coords.at[x.row].span;
    if (inertia > 0) add_once(e, &known, (ModelSize){x.e, what, span, !m->constraints.n, 0, 0, NULL});
  }
  forget_values(e, value);
}

void mass_warn_nonpositive(const Eqns *e) {
  const Model *m = e->m;
  long double *value = parameter_values(e), inertia;
  ExprMap judged = expr_map(m->arena);
  for (uint32_t i = 0; i < e->mass.n; i++) {
    MassEntry x = e->mass.at[i];
    if (x.row != x.col || !expr_is_constant(e->g, x.e) || expr_map_get(&judged, x.e)) continue;
    expr_map_set(&judged, x.e, 1);
    expr_eval(e->g, &x.e, 1, value, &inertia);
    if ((!(inertia < 0) && !(inertia == 0 && !m->constraints.n)) || !may_be_positive(e, x.e)) continue;
    diag_warning(m->diags, m->coords.at[x.row].span, "the values of the parameters make the inertia of `%s` %s",
                 m->coords.at[x.row].name, inertia < 0 ? "negative" : "zero");
    diag_help(m->diags, "give them values that make %s positive; with `> 0` after a parameter a run refuses others",
              expr_text(e->g, x.e));
  }
  forget_values(e, value);
}

/* The coordinate without inertia at these values: the largest part of a vector that M makes 0; e->n: M is regular. */
static uint32_t without_inertia(const Eqns *e, const long double *at) {
  uint32_t n = e->n, most = 0;
  SparseElements M = {0};
  long double *null = ARENA_ARRAY(e->m->arena, long double, n), *x = ARENA_ARRAY(e->m->arena, long double, e->mass.n);
  Expr *entries = ARENA_ARRAY(e->m->arena, Expr, e->mass.n + 1);
  for (uint32_t i = 0; i < e->mass.n; i++) entries[i] = e->mass.at[i].e;
  expr_eval(e->g, entries, e->mass.n, at, x);
  for (uint32_t i = 0; i < e->mass.n; i++) {
    MassEntry m = e->mass.at[i];
    if (!isfinite(x[i])) return n; /* another message */
    sparse_put(e->m->arena, &M, m.row, m.col, x[i]);
    if (m.row != m.col) sparse_put(e->m->arena, &M, m.col, m.row, x[i]);
  }
  if (sparse_solve(e->m->arena, n, &M, NULL, 1e-15L, null) == n) return n;
  for (uint32_t i = 1; i < n; i++)
    if (fabsl(null[i]) > fabsl(null[most])) most = i;
  return most;
}

int mass_regular_at_start(const Eqns *e) {
  const Model *m = e->m;
  /* constant: mass_warn_nonpositive */
  if (!e->n || !e->mass_known || e->constant_mass || m->constraints.n || e->singular_mass || !m->scene.span.end)
    return 1;
  uint32_t k = without_inertia(e, start_requested(e));
  if (k == e->n) return 1;
  diag_error(m->diags, m->scene.span,
             "the mass matrix is singular at the start of the scene `%s`, where `%s` has no inertia: no acceleration "
             "follows there",
             m->scene.name, m->coords.at[k].name);
  diag_help(m->diags, "begin elsewhere, as with `start %s = 0.1`, or describe this position by other coordinates",
            m->coords.at[k].name);
  return 0;
}
