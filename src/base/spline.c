/* Not-a-knot splines in long double: a tridiagonal system for the second derivatives of the cubic; a banded one for
 * slopes and second derivatives of the quintic. */
#include "base/spline.h"

#include <math.h>

typedef long double Real;

/* Length of interval i, and the slope of its chord. */
static Real gap(double (*row)[3], uint32_t i) { return (Real)row[i + 1][0] - row[i][0]; }
static Real chord(double (*row)[3], uint32_t i) { return ((Real)row[i + 1][1] - row[i][1]) / gap(row, i); }

/* Row i of the tridiagonal system for the second derivatives m[1] .. m[n-2]: below, on and above the diagonal, and
 * the right side. From the first and last rows m[0] and m[n-1] are eliminated by the continuity of the third
 * derivative at rows 1 and n - 2. Diagonally dominant: no pivoting is needed. */
static void equation(double (*row)[3], uint32_t n, uint32_t i, Real e[4]) {
  Real h = gap(row, i - 1), k = gap(row, i);
  e[0] = h;
  e[1] = 2 * (h + k);
  e[2] = k;
  e[3] = 6 * (chord(row, i) - chord(row, i - 1));
  if (i == 1) {
    e[0] = 0;
    e[1] = (h + k) * (h + 2 * k) / k;
    e[2] = (k - h) * (k + h) / k;
  }
  if (i == n - 2) {
    e[0] = (h - k) * (h + k) / h;
    e[1] = (h + k) * (k + 2 * h) / h;
    e[2] = 0;
  }
}

/* Thomas's algorithm for m[1] .. m[n-2], then m[0] and m[n-1]. */
static void solve(Arena *a, double (*row)[3], uint32_t n, Real *m) {
  Real *above = ARENA_ARRAY(a, Real, n), e[4];
  for (uint32_t i = 1; i < n - 1; i++) {
    equation(row, n, i, e);
    Real pivot = e[1] - e[0] * above[i - 1];
    above[i] = e[2] / pivot;
    m[i] = (e[3] - e[0] * m[i - 1]) / pivot;
  }
  for (uint32_t i = n - 2; i > 1; i--) m[i - 1] -= above[i - 1] * m[i];
  Real h = gap(row, 0), k = gap(row, 1), last = gap(row, n - 2), before = gap(row, n - 3);
  m[0] = m[1] + (m[1] - m[2]) * h / k;
  m[n - 1] = m[n - 2] + (m[n - 2] - m[n - 3]) * last / before;
}

int spline_fit(Arena *a, double (*row)[3], uint32_t n) {
  Real *m = ARENA_ARRAY(a, Real, n);
  if (n == 3) m[0] = m[1] = m[2] = 2 * (chord(row, 1) - chord(row, 0)) / (gap(row, 0) + gap(row, 1));
  if (n > 3) solve(a, row, n, m);
  for (uint32_t i = 0; i < n; i++) {
    row[i][2] = (double)m[i];
    if (!isfinite(row[i][2])) return 0;
  }
  return 1;
}

/* ---- The quintic */

/* A quintic on an interval h in x = 0 .. 1 is u0 + x h u0' + x^2 h^2 u0''/2 + c3 x^3 + c4 x^4 + c5 x^5. The last
 * three by u0, h u0', h^2 u0'', and the same at the end. */
static const Real high[3][6] = {
    {-10, -6, -1.5L, 10, -4, 0.5L}, {15, 8, 1.5L, -15, 7, -1}, {-6, -3, -0.5L, 6, -3, 0.5L}};

/* Derivative k = 3, 4, 5 of the quintic at the start and the end of its interval, over c3, c4, c5, times h^k. */
static const Real derivative[3][2][3] = {
    {{6, 0, 0}, {6, 24, 60}}, {{0, 24, 0}, {0, 24, 120}}, {{0, 0, 120}, {0, 0, 120}}};

/* The unknowns are the slopes and second derivatives of the rows, times the first and the squared mean interval; an
 * equation has those of three rows. */
enum { SPAN = 6, BELOW = 5, WIDE = SPAN + 2 * BELOW };

/* Equation: derivative k is continuous at row i. e[0 .. 5] := coefficients of the unknowns of rows i - 1, i, i + 1;
 * returns the right side. */
static Real continuity(const double (*jet)[4], uint32_t i, int k, Real mean, Real *e) {
  Real right = 0;
  for (int j = 0; j < SPAN; j++) e[j] = 0;
  for (int side = 0; side < 2; side++) {
    uint32_t from = i - 1 + (uint32_t)side;
    Real h = ((Real)jet[from + 1][0] - jet[from][0]) / mean, per = (side ? -1 : 1) / powl(h, k), c[SPAN] = {0};
    for (int j = 0; j < SPAN; j++)
      for (int d = 0; d < 3; d++) c[j] += derivative[k - 3][1 - side][d] * high[d][j];
    for (int end = 0; end < 2; end++) {
      right -= per * c[3 * end] * jet[from + (uint32_t)end][1];
      e[2 * (side + end)] += per * h * c[3 * end + 1];
      e[2 * (side + end) + 1] += per * h * h * c[3 * end + 2];
    }
  }
  return right;
}

