/* Forces by a tree against direct sums, at sample bodies of the start: lag_tree.h is what a run calls. */
#include "mech/far_error.h"

#include <math.h>

#include "mech/consistent_start.h"
#include "numeric/lag_tree.h"
#include "sym/expr_eval.h"
#include "sym/sum_nest.h"

typedef long double Real;

/* A sum with its arguments at the start. */
typedef struct {
  const Eqns *e;
  const SumNest *s;
  Real *symbols, *args;
} FarSum;

static double value_of(const FarSum *x, Expr e) {
  Real v;
  expr_eval(x->e->g, &e, 1, x->symbols, &v);
  return (double)v;
}

/* Symbols of the body in row i, where they are the same in all turns. */
static void set_row(const FarSum *x, int64_t i) {
  for (uint32_t k = 0; k < x->s->nreads; k++) {
    const NestRead *r = &x->s->reads[k];
    if (!r->at.by_turn) x->symbols[r->symbol] = x->args[subscript_at(&r->at, i, 0)];
  }
}

/* The tree of the bodies; 0: their number is too large. */
static int make_tree(const FarSum *x, lag_tree *w) {
  enum { MOST = 1 << 24 };
  const FarForm *far = x->s->far;
  Arena *a = expr_arena(x->e->g);
  int n = (int)far->members;
  if (far->members > MOST) return 0;
  double *numbers = ARENA_ARRAY(a, double, LAG_TREE_NUMBERS((size_t)n));
  lag_tree_open(w, n, numbers, ARENA_ARRAY(a, int, LAG_TREE_INTS((size_t)n)));
  w->soft = value_of(x, far->soft);
  w->theta = value_of(x, far->theta);
  for (int k = 0; k < n; k++) {
    double *to = w->body + 4 * (size_t)k;
    set_row(x, far->first + k);
    for (uint32_t c = 0; c < 3; c++) to[c] = c < far->n ? (double)x->symbols[expr_sym_id(x->e->g, far->at_i[c])] : 0;
    to[3] = value_of(x, far->charge);
    w->order[k] = k;
  }
  lag_tree_divide(w);
  lag_tree_moments(w);
  return 1;
}

/* Squares of |force by the tree - direct force| and of |direct force|, of a body. */
static void compare_body(const lag_tree *w, int body, double *gap2, double *size2) {
  const double *at = w->body + 4 * (size_t)body, *field = w->field + 4 * (size_t)body;
  double direct[3] = {0};
  for (int k = 0; k < w->n; k++) {
    const double *of = w->body + 4 * (size_t)k, d[3] = {at[0] - of[0], at[1] - of[1], at[2] - of[2]};
    double r2 = d[0] * d[0] + d[1] * d[1] + d[2] * d[2] + w->soft, u = of[3] / (r2 * sqrt(r2));
    for (int c = 0; c < 3 && k != body; c++) direct[c] -= u * d[c];
  }
  *gap2 = *size2 = 0;
  for (int c = 0; c < 3; c++) {
    *gap2 += (field[1 + c] - direct[c]) * (field[1 + c] - direct[c]);
    *size2 += direct[c] * direct[c];
  }
}

static void note_sum(const FarSum *x) {
  enum { SAMPLES = 64 };
  lag_tree w = {0};
  int taken = 0, leaves = 0, every;
  double gaps = 0, sizes = 0, most = 0;
  if (!make_tree(x, &w)) return;
  for (int k = 0; k < w.cells; k++) leaves += !w.child[k];
  every = (leaves + SAMPLES - 1) / SAMPLES;
  for (int k = 0, leaf = 0; k < w.cells; k++) {
    if (w.child[k] || leaf++ % every) continue;
    lag_tree_group_field(&w, k, 0);
    double gap2, size2;
    compare_body(&w, w.begin[k], &gap2, &size2);
    gaps += gap2, sizes += size2;
    most = fmax(most, gap2);
    taken++;
  }
  Diags *d = x->e->m->diags;
  Span where = {x->s->far->begin, x->s->far->end};
  if (!isfinite(gaps / sizes)) return; /* no start */
  diag_note(d, where,
            "a tree takes this sum of 1/r over %d bodies: at the start its forces differ from direct ones by %.1g "
            "of the mean force, at most by %.1g, at %d of them",
            w.n, sqrt(gaps / sizes), sqrt(most * taken / sizes), taken);
  diag_help(d, "energy and momenta are kept to errors like these, not to rounding; a smaller opening angle has smaller "
               "ones, and 0 takes all pairs");
}

void far_errors_note(const Eqns *e) {
  ExprList l = expr_topo(e->g, &e->m->lagrangian, 1);
  for (uint32_t k = 0; k < l.n; k++) {
    const SumNest *s = expr_op(e->g, l.at[k]) == EX_NEST ? expr_sum_nest(e->g, l.at[k]) : NULL;
    if (!s || !s->far || s->ncells > 1) continue;
    FarSum x = {.e = e, .s = s, .symbols = start_requested(e)};
    Expr *args = ARENA_ARRAY(expr_arena(e->g), Expr, s->nargs + 1);
    x.args = ARENA_ARRAY(expr_arena(e->g), Real, s->nargs + 1);
    for (uint32_t i = 0; i < s->nargs; i++) args[i] = expr_sum_arg(e->g, l.at[k], i);
    expr_eval(e->g, args, s->nargs, x.symbols, x.args);
    note_sum(&x);
  }
}
