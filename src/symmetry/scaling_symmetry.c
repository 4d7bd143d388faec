/* Scalings that multiply the action, or leave it: exponents from the kernel of linear equations at random states, the
 * same rationals at two choices of parameters, then proved term by term. In large models, and where
 * the action is left, the coordinates of a kind have one exponent; in large models one turn stands for all of a
 * quantified sum. */
#include <math.h>

#include "base/dense_matrix.h"
#include "symmetry/find_symmetries_impl.h"
#include "symmetry/number_recognition.h"
#include "symmetry/symmetry_names.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/prove.h"
#include "sym/sum_nest.h"

typedef struct {
  const Eqns *e;
  ExprGraph *g;
  Arena *scratch;
  uint32_t n, unknowns;   /* coordinates, and their exponents */
  const uint32_t *column; /* [n] which exponent */
  Expr L;                 /* with one turn of each quantified sum of a large model */
  Scaling *out;
  SearchLimit *limit;
  int keeps;              /* the action: kappa is 0 */
  int found;
} ScalingSearch;

static Expr node(const ScalingSearch *w, SymId s) { return expr_symbol(w->g, s)->node; }
static SymId q_of(const ScalingSearch *w, uint32_t i) { return w->e->m->coords.at[i].q; }
static SymId v_of(const ScalingSearch *w, uint32_t i) { return w->e->m->coords.at[i].v; }

/* Exponents by coordinate, or by kind. */
static void choose_unknowns(ScalingSearch *w) {
  uint32_t *column = ARENA_ARRAY(w->scratch, uint32_t, w->n + 1), *first = ARENA_ARRAY(w->scratch, uint32_t, w->n + 1);
  CoordinateNames names = coordinate_names(w->e);
  w->unknowns = 0;
  for (uint32_t i = 0; i < w->n; i++) {
    uint32_t k = w->keeps || too_large_to_search(w->e) ? 0 : w->unknowns;
    while (k < w->unknowns && !name_same_kind(&names, first[k], i)) k++;
    column[i] = k;
    if (k == w->unknowns) first[w->unknowns++] = i;
  }
  w->column = column;
}

/* Whether turns of the sum are written in coordinates and parameters of one of them. */
static int has_own_symbols(const ScalingSearch *w, const SumNest *s) {
  for (uint32_t k = 0; k < s->nreads; k++)
    if (expr_symbol(w->g, s->reads[k].symbol)->kind == SYM_LOCAL) return 0;
  return 1;
}

/* One turn of each quantified sum in place of it. */
static Expr with_one_turn(ScalingSearch *w, Expr L) {
  ExprGraph *g = w->g;
  VEC(Expr) terms = {0};
  for (ExprPair term = {0}; expr_next_pair(g, L, EX_SUM, &term);) {
    const SumNest *s = expr_op(g, term.of) == EX_CELL ? expr_sum_nest(g, expr_cell_nest(g, term.of)) : NULL;
    uint32_t n = s && has_own_symbols(w, s) ? s->nshares : 0;
    for (uint32_t k = 0; k < n; k++) vec_push(w->scratch, &terms, expr_scale(g, term.num, s->shares[k].value));
    if (!n) vec_push(w->scratch, &terms, expr_scale(g, term.num, term.of));
  }
  return expr_add_n(g, terms.at, terms.n);
}

/* One row of the equations from the values out of L, dL/dt, dL/dq, dL/dv. 0: a value is not finite. */
static int put_row(const ScalingSearch *w, const long double *out, const long double *symbols, long double *row) {
  uint32_t n = w->n, beta = w->unknowns, kappa = beta + 1;
  row[beta] = out[0] + symbols[w->e->m->time] * out[1];
  row[kappa] = -out[0];
  for (uint32_t i = 0; i < n; i++) {
    long double moved = symbols[v_of(w, i)] * out[2 + n + i];
    row[w->column[i]] += symbols[q_of(w, i)] * out[2 + i] + moved;
    row[beta] -= moved;
  }
  for (uint32_t j = 0; j <= kappa; j++)
    if (!isfinite(row[j])) return 0;
  return 1;
}

