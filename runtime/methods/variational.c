/* variational and gauss: variational integrators with one discrete Lagrangian a step, of order 2, 4, 6 or 8. Enters:
 * t, y; leaves: t + h, y one step later. Holds: the map is symplectic in q and dL/dv and symmetric for any L; the
 * momentum of a symmetry that acts on q affinely is conserved to rounding. Forces enter by the discrete
 * Lagrange-d'Alembert principle. Steps: implicit_symplectic.c; tables and their sources: galerkin_rule.h. With u
 * Gauss points a step both methods are the same; variational also takes constraints, and gauss models with states
 * only (nq = 0), such as Lagrangians linear in all velocities, which have no p: it collocates their flow
 * (collocation.c, which says why variational refuses them). */
#include "methods/collocation.h"
#include "methods/implicit_symplectic.h"
#include "methods/steps.h"

enum { OPT_STEP, OPT_ORDER };
enum { OPT_STAGES = 1 };

static const lag_method_option variational_options[] = {
    LAG_STEP_OPTION,
    {"order", "2, 4, 6 or 8; 2 with constraints, as higher orders need them within a step, too", 2, 2, 8, NULL,
     .every = 2, .most = 2},
};

static const lag_method_option gauss_options[] = {
    LAG_STEP_OPTION,
    {"stages", "1, 2, 3 or 4: order 2, 4, 6, 8", 2, 1, 4, NULL, .every = 1},
};

static int variational_order(const double *opt) { return (int)opt[OPT_ORDER]; }

static int gauss_order(const double *opt) { return 2 * (int)opt[OPT_STAGES]; }

/* Gauss points a step; lag_method.variant computes the order from the options. */
static int points(const lag_problem *pb) {
  const lag_method *m = pb->variant;
  return m->order_of(pb->opt) / 2;
}

static size_t work_size(const lag_problem *pb) {
  return (pb->nq ? lag_implicit_size : lag_collocation_size)(pb, points(pb));
}

static int init(void *work, lag_problem *pb, const double *opt) {
  int u = points(pb);
  double h = lag_step_size(pb, opt[OPT_STEP]);
  lag_rule rule = {0};
  if (pb->nq == 0) {
    lag_collocation_init(work, pb, h, u);
    return LAG_OK;
  }
  lag_rule_gauss(&rule, u);
  lag_implicit_init(work, pb, h, 2 * u, &rule);
  return LAG_OK;
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  return (pb->nq ? lag_implicit_step : lag_collocation_step)(work, pb, t, y, t_stop);
}

static void dense(void *work, lag_problem *pb, double t, double *y) {
  (pb->nq ? lag_implicit_dense : lag_collocation_dense)(work, pb, t, y);
}

static void reset(void *work, lag_problem *pb) { (pb->nq ? lag_implicit_reset : lag_collocation_reset)(work, pb); }

static size_t tangent_size(const lag_problem *pb, int k) {
  return (pb->nq ? lag_implicit_tangent_size : lag_collocation_tangent_size)(pb, k);
}

static int tangent(void *work, lag_problem *pb, double t, int k, double *Y, double *scratch) {
  return (pb->nq ? lag_implicit_tangent : lag_collocation_tangent)(work, pb, t, k, Y, scratch);
}

#define PROPERTIES \
  (LAG_METHOD_SYMPLECTIC | LAG_METHOD_SYMMETRIC | LAG_METHOD_NO_STATES | LAG_METHOD_VARIATION | LAG_METHOD_NEWTON)

const lag_method lag_variational = {
    .name = "variational",
    .order = 2,
    .order_least = 2,
    .order_most = 8,
    .dense_order = 2,
    .doc = "discrete Lagrangian, Newton's method. DOI 10.1017/S096249290100006X",
    .flags = PROPERTIES | LAG_METHOD_CONSTRAINTS,
    .noptions = 2,
    .options = variational_options,
    .order_of = variational_order,
    .variant = &lag_variational,
    LAG_METHOD_FUNCTIONS,
    LAG_METHOD_TANGENT,
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
    .order_of = gauss_order,
    .variant = &lag_gauss,
    LAG_METHOD_FUNCTIONS,
    LAG_METHOD_TANGENT,
};
