/* Models with constraints and known motions, written by hand as lagc would emit them. */
#ifndef TEST_RT_CONSTRAINED_H
#define TEST_RT_CONSTRAINED_H

#include "lag_kkt.h"
#include "test_rt_systems.h"

enum { MOST_Q = 6, MOST_C = 3 };

#define RESIDUALS(name) static int name##_residuals(ARGS, UNUSED double *c, double *r, UNUSED double *w)
#define MATRICES(name) static int name##_matrices(ARGS, double *A, double *M, UNUSED double *w)

/* Least changes by the solver that emitted code has, of a model whose A and M are of these sizes; M is diagonal. */
static inline int least(int nq, int n, int nj, const lag_entry *at, const double *A, const double *M, const double *g,
                        double *d, double *force) {
  double w[2 * (MOST_Q * MOST_Q + MOST_C * MOST_Q) + 3 * MOST_Q + MOST_C + MOST_C * MOST_C + 9 * MOST_C] = {0};
  double *rows = w + nq * nq, *x = rows + n * nq, *l = x + nq;
  for (int i = 0; i < nq; i++) {
    w[i * nq + i] = M[i];
  }
  for (int e = 0; e < nj && at[e].row < n; e++) {
    rows[at[e].row * nq + at[e].col] = A[e];
  }
  memcpy(l, g, (size_t)n * sizeof *g);
  if (!lag_kkt(nq, n, 0, w)) {
    return LAG_ESINGULAR;
  }
  memcpy(d, x, (size_t)nq * sizeof *d);
  for (int i = 0; i < nq; i++) {
    force[i] = M[i] * d[i];
  }
  return 0;
}

/* nq coordinates, nc constraints, nh of them holonomic, nj entries of A. */
#define CONSTRAINED(name_, nq_, nc_, nh_, nj_)                                              \
  static int name_##_position(ARGS, const double *g, double *d, double *force, double *w) { \
    double A[nj_], M[nq_];                                                                  \
    name_##_matrices(self, t, q, v, z, p, u, A, M, w);                                      \
    return least(nq_, nh_, nj_, name_##_jacobian, A, M, g, d, force);                       \
  }                                                                                         \
  static int name_##_velocity(ARGS, const double *g, double *d, double *force, double *w) { \
    double A[nj_], M[nq_];                                                                  \
    name_##_matrices(self, t, q, v, z, p, u, A, M, w);                                      \
    return least(nq_, nc_, nj_, name_##_jacobian, A, M, g, d, force);                       \
  }                                                                                         \
  static const lag_constraints name_##_held = {.n = nc_,                                    \
                                               .nholonomic = nh_,                           \
                                               .of = name_##_of,                            \
                                               .njacobian = nj_,                            \
                                               .jacobian = name_##_jacobian,                \
                                               .nmass = nq_,                                \
                                               .mass = diagonal,                            \
                                               .residuals = name_##_residuals,              \
                                               .matrices = name_##_matrices,                \
                                               .position = name_##_position,                \
                                               .velocity = name_##_velocity}

#define HELD(name_, nq_, flags_, energy_, derivatives)                                                          \
  static const lag_model name_##_model = {MODEL(#name_), .flags = flags_, .nq = nq_, .q = name_##_q,           \
      .accel = name_##_accel, .energy = energy_, .constraints = &name_##_held, derivatives};                    \
  UNUSED static const lag_scene name_ = {.name = #name_, .doc = "", .model = &name_##_model, .start = name_##_start, \
      .t1 = 10, .has_span = 1}

static const lag_entry diagonal[] = {{0, 0}, {1, 1}, {2, 2}, {3, 3}, {4, 4}};

/* Unit masses and L = v.v/2 + G.q: a_i = G_i. */
#define FREE_FALL(name, n, ...)                                                                                 \
  UNUSED static int name##_variation(ARGS, double *Lq, double *Lv, double *Q, UNUSED double *w)                  \
  {                                                                                                            \
    const double G[n] = __VA_ARGS__, mass[n] = name##_masses;                                                   \
    for (int i = 0; i < n; i++) {                                                                              \
      Lq[i] = G[i];                                                                                            \
      Lv[i] = mass[i] * v[i];                                                                                   \
      Q[i] = 0;                                                                                                 \
    }                                                                                                          \
    return 0;                                                                                                  \
  }                                                                                                            \
  UNUSED static int name##_second(ARGS, double *h, UNUSED double *w)                                            \
  {                                                                                                            \
    const double mass[n] = name##_masses;                                                                       \
    memcpy(h, mass, sizeof mass);                                                                               \
    return 0;                                                                                                  \
  }                                                                                                            \
  UNUSED static int name##_energy(ARGS, double *e, UNUSED double *w)                                            \
  {                                                                                                            \
    const double G[n] = __VA_ARGS__, mass[n] = name##_masses;                                                   \
    double T = 0, V = 0;                                                                                       \
    for (int i = 0; i < n; i++) {                                                                              \
      T += mass[i] * v[i] * v[i] / 2;                                                                           \
      V -= G[i] * q[i];                                                                                        \
    }                                                                                                          \
    e[0] = T + V;                                                                                              \
    e[1] = 2 * T + fabs(T - V);                                                                                 \
    return 0;                                                                                                  \
  }
