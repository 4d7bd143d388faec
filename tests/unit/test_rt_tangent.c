/* The tangent of the flow: exact against closed forms, the digits of variational equations integrated by mpmath, and
 * central differences of the very map that a method computes; what follows from it: symplecticity, volume, time
 * reversal; that the run is the same with it and without; what is refused. */
#include "test_rt_systems.h"

enum { MOST = 16 };

static const lag_method *const symplectic[] = {&lag_symplectic_euler, &lag_verlet,      &lag_verlet4, &lag_verlet6,
                                               &lag_verlet8,          &lag_variational, &lag_gauss};
static const lag_method *const others[] = {&lag_euler, &lag_rk4, &lag_rk45, &lag_dop853, &lag_radau};
enum {
  SYMPLECTIC = sizeof symplectic / sizeof *symplectic,
  OTHERS = sizeof others / sizeof *others,
  ALL = SYMPLECTIC + OTHERS
};

static const lag_method *method_at(int i) {
  return i < SYMPLECTIC ? symplectic[i] : others[i - SYMPLECTIC];
}

static void set_start(lag_sim *s, const double *y) {
  static const char *const names[2][4] = {{"x", "x'"}, {"x", "y", "x'", "y'"}};
  int nq = lag_sim_scene(s)->model->nq;
  for (int i = 0; i < 2 * nq; i++)
    assert_int_equal(lag_sim_set(s, names[nq - 1][i], y[i]), 0);
}

/* J[n * n] := dy(t)/dy(0) of steps of size h from y0; y := the state there, unless NULL. */
static void tangent(const lag_scene *scene, const lag_method *m, double h, double t, const double *y0, double *y,
                    double *J) {
  lag_sim *s = equal_steps(scene, m, h);
  int n = 2 * scene->model->nq;
  set_start(s, y0);
  assert_int_equal(lag_sim_set_tangent(s, n, NULL), 0);
  assert_int_equal(lag_sim_advance(s, t), LAG_OK);
  assert_int_equal(lag_sim_tangent(s, J), 0);
  if (y)
    memcpy(y, lag_sim_q(s), (size_t)n * sizeof *y);
  lag_sim_free(s);
}

/* The same of a method that chooses its steps. */
static void tangent_tol(const lag_scene *scene, const lag_method *m, double tol, double t, const double *y0,
                        double *J) {
  lag_sim *s = sim_with(scene, m, tol, 0, NULL);
  set_start(s, y0);
  assert_int_equal(lag_sim_set_tangent(s, 2 * scene->model->nq, NULL), 0);
  assert_int_equal(lag_sim_advance(s, t), LAG_OK);
  assert_int_equal(lag_sim_tangent(s, J), 0);
  lag_sim_free(s);
}

/* ---- Closed forms */

static void oscillator_turns(void **state) {
  const double y0[] = {0.3, -1}, t = 3.7, turn[] = {cos(t), sin(t), -sin(t), cos(t)};
  /* of rk45, dop853 at 1e-13, and radau at 1e-12, whose steps are for y */
  static const double within[] = {1e-10, 1e-12, 1e-9};
  static const lag_method *const adaptive[] = {&lag_rk45, &lag_dop853, &lag_radau};
  double J[4];
  (void)state;
  for (int m = 0; m < 3; m++) {
    tangent_tol(&osc, adaptive[m], m == 2 ? 1e-12 : 1e-13, t, y0, J);
    assert_close(distance(4, J, turn), 0, within[m]);
  }
}

static void multiply(int n, const double *A, const double *B, double *C) {
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) {
      double s = 0;
      for (int k = 0; k < n; k++)
        s += A[i * n + k] * B[k * n + j];
      C[i * n + j] = s;
    }
  }
}

/* Of a linear model the derivative of a step is its matrix: Verlet's, the midpoint rule's (I - hA/2)^-1 (I + hA/2),
 * Kutta's exp(hA) to fourth order. */
