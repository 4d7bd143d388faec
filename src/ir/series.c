#include "ir/series.h"

#include "ir/series_impl.h"

enum { INVERSE_MAX = 3 };

/* --- values --- */

Val series_open(Maker *m, Slot zero) {
  vec_push(m->arena, &m->values, ((Value){.zero = zero, .varies = 1}));
  return m->values.n - 1;
}

Val series_value(Maker *m, Slot zero, Slot coef) {
  if (!zero && !coef) return 0;
  vec_push(m->arena, &m->values, ((Value){.zero = zero, .coef = coef, .varies = coef != 0}));
  return m->values.n - 1;
}

void series_set(Maker *m, Val v, Slot coef) {
  m->values.at[v].coef = coef;
  m->values.at[v].varies = coef != 0;
}

Slot series_constant(Maker *m, Slot s) {
  if (!s) return 0;
  const Ins *i = &m->first->ins.at[s];
  if (i->op == IR_CONST) return prog_num(m->next, i->number);
  if (i->op == IR_PI) return prog_ins(m->next, (Ins){.op = IR_PI});
  while (m->constant_at.n <= s) vec_push(m->arena, &m->constant_at, 0);
  uint32_t *at = &m->constant_at.at[s];
  if (!*at) {
    vec_push(m->arena, &m->constants, s);
    *at = m->constants.n;
  }
  return prog_ins(m->next, (Ins){.op = IR_LOAD, .array = ARR_STEP, .index = *at - 1, .name = i->name});
}

Slot series_zero(Maker *m, Val a) { return series_constant(m, m->values.at[a].zero); }
Slot series_op(Maker *m, IrOp op, Slot a, Slot b) { return prog_op(m->next, op, a, b); }
Slot series_order(Maker *m) { return prog_ins(m->next, (Ins){.op = IR_LOAD, .array = ARR_ORDER, .name = "k"}); }

Slot series_per_order(Maker *m, Slot x) {
  Slot r = prog_ins(m->next, (Ins){.op = IR_LOAD, .array = ARR_PER_ORDER, .name = "per_k"});
  return series_op(m, IR_MUL, x, r);
}

Slot series_over(Maker *m, Slot x, Slot divisor) {
  Slot one = prog_num(m->first, num_int(1)), inverse = prog_op(m->first, IR_DIV, one, divisor);
  return series_op(m, IR_MUL, x, series_constant(m, inverse));
}

/* --- sums over the orders below --- */

/* The pair (a, b) or (b, a), found again or new. */
static uint32_t find_pair(Maker *m, Val a, Val b) {
  if (a > b) {
    Val t = a;
    a = b;
    b = t;
  }
  for (uint32_t i = m->values.at[a].pairs; i; i = m->pairs.at[i - 1].before)
    if (m->pairs.at[i - 1].b == b) return i - 1;
  vec_push(m->arena, &m->pairs, ((Pair){a, b, m->values.at[a].pairs}));
  return (m->values.at[a].pairs = m->pairs.n) - 1;
}

/* What the value is a multiple of; *factor gathers the multiples, in `first` (0: one). */
static Val base_of(Maker *m, Val v, Slot *factor) {
  const Value *x = &m->values.at[v];
  if (!x->factor) return v;
  *factor = *factor ? prog_op(m->first, IR_MUL, *factor, x->factor) : x->factor;
  return x->base;
}

static Slot load(Maker *m, IrArray array, uint32_t index, Name name) {
  return prog_ins(m->next, (Ins){.op = IR_LOAD, .array = array, .index = index, .name = name});
}

Slot series_sum(Maker *m, Val a, Val b) {
  if (!m->values.at[a].varies || !m->values.at[b].varies) return 0;
  Slot factor = 0;
  a = base_of(m, a, &factor);
  b = base_of(m, b, &factor);
  Slot s = load(m, ARR_SUMS, find_pair(m, a, b), "s");
  return factor ? series_op(m, IR_MUL, series_constant(m, factor), s) : s;
}

Slot series_product(Maker *m, Val a, Val b) {
  Slot sum = series_sum(m, a, b), a0 = m->values.at[a].zero, lead;
  if (a == b) {
    Slot twice = prog_op(m->first, IR_ADD, a0, a0);
    lead = series_op(m, IR_MUL, series_constant(m, twice), m->values.at[a].coef);
  } else {
    Slot left = series_op(m, IR_MUL, series_constant(m, a0), m->values.at[b].coef);
    Slot right = series_op(m, IR_MUL, series_zero(m, b), m->values.at[a].coef);
    lead = series_op(m, IR_ADD, left, right);
  }
  return series_op(m, IR_ADD, sum, lead);
}

