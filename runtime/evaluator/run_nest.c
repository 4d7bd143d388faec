/* Nests of loops: each operation of a turn is computed for a block of turns; sums are added to in the order of turns.
 */
#include <math.h>
#include <string.h>

#include "evaluator/program.h"
#include "lag_math.h"

/* The values of a block: NEST_BLOCK of each instruction, from 1; those that do not move are equal in all turns. */
typedef struct {
  const Program *p;
  const Nest *n;
  const double *const *in;
  double *r, *values, *part; /* part: sums of the row, by sum of the nest */
  int64_t row, from;         /* row, first turn of the block */
  int count;                 /* turns of the block */
} Block;

static double *value(const Block *b, uint32_t k) { return b->values + (size_t)k * NEST_BLOCK; }

/* Element of an array, or of the sums, in the first turn of the block. */
static int64_t first_index(const Block *b, uint32_t k) {
  const Subscript *s = &b->n->at[k];
  return b->n->has_turns ? s->first + s->by_row * b->row + s->by_turn * b->from : s->first + s->by_row * b->from;
}

static int64_t stride(const Nest *n, uint32_t k) { return n->has_turns ? n->at[k].by_turn : n->at[k].by_row; }

static void fill(double *to, double x, int n) {
  for (int j = 0; j < n; j++) to[j] = x;
}

static void gather(const Block *b, double *to, const double *from, uint32_t k) {
  int64_t step = stride(b->n, k);
  from += first_index(b, k);
  if (step == 1) memcpy(to, from, (size_t)b->count * sizeof *to);
  if (step == 1) return;
  for (int j = 0; j < b->count; j++, from += step) to[j] = *from;
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
  case TURN_INDEX:
    for (int64_t j = 0, at = first_index(b, k); j < b->count; j++, at += stride(b->n, k)) to[j] = (double)at;
    return;
  case TURN_OUTER: fill(to, b->r[b->n->outer[k]], b->count); return;
  }
}

static void compute(const Block *b, uint32_t s) {
  const TurnIns *i = &b->n->ins[s - 1];
  if (i->op <= TURN_OUTER) load(b, value(b, s), i);
  else turn_ops[i->op](value(b, s), value(b, i->a), value(b, i->b), value(b, i->c), b->count, i->number);
}

static void compute_all(const Block *b, uint32_t from, uint32_t end) {
  for (uint32_t k = from; k < end; k++) compute(b, b->n->order[k]);
}

/* *to := *to + x[0] + ...; or, minus, less them. */
static void add_up(double *to, const double *x, int n, int minus) {
  double sum = *to;
  for (int j = 0; j < n; j++) sum = minus ? sum - x[j] : sum + x[j];
  *to = sum;
}

/* The same to elements that lie `step` apart. */
static void add_each(double *to, int64_t step, const double *x, int n, int minus) {
  if (minus)
    for (int j = 0; j < n; j++, to += step) *to -= x[j];
  else
    for (int j = 0; j < n; j++, to += step) *to += x[j];
}

/* Adds n turns, from j on, to sum k. */
static void add_to(const Block *b, uint32_t k, int j, int n) {
  const TurnSum *s = &b->n->sum[k];
  const double *x = value(b, s->value) + j;
  int64_t step = s->moves ? stride(b->n, s->subscript) : 0;
  if (s->moves) add_each(b->r + b->p->cells + first_index(b, s->subscript) + j * step, step, x, n, (int)s->minus);
  else add_up(&b->part[k], x, n, (int)s->minus);
}

static void add(const Block *b) {
  for (uint32_t k = 0; b->n->apart && k < b->n->nsums; k++) add_to(b, k, 0, b->count);
  for (int j = 0; !b->n->apart && j < b->count; j++)
    for (uint32_t k = 0; k < b->n->nsums; k++) add_to(b, k, j, 1);
}

static void run_row(Block *b, int64_t from, int64_t end) {
  const Nest *n = b->n;
  double *sums = b->r + b->p->cells;
  int most = n->in_order ? 1 : NEST_BLOCK;
  b->from = from;
  b->count = end - from < NEST_BLOCK ? (int)(end - from) : NEST_BLOCK;
  compute_all(b, 0, n->fixed);
  for (uint32_t k = 0; k < n->nsums; k++) b->part[k] = 0;
  for (int64_t j = from; j < end; j += b->count) {
    b->from = j;
    b->count = end - j < most ? (int)(end - j) : most;
    compute_all(b, n->fixed, n->nins);
    add(b);
  }
  for (uint32_t k = 0; k < n->nsums; k++)
    if (!n->sum[k].moves) sums[first_index(b, n->sum[k].subscript)] += b->part[k];
}

void lag_run_nest(const Program *p, const Nest *n, const double *const *in, double *r) {
  Block b = {.p = p, .n = n, .in = in, .r = r, .values = r + p->scratch};
  if ((uintptr_t)(void *)b.values % (2 * sizeof(double))) b.values++; /* as vectors lie */
  b.part = b.values + (size_t)(n->nins + 1) * NEST_BLOCK;
  fill(b.values, 0, NEST_BLOCK);
  if (!n->has_turns) run_row(&b, 0, n->rows);
  for (b.row = 0; n->has_turns && b.row < n->rows; b.row++)
    run_row(&b, n->skew * b.row, (n->skew + n->more) * b.row + n->turns);
}