static void matrices_of_linear_steps(void **state) {
  const double h = 0.25, y0[] = {0.3, -1}, d = 1 + h * h / 4, even = 1 - h * h / 2 + h * h * h * h / 24,
               odd = h - h * h * h / 6;
  const struct {
    const lag_method *method;
    double one[4];
  } steps[] = {
      {&lag_verlet, {1 - h * h / 2, h, -h * (1 - h * h / 4), 1 - h * h / 2}},
      {&lag_symplectic_euler, {1 - h * h, h, -h, 1}},
      {&lag_variational, {(1 - h * h / 4) / d, h / d, -h / d, (1 - h * h / 4) / d}},
      {&lag_rk4, {even, odd, -odd, even}},
      {&lag_euler, {1, h, -h, 1}},
  };
  (void)state;
  for (size_t i = 0; i < sizeof steps / sizeof *steps; i++) {
    double J[4], want[4] = {1, 0, 0, 1}, next[4];
    tangent(&osc, steps[i].method, h, 8 * h, y0, NULL, J);
    for (int k = 0; k < 8; k++) {
      multiply(2, steps[i].one, want, next);
      memcpy(want, next, sizeof want);
    }
    assert_close(distance(4, J, want), 0, 1e-14);
  }
}

/* x'' = -x - x'/5 */
static int damped_accel(ARGS, double *a, UNUSED double *zd, UNUSED double *w) {
  a[0] = -q[0] - 0.2 * v[0];
  return 0;
}

LINEARISE(damped) {
  dr[0] = -1;
  dr[1] = -0.2;
  M[0] = 1;
  return 0;
}

FIRST(damped) {
  Lq[0] = -q[0];
  Lv[0] = v[0];
  Q[0] = -0.2 * v[0];
  return 0;
}

SECOND(damped) {
  h[0] = -1;
  h[1] = 1;
  h[2] = -0.2;
  return 0;
}

static const lag_second damped_at[] = {{LAG_QQ, 0, 0}, {LAG_VV, 0, 0}, {LAG_FV, 0, 0}};
static const lag_entry damped_dr[] = {{0, 0}, {0, 1}}, damped_mass[] = {{0, 0}};
LINEAR(damped);
#define damped_start osc_start
SYSTEM(damped, 1, LAG_CONSTANT_MASS | LAG_AUTONOMOUS, NULL, EXACT(damped));

static void damped_oscillator(void **state) {
  const double y0[] = {1, 0}, t = 4, c = 0.1, w = sqrt(1 - c * c), e = exp(-c * t), C = e * cos(w * t),
               S = e * sin(w * t) / w;
  const double want[] = {C + c * S, S, -S, C - c * S};
  double J[4];
  (void)state;
  tangent_tol(&damped, &lag_dop853, 1e-13, t, y0, J);
  assert_close(distance(4, J, want), 0, 1e-12);
  assert_close(J[0] * J[3] - J[1] * J[2], exp(-2 * c * t), 1e-12); /* Liouville */
  tangent(&damped, &lag_verlet8, 0.125, t, y0, NULL, J);
  assert_close(distance(4, J, want), 0, 1e-9); /* its own error at this step */
}

/* Y' = Df Y by Taylor series with 30 digits (mpmath's odefun): Kepler, e = 0.6, from the pericentre to t = 2; the
 * pendulum from 3 at rest to t = 5. */
