/* Root of a continuous function in a bracket by the ITP method. Enters: a bracket with a change of sign; leaves: its
 * root to the last bits. Holds: the root stays bracketed, and at most one evaluation more than bisection is spent. */
#include <float.h>
#include <math.h>

#include "numeric/root.h"

double lag_root(double (*f)(void *context, double x), void *context, double a, double fa, double b, double fb) {
  double width = fabs(b - a), eps = 2 * DBL_EPSILON * fmax(fabs(a), fabs(b)) + DBL_MIN;
  double k1 = 0.2 / width; /* with exponent 2, the authors' defaults */
  if (fa == 0.0) return a;
  int n_max = (int)ceil(log2(fmax(width / eps, 1))) + 1;
  for (int j = 0; j <= n_max + 60 && fabs(b - a) > eps; j++) {
    double half = a + (b - a) / 2, r = eps * ldexp(1, n_max - j) / 2 - fabs(b - a) / 2;
    double x_f = (fb * a - fa * b) / (fb - fa), sigma = half > x_f ? 1 : -1;
    double delta = k1 * (b - a) * (b - a);
    double x_t = delta <= fabs(half - x_f) ? x_f + sigma * delta : half;
    double x = r > 0 && fabs(x_t - half) <= r ? x_t : half - sigma * fmax(r, 0);
    if (!(x > fmin(a, b) && x < fmax(a, b))) x = half;
    if (x == a || x == b) break;
    double fx = f(context, x);
    if (fx == 0.0) return x;
    if ((fx > 0) == (fb > 0)) {
      b = x;
      fb = fx;
    } else {
      a = x;
      fa = fx;
    }
  }
  return b;
}
