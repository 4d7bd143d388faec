/* wisdom_holman: planets. L = Kepler's problems + a perturbation: the model says its bodies (lag_kepler of
 * lag_model.h); each moves on its ellipse or hyperbola (kernels/kepler.h), between kicks by what the accelerations of
 * the model have besides Kepler's. J. Wisdom, M. Holman, Astron. J. 102 (1991) 1528, DOI 10.1086/115978. With a
 * fixed centre these are the bodies' own coordinates; else those of Jacobi: the body of the largest mass first, the
 * others by their distance from it at the start, each from the centre of mass of those before it.
 *
 * Enters: t, y = [q|v]; leaves: t + h, y one step later. Holds: motions without a perturbation are exact for any step;
 * sums of Jacobi's coordinates over steps are compensated; the kick at the end of a step is the first of the next.
 * Schemes of kernels/composition.h for small perturbations stand in for symplectic correctors (Wisdom, Holman,
 * Touma 1996): they have the same order in the perturbation, and starts, events and rows need no other state. */
#include "lag.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#include "kernels/composition.h"
#include "kernels/kepler.h"
#include "methods/steps.h"

static const lag_composition *const schemes[] = {&lag_compose_verlet, &lag_compose_sbab2, &lag_compose_sbab3,
                                                 &lag_compose_sbab4, &lag_compose_aba864};
static const char *const scheme_names[] = {"wh", "sbab2", "sbab3", "sbab4", "aba864", NULL};
enum { SBAB4 = 3 };
static const lag_method_option options[] = {
    LAG_STEP_OPTION,
    {"scheme", "kicks of a step: wh 1, sbab2 to sbab4 as many, aba864 7; errors go with step^2 to step^8 (to first order)",
     SBAB4, 0, 4, .choices = scheme_names}};
static const lag_composition *scheme_of(const lag_problem *pb) { return schemes[(int)pb->opt[1]]; }

/* Arrays of nq or n = 2 nq numbers, in Jacobi's coordinates but Y0, PLACE and RATE; and of bodies. */
typedef struct WisdomHolman {
  lag_fixed_step step;
  double ready; /* 1: X, KICK are those of the state */
  double x[];
} WisdomHolman;

enum { X, LOST, KICK, X0, LOST0, KICK0, STATE, RATE, SCRATCH, NARRAYS = SCRATCH + 3 };
/* order[k]: body of place k; mass; mu of Kepler's motion; mass of the bodies before it and it; k of each body and
 * masses as the model gives them. */
enum { ORDER, MU, INNER, VALUES, PER_BODY = VALUES + 2 };

static const char *refuses(const lag_model *m, const double *opt) {
  (void)opt;
  return m->kepler ? NULL
                   : "method wisdom_holman needs bodies in Cartesian coordinates with constant masses, all with terms "
                     "-k/r between them or from the origin; verlet6 and dop853 do without";
}

static size_t work_size(const lag_problem *pb) {
  return sizeof(WisdomHolman) / sizeof(double) + NARRAYS * (size_t)pb->n + PER_BODY * (size_t)pb->model->kepler->n;
}

static double *array(WisdomHolman *w, const lag_problem *pb, int which) { return w->x + which * pb->n; }
static double *per_body(WisdomHolman *w, const lag_problem *pb, int which) {
  return w->x + NARRAYS * pb->n + which * pb->model->kepler->n;
}

static void reset(void *work, lag_problem *pb) {
  WisdomHolman *w = work;
  (void)pb;
  w->ready = w->step.tc = 0;
}

/* Masses, and k of a fixed centre, or of the pairs with the body of the largest mass. */
static int read_values(WisdomHolman *w, lag_problem *pb, int *heaviest) {
  const lag_model *m = pb->model;
  const lag_kepler *of = m->kepler;
  double *q = array(w, pb, STATE), *out = per_body(w, pb, VALUES);
  memset(q, 0, (size_t)pb->n * sizeof *q);
  *heaviest = 0;
  for (int turn = 0; turn < 2 - of->fixed; turn++) {
    const int rc = of->values(of, 0, q, q, NULL, pb->p, pb->u, out, pb->work);
    if (rc) return lag_step_refused(pb, rc, 0);
    for (int i = 1; i < of->n; i++)
      if (out[i] > out[*heaviest]) *heaviest = i;
    q[of->at[*heaviest * of->dim]] = 1;
  }
  return LAG_OK;
}

