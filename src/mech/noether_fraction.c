/* Simultaneous approximation by a reduced lattice basis: A.K. Lenstra, H.W. Lenstra, L. Lovasz, Math. Ann. 261 (1982) 515,
 * DOI 10.1007/BF01457454, section 1.39. The lattice of q (e, x) - (0, p) has a short vector where all q x are nearly whole. */
#include "mech/noether_fraction.h"

#include <math.h>
#include <string.h>

typedef long double Real;

enum { VALUES = 12, DIM = VALUES + 1, TURNS = 4000 };

typedef struct {
  uint32_t n;             /* of the lattice: 1 + values */
  Real x[VALUES];
  Real weight;            /* e */
  Real whole[DIM][DIM];   /* [vector] q, then p; whole numbers */
} Lattice;

/* A vector from its whole numbers, which are exact: nothing piles up. */
static void vector_of(const Lattice *l, uint32_t k, Real *to) {
  to[0] = l->weight * l->whole[k][0];
  for (uint32_t i = 1; i < l->n; i++) to[i] = l->whole[k][0] * l->x[i - 1] - l->whole[k][i];
}

static Real product(uint32_t n, const Real *a, const Real *b) {
  Real sum = 0;
  for (uint32_t i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* Gram-Schmidt of the first vectors: star[k], its square, mu[k][j]. */
static void orthogonalise(const Lattice *l, uint32_t upto, Real star[DIM][DIM], Real *square, Real mu[DIM][DIM]) {
  for (uint32_t k = 0; k <= upto; k++) {
    Real b[DIM];
    vector_of(l, k, b);
    memcpy(star[k], b, sizeof b);
    for (uint32_t j = 0; j < k; j++) {
      mu[k][j] = product(l->n, b, star[j]) / square[j];
      for (uint32_t i = 0; i < l->n; i++) star[k][i] -= mu[k][j] * star[j][i];
    }
    square[k] = product(l->n, star[k], star[k]);
  }
}

static void subtract(Lattice *l, uint32_t k, uint32_t j, Real times) {
  for (uint32_t i = 0; i < l->n; i++) l->whole[k][i] -= times * l->whole[j][i];
}

static void swap(Lattice *l, uint32_t k) {
  Real kept[DIM];
  memcpy(kept, l->whole[k], sizeof kept);
  memcpy(l->whole[k], l->whole[k - 1], sizeof kept);
  memcpy(l->whole[k - 1], kept, sizeof kept);
}

/* The basis becomes a reduced one, its first vector a short one. */
static void reduce(Lattice *l) {
  Real star[DIM][DIM], square[DIM], mu[DIM][DIM] = {{0}};
  uint32_t k = 1;
  for (int turn = 0; turn < TURNS && k < l->n; turn++) {
    for (uint32_t j = k; j-- > 0;) {
      orthogonalise(l, k, star, square, mu);
      if (fabsl(mu[k][j]) > 0.5L) subtract(l, k, j, roundl(mu[k][j]));
    }
    orthogonalise(l, k, star, square, mu);
    if (square[k] >= (0.99L - mu[k][k - 1] * mu[k][k - 1]) * square[k - 1]) {
      k++;
    } else {
      swap(l, k);
      k = k > 1 ? k - 1 : 1;
    }
  }
}

/* Those that are no whole numbers, each once. */
static void take_values(Lattice *l, const Real *x, uint32_t n) {
  l->n = 1;
  for (uint32_t i = 0; i < n && l->n < DIM; i++) {
    uint32_t k = 0;
    if (fabsl(x[i] - roundl(x[i])) < 1e-12L) continue;
    while (k + 1 < l->n && fabsl(fabsl(l->x[k]) - fabsl(x[i])) > 1e-12L) k++;
    if (k + 1 == l->n) l->x[l->n++ - 1] = x[i];
  }
}

int64_t common_denominator(const long double *x, uint32_t n) {
  const Real digits = 1e-16L, most = 1e15L;
  Lattice l = {.weight = digits};
  take_values(&l, x, n);
  for (uint32_t k = 0; k < l.n; k++) l.whole[k][k] = 1;
  reduce(&l);
  Real q = fabsl(l.whole[0][0]);
  if (l.n == 1) q = 1;
  if (!(q >= 1 && q <= most)) return 0;
  /* numbers at random come as near as q^(-1/k) (Dirichlet) */
  Real near = l.n == 1 ? 1e-3L : 0.02L * powl(q, -1.0L / (l.n - 1));
  for (uint32_t i = 0; i < n; i++)
    if (!(fabsl(q * x[i] - roundl(q * x[i])) < near) || !(fabsl(q * x[i]) < most)) return 0;
  return (int64_t)q;
}
