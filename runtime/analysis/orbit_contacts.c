/* Contacts that are closed where a periodic motion begins (periodic_orbit.h): its multipliers are those of
 * disturbances that keep them closed. Runs from a push that opens them tell whether they close again. */
#include <math.h>
#include <string.h>

#include "analysis/periodic_orbit.h"

static const lag_contact *closed_contact(const lag_sim *sim, int k) {
  const lag_contact *c = &sim->scene->model->contacts[k];
  return c->is_tangent || c->conditional || !lag_contact_is_closed(sim, c) ? NULL : c;
}

/* d[n] := a velocity across the constraints at the state of sim, in units; 0: there is none. */
static int across(const PeriodicOrbit *o, lag_sim *sim, Pool *pool, double *d) {
  int n = o->n, nq = o->flow.nq;
  double *P = lag_pool_doubles(pool, (size_t)(n * n)),
         *scratch = lag_pool_doubles(pool, lag_tangent_projection_size(&sim->pb) + 1), size = 0;
  if (pool->failed) return LAG_ENOMEM;
  for (int e = 0; e < n * n; e++) P[e] = e % (n + 1) == 0;
  if (lag_tangent_project(&sim->pb, o->flow.t0, sim->now, n, P, scratch)) return 0;
  for (int j = nq; j < 2 * nq; j++)
    for (int i = nq; i < 2 * nq; i++) d[i] += (1 + 0.31 * j) * ((i == j) - P[i * n + j]) * o->unit[j];
  for (int i = nq; i < 2 * nq; i++) size = fmax(size, fabs(d[i]) / o->unit[i]);
  for (int i = nq; i < 2 * nq && size > 0; i++) d[i] /= size;
  return size > 0;
}

/* *name := a contact of `sim` that is open, a period after a push by d. 0, or LAG_ENOMEM. */
static int push(PeriodicOrbit *o, const lag_sim *sim, const double *d, double part, double *y, const char **name) {
  const lag_model *m = sim->scene->model;
  for (int i = 0; i < o->n; i++) y[i] = o->y[i] + part * d[i];
  lag_sim *beside = lag_flow_sim(&o->flow, o->flow.t0, y);
  if (!beside) return LAG_ENOMEM;
  if (lag_sim_advance(beside, o->flow.t0 + o->T) == LAG_OK)
    for (int k = 0; k < m->ncontacts; k++)
      if (closed_contact(sim, k) && !closed_contact(beside, k)) *name = m->ev[m->contacts[k].impact].name;
  lag_sim_free(beside);
  return LAG_OK;
}

int lag_orbit_contacts(PeriodicOrbit *o) {
  const double part = 1e-4;
  const lag_model *m = o->flow.like->scene->model;
  Pool pool = {0};
  double *d = lag_pool_doubles(&pool, (size_t)o->n), *y = lag_pool_doubles(&pool, (size_t)o->n);
  lag_sim *sim = m->ncontacts ? lag_flow_sim(&o->flow, o->flow.t0, o->y) : NULL;
  int rc = pool.failed || (m->ncontacts && !sim) ? LAG_ENOMEM : LAG_OK;
  if (rc == LAG_OK && sim && lag_sim_advance(sim, o->flow.t0) == LAG_OK) {
    for (int k = 0; k < m->ncontacts; k++)
      if (closed_contact(sim, k)) o->closed = m->ev[m->contacts[k].impact].name;
    int found = o->closed ? across(o, sim, &pool, d) : 0;
    if (found == 1) rc = push(o, sim, d, part, y, &o->opens);
    if (found == 1 && rc == LAG_OK) rc = push(o, sim, d, -part, y, &o->opens);
  }
  lag_sim_free(sim);
  lag_pool_free(&pool);
  return rc;
}
