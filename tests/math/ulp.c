/* lag_math.h against libquadmath: for each function the largest error in units in the last place, the argument it is
 * at, and a checksum of all results, which is that of a double's in vectors of lanes too.
 *
 *   ulp POINTS `function points error argument checksum`; exit status 1 where an error is more than 1, or a special
 *   value wrong */
#include <float.h>
#include <math.h>
#include <quadmath.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "own.h"

#ifdef LAG_LANES
enum { LANES = LAG_LANES };
static void put(LAG_REAL *v, int lane, double x) { (*v)[lane] = x; }
static double get(const LAG_REAL *v, int lane) { return (*v)[lane]; }
#else
enum { LANES = 1 };
static void put(LAG_REAL *v, int lane, double x) { (void)lane, *v = x; }
static double get(const LAG_REAL *v, int lane) { return (void)lane, *v; }
#endif

/* --- arguments --- */

static uint64_t seed = 3;
static uint64_t bits(void) {
  seed = seed*6364136223846793005u + 1442695040888963407u;
  uint64_t x = seed;
  x ^= x >> 33;
  x *= 0xff51afd7ed558ccdu;
  return x ^ x >> 33;
}
static double unit(void) { return (double)(bits() >> 11)/9007199254740992.0; }
static double between(double a, double b) { return a + (b - a)*unit(); }

/* Any finite number, each binade as likely as any other; its sign is random too. */
static double any(void) {
  const uint64_t u = bits(), e = (u >> 52)%2047;
  union { uint64_t u; double x; } v;
  v.u = (u & 0x800fffffffffffffu) | e << 52;
  return v.x;
}

/* The double nearest to a multiple of pi/2, or one beside it. */
static double near_multiple(void) {
  const double k = floor(exp2(between(0, 40))*(bits() & 1 ? 1 : -1));
  const double x = (double)(k*M_PI_2q);
  switch (bits()%3) {
    case 0: return x;
    case 1: return nextafter(x, HUGE_VAL);
    default: return nextafter(x, -HUGE_VAL);
  }
}

/* Doubles that come very near to a multiple of pi/2: Muller, Elementary Functions, 3rd ed., table 11.1, and Payne
 * and Hanek's worst case of all doubles (W. Kahan); small ones, and those around the ends of what the short
 * reduction takes. */
static const double angles[] = {5.3193726483265414e+255 /* 6381956970095103 2^797 */,
                                1.5707963267948966, 3.1415926535897931, 4.71238898038469, 6.2831853071795862,
                                7.8539816339744828, 22, 355, 103993, 104348, 833719 / 2.0, 2e5, 200000.00000000003,
                                199999.99999999997, 1e22, 1e300, 1.7976931348623157e308, 2.2250738585072014e-308,
                                5e-324, 1e-300, 0.78539816339744828, 0.78539816339744839, 2.3561944901923448,
                                3.9269908169872414, 1e-8, 710, 25735.829, 25735.878, 25735.927, 25735.976,
                                25736.025};

static double angle(long i, long n) {
  const long hard = (long)(sizeof angles/sizeof *angles);
  if (i < 2*hard) return i & 1 ? -angles[i/2] : angles[i/2];
  switch (i*4/n) {
    case 0: return between(-8, 8);
    case 1: return between(-3e5, 3e5);
    case 2: return near_multiple();
    default: return any();
  }
}

static double exponent(long i, long n) {
  static const double hard[] = {0,
                                709.782712893384, 709.78271289338397, -708.3964185322641, -745.13321910194111,
                                -745.13321910194122, -744.4400719213812, 0.34657359027997264, -0.34657359027997264,
                                1e-300, -1e-300,
                                1};
  if (i < (long)(sizeof hard/sizeof *hard)) return hard[i];
  switch (i*3/n) {
    case 0: return between(-1, 1);
    case 1: return between(-708, 709.7);
    default: return (i & 1) ? between(-745, -708) : ldexp(unit() - 0.5, -(int)(bits()%60));
  }
}

static double positive(long i, long n) {
  static const double hard[] = {1,
                                0.99999999999999989, 1.0000000000000002, 0.70710678118654746, 0.70710678118654757,
                                1.4142135623730951, 1.4142135623730949, 5e-324, 2.2250738585072014e-308,
                                2.2250738585072009e-308, 1.7976931348623157e308, 2,
                                0.5};
  if (i < (long)(sizeof hard/sizeof *hard)) return hard[i];
  switch (i*3/n) {
    case 0: return between(0.5, 2);
    case 1: return 1 + ldexp(unit() - 0.5, -(int)(bits()%50));
    default: return fabs(any());
  }
}

/* --- functions --- */

static __float128 rsqrtq(__float128 x) { return 1/sqrtq(x); }

typedef struct {
  const char *name;
  void (*own)(const LAG_REAL *, LAG_REAL *);
  __float128 (*right)(__float128);
  double (*argument)(long, long);
} Function;
static const Function functions[] = {
  {"sin", own_sin, sinq, angle}, {"cos", own_cos, cosq, angle}, {"exp", own_exp, expq, exponent},
  {"log", own_log, logq, positive}, {"rsqrt", own_rsqrt, rsqrtq, positive}};

