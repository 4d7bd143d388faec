/* Headers with scalars that are classes: derivatives of accelerations by dual numbers, by complex steps and by Eigen's AutoDiffScalar. The
 * pendulum against its closed form; the double pendulum against the derivative of the textbook's accelerations. SCALAR: 1 dual, 2 complex, 3
 * AutoDiffScalar. Exit status 0 when all agree. */
#include <cmath>
#include <cstdio>
#if SCALAR == 1
struct Dual {
  double x, d;
  Dual(double value = 0, double slope = 0) : x(value), d(slope) {}
};
static Dual operator+(Dual a, Dual b) { return Dual(a.x + b.x, a.d + b.d); }
static Dual operator-(Dual a, Dual b) { return Dual(a.x - b.x, a.d - b.d); }
static Dual operator-(Dual a) { return Dual(-a.x, -a.d); }
static Dual operator*(Dual a, Dual b) { return Dual(a.x * b.x, a.d * b.x + a.x * b.d); }
static Dual operator/(Dual a, Dual b) { return Dual(a.x / b.x, (a.d - a.x / b.x * b.d) / b.x); }
static Dual &operator+=(Dual &a, Dual b) { return a = a + b; }
static bool operator>(Dual a, Dual b) { return a.x > b.x; }
static Dual sin(Dual a) { return Dual(std::sin(a.x), std::cos(a.x) * a.d); }
static Dual cos(Dual a) { return Dual(std::cos(a.x), -std::sin(a.x) * a.d); }
static Dual fabs(Dual a) { return a.x < 0 ? -a : a; }
typedef Dual Scalar;
static Scalar seeded(double x) { return Dual(x, 1); }
static double slope(Scalar y) { return y.d; }
#elif SCALAR == 2
#include <complex>
typedef std::complex<double> Scalar;
#define PENDULUM_COMPLEX
#define DOUBLE_PENDULUM_COMPLEX
static const double tiny = 1e-100;
static Scalar seeded(double x) { return Scalar(x, tiny); }
static double slope(Scalar y) { return y.imag() / tiny; }
#else
#include <Eigen/Core>
#include <unsupported/Eigen/AutoDiff>
typedef Eigen::AutoDiffScalar<Eigen::Matrix<double, 1, 1> > Scalar;
static Scalar seeded(double x) { return Scalar(x, 1, 0); }
static double slope(Scalar y) { return y.derivatives()(0); }
static Scalar fabs(const Scalar &x) { return abs(x); } /* Eigen has no fabs */
#endif
#define PENDULUM_LIBM
#define DOUBLE_PENDULUM_LIBM
#define PENDULUM_REAL Scalar
#define DOUBLE_PENDULUM_REAL Scalar
#define PENDULUM_STATIC
#define DOUBLE_PENDULUM_STATIC
#include "double_pendulum.h"
#include "pendulum.h"

static int bad;
static void near(const char *what, double got, double want, double tolerance) {
  if (std::fabs(got - want) <= tolerance) return;
  std::printf("%s: got %.17g, want %.17g\n", what, got, want);
  bad = 1;
}

static void pendulum() {
  pendulum_params p;
  pendulum_state s;
  pendulum_defaults(&p);
  pendulum_start(&p, &s);
  Scalar a[1], e[2];
  s.q[0] = seeded(0.7);
  s.v[0] = Scalar(0.4);
  near("status", pendulum_accel(s.t, s.q, s.v, &p, a), 0, 0);
  near("by the angle", slope(a[0]), -9.81 * std::cos(0.7), 1e-14);
  pendulum_energy(s.t, s.q, s.v, &p, e);
  near("energy by the angle", slope(e[0]), 9.81 * std::sin(0.7), 1e-14);
  s.q[0] = Scalar(0.7);
  p.l = seeded(1);
  pendulum_accel(s.t, s.q, s.v, &p, a);
  near("by the length", slope(a[0]), 9.81 * std::sin(0.7), 1e-14);
  /* To first order of the step: d th(h)/d th'(0) = h. */
  p.l = Scalar(1);
  s.v[0] = seeded(0.4);
  near("step", pendulum_rk4_step(&p, &s, Scalar(1e-6)), 0, 0);
  near("step by the velocity", slope(s.q[0]), 1e-6, 1e-15);
}

/* Numerator of th1'' over m1 + m2 sin^2 d, with d = th1 - th2 and all masses and lengths 1, and its derivative by th2. */
static void double_pendulum() {
  double_pendulum_params p;
  double_pendulum_state s;
  double_pendulum_defaults(&p);
  double_pendulum_start(&p, &s);
  const double x = 0.7, y = -0.4, u = 0.3, w = -1.1, g = 9.81, d = x - y, sn = std::sin(d), cs = std::cos(d);
  Scalar a[2];
  s.q[0] = Scalar(x), s.q[1] = seeded(y), s.v[0] = Scalar(u), s.v[1] = Scalar(w);
  near("status", double_pendulum_accel(s.t, s.q, s.v, &p, a), 0, 0);
  const double num = g * std::sin(y) * cs - sn * (u * u * cs + w * w) - 2 * g * std::sin(x), den = 1 + sn * sn;
  const double num_y = g * std::cos(y) * cs + g * std::sin(y) * sn + cs * (u * u * cs + w * w) - sn * (u * u * sn), den_y = -2 * sn * cs;
  near("double pendulum, th1'' by th2", slope(a[0]), (num_y - num / den * den_y) / den, 1e-13);
}

int main() {
  pendulum();
  double_pendulum();
  return bad;
}
