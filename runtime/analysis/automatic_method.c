/* Automatic choice of the method where none is named. Enters: a simulation with its values and tolerance; leaves:
 * its method, and the reason. Holds: the choice depends on the model, the values and the tolerance, never on
 * measured times. Stiffness is the dominant eigenvalue of the Jacobian by the power method, compared with a method's
 * bound of stability at the steps of a trial run. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/workspace.h"
#include "numeric/dense.h"

/* Between these tolerances dop853 is the cheapest method, as measured with `lagc cost`. */
static const double below_taylor = 1e-9, above_rk45 = 1e-6;

/* limits on the size of the state: beyond, Jacobians or factorizations take too long */
enum { MOST_OF_TRIAL = 200, MOST_OF_RADAU = 40 };
enum { STEPS_OF_TRIAL = 600, LEAST_STEPS = 30, ITERATIONS = 6, STAGES = 12, MARGIN = 4 };

/* Fraction of the stability bound above which a step counts as limited. Steps limited by stability vary about the
 * bound, since steps past it let errors grow until one is refused (h*rho of rk45, whose bound is 3.3, lies between
 * 2.2 and 4.2), so half of them may be below it. */
static const double near_bound = 0.75;
/* A mode counts as growing if its real part is more than this fraction of |eigenvalue|: accuracy, not stability,
 * limits steps. Less may be rounding in the eigenvalue of an oscillation. */
static const double growing = 0.1;

typedef struct Stiffness {
  /* steps made; of these examined; of these with h*rho near or past the stability bound. In a trial that gets past
   * half of its steps, only later ones count */
  int steps, looked, limited;
  int unfinished;             /* 1: the trial ended at its largest number of steps */
  /* least number of steps of an explicit method at its stability bound: the sum of h*rho/bound */
  double needed;
  double calls, until;        /* right-hand sides computed; time reached */
} Stiffness;

typedef struct Look {
  Stiffness *s;
  double bound, last;   /* stability bound; time of the step before */
  int n, every;
  double *J, *x, *y, *z, *work;
} Look;

/* y := (df/dy) x; returns |y|. */
static double apply_jacobian(const lag_problem *pb, const double *J, const double *x, double *y) {
  size_t n = (size_t)pb->n, nq = (size_t)pb->nq;
  for (size_t i = 0; i < n; i++) {
    double value = i < nq ? x[nq + i] : 0;
    for (size_t k = 0; i >= nq && k < n; k++) value += J[(i - nq) * n + k] * x[k];
    y[i] = value;
  }
  return sqrt(lag_dot(pb->n, y, y));
}

/* The dominant eigenvalue, or pair: returns its modulus, 0 where there is none, and its real part. Power method,
 * continued from the vector of the last step. Then x, y = J x and z = J y lie in the span of the pair's vectors, z =
 * a y + b x, and the pair are the roots of s^2 = a s + b. For a single eigenvalue y is along x, and s = y.x/x.x. */
static double dominant(Look *l, const lag_problem *pb, double *real) {
  const double alike = 1e-10; /* squared sine of an angle that counts as 0 */
  int n = l->n;
  *real = 0;
  for (int i = 0; i < ITERATIONS; i++) {
    double growth = apply_jacobian(pb, l->J, l->x, l->y);
    if (!(growth > 0 && isfinite(growth))) return 0;
    for (int k = 0; k < n; k++) l->x[k] = l->y[k] / growth;
  }
  double yy = apply_jacobian(pb, l->J, l->x, l->y), xy = lag_dot(n, l->x, l->y); /* |x| = 1 */
  apply_jacobian(pb, l->J, l->y, l->z);
  double xz = lag_dot(n, l->x, l->z), yz = lag_dot(n, l->y, l->z), det = (yy - xy) * (yy + xy);
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
  /* drops the statistics of the first half of the trial: they may be those of a transient */
  if (s->steps == STEPS_OF_TRIAL / 2) {
    s->looked = s->limited = 0;
  }
  if (s->steps++ % l->every == 0 && lag_jacobian(&pb, t, sim->y, l->J, l->work) == LAG_OK) {
    double size = dominant(l, &pb, &real), reach = real * pb.dir > growing * size ? 0 : h * size / l->bound;
    s->looked++;
    s->limited += reach > near_bound;
    s->needed += reach * l->every;
  }
  return s->steps >= STEPS_OF_TRIAL;
}