/* |got - right| in units in the last place of a double there. */
static double error_of(double got, __float128 right) {
  if (right == 0) return got == 0 ? 0 : HUGE_VAL;
  int e;
  frexpq(right, &e);
  const __float128 place = ldexpq(1, e - 53 < -1074 ? -1074 : e - 53);
  return (double)(fabsq((__float128)got - right)/place);
}

static int measure(const Function *f, long n) {
  double worst = 0, at = 0;
  uint64_t sum = 14695981039346656037u;
  seed = 3;
  for (long i = 0; i < n;) {
    double x[LANES];
    LAG_REAL v, y;
    for (int k = 0; k < LANES; k++) put(&v, k, x[k] = f->argument(i + k, n));
    f->own(&v, &y);
    for (int k = 0; k < LANES; k++, i++) {
      const double got = get(&y, k), error = error_of(got, f->right(x[k]));
      union { double x; uint64_t u; } b = {got};
      sum = (sum ^ b.u)*1099511628211u;
      if (!(error <= worst)) worst = error, at = x[k];
    }
  }
  printf("%s %ld %.4f %.17g %016llx\n", f->name, n, worst, at, (unsigned long long)sum);
  return !(worst <= 1);
}

/* --- angles abreast --- */

/* Whether two and four angles a call give the bits of one after the other, whatever stands beside what. */
static int abreast(long n) {
  enum { MOST = 4 };
  int bad = 0;
  seed = 5;
  for (long i = 0; i + MOST*LANES <= n && !bad; i += MOST*LANES) {
    LAG_REAL x[MOST], s[3][MOST], c[3][MOST];
    for (int k = 0; k < MOST; k++) {
      for (int lane = 0; lane < LANES; lane++)
        put(&x[k], lane, bits() % 64 ? angle(i + k * LANES + lane, n) : bits() & 1 ? HUGE_VAL : (double)NAN);
      own_sin(&x[k], &s[0][k]);
      own_cos(&x[k], &c[0][k]);
    }
    own_sincos2(x, s[1], c[1]);
    own_sincos2(x + 2, s[1] + 2, c[1] + 2);
    own_sincos4(x, s[2], c[2]);
    for (int k = 0; k < MOST; k++)
      for (int way = 1; way <= 2; way++)
        if (memcmp(&s[way][k], &s[0][k], sizeof *x) != 0 || memcmp(&c[way][k], &c[0][k], sizeof *x) != 0) {
          printf("%d angles abreast: another sine or cosine of %.17g\n", 2*way, get(&x[k], 0));
          bad = 1;
        }
  }
  return bad;
}

/* --- special values --- */

static int special(const char *name, void (*f)(const LAG_REAL *, LAG_REAL *), double x, double want) {
  LAG_REAL v, y;
  for (int k = 0; k < LANES; k++) put(&v, k, k ? 1 : x); /* beside ordinary lanes */
  f(&v, &y);
  const double got = get(&y, 0);
  const int same = isnan(want) ? isnan(got) : got == want && signbit(got) == signbit(want);
  if (!same) printf("%s(%g) is %g, not %g\n", name, x, got, want);
  for (int k = 1; k < LANES; k++) put(&v, k, 1), put(&v, 0, 1);
  LAG_REAL ones;
  f(&v, &ones);
  for (int k = 1; k < LANES; k++)
    if (get(&y, k) != get(&ones, k)) return printf("%s(%g) changes another lane\n", name, x), 1;
  return !same;
}

static int specials(void) {
  const double inf = HUGE_VAL, nan_ = (double)NAN;
  int bad = 0;
  for (int sign = -1; sign <= 1; sign += 2) {
    bad |= special("sin", own_sin, sign*inf, nan_) | special("cos", own_cos, sign*inf, nan_);
    bad |= special("sin", own_sin, sign*0.0, sign*0.0) | special("cos", own_cos, sign*0.0, 1);
    bad |= special("sin", own_sin, sign*5e-324, sign*5e-324) | special("exp", own_exp, sign*0.0, 1);
    bad |= special("log", own_log, sign*0.0, -inf) | special("rsqrt", own_rsqrt, sign*0.0, sign*inf);
  }
  bad |=
      special("sin", own_sin, nan_, nan_) | special("cos", own_cos, nan_, nan_) | special("exp", own_exp, nan_, nan_);
  bad |= special("exp", own_exp, inf, inf) | special("exp", own_exp, -inf, 0) | special("exp", own_exp, 1e300, inf);
  bad |= special("exp", own_exp, -1e300, 0) | special("exp", own_exp, 709.8, inf) | special("exp", own_exp, -746, 0);
  bad |= special("log", own_log, inf, inf) | special("log", own_log, -1, nan_) | special("log", own_log, -inf, nan_);
  bad |= special("log", own_log, nan_, nan_) | special("log", own_log, 1, 0);
  bad |= special("rsqrt", own_rsqrt, inf, 0) | special("rsqrt", own_rsqrt, -1, nan_) |
         special("rsqrt", own_rsqrt, nan_, nan_);
  return bad;
}

int main(int argc, char **argv) {
  const long n = argc > 1 ? atol(argv[1])/8*8 : 100000;
  int bad = specials() | abreast(n);
  for (size_t i = 0; i < sizeof functions/sizeof *functions; i++) bad |= measure(&functions[i], n);
  return bad;
}
