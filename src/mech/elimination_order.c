/* Symbolic elimination on the sparsity pattern, counting operations. Candidates wait in a heap by the rule's key;
 * stale entries are skipped. */
#include "mech/elimination_order.h"

#include "base/sparse_pattern.h"

/* Kinds of entries in a pattern; products by +-1 cost nothing. */
enum { NONZERO = 1, ONE = 2 };

typedef struct {
  uint64_t key;
  uint32_t var;
} Candidate;

typedef struct {
  Arena *arena;
  uint32_t n, total;
  Sparse H;
  SparseRow *C;          /* [total] rows of definitions: the variables that they contain */
  uint32_t *nusers;      /* [total] number of remaining definitions that contain the variable */
  uint32_t *depth;       /* [total] longest chain of nested definitions down from this one; 0 for coordinates */
  unsigned char *gone;   /* [total] eliminated */
  EliminationRule rule;
  uint64_t ops;          /* operations so far */
  VEC(Candidate) heap;   /* binary, the smallest key on top; a candidate whose key has changed is stale */
} Elimination;

static Elimination elimination_new(Arena *a, ExprGraph *g, const LinearSystem *s, EliminationRule rule) {
  uint32_t total = s->n + s->ndefs;
  Elimination e = {.arena = a, .n = s->n, .total = total, .rule = rule, .H = sparse_new(a, total)};
  e.C = ARENA_ARRAY(a, SparseRow, total + 1);
  e.nusers = ARENA_ARRAY(a, uint32_t, total + 1);
  e.depth = ARENA_ARRAY(a, uint32_t, total + 1);
  e.gone = ARENA_ARRAY(a, unsigned char, total + 1);
  for (uint32_t k = 0; k < s->H.n; k++) sparse_set(&e.H, s->H.at[k].row, s->H.at[k].col, NONZERO);
  for (uint32_t k = 0; k < s->C.n; k++) {
    uint32_t row = s->C.at[k].row, col = s->C.at[k].col;
    int one = expr_is_num(g, s->C.at[k].e) && num_is_one(num_abs(expr_number(g, s->C.at[k].e)));
    vec_push(a, &e.C[row], ((SparseEntry){col, one ? ONE : NONZERO}));
    e.nusers[col]++;
    if (e.depth[row] <= e.depth[col]) e.depth[row] = e.depth[col] + 1; /* rows come in order: col is done */
  }
  return e;
}

/* --- keys of the rules --- */

/* Estimated operations of eliminating a variable: as if no factor were 1 and no sum had a 0. */
static uint64_t cost_of(const Elimination *e, uint32_t v) {
  int pivot = sparse_get(&e->H, v, v) != 0;
  uint64_t others = e->H.rows[v].n - (uint64_t)pivot;
  if (v < e->n) return others * (others + 2);
  uint64_t inside = e->C[v].n;
  return 2 * others * inside + (pivot ? inside * (inside + 2) : 0);
}

static uint64_t key_of(const Elimination *e, uint32_t v) {
  enum { HUB = 8 };
  int definition = v >= e->n;
  switch (e->rule) {
    case ORDER_CHEAPEST: return cost_of(e, v);
    case ORDER_OUTERMOST: return definition ? (uint64_t)e->total - e->depth[v] : 0;
    case ORDER_OUTERMOST_HUBS_LAST:
      return definition ? (uint64_t)e->total - e->depth[v] : e->H.rows[v].n > HUB ? e->total + cost_of(e, v) : 0;
    case ORDER_DEFINITIONS_FIRST: return definition ? 0 : 1 + cost_of(e, v);
  }
  return 0;
}

static int ready(const Elimination *e, uint32_t v) {
  return !e->gone[v] && !e->nusers[v] && (v >= e->n || sparse_get(&e->H, v, v));
}

/* --- a heap --- */

static int before(const Candidate *x, const Candidate *y) {
  return x->key != y->key ? x->key < y->key : x->var < y->var;
}

static void push(Elimination *e, uint32_t v) {
  if (!ready(e, v)) return;
  vec_push(e->arena, &e->heap, ((Candidate){key_of(e, v), v}));
  Candidate *h = e->heap.at;
  for (uint32_t i = e->heap.n - 1; i > 0 && before(&h[i], &h[(i - 1) / 2]); i = (i - 1) / 2) {
    Candidate t = h[i];
    h[i] = h[(i - 1) / 2];
    h[(i - 1) / 2] = t;
  }
}

