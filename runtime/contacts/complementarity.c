/* Linear complementarity by the criss-cross method (complementarity.h). Invariant: basic = q + T nonbasic; basic variable i is z_i if in[i], else
 * w_i; pivots are principal or in pairs, so that each pair (w_i, z_i) keeps its row. */
#include "contacts/complementarity.h"

#include <math.h>

#include "numeric/dense.h"

/* Relative sizes that count as rounding: of a pivot (its row then depends on others), and of a right-hand side. */
const double lag_lcp_zero_pivot = 1e-10;
static const double no_value = 1e-13;

/* Exchanges basic variable r with nonbasic variable s. */
static void pivot(int n, double *T, double *q, int r, int s) {
  double at = T[r * n + s];
  for (int j = 0; j < n; j++) { /* x_s = (basic_r - q_r - others)/at */
    T[r * n + j] = j == s ? 1 / at : -T[r * n + j] / at;
  }
  q[r] = -q[r] / at;
  for (int i = 0; i < n; i++) {
    double factor = T[i * n + s];
    for (int j = 0; j < n && i != r; j++) T[i * n + j] = j == s ? factor * T[r * n + s] : T[i * n + j] + factor * T[r * n + j];
    q[i] += i == r ? 0 : factor * q[r];
  }
}

/* Swaps rows and columns r and s: two pivots have exchanged the pairs r and s, this puts them back. */
static void exchange(int n, double *T, double *q, int r, int s) {
  lag_swap(&q[r], &q[s]);
  lag_swap_rows((size_t)n, T, (size_t)r, (size_t)s);
  lag_swap_columns((size_t)n, (size_t)n, T, (size_t)r, (size_t)s);
}

/* Scales M to a diagonal of ones, and q with it. */
static void scale_to_unit_diagonal(int n, double *M, double *q, double *scale) {
  for (int i = 0; i < n; i++) scale[i] = M[i * n + i] > 0 ? 1 / sqrt(M[i * n + i]) : 1;
  for (int i = 0; i < n; i++) {
    q[i] *= scale[i];
    for (int j = 0; j < n; j++) M[i * n + j] *= scale[i] * scale[j];
  }
}

int lag_solve_lcp(int n, double *M, double *q, double *scale, unsigned char *in, int *row) {
  double most = 0;
  scale_to_unit_diagonal(n, M, q, scale);
  for (int i = 0; i < n; i++) {
    in[i] = 0;
    most = fmax(most, fabs(q[i]));
  }
  for (int turn = 0; turn < 1000 + 100 * n; turn++) {
    int r = 0, s = 0;
    while (r < n && !(q[r] < -no_value * most)) r++;
    if (r == n) {
      for (int i = 0; i < n; i++) q[i] = fmax(q[i], 0) * (in[i] ? scale[i] : 1 / scale[i]);
      return 1;
    }
    if (M[r * n + r] > lag_lcp_zero_pivot) {
      pivot(n, M, q, r, r);
      in[r] ^= 1;
      continue;
    }
    while (s < n && !(M[r * n + s] > lag_lcp_zero_pivot)) s++;
    *row = r;
    if (s == n) return 0;
    pivot(n, M, q, r, s);
    pivot(n, M, q, s, r);
    exchange(n, M, q, r, s);
    in[r] ^= 1;
    in[s] ^= 1;
  }
  *row = -1;
  return 0;
}
