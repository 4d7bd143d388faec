/* Comparison of variants of a scene: runs, differences of motions, weights of effects, times of right-hand sides. */
#include "analysis/effect_variants.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/memory_pool.h"
#include "core/core.h"

/* ---- Runs */

int lag_variant_init(Variant *v, lag_sim *sim) {
  *v = (Variant){.sim = sim, .n = sim->pb.n};
  return lag_samples_init(&v->run, LAG_VARIANT_ROWS, v->n);
}

void lag_variant_free(Variant *v) { lag_samples_free(&v->run); }

int lag_variant_run(Variant *v, double t0, double t1) {
  Samples *s = &v->run;
  for (int i = 0; i < LAG_VARIANT_ROWS; i++) s->t[i] = t0 + (t1 - t0) * (i + 1) / LAG_VARIANT_ROWS;
  int rc = lag_samples_take(s, v->sim);
  if (rc) {
    snprintf(v->why, sizeof v->why, "%s", lag_sim_message(v->sim));
  } else if (s->rows < LAG_VARIANT_ROWS) { /* the last row is the end of the run */
    s->t[s->rows] = lag_sim_time(v->sim);
    memcpy(s->y + (size_t)s->rows++ * (size_t)s->n, v->sim->now, (size_t)s->n * sizeof *s->y);
  }
  return rc;
}

/* ---- Matching components */

/* at[a->n] := the components of b with the names of those of a; -1: there is none. NULL: no memory. */
static int *places(Pool *pool, const Variant *a, const Variant *b) {
  int *at = (int *)(void *)lag_pool_doubles(pool, (size_t)a->n), place;
  const lag_model *m = b->sim->scene->model;
  const lag_var *var;
  char name[128];
  for (int i = 0; at && i < a->n; i++) {
    lag_sim_state_info(a->sim, i, name, sizeof name, NULL, 0);
    int kind = lag_find_name(m, name, &place, &var);
    at[i] = kind == LAG_IS_Q ? place : kind == LAG_IS_V ? m->nq + place : kind == LAG_IS_Z ? 2 * m->nq + place : -1;
  }
  return at;
}

/* ---- Differences */

static double row_difference(const double *a, const double *b, const int *at, const double *scale, int n) {
  double most = 0;
  for (int i = 0; i < n; i++) {
    double d = at[i] < 0 ? 0 : fabs(a[i] - b[at[i]]) / scale[i];
    most = d <= HUGE_VAL ? fmax(most, d) : HUGE_VAL;
  }
  return most;
}

int lag_variant_difference(const Variant *scene, const Variant *other, double *difference) {
  const Samples *a = &scene->run, *b = &other->run;
  Pool pool = {0};
  int common = a->rows < b->rows ? a->rows : b->rows, *at = places(&pool, scene, other);
  double *scale = lag_pool_doubles(&pool, (size_t)scene->n);
  size_t na = (size_t)a->n, nb = (size_t)b->n, last_a = (size_t)a->rows - 1, last_b = (size_t)b->rows - 1;
  if (!pool.failed) {
    lag_cost_scales(a, scene->sim, scale);
    double most = row_difference(a->y + last_a * na, b->y + last_b * nb, at, scale, a->n);
    for (size_t i = 0; i + 1 < (size_t)common; i++) most = fmax(most, row_difference(a->y + i * na, b->y + i * nb, at, scale, a->n));
    double begun = scene->sim->scene->t0;
    *difference = fmax(most, fabs(a->t[last_a] - b->t[last_b]) / fabs(a->t[last_a] - begun));
  }
  lag_pool_free(&pool);
  return pool.failed ? LAG_ENOMEM : LAG_OK;
}

/* ---- Weights */

/* Groups of accelerations and rates of states with one unit: group[n] of component i, -1 for rates of coordinates. Returns the number of groups. */
static int group_rates(const Variant *v, int *group) {
  int count = 0;
  for (int i = 0; i < v->n; i++) {
    int alike = lag_previous_alike(v->sim, i);
    group[i] = i < v->sim->pb.nq ? -1 : alike < 0 ? count++ : group[alike];
  }
  return count;
}

/* dy := rates of v at a state of `along`, whose components stand at[] in v's. Not 0: no values. */
static int rates(const Variant *v, const Variant *along, int state, const int *at, double *y, double *dy) {
  const double *from = along->run.y + (size_t)state * (size_t)along->n;
  for (int i = 0; i < v->n; i++) y[i] = 0;
  for (int i = 0; i < along->n; i++)
    if (at[i] >= 0) y[at[i]] = from[i];
  return lag_rhs(&v->sim->pb, along->run.t[state], y, dy) || lag_not_finite(v->n, dy) >= 0;
}

