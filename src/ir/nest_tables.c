/* A nest with indices from tables, for pieces without affine order: springs of an irregular net, sums over some of many bodies. Columns
 * that differ by a factor and an offset share a table. The order of turns is free; sorted by one body, that body's indices are the same
 * in each row, and tables get shorter. */
#include <string.h>

#include "ir/nest_impl.h"

enum { MOST_KEYS = 8 };

/* Columns as first + step*value, with equal sequences of values stored once. */
typedef struct {
  const Indices *x;
  const uint32_t *pieces;
  uint32_t n;
  int64_t *first, *step; /* [width]; step 0: the index is the same for all pieces */
  uint32_t *of;          /* [width] position in `values` */
  VEC(uint32_t *) values; /* each [n], least value 0, greatest common divisor 1 */
} Table;

/* An order of the pieces, in rows if begin is not NULL, and the number of table entries that it needs. */
typedef struct {
  uint32_t *order; /* [n] positions in Table.pieces */
  uint32_t *begin, rows;
  const uint32_t *key; /* the values by which rows are sorted; */
  int by_value;        /* the key is the number of the row: some rows may be empty */
  uint64_t entries;
} TurnOrder;

static int64_t at(const Table *t, uint32_t piece, uint32_t column) { return t->x->columns[(size_t)t->pieces[piece]*t->x->width + column]; }

static uint32_t number_of(Table *t, uint32_t *values) {
  for (uint32_t k = 0; k < t->values.n; k++)
    if (memcmp(t->values.at[k], values, t->n * sizeof *values) == 0) return k;
  vec_push(t->x->a, &t->values, values);
  return t->values.n - 1;
}

static void split_column(Table *t, uint32_t k) {
  int64_t least = at(t, 0, k), step = 0;
  for (uint32_t i = 1; i < t->n; i++) {
    int64_t now = at(t, i, k);
    step = nest_gcd(step, now - at(t, 0, k));
    if (now < least) least = now;
  }
  t->first[k] = least;
  t->step[k] = step;
  if (!step) return;
  uint32_t *values = ARENA_ARRAY(t->x->a, uint32_t, t->n);
  for (uint32_t i = 0; i < t->n; i++) values[i] = (uint32_t)((at(t, i, k) - least)/step);
  t->of[k] = number_of(t, values);
}

/* --- orders --- */

typedef struct {
  const Table *t;
  uint32_t key;
} ByKey;

/* Order by the key, then by all other values. */
static int before(const void *by_key, uint32_t x, uint32_t y) {
  const ByKey *by = by_key;
  uint32_t *const *values = by->t->values.at;
  if (values[by->key][x] != values[by->key][y]) return values[by->key][x] < values[by->key][y];
  for (uint32_t k = 0; k < by->t->values.n; k++)
    if (values[k][x] != values[k][y]) return values[k][x] < values[k][y];
  return x < y;
}

static uint32_t *sorted(const Table *t, uint32_t key) {
  uint32_t *order = ARENA_ARRAY(t->x->a, uint32_t, t->n);
  for (uint32_t k = 0; k < t->n; k++) order[k] = k;
  nest_sort(t->x->a, order, t->n, before, &(ByKey){t, key});
  return order;
}

/* The value in row k, or in turn k. An empty row may have any. */
static uint32_t value_at(const TurnOrder *l, const uint32_t *values, int of_rows, uint32_t k) {
  if (!of_rows) return values[l->order[k]];
  if (l->begin[k] < l->begin[k + 1]) return values[l->order[l->begin[k]]];
  return values == l->key ? k : 0;
}

/* Whether the n values are equally spaced. */
static int is_even(const TurnOrder *l, const uint32_t *values, int of_rows, uint32_t n) {
  for (uint32_t k = 2; k < n; k++) {
    uint32_t x = value_at(l, values, of_rows, k - 2), y = value_at(l, values, of_rows, k - 1), z = value_at(l, values, of_rows, k);
    if (z - y != y - x) return 0;
  }
  return 1;
}

static int is_of_rows(const uint32_t *values, const TurnOrder *l) {
  for (uint32_t i = 0; i < l->rows; i++)
    for (uint32_t j = l->begin[i]; j < l->begin[i + 1]; j++)
      if (values[l->order[j]] != values[l->order[l->begin[i]]]) return 0;
  return 1;
}

static uint64_t entries_of(const Table *t, const TurnOrder *l) {
  uint64_t entries = l->begin ? l->rows + 1 : 0;
  for (uint32_t k = 0; k < t->values.n; k++) {
    const uint32_t *v = t->values.at[k];
    if (l->begin && is_of_rows(v, l)) entries += is_even(l, v, 1, l->rows) ? 0 : l->rows;
    else entries += is_even(l, v, 0, t->n) ? 0 : t->n;
  }
  return entries;
}

