#include <stdlib.h>

#include "ir/prog.h"

typedef struct {
  Slot slot;
  int minus;
  uint32_t ready, rank; /* rank: place among the terms, where two are ready at once */
} Term;

typedef struct {
  const Prog *from;
  Prog *to;
  Slot *map;
  const uint32_t *uses;
  unsigned char *inside;  /* of a larger sum */
  const uint32_t *loads;  /* when loads are ready */
  VEC(uint32_t) ready;    /* by slot of `to` */
  VEC(Term) terms, sums, open;
} Balance;

static int is_sum(IrOp op) { return op == IR_ADD || op == IR_SUB || op == IR_NEG; }

static uint32_t ready(const Balance *b, Slot s) { return s < b->ready.n ? b->ready.at[s] : 0; }

static uint32_t time_of(IrOp op) {
  switch (op) {
    case IR_ADD: case IR_SUB: case IR_MUL: case IR_SOLVE: return 4;
    case IR_NEG: case IR_SELECT: return 1;
    case IR_DIV: case IR_SQRT: case IR_FN1: case IR_FN2: case IR_TABLE: return 16;
    case IR_CONST: case IR_PI: case IR_LOAD: case IR_MIN: case IR_MAX: case IR_SIGN: case IR_LT: case IR_LE: case IR_EQ:
    case IR_NOT: case IR_AND: case IR_OR: case IR_PIVOT: case IR_SOLVED: case IR_NEST: case IR_TITLE: break;
  }
  return 0;
}

static uint32_t latest(uint32_t x, uint32_t y) { return x > y ? x : y; }

/* Notes when the value of a slot is there; was: the slot of a load in the program that it comes from. */
static Slot timed(Balance *b, Slot s, Slot was) {
  while (b->ready.n <= s) vec_push(b->to->arena, &b->ready, 0);
  const Ins *i = &b->to->ins.at[s];
  uint32_t t = latest(ready(b, i->a), latest(ready(b, i->b), ready(b, i->c)));
  if (i->op == IR_SOLVE) {
    const Solve *k = &b->to->solves.at[i->index];
    for (uint32_t r = 0; r < k->n; r++) t = latest(t, ready(b, k->rhs[r]));
  }
  b->ready.at[s] = i->op == IR_LOAD ? b->loads[was] : t + time_of(i->op);
  return s;
}

/* Which sums are single parts of larger ones. */
static void mark_inside(Balance *b) {
  const Prog *p = b->from;
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    if (!is_sum(i->op)) continue;
    if (b->uses[i->a] == 1 && is_sum(p->ins.at[i->a].op)) b->inside[i->a] = 1;
    if (b->uses[i->b] == 1 && is_sum(p->ins.at[i->b].op)) b->inside[i->b] = 1;
  }
}

/* The terms of the sum s. */
static void gather(Balance *b, Slot s) {
  Arena *a = b->to->arena;
  b->terms.n = 0;
  vec_push(a, &b->open, ((Term){.slot = s}));
  while (b->open.n) {
    Term t = b->open.at[--b->open.n];
    const Ins *i = &b->from->ins.at[t.slot];
    if (t.slot != s && !b->inside[t.slot]) {
      Slot there = b->map[t.slot];
      if (there) vec_push(a, &b->terms, ((Term){there, t.minus, ready(b, there), b->terms.n}));
      continue;
    }
    if (i->b) vec_push(a, &b->open, ((Term){.slot = i->b, .minus = i->op == IR_SUB ? !t.minus : t.minus}));
    if (i->a) vec_push(a, &b->open, ((Term){.slot = i->a, .minus = i->op == IR_NEG ? !t.minus : t.minus}));
  }
}

static int by_time(const void *x, const void *y) {
  const Term *s = x, *t = y;
  if (s->ready != t->ready) return s->ready < t->ready ? -1 : 1;
  return s->rank < t->rank ? -1 : s->rank > t->rank;
}

static Term add(Balance *b, Term x, Term y) {
  Slot s;
  if (x.minus == y.minus) s = prog_op(b->to, IR_ADD, x.slot, y.slot);
  else s = x.minus ? prog_op(b->to, IR_SUB, y.slot, x.slot) : prog_op(b->to, IR_SUB, x.slot, y.slot);
  timed(b, s, 0);
  return (Term){s, x.minus && y.minus, ready(b, s), 0};
}

/* The two earliest, again and again: terms and partial sums are queues in order of time (Huffman's tree by two queues; J. van
 * Leeuwen, ICALP 1976, p. 382). */
static Slot add_up(Balance *b) {
  uint32_t t = 0, u = 0;
  b->sums.n = 0;
  qsort(b->terms.at, b->terms.n, sizeof *b->terms.at, by_time);
  if (!b->terms.n) return 0;
  while (b->terms.n - t + b->sums.n - u > 1) {
    Term two[2];
    for (int k = 0; k < 2; k++) {
      int from_terms = u == b->sums.n || (t < b->terms.n && b->terms.at[t].ready <= b->sums.at[u].ready);
      two[k] = from_terms ? b->terms.at[t++] : b->sums.at[u++];
    }
    vec_push(b->to->arena, &b->sums, add(b, two[0], two[1]));
  }
  Term last = t < b->terms.n ? b->terms.at[t] : b->sums.at[u];
  return last.minus ? timed(b, prog_op(b->to, IR_NEG, last.slot, 0), 0) : last.slot;
}

Prog *prog_balance(const Prog *p, const uint32_t *loads) {
  Arena *a = p->arena;
  Balance b = {.from = p, .to = prog_like(p), .map = ARENA_ARRAY(a, Slot, p->ins.n), .uses = prog_uses(p),
               .inside = ARENA_ARRAY(a, unsigned char, p->ins.n), .loads = loads};
  mark_inside(&b);
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    if (b.inside[s]) continue;
    if (is_sum(i->op)) {
      gather(&b, s);
      b.map[s] = add_up(&b);
    } else {
      b.map[s] = timed(&b, prog_ins(b.to, prog_moved(b.to, p, b.map, *i)), s);
    }
    prog_name(b.to, b.map[s], i->name);
  }
  for (uint32_t k = 0; k < p->stores.n; k++) {
    Store st = p->stores.at[k];
    prog_store(b.to, st.array, st.index, b.map[st.slot], st.comment);
  }
  return b.to;
}
