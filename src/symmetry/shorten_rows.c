/* Shortens rows of a table of generators: adds a multiple of another row where fewer distinct magnitudes remain. In
 * reduced echelon form the turn of the centre of mass, xi_i = sum m_j J r_j, less a multiple of the turn of all
 * bodies, contains differences of masses. */
#include <math.h>

#include "symmetry/generator_table.h"

static uint32_t width_of(const GeneratorTable *t) { return t->blocks * t->shown; }
static long double *row_of(const GeneratorTable *t, uint32_t row) { return t->at + (size_t)row * width_of(t); }

static int same_size(long double a, long double b) { return fabsl(fabsl(a) - fabsl(b)) <= 1e-9L * fabsl(a); }

/* Number of distinct magnitudes among the nonzero entries, listed in seen[]. */
static uint32_t distinct_magnitudes(uint32_t n, const long double *x, long double *seen) {
  uint32_t count = 0;
  for (uint32_t j = 0; j < n; j++) {
    uint32_t k = 0;
    if (fabsl(x[j]) < 1e-9L) continue;
    while (k < count && !same_size(seen[k], x[j])) k++;
    if (k == count) seen[count++] = x[j];
  }
  return count;
}

/* The factor of a change; 0: there is none. */
static int factor_of(const GeneratorTable *t, RowChange c, long double *factor) {
  const long double *x = row_of(t, c.row), *y = row_of(t, c.other);
  long double slope = y[c.one] - c.sign * y[c.two];
  if (fabsl(slope) < 1e-9L) return 0;
  *factor = (c.sign * x[c.two] - x[c.one]) / slope;
  return fabsl(*factor) > 1e-9L;
}

static void changed_row(const GeneratorTable *t, uint32_t row, uint32_t other, long double factor, long double *to) {
  const long double *x = row_of(t, row), *y = row_of(t, other);
  for (uint32_t j = 0; j < width_of(t); j++) {
    to[j] = x[j] + factor * y[j];
    if (fabsl(to[j]) < 1e-10L) to[j] = 0;
  }
}

/* One column for each distinct pair of entries (x, y) of two rows; pairs (0, 0) are skipped. */
static uint32_t distinct_pairs(uint32_t n, const long double *x, const long double *y, uint32_t *at) {
  uint32_t count = 0;
  for (uint32_t j = 0; j < n; j++) {
    uint32_t k = 0;
    if (x[j] == 0 && y[j] == 0) continue;
    while (k < count && (fabsl(x[at[k]] - x[j]) > 1e-9L || fabsl(y[at[k]] - y[j]) > 1e-9L)) k++;
    if (k == count) at[count++] = j;
  }
  return count;
}

/* The change of a row that leaves the fewest distinct magnitudes; 0: none leaves fewer. */
static int best_change(Arena *a, const GeneratorTable *t, uint32_t row, RowChange *best) {
  uint32_t n = width_of(t), *at = ARENA_ARRAY(a, uint32_t, n + 1);
  long double *to = ARENA_ARRAY(a, long double, n + 1), *seen = ARENA_ARRAY(a, long double, n + 1), factor;
  uint32_t fewest = distinct_magnitudes(n, row_of(t, row), seen), before = fewest;
  for (uint32_t other = 0; other < t->rows; other++) {
    if (other == row) continue;
    uint32_t count = distinct_pairs(n, row_of(t, row), row_of(t, other), at);
    for (uint32_t i = 0; i < count; i++)
      for (uint32_t k = 0; k < count; k++)
        for (int sign = -1; sign <= 1; sign += 2) {
          RowChange c = {row, other, at[i], at[k], sign};
          if ((i == k && sign > 0) || !factor_of(t, c, &factor)) continue;
          changed_row(t, row, other, factor, to);
          uint32_t now = distinct_magnitudes(n, to, seen);
          if (now < fewest && now) fewest = now, *best = c;
        }
  }
  return fewest < before;
}

int table_change(Arena *a, GeneratorTable *t, RowChange c) {
  long double *to = ARENA_ARRAY(a, long double, width_of(t) + 1), factor;
  if (!factor_of(t, c, &factor)) return 0;
  changed_row(t, c.row, c.other, factor, to);
  memcpy(row_of(t, c.row), to, width_of(t) * sizeof *to);
  return 1;
}

uint32_t table_shorten(Arena *a, GeneratorTable *t, uint32_t row, RowChange *to) {
  uint32_t n = 0;
  while (n < CHANGES_MOST && best_change(a, t, row, &to[n])) table_change(a, t, to[n++]);
  return n;
}
