/* Two loops whose array indices are affine in their counters, as sums over pairs need. */
#pragma once

#include <stdint.h>

/* Array index in row i, turn j of two loops: first + by_row*i + by_turn*j. */
typedef struct {
  int64_t first, by_row, by_turn;
} Subscript;

/* for i in 0 .. rows - 1, for j in skew*i .. skew*i + turns + more*i - 1. */
typedef struct {
  uint32_t rows;
  int64_t skew, turns, more;
} LoopRange;

static inline int64_t subscript_at(const Subscript *x, int64_t i, int64_t j) {
  return x->first + x->by_row * i + x->by_turn * j;
}

/* That with i and j exchanged. */
static inline Subscript subscript_exchanged(Subscript x) { return (Subscript){x.first, x.by_turn, x.by_row}; }

/* Turns of row i, at least 0; first turn of row i, and one past its last. */
static inline int64_t loop_turns(const LoopRange *r, int64_t i) {
  int64_t n = r->turns + r->more * i;
  return n > 0 ? n : 0;
}
static inline int64_t loop_from(const LoopRange *r, int64_t i) { return r->skew * i; }
static inline int64_t loop_to(const LoopRange *r, int64_t i) { return r->skew * i + loop_turns(r, i); }

/* Greatest common divisor of the steps; 0: none. */
static inline int64_t subscript_step(const Subscript *x) {
  int64_t a = x->by_row, b = x->by_turn;
  while (b) {
    int64_t rest = a % b;
    a = b;
    b = rest;
  }
  return a < 0 ? -a : a;
}

/* Cells least, least + 1 ... in another order, from `base` on: `step` rows of `each`. Those of one component of a
 * family of vectors, which lie `step` apart, come to lie side by side. */
typedef struct {
  int64_t least, step, each, base;
} CellOrder;

/* Lets turns with these indices have cells side by side. */
static inline void cells_follow(CellOrder *o, const Subscript *x) {
  o->step = subscript_step(&(Subscript){0, o->step, subscript_step(x)});
}
static inline void cells_complete(CellOrder *o, int64_t most) {
  if (!o->step) o->step = 1;
  o->each = (most - o->least + o->step) / o->step;
}
static inline Subscript cell_in_order(const CellOrder *o, const Subscript *x) {
  int64_t from = x->first - o->least, row = (from % o->step + o->step) % o->step;
  return (Subscript){o->base + row * o->each + (from - row) / o->step, x->by_row / o->step, x->by_turn / o->step};
}

/* Whether turn k of n belongs to the sample by which the self-check compares long sums: the ends and the middle. */
static inline int loop_samples(int64_t k, int64_t n) { return k < 2 || k >= n - 2 || k == n / 2; }

/* Least and greatest index in all turns; 0: there is no turn. Rows with turns follow one another, and an affine index
 * is extreme at the ends of the first and the last of them. */
static inline int loop_extent(const LoopRange *r, const Subscript *x, int64_t *least, int64_t *most) {
  int64_t a = 0, b = (int64_t)r->rows - 1;
  *least = *most = 0;
  while (a <= b && !loop_turns(r, a)) a++;
  while (a < b && !loop_turns(r, b)) b--;
  if (a > b) return 0;
  for (int k = 0; k < 4; k++) {
    int64_t i = k < 2 ? a : b, at = subscript_at(x, i, k % 2 ? loop_to(r, i) - 1 : loop_from(r, i));
    if (!k || at < *least) *least = at;
    if (!k || at > *most) *most = at;
  }
  return 1;
}