static void published_digits(void **state) {
  static const double orbit[] = {
      -4.529741573854750987436, 1.621301187593417431408,  0.5933650023569488197481, -1.869824251035214602912,
      18.97815706467760974298,  5.036188407217134288068,  1.67716720501291264456,   5.823298645505206873168,
      -11.62559811086058320322, -1.114558359875467963963, -0.4278707804233113189742, -3.547976715432001464607,
      11.16259427369318833165,  1.702993098995816777847,  0.5735630645712109858743, 3.723729734293752288413};
  static const double swing[] = {9.258339196896410256779, 9.427493318920963982092, -7.026627744285790020709,
                                 -7.046996737348957355676};
  const double peri[] = {0.4, 0, 0, 2}, high[] = {3, 0};
  double J[MOST];
  (void)state;
  tangent_tol(&kepler, &lag_dop853, 1e-14, 2, peri, J);
  assert_close(distance(16, J, orbit), 0, 1e-11); /* of 19 */
  tangent(&kepler, &lag_verlet8, 0x1p-7, 2, peri, NULL, J);
  assert_close(distance(16, J, orbit), 0, 1e-9);
  lag_option opt[] = {{"stages", 4, NULL}, {"step", 0x1p-5, NULL}};
  lag_sim *s = sim_with(&kepler, &lag_gauss, 0, 2, opt);
  set_start(s, peri);
  assert_int_equal(lag_sim_set_tangent(s, 4, NULL), 0);
  assert_int_equal(lag_sim_advance(s, 2), LAG_OK);
  assert_int_equal(lag_sim_tangent(s, J), 0);
  lag_sim_free(s);
  print_message("# gauss of order 8, 64 steps: %.1e\n", distance(16, J, orbit));
  assert_close(distance(16, J, orbit), 0, 1e-9); /* its own error at this step */
  tangent_tol(&pendulum, &lag_dop853, 1e-14, 5, high, J);
  assert_close(distance(4, J, swing), 0, 2e-12);
  tangent_tol(&kepler, &lag_taylor_method, 1e-14, 2, peri, J);
  print_message("# taylor: %.1e\n", distance(16, J, orbit));
  assert_close(distance(16, J, orbit), 0, 1e-11);
  tangent_tol(&kepler, &lag_taylor_method, 1e-6, 2, peri, J);
  assert_close(distance(16, J, orbit), 0, 1e-3);
  tangent_tol(&osc, &lag_taylor_method, 1e-14, 3.7, high, J);
  assert_close(J[0], cos(3.7), 1e-13);
  assert_close(J[1], sin(3.7), 1e-13);
}

/* ---- The derivative of the map itself, by central differences of order 8: rounding 1e-15/0.02, truncation
 * 0.02^8/630 times a ninth derivative of the map. */

static void differences(const lag_scene *scene, const lag_method *m, double h, double t, const double *y0, double *J) {
  static const double weight[4] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
  int n = 2 * scene->model->nq;
  double delta = 0.01;
  memset(J, 0, (size_t)(n * n) * sizeof *J);
  for (int j = 0; j < n; j++) {
    for (int k = 0; k < 8; k++) {
      double at[4], out[4], sign = k < 4 ? 1 : -1;
      memcpy(at, y0, (size_t)n * sizeof *at);
      at[j] += sign * (k % 4 + 1) * delta;
      flow(scene, m, h, t, at, out);
      for (int i = 0; i < n; i++)
        J[i * n + j] += sign * weight[k % 4] * out[i] / delta;
    }
  }
}

/* Starts well away from where the maps are not smooth, and steps so long that a wrong derivative could not hide. */
static const struct {
  const lag_scene *scene;
  double h, y0[4];
} maps[] = {
    {&pendulum, 0.25, {2, 0.7}},
    {&henon, 0.25, {0.1, -0.25, 0.4, 0.1}},
    {&kepler, 0.125, {-1.5, -0.28, 0.22, -0.48}},
    {&double_pendulum, 0.0625, {1, -0.5, 0.3, 0.6}},
    {&driven, 0.25, {2, 0.7}},
    {&damped, 0.25, {1, 0.5}},
};
enum { MAPS = sizeof maps / sizeof *maps };

static void derivative_of_the_map(void **state) {
  (void)state;
  for (int m = 0; m < ALL; m++) {
    double worst = 0;
    for (int k = 0; k < MAPS; k++) {
      int n = 2 * maps[k].scene->model->nq;
      double J[MOST], D[MOST];
      tangent(maps[k].scene, method_at(m), maps[k].h, 4 * maps[k].h, maps[k].y0, NULL, J);
      differences(maps[k].scene, method_at(m), maps[k].h, 4 * maps[k].h, maps[k].y0, D);
      worst = fmax(worst, distance(n * n, J, D));
    }
    print_message("# %-16s from differences of its map: %.1e\n", method_at(m)->name, worst);
    /* radau solves its equations to its tolerance, 1e-9 */
    assert_close(worst, 0, method_at(m) == &lag_radau ? 1e-8 : 1e-12);
  }
}

