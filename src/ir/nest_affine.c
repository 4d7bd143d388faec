/* Pieces of a group as nests whose indices are affine in two counters. Pieces are split by shape where shapes are
 * few (a spring to the right, a spring downwards), and sorted; runs of equal steps are rows, and rows whose first
 * indices and lengths go by equal steps a nest. */
#include <string.h>

#include "ir/nest_impl.h"

enum { FEWEST_TURNS = 8, MOST_SHAPES = 24, MANY = 0 };

/* A row: `count` pieces of the order from `begin` on, at equal steps of all indices. */
typedef struct {
  uint32_t begin, count;
} Row;

typedef VEC(Row) Rows;

static const int64_t *indices(const Indices *g, uint32_t k) { return g->columns + (size_t)g->order[k] * g->width; }

/* --- shapes --- */

/* The first column that varies. */
static uint32_t first_varying(const Indices *g) {
  uint32_t k = 0;
  while (k + 1 < g->width && !g->varies[k]) k++;
  return k;
}

static void find_varying(Indices *g) {
  unsigned char *varies = ARENA_ARRAY(g->a, unsigned char, g->width + 1);
  for (uint32_t i = 1; i < g->n; i++)
    for (uint32_t k = 0; k < g->width; k++) varies[k] |= indices(g, i)[k] != indices(g, 0)[k];
  g->varies = varies;
}

/* Greatest common divisor; of 0 and b, |b|. */
static int64_t gcd(int64_t a, int64_t b) {
  while (b) {
    int64_t r = a % b;
    a = b;
    b = r;
  }
  return a < 0 ? -a : a;
}

/* Greatest common divisor of the distances between a piece's indices in one array: 2 where x and y do not mix. 0: no
 * distances. */
static int64_t spacing(const Indices *g, uint32_t first) {
  int64_t all = 0;
  for (uint32_t k = 0; k < g->n && all != 1; k++)
    for (uint32_t j = 0; j < g->width; j++)
      if (g->array[j] == g->array[first] && g->varies[j]) all = gcd(all, indices(g, k)[j] - indices(g, k)[first]);
  return all;
}

/* Key of a shape: the first varying index modulo the spacing; for modulo 0, a hash of the other indices in its array
 * relative to it. */
static uint64_t shape_of(const Indices *g, uint32_t first, uint32_t k, int64_t modulo) {
  const int64_t *at = indices(g, k);
  uint64_t h = modulo ? (uint64_t)(at[first] % modulo) : 0;
  for (uint32_t j = 0; j < g->width && !modulo; j++)
    if (g->array[j] == g->array[first] && g->varies[j]) h = (h ^ (uint64_t)(at[j] - at[first])) * 0x100000001b3u + 1;
  return h;
}

/* Sorts pieces by shape, stably; end[]: end of each shape. Returns the number of shapes, or MANY: all pairs of n
 * bodies have n - 1. */
static uint32_t split(Indices *g, uint32_t first, int64_t modulo, uint32_t *end) {
  uint64_t known[MOST_SHAPES];
  uint32_t n = 0, *shape = ARENA_ARRAY(g->a, uint32_t, g->n), *to = ARENA_ARRAY(g->a, uint32_t, g->n), put = 0;
  for (uint32_t k = 0; k < g->n; k++) {
    uint64_t h = shape_of(g, first, k, modulo);
    while (shape[k] < n && known[shape[k]] != h) shape[k]++;
    if (shape[k] < n) continue;
    if (4*(n + 1)*(n + 1) > g->n || n == MOST_SHAPES) return MANY;
    known[n++] = h;
  }
  for (uint32_t x = 0; x < n; x++) {
    for (uint32_t k = 0; k < g->n; k++)
      if (shape[k] == x) to[put++] = g->order[k];
    end[x] = put;
  }
  memcpy(g->order, to, g->n * sizeof *to);
  return n;
}

/* --- sorting --- */

static int before(const Indices *g, uint32_t x, uint32_t y) {
  const int64_t *a = g->columns + (size_t)x * g->width, *b = g->columns + (size_t)y * g->width;
  for (uint32_t k = 0; k < g->width; k++)
    if (a[k] != b[k]) return a[k] < b[k];
  return x < y;
}

/* Sorts the group by a merge: the order depends on the group, which qsort does not pass on. */
static void sort(Indices *g) {
  uint32_t n = g->n, *from = g->order, *to = ARENA_ARRAY(g->a, uint32_t, n);
  for (uint32_t size = 1; size < n; size *= 2) {
    for (uint32_t left = 0; left < n; left += 2 * size) {
      uint32_t i = left, middle = left + size < n ? left + size : n, j = middle,
               end = middle + size < n ? middle + size : n;
      for (uint32_t k = left; k < end; k++)
        to[k] = j == end || (i < middle && before(g, from[i], from[j])) ? from[i++] : from[j++];
    }
    uint32_t *t = from;
    from = to;
    to = t;
  }
  if (from != g->order) memcpy(g->order, from, n * sizeof *from);
}

/* --- rows --- */