/* Whether the bodies allow the method: forces attract, and of three or more one is far the heaviest. */
static int check_values(WisdomHolman *w, lag_problem *pb, int heaviest) {
  const lag_kepler *of = pb->model->kepler;
  const double *mass = per_body(w, pb, VALUES), *k = mass + of->n;
  for (int i = 0; i < of->n; i++) {
    const char *name = pb->model->q[of->at[i * of->dim]].name;
    if (i == heaviest && !of->fixed) continue;
    if (!(k[i] >= 0)) {
      snprintf(pb->words, sizeof pb->words,
               "method wisdom_holman needs attracting forces, and %s is repelled; verlet6 and dop853 do without", name);
      return pb->detail = pb->words, LAG_EMETHOD;
    }
    if (!of->fixed && of->n > 2 && mass[i] > 0.1 * mass[heaviest]) {
      snprintf(pb->words, sizeof pb->words,
               "method wisdom_holman needs one body that dominates, and the mass of %s is %.2g of the largest, more "
               "than a tenth; verlet6, taylor and dop853 take any masses",
               name, mass[i] / mass[heaviest]);
      return pb->detail = pb->words, LAG_EMETHOD;
    }
  }
  return LAG_OK;
}

static int init(void *work, lag_problem *pb, const double *opt) {
  WisdomHolman *w = work;
  int heaviest, rc = read_values(w, pb, &heaviest);
  w->step.h = lag_step_size(pb, opt[0]);
  reset(work, pb);
  return rc ? rc : check_values(w, pb, heaviest);
}

/* Places of bodies by their distance from the heaviest one, which is first; mu of their Kepler motions. */
static int place_bodies(WisdomHolman *w, lag_problem *pb, const double *y) {
  const lag_kepler *of = pb->model->kepler;
  double *order = per_body(w, pb, ORDER), *mu = per_body(w, pb, MU), *inner = per_body(w, pb, INNER);
  int first, rc = read_values(w, pb, &first);
  const double *mass = per_body(w, pb, VALUES), *k = mass + of->n;
  if (rc) return rc;
  for (int i = 0; i < of->n; i++) { /* mu: squares of distances until all are in place */
    double r2 = of->fixed ? i : i == first ? -1 : 0;
    for (int c = 0; c < of->dim && !of->fixed; c++) {
      const double d = y[of->at[i * of->dim + c]] - y[of->at[first * of->dim + c]];
      r2 += d * d;
    }
    int at = i;
    for (; at && mu[at - 1] > r2; at--) mu[at] = mu[at - 1], order[at] = order[at - 1];
    mu[at] = r2, order[at] = i;
  }
  for (int i = 0; i < of->n; i++) {
    const int body = (int)order[i];
    inner[i] = mass[body] + (i ? inner[i - 1] : 0);
    mu[i] = of->fixed ? k[body] / mass[body] : i ? k[body] / (mass[first] * mass[body]) * inner[i] : 0;
  }
  return LAG_OK;
}

/* to := Jacobi's coordinates of from[nq], body by body; a fixed centre: the same, in the order of bodies. */
static void to_jacobi(WisdomHolman *w, const lag_problem *pb, const double *from, double *to) {
  const lag_kepler *of = pb->model->kepler;
  const double *order = per_body(w, pb, ORDER), *inner = per_body(w, pb, INNER), *mass = per_body(w, pb, VALUES);
  double centre[3] = {0};
  for (int i = 0; i < of->n; i++) {
    const int body = (int)order[i];
    const double part = mass[body] / inner[i];
    for (int c = 0; c < of->dim; c++) {
      const double d = from[of->at[body * of->dim + c]] - centre[c];
      to[i * of->dim + c] = d;
      if (!of->fixed) centre[c] += part * d;
    }
  }
  for (int c = 0; c < of->dim && !of->fixed; c++) to[c] = centre[c];
}

static void from_jacobi(WisdomHolman *w, const lag_problem *pb, const double *from, double *to) {
  const lag_kepler *of = pb->model->kepler;
  const double *order = per_body(w, pb, ORDER), *inner = per_body(w, pb, INNER), *mass = per_body(w, pb, VALUES);
  double centre[3] = {0};
  for (int c = 0; c < of->dim && !of->fixed; c++) centre[c] = from[c];
  for (int i = of->n - 1; i >= 0; i--) {
    const int body = (int)order[i];
    const double part = mass[body] / inner[i];
    const int moves = i && !of->fixed;
    for (int c = 0; c < of->dim; c++) {
      const double d = i || of->fixed ? from[i * of->dim + c] : 0;
      if (moves) centre[c] -= part * d;
      to[of->at[body * of->dim + c]] = centre[c] + d;
    }
  }
}

/* kick := accelerations at Jacobi's coordinates x less those of Kepler. */
static int perturbation(WisdomHolman *w, lag_problem *pb, double t, const double *x, double *kick) {
  const lag_kepler *of = pb->model->kepler;
  const double *mu = per_body(w, pb, MU);
  double *state = array(w, pb, STATE), *rate = array(w, pb, RATE);
  from_jacobi(w, pb, x, state);
  const int rc = lag_step_rhs(pb, t, state, rate);
  if (rc) return rc;
  to_jacobi(w, pb, rate + pb->nq, kick);
  for (int i = !of->fixed; i < of->n; i++) {
    double r2 = 0;
    for (int c = 0; c < of->dim; c++) r2 += x[i * of->dim + c] * x[i * of->dim + c];
    const double pull = mu[i] / (r2 * sqrt(r2));
    for (int c = 0; c < of->dim; c++) kick[i * of->dim + c] += pull * x[i * of->dim + c];
  }
  return LAG_OK;
}