/* Runs a trial by `method` with the values of sim for at most STEPS_OF_TRIAL steps, and compares each with an
 * explicit method's `bound` of stability on the negative real axis. A mode that grows in the direction of the run
 * does not count: backwards, a stiff model is not stiff. Needs the model's linearisation. 0: no trial is possible;
 * LAG_ENOMEM. Source of the criterion, and of the bounds 3.3 of rk45 and 6.1 of dop853: Hairer, Wanner, Solving
 * Ordinary Differential Equations II (1996), DOI 10.1007/978-3-642-05221-7, IV.2. */
static int run_trial(const lag_sim *sim, double until, const lag_method *method, double bound, Stiffness *s) {
  lag_sim *trial = lag_sim_like(sim);
  size_t n = (size_t)sim->pb.n, rows = n - (size_t)sim->pb.nq;
  Look l = {.s = s, .bound = bound, .last = sim->scene->t0, .n = (int)n, .every = n <= 40 ? 1 : 5};
  const lag_part parts[] = {{&l.J, rows * n}, {&l.x, n}, {&l.y, n}, {&l.z, n},
      {&l.work, lag_linear_work(sim->scene->model)}};
  double *block = lag_workspace(sizeof parts / sizeof *parts, parts);
  int rc = trial && block ? lag_sim_set_method(trial, method, NULL, 0) : LAG_ENOMEM, ready = rc == 0;
  *s = (Stiffness){0};
  if (ready) {
    for (size_t i = 0; i < n; i++) l.x[i] = 1 + 0.1 * (double)(i % 7); /* unlikely to be an eigenvector of a model */
    lag_sim_on_step(trial, examine_step, &l);
    s->unfinished = lag_sim_advance(trial, until) == LAG_INTERRUPTED;
  }
  free(block);
  lag_sim_free(trial);
  return rc == LAG_ENOMEM ? rc : ready;
}

/* After a trial of radau, with n components of the state: whether its steps are so far past the bound that it is
 * much cheaper than dop853 can be. At tight tolerances rounding or a transient may limit an explicit method's first
 * steps far below the stability bound; this test still sees stiffness. Costs are right-hand sides, 12 a step of
 * dop853; radau's Jacobian and decompositions count as n of them. */
static int exceeds_stability(const Stiffness *s, int n) {
  return STAGES * s->needed > MARGIN * (s->calls + (double)n * s->steps);
}

/* ---- The choice */

/* Whether the model is stiff, by a trial of `method`, and if needed of radau; why[size] := the reason. LAG_ENOMEM. */
static int is_stiff(const lag_sim *sim, double until, const lag_method *method, char *why, size_t size) {
  const lag_model *m = sim->scene->model;
  int n = 2 * m->nq + m->nz;
  double bound = method == &lag_rk45 ? 3.3 : 6.1;
  Stiffness s, radau;
  int rc = !m->linear || m->constraints || n > MOST_OF_TRIAL ? 0 : run_trial(sim, until, method, bound, &s);
  if (rc <= 0) return rc;
  if (s.looked >= LEAST_STEPS && s.limited * 2 > s.looked) {
    snprintf(
        why, size,
        "radau, since the model is stiff: stability, not the tolerance, would limit %.0f %% of the first steps of %s",
        100.0 * s.limited / s.looked, method->name);
    return 1;
  }
  rc = !s.unfinished || n > MOST_OF_RADAU ? 0 : run_trial(sim, until, &lag_radau, bound, &radau);
  if (rc <= 0 || !exceeds_stability(&radau, n)) return rc < 0 ? rc : 0;
  snprintf(why, size,
           "radau, since the model is stiff: stability alone would demand %.2g steps of %s to t = %.3g s, and radau "
           "takes %d",
           radau.needed, method->name, radau.until, radau.steps);
  return 1;
}

