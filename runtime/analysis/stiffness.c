/* Stiffness: the dominant eigenvalue of the Jacobian by the power method, compared with a method's bound of stability at steps of a trial run. */
#include "analysis/stiffness.h"

#include <math.h>

#include "analysis/memory_pool.h"
#include "core/core.h"

enum { LEAST_STEPS = 30, ITERATIONS = 6, STAGES = 12, MARGIN = 4 };

/* Fraction of the stability bound above which a step counts as limited. Steps limited by stability vary about the bound, since steps past it let
 * errors grow until one is refused (h*rho of rk45, whose bound is 3.3, lies between 2.2 and 4.2), so half of them may be below it. */
static const double near_bound = 0.75;
/* A mode counts as growing if its real part is more than this fraction of |eigenvalue|: accuracy, not stability, limits steps. Less may be
 * rounding in the eigenvalue of an oscillation. */
static const double growing = 0.1;

typedef struct Look {
  Stiffness *s;
  double bound, last;   /* stability bound; time of the step before */
  int n, every, most;
  double *J, *x, *y, *z, *work;
} Look;

static double dot(int n, const double *a, const double *b) {
  double sum = 0;
  for (int i = 0; i < n; i++) sum += a[i] * b[i];
  return sum;
}

/* y := (df/dy) x; returns |y|. */
static double apply_jacobian(const lag_problem *pb, const double *J, const double *x, double *y) {
  size_t n = (size_t)pb->n, nq = (size_t)pb->nq;
  for (size_t i = 0; i < n; i++) {
    double value = i < nq ? x[nq + i] : 0;
    for (size_t k = 0; i >= nq && k < n; k++) value += J[(i - nq) * n + k] * x[k];
    y[i] = value;
  }
  return sqrt(dot(pb->n, y, y));
}

/* The dominant eigenvalue, or pair: returns its modulus, 0 where there is none, and its real part. Power method, continued from the vector of
 * the last step. Then x, y = J x and z = J y lie in the span of the pair's vectors, z = a y + b x, and the pair are the roots of s^2 = a s + b.
 * For a single eigenvalue y is along x, and s = y.x/x.x. */
static double dominant(Look *l, const lag_problem *pb, double *real) {
  const double alike = 1e-10; /* squared sine of an angle that counts as 0 */
  int n = l->n;
  *real = 0;
  for (int i = 0; i < ITERATIONS; i++) {
    double growth = apply_jacobian(pb, l->J, l->x, l->y);
    if (!(growth > 0 && isfinite(growth))) return 0;
    for (int k = 0; k < n; k++) l->x[k] = l->y[k] / growth;
  }
  double yy = apply_jacobian(pb, l->J, l->x, l->y), xy = dot(n, l->x, l->y); /* |x| = 1 */
  apply_jacobian(pb, l->J, l->y, l->z);
  double xz = dot(n, l->x, l->z), yz = dot(n, l->y, l->z), det = (yy - xy) * (yy + xy);
  if (!(det > alike * yy * yy)) {
    *real = xy;
    return fabs(xy);
  }
  double a = (yz - xz * xy) / det, b = (xz * yy * yy - yz * xy) / det, inside = a * a / 4 + b;
  *real = inside < 0 ? a / 2 : a / 2 + copysign(sqrt(inside), a);
  return inside < 0 ? sqrt(-b) : fabs(*real);
}

static int examine_step(void *context, const lag_sim *sim) {
  Look *l = context;
  Stiffness *s = l->s;
  lag_problem pb = sim->pb;
  double t = sim->run->step_t1, h = fabs(t - l->last), real;
  l->last = s->until = t;
  s->calls = pb.rhs_calls;
  if (s->steps == l->most / 2) { /* drops the statistics of the first half of the trial: they may be those of a transient */
    s->looked = s->limited = 0;
  }
  if (s->steps++ % l->every == 0 && lag_jacobian(&pb, t, sim->y, l->J, l->work) == LAG_OK) {
    double size = dominant(l, &pb, &real), reach = real * pb.dir > growing * size ? 0 : h * size / l->bound;
    s->looked++;
    s->limited += reach > near_bound;
    s->needed += reach * l->every;
  }
  return s->steps >= l->most;
}

int lag_stiffness(lag_sim *trial, double until, double bound, int most, Stiffness *s) {
  const lag_model *m = lag_sim_scene(trial)->model;
  int n = 2 * m->nq + m->nz;
  Pool pool = {0};
  Look l = {.s = s, .bound = bound, .last = lag_sim_time(trial), .n = n, .every = n <= 40 ? 1 : 5, .most = most};
  *s = (Stiffness){0};
  l.J = lag_pool_doubles(&pool, (size_t)(m->nq + m->nz) * (size_t)n);
  l.x = lag_pool_doubles(&pool, (size_t)n);
  l.y = lag_pool_doubles(&pool, (size_t)n);
  l.z = lag_pool_doubles(&pool, (size_t)n);
  l.work = lag_pool_doubles(&pool, lag_linear_work(m));
  if (!pool.failed) {
    for (int i = 0; i < n; i++) {
      l.x[i] = 1 + 0.1 * (i % 7); /* unlikely to be an eigenvector of a model */
    }
    lag_sim_on_step(trial, examine_step, &l);
    s->unfinished = lag_sim_advance(trial, until) == LAG_INTERRUPTED;
  }
  lag_pool_free(&pool);
  return pool.failed ? LAG_ENOMEM : LAG_OK;
}

int lag_is_stiff(const Stiffness *s) { return s->looked >= LEAST_STEPS && s->limited * 2 > s->looked; }

int lag_exceeds_stability(const Stiffness *s, int n) { return STAGES * s->needed > MARGIN * (s->calls + (double)n * s->steps); }
