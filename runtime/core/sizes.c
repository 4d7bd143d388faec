/* Sizes of the quantities of a model: what rounding is relative to. Enters: a state; leaves: the size of the terms that
 * make a quantity, which counts where the quantity is their rounding. Holds: with other units, or another part at rest
 * beside, each size has the same ratio to its quantity. */
#include <math.h>
#include <string.h>

#include "core/core.h"

static const double moved = 1. / 1024; /* relative change of a state that shows terms that cancel */

double lag_above_rounding(double size, double terms) {
  const double rounding = 1e-12; /* of a few thousand operations */
  return size > rounding * terms || !(terms < HUGE_VAL) ? size : terms;
}

/* s->ya := y, each component times 1 + moved. */
static const double *moved_state(lag_sim *s, const double *y) {
  for (int i = 0; i < s->pb.n; i++) s->ya[i] = y[i] * (1 + moved);
  return s->ya;
}

/* e[2] := the energy and its scale; NaN where there is none. */
static void energy_at(lag_sim *s, double t, const double *y, double *e) {
  const lag_model *m = s->scene->model;
  int nq = m->nq, bad = !m->energy || lag_inputs_at(&s->pb, t, y);
  if (bad || m->energy(t, y, y + nq, y + 2 * nq, s->p, s->u, e, s->work)) e[0] = e[1] = NAN;
}

double lag_energy_terms(lag_sim *s, double t, const double *y) {
  double e[2], beside[2], calls = s->pb.rhs_calls;
  energy_at(s, t, y, e);
  energy_at(s, t, moved_state(s, y), beside);
  s->pb.rhs_calls = calls;
  return lag_above_rounding(fmax(e[1], fabs(e[0])), fabs(beside[0] - e[0]) / moved);
}

double lag_output_terms(lag_sim *s, double t, const double *y, int k) {
  if (lag_observe(s, t, y, s->out)) return NAN;
  double at = s->out[k];
  if (lag_observe(s, t, moved_state(s, y), s->out)) return fabs(at);
  return lag_above_rounding(fabs(at), fabs(s->out[k] - at) / moved);
}

/* Whether coordinate i is the first of its unit. */
static int is_first(const lag_model *m, int i) {
  for (int k = 0; k < i; k++)
    if (strcmp(m->q[k].unit, m->q[i].unit) == 0) return 0;
  return 1;
}

/* The velocity of all coordinates with the unit of coordinate i at which they have this kinetic energy; HUGE_VAL: there is
 * none. */
static double velocity_of(lag_sim *s, double t, const double *y, int i, double energy) {
  enum { MOST = 60 };
  const lag_model *m = s->scene->model;
  double rest[2], e[2], h = 1, far = 1e4;
  int nq = m->nq;
  memcpy(s->ya, y, (size_t)s->pb.n * sizeof(double));
  memset(s->ya + nq, 0, (size_t)nq * sizeof(double));
  energy_at(s, t, s->ya, rest);
  for (int k = 0; k < MOST; k++) {
    for (int j = 0; j < nq; j++)
      if (strcmp(m->q[j].unit, m->q[i].unit) == 0) s->ya[nq + j] = h;
    energy_at(s, t, s->ya, e);
    double ratio = fabs(e[0] - rest[0]) / energy;
    if (ratio > 0.25 && ratio < 4) return h;
    if (ratio > 1e-3 && ratio < HUGE_VAL) h /= sqrt(ratio);
    else if (ratio <= 1e-3) h *= far;
    else h /= (far = sqrt(far)); /* beyond the domain of L, as the speed of light */
  }
  return HUGE_VAL;
}

void lag_velocity_terms(lag_sim *s, double t, const double *y, double *v) {
  const lag_model *m = s->scene->model;
  double energy = lag_energy_terms(s, t, y);
  int known = energy > 0 && energy < HUGE_VAL && !(m->flags & LAG_FIRST_ORDER);
  for (int i = 0; i < m->nq; i++) {
    if (!is_first(m, i)) continue;
    double of = known ? velocity_of(s, t, y, i, energy) : HUGE_VAL;
    for (int k = i; k < m->nq; k++) v[k] = k == i || strcmp(m->q[k].unit, m->q[i].unit) == 0 ? of : v[k];
  }
}
