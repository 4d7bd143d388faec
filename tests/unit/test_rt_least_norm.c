/* lag_singular_values and lag_least_norm: Hilbert's matrix, whose singular values are published; matrices made from
 * their singular values, small ones with their digits; least-norm solutions against their defining properties. */
#include "test_rt_models.h"

#include "numeric/singular_values.h"

enum { N = 6, ROWS = 9 };

static double chance(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) * 0x1p-52 - 1;
}

/* Hilbert's matrix of order 3: mpmath, 20 digits. */
static void test_hilbert(void **state) {
  (void)state;
  static const double known[] = {1.408318927123653957537489, 0.1223270658539058465648011,
                                 0.002687340355773529231042995};
  double A[9], V[9], sigma[3];
  for (int i = 0; i < 9; i++) A[i] = 1.0 / (i / 3 + i % 3 + 1);
  lag_singular_values(3, 3, A, V, sigma);
  for (int k = 0; k < 3; k++) assert_true(fabs(sigma[k] / known[k] - 1) < 1e-14);
}

/* A[rows N] := a product of rotations, columns of the lengths 10^-2k, and rotations: one-sided rotations keep the
 * digits of graded columns. */
static void graded(int rows, double *A) {
  for (int i = 0; i < rows * N; i++) A[i] = 0;
  for (int k = 0; k < N && k < rows; k++) A[k * N + k] = pow(10, -2 * k);
  for (int r = 0; r + 1 < rows; r++) {
    double c = cos(r + 1), s = sin(r + 1);
    for (int k = 0; k < N; k++) {
      double x = A[r * N + k], y = A[(r + 1) * N + k];
      A[r * N + k] = c * x - s * y;
      A[(r + 1) * N + k] = s * x + c * y;
    }
  }
}

static void test_graded(void **state) {
  (void)state;
  double A[ROWS * N], V[N * N], sigma[N], worst = 0;
  graded(ROWS, A);
  lag_singular_values(ROWS, N, A, V, sigma);
  for (int k = 0; k < N; k++) worst = fmax(worst, fabs(sigma[k] * pow(10, 2 * k) - 1));
  assert_true(worst < 1e-13);
  graded(4, A); /* fewer rows than columns */
  lag_singular_values(4, N, A, V, sigma);
  assert_true(fabs(sigma[3] * 1e6 - 1) < 1e-13 && sigma[4] < 1e-20);
}

/* A of rank 3 by a product: A' (A x - b) = 0, and x has no part along the kernel. */
static void test_least_norm(void **state) {
  (void)state;
  uint64_t seed = 1;
  double A[ROWS * N], was[ROWS * N], V[N * N], sigma[N], b[ROWS], x[N], L[ROWS * 3], R[3 * N], off = 0, along = 0;
  for (int i = 0; i < ROWS * 3; i++) L[i] = chance(&seed);
  for (int i = 0; i < 3 * N; i++) R[i] = chance(&seed);
  for (int i = 0; i < ROWS; i++) {
    b[i] = chance(&seed);
    for (int k = 0; k < N; k++) {
      A[i * N + k] = 0;
      for (int l = 0; l < 3; l++) A[i * N + k] += L[i * 3 + l] * R[l * N + k];
      was[i * N + k] = A[i * N + k];
    }
  }
  lag_singular_values(ROWS, N, A, V, sigma);
  int rank = lag_least_norm((lag_decomposed){ROWS, N, A, V, sigma}, 1e-10, 0, b, x);
  assert_true(rank == 3);
  for (int k = 0; k < N; k++) {
    double sum = 0, part = 0;
    for (int i = 0; i < ROWS; i++) {
      double left = -b[i];
      for (int l = 0; l < N; l++) left += was[i * N + l] * x[l];
      sum += was[i * N + k] * left;
    }
    for (int i = 0; i < N; i++) part += V[i * N + k] * x[i];
    off = fmax(off, fabs(sum));
    along = fmax(along, k >= rank ? fabs(part) : 0);
  }
  assert_true(off < 1e-13 && along < 1e-14);
  double length = 0, damped = 0;
  for (int i = 0; i < N; i++) length += x[i] * x[i];
  lag_least_norm((lag_decomposed){ROWS, N, A, V, sigma}, 1e-10, 1, b, x);
  for (int i = 0; i < N; i++) damped += x[i] * x[i];
  assert_true(damped < length);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_hilbert), cmocka_unit_test(test_graded),
                                     cmocka_unit_test(test_least_norm)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
