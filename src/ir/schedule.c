/* Orders of instructions: store by store (prog_schedule_by_store), and by critical path (prog_schedule_by_path). */
#include <stdlib.h>

#include "ir/prog.h"

uint32_t ir_latency(IrOp op) {
  switch (op) {
    case IR_ADD: case IR_SUB: case IR_MUL: case IR_SOLVE: return 4;
    case IR_NEG: case IR_SELECT: return 1;
    case IR_DIV: case IR_SQRT: case IR_FN1: case IR_FN2: case IR_TABLE: return 16;
    case IR_CONST: case IR_PI: case IR_LOAD: case IR_MIN: case IR_MAX: case IR_SIGN: case IR_LT: case IR_LE: case IR_EQ:
    case IR_NOT: case IR_AND: case IR_OR: case IR_PIVOT: case IR_SOLVED: case IR_NEST: case IR_TITLE: break;
  }
  return 0;
}

/* --- store by store --- */

typedef struct {
  const Prog *from;
  Prog *to;
  Slot *map;
  unsigned char *done;
  VEC(Slot) open;
} Schedule;

/* Appends s after its operands, a before b before c; with a list instead of recursion, since sums have any number of
 * terms. */
static void compute(Schedule *d, Slot s) {
  vec_push(d->to->arena, &d->open, s);
  while (d->open.n) {
    Slot x = d->open.at[d->open.n - 1];
    const Ins *i = &d->from->ins.at[x];
    Slot next = 0;
    for (uint32_t k = 0; k < prog_operands(d->from, i) && !next; k++)
      if (!d->done[prog_operand(d->from, i, k)]) next = prog_operand(d->from, i, k);
    if (!d->done[x] && next) {
      vec_push(d->to->arena, &d->open, next);
      continue;
    }
    d->open.n--;
    if (d->done[x]) continue;
    d->done[x] = 1;
    d->map[x] = prog_ins(d->to, prog_import(d->to, d->from, d->map, *i));
    prog_name(d->to, d->map[x], i->name);
  }
}

Prog *prog_schedule_by_store(const Prog *p) {
  Arena *a = p->arena;
  Schedule d = {.from = p,
                .to = prog_new_like(p),
                .map = ARENA_ARRAY(a, Slot, p->ins.n),
                .done = ARENA_ARRAY(a, unsigned char, p->ins.n)};
  d.done[0] = 1;
  for (Slot s = 1; s < p->ins.n; s++)
    if (p->ins.at[s].op == IR_PIVOT) compute(&d, s);
  for (uint32_t k = 0; k < p->stores.n; k++)
    if (p->stores.at[k].slot) compute(&d, p->stores.at[k].slot);
  prog_copy_stores(d.to, p, d.map);
  return d.to;
}

/* --- by critical path --- */

typedef struct {
  Slot slot;
  uint32_t left; /* cycles from its start to the end of the program */
} Deadline;

static int by_deadline(const void *x, const void *y) {
  const Deadline *a = x, *b = y;
  if (a->left != b->left) return a->left > b->left ? -1 : 1;
  return a->slot < b->slot ? -1 : a->slot > b->slot;
}

typedef struct {
  const Prog *p;
  int calls_first;
} Timing;

static uint32_t time_of(const Timing *t, Slot s) {
  enum { FIRST = 1 << 20 };
  IrOp op = t->p->ins.at[s].op;
  return t->calls_first && (op == IR_FN1 || op == IR_FN2) ? FIRST : ir_latency(op);
}

static void need_before(const Timing *t, uint32_t *left, Slot operand, uint32_t user) {
  uint32_t own = time_of(t, operand) + user;
  if (left[operand] < own) left[operand] = own;
}

/* Slots sorted by the length of the path from their start to the end of the program. A pivot is checked as soon as
 * it is known. */
static Deadline *deadlines(const Timing *t) {
  const Prog *p = t->p;
  Deadline *d = ARENA_ARRAY(p->arena, Deadline, p->ins.n);
  uint32_t *left = ARENA_ARRAY(p->arena, uint32_t, p->ins.n);
  for (uint32_t k = 0; k < p->stores.n; k++) need_before(t, left, p->stores.at[k].slot, 0);
  for (Slot s = p->ins.n; s-- > 1;) {
    const Ins *i = &p->ins.at[s];
    if (i->op == IR_PIVOT) continue;
    need_before(t, left, i->a, left[s]);
    need_before(t, left, i->b, left[s]);
    need_before(t, left, i->c, left[s]);
  }
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    if (i->op == IR_PIVOT) left[s] = left[i->a] ? left[i->a] - time_of(t, i->a) : 0;
    d[s - 1] = (Deadline){s, left[s]};
  }
  qsort(d, p->ins.n - 1, sizeof *d, by_deadline);
  return d;
}

Prog *prog_schedule_by_path(const Prog *p, int calls_first) {
  if (p->solves.n) return prog_tidy(p);
  Prog *to = prog_new_like(p);
  Slot *map = ARENA_ARRAY(p->arena, Slot, p->ins.n);
  const Deadline *d = deadlines(&(Timing){p, calls_first});
  for (uint32_t k = 0; k + 1 < p->ins.n; k++) {
    const Ins *i = &p->ins.at[d[k].slot];
    if (i->op == IR_TITLE) continue;
    map[d[k].slot] = prog_ins(to, prog_import(to, p, map, *i));
    prog_name(to, map[d[k].slot], i->name);
  }
  prog_copy_stores(to, p, map);
  return to;
}