static const lag_second masses_at[] = {{LAG_VV, 0, 0}, {LAG_VV, 1, 1}, {LAG_VV, 2, 2}, {LAG_VV, 3, 3}, {LAG_VV, 4, 4}};
#define FALLS(name, n) .variation = name##_variation, .second = name##_second, .second_at = masses_at, .nsecond = n

/* ---- rod: a point at the end of a rod of length 1, x^2 + y^2 = 1, g = 9.81 */
#define rod_masses {1, 1}
static const lag_var rod_q[] = {{"x", "m", 1, 0, 0, 0}, {"y", "m", 1, 0, 0, 0}};
static const lag_constraint rod_of[] = {{"rod", 1, "m^2", 7}};
static const lag_entry rod_jacobian[] = {{0, 0}, {0, 1}};
FREE_FALL(rod, 2, {0, -9.81})

RESIDUALS(rod)
{
  c[0] = q[0] * q[0] + q[1] * q[1] - 1;
  r[0] = 2 * (q[0] * v[0] + q[1] * v[1]);
  return 0;
}

MATRICES(rod)
{
  A[0] = 2 * q[0];
  A[1] = 2 * q[1];
  M[0] = M[1] = 1;
  return 0;
}

static int rod_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  double l = (9.81 * q[1] - v[0] * v[0] - v[1] * v[1]) / (q[0] * q[0] + q[1] * q[1]);
  a[0] = l * q[0];
  a[1] = l * q[1] - 9.81;
  return 0;
}

static void rod_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 1;
  q[1] = v[0] = v[1] = 0;
}

CONSTRAINED(rod, 2, 1, 1, 2);
HELD(rod, 2, LAG_CONSERVES_ENERGY | LAG_CONSTANT_MASS | LAG_AUTONOMOUS | LAG_SMOOTH, rod_energy, FALLS(rod, 2));

/* ---- twice: the same rod, stated twice */
static const lag_constraint twice_of[] = {{"rod", 1, "m^2", 7}, {"again", 1, "m^2", 8}};
static const lag_entry twice_jacobian[] = {{0, 0}, {0, 1}, {1, 0}, {1, 1}};

RESIDUALS(twice)
{
  rod_residuals(self, t, q, v, z, p, u, c, r, w);
  c[1] = 3 * q[0] * q[0] + 3 * q[1] * q[1] - 3;
  r[1] = 6 * (q[0] * v[0] + q[1] * v[1]);
  return 0;
}

MATRICES(twice)
{
  rod_matrices(self, t, q, v, z, p, u, A, M, w);
  A[2] = 6 * q[0];
  A[3] = 6 * q[1];
  return 0;
}

#define twice_q rod_q
#define twice_accel rod_accel
#define twice_start rod_start
CONSTRAINED(twice, 2, 2, 2, 4);
HELD(twice, 2, LAG_CONSERVES_ENERGY | LAG_CONSTANT_MASS | LAG_AUTONOMOUS | LAG_SMOOTH, rod_energy, FALLS(rod, 2));

/* ---- reel: without gravity, on a string that gets longer, x^2 + y^2 = (1 + t/2)^2: the angular momentum, 2, stays,
 * and the angle is 4 (1 - 1/(1 + t/2)) */
#define reel_masses {1, 1}
static const lag_constraint reel_of[] = {{"string", 1, "m^2", 3}};
FREE_FALL(reel, 2, {0, 0})

RESIDUALS(reel)
{
  double l = 1 + t / 2;
  c[0] = q[0] * q[0] + q[1] * q[1] - l * l;
  r[0] = 2 * (q[0] * v[0] + q[1] * v[1]) - l;
  return 0;
}

static int reel_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  double k = (0.25 - v[0] * v[0] - v[1] * v[1]) / (q[0] * q[0] + q[1] * q[1]); /* q.a + v.v = l'^2 */
  a[0] = k * q[0];
  a[1] = k * q[1];
  return 0;
}

static void reel_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  q[0] = 1;
  q[1] = 0;
  v[0] = 0.5;
  v[1] = 2;
}

#define reel_q rod_q
#define reel_jacobian rod_jacobian
#define reel_matrices rod_matrices
CONSTRAINED(reel, 2, 1, 1, 2);
HELD(reel, 2, LAG_CONSTANT_MASS | LAG_SMOOTH, reel_energy, FALLS(reel, 2));

static inline void reel_exact(double t, double *y)
{
  double l = 1 + t / 2, a = 4 * (1 - 1 / l), w = 2 / (l * l);
  y[0] = l * cos(a);
  y[1] = l * sin(a);
  y[2] = 0.5 * cos(a) - w * y[1];
  y[3] = 0.5 * sin(a) + w * y[0];
}

