/* Simultaneous approximation by a reduced lattice basis: A.K. Lenstra, H.W. Lenstra, L. Lovasz, Math. Ann. 261 (1982) 515, DOI 10.1007/BF01457454,
 * section 1.39. The lattice of all (e q, q x - p), with a whole number q and whole numbers p, has short vectors where all of q x is nearly whole.
 * For several rows x_r with factors q_r: (e q_1, e q_2, .., q_1 x_1 + q_2 x_2 + .. - p). */
#include "symmetry/lattice_reduction.h"

#include <math.h>
#include <string.h>

#include "base/tolerance.h"

typedef long double Real;

enum { VALUES = 40, ROWS = 8, DIM = VALUES + ROWS, TURNS = 20000 };

static const Real weight = LONG_TOLERANCE(1e-16L); /* e */

typedef struct {
  uint32_t rows, values, n;    /* n: rows + values, the dimension */
  Real x[ROWS][VALUES];
  Real whole[DIM][DIM];        /* [vector] q, then p; whole numbers */
  Real star[DIM][DIM], square[DIM], mu[DIM][DIM]; /* Gram-Schmidt vectors, their squares, coefficients */
} Lattice;

/* Vector k from its whole numbers, which are exact: rounding does not accumulate. */
static void vector_of(const Lattice *l, uint32_t k, Real *to) {
  for (uint32_t r = 0; r < l->rows; r++) to[r] = weight * l->whole[k][r];
  for (uint32_t i = 0; i < l->values; i++) {
    to[l->rows + i] = -l->whole[k][l->rows + i];
    for (uint32_t r = 0; r < l->rows; r++) to[l->rows + i] += l->whole[k][r] * l->x[r][i];
  }
}