/* Kepler's motions of all bodies; the centre of mass moves straight on. */
static void drift(WisdomHolman *w, const lag_problem *pb, double dt, double *x, double *lost) {
  const lag_kepler *of = pb->model->kepler;
  const double *mu = per_body(w, pb, MU);
  const int nq = pb->nq;
  for (int i = 0; i < of->n; i++) {
    double *q = x + i * of->dim, *lost_q = lost + i * of->dim;
    if (mu[i] > 0) lag_kepler_drift(of->dim, mu[i], dt, q, q + nq, lost_q, lost_q + nq);
    else
      for (int c = 0; c < of->dim; c++) q[c] = lag_compensated_sum(q[c], dt * q[nq + c], &lost_q[c]);
  }
}

/* Whether steps begin with a drift, and need no forces at their ends. */
static int drifts_first(const lag_composition *c) { return !(c->kick[0] > 0); }

/* A step dt of x = [q|v] with what its sums have lost, from the perturbation to that at the end. */
static int compose(WisdomHolman *w, lag_problem *pb, double t, double dt, double *x, double *lost, double *kick) {
  const lag_composition *c = scheme_of(pb);
  const int nq = pb->nq, first = drifts_first(c);
  double at = 0;
  int rc;
  for (int s = 0;; s++) {
    const double part = c->kick[s] * dt;
    for (int i = 0; i < nq && !(first && s % c->stages == 0); i++)
      x[nq + i] = lag_compensated_sum(x[nq + i], part * kick[i], &lost[nq + i]);
    if (s == c->stages) return LAG_OK;
    drift(w, pb, c->drift[s] * dt, x, lost);
    at += c->drift[s];
    if (first && s + 1 == c->stages) continue;
    if ((rc = perturbation(w, pb, t + at * dt, x, kick)) != 0) return rc;
  }
}

/* Jacobi's coordinates of a state that is not the end of a step. */
static int enter(WisdomHolman *w, lag_problem *pb, double t, const double *y) {
  double *x = array(w, pb, X);
  const int rc = place_bodies(w, pb, y);
  if (rc) return rc;
  to_jacobi(w, pb, y, x);
  to_jacobi(w, pb, y + pb->nq, x + pb->nq);
  memset(array(w, pb, LOST), 0, (size_t)pb->n * sizeof(double));
  return drifts_first(scheme_of(pb)) ? LAG_OK : perturbation(w, pb, t, x, array(w, pb, KICK));
}

static void leave(WisdomHolman *w, const lag_problem *pb, const double *x, double *y) {
  from_jacobi(w, pb, x, y);
  from_jacobi(w, pb, x + pb->nq, y + pb->nq);
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  WisdomHolman *w = work;
  const size_t bytes = 3 * (size_t)pb->n * sizeof(double);
  double *x = array(w, pb, X);
  lag_next_step next;
  int rc;
  (void)t_stop;
  if ((rc = lag_fixed_step_begin(&w->step, pb, *t, &next)) != 0) return rc;
  if (w->ready == 0.0 && (rc = enter(w, pb, *t, y)) != 0) return rc;
  memcpy(array(w, pb, X0), x, bytes);
  w->ready = 0; /* until this step succeeds */
  if ((rc = compose(w, pb, *t, next.dt, x, array(w, pb, LOST), array(w, pb, KICK))) != 0) return rc;
  pb->bad_index = lag_not_finite(pb->n, x);
  if (pb->bad_index >= 0) return lag_step_failed(pb, LAG_ENAN, next.tb);
  leave(w, pb, x, y);
  w->ready = 1;
  lag_fixed_step_end(&w->step, &next, t);
  return LAG_OK;
}

/* A shorter step from the same begin. */
static void dense(void *work, lag_problem *pb, double t, double *y) {
  WisdomHolman *w = work;
  double *x = array(w, pb, SCRATCH);
  memcpy(x, array(w, pb, X0), 3 * (size_t)pb->n * sizeof *x);
  if (compose(w, pb, w->step.t0, t - w->step.t0, x, x + pb->n, x + 2 * pb->n) != LAG_OK) {
    y[0] = NAN;
    return;
  }
  leave(w, pb, x, y);
}

const lag_method lag_wisdom_holman = {
    .name = "wisdom_holman",
    .order = 2,
    .dense_order = 2,
    .doc = "Kepler motions and kicks by perturbations, for planets and satellites over long times. DOI 10.1086/115978",
    .flags = LAG_METHOD_SYMPLECTIC | LAG_METHOD_SYMMETRIC | LAG_METHOD_NO_STATES | LAG_METHOD_KEPLER,
    .noptions = 2,
    .options = options,
    .refuses = refuses,
    LAG_METHOD_FUNCTIONS,
};
