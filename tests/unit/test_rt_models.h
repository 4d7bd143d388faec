/* Models with known solutions, written by hand as lagc would emit them: for tests of the runtime. */
#ifndef TEST_RT_MODELS_H
#define TEST_RT_MODELS_H

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "lag.h"

#define UNUSED __attribute__((unused))
#define SELF UNUSED const void *self
#define STATE                                                                                                      \
  UNUSED double t, UNUSED const double *q, UNUSED const double *v, UNUSED const double *z, UNUSED const double *p, \
      UNUSED const double *u
#define ARGS SELF, STATE
#define MODEL(text) .abi = LAG_ABI, .real_size = sizeof(double), .name = text, .doc = "", .effects = ""

#include "test_rt_taylor.h"

/* The derivatives of L that implicit methods need: name_variation, name_second and name_at. */
#define FIRST(name) UNUSED static int name##_variation(ARGS, double *Lq, double *Lv, double *Q, UNUSED double *w)
#define SECOND(name) UNUSED static int name##_second(ARGS, double *h, UNUSED double *w)
#define DERIVATIVES(name) .variation = name##_variation, .second = name##_second, .second_at = name##_at, \
    .nsecond = (int)(sizeof name##_at / sizeof *name##_at)
/* The linearisation that radau needs: name_linearise with the entries name_dr, and those of M's lower triangle. */
#define LINEARISE(name) \
  UNUSED static int name##_linearise(ARGS, UNUSED const double *a, double *dr, double *M, UNUSED double *w)
#define LINEAR(name)                                                                                    \
  UNUSED static const lag_linear name##_linear = {.ndr = (int)(sizeof name##_dr / sizeof *name##_dr), .dr = name##_dr, \
      .nmass = (int)(sizeof name##_mass / sizeof *name##_mass), .mass = name##_mass, .eval = name##_linearise}
#define EXACT(name) DERIVATIVES(name), .linear = &name##_linear
/* And the series that taylor needs. */
#define ANALYTIC(name) EXACT(name), .taylor = &name##_taylor
UNUSED static const lag_entry full_2[] = {{0, 0}, {0, 1}, {1, 0}, {1, 1}}, diagonal_2[] = {{0, 0}, {1, 1}},
                              lower_2[] = {{0, 0}, {1, 0}, {1, 1}};

/* Of one coordinate with unit mass and a force that falls by `slope` with it. */
#define UNIT_MASS(name, accel, slope)                                             \
  FIRST(name) {                                                                   \
    Lv[0] = v[0];                                                                 \
    Q[0] = 0;                                                                     \
    return accel(self, t, q, v, z, p, u, Lq, NULL, w);                            \
  }                                                                               \
  SECOND(name) {                                                                  \
    h[0] = -(slope);                                                              \
    h[1] = 1;                                                                     \
    return 0;                                                                     \
  }                                                                               \
  LINEARISE(name) {                                                               \
    dr[0] = -(slope);                                                             \
    M[0] = 1;                                                                     \
    return 0;                                                                     \
  }                                                                               \
  UNUSED static const lag_entry name##_dr[] = {{0, 0}}, name##_mass[] = {{0, 0}}; \
  LINEAR(name);                                                                   \
  UNUSED static const lag_second name##_at[] = {{LAG_QQ, 0, 0}, {LAG_VV, 0, 0}}

static const double PI = 3.14159265358979323846264338327950288;
static const lag_var names_q[] = {{"x", "m", 1, 0, 0, 0}, {"y", "m", 1, 0, 0, 0}};
static const lag_var names_z[] = {{"z", "", 1, 0, 0, 0}};

#define assert_close(x, expected, tolerance)                                                            \
  do {                                                                                                  \
    double x_ = (x), e_ = (expected), t_ = (tolerance);                                                 \
    if (!(fabs(x_ - e_) <= t_)) {                                                                       \
      fail_msg("%s = %.17g, expected %.17g within %.3g, off by %.3g", #x, x_, e_, t_, x_ - e_);         \
    }                                                                                                   \
  } while (0)

/* ---- Kepler, GM = 1, a = 1, e = 0.6, from pericentre. */
static const double ecc = 0.6;

UNUSED static int kepler_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  double r2 = q[0] * q[0] + q[1] * q[1], k = 1 / (r2 * sqrt(r2));
  a[0] = -k * q[0];
  a[1] = -k * q[1];
  return 0;
}

UNUSED static int kepler_energy(ARGS, double *e, UNUSED double *w)
{
  double T = (v[0] * v[0] + v[1] * v[1]) / 2, V = -1 / hypot(q[0], q[1]);
  e[0] = T + V;
  e[1] = 2 * T + fabs(T - V);
  return 0;
}

UNUSED static void kepler_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 1 - ecc;
  q[1] = 0;
  v[0] = 0;
  v[1] = sqrt((1 + ecc) / (1 - ecc));
}

/* y[4] at time t, by Kepler's equation. */
UNUSED static void kepler_exact(double t, double *y)
{
  double E = t;
  for (int i = 0; i < 60; i++) {
    E -= (E - ecc * sin(E) - t) / (1 - ecc * cos(E));
  }
  double b = sqrt(1 - ecc * ecc), rate = 1 / (1 - ecc * cos(E));
  y[0] = cos(E) - ecc;
  y[1] = b * sin(E);
  y[2] = -sin(E) * rate;
  y[3] = b * cos(E) * rate;
}

/* L = v.v/2 + 1/|q| */
FIRST(kepler)
{
  double r2 = q[0] * q[0] + q[1] * q[1], k = 1 / (r2 * sqrt(r2));
  for (int i = 0; i < 2; i++) {
    Lq[i] = -k * q[i];
    Lv[i] = v[i];
    Q[i] = 0;
  }
  return 0;
}

SECOND(kepler)
{
  double r2 = q[0] * q[0] + q[1] * q[1], k = 1 / (r2 * sqrt(r2)), k3 = 3 * k / r2;
  h[0] = k3 * q[0] * q[0] - k;
  h[1] = k3 * q[0] * q[1];
  h[2] = k3 * q[1] * q[1] - k;
  h[3] = h[4] = 1;
  return 0;
}

UNUSED static const lag_second kepler_at[] = {
    {LAG_QQ, 0, 0}, {LAG_QQ, 1, 0}, {LAG_QQ, 1, 1}, {LAG_VV, 0, 0}, {LAG_VV, 1, 1}};

/* Of unit masses: r = dL/dq - a. */
#define UNIT_MASSES(name)                        \
  LINEARISE(name) {                              \
    double h[5];                                 \
    name##_second(self, t, q, v, z, p, u, h, w); \
    dr[0] = h[0];                                \
    dr[1] = dr[2] = h[1];                        \
    dr[3] = h[2];                                \
    M[0] = M[1] = 1;                             \
    return 0;                                    \
  }                                              \
  LINEAR(name)
#define kepler_dr full_2
#define kepler_mass diagonal_2
UNIT_MASSES(kepler);
TAYLOR(kepler, 2, 0);

/* Its one body, about the origin. */
UNUSED static int centre_values(ARGS, double *out, UNUSED double *w)
{
  out[0] = out[1] = 1;
  return 0;
}
UNUSED static const int planar[] = {0, 1};
UNUSED static const lag_kepler about_centre = {1, 2, 1, planar, centre_values};
/* Whether the method takes the models with bodies alone. */
#define OF_BODIES(m) (((m)->flags & LAG_METHOD_KEPLER) != 0)

UNUSED static const lag_model kepler_model = {MODEL("kepler"),
                                              .flags = LAG_CONSERVES_ENERGY | LAG_AUTONOMOUS | LAG_CONSTANT_MASS |
                                                       LAG_SEPARABLE | LAG_SMOOTH,
                                              .nq = 2, .q = names_q, .accel = kepler_accel, .energy = kepler_energy,
                                              .kepler = &about_centre, ANALYTIC(kepler)};
UNUSED static const lag_scene kepler = {
    .name = "orbit", .doc = "", .model = &kepler_model, .start = kepler_start, .t1 = 10, .has_span = 1};

/* ---- harmonic oscillator x'' = -x, x(0) = cos(phase): events x = 0, x = level, x = 0 rising. */
UNUSED static int osc_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = -q[0];
  return 0;
}

