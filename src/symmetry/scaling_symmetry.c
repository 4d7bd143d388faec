/* Scalings that multiply the action: exponents from the kernel of linear equations at random states, the same
 * rationals at two choices of parameters, then proved term by term. */
#include <math.h>

#include "base/dense_matrix.h"
#include "symmetry/find_symmetries.h"
#include "symmetry/number_recognition.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/prove.h"

typedef struct {
  const Eqns *e;
  ExprGraph *g;
  Arena *scratch;
  uint32_t n;
  Scaling *out;
  SearchLimit *limit;
  int found;
} ScalingSearch;

static Expr node(const ScalingSearch *w, SymId s) { return expr_symbol(w->g, s)->node; }
static SymId q_of(const ScalingSearch *w, uint32_t i) { return w->e->m->coords.at[i].q; }
static SymId v_of(const ScalingSearch *w, uint32_t i) { return w->e->m->coords.at[i].v; }

/* Exponents alpha, beta, kappa up to a factor: the kernel of the equations at random states. NULL: it is not
 * one-dimensional. */
static const long double *exponents(ScalingSearch *w, const long double *parameters, uint32_t turn) {
  enum { SPARE_ROWS = 8 };
  ExprGraph *g = w->g;
  Expr L = w->e->lagrangian, *roots = ARENA_ARRAY(w->scratch, Expr, 2 + 2 * (size_t)w->n);
  uint32_t n = w->n, width = n + 2, rows = width + SPARE_ROWS, count = expr_symbol_count(g) + 1;
  if (!search_fits(w->limit, (double)rows * width) || !search_goes_on(w->limit, 2.0 * width * width * rows))
    return NULL;
  long double *m = ARENA_ARRAY(w->scratch, long double, (size_t)rows *width),
              *symbols = ARENA_ARRAY(w->scratch, long double, count);
  long double *out = ARENA_ARRAY(w->scratch, long double, 2 + 2 * (size_t)n);
  roots[0] = L;
  roots[1] = expr_diff(g, L, w->e->m->time);
  for (uint32_t i = 0; i < n; i++) roots[2 + i] = w->e->dLdq[i], roots[2 + n + i] = w->e->p[i];
  EvalTape *tape = eval_tape(g, roots, 2 + 2 * n);
  for (size_t r = 0; r < rows; r++) {
    long double *row = m + r * width;
    if (!search_goes_on(w->limit, 0)) return NULL;
    sample_state(g, 100 * turn + (uint32_t)r + 3, symbols);
    for (SymId s = 1; s < count; s++)
      if (expr_symbol(g, s)->kind == SYM_PARAM) symbols[s] = parameters[s];
    eval_run(tape, symbols, out);
    row[n] = out[0] + symbols[w->e->m->time] * out[1];
    row[n + 1] = -out[0];
    for (uint32_t i = 0; i < n; i++) {
      long double moved = symbols[v_of(w, i)] * out[2 + n + i];
      row[i] = symbols[q_of(w, i)] * out[2 + i] + moved;
      row[n] -= moved;
    }
    for (uint32_t j = 0; j < width; j++)
      if (!isfinite(row[j])) return NULL;
  }
  DenseRows kernel = dense_kernel(w->scratch, rows, width, m, 1e-12L);
  return kernel.n == 1 && kernel.gap > 1e4L ? kernel.at : NULL;
}

/* Whether delta L = kappa L, term by term: each has the same dimension. */
static int is_proved(ScalingSearch *w) {
  ExprGraph *g = w->g;
  Expr L = w->e->lagrangian;
  uint32_t n = w->n;
  uint32_t symbols = expr_symbol_count(g) + 1;
  Expr *seed = ARENA_ARRAY(w->scratch, Expr, symbols), moved;
  for (uint32_t i = 0; i < n; i++) {
    seed[q_of(w, i)] = expr_scale(g, w->out->alpha[i], node(w, q_of(w, i)));
    seed[v_of(w, i)] = expr_scale(g, num_sub(w->out->alpha[i], w->out->beta), node(w, v_of(w, i)));
  }
  seed[w->e->m->time] = expr_scale(g, w->out->beta, node(w, w->e->m->time));
  for (ExprPair term = {0}; expr_next_pair(g, L, EX_SUM, &term);) {
    Expr less = expr_scale(g, num_sub(w->out->kappa, w->out->beta), term.of);
    expr_tangent(g, &term.of, 1, (ExprSeeds){.at = seed, .n = symbols}, "_delta", NULL, &moved);
    if (!search_goes_on(w->limit, 0) || prove_zero(g, expr_sub(g, moved, less), NULL) != PROVED_ZERO) return 0;
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

static void scaling_work(Arena *scratch, void *data) {
  ScalingSearch *w = data;
  w->scratch = scratch;
  Choices choices = choices_new(scratch, w->e, 0, 0);
  const long double *x = exponents(w, choices.at[CHOICE_FIRST], 1),
                    *y = x ? exponents(w, choices.at[CHOICE_SECOND], 2) : NULL;
  Num *whole = ARENA_ARRAY(w->e->m->arena, Num, w->n + 2), other;
  uint32_t last = w->n + 1;
  if (!y || fabsl(x[last]) < 1e-9L || fabsl(y[last]) < 1e-9L) return; /* kappa is 0: a symmetry in Noether's sense */
  for (uint32_t i = 0; i <= last; i++)
    if (!recognise_rational(x[i] / x[last], &whole[i]) || !recognise_rational(y[i] / y[last], &other) ||
        !num_equal(whole[i], other))
      return;
  make_whole(whole, w->n + 2);
  *w->out = (Scaling){whole, whole[w->n], whole[last]};
  w->found = is_proved(w);
}

int noether_scaling(const Eqns *e, Scaling *found, SearchLimit *limit) {
  ScalingSearch w = {.e = e, .g = e->g, .n = e->n, .out = found, .limit = limit};
  if (!e->n || e->constraints.n || e->m->states.n || expr_kinds(e->g, e->lagrangian) & 1u << SYM_INPUT) return 0;
  for (uint32_t i = 0; i < e->n; i++)
    if (!expr_is_zero(e->g, e->Q[i])) return 0;
  arena_with_scratch(expr_arena(e->g), scaling_work, &w);
  return w.found;
}
