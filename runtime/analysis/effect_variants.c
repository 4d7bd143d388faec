/* Comparison of variants of a scene: runs, differences of motions, weights of effects, times of right-hand sides. */
#include "analysis/effect_variants.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/memory_pool.h"
#include "core/core.h"
#include "numeric/clock.h"

void lag_variant_free(Variant *v) {
  lag_samples_free(&v->run);
  lag_sim_free(v->sim);
}

int lag_variant_run(Variant *v, double t0, double t1) {
  Samples *s = &v->run;
  int n = v->sim->pb.n, rc = lag_samples_init(s, LAG_VARIANT_ROWS, n);
  for (int i = 0; i < LAG_VARIANT_ROWS && rc == 0; i++) s->t[i] = t0 + (t1 - t0) * (i + 1) / LAG_VARIANT_ROWS;
  if (rc || (rc = lag_samples_take(s, v->sim)) != 0) {
    snprintf(v->why, sizeof v->why, "%s", rc == LAG_ENOMEM ? "out of memory" : lag_sim_message(v->sim));
  } else if (s->rows < LAG_VARIANT_ROWS) { /* the last row is the end of the run */
    s->t[s->rows] = lag_sim_time(v->sim);
    memcpy(s->y + (size_t)s->rows++ * (size_t)n, v->sim->now, (size_t)n * sizeof *s->y);
  }
  return rc;
}

/* ---- Matching components */

int lag_component_index(const lag_model *m, const char *name) {
  const lag_var *var;
  int at, kind = lag_find_name(m, name, &at, &var);
  return kind == LAG_IS_Q ? at : kind == LAG_IS_V ? m->nq + at : kind == LAG_IS_Z ? 2 * m->nq + at : -1;
}

