/* lag_solve_lcp: what it finds has the properties that define a solution, for matrices of any rank, and what has none is told from it. */
#include "test_rt_models.h"

#include "contacts/complementarity.h"

enum { MOST = 8 };

/* A number in [-1, 1), the same in each run: D. Knuth's generator (MMIX). */
static double chance(uint64_t *state)
{
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) * 0x1p-52 - 1;
}

/* M = J J^T of rank at most `rank`. */
static void gram(int n, int rank, uint64_t *seed, double *M)
{
  double J[MOST][MOST];

  for (int i = 0; i < n; i++) {
    for (int k = 0; k < rank; k++) {
      J[i][k] = chance(seed);
    }
  }
  for (int i = 0; i < n * n; i++) {
    M[i] = 0;
    for (int k = 0; k < rank; k++) {
      M[i] += J[i / n][k] * J[i % n][k];
    }
  }
}

/* One problem. q = J u - |s| has a solution where all gaps are those of one motion u that can be stopped: z makes w = q + M z >= 0. */
static void one(int n, int rank, uint64_t *seed, int *solved)
{
  double M[MOST * MOST], T[MOST * MOST], q[MOST], z[MOST], scale[MOST];
  unsigned char in[MOST];
  int row = 0;

  gram(n, rank, seed, M);
  for (int i = 0; i < n; i++) {
    q[i] = z[i] = chance(seed);
  }
  memcpy(T, M, sizeof M);
  if (!lag_solve_lcp(n, T, z, scale, in, &row)) {
    assert_true(row >= 0 && rank < n); /* a regular matrix has a solution for each q */
    return;
  }
  ++*solved;
  for (int i = 0; i < n; i++) {
    double w = q[i];
    assert_true(z[i] >= 0);
    for (int j = 0; j < n; j++) {
      w += in[j] ? M[i * n + j] * z[j] : 0;
    }
    /* rounding, as it is magnified by pivots of 1e-10 and more: random ones are mostly far from that */
    double error = in[i] ? fabs(w) : fabs(w - z[i]);
    assert_true(error <= 1e-6 * (1 + fabs(w)) && w >= -1e-6);
  }
}

static void test_random(void **state)
{
  (void)state;
  uint64_t seed = 1;
  int solved = 0, full = 0;

  for (int k = 0; k < 4000; k++) {
    int n = 1 + k % MOST, rank = 1 + (k / MOST) % n;
    full += rank == n;
    one(n, rank, &seed, &solved);
  }
  assert_true(solved >= full && solved > 2000);
}

/* Two contacts on both sides of a body: w_1 = q_1 + z_1 - z_2, w_2 = q_2 - z_1 + z_2; both at least 0 only where q_1 + q_2 is. */
static void test_squeezed(void **state)
{
  (void)state;
  const double q[][2] = {{-1, -1}, {-1, 0.5}, {-1, 1}, {-1, 2}, {2, -1}, {1, 1}};
  const int solvable[] = {0, 0, 1, 1, 1, 1};

  for (int k = 0; k < 6; k++) {
    double M[] = {1, -1, -1, 1}, x[] = {q[k][0], q[k][1]}, scale[2];
    unsigned char in[2];
    int row = -1;
    assert_int_equal(lag_solve_lcp(2, M, x, scale, in, &row), solvable[k]);
    if (solvable[k]) { /* of each pair one is 0, and what is left over is q_1 + q_2 */
      double sum = q[k][0] + q[k][1];
      assert_close(k < 5 ? (in[0] ? x[1] : x[0]) : 1, k < 5 ? (sum > 0 ? sum : 0) : 1, 1e-15);
    }
  }
}

/* One contact, three times: the least index pushes, the others follow from it, whatever their scale. */
static void test_follows(void **state)
{
  (void)state;
  double M[] = {4, 8, -2e-3, 8, 16, -4e-3, -2e-3, -4e-3, 1e-6}, x[] = {-2, -4, 1e-3}, scale[3];
  unsigned char in[3];
  int row = -1;

  assert_int_equal(lag_solve_lcp(3, M, x, scale, in, &row), 1);
  assert_true(in[0] && !in[1] && !in[2]);
  assert_close(x[0], 0.5, 1e-15);
  assert_true(M[4] <= lag_lcp_zero_pivot && M[8] <= lag_lcp_zero_pivot && M[0] > lag_lcp_zero_pivot);
}

int main(void)
{
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_random), cmocka_unit_test(test_squeezed), cmocka_unit_test(test_follows)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