/* And of the method's options. */
static void derivative_of_higher_orders(void **state) {
  const struct {
    const lag_method *method;
    lag_option opt[3];
    int nopt;
  } tries[] = {{&lag_gauss, {{"step", 0.0625, NULL}, {"stages", 4, NULL}}, 2},
               {&lag_gauss, {{"step", 0.0625, NULL}, {"stages", 1, NULL}}, 2},
               {&lag_variational, {{"step", 0.0625, NULL}, {"order", 6, NULL}}, 2}};
  const double y0[] = {1, -0.5, 0.3, 0.6};
  (void)state;
  for (size_t i = 0; i < sizeof tries / sizeof *tries; i++) {
    double J[MOST], slope[4] = {0}, delta = 4e-3;
    const double weight[] = {-1.0 / 60, 0.15, -0.75, 0, 0.75, -0.15, 1.0 / 60};
    for (int step = -3; step <= 3; step++) {
      double at[4] = {y0[0] + step * delta, y0[1], y0[2], y0[3]};
      lag_sim *s = sim_with(&double_pendulum, tries[i].method, 0, tries[i].nopt, tries[i].opt);
      set_start(s, at);
      assert_int_equal(lag_sim_set_tangent(s, 4, NULL), 0);
      assert_int_equal(lag_sim_advance(s, 0.25), LAG_OK);
      for (int k = 0; k < 4; k++) slope[k] += weight[step + 3] * lag_sim_q(s)[k] / delta;
      if (step == 0)
        assert_int_equal(lag_sim_tangent(s, J), 0);
      lag_sim_free(s);
    }
    for (int k = 0; k < 4; k++) {
      /* truncation: delta^6/140 times a seventh derivative; the equations of steps are solved to some 1e-13 */
      assert_close(slope[k], J[k * 4], 1e-9);
    }
  }
}

/* ---- The symplectic form, in q and p = dL/dv */

/* T[n * n] := d(q, p)/d(q, v) at y. */
static void canonical(const lag_scene *scene, const double *y, double *T) {
  const lag_model *m = scene->model;
  int nq = m->nq, n = 2 * nq;
  double h[16];
  assert_int_equal(m->second(m, 0, y, y + nq, NULL, NULL, NULL, h, NULL), 0);
  memset(T, 0, (size_t)(n * n) * sizeof *T);
  for (int i = 0; i < nq; i++)
    T[i * n + i] = 1;
  for (int e = 0; e < m->nsecond; e++) {
    int row = m->second_at[e].row, col = m->second_at[e].col;
    if (m->second_at[e].part == LAG_VQ) {
      T[(nq + row) * n + col] = h[e];
    } else if (m->second_at[e].part == LAG_VV) {
      T[(nq + row) * n + nq + col] = T[(nq + col) * n + nq + row] = h[e];
    }
  }
}

/* W := A^T Omega A */
static void form(int nq, const double *A, double *W) {
  int n = 2 * nq;
  for (int a = 0; a < n; a++) {
    for (int b = 0; b < n; b++) {
      W[a * n + b] = 0;
      for (int i = 0; i < nq; i++)
        W[a * n + b] += A[i * n + a] * A[(nq + i) * n + b] - A[(nq + i) * n + a] * A[i * n + b];
    }
  }
}

/* (T1 J)^T Omega (T1 J) = T0^T Omega T0 is J^T Omega J = Omega in canonical variables; relative to the largest entry
 * of either. */
