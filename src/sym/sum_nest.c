/* Nodes of quantified sums: construction, partial derivatives, and the sums written out. */
#include "sym/sum_nest.h"

#include "sym/expr_impl.h"

/* --- construction and access --- */

/* Appends the kinds of symbols on which each share of a nest depends: those of the arguments that it reads. */
static void add_share_kinds(ExprGraph *g, Expr nest) {
  const SumNest s = *expr_sum_nest(g, nest);
  unsigned *of = ARENA_ARRAY(g->arena, unsigned, s.nreads + 1);
  for (uint32_t r = 0; r < s.nreads; r++) {
    int64_t lo, hi, step = subscript_step(&s.reads[r].at);
    if (!loop_extent(&s.range, &s.reads[r].at, &lo, &hi)) continue;
    for (int64_t k = lo; k <= hi; k += step ? step : 1) of[r] |= expr_kinds(g, expr_sum_arg(g, nest, (uint32_t)k));
  }
  expr_map_set(&g->share_kinds_at, nest, g->share_kinds.n + 1);
  for (uint32_t i = 0; i < s.nshares; i++) {
    unsigned kinds = 0;
    for (uint32_t r = 0; r < s.nreads; r++)
      if (of[r] & ~kinds && expr_contains_sym(g, s.shares[i].value, s.reads[r].symbol)) kinds |= of[r];
    vec_push(g->arena, &g->share_kinds, (uint16_t)kinds);
  }
}

/* Of the shares that add to the cell, where a nest has several. */
static unsigned cell_kinds(ExprGraph *g, Expr nest, int64_t cell) {
  const SumNest *s = expr_sum_nest(g, nest);
  unsigned kinds = 0, all = expr_kinds(g, nest);
  if (s->nshares < 2) return all;
  if (!expr_map_get(&g->share_kinds_at, nest)) add_share_kinds(g, nest);
  const uint16_t *of = g->share_kinds.at + expr_map_get(&g->share_kinds_at, nest) - 1;
  for (uint32_t k = 0; k < s->nshares && kinds != all; k++) {
    int64_t lo, hi, step = subscript_step(&s->shares[k].at);
    if (loop_extent(&s->range, &s->shares[k].at, &lo, &hi) && cell >= lo && cell <= hi && !(step && (cell - lo) % step))
      kinds |= of[k];
  }
  return kinds;
}

static Expr make_cell(ExprGraph *g, const Expr *both) {
  const uint32_t known = g->nodes.n;
  Expr e = expr_make(g, EX_CELL, both, 2);
  if (e == known) g->nodes.at[e].kinds = (uint16_t)cell_kinds(g, both[0], expr_number(g, both[1]).num);
  return e;
}

Expr expr_cell_of(ExprGraph *g, Expr nest, uint32_t cell) {
  Expr both[2] = {nest, expr_int(g, cell)};
  return make_cell(g, both);
}

static int same_subscript(const Subscript *x, const Subscript *y) {
  return x->first == y->first && x->by_row == y->by_row && x->by_turn == y->by_turn;
}

static int same_lists(const SumNest *x, const SumNest *y) {
  int same = x->nreads == y->nreads && x->nshares == y->nshares;
  for (uint32_t k = 0; same && k < x->nreads; k++)
    same = x->reads[k].symbol == y->reads[k].symbol && same_subscript(&x->reads[k].at, &y->reads[k].at);
  for (uint32_t k = 0; same && k < x->nshares; k++)
    same = x->shares[k].value == y->shares[k].value && same_subscript(&x->shares[k].at, &y->shares[k].at);
  return same;
}

static int is_same(const SumNest *x, const SumNest *y) {
  const LoopRange *r = &x->range, *o = &y->range;
  return r->rows == o->rows && r->skew == o->skew && r->turns == o->turns && r->more == o->more &&
         x->nargs == y->nargs && x->ncells == y->ncells && x->i0 == y->i0 && x->j0 == y->j0 && x->i == y->i &&
         x->j == y->j && x->row == y->row && x->turn == y->turn && x->near == y->near &&
         x->far == y->far && same_lists(x, y);
}

/* Reads of symbols that no share contains are left out. */
static void drop_reads(ExprGraph *g, SumNest *s) {
  Expr *values = ARENA_ARRAY(g->arena, Expr, s->nshares + 1);
  NestRead *kept = ARENA_ARRAY(g->arena, NestRead, s->nreads + 1);
  uint32_t n = 0;
  for (uint32_t k = 0; k < s->nshares; k++) values[k] = s->shares[k].value;
  ExprList l = expr_topo(g, values, s->nshares);
  for (uint32_t r = 0; r < s->nreads; r++) {
    Expr symbol = expr_symbol(g, s->reads[r].symbol)->node;
    uint32_t k = 0;
    while (k < l.n && l.at[k] != symbol) k++;
    if (k < l.n) kept[n++] = s->reads[r];
  }
  s->reads = kept;
  s->nreads = n;
}