Val series_theta(Maker *m, Val v) {
  const Value x = m->values.at[v];
  if (x.theta || !x.varies) return x.theta;
  Slot coef = series_op(m, IR_MUL, series_order(m), x.coef);
  Val base = x.factor ? series_theta(m, x.base) : 0;
  Val theta = series_value(m, 0, coef);
  m->values.at[theta].factor = x.factor;
  m->values.at[theta].base = base;
  return m->values.at[v].theta = theta;
}

/* --- the model --- */

typedef struct {
  Maker m;
  const IrSystem *sys;
  Series *out;
  unsigned char *need; /* by slot of the program */
  Slot *zero;          /* by slot of the program: its slot in `first` */
  Val *value;          /* by slot of the program */
  Val *second;         /* [nq] q'' */
} Model;

static void mark_roots(Model *w) {
  const IrSystem *sys = w->sys;
  for (uint32_t k = 0; k < sys->nblocks; k++) {
    const Block *b = &sys->blocks[k];
    for (uint32_t i = 0; i < b->n; i++) w->need[b->f[i]] = 1;
    for (uint32_t i = 0; i < b->n * b->n; i++) w->need[b->M[i]] = 1;
  }
  for (uint32_t i = 0; i < sys->nz; i++) w->need[sys->flow[i]] = 1;
  for (Slot s = sys->p->ins.n; s-- > 1;) {
    const Ins *i = &sys->p->ins.at[s];
    if (w->need[s]) w->need[i->a] = w->need[i->b] = w->need[i->c] = 1;
  }
}

/* Column of x; -1 for what is no part of the motion. */
static int64_t column_of(Model *w, const Ins *i) {
  const IrSystem *sys = w->sys;
  switch (i->array) {
    case ARR_Q: return i->index;
    case ARR_V: return sys->nq + i->index;
    case ARR_Z: return 2 * sys->nq + i->index;
    case ARR_T: w->out->uses_time = 1; return 3 * sys->nq + 2 * sys->nz;
    case ARR_P: case ARR_U: case ARR_FREE: case ARR_COEF: case ARR_SUMS:
    case ARR_STEP: case ARR_ORDER: case ARR_PER_ORDER: case ARR_UP: case ARR_COUNT: break;
  }
  return -1;
}

static Val load_value(Model *w, const Ins *i, Slot zero) {
  int64_t column = column_of(w, i);
  if (column < 0) return series_value(&w->m, zero, 0);
  Slot coef = prog_ins(w->m.next, (Ins){.op = IR_LOAD, .array = ARR_COEF, .index = (uint32_t)column, .name = i->name});
  return series_value(&w->m, zero, coef);
}

/* The program, value by value, in both orders. */
static void copy_program(Model *w) {
  const Prog *p = w->sys->p;
  for (Slot s = 1; s < p->ins.n && !w->m.why; s++) {
    Ins i = p->ins.at[s];
    if (i.op == IR_TITLE) {
      prog_title(w->m.first, i.text);
      prog_title(w->m.next, i.text);
    }
    if (!w->need[s] || i.op == IR_TITLE) continue;
    Val a = w->value[i.a], b = w->value[i.b], c = w->value[i.c];
    i.a = w->zero[i.a];
    i.b = w->zero[i.b];
    i.c = w->zero[i.c];
    Slot zero = w->zero[s] = prog_ins(w->m.first, i);
    prog_name(w->m.first, zero, i.name);
    w->value[s] = i.op == IR_LOAD ? load_value(w, &i, zero) : series_instruction(&w->m, &i, zero, a, b, c);
    Slot coef = w->m.values.at[w->value[s]].coef;
    if (i.op != IR_LOAD) prog_name(w->m.next, coef, i.name);
  }
}

/* --- M q'' = f --- */

static const Slot *constants_of(Model *w, const Slot *s, uint32_t n) {
  Slot *to = ARENA_ARRAY(w->m.arena, Slot, n);
  for (uint32_t i = 0; i < n; i++) to[i] = series_constant(&w->m, s[i]);
  return to;
}

/* The inverse of a small block, as `next` sees it: where M is full it costs as many operations as its factors do, and they
 * depend less on each other. It is as accurate: a definite matrix loses no digits by bad scales. */
