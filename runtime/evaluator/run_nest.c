/* Nests of loops: each operation is computed for a block of turns, of several rows; sums are added to in the order
 * of turns. */
#include <string.h>

#include "evaluator/program.h"
#include "lag_math.h"
#include "lag_support.h"
#include "lag_tree.h"

/* Turns of one row that lie side by side in a block. */
typedef struct {
  int64_t row, from; /* the first turn */
  int at, count, ends; /* place of the first in the block; ends: the row has no more turns */
  const int *list;     /* the turns, of a nest over neighbours; else NULL: from, from + 1 ... */
} Segment;

static int64_t turn_of(const Segment *g, int j) { return g->list ? g->list[j] : g->from + j; }

/* The values of a block: NEST_BLOCK of each instruction, from 1. */
typedef struct {
  const Program *p;
  const Nest *n;
  const double *const *in;
  double *const *out;
  double *r, *values, *part; /* part: sums of the row, by sum of the nest */
  int64_t last_row;          /* first row of the last block; -1: none */
  int count, nsegments;
  Segment *segment;
} Block;

static double *value(const Block *b, uint32_t k) { return b->values + (size_t)k * NEST_BLOCK; }

/* Element of an array, or of the sums, in the first turn of a segment. */
static int64_t first_index(const Nest *n, const Segment *g, uint32_t k) {
  const Subscript *s = &n->at[k];
  return s->first + s->by_row * g->row + s->by_turn * g->from;
}

static void fill(double *to, double x, int n) {
  int j = 0;
  for (; j + 4 <= n; j += 4) to[j] = to[j + 1] = to[j + 2] = to[j + 3] = x;
  for (; j < n; j++) to[j] = x;
}

/* to[n] := elements that lie `step` apart. */
static void copy_apart(double *to, const double *from, int64_t step, int n) {
  int j = 0;
  for (; j + 4 <= n; j += 4, from += 4 * step)
    to[j] = from[0], to[j + 1] = from[step], to[j + 2] = from[2 * step], to[j + 3] = from[3 * step];
  for (; j < n; j++, from += step) to[j] = *from;
}

static void gather(const Block *b, double *to, const double *from, uint32_t k) {
  int64_t step = b->n->at[k].by_turn;
  for (const Segment *g = b->segment; g < b->segment + b->nsegments; g++) {
    const double *first = from + first_index(b->n, g, k);
    if (g->list && step)
      for (int j = 0; j < g->count; j++) to[g->at + j] = first[g->list[j] * step];
    else if (step) copy_apart(to + g->at, first, step, g->count);
    else fill(to + g->at, *first, g->count);
  }
}

/* to[n] := the index itself. */
static void count_up(const Block *b, double *to, uint32_t k) {
  int64_t step = b->n->at[k].by_turn;
  for (const Segment *g = b->segment; g < b->segment + b->nsegments; g++)
    for (int j = 0; j < g->count; j++)
      to[g->at + j] = (double)(first_index(b->n, g, k) + (turn_of(g, j) - g->from) * step);
}

/* to[n] := an operation of x, y, z; k: number of a function. */
typedef void turn_op(double *to, const double *x, const double *y, const double *z, int n, uint32_t k);

#define A x[j]
#define B y[j]
#define C z[j]
#define ARGUMENTS double *to, const double *x, const double *y, const double *z, int n, uint32_t k
#define UNUSED_ARGUMENTS (void)one, (void)two, (void)x, (void)y, (void)z, (void)k
#define EACH(name, formula)                        \
  static void of_##name(ARGUMENTS) {               \
    lag_function_1 *const *one = lag_functions_1;  \
    lag_function_2 *const *two = lag_functions_2;  \
    for (int j = 0; j < n; j++) to[j] = (formula); \
    UNUSED_ARGUMENTS;                              \
  }
#if defined(__GNUC__)
/* Pairs of turns by vectors, two pairs at once: the last turns may be ones that nobody needs. */
typedef double pair __attribute__((vector_size(16)));
enum { PAIR = 2, FOUR = 4 };
#define AT(turn, formula) \
  {                       \
    const int j = turn;   \
    sum[j] = (formula);   \
  }
#define VECTOR(name, operands, formula)                                                                     \
  static void of_##name(double *to, const double *a, const double *b, const double *c, int n, uint32_t k) { \
    const pair *x = (const void *)a, *y = (const void *)b;                                                  \
    pair *sum = (void *)to;                                                                                 \
    int end = (n + FOUR - 1) / FOUR * PAIR;                                                                 \
    for (int part = 0; part < end; part += 2) {                                                             \
      AT(part, formula)                                                                                     \
      AT(part + 1, formula)                                                                                 \
    }                                                                                                       \
    (void)y, (void)c, (void)k;                                                                              \
  }
