/* series_arrange: renumbers sums and constants of long families so that those that one loop of `next` reads are neighbours.
 *
 * Before, they are numbered member by member: loops read them at equal distances, and in the order of numbers values of several
 * loops alternate, so that no loop can store them. Each run at equal distances becomes a run of neighbours. */
#include <stdlib.h>

#include "ir/roll.h"
#include "series/series_impl.h"

/* A run: the indices first, first + step, ... that a loop reads. */
typedef struct {
  uint32_t first, step, count;
} Run;
typedef VEC(Run) RunList;

typedef struct {
  uint32_t n;
  uint32_t *place; /* by old index: new index + 1; 0: not placed yet */
  unsigned char *read; /* by old index: 1 if it is in a run */
  uint32_t placed;
} Renumbering;

/* Runs of loads from `array` that change from turn to turn. */
static RunList runs_of(const Rolls *r, IrArray array) {
  RunList runs = {0};
  for (uint32_t k = 0; k < r->loops.n; k++) {
    const Loop *l = &r->loops.at[k];
    for (uint32_t offset = 0; offset < l->period; offset++)
      for (int which = 0; which < 3; which++) {
        Slot x = roll_operand(&r->p->ins.at[r->code[l->begin + offset]], which);
        const Ins *i = &r->p->ins.at[x];
        if (!x || i->op != IR_LOAD || i->array != array) continue;
        Step s = roll_step(r, l, offset, which);
        if (s.kind != STEP_LOAD || s.step == 0) continue;
        uint32_t step = (uint32_t)(s.step < 0 ? -s.step : s.step), back = s.step < 0 ? step * (l->count - 1) : 0;
        vec_push(r->p->arena, &runs, ((Run){i->index - back, step, l->count}));
      }
  }
  return runs;
}

static int longer(const void *a, const void *b) {
  const Run *x = a, *y = b;
  if (x->count != y->count) return x->count < y->count ? 1 : -1;
  if (x->first != y->first) return x->first < y->first ? -1 : 1;
  return x->step < y->step ? -1 : x->step > y->step;
}

static void place(Renumbering *y, uint32_t index) {
  if (y->place[index]) return;
  y->place[index] = ++y->placed;
}

/* Places a run, extended at both ends by indices that are in no other: members of the family outside of the loop. */
static void place_run(Renumbering *y, Run r) {
  while (r.first >= r.step && !y->read[r.first - r.step] && !y->place[r.first - r.step]) r.first -= r.step, r.count++;
  for (uint32_t end = r.first + r.step * r.count; end < y->n && !y->read[end] && !y->place[end]; end += r.step) r.count++;
  for (uint32_t k = 0; k < r.count; k++) place(y, r.first + r.step * k);
}

static int is_inside(Run r, uint32_t from, uint32_t n) { return r.first >= from && r.first + r.step * (r.count - 1) < from + n; }

/* New places of the indices from ... from + n - 1, relative to `from`. The longest runs come first. */
static Renumbering layout_of(Arena *a, const RunList *runs, uint32_t from, uint32_t n) {
  Renumbering y = {.n = n, .place = ARENA_ARRAY(a, uint32_t, n + 1), .read = ARENA_ARRAY(a, unsigned char, n + 1)};
  for (uint32_t k = 0; k < runs->n; k++)
    for (uint32_t t = 0; t < runs->at[k].count && is_inside(runs->at[k], from, n); t++) y.read[runs->at[k].first + runs->at[k].step * t - from] = 1;
  for (uint32_t k = 0; k < runs->n; k++) {
    Run r = runs->at[k];
    if (!is_inside(r, from, n)) continue;
    r.first -= from;
    place_run(&y, r);
  }
  for (uint32_t i = 0; i < n; i++) place(&y, i);
  return y;
}

static void move_loads(Prog *p, IrArray array, const Renumbering *y, uint32_t from) {
  for (Slot s = 1; s < p->ins.n; s++) {
    Ins *i = &p->ins.at[s];
    if (i->op == IR_LOAD && i->array == array && i->index >= from && i->index < from + y->n) i->index = from + y->place[i->index - from] - 1;
  }
}

static int in_order(const void *a, const void *b) {
  const Store *x = a, *y = b;
  if (x->array != y->array) return x->array < y->array ? -1 : 1;
  return x->index < y->index ? -1 : x->index > y->index;
}

static void move_stores(Prog *p, uint32_t array, const Renumbering *y, uint32_t from) {
  for (uint32_t k = 0; k < p->stores.n; k++) {
    Store *st = &p->stores.at[k];
    if (st->array == array && st->index >= from && st->index < from + y->n) st->index = from + y->place[st->index - from] - 1;
  }
  if (p->stores.n) qsort(p->stores.at, p->stores.n, sizeof *p->stores.at, in_order);
}

void series_arrange(const Series *s, Prog *first, Prog *next) {
  Arena *a = next->arena;
  Rolls r = roll_find(next, 1u << ARR_COEF | 1u << ARR_SUMS | 1u << ARR_STEP, ROLL_FROM, 0);
  if (!r.loops.n) return;
  RunList sums = runs_of(&r, ARR_SUMS), constants = runs_of(&r, ARR_STEP);
  if (sums.n) qsort(sums.at, sums.n, sizeof *sums.at, longer);
  if (constants.n) qsort(constants.at, constants.n, sizeof *constants.at, longer);
  Renumbering of_sums = layout_of(a, &sums, 0, s->sums), of_squares = layout_of(a, &sums, s->first_square, s->squares);
  Renumbering of_constants = layout_of(a, &constants, 0, s->constants);
  move_loads(next, ARR_SUMS, &of_sums, 0);
  move_loads(next, ARR_SUMS, &of_squares, s->first_square);
  move_loads(next, ARR_STEP, &of_constants, 0);
  move_stores(next, 2, &of_sums, 0);
  move_stores(next, 2, &of_squares, s->first_square);
  move_stores(next, 3, &of_sums, 0);
  move_stores(first, 1, &of_constants, 0);
}