/* ---- turntable: a solid ball of radius 1 rolls on a plane that turns with 1 rad/s; its centre moves on a circle
 * with 2/7 of that. x' - b' = -y, y' + a' = x with the angles a and b about x and y. E.J. Routh, Dynamics of a
 * System of Rigid Bodies, Advanced Part (1905), art. 224 */
#define turntable_masses {1, 1, 0.4, 0.4}
static const lag_var turntable_q[] = {
    {"x", "", 1, 0, 0, 0}, {"y", "", 1, 0, 0, 0}, {"a", "", 1, 0, 0, 0}, {"b", "", 1, 0, 0, 0}};
static const lag_constraint turntable_of[] = {{"roll.x", 0, "m/s", 4}, {"roll.y", 0, "m/s", 4}};
static const lag_entry turntable_jacobian[] = {{0, 0}, {0, 3}, {1, 1}, {1, 2}};
FREE_FALL(turntable, 4, {0, 0, 0, 0})

RESIDUALS(turntable)
{
  r[0] = v[0] - v[3] + q[1];
  r[1] = v[1] + v[2] - q[0];
  return 0;
}

MATRICES(turntable)
{
  A[0] = A[2] = A[3] = M[0] = M[1] = 1;
  A[1] = -1;
  M[2] = M[3] = 0.4;
  return 0;
}

static int turntable_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  double l0 = -v[1] / 3.5, l1 = v[0] / 3.5;
  a[0] = l0;
  a[1] = l1;
  a[2] = l1 / 0.4;
  a[3] = -l0 / 0.4;
  return 0;
}

static void turntable_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  memset(q, 0, 4 * sizeof *q);
  q[0] = 0.3;
  v[0] = 0.5;
  v[1] = 0.2;
  v[2] = q[0] - v[1];
  v[3] = v[0] + q[1];
}

CONSTRAINED(turntable, 4, 2, 0, 4);
HELD(turntable, 4, LAG_CONSTANT_MASS | LAG_AUTONOMOUS | LAG_SMOOTH, turntable_energy, FALLS(turntable, 4));

static inline void turntable_exact(double t, double *y)
{
  double w = 2.0 / 7, s = sin(w * t), c = cos(w * t);
  y[4] = 0.5 * c - 0.2 * s; /* a and b are not told */
  y[5] = 0.5 * s + 0.2 * c;
  y[0] = 0.3 + (0.5 * s - 0.2 * (1 - c)) / w;
  y[1] = (0.5 * (1 - c) + 0.2 * s) / w;
}

/* ---- knife: a knife edge on an inclined plane, x' sin f = y' cos f, from rest and turning with 1 rad/s: x = G/2
 * sin^2 t, y = G/2 (t - sin(2 t)/2), and it stays on the same height on average. J.I. Neimark, N.A. Fufaev, Dynamics
 * of Nonholonomic Systems (1972), ch. I.6 */
#define knife_masses {1, 1, 0.5}
static const lag_var knife_q[] = {{"x", "", 1, 0, 0, 0}, {"y", "", 1, 0, 0, 0}, {"f", "", 1, 0, 0, 0}};
static const lag_constraint knife_of[] = {{"edge", 0, "m/s", 5}};
static const lag_entry knife_jacobian[] = {{0, 0}, {0, 1}};
FREE_FALL(knife, 3, {2, 0, 0})

RESIDUALS(knife)
{
  r[0] = v[0] * sin(q[2]) - v[1] * cos(q[2]);
  return 0;
}

MATRICES(knife)
{
  A[0] = sin(q[2]);
  A[1] = -cos(q[2]);
  M[0] = M[1] = 1;
  M[2] = 0.5;
  return 0;
}

static int knife_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w)
{
  double s = sin(q[2]), c = cos(q[2]), l = -v[2] * (c * v[0] + s * v[1]) - 2 * s;
  a[0] = 2 + l * s;
  a[1] = -l * c;
  a[2] = 0;
  return 0;
}

static void knife_start(SELF, UNUSED const double *p, double *q, double *v, UNUSED double *z) {
  memset(q, 0, 3 * sizeof *q);
  memset(v, 0, 3 * sizeof *v);
  v[2] = 1;
}

CONSTRAINED(knife, 3, 1, 0, 2);
HELD(knife, 3, LAG_CONSERVES_ENERGY | LAG_CONSTANT_MASS | LAG_AUTONOMOUS | LAG_SMOOTH, knife_energy, FALLS(knife, 3));

static inline void knife_exact(double t, double *y)
{
  y[0] = sin(t) * sin(t);
  y[1] = t - sin(2 * t) / 2;
  y[2] = t;
  y[3] = sin(2 * t);
  y[4] = 1 - cos(2 * t);
  y[5] = 1;
}

#endif
