/* Systems on which methods are measured, beside those of test_rt_models.h, and how a test takes steps of equal size. */
#ifndef TEST_RT_SYSTEMS_H
#define TEST_RT_SYSTEMS_H

#include "test_rt_models.h"

#define SEPARABLE (LAG_CONSERVES_ENERGY | LAG_CONSTANT_MASS | LAG_AUTONOMOUS | LAG_SEPARABLE)

/* name: accelerations, energy, start, flags, derivatives of L by hand from L on paper (or not) */
#define NO_DERIVATIVES .nsecond = 0
#define SYSTEM(name_, nq_, flags_, energy_, derivatives)                                                              \
  UNUSED static const lag_model name_##_model = {MODEL(#name_),          .flags = flags_,   .nq = nq_,  .q = names_q, \
                                                 .accel = name_##_accel, .energy = energy_, derivatives};             \
  UNUSED static const lag_scene name_ = {                                                                             \
      .name = #name_, .doc = "", .model = &name_##_model, .start = name_##_start, .t1 = 10, .has_span = 1}

/* ---- pendulum, g/l = 1, from 2.5 rad at rest */
UNUSED static int pendulum_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = -sin(q[0]);
  return 0;
}

UNUSED static int pendulum_energy(ARGS, double *e, UNUSED double *w)
{
  double T = v[0] * v[0] / 2, V = 2 * sin(q[0] / 2) * sin(q[0] / 2);
  e[0] = T + V;
  e[1] = 2 * T + fabs(T - V);
  return 0;
}

UNUSED static void pendulum_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 2.5;
  v[0] = 0;
}

/* L = v^2/2 + cos q */
UNIT_MASS(pendulum, pendulum_accel, cos(q[0]));
SYSTEM(pendulum, 1, SEPARABLE, pendulum_energy, EXACT(pendulum));

/* ---- Henon and Heiles (1964), E = 1/8 */
UNUSED static int henon_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = -q[0] - 2 * q[0] * q[1];
  a[1] = -q[1] - q[0] * q[0] + q[1] * q[1];
  return 0;
}

UNUSED static int henon_energy(ARGS, double *e, UNUSED double *w)
{
  double T = (v[0] * v[0] + v[1] * v[1]) / 2;
  double V = (q[0] * q[0] + q[1] * q[1]) / 2 + q[0] * q[0] * q[1] - q[1] * q[1] * q[1] / 3;
  e[0] = T + V;
  e[1] = 2 * T + fabs(T - V);
  return 0;
}

UNUSED static void henon_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 0;
  q[1] = -0.25;
  v[0] = 0.420812705765086581390141079878;
  v[1] = 0;
}

/* L = v.v/2 - (x^2 + y^2)/2 - x^2 y + y^3/3 */
FIRST(henon)
{
  memcpy(Lv, v, 2 * sizeof *v);
  Q[0] = Q[1] = 0;
  return henon_accel(self, t, q, v, z, p, u, Lq, NULL, w);
}

SECOND(henon)
{
  h[0] = -1 - 2 * q[1];
  h[1] = -2 * q[0];
  h[2] = -1 + 2 * q[1];
  h[3] = h[4] = 1;
  return 0;
}

#define henon_at kepler_at /* the same entries */
#define henon_dr full_2
#define henon_mass diagonal_2
UNIT_MASSES(henon);
SYSTEM(henon, 2, SEPARABLE, henon_energy, EXACT(henon));

/* ---- double pendulum, unit masses and lengths, g = 9.81: textbook equations, not separable */
UNUSED static int double_pendulum_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  double d = q[0] - q[1], g = 9.81, s = sin(d), c = cos(d), den = 2 - c * c;
  a[0] = (-g * 2 * sin(q[0]) + g * sin(q[1]) * c - s * (v[1] * v[1] + v[0] * v[0] * c)) / den;
  a[1] = (s * (2 * v[0] * v[0] + v[1] * v[1] * c) + 2 * g * (sin(q[0]) * c - sin(q[1]))) / den;
  return 0;
}

UNUSED static int double_energy(ARGS, double *e, UNUSED double *w)
{
  double T = v[0] * v[0] + v[1] * v[1] / 2 + v[0] * v[1] * cos(q[0] - q[1]), V = -9.81 * (2 * cos(q[0]) + cos(q[1]));
  e[0] = T + V;
  e[1] = 2 * T + fabs(T - V);
  return 0;
}

UNUSED static void double_pendulum_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 1;
  q[1] = -0.5;
  v[0] = v[1] = 0;
}

/* L = v1^2 + v2^2/2 + v1 v2 cos(q1 - q2) + g (2 cos q1 + cos q2) */
FIRST(double_pendulum)
{
  double d = q[0] - q[1], s = sin(d), c = cos(d), g = 9.81;
  Lq[0] = -v[0] * v[1] * s - 2 * g * sin(q[0]);
  Lq[1] = v[0] * v[1] * s - g * sin(q[1]);
  Lv[0] = 2 * v[0] + v[1] * c;
  Lv[1] = v[1] + v[0] * c;
  Q[0] = Q[1] = 0;
  return 0;
}