#else
#define VECTOR(name, operands, formula) EACH(name, formula)
#endif
#define OP(name, operands, formula) OP_##operands(name, formula)
#define OP_0(name, formula)
#define OP_1 EACH
#define OP_2 EACH
#define OP_3 EACH
PROGRAM_TURN_OPS(OP, VECTOR)
#undef OP
#undef OP_0
#undef OP_1
#undef OP_2
#undef OP_3
#undef VECTOR

static turn_op *const turn_ops[] = {
#define OP_0(name) NULL
#define OP_1(name) of_##name
#define OP_2(name) of_##name
#define OP_3(name) of_##name
#define OP(name, operands, formula) OP_##operands(name),
    PROGRAM_TURN_OPS(OP, OP)};

static void load(const Block *b, double *to, const TurnIns *i) {
  uint32_t k = i->number;
  switch (i->op) {
  case TURN_CONSTANT: fill(to, b->p->constants[k], b->count); return;
  case TURN_ELEMENT: gather(b, to, b->in[i->a], k); return;
  case TURN_SCALAR: fill(to, b->in[i->a][0], b->count); return;
  case TURN_CELL: gather(b, to, b->r + b->p->cells, k); return;
  case TURN_INDEX: count_up(b, to, k); return;
  case TURN_OUTER: fill(to, b->r[b->n->outer[k]], b->count); return;
  }
}

static void compute(const Block *b, uint32_t s) {
  const TurnIns *i = &b->n->ins[s - 1];
  if (i->op <= TURN_OUTER) load(b, value(b, s), i);
  else turn_ops[i->op](value(b, s), value(b, i->a), value(b, i->b), value(b, i->c), b->count, i->number);
}

static void compute_all(const Block *b, TurnLevel level) {
  for (uint32_t k = level ? b->n->end[level - 1] : 0; k < b->n->end[level]; k++) compute(b, b->n->order[k]);
}

/* *to := *to + x[0] + ...; or, minus, less them. */
static void add_up(double *to, const double *x, int n, int minus) {
  double sum = *to;
  if (minus)
    for (int j = 0; j < n; j++) sum -= x[j];
  else
    for (int j = 0; j < n; j++) sum += x[j];
  *to = sum;
}

/* The same to elements that lie `step` apart, or are one. */
static void add_each(double *to, int64_t step, const double *x, int n, int minus) {
  int j = 0;
  if (minus) {
    for (; j + 2 <= n; j += 2, to += 2 * step) to[0] -= x[j], to[step] -= x[j + 1];
    if (j < n) *to -= x[j];
  } else {
    for (; j + 2 <= n; j += 2, to += 2 * step) to[0] += x[j], to[step] += x[j + 1];
    if (j < n) *to += x[j];
  }
}

/* Adds n turns of a segment, from j on, to sum k. */
static void add_to(const Block *b, const Segment *g, uint32_t k, int j, int n) {
  const TurnSum *s = &b->n->sum[k];
  const double *x = value(b, s->value) + g->at + j;
  if (!s->moves) {
    add_up(&b->part[k], x, n, (int)s->how);
    return;
  }
  int64_t step = b->n->at[s->subscript].by_turn, at = first_index(b->n, g, s->subscript) + j * step;
  if (s->how >= NEST_SETS) {
    for (double *to = b->out[s->how - NEST_SETS] + at; n-- > 0; to += step) *to = *x++;
    return;
  }
  add_each(b->r + b->p->cells + at, step, x, n, (int)s->how);
}

/* Sums of a row go to their elements at its end. */
static void end_row(const Block *b, const Segment *g) {
  for (uint32_t k = 0; k < b->n->nsums; k++) {
    const TurnSum *s = &b->n->sum[k];
    if (!s->moves) b->r[b->p->cells + (uint64_t)first_index(b->n, g, s->subscript)] += b->part[k];
    b->part[k] = 0;
  }
}

/* The turns of a list that pass the test, one by one. */
static void add_tested(const Block *b, const Segment *g) {
  const double *test = value(b, b->n->near.test) + g->at;
  for (int j = 0; j < g->count; j++)
    for (uint32_t k = 0; test[j] != 0 && k < b->n->nsums; k++) {
      const TurnSum *s = &b->n->sum[k];
      int64_t at = first_index(b->n, g, s->subscript) + turn_of(g, j) * b->n->at[s->subscript].by_turn;
      double *to = s->moves ? b->r + b->p->cells + at : &b->part[k];
      *to += s->how ? -value(b, s->value)[g->at + j] : value(b, s->value)[g->at + j];
    }
}

static void add(const Block *b) {
  const Nest *n = b->n;
  for (const Segment *g = b->segment; g < b->segment + b->nsegments; g++) {
    if (g->list) add_tested(b, g);
    if (g->list && g->ends) end_row(b, g);
    if (g->list) continue;
    for (uint32_t k = 0; n->apart && k < n->nsums; k++) add_to(b, g, k, 0, g->count);
    for (int j = 0; !n->apart && j < g->count; j++)
      for (uint32_t k = 0; k < n->nsums; k++) add_to(b, g, k, j, 1);
    if (g->ends) end_row(b, g);
  }
}