static Factored inverse_of(Model *w, const Factored *fac) {
  uint32_t n = fac->n;
  Slot *inverse = ARENA_ARRAY(w->m.arena, Slot, n * n), *unit = ARENA_ARRAY(w->m.arena, Slot, n), *column = ARENA_ARRAY(w->m.arena, Slot, n);
  for (uint32_t j = 0; j < n; j++) {
    for (uint32_t i = 0; i < n; i++) unit[i] = i == j ? prog_num(w->m.first, num_int(1)) : 0;
    factor_solve(w->m.first, fac, unit, column);
    for (uint32_t i = 0; i < n; i++) inverse[i * n + j] = i <= j ? column[i] : inverse[j * n + i];
  }
  for (uint32_t j = 0; j < n; j++)
    for (uint32_t i = j + 1; i < n; i++) inverse[i * n + j] = inverse[j * n + i];
  return (Factored){.kind = FACTOR_INVERSE, .n = n, .L = constants_of(w, inverse, n * n)};
}

/* What `first` has factored, as `next` sees it. */
static Factored seen_from_next(Model *w, const Factored *fac) {
  if (fac->kind == FACTOR_STRAIGHT && fac->n <= INVERSE_MAX) return inverse_of(w, fac);
  Factored seen = *fac;
  uint32_t n = fac->n, nd = factor_divisors(fac);
  Slot *inverse = ARENA_ARRAY(w->m.arena, Slot, nd + 1), one = prog_num(w->m.first, num_int(1));
  for (uint32_t i = 0; i < nd; i++) inverse[i] = prog_op(w->m.first, IR_DIV, one, fac->divisor[i]);
  seen.divisor = NULL;
  seen.inverse = constants_of(w, inverse, nd);
  seen.L = fac->kind == FACTOR_STRAIGHT ? constants_of(w, fac->L, n * n) : fac->kind == FACTOR_PAIR ? constants_of(w, fac->L, 3) : NULL;
  return seen;
}

/* f[k] less what the lower coefficients of q'' have in it. */
static Slot right_side(Model *w, const Block *b, uint32_t i) {
  Maker *m = &w->m;
  Slot r = m->values.at[w->value[b->f[i]]].coef;
  for (uint32_t j = 0; j < b->n; j++) {
    Val M = w->value[i >= j ? b->M[i * b->n + j] : b->M[j * b->n + i]], a = w->second[b->at[j]];
    if (!m->values.at[M].varies) continue;
    Slot sum = series_sum(m, M, a), lead = series_op(m, IR_MUL, series_zero(m, a), m->values.at[M].coef);
    r = series_op(m, IR_SUB, r, series_op(m, IR_ADD, sum, lead));
  }
  return r;
}

static void store_rate(Model *w, uint32_t i, Slot zero, Slot coef) {
  Name name = w->sys->rates[i];
  prog_name(w->m.first, zero, name);
  prog_name(w->m.next, coef, name);
  prog_store(w->m.first, 0, 2 * w->sys->nq + w->sys->nz + i, zero, name);
  prog_store(w->m.next, 0, 2 * w->sys->nq + w->sys->nz + i, coef, name);
}

static void solve_block(Model *w, const Block *b) {
  Arena *arena = w->m.arena;
  uint32_t n = b->n;
  Slot *M = ARENA_ARRAY(arena, Slot, n * n), *f = ARENA_ARRAY(arena, Slot, n), *x = ARENA_ARRAY(arena, Slot, n);
  for (uint32_t i = 0; i < n * n; i++) M[i] = w->zero[b->M[i]];
  for (uint32_t i = 0; i < n; i++) f[i] = w->zero[b->f[i]];
  Block here = *b;
  here.M = M;
  here.f = f;
  Factored fac = block_factor(w->m.first, &here, &w->out->room);
  factor_solve(w->m.first, &fac, f, x);
  for (uint32_t i = 0; i < n; i++) w->second[b->at[i]] = series_open(&w->m, x[i]);
  for (uint32_t i = 0; i < n; i++) f[i] = right_side(w, b, i);
  Factored seen = seen_from_next(w, &fac);
  Slot *y = ARENA_ARRAY(arena, Slot, n);
  factor_solve(w->m.next, &seen, f, y);
  for (uint32_t i = 0; i < n; i++) {
    series_set(&w->m, w->second[b->at[i]], y[i]);
    store_rate(w, b->at[i], x[i], y[i]);
  }
}

