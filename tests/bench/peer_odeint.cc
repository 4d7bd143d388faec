// Boost.odeint: Runge-Kutta-Fehlberg 7(8), controlled.
#include <algorithm>
#include <boost/array.hpp>
#include <boost/numeric/odeint.hpp>

#include "methods.h"

template <int n> static double run(bench_rhs *f, double t, double tol, double *y) {
  using namespace boost::numeric::odeint;
  typedef boost::array<double, n> State;
  State x;
  std::copy(y, y + n, x.begin());
  auto stepper = make_controlled(tol, tol, runge_kutta_fehlberg78<State>());
  double t0 = bench_now();
  try {
    integrate_adaptive(stepper, [f](const State &s, State &d, double at) { f(at, s.data(), d.data(), nullptr); }, x, 0.0, t, t*1e-4);
  } catch (const std::exception &) {
    return -1;
  }
  double took = bench_now() - t0;
  std::copy(x.begin(), x.end(), y);
  return took;
}

extern "C" double peer_odeint(int, bench_rhs *f, int n, double t, double tol, double *y) {
  switch (n) {
  case 4: return run<4>(f, t, tol, y);
  case 20: return run<20>(f, t, tol, y);
  case 36: return run<36>(f, t, tol, y);
  case 40: return run<40>(f, t, tol, y);
  default: return -1;
  }
}