UNUSED static int osc_energy(ARGS, double *e, UNUSED double *w)
{
  e[0] = (q[0] * q[0] + v[0] * v[0]) / 2;
  e[1] = v[0] * v[0] + fabs(v[0] * v[0] - q[0] * q[0]) / 2;
  return 0;
}

UNUSED static void osc_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 1;
  v[0] = 0;
}

UNIT_MASS(osc, osc_accel, 1);
TAYLOR_LINEAR(osc, 1, 0);
UNUSED static const lag_model osc_model = {MODEL("oscillator"),
                                           .flags =
                                               LAG_CONSERVES_ENERGY | LAG_CONSTANT_MASS | LAG_SEPARABLE | LAG_SMOOTH,
                                           .nq = 1, .q = names_q, .accel = osc_accel, .energy = osc_energy,
                                           ANALYTIC(osc)};
UNUSED static const lag_scene osc = {
    .name = "osc", .doc = "", .model = &osc_model, .start = osc_start, .t1 = 10, .has_span = 1};

/* ---- ball: y'' = -g, y(0) = h, bounces with restitution e. p = {g, h, e}. */
static const lag_var ball_p[] = {{"g", "m/s^2", 1, 0, 1, 0}, {"h", "cm", 0.01, 0, 1, 0}, {"ground.e", "", 1, 0, 2, 0}};
static const lag_event ball_ev[] = {{"ground", -1}};

