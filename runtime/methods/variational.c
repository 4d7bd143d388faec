/* variational and gauss: variational integrators with one discrete Lagrangian a step, of order 2, 4, 6 or 8. Enters: t, y; leaves:
 * t + h, y one step later. Holds: the map is symplectic in q and dL/dv and symmetric for any L; the momentum of a symmetry that acts
 * on q affinely is conserved to rounding. Forces enter by the discrete Lagrange-d'Alembert principle. Steps: implicit_symplectic.c; tables and
 * their sources: galerkin_rule.h. Models with states only (nq = 0), such as Lagrangians linear in all velocities, have no p: gauss collocates
 * their flow (collocation.c, which says why variational refuses them). */
#include "lag.h"
#include "methods/collocation.h"
#include "methods/implicit_symplectic.h"
#include "methods/steps.h"

enum { OPT_STEP, OPT_QUADRATURE, OPT_ORDER };
enum { OPT_STAGES = 1 };
enum { GAUSS, LOBATTO, MIDPOINT, TRAPEZOID };

static const char *const quadratures[] = {"gauss", "lobatto", "midpoint", "trapezoid", NULL};

static const lag_method_option variational_options[] = {
    LAG_STEP_OPTION,
    {"quadrature", "gauss, lobatto; of order 2 they are midpoint, trapezoid", 0, 0, 3, quadratures},
    {"order", "2, 4, 6 or 8", 2, 2, 8, NULL},
};

static const lag_method_option gauss_options[] = {
    LAG_STEP_OPTION,
    {"stages", "1, 2, 3 or 4: order 2, 4, 6, 8", 2, 1, 4, NULL},
};

static const char *variational_check(const double *opt)
{
  double u = opt[OPT_ORDER] / 2;

  if (u != (int)u) {
    return "order: write 2, 4, 6 or 8";
  }
  if (opt[OPT_QUADRATURE] >= MIDPOINT && u > 1) {
    return opt[OPT_QUADRATURE] == MIDPOINT ? "the midpoint rule has order 2; write quadrature=gauss"
                                           : "the trapezoidal rule has order 2; write quadrature=lobatto";
  }
  return NULL;
}

static int variational_order(const double *opt)
{
  return (int)opt[OPT_ORDER];
}

static int gauss_order(const double *opt)
{
  return 2 * (int)opt[OPT_STAGES];
}

static const char *variational_refuses(const lag_model *model, const double *opt)
{
  return model->constraints && opt[OPT_ORDER] > 2
             ? "with constraints only order 2 is possible: higher orders would need the constraints at points within the step, too; "
               "verlet4, verlet6 and "
               "verlet8 compose steps of order 2"
             : NULL;
}

static int variational_init(void *work, lag_problem *pb, const double *opt)
{
  int quadrature = (int)opt[OPT_QUADRATURE], u = (int)(opt[OPT_ORDER] / 2);
  lag_rule rule;

  if (quadrature == LOBATTO || quadrature == TRAPEZOID) {
    lag_rule_lobatto(&rule, u);
  } else {
    lag_rule_gauss(&rule, u);
  }
  lag_implicit_init(work, pb, lag_step_size(pb, opt[OPT_STEP]), 2 * u, &rule);
  return LAG_OK;
}

static const char *gauss_check(const double *opt)
{
  return opt[OPT_STAGES] != (int)opt[OPT_STAGES] ? "stages: write 1, 2, 3 or 4" : NULL;
}

static int gauss_init(void *work, lag_problem *pb, const double *opt)
{
  int u = (int)opt[OPT_STAGES];
  lag_rule rule;

  if (pb->nq == 0) {
    lag_collocation_init(work, pb, lag_step_size(pb, opt[OPT_STEP]), u);
    return LAG_OK;
  }
  lag_rule_gauss(&rule, u);
  lag_implicit_init(work, pb, lag_step_size(pb, opt[OPT_STEP]), 2 * u, &rule);
  return LAG_OK;
}

static size_t variational_size(const lag_problem *pb)
{
  return lag_implicit_size(pb, (int)(pb->opt[OPT_ORDER] / 2));
}

static size_t gauss_size(const lag_problem *pb)
{
  int u = (int)pb->opt[OPT_STAGES];

  return pb->nq ? lag_implicit_size(pb, u) : lag_collocation_size(pb, u);
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop)
{
  (void)t_stop;
  return lag_implicit_step(work, pb, t, y);
}

static int gauss_step(void *work, lag_problem *pb, double *t, double *y, double t_stop)
{
  (void)t_stop;
  return pb->nq ? lag_implicit_step(work, pb, t, y) : lag_collocation_step(work, pb, t, y);
}

static void gauss_dense(void *work, lag_problem *pb, double t, double *y)
{
  (pb->nq ? lag_implicit_dense : lag_collocation_dense)(work, pb, t, y);
}

static void gauss_reset(void *work, lag_problem *pb)
{
  (pb->nq ? lag_implicit_reset : lag_collocation_reset)(work, pb);
}

static size_t gauss_tangent_size(const lag_problem *pb, int k)
{
  return (pb->nq ? lag_implicit_tangent_size : lag_collocation_tangent_size)(pb, k);
}

static int gauss_tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch)
{
  return (pb->nq ? lag_implicit_tangent : lag_collocation_tangent)(work, pb, t, k, Y, scratch);
}

#define PROPERTIES (LAG_METHOD_SYMPLECTIC | LAG_METHOD_SYMMETRIC | LAG_METHOD_NO_STATES | LAG_METHOD_VARIATION | LAG_METHOD_NEWTON)

const lag_method lag_variational = {
    .name = "variational",
    .order = 2,
    .order_least = 2,
    .order_most = 8,
    .dense_order = 2,
    .doc = "discrete Lagrangian, Newton's method. DOI 10.1017/S096249290100006X",
    .flags = PROPERTIES | LAG_METHOD_CONSTRAINTS,
    .noptions = 3,
    .options = variational_options,
    .check = variational_check,
    .order_of = variational_order,
    .refuses = variational_refuses,
    .work_size = variational_size,
    .init = variational_init,
    .step = step,
    .dense = lag_implicit_dense,
    .reset = lag_implicit_reset,
    .tangent_size = lag_implicit_tangent_size,
    .tangent = lag_implicit_tangent,
};

const lag_method lag_gauss = {
    .name = "gauss",
    .order = 4,
    .order_least = 2,
    .order_most = 8,
    .dense_order = 4,
    .doc = "Gauss collocation in q and p, or in the states of models without coordinates, by Newton's method. DOI "
           "10.1007/3-540-30666-8, VI.4 and VI.6",
    .flags = PROPERTIES | LAG_METHOD_FLOWS,
    .noptions = 2,
    .options = gauss_options,
    .check = gauss_check,
    .order_of = gauss_order,
    .work_size = gauss_size,
    .init = gauss_init,
    .step = gauss_step,
    .dense = gauss_dense,
    .reset = gauss_reset,
    .tangent_size = gauss_tangent_size,
    .tangent = gauss_tangent,
};
