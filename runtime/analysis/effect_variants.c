/* Comparison of variants of a scene: runs, differences of motions, weights of effects, times of right-hand sides. */
#include "analysis/effect_variants.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"

/* ---- Runs */

int lag_variant_init(Variant *v, lag_sim *sim)
{
  *v = (Variant){.sim = sim, .n = sim->pb.n};
  int rc = lag_samples_init(&v->run, LAG_VARIANT_ROWS, v->n);
  v->t = calloc(LAG_VARIANT_STATES, sizeof *v->t);
  v->y = calloc((size_t)LAG_VARIANT_STATES * (size_t)v->n + 1, sizeof *v->y);
  return rc == LAG_OK && v->t && v->y ? LAG_OK : LAG_ENOMEM;
}

void lag_variant_free(Variant *v)
{
  lag_samples_free(&v->run);
  free(v->t);
  free(v->y);
}

/* Keeps every stride-th step; when full, drops every second one and doubles the stride. */
typedef struct Recorder {
  Variant *v;
  long long step, stride;
} Recorder;

static int record(void *context, const lag_sim *sim)
{
  Recorder *r = context;
  Variant *v = r->v;
  size_t n = (size_t)v->n;

  if (r->step++ % r->stride != 0) {
    return 0;
  }
  if (v->nstates == LAG_VARIANT_STATES) {
    for (int i = 1; 2 * i < LAG_VARIANT_STATES; i++) {
      v->t[i] = v->t[2 * i];
      memcpy(v->y + (size_t)i * n, v->y + 2 * (size_t)i * n, n * sizeof *v->y);
    }
    v->nstates = LAG_VARIANT_STATES / 2;
    r->stride *= 2;
  }
  v->t[v->nstates] = sim->run->t;
  memcpy(v->y + (size_t)v->nstates++ * n, sim->now, n * sizeof *v->y);
  return 0;
}

int lag_variant_run(Variant *v, double t0, double t1)
{
  Recorder recorder = {v, 0, 1};
  Samples *s = &v->run;

  lag_sim_on_step(v->sim, record, &recorder);
  for (int i = 0; i < LAG_VARIANT_ROWS; i++) {
    s->t[i] = t0 + (t1 - t0) * (i + 1) / LAG_VARIANT_ROWS;
    int rc = lag_sim_advance(v->sim, s->t[i]);
    if (rc < 0) {
      snprintf(v->why, sizeof v->why, "%s", lag_sim_message(v->sim));
      return rc;
    }
    memcpy(s->y + (size_t)i * (size_t)s->n, v->sim->now, (size_t)s->n * sizeof *s->y);
    if (rc == LAG_STOPPED) {
      s->t[i] = lag_sim_time(v->sim);
      s->rows = i + 1;
      break;
    }
  }
  if (v->nstates == 0) {
    record(&recorder, v->sim);
  }
  lag_sim_on_step(v->sim, NULL, NULL);
  return LAG_OK;
}

/* ---- Matching components */

/* Kind of component i of [q|v|z]: 0, 1, 2; *index: its place within that kind. */
static int part_of(const lag_model *m, int i, int *index)
{
  int part = lag_component_kind(m, i);

  *index = i - part * m->nq;
  return part;
}

static const lag_var *var_of(const lag_model *m, int i)
{
  int index, part = part_of(m, i, &index);

  return part < 2 ? &m->q[index] : &m->z[index];
}

/* The component of b with the name and kind of component i of a; -1: there is none. */
static int same_component(const lag_model *a, int i, const lag_model *b)
{
  int index, part = part_of(a, i, &index), n = part < 2 ? b->nq : b->nz;
  const lag_var *vars = part < 2 ? b->q : b->z;
  const char *name = var_of(a, i)->name;

  if (index < n && strcmp(vars[index].name, name) == 0) {
    return part * b->nq + index;
  }
  for (int k = 0; k < n; k++) {
    if (strcmp(vars[k].name, name) == 0) {
      return part * b->nq + k;
    }
  }
  return -1;
}