/* Exponents alpha, beta, kappa up to a factor: the kernel of the equations at random states. NULL: it is not
 * one-dimensional. */
static const long double *exponents(ScalingSearch *w, const long double *parameters, uint32_t turn) {
  enum { SPARE_ROWS = 8 };
  ExprGraph *g = w->g;
  Expr *roots = ARENA_ARRAY(w->scratch, Expr, 2 + 2 * (size_t)w->n);
  uint32_t n = w->n, width = w->unknowns + 2, rows = width + SPARE_ROWS, count = expr_symbol_count(g) + 1;
  if (!search_fits(w->limit, (double)rows * width) || !search_goes_on(w->limit, 2.0 * width * width * rows))
    return NULL;
  long double *m = ARENA_ARRAY(w->scratch, long double, (size_t)rows *width),
              *symbols = ARENA_ARRAY(w->scratch, long double, count);
  long double *out = ARENA_ARRAY(w->scratch, long double, 2 + 2 * (size_t)n);
  roots[0] = w->L;
  roots[1] = expr_diff(g, w->L, w->e->m->time);
  expr_gradient(g, w->L, eqns_symbols(w->e, 0), n, roots + 2);
  expr_gradient(g, w->L, eqns_symbols(w->e, 1), n, roots + 2 + n);
  EvalTape *tape = eval_tape(g, roots, 2 + 2 * n);
  for (size_t r = 0; r < rows; r++) {
    if (!search_goes_on(w->limit, 0)) return NULL;
    sample_state(g, 100 * turn + (uint32_t)r + 3, symbols);
    for (uint32_t i = 0; i < n && w->keeps; i++) symbols[q_of(w, i)] *= n; /* bodies that nearly touch drown the rest */
    for (SymId s = 1; s < count; s++)
      if (expr_symbol(g, s)->kind == SYM_PARAM) symbols[s] = parameters[s];
    eval_run(tape, symbols, out);
    if (!put_row(w, out, symbols, m + r * width)) return NULL;
  }
  DenseRows kernel = dense_kernel(w->scratch, rows, width, m, 1e-12L);
  if (kernel.n != 1 || kernel.gap <= 1e4L) return NULL;
  long double largest = dense_largest(kernel.at, width);
  for (uint32_t j = 0; j < width; j++) {
    kernel.at[j] /= largest;
    if (fabsl(kernel.at[j]) < 1e-8L) kernel.at[j] = 0;
  }
  return kernel.at;
}

/* Whether delta x = (kappa - beta) x. */
static int scales(ScalingSearch *w, ExprSeeds seed, Expr x) {
  Expr less = expr_scale(w->g, num_sub(w->out->kappa, w->out->beta), x), moved;
  expr_tangent(w->g, &x, 1, seed, "_delta", NULL, &moved);
  return search_goes_on(w->limit, 0) && prove_zero(w->g, expr_sub(w->g, moved, less), NULL) == PROVED_ZERO;
}

/* Whether delta L = kappa L, term by term: each has the same dimension. */
static int is_proved(ScalingSearch *w) {
  ExprGraph *g = w->g;
  uint32_t symbols = expr_symbol_count(g) + 1;
  Expr *seed = ARENA_ARRAY(w->scratch, Expr, symbols);
  Num *power = ARENA_ARRAY(w->scratch, Num, symbols);
  for (uint32_t s = 0; s < symbols; s++) power[s] = num_int(0);
  for (uint32_t i = 0; i < w->n; i++) {
    power[q_of(w, i)] = w->out->alpha[i];
    power[v_of(w, i)] = num_sub(w->out->alpha[i], w->out->beta);
  }
  power[w->e->m->time] = w->out->beta;
  for (SymId s = 1; s < symbols; s++)
    if (!num_is_zero(power[s])) seed[s] = expr_scale(g, power[s], node(w, s));
  for (ExprPair term = {0}; expr_next_pair(g, w->e->lagrangian, EX_SUM, &term);) {
    int is_cell = expr_op(g, term.of) == EX_CELL && turns_move_alike(w->e, expr_cell_nest(g, term.of), seed, symbols);
    const SumNest *s = is_cell ? expr_sum_nest(g, expr_cell_nest(g, term.of)) : NULL;
    for (uint32_t k = 0; is_cell && k < s->nshares; k++)
      if (!scales(w, (ExprSeeds){.at = seed, .n = symbols}, s->shares[k].value)) return 0;
    if (!is_cell && !scales(w, (ExprSeeds){.at = seed, .n = symbols}, term.of)) return 0;
  }
  return 1;
}