typedef struct Weighing {
  const Variant *along, *with, *without;
  int *at_with, *at_without, *same, *group; /* same: components of `with` in `without` */
  int ngroups;
  double *y, *one, *two;      /* a state, rates with and without */
  double *size, *differs;     /* [LAG_VARIANT_ROWS * ngroups] |a_with|^2, |a_with - a_without|^2 */
} Weighing;

/* Sums of squares over groups at one state; 0: no values. */
static int weigh_state(const Weighing *w, int state, double *size, double *differs) {
  if (rates(w->with, w->along, state, w->at_with, w->y, w->one) || rates(w->without, w->along, state, w->at_without, w->y, w->two)) return 0;
  for (int g = 0; g < w->ngroups; g++) size[g] = differs[g] = 0;
  for (int i = 0; i < w->with->n; i++) {
    if (w->group[i] < 0) continue;
    double d = w->same[i] < 0 ? 0 : w->one[i] - w->two[w->same[i]];
    size[w->group[i]] += w->one[i] * w->one[i];
    differs[w->group[i]] += d * d;
  }
  return 1;
}

static double weigh(const Weighing *w) {
  double most = NAN;
  int n = 0;
  for (int state = 0; state < w->along->run.rows; state++) n += weigh_state(w, state, w->size + n * w->ngroups, w->differs + n * w->ngroups);
  for (int g = 0; g < w->ngroups; g++) {
    double mean = 0;
    for (int k = 0; k < n; k++) mean += w->size[k * w->ngroups + g] / n;
    for (int k = 0; k < n; k++) {
      double d = w->differs[k * w->ngroups + g], size = fmax(w->size[k * w->ngroups + g], mean);
      most = d > 0 || size > 0 ? fmax(most, d > 0 ? sqrt(d / size) : 0) : most;
    }
  }
  return most;
}

int lag_variant_weight(const Variant *along, const Variant *with, const Variant *without, double *weight) {
  Pool pool = {0};
  size_t n = (size_t)(with->n > without->n ? with->n : without->n);
  Weighing w = {along, with, without, places(&pool, along, with), places(&pool, along, without), places(&pool, with, without),
                (int *)(void *)lag_pool_doubles(&pool, n), 0, lag_pool_doubles(&pool, n), lag_pool_doubles(&pool, n),
                lag_pool_doubles(&pool, n), NULL, NULL};
  *weight = NAN;
  if (!pool.failed) {
    w.ngroups = group_rates(with, w.group);
    w.size = lag_pool_doubles(&pool, (size_t)w.ngroups * LAG_VARIANT_ROWS);
    w.differs = lag_pool_doubles(&pool, (size_t)w.ngroups * LAG_VARIANT_ROWS);
  }
  if (!pool.failed) *weight = weigh(&w);
  lag_pool_free(&pool);
  return pool.failed ? LAG_ENOMEM : LAG_OK;
}

/* ---- Times */

/* Mean time of one call over `loops` passes through all states of the run. */
static double time_calls(Variant *v, int loops, double *dy) {
  double begun = lag_processor_seconds();
  for (int k = 0; k < loops; k++)
    for (int i = 0; i < v->run.rows; i++) lag_rhs(&v->sim->pb, v->run.t[i], v->run.y + (size_t)i * (size_t)v->n, dy);
  return (lag_processor_seconds() - begun) / loops / v->run.rows;
}

int lag_variants_time(Variant *v, int n) {
  enum { ROUNDS = 60 };
  const double turn = 2e-4; /* [s], long beside reading the clock */
  size_t most = 1;

  for (int i = 0; i < n; i++) {
    most = (size_t)v[i].n > most ? (size_t)v[i].n : most;
    v[i].time = !v[i].why[0] ? HUGE_VAL : NAN;
  }
  double *dy = calloc(most, sizeof *dy);
  for (int round = 0; dy && round < ROUNDS; round++)
    for (int i = 0; i < n; i++)
      if (!isnan(v[i].time)) {
        double per_call = isinf(v[i].time) ? 1e-6 : v[i].time;
        v[i].time = fmin(v[i].time, time_calls(&v[i], (int)fmin(1e4, turn / (per_call * v[i].run.rows)) + 1, dy));
      }
  free(dy);
  return dy ? LAG_OK : LAG_ENOMEM;
}
