/* Methods in quadruple precision, where high orders have room to show, on models that lagc emitted: the order of
 * steps and of dense output, with forces and time in L too, from how solutions for steps h, h/2, h/4 approach each
 * other (that they approach the right one is measured in double precision, against closed forms and other methods);
 * of symplectic ones the symplectic form of one step in q and p, and time reversal. TAP. Goes through
 * runtime/precision.awk. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lag.h"

extern const lag_scene pendulum_small, double_pendulum_swing, kepler_orbit, magnet_go, shaken_go;

enum { MOST = 4 };

typedef struct Case {
  const lag_scene *scene;
  double y[2 * MOST]; /* where it starts: away from turning points and symmetries */
  double h, end, t0;
} Case;

static const Case cases[] = {
    {&pendulum_small, {2, 1}, 0.4, 6.4},
    {&double_pendulum_swing, {1, -0.5, 0.3, 0.2}, 0.04, 0.64},
    {&kepler_orbit, {0.4, 0, 0.1, 2}, 0.03, 0.96},
    {&magnet_go, {1, 0.2, 0.1, 0.3}, 0.2, 1.6},
    {&shaken_go, {1, -0.5, 0.3, 0.2}, 0.04, 0.64},
};
enum { CASES = sizeof cases / sizeof *cases };

typedef struct Kind {
  const lag_method *method;
  const char *name;
  lag_option option[2];
  int noptions, order;
  double finer;        /* the steps of a case over this: until the leading term of the error rules */
  double other[CASES]; /* the same for single cases */
} Kind;

static const Kind kinds[] = {
    {&lag_symplectic_euler, "symplectic_euler", {{0}}, 0, 1, 128},
    {&lag_verlet, "verlet", {{0}}, 0, 2, 8},
    {&lag_verlet4, "verlet4", {{0}}, 0, 4, 16},
    {&lag_verlet6, "verlet6", {{0}}, 0, 6, 4},
    {&lag_verlet8, "verlet8", {{0}}, 0, 8, 3},
    {&lag_variational, "variational midpoint", {{0}}, 0, 2, 8},
    {&lag_gauss, "gauss 4", {{"stages", 2, NULL}}, 1, 4, 8},
    {&lag_gauss, "gauss 6", {{"stages", 3, NULL}}, 1, 6, 8},
    {&lag_gauss, "gauss 8", {{"stages", 4, NULL}}, 1, 8, 8},
    {&lag_euler, "euler", {{0}}, 0, 1, 1024},
    {&lag_rk4, "rk4", {{0}}, 0, 4, 128},
    {&lag_rk45, "rk45", {{"adapt", 0, "off"}}, 1, 5, 64, {[4] = 256}},
    {&lag_dop853, "dop853", {{"adapt", 0, "off"}}, 1, 8, 64, {[0] = 256}},
    {&lag_radau, "radau", {{"adapt", 0, "off"}}, 1, 5, 64},
    {&lag_taylor_method, "taylor 12", {{"adapt", 0, "off"}, {"order", 12, NULL}}, 2, 12, 16, {[3] = 4}},
};
enum { KINDS = sizeof kinds / sizeof *kinds };

static int tests, bad;

static void result(int good, const char *what, const char *model, const Kind *k, double x)
{
  tests++;
  bad += !good;
  printf("%sok %d - %s: %s, %s: %.3g\n", good ? "" : "not ", tests, model, k->name, what, x);
}

static int size(const Case *c)
{
  return 2 * c->scene->model->nq;
}

/* From t0 on, and without monitors, which a coarse step would set off. */
static const lag_scene *scene_of(const Case *c)
{
  static lag_scene all[CASES];
  lag_scene *at = all;
  while (at->name && at->model != c->scene->model) {
    at++;
  }
  *at = *c->scene;
  at->nmonitors = 0;
  at->t0 = c->t0;
  return at;
}

static lag_sim *begin(const Case *c, const Kind *k, const double *y, double h)
{
  lag_option opt[3] = {{"step", h, NULL}, k->option[0], k->option[1]};
  lag_sim *s = lag_sim_new(scene_of(c));
  char name[32];
  /* tolerance: of Newton's method */
  if (!s || lag_sim_set_tolerance(s, 1e-27) || lag_sim_set_method(s, k->method, opt, 1 + k->noptions)) {
    printf("# %s\n", s ? lag_sim_message(s) : "no simulation");
    exit(1);
  }
  for (int i = 0; i < size(c); i++) {
    double unit = lag_sim_state_info(s, i, name, sizeof name, NULL, 0);
    lag_sim_set(s, name, y[i] / unit);
  }
  return s;
}

