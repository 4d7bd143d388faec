/* Lists of neighbours (lag_support.h): whatever moved before, they have all pairs nearer than the cut, ascending. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "lag_support.h"
#include "slow.h"

enum { MOST = 300 };
static double numbers[LAG_NEAR_NUMBERS(MOST)];
static int ints[LAG_NEAR_INTS(MOST)];
static uint64_t state = 1;

static double uniform(double lo, double hi) {
  state = state * 6364136223846793005u + 1442695040888963407u;
  return lo + (hi - lo) * (double)(state >> 11) / 9007199254740992.0;
}

static int is_near(const double *x, const double *y, int parts, double cut, const double *side) {
  double square = 0;
  for (int c = 0; c < parts; c++) {
    double d = x[c] - y[c];
    if (side[c] > 0) d -= side[c] * floor(d / side[c] + 0.5);
    square += d * d;
  }
  return square < cut * cut;
}

/* Whether the list of each member ascends and has those before it that are near; *kept: its length in all. */
static void check_lists(lag_near *w, const double *q, double cut, const double *side, long *kept) {
  for (int k = 0; k < w->n; k++) {
    const int *list;
    int n = lag_near_of(w, k, &list), at = 0;
    for (int j = 0; j < k; j++) {
      int has = at < n && list[at] == j;
      if (!has && is_near(q + w->step * k + 1, q + w->step * j + 1, w->parts, cut, side))
        fail_msg("%d parts: %d is near %d, and not in its list", w->parts, j, k);
      at += has;
    }
    if (at != n) fail_msg("the list of %d does not ascend, or has others than those before it", k);
    *kept += n;
  }
}

static void lists_have_all_that_are_near(void **unused) {
  (void)unused;
  static const double sides[][3] = {{0, 0, 0}, {9, 7, 8}, {0, 6, 0}, {2, 2, 2}};
  for (int round = 0; round < slow(40, 8); round++)
    for (int parts = 1; parts <= 3; parts++) {
      static double q[5 * MOST];
      const double *side = sides[round % 4], cut = uniform(0.5, 2), speed = uniform(0, 0.2);
      lag_near w = {.first = {1, 2, 3}};
      long kept = 0, n = (long)uniform(2, MOST);
      lag_near_open(&w, (int)n, parts, 5, numbers, ints);
      for (int k = 0; k < 5 * n; k++) q[k] = uniform(-10, 10);
      for (int step = 0; step < 6; step++) {
        const double now = cut * (step == 3 ? 1.3 : 1), twice[3] = {2 * side[0], 2 * side[1], 2 * side[2]},
                     *box = step == 4 ? twice : side;
        lag_near_find(&w, q, now, box);
        assert_true(w.known);
        check_lists(&w, q, now, box, &kept);
        for (int k = 0; k < 5 * n; k++) q[k] += uniform(-speed, speed);
      }
    }
}

/* Members that many others are near have no room in the list, and places that are no numbers have no cells. */
static void lists_of_crowds_and_of_nothing(void **unused) {
  (void)unused;
  static double q[5 * MOST];
  const double side[3] = {0, 0, 0};
  lag_near w = {.first = {1, 2, 3}};
  long kept = 0;
  lag_near_open(&w, MOST, 3, 5, numbers, ints);
  for (int k = 0; k < 5 * MOST; k++) q[k] = k % 5 == 1 ? uniform(0, 6) : uniform(-0.1, 0.1);
  lag_near_find(&w, q, 2, side);
  check_lists(&w, q, 2, side, &kept);
  assert_true(w.cells[0] > 1 && w.count[MOST - 1] > LAG_NEAR_WIDTH && kept < (long)MOST * (MOST - 1) / 2);
  q[7] = NAN;
  lag_near_find(&w, q, 1, side);
  kept = 0;
  check_lists(&w, q, 1, side, &kept);
  assert_true(kept == (long)MOST * (MOST - 1) / 2);
}

/* In a large space few of all pairs are kept: the mean number within the reach, 1.12^3*4/3*pi*cut^3 per volume, with
 * 30 % for chance. */
static void lists_are_short(void **unused) {
  (void)unused;
  static double q[5 * MOST];
  const double side[3] = {8, 8, 8};
  lag_near w = {.first = {1, 2, 3}};
  long kept = 0;
  lag_near_open(&w, MOST, 3, 5, numbers, ints);
  for (int k = 0; k < 5 * MOST; k++) q[k] = uniform(0, 8);
  lag_near_find(&w, q, 1.5, side);
  check_lists(&w, q, 1.5, side, &kept);
  assert_true((double)kept < 1.3 * MOST * (MOST - 1) / 2 * 1.405 * 4.18879 * 3.375 / 512);
}

static void floors_are_those_of_the_library(void **unused) {
  (void)unused;
  static const double some[] = {0.0, -0.0, 0.3, -0.3, 1, -1, 4503599627370497.5, -4503599627370495.5, 1e300, -INFINITY};
  for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
    double x = lag_floor(some[k]), y = floor(some[k]);
    assert_memory_equal(&x, &y, sizeof x);
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(lists_have_all_that_are_near), cmocka_unit_test(lists_of_crowds_and_of_nothing),
      cmocka_unit_test(lists_are_short), cmocka_unit_test(floors_are_those_of_the_library)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
