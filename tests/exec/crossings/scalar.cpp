/* Steps to an event with a scalar that is a class: a ball falls to the floor after sqrt(2 h/g). SCALAR: 1 dual numbers, 2 Eigen's AutoDiffScalar, whose sums are types of their own. */
#include <cmath>
#include <cstdio>
#if SCALAR == 1
struct Dual {
  double x, d;
  Dual(double value = 0, double slope = 0) : x(value), d(slope) {}
  double value() const { return x; }
};
static Dual operator+(Dual a, Dual b) { return Dual(a.x + b.x, a.d + b.d); }
static Dual operator-(Dual a, Dual b) { return Dual(a.x - b.x, a.d - b.d); }
static Dual operator-(Dual a) { return Dual(-a.x, -a.d); }
static Dual operator*(Dual a, Dual b) { return Dual(a.x * b.x, a.d * b.x + a.x * b.d); }
static Dual operator/(Dual a, Dual b) { return Dual(a.x / b.x, (a.d - a.x / b.x * b.d) / b.x); }
static Dual &operator+=(Dual &a, Dual b) { return a = a + b; }
static Dual &operator*=(Dual &a, Dual b) { return a = a * b; }
static Dual &operator/=(Dual &a, Dual b) { return a = a / b; }
static bool operator>(Dual a, Dual b) { return a.x > b.x; }
static bool operator<(Dual a, Dual b) { return a.x < b.x; }
static bool operator>=(Dual a, Dual b) { return a.x >= b.x; }
static bool operator<=(Dual a, Dual b) { return a.x <= b.x; }
static Dual fabs(Dual a) { return a.x < 0 ? -a : a; }
#else
#include <Eigen/Core>
#include <unsupported/Eigen/AutoDiff>
typedef Eigen::AutoDiffScalar<Eigen::Matrix<double, 1, 1> > Dual;
static Dual fabs(const Dual &x) { return abs(x); } /* Eigen has no fabs */
#endif
#define M_LIBM
#define M_REAL Dual
#define M_STATIC
#include "m.h"

int main() {
  m_params p;
  m_state s;
  int event = -1;
  m_defaults(&p);
  m_start(&p, &s);
  while (event < 0)
    if (m_step_until_event(&p, &s, 0.3, &event) != M_OK) return 1;
  std::printf("%.17g\n", s.t.value());
}