/* y after `end`, from `from` in steps of h. */
static void flow(const Case *c, const Kind *k, const double *from, double h, double end, double *y)
{
  lag_sim *s = begin(c, k, from, h);
  if (lag_sim_advance(s, c->t0 + end) != LAG_OK) {
    printf("# %s, %s: %s\n", c->scene->name, k->name, lag_sim_message(s));
    exit(1);
  }
  memcpy(y, lag_sim_q(s), (size_t)size(c) * sizeof *y);
  lag_sim_free(s);
}

static double apart(const double *a, const double *b, int n)
{
  double d = 0;
  for (int i = 0; i < n; i++) {
    d = fmax(d, fabs(a[i] - b[i]));
  }
  return d;
}

/* The states after each quarter of `end`: at one time alone the leading term of the error may vanish. */
static void quarters(const Case *c, const Kind *k, double h, double end, double *y)
{
  lag_sim *s = begin(c, k, c->y, h);
  for (int i = 0; i < 4; i++) {
    if (lag_sim_advance(s, c->t0 + end * (i + 1) / 4) != LAG_OK) {
      printf("# %s, %s: %s\n", c->scene->name, k->name, lag_sim_message(s));
      exit(1);
    }
    memcpy(y + i * size(c), lag_sim_q(s), (size_t)size(c) * sizeof *y);
  }
  lag_sim_free(s);
}

/* log2 of how much closer the second pair of solutions is. */
static double slope(const Case *c, const Kind *k, double h, double end)
{
  double y[3][4 * 2 * MOST];
  for (int i = 0; i < 3; i++) {
    quarters(c, k, h / (1 << i), end, y[i]);
  }
  return log2(apart(y[0], y[1], 4 * size(c)) / apart(y[1], y[2], 4 * size(c)));
}

static void orders(const Case *c, const Kind *k)
{
  double other = k->other[c - cases], p = slope(c, k, c->h / (other > 0 ? other : k->finer), c->end);
  result(fabs(p - k->order) <= 0.15, "order", c->scene->model->name, k, p);
}

/* The largest error at 0.37 of each step, against steps half as long at the same times, which are as good as exact
 * 2^order times over: in both the same places of their steps are asked for. */
static double dense_error(const Case *c, const Kind *k, double h)
{
  lag_sim *coarse = begin(c, k, c->y, h), *fine = begin(c, k, c->y, h / 8);
  double worst = 0;
  for (int i = 0; i < 16; i++) {
    double t = (i + 0.375) * h; /* the end of a step of the fine one */
    if (lag_sim_advance(coarse, t) || lag_sim_advance(fine, t)) {
      exit(1);
    }
    worst = fmax(worst, apart(lag_sim_q(coarse), lag_sim_q(fine), size(c)));
  }
  lag_sim_free(coarse);
  lag_sim_free(fine);
  return worst;
}

static void dense_orders(const Case *c, const Kind *k)
{
  if ((k->method->flags & LAG_METHOD_SPLITS) && (c->scene->model->flags & LAG_SEPARABLE)) {
    return; /* the explicit form: tests/unit/test_rt_verlet.c */
  }
  double h = c->h / k->finer, p = log2(dense_error(c, k, h) / dense_error(c, k, h / 2));
  /* Over 16 steps, which become shorter with h: the errors of steps add up to order + 1 there, those between stand
   * alone. */
  result(p >= k->order - 0.3, "order between steps", c->scene->model->name, k, p);
}

/* The symplectic form at y in q and v: T^t Omega T with T = d(q, p)/d(q, v), [n n]. */
static void form(const Case *c, const double *p, const double *y, double *omega)
{
  const lag_model *m = c->scene->model;
  int nq = m->nq, n = 2 * nq;
  double h[64], T[4 * MOST * MOST] = {0}, u[4] = {0};
  if (m->inputs) {
    m->inputs(m, 0, p, u);
  }
  m->second(m, 0, y, y + nq, NULL, p, u, h, NULL);
  for (int i = 0; i < nq; i++) {
    T[i * n + i] = 1;
  }
  for (int e = 0; e < m->nsecond; e++) {
    int i = m->second_at[e].row, j = m->second_at[e].col;
    if (m->second_at[e].part == LAG_VQ) {
      T[(nq + i) * n + j] = h[e];
    } else if (m->second_at[e].part == LAG_VV) {
      T[(nq + i) * n + nq + j] = T[(nq + j) * n + nq + i] = h[e];
    }
  }
  for (int a = 0; a < n; a++) {
    for (int b = 0; b < n; b++) {
      omega[a * n + b] = 0;
      for (int i = 0; i < nq; i++) {
        omega[a * n + b] += T[i * n + a] * T[(nq + i) * n + b] - T[(nq + i) * n + a] * T[i * n + b];
      }
    }
  }
}