static double defect(const lag_scene *scene, const lag_method *m, double h, const double *y0) {
  int nq = scene->model->nq, n = 2 * nq;
  double y1[4], J[MOST], T0[MOST], T1[MOST], moved[MOST], before[MOST], after[MOST], size = 1;
  tangent(scene, m, h, h, y0, y1, J);
  canonical(scene, y0, T0);
  canonical(scene, y1, T1);
  multiply(n, T1, J, moved);
  form(nq, T0, before);
  form(nq, moved, after);
  for (int i = 0; i < n * n; i++)
    size = fmax(size, fabs(before[i]));
  return distance(n * n, before, after) / size;
}

/* The pendulum from 3.0, Kepler with e = 0.6 half way out, the double pendulum; steps from small to as long as
 * Newton's method bears. */
static const struct {
  const lag_scene *scene;
  double h[3], y0[4];
} forms[] = {
    {&pendulum, {0.01, 0.1, 0.5}, {3, 0}},
    {&kepler, {0.01, 0.05, 0.2}, {-0.6, 0.8, -1, 0}},
    {&double_pendulum, {0.01, 0.02, 0.1}, {1, -0.5, 0.3, 0.6}},
};

static void steps_are_symplectic(void **state) {
  (void)state;
  for (int k = 0; k < 3; k++) {
    for (int i = 0; i < 3; i++) {
      double h = forms[k].h[i];
      for (int m = 0; m < SYMPLECTIC; m++) {
        double d = defect(forms[k].scene, symplectic[m], h, forms[k].y0);
        print_message("# %-15s h %-5g %-16s J^T Omega J - Omega: %.1e\n", forms[k].scene->name, h, symplectic[m]->name,
                      d);
        assert_true(symplectic[m]->flags & LAG_METHOD_SYMPLECTIC);
        assert_close(d, 0, 1e-12);
      }
    }
    double h = 2 * forms[k].h[2], rk4 = defect(forms[k].scene, &lag_rk4, h, forms[k].y0),
           rk45 = defect(forms[k].scene, &lag_rk45, h, forms[k].y0);
    print_message("# %-15s h %-5g rk4 %.1e, rk45 %.1e\n", forms[k].scene->name, h, rk4, rk45);
    assert_true(rk4 > 1e-6 && rk45 > 1e-6);
  }
}

/* Every method whose descriptor says so was tried, but that of bodies, which has no derivative. */
static void all_that_claim_it(void **state) {
  (void)state;
  for (int i = 0; i < lag_nmethods; i++) {
    int tried = 0;
    for (int m = 0; m < SYMPLECTIC; m++)
      tried |= lag_methods[i] == symplectic[m];
    assert_int_equal(tried || OF_BODIES(lag_methods[i]), (lag_methods[i]->flags & LAG_METHOD_SYMPLECTIC) != 0);
  }
}

static double determinant(int n, double *A) {
  double det = 1;
  for (int c = 0; c < n; c++) {
    int best = c;
    for (int i = c + 1; i < n; i++)
      best = fabs(A[i * n + c]) > fabs(A[best * n + c]) ? i : best;
    for (int j = 0; j < n && best != c; j++) {
      double x = A[c * n + j];
      A[c * n + j] = A[best * n + j];
      A[best * n + j] = x;
    }
    det *= best != c ? -A[c * n + c] : A[c * n + c];
    for (int i = c + 1; i < n; i++) {
      double f = A[i * n + c] / A[c * n + c];
      for (int j = c; j < n; j++)
        A[i * n + j] -= f * A[c * n + j];
    }
  }
  return det;
}

/* Phase-space volume over a hundred steps, where M is constant. The determinant loses what J has grown by. */
static void volume_is_kept(void **state) {
  double J[MOST];
  (void)state;
  for (int m = 0; m < SYMPLECTIC; m++) {
    tangent(&henon, symplectic[m], 0.125, 12.5, maps[1].y0, NULL, J);
    assert_close(determinant(4, J), 1, 1e-10);
    tangent(&pendulum, symplectic[m], 0.125, 12.5, maps[0].y0, NULL, J);
    assert_close(determinant(2, J), 1, 1e-10);
  }
  tangent(&henon, &lag_rk4, 0.25, 12.5, maps[1].y0, NULL, J);
  assert_true(fabs(determinant(4, J) - 1) > 1e-6);
}

