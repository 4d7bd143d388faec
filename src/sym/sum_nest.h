/* Quantified sums as nodes: all sums that two loops accumulate, of a body that is kept once.
 *
 * sum(i in 1..N, sum(j in 1..i-1, f(x[i], x[j]))) is CELL 0 of a NEST whose arguments are x[1] ... x[N] and whose body
 * f is written in the symbols of one turn, x[5] and x[2]. The derivatives of that sum by all of its arguments are the
 * cells of a second nest: each turn adds df/dx[5] to the cell of x[i], and df/dx[2] to that of x[j]. So both are as
 * long as f, whatever N is. */
#pragma once

#include "sym/expr.h"

/* Sum number `cell` of the nest over the arguments args[s->nargs]. */
Expr expr_sum_cell(ExprGraph *g, const SumNest *s, const Expr *args, uint32_t cell);

/* Number of the nest of these sums; reads that no share needs are dropped. */
uint32_t expr_sum_number(ExprGraph *g, SumNest *s);

/* Sum number `cell` of a NEST; of nest `number` over the arguments of `nest`. */
Expr expr_cell_of(ExprGraph *g, Expr nest, uint32_t cell);
Expr expr_twin_cell(ExprGraph *g, Expr nest, uint32_t number, uint32_t cell);
uint32_t expr_nest_number(const ExprGraph *g, Expr nest);

/* A NEST of these arguments; where some have become 0 in all turns, the body has 0 in their place, as readers see the
 * body. A CELL; 0 where no turn adds to any. */
Expr expr_nest_rebuilt(ExprGraph *g, const Expr *args, uint32_t n);
Expr expr_cell_rebuilt(ExprGraph *g, const Expr *args);

/* Of a NEST: its sums; argument i. Of a CELL: its NEST, and its number. */
const SumNest *expr_sum_nest(const ExprGraph *g, Expr nest);
uint32_t expr_sum_args(const ExprGraph *g, Expr nest);
Expr expr_sum_arg(const ExprGraph *g, Expr nest, uint32_t i);
Expr expr_cell_nest(const ExprGraph *g, Expr cell);
uint32_t expr_cell_number(const ExprGraph *g, Expr cell);

/* Number of turns of all rows. */
uint64_t expr_sum_turns(const ExprGraph *g, Expr nest);

/* The nodes below the roots, and those of the bodies of their sums, which stand in the symbols of one turn. */
ExprList expr_topo_with_bodies(ExprGraph *g, const Expr *roots, uint32_t n);

/* out[i] = roots[i] with all cells written out as sums. */
void expr_expand_sums(ExprGraph *g, const Expr *roots, uint32_t n, Expr *out);

/* Writes out the sums of *e; 0: they have too many terms for a proof or a reader. */
int expr_open_sums(ExprGraph *g, Expr *e);

/* The same for the cells of a list. */
void expr_write_out(ExprGraph *g, const Expr *roots, uint32_t n, const Expr *cells, uint32_t ncells, Expr *out);

/* sum_mirror.c: the reads of a nest over all pairs of a square, and those with i and j exchanged, which are appended
 * where the nest has none; nodes of their symbols, and of those of their mirrors, to be put for them. 0: it is another
 * nest, or reads at sums of i and j. */
typedef struct {
  uint32_t n;
  NestRead *reads;
  Expr *symbol, *mirror; /* [n] */
} SumMirror;
int expr_sum_mirror(ExprGraph *g, Expr nest, SumMirror *to);

/* sum_gather.c: the body whose sum over all turns is what the cells of one nest contribute to the sum e, linear in
 * them; *rest: the other terms. 0: e has no cells, or their factors differ from turn to turn. */
Expr expr_gather_sum(ExprGraph *g, Expr e, Expr *rest);

/* sum_terms.c: where the turns that add to a cell stand: in one row, or in rows[0] to rows[1]; in one turn of each, or
 * in all; and the arguments that their term names without a running index. */
typedef struct {
  uint32_t share;
  int fixed_row, fixed_turn;
  int64_t row, turn, rows[2];
  uint32_t nargs;
  const Expr *args;
} SumPlace;

typedef struct {
  const SumPlace *at;
  uint32_t n;
} SumPlaces;
SumPlaces expr_sum_places(ExprGraph *g, Expr cell);

/* A cell as a person writes it: a sum over i and j, or for a derivative the sums over the index that is
 * left; the body is in symbols that have the names r[i].x. */
typedef struct {
  int minus;
  const char *index[2], *from[2], *to[2]; /* index NULL: no (second) sum */
  Expr body;
} SumTerm;

typedef struct {
  const SumTerm *at;
  uint32_t n;
} SumTerms;
SumTerms expr_sum_terms(ExprGraph *g, Expr cell);

/* The symbol with that text as its name, which stands for a member with a running index. */
Expr expr_named_symbol(ExprGraph *g, const char *text);