uint32_t expr_sum_number(ExprGraph *g, SumNest *s) {
  drop_reads(g, s);
  for (uint32_t k = 0; k < g->nests.n; k++)
    if (is_same(s, &g->nests.at[k])) return k + 1;
  s->gradient = 0;
  vec_push(g->arena, &g->nests, *s);
  return g->nests.n;
}

/* The nest over the arguments that are read; others are 0. */
static Expr nest_of(ExprGraph *g, uint32_t number, const Expr *args, uint32_t n) {
  Expr *all = ARENA_ARRAY(g->arena, Expr, n + 1);
  const SumNest *s = &g->nests.at[number - 1];
  all[0] = expr_int(g, number);
  for (uint32_t k = 0; k < n; k++) all[k + 1] = g->zero;
  for (uint32_t r = 0; r < s->nreads; r++) {
    int64_t lo, hi, step = subscript_step(&s->reads[r].at);
    if (!loop_extent(&s->range, &s->reads[r].at, &lo, &hi)) continue;
    for (int64_t k = lo; k <= hi; k += step ? step : 1) all[k + 1] = args[k];
  }
  return expr_make(g, EX_NEST, all, n + 1);
}

Expr expr_sum_cell(ExprGraph *g, const SumNest *s, const Expr *args, uint32_t cell) {
  SumNest own = *s;
  uint32_t number = expr_sum_number(g, &own);
  Expr nest = nest_of(g, number, args, own.nargs);
  return expr_cell_of(g, nest, cell);
}

/* Whether the read is 0 in all turns. */
static int reads_zeros(const ExprGraph *g, const SumNest *s, const NestRead *read, const Expr *args) {
  int64_t lo, hi, step = subscript_step(&read->at);
  if (!loop_extent(&s->range, &read->at, &lo, &hi)) return 0;
  for (int64_t k = lo; k <= hi; k += step ? step : 1)
    if (args[k + 1] != g->zero) return 0;
  return 1;
}

Expr expr_nest_rebuilt(ExprGraph *g, const Expr *args, uint32_t n) {
  SumNest s = g->nests.at[expr_number(g, args[0]).num - 1];
  ExprMap zeros = expr_map(g->arena); /* the graph's own map is in use while nodes are rebuilt */
  NestShare *shares = ARENA_ARRAY(g->arena, NestShare, s.nshares + 1);
  for (uint32_t k = 0; k < s.nreads && !s.near; k++)
    if (reads_zeros(g, &s, &s.reads[k], args))
      expr_map_set(&zeros, expr_symbol(g, s.reads[k].symbol)->node, g->zero);
  if (!zeros.n) return expr_make(g, EX_NEST, args, n);
  for (uint32_t k = 0; k < s.nshares; k++) {
    shares[k] = s.shares[k];
    shares[k].value = expr_replace_by(g, shares[k].value, &zeros);
  }
  s.shares = shares;
  s.slopes = NULL;
  s.far = NULL;
  return nest_of(g, expr_sum_number(g, &s), args + 1, n - 1);
}

Expr expr_cell_rebuilt(ExprGraph *g, const Expr *args) {
  const SumNest *s = expr_sum_nest(g, args[0]);
  int some = 0;
  for (uint32_t k = 0; k < s->nshares; k++) some |= s->shares[k].value != g->zero;
  return some ? make_cell(g, args) : g->zero;
}

Expr expr_twin_cell(ExprGraph *g, Expr nest, uint32_t number, uint32_t cell) {
  if (g->twin_of != nest || g->twin_number != number) {
    uint32_t n = expr_sum_args(g, nest);
    Expr *args = ARENA_ARRAY(g->arena, Expr, n + 1);
    memcpy(args, g->args.at + g->nodes.at[nest].payload + 1, n * sizeof *args);
    g->twin = nest_of(g, number, args, n);
    g->twin_of = nest;
    g->twin_number = number;
  }
  return expr_cell_of(g, g->twin, cell);
}

uint32_t expr_nest_number(const ExprGraph *g, Expr nest) {
  return (uint32_t)expr_number(g, expr_arg(g, nest, 0)).num;
}

const SumNest *expr_sum_nest(const ExprGraph *g, Expr nest) { return &g->nests.at[expr_nest_number(g, nest) - 1]; }
uint32_t expr_sum_args(const ExprGraph *g, Expr nest) { return expr_nargs(g, nest) - 1; }
Expr expr_sum_arg(const ExprGraph *g, Expr nest, uint32_t i) { return expr_arg(g, nest, i + 1); }
Expr expr_cell_nest(const ExprGraph *g, Expr cell) { return expr_arg(g, cell, 0); }
uint32_t expr_cell_number(const ExprGraph *g, Expr cell) { return (uint32_t)expr_number(g, expr_arg(g, cell, 1)).num; }

