/* Simultaneous approximation by a reduced lattice basis: A.K. Lenstra, H.W. Lenstra, L. Lovasz, Math. Ann. 261 (1982) 515,
 * DOI 10.1007/BF01457454, section 1.39. The lattice of all (e q, q x - p), with whole numbers q for the rows of x and p for its
 * columns, has short vectors where all of q x is nearly whole. */
#include "mech/noether_fraction.h"

#include <math.h>
#include <string.h>

typedef long double Real;

enum { VALUES = 40, ROWS_MOST = 14, DIM = VALUES + ROWS_MOST, TURNS = 20000 };

typedef struct {
  uint32_t rows, values, n;    /* n: both together */
  Real x[ROWS_MOST][VALUES];
  Real weight;                 /* e */
  Real whole[DIM][DIM];        /* [vector] q, then p; whole numbers */
  Real star[DIM][DIM], square[DIM], mu[DIM][DIM]; /* of Gram and Schmidt */
} Lattice;

/* A vector from its whole numbers, which are exact: nothing piles up. */
static void vector_of(const Lattice *l, uint32_t k, Real *to) {
  for (uint32_t r = 0; r < l->rows; r++) to[r] = l->weight * l->whole[k][r];
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

/* Of vector k, those before it being done. */
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

/* Less whole multiples of the vectors before it. */
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

/* The basis becomes a reduced one, its first vectors short ones. */
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

/* Columns that are not whole in all rows, each once. */
static void take_values(Lattice *l, const Real *x, uint32_t n) {
  const Real rounding = 1e-12L;
  for (uint32_t i = 0; i < n && l->values < VALUES; i++) {
    uint32_t seen = 0, whole = 1;
    for (uint32_t r = 0; r < l->rows; r++) whole &= fabsl(x[(size_t)r * n + i] - roundl(x[(size_t)r * n + i])) < rounding;
    for (uint32_t k = 0; k < l->values && !whole && !seen; k++) {
      seen = 1;
      for (uint32_t r = 0; r < l->rows; r++) seen &= fabsl(fabsl(l->x[r][k]) - fabsl(x[(size_t)r * n + i])) < rounding;
    }
    if (whole || seen) continue;
    for (uint32_t r = 0; r < l->rows; r++) l->x[r][l->values] = x[(size_t)r * n + i];
    l->values++;
  }
  l->n = l->rows + l->values;
}

/* The largest whole number that vector k has for the rows. */
static Real size_of(const Lattice *l, uint32_t k) {
  Real size = 1;
  for (uint32_t r = 0; r < l->rows; r++) size = fmaxl(size, fabsl(l->whole[k][r]));
  return size;
}

/* The member that vector k of the basis stands for; 0: it is not whole. */
static int member(const Lattice *l, uint32_t k, const Real *x, uint32_t n, Real near, int64_t *to) {
  const Real most = 1e15L;
  int some = 0;
  for (uint32_t i = 0; i < n; i++) {
    Real value = 0;
    for (uint32_t r = 0; r < l->rows; r++) value += l->whole[k][r] * x[(size_t)r * n + i];
    if (!(fabsl(value - roundl(value)) < near) || !(fabsl(value) < most)) return 0;
    to[i] = (int64_t)roundl(value);
    some |= to[i] != 0;
  }
  return some && size_of(l, k) < most;
}

static Lattice *reduced(Arena *a, const Real *x, uint32_t rows, uint32_t n) {
  Lattice *l = ARENA_NEW(a, Lattice);
  l->rows = rows;
  l->weight = rows > 1 ? 1e-14L : 1e-16L;
  take_values(l, x, n);
  for (uint32_t k = 0; k < l->n; k++) l->whole[k][k] = 1;
  reduce(l);
  return l;
}

int64_t common_denominator(Arena *a, const long double *x, uint32_t n) {
  Lattice *l = reduced(a, x, 1, n);
  int64_t *whole = ARENA_ARRAY(a, int64_t, n + 1);
  if (l->values == 0) return 1;
  Real near = fminl(0.02L * powl(size_of(l, 0), -1.0L / l->values), 0.01L); /* numbers at random come as near as q^(-1/values) (Dirichlet) */
  return member(l, 0, x, n, near, whole) ? (int64_t)fabsl(l->whole[0][0]) : 0;
}

uint32_t whole_members(Arena *a, const long double *x, uint32_t rows, uint32_t n, int64_t *to) {
  const Real near = 0.05L;
  uint32_t count = 0;
  if (!rows || rows > ROWS_MOST) return 0;
  Lattice *l = reduced(a, x, rows, n);
  for (uint32_t k = 0; k < rows; k++) count += (uint32_t)member(l, k, x, n, near, to + (size_t)count * n);
  return count;
}
