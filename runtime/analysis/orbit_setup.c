/* Preparation of a periodic motion (periodic_orbit.h): sizes of its linear system, its segments, the states at their
 * begins along the motion from the start. */
#include <math.h>
#include <string.h>

#include "analysis/periodic_orbit.h"

enum { MOST_SEGMENTS = 40 };

void lag_orbit_count(PeriodicOrbit *o) {
  int phases = !o->flow.forced;
  for (int k = 0; k < o->ncharges; k++) phases += o->charge[k] != 0;
  for (int j = 0; j < o->ngroup; j++) phases += o->group[j].n > 0;
  o->rows = o->m * o->n + o->nheld + (o->half ? o->n : 0) + (o->continues ? phases : 0);
  o->cols = o->m * o->n + !o->flow.forced + o->ngroup + (o->continues != 0);
}

static int allocate(PeriodicOrbit *o) {
  size_t n = (size_t)o->n, m = (size_t)o->m, size = (size_t)o->flow.nq + 1, group = (size_t)o->ngroup;
  size_t charges = (size_t)lag_flow_charges(&o->flow);
  lag_orbit_count(o);
  size_t rows = (m + 1) * n + (size_t)o->nheld + charges + group + 1, cols = m * n + 2 + group; /* with continuation */
  const lag_part parts[] = {{&o->y, m * n}, {&o->end, m * n}, {&o->ends, m * n}, {&o->Phi, m * n * n},
      {&o->rates, m * n}, {&o->unit, n}, {&o->turns, n}, {&o->offset, n}, {&o->affine, group * size * size + 1},
      {&o->target, n}, {&o->G, n * n}, {&o->A, rows * cols}, {&o->b, rows},
      {&o->V, cols * cols}, {&o->sigma, cols}, {&o->x, cols + 2 * n}, {&o->saved, m * n * (charges + 2) + cols},
      {&o->across, m * n * charges + 1},
      {&o->w, 4 * size * size + 4 * n}, {&o->re, n}, {&o->im, n}};
  lag_pool_parts(&o->pool, sizeof parts / sizeof *parts, parts);
  o->charge = (int *)(void *)lag_pool_doubles(&o->pool, charges + 1);
  return o->pool.failed ? LAG_ENOMEM : LAG_OK;
}

/* Number of segments, so that small changes grow at most about a hundredfold in each. */
static int count_segments(PeriodicOrbit *o, int m) {
  int n = o->n, most = 1 + 240 / n;
  if (m > 0) return o->reverse ? m + m % 2 : m;
  double *Phi = lag_pool_doubles(&o->pool, (size_t)(n * n)), *y = lag_pool_doubles(&o->pool, (size_t)n), size = 0;
  if (o->pool.failed || lag_flow_run(&o->flow, o->flow.t0, o->T, o->flow.probe->now, y, Phi)) return 1;
  for (int i = 0; i < n; i++)
    for (int j = 0; j < n; j++) size = fmax(size, fabs(Phi[i * n + j]) * o->unit[j] / o->unit[i]);
  most = most < MOST_SEGMENTS ? most : MOST_SEGMENTS;
  m = 1 + (int)(log(fmax(size, 1)) / log(100));
  m = m < most ? m : most;
  return o->reverse ? m + m % 2 : m;
}

/* The begin on the states that `reverse` leaves. */
static void place_begin(PeriodicOrbit *o) {
  const lag_model *m = o->flow.like->scene->model;
  const double turn = 2 * acos(-1);
  double *image = o->x;
  lag_map_apply(o->reverse, o->y, image);
  for (int i = 0; i < o->n; i++)
    o->offset[i] = lag_flow_is_angle(m, i) ? turn * rint((o->y[i] - image[i]) / turn) : 0;
  for (int i = 0; i < o->n; i++) o->y[i] = (o->y[i] + image[i] + o->offset[i]) / 2;
}

/* The states at the begin of segments, along the motion from the start; turns of periodic angles. */
static int place_nodes(PeriodicOrbit *o, const double *y0) {
  int n = o->n, rc = LAG_OK;
  const lag_model *m = o->flow.like->scene->model;
  memcpy(o->y, y0, (size_t)n * sizeof *o->y);
  if (o->reverse) place_begin(o);
  for (int k = 0; k < o->m && rc == LAG_OK; k++) {
    rc = lag_flow_run(&o->flow, o->flow.t0 + o->T * k / o->m, o->T / o->m, o->y + k * n, o->end + k * n, NULL);
    if (k < o->m - 1) memcpy(o->y + (k + 1) * n, o->end + k * n, (size_t)n * sizeof *o->y);
  }
  const double *last = o->end + (o->m - 1) * n, turn = 2 * acos(-1);
  double *image = o->x;
  if (o->closing) lag_map_apply(o->closing, o->y, image);
  else memcpy(image, o->y, (size_t)n * sizeof *image);
  for (int i = 0; i < n && rc == LAG_OK; i++)
    o->turns[i] = lag_flow_is_angle(m, i) ? turn * rint((last[i] - image[i]) / turn) : 0;
  return rc;
}

int lag_orbit_open(PeriodicOrbit *o, lag_sim *like, const lag_algebra *algebra, double T, int m) {
  int rc = lag_flow_open(&o->flow, like);
  if (rc) return rc;
  o->flow.closing = o->closing;
  o->n = o->flow.n;
  o->T = o->time = T;
  o->algebra = algebra;
  if (o->flow.forced) lag_orbit_count_drives(o);
  o->unit = lag_pool_doubles(&o->pool, (size_t)o->n);
  o->x = lag_pool_doubles(&o->pool, 2 * (size_t)o->n);
  if (o->pool.failed) return LAG_ENOMEM;
  if ((rc = lag_orbit_choose_units(o, o->flow.probe->now)) != 0) return rc;
  const double *unit = o->unit;
  o->m = count_segments(o, m);
  if ((rc = allocate(o)) != 0) return rc;
  memcpy(o->unit, unit, (size_t)o->n * sizeof *unit);
  rc = lag_orbit_check_maps(o, &o->flow, T);
  rc = rc ? rc : place_nodes(o, o->flow.probe->now);
  rc = rc ? rc : lag_orbit_list_charges(o);
  if (rc == LAG_OK) lag_orbit_guess_shifts(o);
  return rc;
}

int lag_orbit_settle(PeriodicOrbit *o, int periods) {
  double *y = o->x;
  o->settled = periods;
  int rc = lag_flow_run(&o->flow, o->flow.t0, periods * o->T, o->flow.probe->now, y, NULL);
  return rc ? rc : place_nodes(o, y);
}

void lag_orbit_free(PeriodicOrbit *o) {
  lag_flow_free(&o->flow);
  lag_pool_free(&o->pool);
}
