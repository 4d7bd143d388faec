/* The steppers of the GNU Scientific Library as methods: independent integrators to check against. Enters: t, y;
 * leaves: the next t, y. Holds: GSL's abort handler is off while it runs; a time of output is reached exactly,
 * because GSL has no dense output (dense() here is lag_hermite, inaccurate where steps are long).
 *
 * Errors are controlled by GSL's y_new control: |err_i| <= tol (1 + |y_i|). gsl-bsimp needs the Jacobian: central
 * finite differences of the right-hand side, 2n + 2 calls each, of relative accuracy about 1e-10. Source: GSL
 * Reference Manual, "Ordinary Differential Equations" (gsl_odeiv2), and the papers named there. */
#include <float.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <gsl/gsl_qrng.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "lag.h"

typedef struct Gsl {
  gsl_odeiv2_driver *driver;
  gsl_odeiv2_system system;
  lag_problem *pb;
  double h, h_option;
  double t0, t1;   /* the last step */
  int fatal;       /* the model's own failure inside GSL, 0 none */
  int have_f;      /* F0 = f(t0, Y0) and F1 = f(t1, Y1) are known */
} Gsl;

/* Quasi-random sequences, for samples of sweeps: `points` of lag_extras (lag.h). */
static int points(const char *sequence, int dimensions, long long n, double *u) {
  const gsl_qrng_type *type = strcmp(sequence, "sobol") == 0 ? gsl_qrng_sobol : gsl_qrng_halton;
  if (dimensions > (int)type->max_dimension) return (int)type->max_dimension;
  gsl_qrng *q = gsl_qrng_alloc(type, (unsigned)dimensions);
  if (!q) return (int)type->max_dimension;
  for (long long i = 0; i < n; i++) gsl_qrng_get(q, u + i * dimensions);
  gsl_qrng_free(q);
  return 0;
}

enum { Y0, F0, Y1, F1, J0, J1, NARRAYS };
enum { HEAD = (sizeof(Gsl) + sizeof(double) - 1) / sizeof(double) };

static double *array(const void *work, int k) {
  const Gsl *w = work;
  return (double *)(uintptr_t)work + HEAD + k * w->pb->n;
}

static const lag_method_option options[] = {
    {"step", "first step to try [s]; 0: a millionth of the scene's span", 0, 0, HUGE_VAL, .choices = NULL},
};

static size_t work_size(const lag_problem *pb) { return HEAD + NARRAYS * (size_t)pb->n; }

/* f for GSL. A fatal failure of the model ends GSL's attempts at once; others make it try a smaller step. */
static int gsl_rhs(double t, const double *y, double *dy, void *params) {
  Gsl *w = params;
  int rc = lag_rhs(w->pb, t, y, dy), bad = rc ? -1 : lag_not_finite(w->pb->n, dy);
  if (rc == 0 && bad < 0) return GSL_SUCCESS;
  w->pb->bad_t = t;
  w->pb->bad_index = bad;
  if (rc < 0) {
    w->fatal = rc < -1 ? LAG_EMODEL : rc;
    return GSL_EBADFUNC;
  }
  return GSL_FAILURE;
}

/* df/dy and df/dt by central differences. */
static int gsl_jacobian(double t, const double *y, double *dfdy, double *dfdt, void *params) {
  Gsl *w = params;
  int n = w->pb->n, rc = 0;
  double *x = array(w, F0), *fa = array(w, J0), *fb = array(w, J1), eps = cbrt(DBL_EPSILON);
  memcpy(x, y, (size_t)n * sizeof *x);
  for (int j = 0; j <= n && rc == 0; j++) {
    double at = j < n ? y[j] : t, d = eps * fmax(fabs(at), 1e-3), *where = j < n ? &x[j] : &t;
    *where = at - d;
    rc = gsl_rhs(t, x, fa, w);
    *where = at + d;
    rc = rc ? rc : gsl_rhs(t, x, fb, w);
    *where = at;
    for (int i = 0; i < n; i++) {
      double slope = (fb[i] - fa[i]) / (2 * d);
      *(j < n ? &dfdy[i * n + j] : &dfdt[i]) = slope;
    }
  }
  return rc;
}

/* Whether memory suffices for GSL's largest stepper, bsimp: GSL 2.7 does not check some of its allocations, and
 * writes to NULL. */
static int has_room(size_t n) {
  void *room = malloc((8 * n * n + 256 * n + 4096) * sizeof(double));
  free(room);
  return room != NULL;
}

