/* Sums of 1/r by a tree (lag_tree.h): the direct sum at opening angle 0, and errors that fall as multipoles do. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "lag_tree.h"
#include "slow.h"

enum { MOST = 600, STEP = 4, PLACES = STEP * MOST };
static double numbers[LAG_TREE_NUMBERS(MOST)];
static int ints[LAG_TREE_INTS(MOST)];
static double q[PLACES], charge[MOST], sum[PLACES + 1], direct[PLACES + 1];
static uint64_t state = 1;

static double uniform(double lo, double hi) {
  state = state * 6364136223846793005u + 1442695040888963407u;
  return lo + (hi - lo) * (double)(state >> 11) / 9007199254740992.0;
}

/* The definition. */
static void sum_directly(int n, int parts, double factor, double soft) {
  for (int k = 0; k <= PLACES; k++) direct[k] = 0;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < i; j++) {
      double r2 = soft;
      for (int c = 0; c < parts; c++) r2 += pow(q[STEP * i + c] - q[STEP * j + c], 2);
      const double u = factor * charge[i] * charge[j] / sqrt(r2);
      direct[PLACES] += u;
      for (int c = 0; c < parts; c++) {
        const double d = -u / r2 * (q[STEP * i + c] - q[STEP * j + c]);
        direct[STEP * i + c] += d, direct[STEP * j + c] -= d;
      }
    }
}

static void sum_by_tree(int n, int parts, double factor, double soft, double theta) {
  const double given[] = {factor, soft, theta};
  lag_tree w = {.parts = parts, .step = STEP, .first = {0, 1, 2}, .energy = PLACES, .slope = {0, 1, 2}, .by = STEP};
  for (int k = 0; k <= PLACES; k++) sum[k] = 0;
  lag_tree_open(&w, n, numbers, ints);
  lag_tree_sum(&w, q, charge, given, sum);
}

/* Root of the mean square of differences of forces, in that of forces. */
static double force_error(int n, int parts) {
  double gap2 = 0, size2 = 0;
  for (int k = 0; k < STEP * n; k++)
    if (k % STEP < parts) gap2 += pow(sum[k] - direct[k], 2), size2 += pow(direct[k], 2);
  return sqrt(gap2 / size2);
}

static void place(int n, double size, int mixed) {
  for (int k = 0; k < STEP * n; k++) q[k] = uniform(-size, size);
  for (int k = 0; k < n; k++) charge[k] = uniform(0.5, 1) * (mixed && k % 2 ? -1 : 1);
}

/* The opening angle 0 is the direct sum, up to the rounding of some hundred terms that cancel in part. */
static void angle_0_is_the_direct_sum(void **unused) {
  (void)unused;
  for (int round = 0; round < slow(60, 12); round++) {
    const int n = 1 + (int)uniform(0, 200), parts = 1 + round % 3;
    const double soft = round % 2 ? 0.01 : 0;
    place(n, 1, round % 4 > 1);
    sum_directly(n, parts, -3, soft);
    sum_by_tree(n, parts, -3, soft, 0);
    assert_true(n == 1 || force_error(n, parts) < 1e-12);
    assert_true(fabs(sum[PLACES] - direct[PLACES]) <= 1e-12 * n * (1 + fabs(direct[PLACES])));
  }
}

/* Errors fall with the angle, and are small beside forces: cells have quadrupoles, so that what is left out is angle^3
 * of one cell, less as cells have errors of any sign. */
static void errors_fall_with_the_angle(void **unused) {
  (void)unused;
  for (int parts = 2; parts <= 3; parts++) {
    double last = 1;
    place(MOST, 1, 0);
    sum_directly(MOST, parts, 1, 1e-4);
    for (double angle = 1; angle > 0.2; angle /= 2) {
      sum_by_tree(MOST, parts, 1, 1e-4, angle);
      const double error = force_error(MOST, parts), of_energy = fabs(sum[PLACES] / direct[PLACES] - 1);
      if (!(error < 0.02 * pow(angle, 2) && error < last / 2 && of_energy < 1e-3 * pow(angle, 2)))
        fail_msg("%d parts, angle %g: error %g after %g, of the energy %g", parts, angle, error, last, of_energy);
      last = error;
    }
  }
}

/* Force and energy of two groups, far apart: an octupole is the first that is left out, so the error of the force falls
 * as distance^-5, beside a force that falls as distance^-2 (or, of groups without charge, dipoles, as distance^-4). */
static double two_groups(int mixed, double soft, double gap, double *of_energy) {
  enum { HALF = 60 };
  double gap2 = 0;
  state = 7;
  place(2 * HALF, 0.5, mixed);
  for (int k = HALF; k < 2 * HALF; k++) q[STEP * k] += gap, q[STEP * k + 1] += gap / 2;
  sum_directly(2 * HALF, 3, 1, soft);
  sum_by_tree(2 * HALF, 3, 1, soft, 0.12); /* opens all cells of its own group */
  for (int k = 0; k < STEP * 2 * HALF; k++)
    if (k % STEP < 3) gap2 += pow(sum[k] - direct[k], 2);
  *of_energy = fabs(sum[PLACES] - direct[PLACES]);
  return sqrt(gap2);
}

static void cells_have_quadrupoles(void **unused) {
  (void)unused;
  for (int mixed = 0; mixed < 2; mixed++)
    for (int k = 0; k < 2; k++) {
      double near_energy, far_energy, soft = k ? 0.3 : 0;
      const double near = two_groups(mixed, soft, 10, &near_energy), far = two_groups(mixed, soft, 20, &far_energy);
      const double of_force = near / far, of_energy = near_energy / far_energy;
      /* 2^5 and 2^4, between the halves of the powers beside; charges of both signs may leave out less */
      if (!(of_force > 22 && of_energy > 11 && (mixed || (of_force < 45 && of_energy < 23))))
        fail_msg("mixed %d, soft %g: errors %g and %g, of energies %g and %g", mixed, soft, near, far, near_energy,
                 far_energy);
    }
}

/* Bodies at one place, in clusters of clusters, with places that are no numbers: the tree ends, and has all pairs. */
static void trees_of_crowds_and_of_nothing(void **unused) {
  (void)unused;
  place(MOST, 1, 0);
  for (int k = 0; k < STEP * MOST; k++) q[k] = 1;
  sum_directly(MOST, 3, 1, 0.25);
  sum_by_tree(MOST, 3, 1, 0.25, 0.5);
  assert_true(fabs(sum[PLACES] / direct[PLACES] - 1) < 1e-12 && fabs(sum[0]) < 1e-9);
  for (int k = 0; k < STEP * MOST; k++) q[k] = k % STEP ? 0 : ldexp(1, -(k / STEP));
  sum_directly(MOST, 3, 1, 1e-3);
  sum_by_tree(MOST, 3, 1, 1e-3, 0.5);
  assert_true(force_error(MOST, 3) < 0.01);
  for (int k = 0; k < STEP * MOST; k++) q[k] = k < STEP ? 1 : uniform(0, 0.01); /* a body outside of the crowd */
  sum_directly(MOST, 3, 1, 0);
  sum_by_tree(MOST, 3, 1, 0, 1);
  assert_true(fabs(sum[0] / direct[0] - 1) < 1e-5);
  q[5] = NAN;
  sum_by_tree(MOST, 3, 1, 1e-3, 0.5);
  assert_true(isnan(sum[PLACES]));
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(angle_0_is_the_direct_sum), cmocka_unit_test(errors_fall_with_the_angle),
      cmocka_unit_test(cells_have_quadrupoles), cmocka_unit_test(trees_of_crowds_and_of_nothing)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
