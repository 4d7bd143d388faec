/* Reassociation of sums and products by the times at which their operands are ready (prog_reassociate,
 * prog_reassociate_fma). A sum, or product, whose parts have no other use is gathered into a list of terms, or
 * factors, and built again in the new order. */
#include <stdlib.h>

#include "ir/product.h"

typedef struct {
  Slot slot;
  int minus, product; /* product: has one use, so that a fused multiply-add may take it in */
  uint32_t ready, rank; /* ready: of a product, when its factors are; rank: breaks ties in the order of the terms */
} Term;

typedef struct {
  const Prog *from;
  Prog *to;
  Slot *map;
  const uint32_t *uses;
  unsigned char *inside;  /* by slot: a part of a larger sum or product */
  const uint32_t *loads;  /* by slot: when loads are ready; NULL: at 0 */
  int fused;              /* for fused multiply-add; named sums stay whole */
  VEC(uint32_t) ready;    /* by slot of `to` */
  VEC(Term) terms, sums, open;
} Reassociation;


static uint32_t ready(const Reassociation *b, Slot s) { return s < b->ready.n ? b->ready.at[s] : 0; }

static uint32_t latest(uint32_t x, uint32_t y) { return x > y ? x : y; }

/* Records when slot s is ready; was: its slot in the old program, for loads. */
static Slot timed(Reassociation *b, Slot s, Slot was) {
  while (b->ready.n <= s) vec_push(b->to->arena, &b->ready, 0);
  const Ins *i = &b->to->ins.at[s];
  uint32_t t = latest(ready(b, i->a), latest(ready(b, i->b), ready(b, i->c)));
  if (i->op == IR_SOLVE) {
    const Solve *k = &b->to->solves.at[i->index];
    for (uint32_t r = 0; r < solve_unknowns(k); r++) t = latest(t, ready(b, k->rhs[r]));
  }
  b->ready.at[s] = i->op == IR_LOAD ? (b->loads ? b->loads[was] : 0) : t + ir_latency(i->op);
  return s;
}

/* Marks sums whose only use is in a larger sum. */
static void mark_inside(Reassociation *b) {
  const Prog *p = b->from;
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    if (!ir_is_sum(i->op)) continue;
    const Slot parts[] = {i->a, i->b};
    for (int k = 0; k < 2; k++) {
      const Ins *part = &p->ins.at[parts[k]];
      if (b->uses[parts[k]] == 1 && ir_is_sum(part->op) && !(b->fused && part->name)) b->inside[parts[k]] = 1;
    }
  }
}

static Term term(const Reassociation *b, Slot s, int minus, int once) {
  const Ins *i = &b->to->ins.at[s];
  Term t = {s, minus, b->fused && once && i->op == IR_MUL, ready(b, s), b->terms.n};
  if (t.product) t.ready = latest(ready(b, i->a), ready(b, i->b));
  return t;
}