/* Rows of equal keys, if they have two turns on the average; else one row, without begin. Where few keys are missing, the key is the
 * row's number. */
static TurnOrder in_rows(const Table *t, uint32_t key, uint32_t *order) {
  const uint32_t *v = t->values.at[key];
  uint32_t rows = 1, most = v[order[t->n - 1]];
  for (uint32_t k = 1; k < t->n; k++) rows += v[order[k]] != v[order[k - 1]];
  if (rows > t->n/2) return (TurnOrder){.order = order, .rows = 1};
  TurnOrder l = {.order = order, .key = v, .by_value = most < 2*rows};
  l.begin = ARENA_ARRAY(t->x->a, uint32_t, (l.by_value ? most : rows) + 2);
  for (uint32_t k = 0; k < t->n; k++) {
    int is_new = !k || v[order[k]] != v[order[k - 1]];
    for (uint32_t end = l.by_value ? v[order[k]] + 1 : l.rows + 1; is_new && l.rows < end;) l.begin[l.rows++] = k;
  }
  l.begin[l.rows] = t->n;
  return l;
}

static TurnOrder shortest(const Table *t) {
  TurnOrder best = {.entries = UINT64_MAX};
  for (uint32_t key = 0; key < t->values.n && key < MOST_KEYS; key++) {
    uint32_t *order = sorted(t, key);
    TurnOrder tried[2] = {{.order = order, .rows = 1}, in_rows(t, key, order)};
    for (int k = 0; k < 2; k++) {
      tried[k].entries = entries_of(t, &tried[k]);
      if (tried[k].entries < best.entries) best = tried[k];
    }
  }
  return best;
}

/* --- places --- */

/* Table of the values of all rows, or of all turns, in order; NULL, first and step where they are equally spaced. */
static const uint32_t *tabulated(const Table *t, const TurnOrder *l, const uint32_t *values, int of_rows, int64_t *step, int64_t *first) {
  uint32_t n = of_rows ? l->rows : t->n, *r = ARENA_ARRAY(t->x->a, uint32_t, n);
  for (uint32_t k = 0; k < n; k++) r[k] = value_at(l, values, of_rows, k);
  *step = 1;
  *first = 0;
  if (!is_even(l, values, of_rows, n)) return r;
  *step = n > 1 ? (int64_t)r[1] - r[0] : 0;
  *first = r[0];
  return NULL;
}

Fit nest_tables(const Indices *x, const uint32_t *pieces, uint32_t n) {
  Arena *a = x->a;
  Table t = {.x = x, .pieces = pieces, .n = n};
  t.first = ARENA_ARRAY(a, int64_t, x->width + 1);
  t.step = ARENA_ARRAY(a, int64_t, x->width + 1);
  t.of = ARENA_ARRAY(a, uint32_t, x->width + 1);
  for (uint32_t k = 0; k < x->width; k++) split_column(&t, k);
  if (!t.values.n) vec_push(a, &t.values, ARENA_ARRAY(a, uint32_t, n)); /* all indices are constant */
  TurnOrder l = shortest(&t);
  uint32_t *in_order = ARENA_ARRAY(a, uint32_t, n);
  for (uint32_t k = 0; k < n; k++) in_order[k] = pieces[l.order[k]];
  IrSubscript *places = ARENA_ARRAY(a, IrSubscript, t.values.n + 1), *all = ARENA_ARRAY(a, IrSubscript, x->width + 1);
  for (uint32_t k = 0; k < t.values.n; k++) {
    int of_rows = l.begin && is_of_rows(t.values.at[k], &l);
    int64_t step;
    const uint32_t *table = tabulated(&t, &l, t.values.at[k], of_rows, &step, &places[k].first);
    if (of_rows) places[k].by_row = step, places[k].row_at = table;
    else places[k].by_turn = step, places[k].turn_at = table;
  }
  for (uint32_t k = 0; k < x->width; k++) {
    all[k].first = t.first[k];
    if (!t.step[k]) continue;
    all[k] = places[t.of[k]];
    all[k].first = t.first[k] + t.step[k]*all[k].first;
    all[k].by_row *= t.step[k];
    all[k].by_turn *= t.step[k];
  }
  return (Fit){.rows = l.rows, .turns = l.begin ? 0 : n, .begin = l.begin, .at = all, .pieces = in_order, .count = n};
}
