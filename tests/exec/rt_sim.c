/* A simulator as lagc would emit it, written by hand: for tests/exec/rt_app.sh. A ball that bounces with losses
 * (one event; closed form known), a pendulum (energy), and models that fail in known ways. */
#include <math.h>

#include "lag.h"

/* ---- ball: y'' = -g, bounces with restitution e; drag.c is a parameter of an effect */
static const lag_var ball_q[] = {{"y", "m", 1, 0, 0, 0}};
static const lag_var ball_p[] = {{"g", "m/s^2", 1, 0, 1, 0}, {"e", "", 1, 0, 2, 0}, {"drag.c", "1/s", 1, 0, 0, 0}};
static const lag_var ball_u[] = {{"wind", "m/s^2", 1, 0, 0, 0}};
static const lag_event ball_ev[] = {{"ground", -1}, {"apex", -1}};

static int ball_inputs(const void *self, double t, const double *p, double *u) {
  (void)self, (void)t, (void)p;
  u[0] = 0;
  return 0;
}

static int ball_accel(const void *self, double t, const double *q, const double *v, const double *z, const double *p,
                      const double *u, double *a, double *zd, double *w) {
  (void)self, (void)t, (void)q, (void)z, (void)zd, (void)w;
  a[0] = -p[0] - p[2] * v[0] + u[0];
  return 0;
}

static int ball_energy(const void *self, double t, const double *q, const double *v, const double *z, const double *p,
                       const double *u, double *e, double *w) {
  (void)self, (void)t, (void)z, (void)u, (void)w;
  e[0] = 0.5 * v[0] * v[0] + p[0] * q[0];
  e[1] = v[0] * v[0] + fabs(0.5 * v[0] * v[0] - p[0] * q[0]);
  return 0;
}

static int ball_events(const void *self, double t, const double *q, const double *v, const double *z, const double *p,
                       const double *u, double *g, double *w) {
  (void)self, (void)t, (void)z, (void)p, (void)u, (void)w;
  g[0] = q[0];
  g[1] = v[0];
  return 0;
}

static int ball_act(const void *self, int k, double t, const double *q, const double *v, const double *z,
                    const double *p, const double *u, double *q1, double *v1, double *z1, int *stop, double *w) {
  (void)self, (void)t, (void)q, (void)z, (void)u, (void)q1, (void)z1, (void)stop, (void)w;
  if (k == 0) {
    v1[0] = -p[1] * v[0];
  }
  return 0;
}

static const lag_model ball = {.abi = LAG_ABI,
                               .real_size = sizeof(double), .name = "ball", .doc = "", .effects = "drag", .flags = 0,
                               .nq = 1, .np = 3, .nu = 1, .nev = 2, .q = ball_q, .p = ball_p, .u = ball_u,
                               .ev = ball_ev, .inputs = ball_inputs, .accel = ball_accel, .energy = ball_energy,
                               .events = ball_events,
                               .act = ball_act};

static void ball_params(const void *self, double *p, const unsigned char *fixed) {
  (void)self;
  if (!fixed[0]) p[0] = 9.81;
  if (!fixed[1]) p[1] = 0.9;
  if (!fixed[2]) p[2] = 0;
}

static void ball_start(const void *self, const double *p, double *q, double *v, double *z) {
  (void)self;
  (void)p, (void)z;
  q[0] = 1;
  v[0] = 0;
}

static const lag_scene drop = {.name = "drop", .doc = "dropped from 1 m", .model = &ball, .params = ball_params,
    .start = ball_start, .t0 = 0, .t1 = 5, .has_span = 1, .tolerance = 1e-10};

/* ---- pendulum, angles in degrees; outputs with names that must be quoted */
static const lag_var pend_q[] = {{"th", "deg", 3.14159265358979323846 / 180, 1, 0, 0}};
static const lag_var pend_p[] = {{"l", "m", 1, 0, 1, 0}, {"g", "m/s^2", 1, 0, 1, 0}};
static const lag_var pend_out[] = {{"th", "deg", 3.14159265358979323846 / 180, 1, 0, 0},
                                   {"E \"total\", T+V", "J", 1, 0, 0, 0}};