UNUSED static int ball_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = -p[0];
  return 0;
}

UNUSED static int ball_energy(ARGS, double *e, UNUSED double *w)
{
  e[0] = v[0] * v[0] / 2 + p[0] * q[0];
  e[1] = v[0] * v[0] + fabs(v[0] * v[0] / 2 - p[0] * q[0]);
  return 0;
}

UNUSED static int ball_events(ARGS, double *g, UNUSED double *w)
{
  g[0] = q[0];
  return 0;
}

UNUSED static int ball_act(SELF, UNUSED int k, STATE, UNUSED double *q1, double *v1, UNUSED double *z1,
                           UNUSED int *stop, UNUSED double *w) {
  v1[0] = -p[2] * v[0];
  return 0;
}

UNUSED static void ball_params(SELF, double *p, const unsigned char *fixed) {
  static const double value[] = {9.81, 1, 0.9};
  for (int i = 0; i < 3; i++) {
    p[i] = fixed[i] ? p[i] : value[i];
  }
}

UNUSED static void ball_start(SELF, const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = p[1];
  v[0] = 0;
}

UNIT_MASS(ball, ball_accel, 0);
TAYLOR_LINEAR(ball, 0, 0);
UNUSED static const lag_model ball_model = {MODEL("ball"),
                                            .flags =
                                                LAG_CONSERVES_ENERGY | LAG_CONSTANT_MASS | LAG_SEPARABLE | LAG_SMOOTH,
                                            .nq = 1, .np = 3, .nev = 1, .q = names_q + 1, .p = ball_p, .ev = ball_ev,
                                            .accel = ball_accel, .energy = ball_energy, .events = ball_events,
                                            .act = ball_act,
                                            ANALYTIC(ball)};
UNUSED static const lag_scene ball = {.name = "drop", .doc = "", .model = &ball_model, .params = ball_params,
    .start = ball_start, .t1 = 5, .has_span = 1};

/* ---- a state alone: z' = f(t, z), chosen by each test through a static function. */
#define FLOW(name_, f_)                                                                                  \
  static int name_##_accel(ARGS, UNUSED double *a, double *zd, UNUSED double *w) { return f_; }          \
  static const lag_model name_##_model = {MODEL(#name_), .nz = 1, .z = names_z, .accel = name_##_accel}; \
  static const lag_scene name_ = {                                                                       \
      .name = #name_, .doc = "", .model = &name_##_model, .start = flow_start, .t1 = 5, .has_span = 1}

UNUSED static void flow_start(SELF, UNUSED const double *p, UNUSED double *q, UNUSED double *v, double *z) { z[0] = 1; }

/* A simulation with a method and one option; tol 0: the default. */
UNUSED static lag_sim *sim_with(const lag_scene *scene, const lag_method *m, double tol, int nopt,
                                const lag_option *opt) {
  lag_sim *s = lag_sim_new(scene);
  assert_non_null(s);
  if (tol > 0) {
    assert_int_equal(lag_sim_set_tolerance(s, tol), 0);
  }
  assert_int_equal(lag_sim_set_method(s, m, opt, nopt), 0);
  return s;
}

#endif
