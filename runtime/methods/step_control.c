/* Error norm and first step of adaptive methods (Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I,
 * II.4). */
#include "methods/step_control.h"

#include <float.h>

const char *const lag_on_off[] = {"on", "off", NULL};

void lag_step_limits_init(lag_step_limits *l, const lag_problem *pb, const double *opt) {
  l->fixed = opt[LAG_OPT_ADAPT];
  l->h_option = l->fixed != 0.0 ? lag_step_size(pb, opt[LAG_OPT_STEP]) : opt[LAG_OPT_STEP];
  l->h_max = opt[LAG_OPT_MAX] > 0 ? opt[LAG_OPT_MAX] : pb->span / 10;
  l->atol = opt[LAG_OPT_ATOL];
}

/* Instance of kernels/first_step.h. */
#define LAG_START_MODEL lag_problem *pb, const lag_tolerance *tol
#define LAG_THE_START pb, tol
#define LAG_START_ALLOWED(i, size) \
  (tol->relative * lag_tolerance_floor(tol->limits, pb, i) + tol->relative * (size))
#define LAG_START_RATES(t, y, f) lag_rhs(pb, t, y, f)
#include "kernels/first_step.h"

double lag_first_step(lag_problem *pb, const lag_tolerance *tol, lag_first_try s) {
  s.n = pb->n;
  s.dir = pb->dir;
  s.longest = tol->limits->h_max;
  s.unit = tol->limits->atol > 0 ? 1 : pb->size[pb->n + 1]; /* of h0, h1, 1/d1 and 1/d2 */
  /* Not a size that is refused at this time (4 ulp of it), as from components near 0, whose allowed errors are. */
  return lag_max(lag_start_step(pb, tol, &s), 16 * DBL_EPSILON * fabs(s.t));
}