/* J of one step by differences of order 2 in steps of 1e-11: truncation and rounding are 1e-22. */
static void differences(const Case *c, const Kind *k, double h, double *J)
{
  int n = size(c);
  double d = 1e-11;
  for (int j = 0; j < n; j++) {
    double y[2 * MOST], up[2 * MOST], down[2 * MOST];
    memcpy(y, c->y, sizeof y);
    y[j] += d;
    flow(c, k, y, h, h, up);
    y[j] = c->y[j] - d;
    flow(c, k, y, h, h, down);
    for (int i = 0; i < n; i++) {
      J[i * n + j] = (up[i] - down[i]) / (2 * d);
    }
  }
}

/* J of one step, exactly; y: where it leads. */
static void tangent(const Case *c, const Kind *k, double h, double *y, double *J)
{
  lag_sim *s = begin(c, k, c->y, h);
  if (lag_sim_set_tangent(s, size(c), NULL) || lag_sim_advance(s, c->t0 + h) || lag_sim_tangent(s, J)) {
    printf("# %s, %s: %s\n", c->scene->name, k->name, lag_sim_message(s));
    exit(1);
  }
  memcpy(y, lag_sim_q(s), (size_t)size(c) * sizeof *y);
  lag_sim_free(s);
}

static void derivative(const Case *c, const Kind *k)
{
  double y[2 * MOST], J[4 * MOST * MOST], D[4 * MOST * MOST];
  tangent(c, k, c->h, y, J);
  differences(c, k, c->h, D);
  double d = apart(J, D, size(c) * size(c));
  result(d < 1e-18, "tangent and differences", c->scene->model->name, k, d);
}

/* J^t omega(y1) J - omega(y0). */
static double defect(const Case *c, const Kind *k, double h)
{
  int n = size(c);
  double y1[2 * MOST], J[4 * MOST * MOST], w0[4 * MOST * MOST], w1[4 * MOST * MOST], worst = 0;
  lag_sim *s = begin(c, k, c->y, h);
  tangent(c, k, h, y1, J);
  form(c, lag_sim_p(s), c->y, w0);
  form(c, lag_sim_p(s), y1, w1);
  lag_sim_free(s);
  for (int a = 0; a < n; a++) {
    for (int b = 0; b < n; b++) {
      double sum = -w0[a * n + b];
      for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++) {
          sum += J[i * n + a] * w1[i * n + j] * J[j * n + b];
        }
      }
      worst = fmax(worst, fabs(sum));
    }
  }
  return worst;
}

static void symplectic(const Case *c, const Kind *k)
{
  if (!(c->scene->model->flags & LAG_CONSERVES_ENERGY)) {
    return;
  }
  double d = defect(c, k, c->h);
  result(d < 1e-29, "J^t Omega J - Omega", c->scene->model->name, k, d);
}

/* Forth in steps of h, and back in steps of -h: a simulation that ends where it began. */
static void reversal(const Case *c, const Kind *k)
{
  double y[2 * MOST], back[2 * MOST];
  Case there = *c;
  int symmetric = (k->method->flags & LAG_METHOD_SYMMETRIC) != 0;
  flow(c, k, c->y, c->h, 8 * c->h, y);
  memcpy(there.y, y, sizeof y);
  there.t0 = 8 * c->h;
  flow(&there, k, there.y, c->h, -8 * c->h, back);
  double d = apart(back, c->y, size(c));
  double rounding = 1e-24; /* of Newton's method, which stops at the rounding of what is largest in it */
  result(symmetric ? d < rounding : d > 1e-6, symmetric ? "the way back" : "another way back", c->scene->model->name, k,
         d);
}

int main(void)
{
  for (int i = 0; i < CASES; i++) {
    for (int j = 0; j < KINDS; j++) {
      orders(&cases[i], &kinds[j]);
      /* whose tangent is dop853's, to the tolerance */
      if (kinds[j].method->tangent && kinds[j].method != &lag_taylor_method) {
        derivative(&cases[i], &kinds[j]);
      }
      if (kinds[j].method->flags & LAG_METHOD_SYMPLECTIC) {
        dense_orders(&cases[i], &kinds[j]);
        symplectic(&cases[i], &kinds[j]);
        reversal(&cases[i], &kinds[j]);
      }
    }
  }
  /* what the measure shows when it is not */
  static const Kind other = {&lag_rk45, "rk45", {{"adapt", 0, "off"}}, 1, 5, 1};
  double d = defect(&cases[1], &other, cases[1].h);
  result(d > 1e-10, "is not symplectic", cases[1].scene->model->name, &other, d);
  printf("1..%d\n", tests);
  return bad != 0;
}
