/* Sums over all pairs (i, j) of a square, as those that each member of a family has, taken once for (i, j) and (j, i):
 * what the two have in common, a distance or an odd function, is computed once. */
#include "lower/lower_impl.h"
#include "sym/expr_eval.h"
#include "sym/prove.h"
#include "sym/sum_nest.h"

typedef struct {
  ExprGraph *g;
  Expr nest;
  SumNest half;
  NestRead *reads; /* of the half */
  Expr *symbol, *mirror; /* [nreads] node of a read; that of the read of the same argument with i and j exchanged */
  Expr *row;             /* [nreads] the same on the diagonal: what reads at j reads at i */
} Square;

/* Whether x reads in turn (i, j) what y reads in turn (j, i). */
static int is_mirror(const Square *q, const NestRead *x, const NestRead *y) {
  if (x->at.by_row != y->at.by_turn || x->at.by_turn != y->at.by_row) return 0;
  if (x->at.first == y->at.first) return 1;
  for (int64_t k = 0; k < q->half.range.rows; k++) { /* indices as numbers have arguments of their own */
    const int64_t by = k * (x->at.by_row + x->at.by_turn);
    Expr a = expr_sum_arg(q->g, q->nest, (uint32_t)(x->at.first + by));
    if (!expr_is_num(q->g, a) || a != expr_sum_arg(q->g, q->nest, (uint32_t)(y->at.first + by))) return 0;
  }
  return 1;
}

static Subscript exchanged(Subscript x) { return (Subscript){x.first, x.by_turn, x.by_row}; }

/* Appends the read of what read x reads in turn (j, i); 0: its argument is no symbol, or one that another read has. */
static int add_mirror(Square *q, const NestRead *x) {
  NestRead r = *x;
  r.at = exchanged(x->at);
  for (uint32_t k = 0; k < r.nindices; k++) r.index[k] = exchanged(x->index[k]);
  Expr node = expr_sum_arg(q->g, q->nest, (uint32_t)subscript_at(&r.at, q->half.row, q->half.turn));
  if (expr_op(q->g, node) != EX_SYM) return 0;
  r.symbol = expr_sym_id(q->g, node);
  for (uint32_t k = 0; k < q->half.nreads; k++)
    if (q->reads[k].symbol == r.symbol) return 0;
  q->reads[q->half.nreads++] = r;
  return 1;
}

/* Finds the reads with i and j exchanged, or appends them; 0: some have none. */
static int find_mirrors(Square *q) {
  for (uint32_t k = 0; k < q->half.nreads; k++) {
    uint32_t m = 0;
    if (q->reads[k].at.by_row && q->reads[k].at.by_turn) return 0;
    while (m < q->half.nreads && !is_mirror(q, &q->reads[k], &q->reads[m])) m++;
    if (m == q->half.nreads && !add_mirror(q, &q->reads[k])) return 0;
    q->symbol[k] = expr_symbol(q->g, q->reads[k].symbol)->node;
    q->mirror[k] = expr_symbol(q->g, q->reads[m].symbol)->node;
    q->row[k] = q->reads[k].at.by_turn ? q->mirror[k] : q->symbol[k];
  }
  return 1;
}

/* Whether the values vanish for i = j, as where a condition says so, and not because 0 times 1/0 does. */
static int vanish_on_diagonal(const Square *q, const Expr *values, uint32_t n) {
  ExprGraph *g = q->g;
  Arena *a = expr_arena(g);
  Expr *there = ARENA_ARRAY(a, Expr, n + 1);
  long double *symbols = ARENA_ARRAY(a, long double, expr_symbol_count(g) + 1);
  long double *at = ARENA_ARRAY(a, long double, n + 1);
  expr_replace_nodes(g, values, n, q->symbol, q->row, q->half.nreads, there);
  for (uint32_t k = 0; k < n; k++)
    if (!expr_is_zero(g, there[k])) return 0;
  sample_state(g, 1, symbols);
  for (uint32_t k = 0; k < q->half.nreads; k++)
    symbols[q->reads[k].symbol] = symbols[expr_sym_id(g, q->row[k])];
  expr_eval(g, values, n, symbols, at);
  for (uint32_t k = 0; k < n; k++)
    if (at[k] != 0) return 0;
  return 1;
}

/* Decides comparisons of i and j in `values` for j below i. */
static void decide_below(const Square *q, Expr *values, uint32_t n) {
  ExprGraph *g = q->g;
  static const ExprOp op[] = {EX_EQ, EX_LT, EX_LE, EX_LT, EX_LE}; /* of i and j, and twice of j and i */
  for (uint32_t k = 0; k < q->half.nreads; k++) {
    const NestRead *r = &q->reads[k];
    if (!r->stem || *r->stem || !r->at.by_row) continue;
    Expr i = q->symbol[k], j = q->mirror[k], from[5], to[5];
    for (int c = 0; c < 5; c++) {
      from[c] = c < 3 ? expr_fn2(g, op[c], i, j) : expr_fn2(g, op[c], j, i);
      to[c] = expr_int(g, c >= 3);
    }
    expr_replace_nodes(g, values, n, from, to, 5, values);
  }
}

/* Whether the values and their mirrors have a quarter of their nodes in common. */
static int share_nodes(ExprGraph *g, const Expr *values, uint32_t n) {
  ExprList both = expr_topo(g, values, 2 * n);
  uint32_t of_both = both.n;
  expr_list_free(g, both);
  ExprList one = expr_topo(g, values, n);
  uint32_t of_one = one.n;
  expr_list_free(g, one);
  return 2 * of_both <= 3 * of_one;
}

const SumNest *nest_half(ExprGraph *g, Expr nest) {
  Arena *a = expr_arena(g);
  const SumNest *s = expr_sum_nest(g, nest);
  const LoopRange *r = &s->range;
  const uint32_t n = s->nshares;
  if (s->near || s->far || s->ncells == 1 || r->rows < 3 || r->skew || r->more || r->turns != r->rows) return NULL;
  Square q = {.g = g, .nest = nest, .half = *s, .reads = ARENA_ARRAY(a, NestRead, 2 * s->nreads + 1),
              .symbol = ARENA_ARRAY(a, Expr, 2 * s->nreads + 1), .mirror = ARENA_ARRAY(a, Expr, 2 * s->nreads + 1),
              .row = ARENA_ARRAY(a, Expr, 2 * s->nreads + 1)};
  if (s->nreads) memcpy(q.reads, s->reads, s->nreads * sizeof *q.reads);
  if (!find_mirrors(&q)) return NULL;
  Expr *values = ARENA_ARRAY(a, Expr, 2 * n + 1);
  for (uint32_t k = 0; k < n; k++) values[k] = s->shares[k].value;
  if (!vanish_on_diagonal(&q, values, n)) return NULL;
  expr_replace_nodes(g, values, n, q.symbol, q.mirror, q.half.nreads, values + n);
  decide_below(&q, values, 2 * n);
  if (!share_nodes(g, values, n)) return NULL;
  NestShare *shares = ARENA_ARRAY(a, NestShare, 2 * n + 1);
  for (uint32_t k = 0; k < n; k++) {
    shares[k] = (NestShare){values[k], s->shares[k].at};
    shares[n + k] = (NestShare){values[n + k], exchanged(s->shares[k].at)};
  }
  SumNest *half = ARENA_NEW(a, SumNest);
  *half = q.half;
  half->range = (LoopRange){.rows = r->rows, .more = 1};
  half->reads = q.reads;
  half->shares = shares;
  half->nshares = 2 * n;
  return half;
}