static int init(void *work, lag_problem *pb, const double *opt) {
  const gsl_odeiv2_step_type *type = *(const gsl_odeiv2_step_type *const *)pb->variant;
  Gsl *w = work;
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  w->pb = pb;
  w->h_option = opt[0] > 0 ? opt[0] : 1e-6 * (pb->span > 0 ? pb->span : 10);
  w->h = w->h_option;
  w->system = (gsl_odeiv2_system){gsl_rhs, gsl_jacobian, (size_t)pb->n, w};
  w->driver = has_room((size_t)pb->n) ? gsl_odeiv2_driver_alloc_scaled_new(&w->system, type, pb->dir * w->h, pb->tol,
                                                                           pb->tol, 1, 0, pb->size)
                                      : NULL;
  gsl_set_error_handler(handler);
  pb->detail = "GSL: out of memory";
  return w->driver ? LAG_OK : LAG_ENOMEM;
}

static void reset(void *work, lag_problem *pb) {
  Gsl *w = work;
  (void)pb;
  gsl_odeiv2_driver_reset(w->driver);
  w->h = w->h_option;
}

/* The status of liblag for a failure of GSL. */
static int failure(Gsl *w, int rc, double t) {
  w->pb->detail = gsl_strerror(rc);
  if (w->fatal) return w->fatal;
  if (w->pb->bad_index >= 0) return LAG_ENAN;
  w->pb->bad_t = t;
  return LAG_EMETHOD;
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  Gsl *w = work;
  gsl_odeiv2_driver *d = w->driver;
  double at = *t, h = pb->dir * w->h, *y1 = array(w, Y1);
  size_t bytes = (size_t)pb->n * sizeof *y;
  unsigned long failed = d->e->failed_steps;
  gsl_error_handler_t *handler = gsl_set_error_handler_off();
  w->fatal = 0;
  pb->bad_index = -1;
  memcpy(y1, y, bytes);
  int rc = gsl_odeiv2_evolve_apply(d->e, d->c, d->s, &w->system, &at, t_stop, &h, y1);
  gsl_set_error_handler(handler);
  pb->rejected += (double)(d->e->failed_steps - failed);
  if (rc == GSL_SUCCESS && (pb->bad_index = lag_not_finite(pb->n, y1)) < 0 && at != *t) {
    memcpy(array(w, Y0), y, bytes);
    memcpy(y, y1, bytes);
    w->t0 = *t;
    w->t1 = *t = at;
    w->h = fabs(h);
    w->have_f = 0;
    return LAG_OK;
  }
  return failure(w, rc, *t);
}

/* Hermite interpolation. f at the ends is computed on the first call only, since most steps never need it. */
static void dense(void *work, lag_problem *pb, double t, double *y) {
  Gsl *w = work;
  double h = w->t1 - w->t0;
  if (!w->have_f) {
    lag_rhs(w->pb, w->t0, array(w, Y0), array(w, F0));
    lag_rhs(w->pb, w->t1, array(w, Y1), array(w, F1));
    w->have_f = 1;
  }
  lag_hermite(pb->nq, pb->nz, h, (t - w->t0) / h, array(w, Y0), array(w, F0), array(w, Y1), array(w, F1), y);
}

static void fini(void *work) {
  Gsl *w = work;
  gsl_odeiv2_driver_free(w->driver);
}

/* name in C, name, order, GSL's stepper, doc: with the names of GSL's other steppers, for whoever looks for them */
#define METHODS(X)                                                                                                  \
  X(rk8pd, "gsl-rk8pd", 8, gsl_odeiv2_step_rk8pd, "GSL: Prince-Dormand 8(9), explicit; for gsl-rkf45, gsl-msadams") \
  X(bsimp, "gsl-bsimp", 12, gsl_odeiv2_step_bsimp,                                                                  \
    "GSL: Bulirsch-Stoer-Bader-Deuflhard, implicit, for stiff models; for gsl-msbdf")

#define DEFINE(id, text, p, type, words)                                    \
  static const lag_method method_##id = {                                   \
      .name = text,                                                         \
      .order = p,                                                           \
      .dense_order = 4,                                                     \
      .doc = words,                                                         \
      .flags = LAG_METHOD_ADAPTIVE | LAG_METHOD_STEPS_TO | LAG_METHOD_NO_SAVE, \
      .noptions = 1,                                                        \
      .options = options,                                                   \
      .work_size = work_size,                                               \
      .init = init,                                                         \
      .step = step,                                                         \
      .dense = dense,                                                       \
      .reset = reset,                                                       \
      .fini = fini,                                                         \
      .variant = &type,                                                     \
  };
METHODS(DEFINE)

#define LIST(id, text, p, type, words) &method_##id,
const lag_method *const lag_gsl_methods[] = {METHODS(LIST)};
enum { NMETHODS = sizeof lag_gsl_methods / sizeof *lag_gsl_methods };
const int lag_gsl_nmethods = NMETHODS;

const lag_extras lag_gsl = {
    .methods = lag_gsl_methods, .nmethods = NMETHODS, .algebra = &lag_gsl_algebra, .points = points,
    .fits = &lag_gsl_least_squares};
