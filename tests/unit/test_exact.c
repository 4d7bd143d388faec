/* rational_solve: inverses of Hilbert's matrices, whose entries are products of binomials (D. E. Knuth, The Art of Computer Programming 1,
 * 1.2.3, exercise 45), and systems made from their solutions. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "base/rational_solve.h"

static int64_t binomial(int64_t n, int64_t k) {
  int64_t c = 1;
  for (int64_t i = 1; i <= k; i++) c = c * (n - k + i) / i;
  return c;
}

static int64_t hilbert_inverse(int64_t n, int64_t i, int64_t j) {
  int64_t middle = binomial(i + j - 2, i - 1), sign = (i + j) % 2 ? -1 : 1;
  return sign * (i + j - 1) * binomial(n + i - 1, n - j) * binomial(n + j - 1, n - i) * middle * middle;
}

static void test_hilbert(void **state) {
  (void)state;
  enum { MOST = 12 };
  for (uint32_t n = 1; n <= MOST; n++) {
    Arena *arena = arena_new(NULL);
    Num A[MOST * MOST], B[MOST * MOST], X[MOST * MOST];
    for (uint32_t i = 0; i < n; i++)
      for (uint32_t j = 0; j < n; j++) A[i * n + j] = num_ratio(1, (int64_t)(i + j + 1)), B[i * n + j] = num_int(i == j);
    assert_true(rational_solve(arena, n, A, n, B, X));
    for (uint32_t i = 0; i < n; i++)
      for (uint32_t j = 0; j < n; j++) assert_true(num_equal(X[i * n + j], num_int(hilbert_inverse(n, i + 1, j + 1))));
    arena_free(arena);
  }
}

/* SplitMix64; fractions up to 99/99. */
static Num fraction(uint64_t *random) {
  uint64_t z = *random += 0x9e3779b97f4a7c15u;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  return num_ratio((int64_t)(z % 199) - 99, (int64_t)(z / 199 % 99) + 1);
}

/* A (a, b) where a and b are long: sums of two products stay exact. */
static void test_long(void **state) {
  (void)state;
  uint64_t random = 3;
  for (int turn = 0; turn < 2000; turn++) {
    Arena *arena = arena_new(NULL);
    const Num a = num_ratio(123456789012, 1000000007), b = num_ratio(-998244353, 299792458);
    Num A[4], B[2], X[2] = {0};
    for (int k = 0; k < 4; k++) A[k] = fraction(&random);
    for (int k = 0; k < 2; k++) B[k] = num_add(num_mul(A[2 * k], a), num_mul(A[2 * k + 1], b));
    Num determinant = num_sub(num_mul(A[0], A[3]), num_mul(A[1], A[2]));
    int exact = num_is_exact(B[0]) && num_is_exact(B[1]);
    int solved = rational_solve(arena, 2, A, 1, B, X);
    assert_int_equal(solved, exact && !num_is_zero(determinant));
    if (solved) assert_true(num_equal(X[0], a) && num_equal(X[1], b));
    arena_free(arena);
  }
}

/* 2^-40 x = 2^40 / 3: the value and the residue of 2^80 / 3. */
static void test_overflow(void **state) {
  (void)state;
  Arena *arena = arena_new(NULL);
  Num large = num_int(1ll << 40), A = num_ratio(1, 1ll << 40), B = num_div(large, num_int(3)), X;
  assert_true(rational_solve(arena, 1, &A, 1, &B, &X));
  assert_false(num_is_exact(X));
  Num square = num_mul(large, large), three = num_int(3);
  assert_true(num_is_zero(num_sub(num_mul(X, three), square)));
  arena_free(arena);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_hilbert), cmocka_unit_test(test_long), cmocka_unit_test(test_overflow)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
