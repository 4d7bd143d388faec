/* Floquet multipliers of a periodic motion (periodic_orbit.h): the eigenvalues of its derivative over a period, in
 * the space that is left of the tangent space of constraints when the levels of conserved charges, the direction of
 * motion and those of symmetries are taken out: along these the multipliers are 1, in Jordan blocks, whose eigenvalues
 * would have half of the digits. */
#include <math.h>
#include <string.h>

#include "analysis/orthonormalise.h"
#include "analysis/periodic_orbit.h"
#include "analysis/quotient_space.h"
#include "numeric/dense.h"

/* Whether state i only counts, as which foot stands: without events it keeps its value at the nodes, and each segment
 * leaves a change of it as it is, but for its sign. */
static int is_counter(PeriodicOrbit *o, int i) {
  const double least = 1e-6;
  for (int k = 0; k < o->m; k++)
    if (lag_flow_rates(&o->flow, o->flow.t0, o->y + k * o->n, o->w) || o->w[i] != 0.0) return 0;
  for (int e = 0; e < o->m * o->n; e++) {
    double left = fabs(o->Phi[e * o->n + i]) * o->unit[i] / o->unit[e % o->n] - (e % o->n == i);
    if (!(fabs(left) < least)) return 0;
  }
  return 1;
}

/* d[n] := the direction of motion at node s; where a slide begins beside its surface, that of the run that ends there,
 * on its side of the switch. */
static int direction(PeriodicOrbit *o, int s, double *d) {
  const double side = 1e-3; /* a gap between segments, on the way to a solution, changes rates by less */
  int mapped = s == 0 && (o->ngroup || o->closing || o->half), rc;
  const double *rates = o->rates + (s + o->m - 1) % o->m * o->n;
  double off = 0, size = 0;
  rc = lag_flow_rates(&o->flow, o->flow.t0 + o->T * s / o->m, o->y + s * o->n, d);
  for (int i = 0; i < o->n && rc == LAG_OK && !mapped; i++) {
    off = fmax(off, fabs(rates[i] - d[i]) / o->unit[i]);
    size = fmax(size, fabs(d[i]) / o->unit[i]);
  }
  if (off > side * size) memcpy(d, rates, (size_t)o->n * sizeof *d);
  return rc;
}

/* At node s: L[n c] := the gradients of conserved charges, R[n *nr] := the direction of motion, those of symmetries and
 * of counters, in units and of length 1. */
static int invariants(PeriodicOrbit *o, int s, double *L, double *R, int *nr) {
  const double t = o->flow.t0 + o->T * s / o->m, *y = o->y + s * o->n;
  int n = o->n, c = o->ncharges, most = c + 1 + o->ngroup + n - 2 * o->flow.nq, rc = LAG_OK;
  double *d = o->x;
  *nr = 0;
  for (int k = 0; k < c && rc == LAG_OK; k++) {
    rc = lag_flow_gradient(&o->flow, o->charge[k], t, y, d);
    for (int i = 0; i < n; i++) L[i * c + k] = d[i] * o->unit[i];
  }
  for (int k = -1; k < c && rc == LAG_OK; k++) {
    if (k < 0 ? o->flow.forced : o->charge[k] == 0) continue;
    if (k < 0 ? direction(o, s, d) : lag_flow_field(&o->flow, o->charge[k], t, y, d)) continue;
    for (int i = 0; i < n; i++) R[i * most + *nr] = d[i] / o->unit[i];
    ++*nr;
  }
  for (int j = 0; j < o->ngroup; j++) {
    const OrbitClosing *g = &o->group[j];
    for (int i = 0; i < n && g->n; i++) R[i * most + *nr] = 0;
    for (int i = 0; i < g->n; i++) R[g->shifted[i] * most + *nr] = 1 / o->unit[g->shifted[i]];
    *nr += g->n > 0;
  }
  for (int z = 2 * o->flow.nq; z < n; z++) {
    if (!is_counter(o, z)) continue;
    for (int i = 0; i < n; i++) R[i * most + *nr] = i == z;
    ++*nr;
  }
  for (int i = 0; i < n; i++) /* rows of *nr elements, one behind the other */
    for (int j = 0; j < *nr; j++) R[i * *nr + j] = R[i * most + j];
  lag_normalise_columns(n, c, L);
  lag_normalise_columns(n, *nr, R);
  return rc;
}

