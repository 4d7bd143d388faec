/* Units of the components of a periodic motion: their excursions over a period. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "analysis/periodic_orbit.h"

enum { SAMPLES = 64 };

static int of_one_unit(const lag_model *m, int i, int j) {
  const lag_var *a = i < m->nq ? &m->q[i] : i < 2 * m->nq ? &m->q[i - m->nq] : &m->z[i - 2 * m->nq];
  const lag_var *b = j < m->nq ? &m->q[j] : j < 2 * m->nq ? &m->q[j - m->nq] : &m->z[j - 2 * m->nq];
  return (i < m->nq) == (j < m->nq) && (i < 2 * m->nq) == (j < 2 * m->nq) && strcmp(a->unit, b->unit) == 0;
}

int lag_orbit_choose_units(PeriodicOrbit *o, const double *y0) {
  FlowMap *f = &o->flow;
  const lag_model *m = f->like->scene->model;
  lag_sim *sim = lag_flow_sim(f, f->t0, y0);
  double *moved = o->x, *value = moved + o->n;
  int rc = sim ? LAG_OK : LAG_ENOMEM;
  for (int i = 0; i < o->n; i++) moved[i] = 0, value[i] = fabs(y0[i]);
  for (int i = 0; i < m->nq; i++) value[m->nq + i] = fmax(value[m->nq + i], value[i] / o->T);
  for (int k = 1; k <= SAMPLES && rc == LAG_OK; k++) {
    rc = lag_sim_advance(sim, f->t0 + o->T * k / SAMPLES);
    for (int i = 0; i < o->n && rc == LAG_OK; i++) moved[i] = fmax(moved[i], fabs(sim->now[i] - y0[i]));
  }
  if (rc)
    snprintf(f->message, sizeof f->message, "%s",
             rc == LAG_STOPPED  ? "an event ends the motion within a period"
             : rc == LAG_ENOMEM ? "out of memory"
                                : lag_sim_message(sim));
  lag_sim_free(sim);
  for (int i = 0; i < o->n; i++) {
    double most = 0, size = 0;
    for (int j = 0; j < o->n; j++) {
      most = of_one_unit(m, i, j) ? fmax(most, moved[j]) : most;
      size = of_one_unit(m, i, j) ? fmax(size, value[j]) : size;
    }
    o->unit[i] = most > 1e-6 * size && most > 0 ? most : size > 0 ? size : 1;
  }
  return rc;
}