uint64_t expr_sum_turns(const ExprGraph *g, Expr nest) {
  const LoopRange *r = &expr_sum_nest(g, nest)->range;
  uint64_t n = 0;
  for (uint32_t i = 0; i < r->rows; i++) n += (uint64_t)loop_turns(r, i);
  return n;
}

ExprList expr_topo_with_bodies(ExprGraph *g, const Expr *roots, uint32_t n) {
  VEC(Expr) all = {0};
  ExprList l = expr_topo(g, roots, n);
  if (!g->nests.n) return l;
  for (uint32_t k = 0; k < n; k++) vec_push(g->arena, &all, roots[k]);
  for (uint32_t k = 0; k < l.n; k++) {
    const SumNest *s = expr_op(g, l.at[k]) == EX_NEST ? expr_sum_nest(g, l.at[k]) : NULL;
    for (uint32_t i = 0; s && i < s->nshares; i++) vec_push(g->arena, &all, s->shares[i].value);
  }
  return expr_topo(g, all.at, all.n);
}

/* --- written out --- */

/* Whether a turn adds to cell k: an equation affine in i and j. */
static int adds_to(const NestShare *x, int64_t k, int64_t i, int64_t j) { return subscript_at(&x->at, i, j) == k; }

/* Whether some turn of row i may add to cell k. */
static int row_adds_to(const SumNest *s, int64_t k, int64_t i) {
  for (uint32_t n = 0; n < s->nshares; n++)
    if (s->shares[n].at.by_turn || adds_to(&s->shares[n], k, i, 0)) return 1;
  return 0;
}

/* A nest whose turns are written out: its arguments, and room for what a turn replaces. */
typedef struct {
  SumNest nest;
  SymId *syms;
  Expr *with, *args;
} WrittenNest;

static void add_turn(ExprGraph *g, const WrittenNest *w, const NestShare *x, int64_t i, int64_t j) {
  for (uint32_t k = 0; k < w->nest.nreads; k++) {
    w->syms[k] = w->nest.reads[k].symbol;
    w->with[k] = w->args[subscript_at(&w->nest.reads[k].at, i, j)];
  }
  Expr term = expr_replace(g, x->value, w->syms, w->with, w->nest.nreads);
  vec_push(g->arena, &g->terms, term);
}

static Expr written_out(ExprGraph *g, Expr cell) {
  Expr nest = expr_cell_nest(g, cell);
  SumNest s = *expr_sum_nest(g, nest);
  int64_t k = expr_cell_number(g, cell);
  WrittenNest w = {s, ARENA_ARRAY(g->arena, SymId, s.nreads + 1), ARENA_ARRAY(g->arena, Expr, s.nreads + 1),
                   ARENA_ARRAY(g->arena, Expr, s.nargs + 1)};
  for (uint32_t n = 0; n < s.nargs; n++) w.args[n] = expr_sum_arg(g, nest, n);
  g->terms.n = 0;
  for (int64_t i = 0; i < s.range.rows; i++)
    for (int64_t j = loop_from(&s.range, i); row_adds_to(&s, k, i) && j < loop_to(&s.range, i); j++)
      for (uint32_t n = 0; n < s.nshares; n++)
        if (adds_to(&s.shares[n], k, i, j)) add_turn(g, &w, &s.shares[n], i, j);
  return expr_add_n(g, g->terms.at, g->terms.n);
}

void expr_write_out(ExprGraph *g, const Expr *roots, uint32_t n, const Expr *cells, uint32_t ncells, Expr *out) {
  Expr *sums = ARENA_ARRAY(g->arena, Expr, ncells + 1);
  if (n && out != roots) memcpy(out, roots, n * sizeof *roots);
  for (uint32_t k = 0; k < ncells; k++) sums[k] = written_out(g, cells[k]);
  if (ncells) expr_replace_nodes(g, roots, n, cells, sums, ncells, out);
}

void expr_expand_sums(ExprGraph *g, const Expr *roots, uint32_t n, Expr *out) {
  VEC(Expr) cells = {0};
  ExprList l = g->nests.n ? expr_topo(g, roots, n) : (ExprList){0};
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(g, l.at[k]) == EX_CELL) vec_push(g->arena, &cells, l.at[k]);
  expr_write_out(g, roots, n, cells.at, cells.n, out);
}

int expr_open_sums(ExprGraph *g, Expr *e) {
  enum { MOST_TURNS = 8000 };
  uint64_t turns = 0;
  ExprList l = g->nests.n ? expr_topo_to_sums(g, e, 1) : (ExprList){0};
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(g, l.at[k]) == EX_NEST) turns += expr_sum_turns(g, l.at[k]);
  if (turns > MOST_TURNS) return 0;
  if (turns) expr_expand_sums(g, e, 1, e);
  return 1;
}