/* The space of other changes at node s: basis *b; *all: dimension of the tangent space there. */
static int quotient(Pool *pool, PeriodicOrbit *o, int s, Basis *b, int *all) {
  const double t = o->flow.t0 + o->T * s / o->m, *y = o->y + s * o->n;
  int n = o->n, nr = 0, rc;
  *b = (Basis){n, n, lag_pool_doubles(pool, (size_t)(n * n))};
  rc = b->B ? lag_flow_tangent_basis(&o->flow, pool, t, y, o->unit, b->B, &b->k) : LAG_ENOMEM;
  double *L = lag_pool_doubles(pool, (size_t)(n * (o->ncharges + 1))),
         *R = lag_pool_doubles(pool, (size_t)(n * (o->ncharges + 1 + o->ngroup + n)));
  rc = pool->failed ? LAG_ENOMEM : rc;
  *all = b->k;
  rc = rc ? rc : invariants(o, s, L, R, &nr);
  rc = rc ? rc : lag_within_levels(pool, n, o->ncharges, L, &nr, R);
  rc = rc ? rc : lag_basis_take_out(pool, b, o->ncharges, L);
  return rc ? rc : lag_basis_take_out(pool, b, nr, R);
}

/* W[k k] := P, the derivative over segment s, from basis a to basis b. The last segment ends with the inverse of what
 * closes the motion. */
static int reduced(Pool *pool, const PeriodicOrbit *o, int s, const Basis *a, const Basis *b, double *W) {
  int n = o->n, k = a->k;
  double *P = lag_pool_doubles(pool, (size_t)(n * n)), *G = lag_pool_doubles(pool, (size_t)(n * n)),
         *PB = lag_pool_doubles(pool, (size_t)(n * k) + 1);
  if (pool->failed) return LAG_ENOMEM;
  memcpy(P, o->Phi + s * n * n, (size_t)(n * n) * sizeof *P);
  memcpy(G, o->G, (size_t)(n * n) * sizeof *G);
  if (s == o->m - 1 && (o->ngroup || o->closing) && lag_solve_dense((size_t)n, (size_t)n, G, P)) return LAG_ESINGULAR;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < k; j++)
      for (int l = 0; l < n; l++) PB[i * k + j] += P[i * n + l] * o->unit[l] / o->unit[i] * a->B[l * k + j];
  lag_multiply_transposed(b->k, n, k, b->B, PB, W);
  return LAG_OK;
}

/* W[k k] := to' W from, with orthogonal matrices; scratch[k k]. */
static void transform(int k, const double *to, const double *from, double *W, double *scratch) {
  lag_multiply(k, k, k, W, from, scratch);
  lag_multiply_transposed(k, k, k, to, scratch, W);
}

/* Q[k k] := a reflection along no axis, so that all directions mix, those of parts that do not act on each other,
 * too. */
static void reflect(int k, double *Q) {
  double size = 0, v = 0;
  for (int i = 0; i < k; i++) size += (1 + 0.31 * i) * (1 + 0.31 * i);
  for (int i = 0; i < k; i++) {
    v = 1 + 0.31 * i;
    for (int j = 0; j < k; j++) Q[i * k + j] = (i == j) - 2 * v * (1 + 0.31 * j) / size;
  }
}

/* W[m k k] := Q' W Q, with orthogonal matrices Q that orthogonal iteration makes block triangular: blocks of growth
 * that differ by 1.5 or more are separated, so that the product of blocks keeps the digits of small multipliers.
 * growth[k]: logarithms of their growth over a period, in the mean. */
static int separate(Pool *pool, int m, int k, double *W, double *growth) {
  enum { ROUNDS = 100, COUNTED = 50 };
  size_t size = (size_t)(k * k);
  double *Q = lag_pool_doubles(pool, ((size_t)m + 1) * size), *next = lag_pool_doubles(pool, size);
  if (pool->failed) return LAG_ENOMEM;
  reflect(k, Q);
  for (int round = 0; round < ROUNDS; round++) {
    if (round) memcpy(Q, Q + (size_t)m * size, size * sizeof *Q);
    for (int s = 0; s < m; s++) {
      double *to = Q + (size_t)(s + 1) * size;
      lag_multiply(k, k, k, W + (size_t)s * size, to - size, to);
      if (lag_orthonormalise(k, k, to, growth, round >= ROUNDS - COUNTED, 0) ||
          lag_orthonormalise(k, k, to, growth, 0, 0))
        return LAG_ESINGULAR; /* twice: of a singular W */
    }
  }
  for (int s = 0; s < m; s++)
    transform(k, Q + (size_t)((s + 1) % m) * size, Q + (size_t)s * size, W + (size_t)s * size, next);
  for (int i = 0; i < k; i++) growth[i] /= COUNTED;
  return LAG_OK;
}

