/* Sparse systems and the span of sparse rows. Expected: systems are made from their solutions, ranks and kernels. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <math.h>
#include <string.h>

#include <cmocka.h>

#include "base/row_span.h"
#include "base/sparse_solve.h"

enum { MOST = 120 };

static uint64_t seed = 1;
static long double uniform(void) { /* in (-1, 1); Knuth's MMIX generator */
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (long double)(int64_t)(seed >> 11) / 4503599627370496.0L - 1;
}

/* A chain: element (i, j) for |i - j| <= 1, and some far ones; a column is 2^`turn`, a row 2^-`turn`, apart in
 * scale. */
static void random_matrix(Arena *a, uint32_t n, int turn, SparseElements *m, long double *dense) {
  memset(dense, 0, (size_t)n * n * sizeof *dense);
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t j = 0; j < n; j++) {
      int near = i < j ? j - i <= 1 : i - j <= 1;
      if (!near && !(uniform() > 0.97L)) continue;
      long double value = ldexpl(uniform() + (i == j ? 3 : 0), turn * ((int)(j % 7) - (int)(i % 5)));
      sparse_put(a, m, i, j, value / 2); /* elements at one place add up */
      sparse_put(a, m, i, j, value / 2);
      dense[i * n + j] = value;
    }
}

static void a_solution_comes_back(void **state) {
  (void)state;
  for (uint32_t n = 1; n <= MOST; n += 17)
    for (int turn = 0; turn < 9; turn += 4) {
      Arena *a = arena_new(NULL);
      static long double dense[MOST * MOST], x[MOST], b[MOST];
      SparseElements m = {0};
      random_matrix(a, n, turn, &m, dense);
      for (uint32_t i = 0; i < n; i++) x[i] = ldexpl(uniform(), -turn * (int)(i % 7)), b[i] = 0;
      for (uint32_t i = 0; i < n; i++)
        for (uint32_t j = 0; j < n; j++) b[i] += dense[i * n + j] * x[j];
      assert_int_equal(sparse_solve(a, n, &m, b, 1e-15L, NULL), n);
      for (uint32_t i = 0; i < n; i++) /* conditions are below 1e3 once scaled; 1e-19 is the rounding */
        assert_true(fabsl(ldexpl(b[i] - x[i], turn * (int)(i % 7))) < 1e-14L);
      arena_free(a);
    }
}

/* Members of mass 1 whose sum one constraint holds: x_i = f_i - mean f. The constraint's row grows to n as members are
 * eliminated; taken as a pivot it would fill the rest, 32 bytes for each of n^2/2 elements, 64 MB. */
static void a_row_over_all_members_fills_nothing(void **state) {
  (void)state;
  enum { N = 2000 };
  const ArenaConfig config = {.max_bytes = 4 << 20};
  Arena *a = arena_new(&config);
  SparseElements m = {0};
  static long double b[N + 1], f[N];
  long double mean = 0;
  for (uint32_t i = 0; i < N; i++) b[i] = f[i] = uniform(), mean += f[i] / N;
  for (uint32_t i = 0; i < N; i++)
    sparse_put(a, &m, i, i, 1), sparse_put(a, &m, i, N, -1), sparse_put(a, &m, N, i, 1);
  jmp_buf full;
  assert_int_equal(setjmp(full), 0);
  arena_guard(a, &full);
  assert_int_equal(sparse_solve(a, N + 1, &m, b, 1e-13L, NULL), N + 1);
  for (uint32_t i = 0; i < N; i++) assert_true(fabsl(b[i] - (f[i] - mean)) < 1e-15L); /* sums of 2000 numbers below 1 */
  arena_free(a);
}

/* The same with factors a_i of three sizes: i/N, its cube, and 1 to e^5 in no order, whose row has the largest elements
 * while members are left. With unit masses x = f - a (a.f)/(a.a). As pivot the row would fill 80 MB. */
static void a_row_of_many_sizes_fills_nothing(void **state) {
  (void)state;
  enum { N = 2000 };
  const ArenaConfig config = {.max_bytes = 4 << 20};
  for (int kind = 0; kind < 3; kind++) {
    Arena *a = arena_new(&config);
    SparseElements m = {0};
    static long double b[N + 1], f[N], w[N];
    long double along = 0, square = 0;
    for (uint32_t i = 0; i < N; i++) {
      w[i] = kind == 2 ? expl(-5.0L * (i * 7919 % N) / N) : powl((i + 1.0L) / N, 1 + 2 * kind);
      b[i] = f[i] = uniform(), along += w[i] * f[i], square += w[i] * w[i];
    }
    b[N] = 0;
    for (uint32_t i = 0; i < N; i++)
      sparse_put(a, &m, i, i, 1), sparse_put(a, &m, i, N, -w[i]), sparse_put(a, &m, N, i, w[i]);
    jmp_buf full;
    assert_int_equal(setjmp(full), 0);
    arena_guard(a, &full);
    assert_int_equal(sparse_solve(a, N + 1, &m, b, 1e-13L, NULL), N + 1);
    for (uint32_t i = 0; i < N; i++) /* pivots cost up to 12 of 64 bits: 2^-52 = 2e-16 */
      assert_true(fabsl(b[i] - (f[i] - w[i] * along / square)) < 1e-15L);
    arena_free(a);
  }
}