static const lag_monitor pend_mon[] = {{"energy", -1, 1e-6, 0}, {"H", 1, 1e-6, 0}};

static int pend_accel(const void *self, double t, const double *q, const double *v, const double *z, const double *p,
                      const double *u, double *a, double *zd, double *w) {
  (void)self, (void)t, (void)v, (void)z, (void)u, (void)zd, (void)w;
  a[0] = -(p[1] / p[0]) * sin(q[0]);
  return 0;
}

static int pend_energy(const void *self, double t, const double *q, const double *v, const double *z, const double *p,
                       const double *u, double *e, double *w) {
  (void)self, (void)t, (void)z, (void)u, (void)w;
  double T = 0.5 * p[0] * p[0] * v[0] * v[0], V = -p[1] * p[0] * cos(q[0]);
  e[0] = T + V;
  e[1] = 2 * T + fabs(T - V);
  return 0;
}

static int pend_observe(const void *self, double t, const double *q, const double *v, const double *z, const double *p,
                        const double *u, double *out, double *w) {
  (void)self;
  double e[2];
  pend_energy(self, t, q, v, z, p, u, e, w);
  out[0] = q[0];
  out[1] = e[0];
  return 0;
}

static const lag_model pendulum = {.abi = LAG_ABI,
                                   .real_size = sizeof(double),
                                   .name = "pendulum",
                                   .doc = "",
                                   .effects = "",
                                   .flags = LAG_CONSERVES_ENERGY | LAG_CONSTANT_MASS | LAG_SEPARABLE,
                                   .nq = 1,
                                   .np = 2,
                                   .q = pend_q,
                                   .p = pend_p,
                                   .accel = pend_accel,
                                   .energy = pend_energy};

static void pend_params(const void *self, double *p, const unsigned char *fixed) {
  (void)self;
  if (!fixed[0]) p[0] = 1;
  if (!fixed[1]) p[1] = 9.81;
}

static void pend_start(const void *self, const double *p, double *q, double *v, double *z) {
  (void)self;
  (void)p, (void)z;
  q[0] = 1.5;
  v[0] = 0;
}

static const lag_option pend_opt[] = {{"step", 0.001, 0}};
static const lag_scene swing = {.name = "swing",
                                .doc = "", .model = &pendulum, .params = pend_params, .start = pend_start, .t0 = 0,
                                .t1 = 10, .has_span = 1, .every = 0.1, .nout = 2, .outputs = pend_out,
                                .observe = pend_observe, .nmonitors = 2,
                                .monitors = pend_mon};
static const lag_scene fixed_swing = {.name = "fixed",
                                      .doc = "", .model = &pendulum, .params = pend_params, .start = pend_start,
                                      .t0 = 0, .t1 = 10, .has_span = 1, .every = 0.1, .method = "rk4", .noptions = 1,
                                      .options = pend_opt};

/* ---- a force that becomes infinite at t = 1 */
static int wall_accel(const void *self, double t, const double *q, const double *v, const double *z, const double *p,
                      const double *u, double *a, double *zd, double *w) {
  (void)self;
  (void)q, (void)v, (void)z, (void)u, (void)zd, (void)w, (void)p;
  a[0] = sqrt(1 - t);
  return 0;
}

static const lag_model wall_model = {.abi = LAG_ABI,
                                     .real_size = sizeof(double), .name = "wall", .doc = "", .effects = "", .nq = 1,
                                     .np = 0, .q = ball_q,
                                     .accel = wall_accel};
static const lag_scene wall = {.name = "wall", .doc = "", .model = &wall_model, .start = ball_start, .t0 = 0, .t1 = 5,
    .has_span = 1, .every = 0.25};

static const lag_scene *const scenes[] = {&drop, &swing, &fixed_swing, &wall};
static const lag_program program = {"rt_sim", "hand-written", "models/rt_sim.lag", "drag moon", 4, scenes};

int main(int argc, char **argv)
{
#ifdef WITH_GSL
  return lag_app_main(argc, argv, &program, &lag_gsl);
#else
  return lag_app_main(argc, argv, &program, 0);
#endif
}
