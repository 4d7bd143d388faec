/* Derivatives of quantified sums. The partial derivatives of a sum by its arguments are the cells of one nest; that of
 * cell k of such a nest by argument l is the cell k*nargs + l of the next, as both subscripts are affine in the turn.
 * What few turns add to stands as an expression instead. */
#include "sym/sum_diff.h"

#include <string.h>

#include "sym/expr_impl.h"
#include "sym/sum_nest.h"

enum { MOST_CELLS = 1 << 23, FEW_TURNS = 8 };

/* --- the nest of derivatives --- */

/* Share of the sum that holds derivatives by a read. */
static Subscript derivative_cell(const SumNest *s, const Subscript *of, const Subscript *by) {
  if (s->ncells == 1) return *by;
  int64_t n = s->nargs;
  return (Subscript){of->first * n + by->first, of->by_row * n + by->by_row, of->by_turn * n + by->by_turn};
}

int expr_prepare_sum(ExprGraph *g, Expr cell, int forward) {
  uint32_t number = expr_nest_number(g, expr_cell_nest(g, cell));
  SumNest s = g->nests.at[number - 1];
  const Expr *d = s.slopes;
  if (s.gradient || (forward && s.ncells > 1)) return 1;
  uint64_t cells = s.ncells == 1 ? s.nargs + 1u : (uint64_t)s.nargs * s.ncells;
  if (cells > MOST_CELLS && (s.sampled || s.ncells > s.nargs + 1u)) return 0;
  NestShare *shares = ARENA_ARRAY(g->arena, NestShare, (size_t)s.nreads * s.nshares + 1);
  SumNest to = s;
  to.shares = shares;
  to.nshares = 0;
  to.slopes = NULL;
  to.far = s.ncells == 1 ? s.far : NULL;
  to.ncells = (uint32_t)(cells > MOST_CELLS ? MOST_CELLS : cells);
  for (uint32_t k = 0; k < s.nreads * s.nshares; k++)
    if (d[k] != g->zero)
      shares[to.nshares++] = (NestShare){
          d[k], derivative_cell(&s, &s.shares[k / s.nreads].at, &s.reads[k % s.nreads].at)};
  uint32_t made = expr_sum_number(g, &to);
  g->nests.at[number - 1].gradient = made;
  return 1;
}

/* --- partial derivatives --- */

typedef struct {
  ExprGraph *g;
  Expr nest;
  const SumNest *s;   /* the sums, */
  uint32_t number;    /* and the nest of their derivatives */
  const ExprMap *live; /* arguments of interest */
  Expr *value;        /* by argument: what single turns add; 0: nothing */
  VEC(SumPartial) found;
} Partials;

/* Whether a value is a number times powers of symbols. */
static int is_simple(ExprGraph *g, Expr e) {
  ExprList l = expr_topo(g, &e, 1);
  int simple = l.n <= 8;
  for (uint32_t k = 0; k < l.n && simple; k++) {
    ExprOp op = expr_op(g, l.at[k]);
    simple = op == EX_NUM || op == EX_SYM || op == EX_PROD || (op == EX_SUM && expr_pairs(g, l.at[k], EX_SUM) == 1);
  }
  return simple;
}

/* Whether share n adds a simple value to another sum in each turn: sums of such stand as expressions. */
static int stands_alone(ExprGraph *g, const SumNest *d, uint32_t n) {
  const LoopRange *r = &d->range;
  const Subscript *at = &d->shares[n].at;
  return !d->sampled && (at->by_row || r->rows == 1) && (at->by_turn || (r->turns == 1 && !r->more)) &&
         is_simple(g, d->shares[n].value);
}

static int is_live(const Partials *p, int64_t arg) {
  return expr_map_get(p->live, expr_sum_arg(p->g, p->nest, (uint32_t)arg)) != 0;
}

static void add_value(Partials *p, int64_t arg, Expr value, int64_t i, int64_t j) {
  ExprGraph *g = p->g;
  ExprMap m = expr_map(g->arena);
  for (uint32_t k = 0; k < p->s->nreads; k++) {
    Expr at = expr_sum_arg(g, p->nest, (uint32_t)subscript_at(&p->s->reads[k].at, i, j));
    Expr symbol = expr_symbol(g, p->s->reads[k].symbol)->node;
    if (at != symbol) expr_map_set(&m, symbol, at);
  }
  Expr here = expr_replace_by(g, value, &m);
  expr_map_free(&m);
  p->value[arg] = p->value[arg] ? expr_add(g, p->value[arg], here) : here;
}

/* Appends what the turns add to an argument. */
static void take_value(Partials *p, uint32_t arg) {
  if (p->value[arg] && p->value[arg] != p->g->zero)
    vec_push(p->g->arena, &p->found, ((SumPartial){arg, p->value[arg]}));
  p->value[arg] = 0;
}