/* at[n] := the components of b with the names of those of a; -1: there is none. NULL: no memory. */
static int *places(Pool *pool, const Variant *a, const Variant *b) {
  int *at = (int *)(void *)lag_pool_doubles(pool, (size_t)a->run.n);
  char name[128];
  for (int i = 0; at && i < a->run.n; i++) {
    lag_sim_state_info(a->sim, i, name, sizeof name, NULL, 0);
    at[i] = lag_component_index(b->sim->scene->model, name);
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

/* Scales of a, of a component that rests in it those of b: a motion that an effect makes has a size, its absence none.
 * own: scratch. */
static int take_scales(const Variant *a, const Variant *b, const int *at, double *scale, double *own) {
  const Samples *s = &a->run;
  if (lag_cost_scales(s, a->sim, scale) || lag_cost_scales(&b->run, b->sim, own)) return LAG_ENOMEM;
  for (int i = 0; i < s->n; i++) {
    double size = lag_size_in(s, i);
    if (at[i] >= 0 && lag_above_rounding(size, scale[i]) > size) scale[i] = fmin(scale[i], own[at[i]]);
  }
  return LAG_OK;
}

int lag_variant_difference(const Variant *scene, const Variant *other, double *difference) {
  const Samples *a = &scene->run, *b = &other->run;
  Pool pool = {0};
  int common = a->rows < b->rows ? a->rows : b->rows, *at = places(&pool, scene, other);
  double *scale = lag_pool_doubles(&pool, (size_t)a->n), *own = lag_pool_doubles(&pool, (size_t)b->n);
  size_t na = (size_t)a->n, nb = (size_t)b->n, last_a = (size_t)a->rows - 1, last_b = (size_t)b->rows - 1;
  pool.failed = pool.failed || take_scales(scene, other, at, scale, own);
  if (!pool.failed) {
    double most = row_difference(a->y + last_a * na, b->y + last_b * nb, at, scale, a->n);
    for (size_t i = 0; i + 1 < (size_t)common; i++)
      most = fmax(most, row_difference(a->y + i * na, b->y + i * nb, at, scale, a->n));
    double begun = scene->sim->scene->t0;
    *difference = fmax(most, fabs(a->t[last_a] - b->t[last_b]) / fabs(a->t[last_a] - begun));
  }
  lag_pool_free(&pool);
  return pool.failed ? LAG_ENOMEM : LAG_OK;
}

/* ---- Weights */

/* Groups of accelerations and rates of states with one unit: group[n] of component i, -1 for rates of coordinates.
 * Returns the number of groups. */
static int group_rates(const Variant *v, int *group) {
  int count = 0;
  for (int i = 0; i < v->run.n; i++) {
    int alike = lag_previous_alike(v->sim, i);
    group[i] = i < v->sim->pb.nq ? -1 : alike < 0 ? count++ : group[alike];
  }
  return count;
}

/* dy := rates of v at a state of `along`, whose components stand at[] in v's. Not 0: no values. */
static int rates(const Variant *v, const Variant *along, int state, const int *at, double *y, double *dy) {
  const double *from = along->run.y + (size_t)state * (size_t)along->run.n;
  for (int i = 0; i < v->run.n; i++) y[i] = 0;
  for (int i = 0; i < along->run.n; i++)
    if (at[i] >= 0) y[at[i]] = from[i];
  return lag_rhs(&v->sim->pb, along->run.t[state], y, dy) || lag_not_finite(v->run.n, dy) >= 0;
}

/* The largest sqrt(differs/size) of a group over the states, with size at least its mean. */
static double largest_ratio(int states, int groups, const double *size, const double *differs) {
  double most = NAN;
  for (int g = 0; g < groups; g++) {
    double mean = 0;
    for (int k = 0; k < states; k++) mean += size[k * groups + g] / states;
    for (int k = 0; k < states; k++) {
      double d = differs[k * groups + g], of = fmax(size[k * groups + g], mean);
      most = d > 0 || of > 0 ? fmax(most, d > 0 ? sqrt(d / of) : 0) : most;
    }
  }
  return most;
}

int lag_variant_weight(const Variant *along, const Variant *with, const Variant *without, double *weight) {
  Pool pool = {0};
  size_t n = (size_t)(with->run.n > without->run.n ? with->run.n : without->run.n);
  int *at_with = places(&pool, along, with), *at_without = places(&pool, along, without),
      *same = places(&pool, with, without);
  int *group = (int *)(void *)lag_pool_doubles(&pool, n), groups = 0, states = 0;
  double *y = lag_pool_doubles(&pool, n), *one = lag_pool_doubles(&pool, n), *two = lag_pool_doubles(&pool, n);
  double *beside = lag_pool_doubles(&pool, n);
  double *size = lag_pool_doubles(&pool, LAG_VARIANT_ROWS * n),
         *differs = lag_pool_doubles(&pool, LAG_VARIANT_ROWS * n);
  const double moved = 1. / 1024; /* shows the terms of rates that cancel */
  *weight = NAN;
  if (!pool.failed) groups = group_rates(with, group);
  for (int state = 0; state < along->run.rows && !pool.failed; state++) {
    if (rates(without, along, state, at_without, y, two) || rates(with, along, state, at_with, y, one)) continue;
    for (int i = 0; i < with->run.n; i++) y[i] *= 1 + moved;
    if (lag_rhs(&with->sim->pb, along->run.t[state], y, beside)) continue;
    for (int i = 0; i < with->run.n; i++) {
      if (group[i] < 0) continue;
      double d = same[i] < 0 ? 0 : one[i] - two[same[i]];
      double of = lag_above_rounding(fabs(one[i]), fabs(beside[i] - one[i]) / moved);
      size[states * groups + group[i]] += of * of;
      differs[states * groups + group[i]] += d * d;
    }
    states++;
  }
  if (!pool.failed) *weight = largest_ratio(states, groups, size, differs);
  lag_pool_free(&pool);
  return pool.failed ? LAG_ENOMEM : LAG_OK;
}

/* ---- Times */

/* Mean time of one call over `loops` passes through all states of the run. */
static double time_calls(Variant *v, int loops, double *dy) {
  double begun = lag_processor_seconds();
  for (int k = 0; k < loops; k++)
    for (int i = 0; i < v->run.rows; i++)
      lag_rhs(&v->sim->pb, v->run.t[i], v->run.y + (size_t)i * (size_t)v->run.n, dy);
  return (lag_processor_seconds() - begun) / loops / v->run.rows;
}

int lag_variants_time(Variant *v, int n) {
  enum { ROUNDS = 60 };
  const double turn = 2e-4; /* [s], long beside reading the clock */
  size_t most = 1;

  for (int i = 0; i < n; i++) {
    most = (size_t)v[i].run.n > most ? (size_t)v[i].run.n : most;
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
