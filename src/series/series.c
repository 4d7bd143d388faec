/* series_new: the program of order 0 is a copy of the model's program; the program of order k gets a recurrence for
 * each instruction that the motion depends on, and the linear system with the factors of order 0. */
#include "series/series.h"

#include "series/series_impl.h"

enum { INVERSE_MAX = 3 };

/* --- values --- */

Val series_open(SeriesBuilder *m, Slot zero) {
  vec_push(m->arena, &m->values, ((Value){.zero = zero, .varies = 1}));
  return m->values.n - 1;
}

Val series_value(SeriesBuilder *m, Slot zero, Slot coef) {
  if (!zero && !coef) return 0;
  vec_push(m->arena, &m->values, ((Value){.zero = zero, .coef = coef, .varies = coef != 0}));
  return m->values.n - 1;
}

void series_set(SeriesBuilder *m, Val v, Slot coef) {
  m->values.at[v].coef = coef;
  m->values.at[v].varies = coef != 0;
}

Slot series_constant(SeriesBuilder *m, Slot s) {
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
  return prog_ins(m->next,
                  (Ins){.op = IR_LOAD, .array = ARR_STEP, .index = *at - 1, .name = i->name ? i->name : "constant"});
}

Slot series_zero(SeriesBuilder *m, Val a) { return series_constant(m, m->values.at[a].zero); }
Slot series_op(SeriesBuilder *m, IrOp op, Slot a, Slot b) { return prog_op(m->next, op, a, b); }
Slot series_order(SeriesBuilder *m) { return prog_ins(m->next, (Ins){.op = IR_LOAD, .array = ARR_ORDER, .name = "k"}); }

Slot series_per_order(SeriesBuilder *m, Slot x) {
  Slot r = prog_ins(m->next, (Ins){.op = IR_LOAD, .array = ARR_PER_ORDER, .name = "per_k"});
  return series_op(m, IR_MUL, x, r);
}

/* 1/divisor, a slot of `first`, in `next`. */
static Slot inverse_of(SeriesBuilder *m, Slot divisor) {
  Slot one = prog_num(m->first, num_int(1)), inverse = prog_op(m->first, IR_DIV, one, divisor);
  return series_constant(m, inverse);
}

Slot series_over(SeriesBuilder *m, Slot x, Slot divisor) { return series_op(m, IR_MUL, x, inverse_of(m, divisor)); }

/* --- sums over the orders below --- */