static const lag_model *model_of(const Variant *v)
{
  return v->sim->scene->model;
}

/* at[a->n] := places of the components of a in b. NULL: no memory. */
static int *places(const Variant *a, const Variant *b)
{
  int *at = calloc((size_t)a->n + 1, sizeof *at);

  for (int i = 0; at && i < a->n; i++) {
    at[i] = same_component(model_of(a), i, model_of(b));
  }
  return at;
}

/* ---- Differences */

static double row_difference(const double *a, const double *b, const int *at, const double *scale, int n)
{
  double most = 0;

  for (int i = 0; i < n; i++) {
    double d = at[i] < 0 ? 0 : fabs(a[i] - b[at[i]]) / scale[i];
    most = d <= HUGE_VAL ? fmax(most, d) : HUGE_VAL;
  }
  return most;
}

int lag_variant_difference(const Variant *scene, const Variant *other, double *difference)
{
  const Samples *a = &scene->run, *b = &other->run;
  int common = a->rows < b->rows ? a->rows : b->rows, *at = places(scene, other);
  double *scale = calloc((size_t)scene->n + 1, sizeof *scale);
  size_t na = (size_t)a->n, nb = (size_t)b->n, last_a = (size_t)a->rows - 1, last_b = (size_t)b->rows - 1;

  if (at && scale) {
    lag_cost_scales(a, scene->sim, scale);
    double most = row_difference(a->y + last_a * na, b->y + last_b * nb, at, scale, a->n);
    for (size_t i = 0; i + 1 < (size_t)common; i++) {
      most = fmax(most, row_difference(a->y + i * na, b->y + i * nb, at, scale, a->n));
    }
    double begun = scene->sim->scene->t0;
    *difference = fmax(most, fabs(a->t[last_a] - b->t[last_b]) / fabs(a->t[last_a] - begun));
  }
  int rc = at && scale ? LAG_OK : LAG_ENOMEM;
  free(at);
  free(scale);
  return rc;
}

/* ---- Weights */

/* Groups of accelerations and rates of states with one unit: group[n] of component i, -1 for rates of coordinates. Returns the number of groups. */
static int group_rates(const lag_model *m, int n, int *group)
{
  int count = 0, index, other;

  for (int i = 0; i < n; i++) {
    group[i] = -1;
    if (part_of(m, i, &index) == 0) {
      continue;
    }
    for (int k = i - 1; k >= m->nq && group[i] < 0 && k > i - 64; k--) { /* neighbours, mostly: 64 bounds the search */
      if (part_of(m, k, &other) == part_of(m, i, &index) && strcmp(var_of(m, k)->unit, var_of(m, i)->unit) == 0) {
        group[i] = group[k];
      }
    }
    group[i] = group[i] < 0 ? count++ : group[i];
  }
  return count;
}

/* dy := rates of v at a state of `along`, whose components stand at[] in v's. Not 0: no values. */
static int rates(const Variant *v, const Variant *along, int state, const int *at, double *y, double *dy)
{
  const double *from = along->y + (size_t)state * (size_t)along->n;

  for (int i = 0; i < v->n; i++) {
    y[i] = 0;
  }
  for (int i = 0; i < along->n; i++) {
    if (at[i] >= 0) {
      y[at[i]] = from[i];
    }
  }
  return lag_rhs(&v->sim->pb, along->t[state], y, dy) || lag_not_finite(v->n, dy) >= 0;
}

typedef struct Weighing {
  const Variant *along, *with, *without;
  int *at_with, *at_without, *same, *group; /* same: components of `with` in `without` */
  int ngroups;
  double *y, *one, *two;      /* a state, rates with and without */
  double *size, *differs;     /* [LAG_VARIANT_STATES * ngroups] |a_with|^2, |a_with - a_without|^2 */
} Weighing;