/* Divides x by the greatest common divisor of its elements. */
static void make_whole(Num *x, uint32_t n) {
  Num common = num_int(0);
  for (uint32_t i = 0; i < n; i++)
    if (!num_is_zero(x[i])) common = num_is_zero(common) ? num_abs(x[i]) : num_gcd(common, x[i]);
  for (uint32_t i = 0; i < n; i++) x[i] = num_div(x[i], common);
}

/* The exponent near x, a ratio of small numbers: forces of many bodies may leave six digits, and each guess is
 * proved. */
static int small_ratio(long double x, Num *out) {
  enum { DENOMINATOR_MOST = 12 };
  for (int64_t d = 1; d <= DENOMINATOR_MOST && fabsl(x) < 100; d++) {
    *out = num_ratio((int64_t)roundl(x * (long double)d), d);
    if (fabsl(x - (long double)num_value(*out)) < 1e-6L) return 1;
  }
  return 0;
}

static void scaling_work(Arena *scratch, void *data) {
  ScalingSearch *w = data;
  w->scratch = scratch;
  choose_unknowns(w);
  w->L = too_large_to_search(w->e) ? with_one_turn(w, w->e->lagrangian) : w->e->lagrangian;
  Choices choices = choices_new(scratch, w->e, 0, 0);
  const long double *x = exponents(w, choices.at[CHOICE_FIRST], 1),
                    *y = x ? exponents(w, choices.at[CHOICE_SECOND], 2) : NULL;
  uint32_t beta = w->unknowns, kappa = beta + 1, unit = w->keeps ? beta : kappa;
  Num *whole = ARENA_ARRAY(scratch, Num, kappa + 1), *alpha = ARENA_ARRAY(w->e->m->arena, Num, w->n + 1), other;
  if (!y || x[unit] == 0 || y[unit] == 0 || w->keeps != (x[kappa] == 0)) return;
  int (*recognise)(long double, Num *) = w->keeps ? small_ratio : recognise_rational;
  for (uint32_t i = 0; i <= kappa; i++)
    if (!recognise(x[i] / x[unit], &whole[i]) || !recognise(y[i] / y[unit], &other) ||
        !num_equal(whole[i], other))
      return;
  make_whole(whole, kappa + 1);
  for (uint32_t i = 0; i < w->n; i++) alpha[i] = whole[w->column[i]];
  *w->out = (Scaling){alpha, whole[beta], whole[kappa]};
  w->found = w->keeps || is_proved(w);
}

static int find_scaling(const Eqns *e, int keeps, Scaling *found, SearchLimit *limit) {
  ScalingSearch w = {.e = e, .g = e->g, .n = e->n, .out = found, .limit = limit, .keeps = keeps};
  if (!e->n || e->constraints.n || e->m->states.n || expr_kinds(e->g, e->lagrangian) & 1u << SYM_INPUT) return 0;
  for (uint32_t i = 0; i < e->n; i++)
    if (!expr_is_zero(e->g, e->Q[i])) return 0;
  arena_with_scratch(expr_arena(e->g), scaling_work, &w);
  return w.found;
}

int noether_scaling(const Eqns *e, Scaling *found, SearchLimit *limit) { return find_scaling(e, 0, found, limit); }

int scaling_of_kinds(const Eqns *e, Scaling *found, SearchLimit *limit) { return find_scaling(e, 1, found, limit); }