static void rank_and_kernel(void **state) {
  (void)state;
  for (uint32_t n = 4; n <= MOST; n += 13) {
    Arena *a = arena_new(NULL);
    static long double dense[MOST * MOST], null[MOST], b[MOST];
    SparseElements m = {0};
    random_matrix(a, n - 1, 0, &m, dense); /* the last row is a sum of two, the last column twice another */
    for (uint32_t k = 0, of = m.n; k < of; k++) {
      SparseElement e = m.at[k];
      if (e.row < 2) sparse_put(a, &m, n - 1, e.col, e.value), e.row = n - 1;
      if (m.at[k].col == 2) sparse_put(a, &m, m.at[k].row, n - 1, 2 * e.value);
      if (m.at[k].row < 2 && m.at[k].col == 2) sparse_put(a, &m, n - 1, n - 1, 2 * e.value);
    }
    assert_int_equal(sparse_solve(a, n, &m, NULL, 1e-13L, null), n - 1);
    long double most = 0;
    memset(b, 0, sizeof b);
    for (uint32_t k = 0; k < m.n; k++) b[m.at[k].row] += m.at[k].value * null[m.at[k].col];
    for (uint32_t i = 0; i < n; i++) most = fmaxl(most, fabsl(null[i]));
    assert_true(most > 0);
    for (uint32_t i = 0; i < n; i++) assert_true(fabsl(b[i]) < 1e-13L * most);
    assert_true(fabsl(null[2] / null[n - 1] + 2) < 1e-12L); /* the kernel is (.. 2 at column 2, -1 at the last) */
    arena_free(a);
  }
}

static void elements_cancel(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  SparseElements m = {0};
  long double b[2] = {3, 4}, null[2];
  sparse_put(a, &m, 0, 0, 1), sparse_put(a, &m, 0, 0, -1), sparse_put(a, &m, 0, 1, 2), sparse_put(a, &m, 1, 0, 4);
  assert_int_equal(sparse_solve(a, 2, &m, b, 1e-15L, NULL), 2);
  assert_true(b[0] == 1 && b[1] == 1.5L);
  SparseElements empty = {0};
  assert_int_equal(sparse_solve(a, 2, &empty, NULL, 1e-15L, null), 0);
  arena_free(a);
}

/* x'^2 and no y'^2: regular where the constraint is on y, not where it is on x. */
static void regular_on_a_kernel(void **state) {
  (void)state;
  for (uint32_t on = 0; on < 2; on++) {
    Arena *a = arena_new(NULL);
    SparseElements m = {0};
    long double null[2];
    sparse_put(a, &m, 0, 0, 1), sparse_put(a, &m, on, 2, -1e9L), sparse_put(a, &m, 2, on, 1e9L),
        sparse_put(a, &m, 1, 1, NAN);
    assert_int_equal(sparse_is_regular_on_kernel(a, 2, 1, &m, null), on == 1);
    if (on == 0) assert_true(null[0] == 0 && null[1] != 0);
    arena_free(a);
  }
}

static void rows_of_a_span(void **state) {
  (void)state;
  enum { ROWS = 60 };
  Arena *a = arena_new(NULL);
  RowSpan s = row_span(a, ROWS + 1);
  for (uint32_t i = 0; i < ROWS; i++) { /* the rods of a chain: each hangs on the one before */
    RowElement rod[2] = {{i, uniform()}, {i + 1, 1 + uniform()}};
    assert_true(row_span_add(&s, rod, 2, 1e-9L) > 1e-3L);
    RowElement again[2] = {{i, -3 * rod[0].value}, {i + 1, -3 * rod[1].value}};
    assert_true(row_span_add(&s, again, 2, 1e-9L) < 1e-15L);
  }
  assert_int_equal(s.rank, ROWS);
  /* of the last direction the part across the others is what is left: e_ROWS less its projection, which a dense
   * Gram-Schmidt process gives, too */
  RowElement last = {ROWS, 1};
  long double left = row_span_add(&s, &last, 1, 2), square = 0, dot[ROWS];
  for (uint32_t j = 0; j <= ROWS; j++) square += s.left[j] * s.left[j];
  assert_true(left > 0 && left <= 1 && fabsl(square - 1) < 1e-15L);
  for (uint32_t k = 0; k < ROWS; k++) {
    dot[k] = 0;
    for (uint32_t j = 0; j < s.rows[k].n; j++) dot[k] += s.rows[k].at[j].value * s.left[s.rows[k].at[j].col];
    assert_true(fabsl(dot[k]) < 1e-15L);
  }
  assert_true(fabsl(s.left[ROWS] - left) < 1e-15L); /* left = |P e| = (P e).e / |P e| */
  RowElement none = {0, 0};
  assert_true(row_span_add(&s, &none, 1, 1e-9L) == 0);
  arena_free(a);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(a_solution_comes_back),
      cmocka_unit_test(a_row_over_all_members_fills_nothing),
      cmocka_unit_test(a_row_of_many_sizes_fills_nothing), cmocka_unit_test(rank_and_kernel),
      cmocka_unit_test(elements_cancel),
      cmocka_unit_test(regular_on_a_kernel),   cmocka_unit_test(rows_of_a_span),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