/* re + i im := the eigenvalues of the product of the diagonal blocks from row `first` of W[m k k], c wide. */
static int block_eigenvalues(Pool *pool, PeriodicOrbit *o, int k, const double *W, int first, int c) {
  size_t size = (size_t)(c * c);
  double *M = lag_pool_doubles(pool, 6 * size), *D = M + size, *next = D + size, *v = next + size;
  if (pool->failed) return LAG_ENOMEM;
  for (int i = 0; i < c; i++) M[i * c + i] = 1;
  for (int s = 0; s < o->m; s++) {
    for (int i = 0; i < c; i++)
      for (int j = 0; j < c; j++) D[i * c + j] = W[(s * k + first + i) * k + first + j];
    lag_multiply(c, c, c, D, M, next);
    memcpy(M, next, size * sizeof *M);
  }
  return o->algebra->general(c, M, o->re + first, o->im + first, v, v + size, v + 2 * size);
}

/* re + i im := the eigenvalues of the product of W[m k k]. */
static int eigenvalues(Pool *pool, PeriodicOrbit *o, int k, double *W) {
  const double gap = log(1.5);
  double *growth = lag_pool_doubles(pool, (size_t)k + 1), *own = lag_pool_doubles(pool, (size_t)(o->m * k * k) + 1);
  if (pool->failed) return LAG_ENOMEM;
  o->nmultipliers = k;
  memcpy(own, W, (size_t)(o->m * k * k) * sizeof *W);
  int rc = k ? separate(pool, o->m, k, W, growth) : LAG_OK;
  if (rc == LAG_ESINGULAR) return block_eigenvalues(pool, o, k, own, 0, k); /* a slide: multipliers of 0 */
  for (int first = 0, c; first < k && rc == LAG_OK; first += c) {
    for (c = 1; first + c < k && growth[first + c - 1] - growth[first + c] < gap;) c++;
    rc = block_eigenvalues(pool, o, k, W, first, c);
  }
  return rc;
}

/* Sorts multipliers by size, the largest first; of a pair the one with the positive angle. */
static void sort(PeriodicOrbit *o) {
  for (int i = 0; i < o->nmultipliers; i++)
    for (int j = i + 1; j < o->nmultipliers; j++) {
      double d = hypot(o->re[j], o->im[j]) - hypot(o->re[i], o->im[i]);
      if (d < -1e-9 || (d <= 1e-9 && o->im[j] <= o->im[i])) continue;
      lag_swap(&o->re[i], &o->re[j]);
      lag_swap(&o->im[i], &o->im[j]);
    }
}

/* The largest |a b - 1|, where each multiplier a has the other b for which this is least. */
static double pairing(const PeriodicOrbit *o) {
  double worst = o->nmultipliers ? 0 : NAN;
  for (int i = 0; i < o->nmultipliers; i++) {
    double least = HUGE_VAL;
    for (int j = 0; j < o->nmultipliers; j++) {
      double re = o->re[i] * o->re[j] - o->im[i] * o->im[j], im = o->re[i] * o->im[j] + o->im[i] * o->re[j];
      if (i != j) least = fmin(least, hypot(re - 1, im));
    }
    worst = fmax(worst, least);
  }
  return worst < 1e-3 ? worst : NAN;
}

int lag_orbit_multipliers(PeriodicOrbit *o) {
  Pool pool = {0};
  int m = o->m, all = 0, rc = LAG_OK;
  Basis *b = (Basis *)(void *)lag_pool_doubles(&pool, (size_t)(m + 1) * (sizeof(Basis) / sizeof(double) + 1));
  for (int s = 0; s < m && b && rc == LAG_OK; s++)
    rc = quotient(&pool, o, s, &b[s], &all);
  if (!b) rc = LAG_ENOMEM;
  int k = rc ? 0 : b[0].k;
  for (int s = 0; s < m && rc == LAG_OK; s++) rc = b[s].k == k ? LAG_OK : LAG_ESINGULAR;
  double *W = lag_pool_doubles(&pool, (size_t)(m * k * k) + 1);
  if (rc == LAG_OK && pool.failed) rc = LAG_ENOMEM;
  for (int s = 0; s < m && rc == LAG_OK; s++) rc = reduced(&pool, o, s, &b[s], &b[(s + 1) % m], W + s * k * k);
  rc = rc ? rc : eigenvalues(&pool, o, k, W);
  if (rc == LAG_OK) sort(o);
  o->ntrivial = all - o->nmultipliers;
  o->pairing = rc ? NAN : pairing(o);
  lag_pool_free(&pool);
  return rc;
}
