/* Events next to which a branch of periodic motions ends (periodic_orbit.h). */
#include <math.h>
#include <stdlib.h>

#include "analysis/periodic_orbit.h"
#include "numeric/release.h"

const char *lag_orbit_event_at_begin(PeriodicOrbit *o) {
  const lag_model *m = o->flow.like->scene->model;
  const char *name = NULL;
  double near = 0.01 * o->T / o->m, first, last;
  for (int k = 0; k < o->m && !name; k++) {
    double begin = o->flow.t0 + o->T * k / o->m, end = begin + o->T / o->m;
    lag_sim *sim = lag_flow_sim(&o->flow, begin, o->y + k * o->n);
    for (int j = 0; sim && j < m->nev && lag_sim_advance(sim, end) == LAG_OK; j++) {
      if (lag_is_kick(m, j) || lag_sim_event_times(sim, j, &first, &last) <= 0) continue;
      if (first < begin + near || last > end - near) name = m->ev[j].name;
    }
    lag_sim_free(sim);
  }
  return name;
}

/* Function of an event along a motion: its range, its last values, and the least that lies between larger ones of its
 * sign, and when. */
typedef struct Graze {
  double low, high, past[2], least, at;
  long long count[2];
} Graze;

/* Takes value g of event j at time t; step: time between values. */
static void look_at_event(Graze *z, const lag_sim *sim, int j, double t, double step, double g) {
  double first, last, a = fabs(z->past[0]), b = fabs(z->past[1]), c = fabs(g), bend = a + c - 2 * b;
  long long count = lag_sim_event_times(sim, j, &first, &last);
  int apart = z->count[0] == count && z->past[0] * z->past[1] > 0 && z->past[1] * g > 0;
  if (apart && b <= a && b <= c && bend > 0 && b - (c - a) * (c - a) / (8 * bend) < z->least) {
    z->least = b - (c - a) * (c - a) / (8 * bend);
    z->at = t - step - step * (c - a) / (2 * bend);
  }
  z->low = fmin(z->low, g), z->high = fmax(z->high, g);
  z->past[0] = z->past[1], z->past[1] = g;
  z->count[0] = z->count[1], z->count[1] = count;
}

const char *lag_orbit_grazes(PeriodicOrbit *o, double *time) {
  enum { GRAZE_LOOKS = 500 };
  const double near = 1e-3; /* of the range of its function */
  const lag_model *m = o->flow.like->scene->model;
  const char *name = NULL;
  double length = o->T / o->m, *g = malloc(((size_t)m->nev + 1) * sizeof *g);
  Graze *z = malloc(((size_t)m->nev + 1) * sizeof *z);
  for (int j = 0; j < m->nev && z; j++) z[j] = (Graze){HUGE_VAL, -HUGE_VAL, {0, 0}, HUGE_VAL, 0, {-1, -1}};
  for (int k = 0; k < o->m && g && z; k++) {
    double begin = o->flow.t0 + length * k, step = length / GRAZE_LOOKS;
    lag_sim *sim = lag_flow_sim(&o->flow, begin, o->y + k * o->n);
    for (int j = 0; j < m->nev; j++) z[j].past[1] = 0;
    for (int i = 0; sim && i <= GRAZE_LOOKS && lag_sim_advance(sim, begin + step * i) == LAG_OK; i++) {
      if (lag_events_eval(sim, begin + step * i, sim->now, g)) break;
      for (int j = 0; j < m->nev; j++)
        if (!lag_is_kick(m, j)) look_at_event(&z[j], sim, j, begin + step * i, step, g[j]);
    }
    lag_sim_free(sim);
  }
  for (int j = 0; j < m->nev && z; j++)
    if (z[j].least < near * (z[j].high - z[j].low)) name = m->ev[j].name, *time = z[j].at;
  lag_free_all(g, z);
  return name;
}
