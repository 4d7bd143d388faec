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
#include "methods/kepler_lanes.h"
#include "methods/steps.h"
#include "numeric/processor.h"

static const lag_composition *const schemes[] = {&lag_compose_verlet, &lag_compose_sbab2, &lag_compose_sbab3,
                                                 &lag_compose_sbab4, &lag_compose_aba864};
static const char *const scheme_names[] = {"wh", "sbab2", "sbab3", "sbab4", "aba864", NULL};
enum { SBAB4 = 3 };
static const lag_method_option options[] = {
    LAG_STEP_OPTION,
    {"scheme",
     "wh, sbab2, sbab3, sbab4: 1 to 4 kicks a step, errors go with step^2, 4, 6, 8 times the perturbation, and step^2 "
     "times its square; aba864: 7 kicks, step^8, and step^6 times the square",
     SBAB4, 0, 4, .choices = scheme_names}};
static const lag_composition *scheme_of(const lag_problem *pb) { return schemes[(int)pb->opt[1]]; }

typedef struct WisdomHolman {
  lag_fixed_step step;
  double ready; /* 1: STATE is that of the run */
  _Alignas(LAG_WORK_ALIGN) double x[];
} WisdomHolman;

/* Arrays of kepler_lanes.h in Jacobi's coordinates: of the state, at the begin of the last step, of another step. */
enum { STATE, BEGIN, OTHER, NSTATES };
/* By place: the body; mu of its Kepler motion, and 1 where that is not 0; its part of the mass of the bodies up to
 * it. By body: masses, and k. */
enum { ORDER, MU, HELD, PART, VALUES, PER_BODY = VALUES + 2 };

static const char *refuses(const lag_model *m, const double *opt) {
  (void)opt;
  return m->kepler ? NULL
                   : "it needs bodies in Cartesian coordinates with constant masses, all with terms "
                     "-k/r between them or from the origin; verlet6 and dop853 do without";
}

/* Places: bodies, and more that stay at rest to fill vectors. */
static int places(const lag_problem *pb) {
  const int n = pb->model->kepler->n, block = n > KEPLER_FEW ? KEPLER_BLOCK : KEPLER_FEW;
  return (n + block - 1) / block * block;
}

static size_t work_size(const lag_problem *pb) {
  const size_t per_place = 3 * NSTATES * KEPLER_ARRAYS + PER_BODY;
  return sizeof(WisdomHolman) / sizeof(double) + per_place * (size_t)places(pb) + 2 * (size_t)pb->n;
}

static int length(const lag_problem *pb) { return 3 * places(pb); }
static size_t state_size(const lag_problem *pb) { return KEPLER_ARRAYS * (size_t)length(pb) * sizeof(double); }
static double *array(WisdomHolman *w, const lag_problem *pb, int state, int which) {
  return w->x + (state * KEPLER_ARRAYS + which) * length(pb);
}
static double *per_body(WisdomHolman *w, const lag_problem *pb, int which) {
  return w->x + (3 * NSTATES * KEPLER_ARRAYS + which) * places(pb);
}
/* A state as the model has it, and its rates. */
static double *state_of(WisdomHolman *w, const lag_problem *pb) { return per_body(w, pb, PER_BODY); }

static void reset(void *work, lag_problem *pb) {
  WisdomHolman *w = work;
  (void)pb;
  w->ready = w->step.tc = 0;
}

