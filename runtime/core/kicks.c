/* Kicks: events (LAG_KICK) at the times t0 + k T, k = 1, 2, ..., whose function is the period T, the same at all
 * states. Enters: the counts of kicks so far; leaves: the time of the next, pb.kick, at which steps end, and the
 * roots of those in a step. Holds: times are products, not sums, so that they carry one rounding. */
#include <float.h>
#include <math.h>

#include "core/core.h"
#include "core/rhs.h"

int lag_is_kick(const lag_model *m, int k) { return k < m->nev && m->ev[k].direction == LAG_KICK; }

static int has_kicks(const lag_model *m) {
  int n = 0;
  for (int k = 0; k < m->nev; k++) n += lag_is_kick(m, k);
  return n > 0;
}

/* The time of the next kick k, with the period T. */
static double next_of(const lag_sim *s, int k, double T) {
  return s->scene->t0 - s->kicks_late + (s->count[k] + 1) * T;
}

/* Rounding of the times of kicks near t. */
static double together(double t) { return 16 * DBL_EPSILON * fabs(t); }

int lag_kicks_begin(lag_sim *s, const double *period) {
  const lag_model *m = s->scene->model;
  for (int k = 0; k < m->nev; k++) {
    if (!lag_is_kick(m, k)) continue;
    if (s->run->dir < 0)
      return lag_fail(s, LAG_EMETHOD, "kick %s: a run backwards would need its inverse; run forwards", m->ev[k].name);
    if (!(period[k] > 0))
      return lag_fail(s, LAG_EINVAL, "kick %s: its period is %s s, and must be positive", m->ev[k].name,
                      LAG_TEXT(period[k]));
    s->count[k] = floor(s->kicks_late / period[k] * (1 + 64 * DBL_EPSILON));
  }
  return LAG_OK;
}

int lag_kicks_plan(lag_sim *s) {
  const lag_model *m = s->scene->model;
  if (!has_kicks(m)) return LAG_OK;
  int rc = lag_events_eval(s, s->run->t, s->now, s->g1);
  s->pb.kick = HUGE_VAL;
  for (int k = 0; k < m->nev && rc == 0; k++)
    if (lag_is_kick(m, k)) s->pb.kick = fmin(s->pb.kick, next_of(s, k, s->g1[k]));
  return rc;
}

double lag_kicks_locate(lag_sim *s, const double *period) {
  const Run *r = s->run;
  double first = r->step_t1;
  for (int k = 0; k < s->scene->model->nev; k++) {
    if (!lag_is_kick(s->scene->model, k)) continue;
    double t = next_of(s, k, period[k]);
    if (t > r->step_t1 + together(r->step_t1)) continue;
    s->root[k] = fmax(r->from, fmin(t, r->step_t1));
    first = fmin(first, s->root[k]);
  }
  return first;
}

int lag_kicks_at_once(lag_sim *s) {
  Run *r = s->run;
  if (!(s->pb.kick - r->t <= together(r->t))) return 0;
  r->have_step = r->pending = 1;
  r->step_t0 = r->step_t1 = r->from = r->limit = r->t;
  lag_copy(s->pb.n, s->now, s->y);
  lag_copy(s->pb.n, s->now, s->y0);
  for (int k = 0; k < lag_watched(s); k++) {
    s->root[k] = NAN;
    s->sign_end[k] = s->sign[k];
  }
  lag_kicks_locate(s, s->g1);
  return 1;
}
