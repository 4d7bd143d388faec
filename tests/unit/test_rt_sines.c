/* liblag's sines, which simulators link, have the bits of those that emitted C compiles in: at random angles, near
 * multiples of pi/64, where they are large, and where there is none. */
#include "test_rt_models.h"

#include <string.h>

void lag_sincos(double x, double *s, double *c);
double lag_sin(double x);
double lag_cos(double x);
void lag_sincos2(double a, double *sin_a, double *cos_a, double b, double *sin_b, double *cos_b);

/* The inline ones by other names. */
#define LAG_NO_FMA 1
#define lag_sincos inline_sincos
#define lag_sin inline_sin
#define lag_cos inline_cos
#define lag_sincos2 inline_sincos2
#include "lag_math.h"
#undef lag_sincos
#undef lag_sin
#undef lag_cos
#undef lag_sincos2

static int same(double a, double b) { return memcmp(&a, &b, sizeof a) == 0 || (isnan(a) && isnan(b)); }

static void compare(double x, double y) {
  double linked[4], own[4];
  lag_sincos2(x, &linked[0], &linked[1], y, &linked[2], &linked[3]);
  inline_sincos(x, &own[0], &own[1]);
  inline_sincos(y, &own[2], &own[3]);
  for (int i = 0; i < 4; i++) assert_true(same(linked[i], own[i]));
  lag_sincos(x, &linked[0], &linked[1]);
  assert_true(same(linked[0], own[0]) && same(linked[1], own[1]));
  assert_true(same(lag_sin(y), own[2]) && same(lag_cos(y), own[3]));
}

static void linked_sines_are_inline_ones(void **state) {
  (void)state;
  uint64_t r = 1;
  for (int i = 0; i < 20000; i++) {
    r = r * 6364136223846793005u + 1442695040888963407u;
    double u = (double)(r >> 11) * 0x1p-53 - 0.5;
    compare(8 * u, ldexp(u, i % 2000 - 1000));
    compare(i * 0.049087385212340517, nextafter(i * 0.049087385212340517, u < 0 ? -1e9 : 1e9));
  }
  compare(INFINITY, NAN);
  compare(-0.0, 0x1p1023);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(linked_sines_are_inline_ones)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
