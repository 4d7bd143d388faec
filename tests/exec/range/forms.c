/* Compares the accelerations of a model of forms.txt with its rows, which come on standard input: `U EXPECTED`. */
#include <math.h>
#include <stdio.h>

#include "lag_model.h"

extern const lag_scene range_one;

int main(void) {
  static const unsigned char none[8];
  double p[16], w[64], z[1], u, expected;
  int bad = 0;
  range_one.params(&range_one, p, none);
  while (scanf("%lf %lf", &u, &expected) == 2) {
    double q = u/8, v = 1, a = NAN;
    int status = range_one.model->accel(range_one.model, 0, &q, &v, z, p, NULL, &a, z, w);
    /* exp magnifies the rounding of its argument 1e4; 1 - tanh^2, to 1e-16, comes with factors of 50 */
    double tolerance = 3e-12*fabs(expected) + 2e-14;
    if (status == 0 && fabs(a - expected) <= tolerance) continue;
    printf("at %g a: got %.17g (status %d), expected %.17g\n", u, a, status, expected);
    bad = 1;
  }
  return bad;
}