/* Index of the pair (a, b) or (b, a), appended if new. */
static uint32_t find_pair(SeriesBuilder *m, Val a, Val b) {
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

/* The base of a multiple; *factor, a slot of `first` (0: one), is multiplied by the value's factor. */
static Val base_of(SeriesBuilder *m, Val v, Slot *factor) {
  const Value *x = &m->values.at[v];
  if (!x->factor) return v;
  *factor = *factor ? prog_op(m->first, IR_MUL, *factor, x->factor) : x->factor;
  return x->base;
}

static Slot load(SeriesBuilder *m, IrArray array, uint32_t index, Name name) {
  return prog_ins(m->next, (Ins){.op = IR_LOAD, .array = array, .index = index, .name = name});
}

Slot series_sum(SeriesBuilder *m, Val a, Val b) {
  if (!m->values.at[a].varies || !m->values.at[b].varies) return 0;
  Slot factor = 0;
  a = base_of(m, a, &factor);
  b = base_of(m, b, &factor);
  Slot s = load(m, ARR_SUMS, find_pair(m, a, b), "sum");
  return factor ? series_op(m, IR_MUL, series_constant(m, factor), s) : s;
}

Slot series_product(SeriesBuilder *m, Val a, Val b) {
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

Val series_theta(SeriesBuilder *m, Val v) {
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

/* An entry of the linear system in the list of its row or column; other: its column or row. */
typedef struct {
  uint32_t other;
  Val value;
} Entry;
typedef VEC(Entry) EntryList;

typedef struct {
  SeriesBuilder m;
  const IrSystem *sys;
  Series *out;
  unsigned char *need; /* by slot of the program: whether its coefficients are needed */
  Slot *zero;          /* by slot of the program: slot in `first` */
  Val *value;          /* by slot of the program */
  EntryList *H, *row, *column; /* [nq + ndefs] rows of H, rows and columns of C */
  Val *u, *lambda;     /* [nq + ndefs] the rates u', and the adjoints of definitions */
} ModelSeries;

static void mark_roots(ModelSeries *w) {
  const IrSystem *sys = w->sys;
  for (uint32_t k = 0; k < sys->H.n; k++) w->need[sys->H.at[k].slot] = 1;
  for (uint32_t k = 0; k < sys->C.n; k++) w->need[sys->C.at[k].slot] = 1;
  for (uint32_t i = 0; i < sys->nq; i++) w->need[sys->f[i]] = 1;
  for (uint32_t i = 0; i < sys->nz; i++) w->need[sys->flow[i]] = 1;
  for (Slot s = sys->p->ins.n; s-- > 1;) {
    const Ins *i = &sys->p->ins.at[s];
    if (w->need[s]) w->need[i->a] = w->need[i->b] = w->need[i->c] = 1;
  }
}

/* Column of x that a load reads; -1 for parameters and other constants. */
static int64_t column_of(ModelSeries *w, const Ins *i) {
  const IrSystem *sys = w->sys;
  switch (i->array) {
    case ARR_Q: return i->index;
    case ARR_V: return sys->nq + i->index;
    case ARR_Z: return 2 * sys->nq + i->index;
    case ARR_T: w->out->uses_time = 1; return 3 * sys->nq + 2 * sys->nz;
    case ARR_P:
    case ARR_U:
    case ARR_A:
    case ARR_G:
    case ARR_FREE:
    case ARR_COEF:
    case ARR_SUMS:
    case ARR_STEP:
    case ARR_ORDER:
    case ARR_PER_ORDER:
    case ARR_UP: case ARR_CELL: case ARR_OUTER: case ARR_INDEX: case ARR_COUNT: break;
  }
  return -1;
}

static Val load_value(ModelSeries *w, const Ins *i, Slot zero) {
  int64_t column = column_of(w, i);
  if (column < 0) return series_value(&w->m, zero, 0);
  return series_value(&w->m, zero, load(&w->m, ARR_COEF, (uint32_t)column, i->name));
}

/* Copies the program to `first`, and appends the recurrences of its instructions to `next`. */
static void copy_program(ModelSeries *w) {
  const Prog *p = w->sys->p;
  for (Slot s = 1; s < p->ins.n && !w->m.why; s++) {
    const Ins *was = &p->ins.at[s];
    Ins i = prog_import(w->m.first, p, w->zero, *was);
    Slot zero = w->zero[s] = prog_ins(w->m.first, i);
    prog_name(w->m.first, zero, i.name);
    if (!w->need[s]) continue;
    w->value[s] = i.op == IR_LOAD
                      ? load_value(w, &i, zero)
                      : series_instruction(&w->m, &i, zero, w->value[was->a], w->value[was->b], w->value[was->c]);
    Slot coef = w->m.values.at[w->value[s]].coef;
    if (i.op != IR_LOAD) prog_name(w->m.next, coef, i.name);
  }
}

/* --- M q'' = f --- */

static void list_entries(ModelSeries *w) {
  Arena *a = w->m.arena;
  const IrSystem *sys = w->sys;
  uint32_t total = sys->nq + sys->ndefs;
  w->H = ARENA_ARRAY(a, EntryList, total + 1);
  w->row = ARENA_ARRAY(a, EntryList, total + 1);
  w->column = ARENA_ARRAY(a, EntryList, total + 1);
  for (uint32_t k = 0; k < sys->H.n; k++) {
    const IrSlotEntry *h = &sys->H.at[k];
    vec_push(a, &w->H[h->row], ((Entry){h->col, w->value[h->slot]}));
    if (h->row != h->col) vec_push(a, &w->H[h->col], ((Entry){h->row, w->value[h->slot]}));
  }
  for (uint32_t k = 0; k < sys->C.n; k++) {
    const IrSlotEntry *c = &sys->C.at[k];
    vec_push(a, &w->row[c->row], ((Entry){c->col, w->value[c->slot]}));
    vec_push(a, &w->column[c->col], ((Entry){c->row, w->value[c->slot]}));
  }
}

/* Opens the values of rates and adjoints, the latter computed in `first`: lambda = H u' + C^T lambda, from the last
 * definition on. */
static void open_unknowns(ModelSeries *w) {
  SeriesBuilder *m = &w->m;
  const IrSystem *sys = w->sys;
  uint32_t total = sys->nq + sys->ndefs;
  w->u = ARENA_ARRAY(m->arena, Val, total + 1);
  w->lambda = ARENA_ARRAY(m->arena, Val, total + 1);
  for (uint32_t v = 0; v < total; v++) w->u[v] = series_open(m, w->zero[sys->x[v]]);
  for (uint32_t v = total; v-- > sys->nq;) {
    Slot sum = 0;
    for (uint32_t k = 0; k < w->H[v].n; k++)
      sum = prog_add_product(m->first, sum, m->values.at[w->H[v].at[k].value].zero,
                             m->values.at[w->u[w->H[v].at[k].other]].zero);
    for (uint32_t k = 0; k < w->column[v].n; k++)
      sum = prog_add_product(m->first, sum, m->values.at[w->column[v].at[k].value].zero,
                             m->values.at[w->lambda[w->column[v].at[k].other]].zero);
    w->lambda[v] = series_open(m, sum);
  }
}

/* Coefficient k of sum E x without its terms E[0] x[k]. */
static Slot lower_terms(ModelSeries *w, const EntryList *list, const Val *x) {
  SeriesBuilder *m = &w->m;
  Slot sum = 0;
  for (uint32_t k = 0; k < list->n; k++) {
    Val E = list->at[k].value, y = x[list->at[k].other];
    if (!m->values.at[E].varies) continue;
    Slot below = series_sum(m, E, y), lead = series_op(m, IR_MUL, series_zero(m, y), m->values.at[E].coef);
    Slot part = series_op(m, IR_ADD, below, lead);
    sum = series_op(m, IR_ADD, sum, part);
  }
  return sum;
}

/* The terms E[0] x[k]. */
static Slot top_terms(ModelSeries *w, const EntryList *list, const Val *x) {
  SeriesBuilder *m = &w->m;
  Slot sum = 0;
  for (uint32_t k = 0; k < list->n; k++)
    sum = prog_add_product(m->next, sum, series_zero(m, list->at[k].value), m->values.at[x[list->at[k].other]].coef);
  return sum;
}

/* Coefficient k of row v, H u' + C^T lambda, without the unknown terms of order k. */
static Slot row_below(ModelSeries *w, uint32_t v) {
  Slot quadratic = lower_terms(w, &w->H[v], w->u), adjoint = lower_terms(w, &w->column[v], w->lambda);
  return series_op(&w->m, IR_ADD, quadratic, adjoint);
}

/* Coefficients k of the adjoints lambda = H u' + C^T lambda, from the last definition on. */
static void set_adjoints(ModelSeries *w) {
  SeriesBuilder *m = &w->m;
  for (uint32_t v = w->sys->nq + w->sys->ndefs; v-- > w->sys->nq;) {
    Slot below = row_below(w, v), top = top_terms(w, &w->H[v], w->u), adjoint = top_terms(w, &w->column[v], w->lambda);
    top = series_op(m, IR_ADD, top, adjoint);
    series_set(m, w->lambda[v], series_op(m, IR_ADD, top, below));
  }
}

/* --- the factors of order 0 as order k sees them --- */

static Slot seen_slot(ModelSeries *w, Slot s) { return series_constant(&w->m, w->zero[s]); }

static SolveElements seen_elements(ModelSeries *w, const SolveElements *s) {
  SolveElements to = {0};
  for (uint32_t k = 0; k < s->n; k++)
    vec_push(w->m.arena, &to, ((SolveElement){s->at[k].at, seen_slot(w, s->at[k].x)}));
  return to;
}

static const SparseRow *seen_rows(ModelSeries *w, const SparseRow *rows, uint32_t n) {
  SparseRow *to = ARENA_ARRAY(w->m.arena, SparseRow, n + 1);
  for (uint32_t v = 0; v < n; v++)
    for (uint32_t k = 0; k < rows[v].n; k++)
      vec_push(w->m.arena, &to[v], ((SparseEntry){rows[v].at[k].col, seen_slot(w, rows[v].at[k].value)}));
  return to;
}

static FactorRecord factors_in_next(ModelSeries *w) {
  const FactorRecord *f = w->sys->factored;
  uint32_t total = f->n + f->ndefs;
  Slot *inverse = ARENA_ARRAY(w->m.arena, Slot, total + 1);
  FactorRecord seen = {.n = f->n, .ndefs = f->ndefs, .straight = f->straight, .order = f->order, .inverse = inverse};
  if (f->straight) {
    seen.pivot = ARENA_ARRAY(w->m.arena, Slot, f->n + 1);
    for (uint32_t v = 0; v < f->n; v++) inverse[v] = inverse_of(&w->m, w->zero[f->pivot[v]]);
    seen.below = seen_rows(w, f->below, f->n);
    seen.C = seen_rows(w, f->C, total);
    seen.row = seen_rows(w, f->row, total);
  }
  for (uint32_t k = 0; k < f->blocks.n; k++) {
    FactorBlock b = f->blocks.at[k];
    if (b.n < 3) inverse[k] = inverse_of(&w->m, w->zero[b.divisor]);
    if (b.n >= 2) b.M = seen_elements(w, &b.M);
    vec_push(w->m.arena, &seen.blocks, b);
  }
  return seen;
}

/* Solves small systems by the inverse: for a full M it takes as many operations as factors do, with shorter chains
 * of dependence. It is as accurate, since a definite matrix loses no digits by bad scales. */
static void solve_by_inverse(ModelSeries *w, const Slot *b, Slot *x) {
  SeriesBuilder *m = &w->m;
  FactorRecord f = *w->sys->factored;
  uint32_t n = f.n;
  Slot unit[INVERSE_MAX], column[INVERSE_MAX], inverse[INVERSE_MAX][INVERSE_MAX],
      *pivot = ARENA_ARRAY(m->arena, Slot, n);
  SparseRow *below = ARENA_ARRAY(m->arena, SparseRow, n);
  for (uint32_t v = 0; v < n; v++) {
    pivot[v] = w->zero[f.pivot[v]];
    for (uint32_t k = 0; k < f.below[v].n; k++)
      vec_push(m->arena, &below[v], ((SparseEntry){f.below[v].at[k].col, w->zero[f.below[v].at[k].value]}));
  }
  f.pivot = pivot;
  f.below = below;
  for (uint32_t j = 0; j < n; j++) {
    for (uint32_t i = 0; i < n; i++) unit[i] = i == j ? prog_num(m->first, num_int(1)) : 0;
    factor_record_solve(m->first, &f, unit, NULL, column);
    for (uint32_t i = 0; i <= j; i++) inverse[i][j] = inverse[j][i] = column[i];
  }
  for (uint32_t i = 0; i < n; i++) {
    x[i] = 0;
    for (uint32_t j = 0; j < n; j++) x[i] = prog_add_product(m->next, x[i], series_constant(m, inverse[i][j]), b[j]);
  }
}

static void solve(ModelSeries *w) {
  SeriesBuilder *m = &w->m;
  const IrSystem *sys = w->sys;
  uint32_t n = sys->nq, total = n + sys->ndefs;
  Slot *b = ARENA_ARRAY(m->arena, Slot, total + 1), *s = ARENA_ARRAY(m->arena, Slot, total + 1),
       *x = ARENA_ARRAY(m->arena, Slot, total + 1);
  if (!n) return;
  list_entries(w);
  open_unknowns(w);
  prog_title(m->next, "M q'' = f, with M as factored at order 0");
  for (uint32_t v = 0; v < total; v++) {
    Slot below = row_below(w, v), f = v < n ? m->values.at[w->value[sys->f[v]]].coef : 0;
    b[v] = series_op(m, IR_SUB, f, below);
    s[v] = v < n ? 0 : lower_terms(w, &w->row[v], w->u);
  }
  if (sys->factored->straight && n <= INVERSE_MAX && !sys->ndefs) {
    solve_by_inverse(w, b, x);
  } else {
    FactorRecord seen = factors_in_next(w);
    factor_record_solve(m->next, &seen, b, s, x);
  }
  for (uint32_t v = 0; v < total; v++) series_set(m, w->u[v], x[v]);
  set_adjoints(w);
}

/* --- stores --- */

static void store_rate(ModelSeries *w, uint32_t i, Slot zero, Slot coef) {
  Name name = w->sys->rates[i];
  uint32_t column = 2 * w->sys->nq + w->sys->nz + i;
  prog_name(w->m.first, zero, name);
  prog_name(w->m.next, coef, name);
  prog_store(w->m.first, 0, column, zero, name);
  prog_store(w->m.next, 0, column, coef, name);
}

/* x[k+1] of q, v, z: T/(k+1) times their rates. */
static void store_state(ModelSeries *w, uint32_t column, Slot rate) {
  Slot up = load(&w->m, ARR_UP, 0, "up");
  prog_store(w->m.next, 1, column, series_op(&w->m, IR_MUL, up, rate), "");
}

static void store_all(ModelSeries *w) {
  SeriesBuilder *m = &w->m;
  const IrSystem *sys = w->sys;
  uint32_t nq = sys->nq, nz = sys->nz;
  for (uint32_t i = 0; i < nq; i++) store_rate(w, i, w->zero[sys->x[i]], m->values.at[w->u[i]].coef);
  for (uint32_t i = 0; i < nz; i++)
    store_rate(w, nq + i, w->zero[sys->flow[i]], m->values.at[w->value[sys->flow[i]]].coef);
  for (uint32_t i = 0; i < nq; i++) store_state(w, i, load(m, ARR_COEF, nq + i, sys->velocities[i]));
  for (uint32_t i = 0; i < nq; i++) store_state(w, nq + i, m->values.at[w->u[i]].coef);
  for (uint32_t i = 0; i < nz; i++) store_state(w, 2 * nq + i, m->values.at[w->value[sys->flow[i]]].coef);
}

/* By slot: cycles until the loads of `next` are ready. Rates of the previous order, and v and z computed from them,
 * come last, with the sums that contain them; everything else was ready one order before. */
static const uint32_t *when_ready(const ModelSeries *w, const Prog *next) {
  enum { ORDER = 30, PRODUCT = 4 };
  uint32_t *ready = ARENA_ARRAY(next->arena, uint32_t, next->ins.n), total = w->sys->nq + w->sys->ndefs;
  unsigned char *late = ARENA_ARRAY(next->arena, unsigned char, w->m.values.n);
  for (uint32_t v = 0; w->sys->nq && v < total; v++) late[w->u[v]] = late[w->lambda[v]] = 1;
  late[0] = 0;
  for (Slot s = 1; s < next->ins.n; s++) {
    const Ins *i = &next->ins.at[s];
    if (i->op != IR_LOAD) continue;
    if (i->array == ARR_COEF && i->index >= w->sys->nq) ready[s] = ORDER + PRODUCT;
    const Pair *pair = i->array == ARR_SUMS ? &w->m.pairs.at[w->m.columns.at[i->index]] : NULL;
    if (pair && (late[pair->a] || late[pair->b])) ready[s] = ORDER;
  }
  return ready;
}

Series *series_new(const IrSystem *sys, const char **why) {
  Arena *a = sys->p->arena;
  uint32_t n = sys->p->ins.n;
  Series *out = ARENA_NEW(a, Series);
  ModelSeries w = {.m = {.arena = a, .first = prog_new(a), .next = prog_new(a)}, .sys = sys, .out = out};
  *out = (Series){.nq = sys->nq, .nz = sys->nz};
  w.need = ARENA_ARRAY(a, unsigned char, n);
  w.zero = ARENA_ARRAY(a, Slot, n);
  w.value = ARENA_ARRAY(a, Val, n);
  vec_push(a, &w.m.values, ((Value){0}));
  mark_roots(&w);
  copy_program(&w);
  if (w.m.why) {
    *why = w.m.why;
    return NULL;
  }
  solve(&w);
  store_all(&w);
  series_columns(&w.m, out);
  Prog *first = prog_tidy(w.m.first), *next = prog_tidy(w.m.next);
  next = prog_reassociate(next, when_ready(&w, next));
  out->columns = (3 * sys->nq + 2 * sys->nz + (out->uses_time ? 1 : 0) + 3) / 4 * 4;
  out->first = first;
  out->next = next;
  out->room = prog_work_size(prog_work_size(first) > prog_work_size(next) ? first : next);
  return out;
}