static void solve_all(Model *w) {
  prog_title(w->m.first, "M q'' = f");
  prog_title(w->m.next, "M q'' = f, with M as factored at order 0");
  for (uint32_t k = 0; k < w->sys->nblocks; k++) solve_block(w, &w->sys->blocks[k]);
}

/* x[k+1] of q, v, z: T/(k+1) times their rates. */
static void store_state(Model *w, uint32_t column, Slot rate) {
  Slot up = prog_ins(w->m.next, (Ins){.op = IR_LOAD, .array = ARR_UP, .name = "up"});
  prog_store(w->m.next, 1, column, series_op(&w->m, IR_MUL, up, rate), "");
}

static void store_rest(Model *w) {
  Maker *m = &w->m;
  uint32_t nq = w->sys->nq, nz = w->sys->nz;
  for (uint32_t i = 0; i < nz; i++) {
    Slot s = w->sys->flow[i];
    store_rate(w, nq + i, w->zero[s], m->values.at[w->value[s]].coef);
  }
  for (uint32_t i = 0; i < nq; i++)
    store_state(w, i, prog_ins(m->next, (Ins){.op = IR_LOAD, .array = ARR_COEF, .index = nq + i, .name = w->sys->velocities[i]}));
  for (uint32_t i = 0; i < nq; i++) store_state(w, nq + i, m->values.at[w->second[i]].coef);
  for (uint32_t i = 0; i < nz; i++) store_state(w, 2 * nq + i, m->values.at[w->value[w->sys->flow[i]]].coef);
  for (uint32_t i = 0; i < m->pairs.n; i++) prog_store(m->next, 2, i, m->values.at[m->pairs.at[i].a].coef, "");
  for (uint32_t i = 0; i < m->pairs.n; i++) prog_store(m->next, 3, i, m->values.at[m->pairs.at[i].b].coef, "");
  for (uint32_t i = 0; i < m->constants.n; i++) prog_store(m->first, 1, i, m->constants.at[i], "");
}

static int is_second(const Model *w, Val v) {
  for (uint32_t i = 0; i < w->sys->nq; i++)
    if (w->second[i] == v) return 1;
  return 0;
}

/* When the loads of `next` are there, in cycles of a processor: the rates of the order before, and v and z, which are made of
 * them, come last; all else was there one order before. */
static const uint32_t *when_ready(const Model *w, const Prog *next) {
  enum { ORDER = 30, PRODUCT = 4 };
  uint32_t *ready = ARENA_ARRAY(next->arena, uint32_t, next->ins.n);
  for (Slot s = 1; s < next->ins.n; s++) {
    const Ins *i = &next->ins.at[s];
    if (i->op != IR_LOAD) continue;
    if (i->array == ARR_COEF && i->index >= w->sys->nq) ready[s] = ORDER + PRODUCT;
    if (i->array == ARR_SUMS && (is_second(w, w->m.pairs.at[i->index].a) || is_second(w, w->m.pairs.at[i->index].b))) ready[s] = ORDER;
  }
  return ready;
}

Series *series_new(const IrSystem *sys, const char **why) {
  Arena *a = sys->p->arena;
  uint32_t n = sys->p->ins.n;
  Series *out = ARENA_NEW(a, Series);
  Model w = {.m = {.arena = a, .first = prog_new(a), .next = prog_new(a)}, .sys = sys, .out = out};
  *out = (Series){.nq = sys->nq, .nz = sys->nz};
  w.need = ARENA_ARRAY(a, unsigned char, n);
  w.zero = ARENA_ARRAY(a, Slot, n);
  w.value = ARENA_ARRAY(a, Val, n);
  w.second = ARENA_ARRAY(a, Val, sys->nq + 1);
  vec_push(a, &w.m.values, ((Value){0}));
  mark_roots(&w);
  copy_program(&w);
  if (w.m.why) {
    *why = w.m.why;
    return NULL;
  }
  solve_all(&w);
  store_rest(&w);
  out->first = prog_tidy(w.m.first);
  const Prog *next = prog_tidy(w.m.next);
  out->next = prog_balance(next, when_ready(&w, next));
  out->columns = (3 * sys->nq + 2 * sys->nz + (out->uses_time ? 1 : 0) + 3) / 4 * 4;
  out->sums = w.m.pairs.n;
  out->constants = w.m.constants.n;
  return out;
}