/* Lists the terms of the sum s, through the parts inside it. */
static void gather(Reassociation *b, Slot s) {
  Arena *a = b->to->arena;
  b->terms.n = 0;
  vec_push(a, &b->open, ((Term){.slot = s}));
  while (b->open.n) {
    Term t = b->open.at[--b->open.n];
    const Ins *i = &b->from->ins.at[t.slot];
    if (t.slot != s && !b->inside[t.slot]) {
      Slot there = b->map[t.slot];
      if (there) vec_push(a, &b->terms, term(b, there, t.minus, b->uses[t.slot] == 1));
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

static Term add(Reassociation *b, Term x, Term y) {
  Slot s;
  if (x.minus == y.minus) s = prog_op(b->to, IR_ADD, x.slot, y.slot);
  else s = x.minus ? prog_op(b->to, IR_SUB, y.slot, x.slot) : prog_op(b->to, IR_SUB, x.slot, y.slot);
  timed(b, s, 0);
  if (y.product) b->ready.at[s] = latest(x.product ? ready(b, x.slot) : x.ready, y.ready) + ir_latency(IR_ADD);
  return (Term){.slot = s, .minus = x.minus && y.minus, .ready = ready(b, s)};
}

/* The term to begin with: a product in first place takes a multiplication of its own, so the first term that is
 * none, if it is ready within a multiplication's time. */
static uint32_t first_of(const Reassociation *b) {
  const Term *t = b->terms.at;
  for (uint32_t k = 0; k < b->terms.n; k++)
    if (!t[k].product && (t[k].ready <= t[0].ready + ir_latency(IR_MUL))) return k;
  return 0;
}

/* The sum as a chain, earliest term first: each product is one fused multiply-add. */
static Slot add_in_a_row(Reassociation *b) {
  Term *t = b->terms.at;
  qsort(t, b->terms.n, sizeof *t, by_time);
  if (!b->terms.n) return 0;
  uint32_t first = first_of(b);
  Term sum = t[first];
  for (uint32_t k = first; k > 0; k--) t[k] = t[k - 1];
  for (uint32_t k = 1; k < b->terms.n; k++) sum = add(b, sum, t[k]);
  return sum.minus ? timed(b, prog_op(b->to, IR_NEG, sum.slot, 0), 0) : sum.slot;
}

/* The sum as a tree: adds the two earliest of terms and partial sums, again and again. Both are queues in order of
 * time (Huffman's tree by two queues; J. van Leeuwen, ICALP 1976, p. 382). */
static Slot add_up(Reassociation *b) {
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

/* --- products --- */

static void mark_factors(Reassociation *b) {
  for (Slot s = b->from->ins.n; s-- > 1;)
    if (b->from->ins.at[s].op == IR_MUL && !b->inside[s]) product_of(b->from, b->uses, s, b->inside);
}

/* The product as a tree: multiplies the two earliest factors, again and again. */
static Slot multiply(Reassociation *b, Slot s) {
  Product of = product_of(b->from, b->uses, s, NULL);
  Term t[MOST_FACTORS];
  for (uint32_t k = 0; k < of.n; k++)
    t[k] = (Term){.slot = b->map[of.at[k]], .ready = ready(b, b->map[of.at[k]]), .rank = k};
  for (uint32_t n = of.n; n > 1; n--) {
    if (of.n > 2) qsort(t, n, sizeof *t, by_time);
    Slot two = timed(b, prog_op(b->to, IR_MUL, t[0].slot, t[1].slot), 0);
    t[0] = (Term){.slot = two, .ready = ready(b, two), .rank = t[0].rank};
    t[1] = t[n - 1];
  }
  return t[0].slot;
}

static Prog *reassociate(const Prog *p, const uint32_t *loads, int fused) {
  Arena *a = p->arena;
  Reassociation b = {.from = p, .to = prog_new_like(p), .map = ARENA_ARRAY(a, Slot, p->ins.n), .uses = prog_uses(p),
               .inside = ARENA_ARRAY(a, unsigned char, p->ins.n), .loads = loads, .fused = fused};
  mark_inside(&b);
  if (fused) mark_factors(&b);
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = &p->ins.at[s];
    if (b.inside[s]) continue;
    if (ir_is_sum(i->op)) {
      gather(&b, s);
      b.map[s] = fused ? add_in_a_row(&b) : add_up(&b);
    } else if (fused && i->op == IR_MUL) {
      b.map[s] = multiply(&b, s);
    } else {
      b.map[s] = timed(&b, prog_ins(b.to, prog_import(b.to, p, b.map, *i)), s);
    }
    prog_name(b.to, b.map[s], i->name);
  }
  prog_copy_stores(b.to, p, b.map);
  return b.to;
}

Prog *prog_reassociate(const Prog *p, const uint32_t *ready) { return reassociate(p, ready, 0); }
Prog *prog_reassociate_fma(const Prog *p) { return reassociate(p, NULL, 1); }