/* A banded system: row r of a[] holds the columns r - BELOW and following; b its right side. */
typedef struct Band {
  uint32_t n;
  Real *a, *b;
} Band;

static Real *at(const Band *m, uint32_t row, uint32_t column) {
  return &m->a[(size_t)row * WIDE + column + BELOW - row];
}

static void exchange(const Band *m, uint32_t i, uint32_t j, uint32_t from, uint32_t to) {
  for (uint32_t c = from; c < to; c++) {
    Real x = *at(m, i, c);
    *at(m, i, c) = *at(m, j, c), *at(m, j, c) = x;
  }
  Real x = m->b[i];
  m->b[i] = m->b[j], m->b[j] = x;
}

/* Gaussian elimination with partial pivoting; b := the solution. */
static void solve_band(const Band *m) {
  for (uint32_t k = 0; k < m->n; k++) {
    uint32_t last = k + BELOW < m->n - 1 ? k + BELOW : m->n - 1, to = k + SPAN + BELOW < m->n ? k + SPAN + BELOW : m->n,
             best = k;
    for (uint32_t i = k + 1; i <= last; i++) best = fabsl(*at(m, i, k)) > fabsl(*at(m, best, k)) ? i : best;
    if (best != k) exchange(m, k, best, k, to);
    for (uint32_t i = k + 1; i <= last; i++) {
      Real factor = *at(m, i, k) / *at(m, k, k);
      for (uint32_t c = k; c < to; c++) *at(m, i, c) -= factor * *at(m, k, c);
      m->b[i] -= factor * m->b[k];
    }
  }
  for (uint32_t k = m->n; k-- > 0;) {
    uint32_t to = k + SPAN + BELOW < m->n ? k + SPAN + BELOW : m->n;
    for (uint32_t c = k + 1; c < to; c++) m->b[k] -= *at(m, k, c) * m->b[c];
    m->b[k] /= *at(m, k, k);
  }
}

int spline_fit_quintic(Arena *a, double (*jet)[4], uint32_t n) {
  Band m = {2 * n, ARENA_ARRAY(a, Real, 2 * (size_t)n * WIDE), ARENA_ARRAY(a, Real, 2 * n)};
  Real mean = ((Real)jet[n - 1][0] - jet[0][0]) / (n - 1), e[SPAN];
  uint32_t row = 0;
  for (uint32_t i = 1; i + 1 < n; i++)
    for (int k = 3; k <= 5; k++) {
      int is_end = i <= 2 || i + 3 >= n; /* not a knot */
      if (k == 5 && !is_end) continue;
      m.b[row] = continuity((const double(*)[4])jet, i, k, mean, e);
      for (uint32_t j = 0; j < SPAN; j++) *at(&m, row, 2 * (i - 1) + j) = e[j];
      row++;
    }
  solve_band(&m);
  for (uint32_t i = 0; i < n; i++)
    for (int k = 0; k < 2; k++) {
      jet[i][2 + k] = (double)(m.b[2 * i + (uint32_t)k] / (k ? mean * mean : mean));
      if (!isfinite(jet[i][2 + k])) return 0;
    }
  return 1;
}

/* ---- Values */

static double place(const Spline *s, uint32_t i) { return s->jet ? s->jet[i][0] : s->row[i][0]; }

static Real cubic_at(const double *a, const double *b, Real h, Real part) {
  Real rest = 1 - part;
  return rest * a[1] + part * b[1] - part * rest * (h * h / 6) * ((1 + rest) * a[2] + (1 + part) * b[2]);
}

static Real quintic_at(const double *a, const double *b, int order, Real h, Real x) {
  Real m = h * a[2], s = h * h * a[3], A = b[1] - a[1] - m - s / 2, B = h * b[2] - m - s, C = h * h * b[3] - s;
  Real c3 = 10 * A - 4 * B + C / 2, c4 = 7 * B - 15 * A - C, c5 = 6 * A - 3 * B + C / 2;
  if (order == 0) return a[1] + x * (m + x * (s / 2 + x * (c3 + x * (c4 + x * c5))));
  if (order == 1) return (m + x * (s + x * (3 * c3 + x * (4 * c4 + x * 5 * c5)))) / h;
  return (s + x * (6 * c3 + x * (12 * c4 + x * 20 * c5))) / (h * h);
}

long double spline_at(const Spline *s, int order, long double x) {
  uint32_t k = 0, end = s->n - 1;
  while (end - k > 1) {
    uint32_t mid = (k + end) / 2;
    if (x < place(s, mid)) end = mid;
    else k = mid;
  }
  Real h = (Real)place(s, k + 1) - place(s, k), part = (x - place(s, k)) / h;
  int outside = part < 0 || part > 1;
  part = part < 0 ? 0 : part > 1 ? 1 : part;
  if (!s->jet) return cubic_at(s->row[k], s->row[k + 1], h, part);
  return order && outside ? 0 : quintic_at(s->jet[k], s->jet[k + 1], order, h, part);
}