static int one_step(void *context, const lag_sim *sim) {
  (void)context;
  (void)sim;
  return 1;
}

/* Sets the method if it makes a first step. Else its failure: LAG_ENOMEM, or why this method cannot start. */
static int take_method(lag_sim *sim, double until, const lag_method *method, const lag_option *opt, int n) {
  int rc = lag_sim_set_method(sim, method, opt, n);
  if (rc) return rc;
  lag_sim *trial = lag_sim_like(sim);
  if (!trial) return lag_fail(sim, LAG_ENOMEM, "out of memory");
  lag_sim_on_step(trial, one_step, NULL);
  rc = lag_sim_advance(trial, until);
  rc = rc == LAG_EINVAL || rc > 0 ? LAG_OK : rc; /* a mistake in the start is not the method's */
  if (rc) lag_fail(sim, rc, "%s", lag_sim_message(trial));
  lag_sim_free(trial);
  return rc;
}

/* why := the choice after `refused` could not start, as the simulation's message says. */
static void say_refusal(const lag_sim *sim, const lag_method *refused, const char *taken, char *why, size_t size) {
  const char *message = lag_sim_message(sim);
  snprintf(why, size, "%s, since %s cannot start here (%.*s)", taken, refused->name, (int)strcspn(message, ";"),
           message);
}

int lag_sim_choose_method(lag_sim *sim, double until, int exponents, const lag_option *opt, int n, char *why,
                          size_t size) {
  if (!sim || !why) return LAG_EINVAL;
  double tol = lag_sim_tolerance(sim);
  const lag_method *plain = tol > above_rk45 ? &lag_rk45 : &lag_dop853, *refused = NULL;
  char refusal[400] = "";
  int stiff = is_stiff(sim, until, plain, why, size), rc = stiff < 0 ? lag_fail(sim, stiff, "out of memory") : LAG_OK;
  if (stiff > 0) rc = take_method(sim, until, refused = &lag_radau, opt, n);
  else if (rc == 0 && tol < below_taylor && !exponents) {
    snprintf(why, size, "taylor, since the tolerance is below %g", below_taylor);
    rc = take_method(sim, until, refused = &lag_taylor_method, opt, n);
  }
  if (rc == LAG_ENOMEM || (rc == 0 && refused)) return rc;
  if (rc && rc != LAG_EMETHOD) say_refusal(sim, refused, plain->name, refusal, sizeof refusal);
  rc = lag_sim_set_method(sim, plain, opt, n);
  if (rc == LAG_EMETHOD && !exponents) {
    say_refusal(sim, plain, lag_moreau.name, why, size);
    return lag_sim_set_method(sim, &lag_moreau, opt, n) == LAG_OK ? LAG_OK : lag_sim_set_method(sim, plain, opt, n);
  }
  if (rc) return rc;
  if (refusal[0]) snprintf(why, size, "%s", refusal);
  else if (plain == &lag_rk45) snprintf(why, size, "rk45, since the tolerance is above %g", above_rk45);
  else if (tol >= below_taylor) snprintf(why, size, "dop853, since the tolerance is at most %g", above_rk45);
  else if (exponents) snprintf(why, size, "dop853, since tangent vectors cost less with dop853 than with taylor");
  else if (sim->scene->model->constraints)
    snprintf(why, size, "dop853, since taylor cannot hold constraints, with the tolerance below %g", below_taylor);
  else snprintf(why, size, "dop853, since taylor cannot take this run, with its tolerance below %g", below_taylor);
  return LAG_OK;
}
