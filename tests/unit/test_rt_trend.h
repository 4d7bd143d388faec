/* How long the long runs of tests are, and the trend of the energy along one. */
#ifndef TEST_RT_TREND_H
#define TEST_RT_TREND_H

#include "test_rt_systems.h"

/* LAG_STEPS, which the suites of `make test-long` set, or else so many. */
UNUSED static int long_run(int steps)
{
  const char *text = getenv("LAG_STEPS");
  return text ? atoi(text) : steps;
}

/* ---- Energy: a straight line fitted to E - E0 over all steps */

typedef struct Trend {
  double k, e0, worst, sx, sxx, sy, sxy;
} Trend;

UNUSED static int record(void *context, const lag_sim *s)
{
  Trend *t = context;
  double e[2];
  lag_sim_scene(s)->model->energy(lag_sim_scene(s)->model, 0, lag_sim_q(s), lag_sim_v(s), NULL, NULL, NULL, e, NULL);
  double d = e[0] - t->e0;
  t->worst = fmax(t->worst, fabs(d));
  t->sx += t->k;
  t->sxx += t->k * t->k;
  t->sy += d;
  t->sxy += t->k * d;
  t->k++;
  return 0;
}

/* What the fitted line gains over steps of size h of a fresh simulation, which is freed; *worst: the largest |E -
 * E0|. start: of x, or NaN. */
UNUSED static double trend(lag_sim *s, double start, double h, int steps, double *worst)
{
  const lag_scene *scene = lag_sim_scene(s);
  double q[4], e[2];
  int nq = scene->model->nq;
  Trend t = {0};
  scene->start(scene, NULL, q, q + nq, NULL);
  if (!isnan(start)) {
    q[0] = start;
    assert_int_equal(lag_sim_set(s, "x", start), 0);
  }
  scene->model->energy(scene->model, 0, q, q + nq, NULL, NULL, NULL, e, NULL);
  t.e0 = e[0];
  lag_sim_on_step(s, record, &t);
  assert_int_equal(lag_sim_advance(s, steps * h), LAG_OK);
  lag_sim_free(s);
  *worst = t.worst;
  return (t.k * t.sxy - t.sx * t.sy) / (t.k * t.sxx - t.sx * t.sx) * t.k;
}

#endif
