#include "analysis/stiff.h"

#include <math.h>

#include "analysis/pool.h"
#include "core/core.h"

enum { MOST_STEPS = 600, LEAST_STEPS = 30, ITERATIONS = 6 };

/* Of the bound of stability. Steps that it limits do not stay above it: their h*rho goes up and down about it, since steps past it
 * let errors grow until one is refused (of rk45, whose bound is 3.3, between 2.2 and 4.2), so that half of them may be below. */
static const double near_bound = 0.75;

typedef struct Look {
  Stiffness *s;
  double bound, last;   /* of stability; the time of the step before */
  int n, every, steps;
  double *J, *x, *y, *work;
} Look;

/* y := (df/dy) x; returns |y|. */
static double apply(const lag_problem *pb, const double *J, const double *x, double *y)
{
  size_t n = (size_t)pb->n, nq = (size_t)pb->nq;
  double sum = 0;

  for (size_t i = 0; i < n; i++) {
    double value = i < nq ? x[nq + i] : 0;
    for (size_t k = 0; i >= nq && k < n; k++) {
      value += J[(i - nq) * n + k] * x[k];
    }
    y[i] = value;
    sum += value * value;
  }
  return sqrt(sum);
}

/* The size of the largest eigenvalue, by the power method from what the last step left: the geometric mean of two
 * growths, since one alone goes up and down with a complex pair. */
static double spectral_radius(Look *l, const lag_problem *pb)
{
  double before = 1, growth = 1;

  for (int i = 0; i < ITERATIONS; i++) {
    before = growth;
    growth = apply(pb, l->J, l->x, l->y);
    if (!(growth > 0 && isfinite(growth))) {
      return 0;
    }
    for (int k = 0; k < l->n; k++) {
      l->x[k] = l->y[k] / growth;
    }
  }
  return sqrt(before * growth);
}

static int look(void *context, const lag_sim *sim)
{
  Look *l = context;
  lag_problem pb = sim->pb;
  double t = sim->run->step_t1, h = fabs(t - l->last);

  l->last = t;
  if (l->steps++ % l->every == 0 && lag_jacobian(&pb, t, sim->y, l->J, l->work) == LAG_OK) {
    l->s->looked++;
    l->s->limited += h * spectral_radius(l, &pb) > near_bound * l->bound;
  }
  return l->steps >= MOST_STEPS;
}

int lag_stiffness(lag_sim *trial, double until, double bound, Stiffness *s)
{
  const lag_model *m = lag_sim_scene(trial)->model;
  int n = 2 * m->nq + m->nz;
  Pool pool = {0};
  Look l = {.s = s, .bound = bound, .last = lag_sim_time(trial), .n = n, .every = n <= 40 ? 1 : 5};

  *s = (Stiffness){0};
  l.J = pool_doubles(&pool, (size_t)(m->nq + m->nz) * (size_t)n);
  l.x = pool_doubles(&pool, (size_t)n);
  l.y = pool_doubles(&pool, (size_t)n);
  l.work = pool_doubles(&pool, lag_linear_work(m));
  if (!pool.failed) {
    for (int i = 0; i < n; i++) {
      l.x[i] = 1 + 0.1 * (i % 7); /* no eigenvector that a model is likely to have */
    }
    lag_sim_on_step(trial, look, &l);
    lag_sim_advance(trial, until);
  }
  pool_free(&pool);
  return pool.failed ? LAG_ENOMEM : LAG_OK;
}

int lag_is_stiff(const Stiffness *s)
{
  return s->looked >= LEAST_STEPS && s->limited * 2 > s->looked;
}