/* Masses, and k of a fixed centre, or of the pairs with the body of the largest mass. */
static int read_values(WisdomHolman *w, lag_problem *pb, int *heaviest) {
  const lag_model *m = pb->model;
  const lag_kepler *of = m->kepler;
  double *q = state_of(w, pb), *out = per_body(w, pb, VALUES);
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
    if (!(k[i] > 0)) {
      snprintf(pb->words, sizeof pb->words,
               "it needs attracting forces, and none attracts %s to %s; verlet6 and dop853 do "
               "without",
               name, of->fixed ? "the origin" : "the body of the largest mass");
      return pb->detail = pb->words, LAG_EMETHOD;
    }
    if (!of->fixed && of->n > 2 && mass[i] > 0.1 * mass[heaviest]) {
      snprintf(pb->words, sizeof pb->words,
               "it needs one body that dominates, and the mass of %s is %.2g of the largest, more "
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
  double *order = per_body(w, pb, ORDER), *mu = per_body(w, pb, MU), *held = per_body(w, pb, HELD),
         *part = per_body(w, pb, PART), inner = 0;
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
    inner += mass[body];
    part[i] = mass[body] / inner;
    mu[i] = of->fixed ? k[body] / mass[body] : i ? k[body] / (mass[first] * mass[body]) * inner : 0;
    held[i] = mu[i] > 0;
  }
  return LAG_OK;
}

/* to := Jacobi's coordinates of from[nq]; with a fixed centre the same. */
static void to_jacobi(WisdomHolman *w, const lag_problem *pb, const double *from, double *to) {
  const lag_kepler *of = pb->model->kepler;
  const double *order = per_body(w, pb, ORDER), *part = per_body(w, pb, PART);
  const int dim = of->dim, joint = !of->fixed, m = places(pb);
  double x = 0, y = 0, z = 0; /* centre of mass */
  for (int i = 0; i < of->n; i++) {
    const int *at = of->at + (int)order[i] * dim;
    const double dx = from[at[0]] - x, dy = from[at[1]] - y, dz = dim > 2 ? from[at[2]] - z : 0;
    to[i] = dx, to[m + i] = dy, to[2 * m + i] = dz;
    if (joint) x += part[i] * dx, y += part[i] * dy, z += part[i] * dz;
  }
  if (joint) to[0] = x, to[m] = y, to[2 * m] = z;
}

static void from_jacobi(WisdomHolman *w, const lag_problem *pb, const double *from, double *to) {
  const lag_kepler *of = pb->model->kepler;
  const double *order = per_body(w, pb, ORDER), *part = per_body(w, pb, PART);
  const int dim = of->dim, joint = !of->fixed, m = places(pb);
  double x = joint ? from[0] : 0, y = joint ? from[m] : 0, z = joint ? from[2 * m] : 0;
  for (int i = of->n - 1; i >= 0; i--) {
    const int *at = of->at + (int)order[i] * dim, apart = i || !joint;
    const double dx = apart ? from[i] : 0, dy = apart ? from[m + i] : 0, dz = apart ? from[2 * m + i] : 0;
    if (joint) x -= part[i] * dx, y -= part[i] * dy, z -= part[i] * dz;
    to[at[0]] = x + dx, to[at[1]] = y + dy;
    if (dim > 2) to[at[2]] = z + dz;
  }
}

/* Accelerations in Jacobi's coordinates at x. */
static int accelerations(WisdomHolman *w, lag_problem *pb, double t, double *x) {
  double *state = state_of(w, pb), *rate = state + pb->n;
  from_jacobi(w, pb, x, state);
  const int rc = lag_rhs(pb, t, state, rate); /* the state at the end shows what is not finite */
  if (rc) return lag_step_refused(pb, rc, t);
  to_jacobi(w, pb, rate + pb->nq, x + KEPLER_ACCEL * length(pb));
  return LAG_OK;
}

static KeplerMove *move_for(int m) {
  const int most = lag_processor_lanes();
  if (most >= 8 && m % KEPLER_BLOCK == 0 && lag_kepler_move_8) return lag_kepler_move_8;
  if (most >= 4 && lag_kepler_move_4) return lag_kepler_move_4;
  return lag_kepler_move_2 ? lag_kepler_move_2 : lag_kepler_move_1;
}

/* Whether steps begin with a drift, and need no forces at their ends. */
static int drifts_first(const lag_composition *c) { return !(c->kick[0] > 0); }

/* A step dt of x, with what its sums have lost, from the accelerations to those at the end. */
static int compose(WisdomHolman *w, lag_problem *pb, double t, double dt, double *x) {
  const lag_composition *c = scheme_of(pb);
  const double *mu = per_body(w, pb, MU);
  const int m = places(pb);
  KeplerMove *const move = move_for(m);
  double at = 0;
  for (int s = 0; s < c->stages; s++) {
    move(m, mu, c->kick[s] * dt, c->drift[s] * dt, x);
    at += c->drift[s];
    if (drifts_first(c) && s + 1 == c->stages) return LAG_OK;
    const int rc = accelerations(w, pb, t + at * dt, x);
    if (rc) return rc;
  }
  move(m, mu, c->kick[c->stages] * dt, 0, x);
  return LAG_OK;
}

/* Jacobi's coordinates of a state that is not the end of a step. */
static int enter(WisdomHolman *w, lag_problem *pb, double t, const double *y) {
  double *x = array(w, pb, STATE, KEPLER_X);
  const double *mu = per_body(w, pb, MU);
  const int rc = place_bodies(w, pb, y), n = length(pb), m = places(pb);
  if (rc) return rc;
  to_jacobi(w, pb, y, x);
  to_jacobi(w, pb, y + pb->nq, x + KEPLER_V * n);
  memset(x + KEPLER_LOST_X * n, 0, 2 * (size_t)n * sizeof *x);
  lag_kepler_distances(m, mu, x);
  return drifts_first(scheme_of(pb)) ? LAG_OK : accelerations(w, pb, t, x);
}

/* y := the state x at the end of a step; the last forces had its positions, but where a drift came last. */
static void leave(WisdomHolman *w, const lag_problem *pb, const double *x, double *y) {
  if (drifts_first(scheme_of(pb))) from_jacobi(w, pb, x, y);
  else lag_copy(pb->nq, state_of(w, pb), y);
  from_jacobi(w, pb, x + length(pb), y + pb->nq);
}

/* A step from t to tb that has no finite end: the model has no rates at its begin, or none within it. */
static int lost(WisdomHolman *w, lag_problem *pb, double t, const double *y, double tb) {
  double *rate = state_of(w, pb) + pb->n;
  const int rc = lag_rhs(pb, t, y, rate);
  if (rc) return lag_step_refused(pb, rc, t);
  pb->bad_index = lag_not_finite(pb->n, rate);
  return lag_step_failed(pb, LAG_ENAN, pb->bad_index >= 0 ? t : tb);
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  WisdomHolman *w = work;
  double *x = array(w, pb, STATE, KEPLER_X);
  lag_next_step next;
  int rc;
  (void)t_stop;
  if ((rc = lag_fixed_step_begin(&w->step, pb, *t, &next)) != 0) return rc;
  if (w->ready == 0.0 && (rc = enter(w, pb, *t, y)) != 0) return rc;
  memcpy(array(w, pb, BEGIN, KEPLER_X), x, state_size(pb));
  w->ready = 0; /* until this step succeeds */
  if ((rc = compose(w, pb, *t, next.dt, x)) != 0) return rc;
  if (lag_not_finite(2 * length(pb), x) >= 0) return lost(w, pb, *t, y, next.tb);
  leave(w, pb, x, y);
  w->ready = 1;
  lag_fixed_step_end(&w->step, &next, t);
  return LAG_OK;
}

/* A shorter step from the same begin. */
static void dense(void *work, lag_problem *pb, double t, double *y) {
  WisdomHolman *w = work;
  double *x = array(w, pb, OTHER, KEPLER_X);
  memcpy(x, array(w, pb, BEGIN, KEPLER_X), state_size(pb));
  if (compose(w, pb, w->step.t0, t - w->step.t0, x) == LAG_OK) leave(w, pb, x, y);
  else y[0] = NAN;
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
