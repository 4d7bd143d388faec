/* GSL's rk8pd: Prince-Dormand 8(7) with 13 stages. */
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include "methods.h"

double peer_rk8pd(int problem, bench_rhs *f, int n, double t, double tol, double *y) {
  gsl_odeiv2_system system = {f, NULL, (size_t)n, NULL};
  double at = 0;
  (void)problem;
  gsl_set_error_handler_off();
  gsl_odeiv2_driver *d = gsl_odeiv2_driver_alloc_y_new(&system, gsl_odeiv2_step_rk8pd, t*1e-4, tol, tol);
  double t0 = bench_now();
  int rc = gsl_odeiv2_driver_apply(d, &at, t, y);
  double took = bench_now() - t0;
  gsl_odeiv2_driver_free(d);
  return rc ? -1 : took;
}