/* Derivatives of the only cell: those by arguments that simple values are added to as expressions. */
static void partials_of_only(Partials *p) {
  ExprGraph *g = p->g;
  const SumNest d = g->nests.at[p->number - 1];
  unsigned char *as_cell = ARENA_ARRAY(g->arena, unsigned char, p->s->nargs + 1);
  int64_t lo, hi;
  for (uint32_t n = 0; n < d.nshares; n++) {
    if (stands_alone(g, &d, n)) continue;
    int64_t step = subscript_step(&d.shares[n].at);
    if (!loop_extent(&d.range, &d.shares[n].at, &lo, &hi)) continue;
    for (int64_t k = lo; k <= hi; k += step ? step : 1) as_cell[k] = 1;
  }
  for (uint32_t n = 0; n < d.nshares; n++) {
    if (!stands_alone(g, &d, n) || !loop_extent(&d.range, &d.shares[n].at, &lo, &hi)) continue;
    for (int64_t i = 0; i < d.range.rows; i++)
      for (int64_t j = loop_from(&d.range, i); j < loop_to(&d.range, i); j++) {
        int64_t k = subscript_at(&d.shares[n].at, i, j);
        if (!as_cell[k] && is_live(p, k)) add_value(p, k, d.shares[n].value, i, j);
      }
  }
  for (uint32_t k = 0; k < p->s->nargs; k++)
    if (!is_live(p, k)) continue;
    else if (as_cell[k]) vec_push(g->arena, &p->found, ((SumPartial){k, expr_twin_cell(g, p->nest, p->number, k)}));
    else take_value(p, k);
}

typedef struct {
  int64_t row, turn;
} Turn;

typedef VEC(Turn) Turns;

/* The turns in which a share is added to cell c. */
static Turns turns_to(const SumNest *s, const Subscript *at, int64_t c, Arena *a) {
  Turns t = {0};
  int64_t first = 0, end = s->range.rows;
  if (at->by_row && !at->by_turn) {
    first = (c - at->first) / at->by_row;
    end = (c - at->first) % at->by_row || first < 0 || first >= end ? first : first + 1;
  }
  for (int64_t i = first; i < end; i++) {
    int64_t from = loop_from(&s->range, i), to = loop_to(&s->range, i), gap = c - at->first - at->by_row * i;
    if (at->by_turn ? gap % at->by_turn : gap) continue;
    if (at->by_turn && (gap / at->by_turn < from || gap / at->by_turn >= to)) continue;
    if (at->by_turn) from = gap / at->by_turn, to = from + 1;
    for (int64_t j = from; j < to; j++) vec_push(a, &t, ((Turn){i, j}));
  }
  return t;
}

/* Derivatives of cell c of several. */
static void partials_of_cell(Partials *p, uint32_t c) {
  ExprGraph *g = p->g;
  const SumNest *s = p->s, d = g->nests.at[p->number - 1];
  VEC(uint32_t) args = {0};
  Turns *turns = ARENA_ARRAY(g->arena, Turns, s->nshares + 1);
  uint32_t all = 0;
  for (uint32_t k = 0; k < s->nshares; k++) all += (turns[k] = turns_to(s, &s->shares[k].at, c, g->arena)).n;
  int few = !s->sampled && (all <= FEW_TURNS || d.ncells == MOST_CELLS);
  for (uint32_t k = 0; k < s->nshares; k++)
    for (uint32_t r = 0; r < s->nreads; r++) {
      Expr value = s->slopes[k * s->nreads + r];
      if (value == g->zero) continue;
      for (uint32_t t = 0; t < turns[k].n; t++) {
        Turn at = turns[k].at[t];
        int64_t arg = subscript_at(&s->reads[r].at, at.row, at.turn);
        if (!is_live(p, arg)) continue;
        if (!p->value[arg]) vec_push(g->arena, &args, (uint32_t)arg);
        if (few) add_value(p, arg, value, at.row, at.turn);
        else p->value[arg] = expr_twin_cell(g, p->nest, p->number, c * s->nargs + (uint32_t)arg);
      }
    }
  for (uint32_t k = 0; k < args.n; k++) take_value(p, args.at[k]);
}

SumPartials expr_sum_partials(ExprGraph *g, Expr cell, const ExprMap *live) {
  Expr nest = expr_cell_nest(g, cell);
  SumNest s = *expr_sum_nest(g, nest);
  if (g->nby_arg <= s.nargs) {
    g->nby_arg = 2 * s.nargs + 1;
    g->by_arg = ARENA_ARRAY(g->arena, Expr, g->nby_arg);
  }
  Partials p = {.g = g, .nest = nest, .s = &s, .number = s.gradient, .live = live, .value = g->by_arg};
  if (s.ncells == 1) partials_of_only(&p);
  else partials_of_cell(&p, expr_cell_number(g, cell));
  return (SumPartials){p.found.at, p.found.n};
}

/* --- along a direction --- */