/* Sums of squares over groups at one state; 0: no values. */
static int weigh_state(const Weighing *w, int state, double *size, double *differs)
{
  if (rates(w->with, w->along, state, w->at_with, w->y, w->one) || rates(w->without, w->along, state, w->at_without, w->y, w->two)) {
    return 0;
  }
  for (int g = 0; g < w->ngroups; g++) {
    size[g] = differs[g] = 0;
  }
  for (int i = 0; i < w->with->n; i++) {
    if (w->group[i] < 0) {
      continue;
    }
    double d = w->same[i] < 0 ? 0 : w->one[i] - w->two[w->same[i]];
    size[w->group[i]] += w->one[i] * w->one[i];
    differs[w->group[i]] += d * d;
  }
  return 1;
}

static double weigh(const Weighing *w)
{
  double most = NAN;
  int n = 0;

  for (int state = 0; state < w->along->nstates; state++) {
    n += weigh_state(w, state, w->size + n * w->ngroups, w->differs + n * w->ngroups);
  }
  for (int g = 0; g < w->ngroups; g++) {
    double mean = 0;
    for (int k = 0; k < n; k++) {
      mean += w->size[k * w->ngroups + g] / n;
    }
    for (int k = 0; k < n; k++) {
      double d = w->differs[k * w->ngroups + g], size = fmax(w->size[k * w->ngroups + g], mean);
      most = d > 0 || size > 0 ? fmax(most, d > 0 ? sqrt(d / size) : 0) : most;
    }
  }
  return most;
}

int lag_variant_weight(const Variant *along, const Variant *with, const Variant *without, double *weight)
{
  size_t n = (size_t)(with->n > without->n ? with->n : without->n) + 1;
  Weighing w = {along, with, without, places(along, with), places(along, without), places(with, without), calloc(n, sizeof(int)), 0,
                calloc(n, sizeof(double)), calloc(n, sizeof(double)), calloc(n, sizeof(double)), NULL, NULL};
  int fine = w.at_with && w.at_without && w.same && w.group && w.y && w.one && w.two;

  if (fine) {
    w.ngroups = group_rates(model_of(with), with->n, w.group);
    w.size = calloc((size_t)w.ngroups * LAG_VARIANT_STATES + 1, sizeof(double));
    w.differs = calloc((size_t)w.ngroups * LAG_VARIANT_STATES + 1, sizeof(double));
    fine = w.size && w.differs;
    *weight = fine ? weigh(&w) : NAN;
  }
  free(w.at_with), free(w.at_without), free(w.same), free(w.group), free(w.y), free(w.one), free(w.two), free(w.size), free(w.differs);
  return fine ? LAG_OK : LAG_ENOMEM;
}

/* ---- Times */

/* Mean time of one call over `loops` passes through all states of the run. */
static double time_calls(Variant *v, int loops, double *dy)
{
  double begun = lag_processor_seconds();

  for (int k = 0; k < loops; k++) {
    for (int i = 0; i < v->nstates; i++) {
      lag_rhs(&v->sim->pb, v->t[i], v->y + (size_t)i * (size_t)v->n, dy);
    }
  }
  return (lag_processor_seconds() - begun) / loops / v->nstates;
}

int lag_variants_time(Variant *v, int n)
{
  enum { ROUNDS = 60 };
  const double turn = 2e-4; /* [s], long beside reading the clock */
  size_t most = 1;

  for (int i = 0; i < n; i++) {
    most = (size_t)v[i].n > most ? (size_t)v[i].n : most;
    v[i].time = v[i].nstates && !v[i].why[0] ? HUGE_VAL : NAN;
  }
  double *dy = calloc(most, sizeof *dy);
  for (int round = 0; dy && round < ROUNDS; round++) {
    for (int i = 0; i < n; i++) {
      if (!isnan(v[i].time)) {
        double per_call = isinf(v[i].time) ? 1e-6 : v[i].time;
        v[i].time = fmin(v[i].time, time_calls(&v[i], (int)fmin(1e4, turn / (per_call * v[i].nstates)) + 1, dy));
      }
    }
  }
  free(dy);
  return dy ? LAG_OK : LAG_ENOMEM;
}