static Candidate pop(Elimination *e) {
  Candidate *h = e->heap.at, top = h[0];
  h[0] = h[--e->heap.n];
  for (uint32_t i = 0, child = 1; child < e->heap.n; i = child, child = 2 * i + 1) {
    if (child + 1 < e->heap.n && before(&h[child + 1], &h[child])) child++;
    if (!before(&h[child], &h[i])) break;
    Candidate t = h[i];
    h[i] = h[child];
    h[child] = t;
  }
  return top;
}

/* --- steps --- */

/* Counts adding a product to entry (i, j), and records the fill-in. by_one: the product is by +-1. */
static void fill(Elimination *e, uint32_t i, uint32_t j, int by_one) {
  uint32_t *at = sparse_find(&e->H, i, j);
  e->ops += (at != NULL) + (uint64_t)!by_one;
  if (!at) sparse_set(&e->H, i, j, NONZERO);
}

static void eliminate_coordinate(Elimination *e, uint32_t v) {
  const SparseRow *row = &e->H.rows[v];
  e->ops++;
  for (uint32_t i = 0; i < row->n; i++) {
    if (row->at[i].col == v) continue;
    e->ops += 5; /* the factor; two operations in each substitution */
    for (uint32_t k = 0; k <= i; k++)
      if (row->at[k].col != v) fill(e, row->at[i].col, row->at[k].col, 0);
  }
}

static void eliminate_definition(Elimination *e, uint32_t v) {
  const SparseRow *row = &e->H.rows[v], *c = &e->C[v];
  int pivot = sparse_get(&e->H, v, v) != 0;
  for (uint32_t i = 0; i < c->n; i++) {
    int one = c->at[i].value == ONE;
    e->ops += one ? 2 : 4; /* forward and back substitution */
    for (uint32_t k = 0; k < row->n; k++)
      if (row->at[k].col != v) fill(e, row->at[k].col, c->at[i].col, one);
    e->ops += pivot && !one;
    for (uint32_t k = 0; k <= i && pivot; k++) fill(e, c->at[i].col, c->at[k].col, c->at[k].value == ONE);
  }
}

static void eliminate(Elimination *e, uint32_t v) {
  e->gone[v] = 1;
  if (v < e->n) eliminate_coordinate(e, v);
  else eliminate_definition(e, v);
  sparse_eliminate(&e->H, v);
  for (uint32_t k = 0; k < e->C[v].n; k++) e->nusers[e->C[v].at[k].col]--;
}

/* Pushes the variables whose key may have changed by the elimination of v. */
static void reconsider(Elimination *e, uint32_t v) {
  for (uint32_t k = 0; k < e->H.rows[v].n; k++) push(e, e->H.rows[v].at[k].col);
  for (uint32_t k = 0; k < e->C[v].n; k++) push(e, e->C[v].at[k].col);
}

typedef struct {
  ExprGraph *g;
  LinearSystem *s;
  EliminationRule rule;
  uint64_t enough;
  uint32_t *order; /* [n + ndefs] of s */
} OrderTask;

static void find_order(Arena *scratch, void *data) {
  const OrderTask *t = data;
  Elimination e = elimination_new(scratch, t->g, t->s, t->rule);
  uint32_t *order = t->order, n = 0;
  uint64_t enough = t->enough;
  for (uint32_t v = 0; v < e.total; v++) push(&e, v);
  while (e.heap.n && e.ops <= enough) {
    Candidate c = pop(&e);
    if (!ready(&e, c.var) || c.key != key_of(&e, c.var)) continue;
    order[n++] = c.var;
    eliminate(&e, c.var);
    reconsider(&e, c.var);
  }
  for (uint32_t v = 0; v < e.n && e.ops <= enough; v++) /* no pivot: singular; the run reports it */
    if (!e.gone[v]) order[n++] = v;
  t->s->order = order;
  t->s->ops = e.ops;
}

void elimination_order(Arena *a, ExprGraph *g, LinearSystem *s, EliminationRule rule, uint64_t enough) {
  OrderTask t = {g, s, rule, enough, ARENA_ARRAY(a, uint32_t, s->n + s->ndefs + 1)};
  arena_with_scratch(a, find_order, &t);
}

/* Takes the order of another rule if it has fewer operations, or as many and `equal` is set. */
static void try_rule(Arena *a, ExprGraph *g, LinearSystem *s, EliminationRule rule, int equal) {
  LinearSystem other = *s;
  elimination_order(a, g, &other, rule, s->ops);
  if (other.ops < s->ops || (equal && other.ops == s->ops)) *s = other;
}

void elimination_order_best(Arena *a, ExprGraph *g, LinearSystem *s) {
  elimination_order(a, g, s, ORDER_OUTERMOST, UINT64_MAX);
  try_rule(a, g, s, ORDER_CHEAPEST, 1);
  try_rule(a, g, s, ORDER_OUTERMOST_HUBS_LAST, 0);
}