/* Symbol for the rate of a read: that of its argument in the representative turn, where it is one that has an index. */
static SymId rate_symbol(ExprGraph *g, const SumNest *s, uint32_t r, Expr rate) {
  const char *name = expr_op(g, rate) == EX_SYM ? expr_sym_of(g, rate)->name : NULL;
  if (name && strchr(name, '[')) return expr_sym_id(g, rate);
  Expr node = expr_named_symbol(g, arena_printf(g->arena, "d_%s", expr_symbol(g, s->reads[r].symbol)->name));
  return expr_sym_id(g, node);
}

/* The read of the rates of what read r reads. */
static NestRead rate_read(ExprGraph *g, const SumNest *s, uint32_t r, SymId symbol) {
  NestRead x = s->reads[r];
  const char *name = expr_symbol(g, symbol)->name, *open = strchr(name, '['), *close = strchr(name, ']');
  x.symbol = symbol;
  x.at.first += s->nargs;
  x.stem = open ? intern(g->names, arena_strndup(g->arena, name, (size_t)(open - name))) : NULL;
  x.tail = close ? intern(g->names, close + 1) : NULL;
  return x;
}

/* Whether two reads have equal arguments in all turns; the second is of a rate. */
static int reads_agree(const SumNest *s, const Expr *args, const Subscript *x, const Subscript *y) {
  int64_t lo, hi, least, most;
  if (x->by_row != y->by_row || x->by_turn != y->by_turn || !loop_extent(&s->range, x, &lo, &hi) ||
      !loop_extent(&s->range, y, &least, &most))
    return 0;
  for (int64_t k = lo; k <= hi; k++)
    if (args[k] != args[least + k - lo]) return 0;
  return 1;
}

/* Position of the rate of read r among the reads, which may have it already; SIZE: 0, it vanishes everywhere. */
static uint32_t add_rate(ExprGraph *g, SumNest *s, NestRead *reads, const Expr *args, uint32_t r, uint32_t before) {
  int64_t lo, hi;
  int some = 0;
  if (!loop_extent(&s->range, &s->reads[r].at, &lo, &hi)) return UINT32_MAX;
  for (int64_t k = lo; k <= hi && !some; k++) some = args[s->nargs + k] != g->zero;
  if (!some) return UINT32_MAX;
  Expr rate = args[s->nargs + subscript_at(&s->reads[r].at, s->row, s->turn)];
  NestRead x = rate_read(g, s, r, rate_symbol(g, s, r, rate));
  for (uint32_t k = 0; k < before; k++)
    if (reads[k].symbol == x.symbol && reads_agree(s, args, &reads[k].at, &x.at)) return k;
  for (uint32_t k = 0; k < s->nreads; k++)
    if (reads[k].symbol == x.symbol)
      x.symbol = expr_sym_id(g, expr_named_symbol(g, arena_printf(g->arena, "d_%s", expr_symbol(g, x.symbol)->name)));
  reads[s->nreads] = x;
  return s->nreads++;
}

Expr expr_sum_rates(ExprGraph *g, Expr nest, const ExprMap *rate) {
  SumNest s = *expr_sum_nest(g, nest);
  uint32_t n = s.nargs, nreads = s.nreads;
  Expr *args = ARENA_ARRAY(g->arena, Expr, 2 * n + 1);
  const Expr *d = s.slopes;
  NestRead *reads = ARENA_ARRAY(g->arena, NestRead, 2 * nreads + 1);
  NestShare *shares = ARENA_ARRAY(g->arena, NestShare, s.nshares + 1);
  uint32_t *at = ARENA_ARRAY(g->arena, uint32_t, nreads + 1);
  int some = 0;
  for (uint32_t k = 0; k < n; k++) {
    args[k] = expr_sum_arg(g, nest, k);
    args[n + k] = expr_map_get(rate, args[k]);
    some |= args[n + k] && args[n + k] != g->zero;
    if (!args[n + k]) args[n + k] = g->zero;
  }
  if (!some) return 0;
  memcpy(reads, s.reads, nreads * sizeof *reads);
  for (uint32_t r = 0; r < nreads; r++) at[r] = add_rate(g, &s, reads, args, r, nreads);
  const NestShare *of = s.shares;
  uint32_t nof = s.nshares;
  s.nshares = 0;
  for (uint32_t k = 0; k < nof; k++) {
    Expr sum = g->zero;
    for (uint32_t r = 0; r < nreads; r++, d++) {
      if (at[r] == UINT32_MAX || *d == g->zero) continue;
      Expr part = expr_mul(g, *d, expr_symbol(g, reads[at[r]].symbol)->node);
      sum = expr_add(g, sum, part);
    }
    if (sum != g->zero) shares[s.nshares++] = (NestShare){sum, of[k].at};
  }
  if (!s.nshares) return 0;
  s.reads = reads;
  s.shares = shares;
  s.nargs = 2 * n;
  s.slopes = NULL;
  s.far = NULL;
  Expr cell = expr_sum_cell(g, &s, args, 0);
  return expr_cell_nest(g, cell);
}
