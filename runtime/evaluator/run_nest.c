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
  for (int j = 0; j < b->count; j++) to[j] = from[j * step];
}

/* Four turns at once, where the compiler has vectors; the last ones may compute values that nobody needs. */
#if defined(__GNUC__)
typedef double four __attribute__((vector_size(32), aligned(8), may_alias));
#else
typedef double four;
#endif
enum { FOUR = (int)(sizeof(four) / sizeof(double)) };

static void compute(const Block *b, uint32_t s) {
  const TurnIns *i = &b->n->ins[s - 1];
  double *to = value(b, s);
  const double *of[] = {value(b, i->a), value(b, i->b), value(b, i->c)};
  lag_function_1 *const *one = lag_functions_1;
  lag_function_2 *const *two = lag_functions_2;
  uint32_t k = i->number;
  int n = b->count;
#define A x[j]
#define B y[j]
#define C z[j]
#define LOOP(Type, turns, name, formula)                                                     \
  case TURN_##name: {                                                                        \
    const Type *x = (const void *)of[0], *y = (const void *)of[1], *z = (const void *)of[2]; \
    for (int j = 0; j < (turns); j++) ((Type *)(void *)to)[j] = (formula);                   \
    (void)x, (void)y, (void)z;                                                               \
    return;                                                                                  \
  }
#define VECTOR(name, operands, formula) LOOP(four, (n + FOUR - 1) / FOUR, name, formula)
#define OP(name, operands, formula) OP_##operands(name, formula)
#define OP_0(name, formula)
#define OP_1(name, formula) LOOP(double, n, name, formula)
#define OP_2 OP_1
#define OP_3 OP_1
  switch (i->op) {
    PROGRAM_TURN_OPS(OP, VECTOR)
  case TURN_CONSTANT: fill(to, b->p->constants[k], n); return;
  case TURN_ELEMENT: gather(b, to, b->in[i->a], k); return;
  case TURN_SCALAR: fill(to, b->in[i->a][0], n); return;
  case TURN_CELL: gather(b, to, b->r + b->p->cells, k); return;
  case TURN_OUTER: fill(to, b->r[b->n->outer[k]], n); return;
  }
}

/* Loads come first, as in C; then the other values. */
static void compute_all(const Block *b, int moves) {
  for (int loads = 1; loads >= 0; loads--)
    for (uint32_t s = 1; s <= b->n->nins; s++)
      if (b->n->ins[s - 1].moves == moves && (b->n->ins[s - 1].op <= TURN_OUTER) == loads) compute(b, s);
}

/* Adds turns from .. end - 1 to sum k. */
static void add_to(const Block *b, uint32_t k, int from, int end) {
  const TurnSum *s = &b->n->sum[k];
  const double *x = value(b, s->value);
  int64_t step = s->moves ? stride(b->n, s->subscript) : 0;
  double *to = s->moves ? b->r + b->p->cells + first_index(b, s->subscript) : &b->part[k];
  for (int j = from; j < end && !s->minus; j++) to[j * step] += x[j];
  for (int j = from; j < end && s->minus; j++) to[j * step] -= x[j];
}

static void add(const Block *b) {
  for (uint32_t k = 0; b->n->apart && k < b->n->nsums; k++) add_to(b, k, 0, b->count);
  for (int j = 0; !b->n->apart && j < b->count; j++)
    for (uint32_t k = 0; k < b->n->nsums; k++) add_to(b, k, j, j + 1);
}

static void run_row(Block *b, int64_t from, int64_t end) {
  const Nest *n = b->n;
  double *sums = b->r + b->p->cells;
  int most = n->in_order ? 1 : NEST_BLOCK;
  b->from = from;
  b->count = end - from < NEST_BLOCK ? (int)(end - from) : NEST_BLOCK;
  compute_all(b, 0);
  for (uint32_t k = 0; k < n->nsums; k++) b->part[k] = 0;
  for (int64_t j = from; j < end; j += b->count) {
    b->from = j;
    b->count = end - j < most ? (int)(end - j) : most;
    compute_all(b, 1);
    add(b);
  }
  for (uint32_t k = 0; k < n->nsums; k++)
    if (!n->sum[k].moves) sums[first_index(b, n->sum[k].subscript)] += b->part[k];
}

void lag_run_nest(const Program *p, const Nest *n, const double *const *in, double *r) {
  Block b = {.p = p, .n = n, .in = in, .r = r, .values = r + p->scratch};
  b.part = b.values + (size_t)(n->nins + 1) * NEST_BLOCK;
  fill(b.values, 0, NEST_BLOCK);
  if (!n->has_turns) run_row(&b, 0, n->rows);
  for (b.row = 0; n->has_turns && b.row < n->rows; b.row++)
    run_row(&b, n->skew * b.row, (n->skew + n->more) * b.row + n->turns);
}