static Real product(uint32_t n, const Real *a, const Real *b) {
  Real sum = 0;
  for (uint32_t i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* Gram-Schmidt step for vector k; star[0..k-1] are orthogonal. */
static void orthogonalise(Lattice *l, uint32_t k) {
  Real b[DIM];
  vector_of(l, k, b);
  memcpy(l->star[k], b, sizeof b);
  for (uint32_t j = 0; j < k; j++) {
    l->mu[k][j] = product(l->n, b, l->star[j]) / l->square[j];
    for (uint32_t i = 0; i < l->n; i++) l->star[k][i] -= l->mu[k][j] * l->star[j][i];
  }
  l->square[k] = product(l->n, l->star[k], l->star[k]);
}

static void swap(Lattice *l, uint32_t k) {
  Real kept[DIM];
  memcpy(kept, l->whole[k], sizeof kept);
  memcpy(l->whole[k], l->whole[k - 1], sizeof kept);
  memcpy(l->whole[k - 1], kept, sizeof kept);
}

/* Size reduction: subtracts whole multiples of vectors 0..k-1 from vector k. */
static void shorten(Lattice *l, uint32_t k) {
  for (uint32_t j = k; j-- > 0;) {
    Real times = roundl(l->mu[k][j]);
    if (times == 0) continue;
    for (uint32_t i = 0; i < l->n; i++) l->whole[k][i] -= times * l->whole[j][i];
    for (uint32_t i = 0; i < j; i++) l->mu[k][i] -= times * l->mu[j][i];
    l->mu[k][j] -= times;
  }
  orthogonalise(l, k);
}

/* LLL reduction of the basis; its first vectors are short. */
static void reduce(Lattice *l) {
  uint32_t k = 1;
  orthogonalise(l, 0);
  for (int turn = 0; turn < TURNS && k < l->n; turn++) {
    orthogonalise(l, k);
    shorten(l, k);
    if (l->square[k] >= (0.99L - l->mu[k][k - 1] * l->mu[k][k - 1]) * l->square[k - 1]) {
      k++;
      continue;
    }
    swap(l, k);
    orthogonalise(l, k - 1);
    k = k > 1 ? k - 1 : 1;
  }
}

static void reduced_basis(Lattice *l) {
  l->n = l->rows + l->values;
  for (uint32_t k = 0; k < l->n; k++) l->whole[k][k] = 1;
  reduce(l);
}

/* Largest distance from a whole number at which a sum of q times rows counts as whole: random numbers come as near as q^(-rows/values)
 * (Dirichlet). */
static Real near_enough(const Lattice *l, Real q) { return fminl(0.02L * powl(fmaxl(1, fabsl(q)), -(Real)l->rows / l->values), 0.01L); }

/* --- one row --- */

/* The values of x that are not whole, each magnitude once. */
static void add_fractions(Lattice *l, const Real *x, uint32_t n) {
  const Real rounding = 1e-12L;
  for (uint32_t i = 0; i < n && l->values < VALUES; i++) {
    int seen = fabsl(x[i] - roundl(x[i])) < rounding;
    for (uint32_t k = 0; k < l->values && !seen; k++) seen = fabsl(fabsl(l->x[0][k]) - fabsl(x[i])) < rounding;
    if (!seen) l->x[0][l->values++] = x[i];
  }
}

static const Real LONGEST = 1e15L;

/* Whether all q x[i] are within `near` of whole numbers below LONGEST, and not all 0. */
static int is_common(Real q, const Real *x, uint32_t n, Real near) {
  int some = 0;
  for (uint32_t i = 0; i < n; i++) {
    Real value = q * x[i];
    if (!(fabsl(value - roundl(value)) < near) || !(fabsl(value) < LONGEST)) return 0;
    some |= roundl(value) != 0;
  }
  return some && fabsl(q) < LONGEST;
}

int64_t common_denominator(Arena *a, const long double *x, uint32_t n) {
  Lattice *l = ARENA_NEW(a, Lattice);
  l->rows = 1;
  add_fractions(l, x, n);
  reduced_basis(l);
  Real q = l->whole[0][0];
  if (l->values == 0) return 1;
  return is_common(q, x, n, near_enough(l, q)) ? (int64_t)fabsl(q) : 0;
}

/* --- several rows --- */

/* Reduced echelon form with complete pivoting; pivot[rows] are the columns. Returns the number of rows. */
static uint32_t largest_pivots(DenseRows *m, uint32_t *pivot) {
  const Real rest = 1e-9L;
  size_t w = m->width;
  for (uint32_t r = 0; r < m->n; r++) {
    size_t best = r * w;
    for (size_t k = r * w; k < m->n * w; k++)
      if (fabsl(m->at[k]) > fabsl(m->at[best])) best = k;
    Real by = m->at[best];
    if (fabsl(by) < rest) return r;
    size_t from = best / w;
    pivot[r] = (uint32_t)(best % w);
    for (size_t j = 0; j < w; j++) {
      Real x = m->at[from * w + j];
      m->at[from * w + j] = m->at[r * w + j];
      m->at[r * w + j] = x / by;
    }
    for (size_t i = 0; i < m->n; i++) {
      Real factor = m->at[i * w + pivot[r]];
      for (size_t j = 0; j < w && i != r && factor != 0; j++) m->at[i * w + j] -= factor * m->at[r * w + j];
    }
  }
  return m->n;
}

/* Numbers the blocks of rows that share no columns: part[row]. */
static void separate(const DenseRows *m, uint32_t rows, uint32_t *part) {
  const Real rest = 1e-9L;
  for (uint32_t r = 0; r < rows; r++) part[r] = r;
  for (size_t j = 0; j < m->width; j++)
    for (uint32_t r = 0, first = UINT32_MAX; r < rows; r++) {
      if (fabsl(m->at[r * m->width + j]) < rest) continue;
      if (first == UINT32_MAX) first = part[r];
      uint32_t old = part[r] > first ? part[r] : first, new = part[r] > first ? first : part[r];
      for (uint32_t i = 0; i < rows; i++)
        if (part[i] == old) part[i] = new;
      first = new;
    }
}

/* Whether x equals column k of the lattice in all rows, up to one sign. */
static int same_column(const Lattice *l, const Real *x, uint32_t k) {
  const Real rounding = 1e-12L;
  int plus = 1, minus = 1;
  for (uint32_t r = 0; r < l->rows; r++) {
    plus = plus && fabsl(x[r] - l->x[r][k]) < rounding;
    minus = minus && fabsl(x[r] + l->x[r][k]) < rounding;
  }
  return plus || minus;
}

/* Distinct columns of the given rows that are not whole, as pivots are. 0: there are too many. */
static int add_columns(Lattice *l, const DenseRows *m, const uint32_t *row) {
  const Real rounding = 1e-12L;
  for (size_t j = 0; j < m->width; j++) {
    Real x[ROWS];
    int seen = 1;
    for (uint32_t r = 0; r < l->rows; r++) {
      x[r] = m->at[row[r] * (size_t)m->width + j];
      seen = seen && fabsl(x[r] - roundl(x[r])) < rounding;
    }
    for (uint32_t k = 0; k < l->values && !seen; k++) seen = same_column(l, x, k);
    if (seen) continue;
    if (l->values == VALUES) return 0;
    for (uint32_t r = 0; r < l->rows; r++) l->x[r][l->values] = x[r];
    l->values++;
  }
  return 1;
}

/* The combination of rows that vector k of the reduced basis gives, as whole numbers. 0: it is not whole. */
static int write_row(const Lattice *l, uint32_t k, const DenseRows *m, const uint32_t *row, int64_t *to) {
  Real most = 1;
  for (uint32_t r = 0; r < l->rows; r++) most = fmaxl(most, fabsl(l->whole[k][r]));
  Real near = l->values ? near_enough(l, most) : 0.01L;
  int some = 0;
  for (size_t j = 0; j < m->width; j++) {
    Real sum = 0;
    for (uint32_t r = 0; r < l->rows; r++) sum += l->whole[k][r] * m->at[row[r] * (size_t)m->width + j];
    if (!(fabsl(sum - roundl(sum)) < near) || !(fabsl(sum) < LONGEST)) return 0;
    to[j] = (int64_t)roundl(sum);
    some |= to[j] != 0;
  }
  return some;
}

uint32_t integer_rows(Arena *a, DenseRows *space, int64_t *to) {
  uint32_t *pivot = ARENA_ARRAY(a, uint32_t, space->n + 1), *part = ARENA_ARRAY(a, uint32_t, space->n + 1), found = 0;
  uint32_t rows = largest_pivots(space, pivot);
  separate(space, rows, part);
  for (uint32_t p = 0; p < rows; p++) {
    Lattice *l = ARENA_NEW(a, Lattice);
    uint32_t row[ROWS], count = 0;
    for (uint32_t r = 0; r < rows; r++) {
      if (part[r] == p && count < ROWS) row[count] = r;
      count += part[r] == p;
    }
    l->rows = count;
    if (!count || count > ROWS || !add_columns(l, space, row)) continue;
    reduced_basis(l);
    for (uint32_t k = 0; k < count; k++) found += (uint32_t)write_row(l, k, space, row, to + (size_t)found * space->width);
  }
  return found;
}