/* A symmetric method: forth, velocities turned, forth, is the beginning with velocities turned; and so of
 * derivatives. */
static double not_reversed(const lag_scene *scene, const lag_method *m, double h, const double *y0) {
  int nq = scene->model->nq, n = 2 * nq;
  double y[4], J[MOST], back[MOST], both[MOST], worst = 0;
  tangent(scene, m, h, h, y0, y, J);
  for (int i = nq; i < n; i++)
    y[i] = -y[i];
  tangent(scene, m, h, h, y, NULL, back);
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++)
      J[i * n + j] *= i < nq ? 1 : -1;
  }
  multiply(n, back, J, both);
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++)
      worst = fmax(worst, fabs(both[i * n + j] - (i != j ? 0 : i < nq ? 1 : -1)));
  }
  return worst;
}

static void symmetric_steps_are_reversed(void **state) {
  (void)state;
  for (int m = 0; m < ALL; m++) {
    for (int k = 0; k < 3; k++) {
      double d = not_reversed(forms[k].scene, method_at(m), forms[k].h[1], forms[k].y0);
      if (method_at(m)->flags & LAG_METHOD_SYMMETRIC) {
        assert_close(d, 0, 1e-12);
      } else if (method_at(m) == &lag_symplectic_euler) {
        assert_true(d > 1e-5);
      }
    }
  }
}

/* ---- The run, and what is refused */

static void run_is_the_same(void **state) {
  (void)state;
  for (int m = 0; m < ALL; m++) {
    double y[2][4], J[MOST];
    lag_stats st[2];
    for (int with = 0; with < 2; with++) {
      lag_sim *s = sim_with(&double_pendulum, method_at(m), 0, 0, NULL);
      if (with)
        assert_int_equal(lag_sim_set_tangent(s, 4, NULL), 0);
      for (int i = 1; i <= 5; i++) {
        assert_int_equal(lag_sim_advance(s, 0.0123 * i), LAG_OK);
        assert_int_equal(with ? lag_sim_tangent(s, J) : 0, 0);
      }
      memcpy(y[with], lag_sim_q(s), sizeof y[with]);
      lag_sim_stats(s, &st[with]);
      lag_sim_free(s);
    }
    assert_memory_equal(y[0], y[1], sizeof y[0]);
    assert_int_equal(st[0].rhs_calls, st[1].rhs_calls);
    assert_int_equal(st[0].iterations, st[1].iterations);
  }
}

/* Within a step: by a shorter one, as accurate as the method. */
static void within_a_step(void **state) {
  const double y0[] = {0.3, -1}, t = 1.03, turn[] = {cos(t), sin(t), -sin(t), cos(t)};
  double J[4];
  (void)state;
  for (int m = 0; m < ALL; m++) {
    tangent(&osc, method_at(m), 0.0625, t, y0, NULL, J);
    assert_close(distance(4, J, turn), 0, method_at(m)->order == 1 ? 0.05 : method_at(m)->order == 2 ? 1e-3 : 1e-5);
  }
  lag_model any = osc_model; /* the implicit form, for once */
  lag_scene turned = osc;
  any.flags &= ~(unsigned)LAG_SEPARABLE;
  turned.model = &any;
  tangent(&turned, &lag_verlet8, 0.0625, t, y0, NULL, J);
  assert_close(distance(4, J, turn), 0, 1e-9);
}

/* Two columns, replaced by others on the way. */
static int replace(void *context, const lag_sim *s) {
  double Y[4];
  (void)context;
  assert_int_equal(lag_sim_tangent((lag_sim *)(uintptr_t)s, Y), 0);
  for (int i = 0; i < 4; i++)
    Y[i] *= 0.5;
  assert_int_equal(lag_sim_set_tangent((lag_sim *)(uintptr_t)s, 2, Y), 0);
  return 0;
}

