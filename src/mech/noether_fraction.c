/* Simultaneous approximation by a reduced lattice basis: A.K. Lenstra, H.W. Lenstra, L. Lovasz, Math. Ann. 261 (1982) 515,
 * DOI 10.1007/BF01457454, section 1.39. The lattice of all (e q, q x - p), with a whole number q and whole numbers p, has
 * short vectors where all of q x is nearly whole. */
#include "mech/noether_fraction.h"

#include <math.h>
#include <string.h>

typedef long double Real;

enum { VALUES = 40, DIM = VALUES + 1, TURNS = 20000 };

static const Real weight = 1e-16L; /* e */

typedef struct {
  uint32_t values, n;          /* n: with q */
  Real x[VALUES];
  Real whole[DIM][DIM];        /* [vector] q, then p; whole numbers */
  Real star[DIM][DIM], square[DIM], mu[DIM][DIM]; /* of Gram and Schmidt */
} Lattice;

/* A vector from its whole numbers, which are exact: nothing piles up. */
static void vector_of(const Lattice *l, uint32_t k, Real *to) {
  to[0] = weight * l->whole[k][0];
  for (uint32_t i = 0; i < l->values; i++) to[1 + i] = l->whole[k][0] * l->x[i] - l->whole[k][1 + i];
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

/* Those that are not whole, each once. */
static void take_values(Lattice *l, const Real *x, uint32_t n) {
  const Real rounding = 1e-12L;
  for (uint32_t i = 0; i < n && l->values < VALUES; i++) {
    int seen = fabsl(x[i] - roundl(x[i])) < rounding;
    for (uint32_t k = 0; k < l->values && !seen; k++) seen = fabsl(fabsl(l->x[k]) - fabsl(x[i])) < rounding;
    if (!seen) l->x[l->values++] = x[i];
  }
  l->n = 1 + l->values;
}

/* Whether q times each of x is within `near` of a whole number, and not a long one. */
static int is_common(Real q, const Real *x, uint32_t n, Real near) {
  const Real most = 1e15L;
  int some = 0;
  for (uint32_t i = 0; i < n; i++) {
    Real value = q * x[i];
    if (!(fabsl(value - roundl(value)) < near) || !(fabsl(value) < most)) return 0;
    some |= roundl(value) != 0;
  }
  return some && fabsl(q) < most;
}

int64_t common_denominator(Arena *a, const long double *x, uint32_t n) {
  Lattice *l = ARENA_NEW(a, Lattice);
  take_values(l, x, n);
  for (uint32_t k = 0; k < l->n; k++) l->whole[k][k] = 1;
  reduce(l);
  Real q = l->whole[0][0];
  if (l->values == 0) return 1;
  Real near = fminl(0.02L * powl(fmaxl(1, fabsl(q)), -1.0L / l->values), 0.01L); /* numbers at random come as near as q^(-1/values) (Dirichlet) */
  return is_common(q, x, n, near) ? (int64_t)fabsl(q) : 0;
}