SECOND(double_pendulum)
{
  double d = q[0] - q[1], s = sin(d), c = cos(d), g = 9.81, vvc = v[0] * v[1] * c;
  h[0] = -vvc - 2 * g * cos(q[0]);
  h[1] = vvc;
  h[2] = -vvc - g * cos(q[1]);
  h[3] = -v[1] * s;
  h[4] = v[1] * s;
  h[5] = -v[0] * s;
  h[6] = v[0] * s;
  h[7] = 2;
  h[8] = c;
  h[9] = 1;
  return 0;
}

UNUSED static const lag_second double_pendulum_at[] = {{LAG_QQ, 0, 0}, {LAG_QQ, 1, 0}, {LAG_QQ, 1, 1}, {LAG_VQ, 0, 0},
                                                       {LAG_VQ, 0, 1}, {LAG_VQ, 1, 0}, {LAG_VQ, 1, 1}, {LAG_VV, 0, 0},
                                                       {LAG_VV, 1, 0}, {LAG_VV, 1, 1}};
/* r1 = -2 a1 - a2 cos d - v2^2 sin d - 2 g sin q1, r2 = -a2 - a1 cos d + v1^2 sin d - g sin q2, d = q1 - q2 */
LINEARISE(double_pendulum)
{
  double d = q[0] - q[1], s = sin(d), c = cos(d), g = 9.81;
  double e1 = a[1] * s - v[1] * v[1] * c, e2 = a[0] * s + v[0] * v[0] * c;
  dr[0] = e1 - 2 * g * cos(q[0]);
  dr[1] = -e1;
  dr[2] = -2 * v[1] * s;
  dr[3] = e2;
  dr[4] = -e2 - g * cos(q[1]);
  dr[5] = 2 * v[0] * s;
  M[0] = 2;
  M[1] = c;
  M[2] = 1;
  return 0;
}

UNUSED static const lag_entry double_pendulum_dr[] = {{0, 0}, {0, 1}, {0, 3}, {1, 0}, {1, 1}, {1, 2}};
#define double_pendulum_mass lower_2
LINEAR(double_pendulum);
SYSTEM(double_pendulum, 2, LAG_CONSERVES_ENERGY | LAG_AUTONOMOUS, double_energy, EXACT(double_pendulum));

/* ---- a pendulum that is driven, and whose support shakes: forces with explicit time */
UNUSED static int driven_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  a[0] = -sin(q[0]) * (1 + 0.5 * cos(2 * t)) + 0.3 * cos(t);
  return 0;
}

#define driven_start pendulum_start
UNIT_MASS(driven, driven_accel, cos(q[0]) * (1 + 0.5 * cos(2 * t)));
SYSTEM(driven, 1, LAG_CONSTANT_MASS | LAG_SEPARABLE, NULL, EXACT(driven));

/* Momenta of a model at y = [q|v]. */
UNUSED static void momenta(const lag_scene *scene, const double *y, double *p)
{
  double Lq[2], Q[2];
  int nq = scene->model->nq;
  assert_int_equal(scene->model->variation(scene->model, 0, y, y + nq, NULL, NULL, NULL, Lq, p, Q, NULL), 0);
}

/* ---- steps of equal size */

/* A simulation whose steps all have the size h. */
UNUSED static lag_sim *equal_steps(const lag_scene *scene, const lag_method *m, double h)
{
  lag_option opt[] = {{"step", h, NULL}, {"adapt", 0, "off"}};
  return sim_with(scene, m, 0, m->flags & LAG_METHOD_ADAPTIVE ? 2 : 1, opt);
}

/* A method with its options, but for the step. */
typedef struct Setting {
  const lag_method *method;
  lag_option option[2];
  int noptions;
  double within; /* for the test's own use */
} Setting;

UNUSED static lag_sim *sim_at(const lag_scene *scene, const Setting *k, double h)
{
  lag_option opt[3] = {{"step", h, NULL}, k->option[0], k->option[1]};
  return sim_with(scene, k->method, 0, 1 + k->noptions, opt);
}

/* Largest difference between components. */
UNUSED static double distance(int n, const double *a, const double *b)
{
  double d = 0;
  for (int i = 0; i < n; i++) {
    d = fmax(d, fabs(a[i] - b[i]));
  }
  return d;
}

/* The state, from y0, after time t in steps of size h (t/h is whole). */
UNUSED static void flow(const lag_scene *scene, const lag_method *m, double h, double t, const double *y0, double *y)
{
  static const char *const names[2][4] = {{"x", "x'"}, {"x", "y", "x'", "y'"}};
  int nq = scene->model->nq;
  lag_sim *s = equal_steps(scene, m, h);
  for (int i = 0; i < 2 * nq; i++) {
    assert_int_equal(lag_sim_set(s, names[nq - 1][i], y0[i]), 0);
  }
  assert_int_equal(lag_sim_advance(s, t), LAG_OK);
  memcpy(y, lag_sim_q(s), (size_t)(2 * nq) * sizeof *y);
  lag_sim_free(s);
}

#endif