/* Whether index vectors x, y and z of the order are equally spaced. */
static int even(const Indices *g, uint32_t x, uint32_t y, uint32_t z) {
  const int64_t *a = indices(g, x), *b = indices(g, y), *c = indices(g, z);
  for (uint32_t k = 0; k < g->width; k++)
    if (c[k] - b[k] != b[k] - a[k]) return 0;
  return 1;
}

/* Rows of pieces with equal steps and, where that is common, one index the same in each row. */
static Rows find_rows(const Indices *g) {
  uint32_t common = first_varying(g), pairs = 0;
  Rows rows = {0};
  for (uint32_t i = 1; i < g->n; i++) pairs += indices(g, i)[common] == indices(g, i - 1)[common];
  int by_common = pairs >= g->n / 2;
  for (uint32_t i = 0; i < g->n;) {
    uint32_t n = 1;
    while (i + n < g->n && (!by_common || indices(g, i + n)[common] == indices(g, i)[common]) &&
           (n < 2 || even(g, i + n - 2, i + n - 1, i + n)))
      n++;
    vec_push(g->a, &rows, ((Row){i, n}));
    i += n;
  }
  return rows;
}

/* --- nests --- */

/* A nest that grows row by row. */
typedef struct {
  const Row *rows;
  uint32_t n;
  int64_t *row, *turn; /* [width] steps from row to row, known from 2 rows on; from turn to turn */
  int steps;           /* turn is known */
} Growing;

static void difference(const Indices *g, uint32_t x, uint32_t y, int64_t *to) {
  for (uint32_t k = 0; k < g->width; k++) to[k] = indices(g, y)[k] - indices(g, x)[k];
}

static int same_steps(const Indices *g, uint32_t x, uint32_t y, const int64_t *step) {
  for (uint32_t k = 0; k < g->width; k++)
    if (indices(g, y)[k] - indices(g, x)[k] != step[k]) return 0;
  return 1;
}

static int takes_row(const Indices *g, Growing *w) {
  const Row *next = &w->rows[w->n], *last = next - 1;
  if (w->n >= 2) {
    int64_t more = (int64_t)w->rows[1].count - w->rows[0].count;
    if ((int64_t)next->count - last->count != more || !same_steps(g, last->begin, next->begin, w->row)) return 0;
  }
  if (next->count >= 2 && w->steps && !same_steps(g, next->begin, next->begin + 1, w->turn)) return 0;
  if (next->count >= 2 && !w->steps) {
    difference(g, next->begin, next->begin + 1, w->turn);
    w->steps = 1;
  }
  if (w->n == 1) difference(g, last->begin, next->begin, w->row);
  w->n++;
  return 1;
}

/* The skew for which the first index that changes from turn to turn stays the same from row to row; 0: none. */
static int64_t skew_of(const Indices *g, const Growing *w) {
  for (uint32_t k = 0; k < g->width; k++)
    if (w->turn[k]) return w->row[k] % w->turn[k] == 0 ? w->row[k] / w->turn[k] : 0;
  return 0;
}

static Fit fit_of(const Indices *g, const Growing *w, uint32_t count) {
  IrSubscript *at = ARENA_ARRAY(g->a, IrSubscript, g->width + 1);
  Fit f = {.rows = w->n, .turns = w->rows->count, .at = at, .pieces = g->order + w->rows->begin, .count = count};
  if (w->n > 1) f.more = (int64_t)w->rows[1].count - w->rows[0].count;
  f.skew = skew_of(g, w);
  for (uint32_t k = 0; k < g->width; k++)
    at[k] = (IrSubscript){
        .first = indices(g, w->rows->begin)[k], .by_row = w->row[k] - f.skew * w->turn[k], .by_turn = w->turn[k]};
  return f;
}

static void fit_shape(Indices *g, Fits *fits) {
  sort(g);
  find_varying(g);
  Rows rows = find_rows(g);
  for (uint32_t i = 0; i < rows.n;) {
    Growing w = {.rows = rows.at + i,
                 .n = 1,
                 .row = ARENA_ARRAY(g->a, int64_t, g->width + 1),
                 .turn = ARENA_ARRAY(g->a, int64_t, g->width + 1)};
    if (w.rows->count >= 2) {
      difference(g, w.rows->begin, w.rows->begin + 1, w.turn);
      w.steps = 1;
    }
    while (i + w.n < rows.n && takes_row(g, &w)) {}
    uint32_t count = 0;
    for (uint32_t k = 0; k < w.n; k++) count += w.rows[k].count;
    if (count >= FEWEST_TURNS) vec_push(g->a, fits, fit_of(g, &w, count));
    i += w.n;
  }
}

void nest_affine(Indices all, Fits *fits) {
  uint32_t end[MOST_SHAPES], begin = 0;
  find_varying(&all);
  uint32_t first = first_varying(&all), shapes = split(&all, first, 0, end);
  if (shapes == MANY) shapes = split(&all, first, spacing(&all, first), end);
  if (shapes == MANY) end[0] = all.n, shapes = 1;
  for (uint32_t k = 0; k < shapes; k++) {
    Indices g = all;
    g.order = all.order + begin;
    g.n = end[k] - begin;
    fit_shape(&g, fits);
    begin = end[k];
  }
}
