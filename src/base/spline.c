/* Not-a-knot cubic splines in long double: a tridiagonal system for the second derivatives. */
#include "base/spline.h"

#include <math.h>

typedef long double Real;

/* Length of interval i, and the slope of its chord. */
static Real gap(double (*row)[3], uint32_t i) { return (Real)row[i + 1][0] - row[i][0]; }
static Real chord(double (*row)[3], uint32_t i) { return ((Real)row[i + 1][1] - row[i][1]) / gap(row, i); }

/* Row i of the tridiagonal system for the second derivatives m[1] .. m[n-2]: below, on and above the diagonal, and the right
 * side. From the first and last rows m[0] and m[n-1] are eliminated by the continuity of the third derivative at rows 1 and
 * n - 2. Diagonally dominant: no pivoting is needed. */
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

long double spline_at(const Spline *s, long double x) {
  uint32_t k = 0, end = s->n - 1;
  while (end - k > 1) {
    uint32_t mid = (k + end) / 2;
    if (x < s->row[mid][0]) end = mid;
    else k = mid;
  }
  const double *a = s->row[k], *b = s->row[k + 1];
  Real h = (Real)b[0] - a[0], part = (x - a[0]) / h;
  part = part < 0 ? 0 : part > 1 ? 1 : part;
  Real rest = 1 - part;
  return rest * a[1] + part * b[1] - part * rest * (h * h / 6) * ((1 + rest) * a[2] + (1 + part) * b[2]);
}