static void columns_may_be_replaced(void **state) {
  const double half[] = {1, 1, 0, 1}, h = 0.25;
  double Y[4], J[4];
  lag_sim *s = equal_steps(&osc, &lag_verlet, h);
  (void)state;
  lag_sim_on_step(s, replace, NULL);
  assert_int_equal(lag_sim_set_tangent(s, 2, half), 0);
  assert_int_equal(lag_sim_advance(s, 3 * h), LAG_OK);
  assert_int_equal(lag_sim_tangent(s, Y), 0);
  lag_sim_free(s);
  tangent(&osc, &lag_verlet, h, 3 * h, (double[]){1, 0}, NULL, J);
  for (int i = 0; i < 2; i++) { /* J half, halved after each step but the last: the run stands within it, at its end */
    assert_close(Y[2 * i], J[2 * i] / 4, 1e-15);
    assert_close(Y[2 * i + 1], (J[2 * i] + J[2 * i + 1]) / 4, 1e-15);
  }
}

static void refusals(void **state) {
  lag_method bare = lag_rk4;
  bare.tangent = NULL;
  lag_sim *s = sim_with(&kepler, &bare, 0, 0, NULL);
  double x[1000];
  (void)state;
  assert_int_equal(lag_sim_set_tangent(s, 4, NULL), LAG_EMETHOD);
  assert_non_null(strstr(lag_sim_message(s), "dop853 has"));
  assert_int_equal(lag_sim_tangent(s, x), LAG_EINVAL);
  lag_sim_free(s);

  lag_model plain = kepler_model;
  lag_scene without = kepler;
  plain.linear = NULL;
  without.model = &plain;
  s = sim_with(&without, &lag_dop853, 0, 0, NULL);
  assert_int_equal(lag_sim_set_tangent(s, 4, NULL), LAG_EMETHOD);
  assert_non_null(strstr(lag_sim_message(s), "--with linear"));
  lag_sim_free(s);

  s = sim_with(&ball, &lag_dop853, 0, 0, NULL);
  assert_int_equal(lag_sim_set_tangent(s, 2, NULL), 0);
  assert_int_equal(lag_sim_advance(s, 5), LAG_EMETHOD);
  assert_non_null(strstr(lag_sim_message(s), "event ground changes the state at t = 0.45"));
  lag_sim_free(s);

  s = sim_with(&kepler, &lag_dop853, 0, 0, NULL);
  assert_int_equal(lag_sim_set_tangent(s, 3, NULL), LAG_EINVAL);
  assert_int_equal(lag_sim_set_tangent(s, -1, NULL), LAG_EINVAL);
  assert_int_equal(lag_sim_set_tangent(s, 4, NULL), 0);
  assert_int_equal(lag_sim_advance(s, 1), LAG_OK);
  assert_true(lag_sim_save_size(s) <= sizeof x / sizeof *x);
  assert_int_equal(lag_sim_save(s, x), LAG_OK);
  assert_int_equal(lag_sim_load(s, x), LAG_EINVAL);
  assert_int_equal(lag_sim_set_tangent(s, 0, NULL), LAG_OK);
  assert_int_equal(lag_sim_load(s, x), LAG_OK);
  assert_int_equal(lag_sim_set_tangent(s, 4, NULL), LAG_EINVAL); /* within a step */
  lag_sim_free(s);
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(oscillator_turns),
      cmocka_unit_test(matrices_of_linear_steps),
      cmocka_unit_test(damped_oscillator),
      cmocka_unit_test(published_digits),
      cmocka_unit_test(derivative_of_the_map),
      cmocka_unit_test(derivative_of_higher_orders),
      cmocka_unit_test(steps_are_symplectic),
      cmocka_unit_test(all_that_claim_it),
      cmocka_unit_test(volume_is_kept),
      cmocka_unit_test(symmetric_steps_are_reversed),
      cmocka_unit_test(run_is_the_same),
      cmocka_unit_test(within_a_step),
      cmocka_unit_test(columns_may_be_replaced),
      cmocka_unit_test(refusals),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