/* Computes the block, adds it up, and begins the next. */
static void finish_block(Block *b) {
  const Segment *g = b->segment;
  if (!b->count) return;
  if (b->nsegments > 1 || g->row != b->last_row) compute_all(b, IN_ROW);
  b->last_row = g->row;
  compute_all(b, IN_TURN);
  add(b);
  b->count = b->nsegments = 0;
}

/* list: of the turns from, from + 1 ...; or NULL. */
static void run_row(Block *b, int64_t row, int64_t from, int64_t end, const int *list, int most) {
  while (from < end) {
    int room = most - b->count, count = end - from < room ? (int)(end - from) : room;
    b->segment[b->nsegments++] =
        (Segment){row, list ? 0 : from, b->count, count, from + count == end, list ? list + from : NULL};
    b->count += count, from += count;
    if (b->count == most) finish_block(b);
  }
}

uint64_t lag_near_room(int members) {
  uint64_t n = (uint64_t)members;
  return LAG_NEAR_NUMBERS(n) + LAG_NEAR_INTS(n) / 2 + 1;
}

/* Makes the list of neighbours, behind the sums of rows. */
static void find_neighbours(const Block *b, lag_near *w) {
  const Near *x = &b->n->near;
  double *places = b->part + b->n->nsums + 1, side[3] = {0};
  const Subscript *j = &b->n->at[x->at_j[0]];
  int *ints = (int *)(void *)(places + LAG_NEAR_NUMBERS(x->members));
  lag_near_open(w, x->members, (int)x->n, (int)j->by_turn, places, ints);
  for (uint32_t c = 0; c < x->n; c++) {
    w->first[c] = (int)b->n->at[x->at_j[c]].first;
    side[c] = x->side[c] ? b->r[b->n->outer[x->side[c] - 1]] : 0;
  }
  lag_near_find(w, b->in[PROGRAM_Q], b->r[b->n->outer[x->cut]], side);
}

static void run_neighbours(Block *b, int most) {
  lag_near near = {0};
  find_neighbours(b, &near);
  for (int64_t row = 0; row < b->n->rows; row++) {
    const int *list;
    int n = lag_near_of(&near, (int)(row + b->n->turns), &list);
    run_row(b, row, 0, n, list, most);
    if (list == near.row || b->n->turn_order != ANY_ORDER) finish_block(b); /* the next row may use its memory */
  }
  finish_block(b);
}

uint64_t lag_tree_room(int members) {
  uint64_t n = (uint64_t)members;
  return LAG_TREE_NUMBERS(n) + LAG_TREE_INTS(n) / 2 + 1;
}

static void run_tree(const Program *p, const Far *x, const uint32_t *outer, const double *const *in, double *r) {
  double numbers[3], *room = r + p->scratch;
  lag_tree w = {.parts = x->n, .step = x->step, .energy = x->energy, .by = x->by};
  for (int k = 0; k < 3; k++) {
    w.first[k] = x->first[k], w.slope[k] = x->slope[k];
    numbers[k] = r[outer[x->numbers[k]]];
  }
  lag_tree_open(&w, x->members, room, (int *)(void *)(room + LAG_TREE_NUMBERS((uint64_t)x->members)));
  lag_tree_sum(&w, in[PROGRAM_Q], r + p->cells + x->charge, numbers, r + p->cells);
}

void lag_run_nest(const Program *p, const Nest *n, const double *const *in, double *const *out, double *r) {
  if (n->far.n) {
    run_tree(p, &n->far, n->outer, in, r);
    return;
  }
  Segment segment[NEST_BLOCK];
  Block b = {p, n, in, out, r, .values = r + p->scratch, .last_row = -1, .count = NEST_BLOCK, .segment = segment};
  int most = n->turn_order == TURN_BY_TURN ? 1 : NEST_BLOCK;
  if ((uintptr_t)(void *)b.values % (2 * sizeof(double))) b.values++; /* as vectors lie */
  b.part = b.values + (size_t)(n->nins + 1) * NEST_BLOCK;
  fill(b.values, 0, NEST_BLOCK);
  fill(b.part, 0, (int)n->nsums);
  b.segment[b.nsegments++] = (Segment){.count = NEST_BLOCK};
  compute_all(&b, IN_NEST);
  b.count = b.nsegments = 0;
  if (n->near.n) {
    run_neighbours(&b, most);
    return;
  }
  for (int64_t row = 0; row < n->rows; row++) {
    run_row(&b, row, n->skew * row, (n->skew + n->more) * row + n->turns, NULL, most);
    if (n->turn_order != ANY_ORDER) finish_block(&b);
  }
  finish_block(&b);
}
