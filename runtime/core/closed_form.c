/* Comparison of a run with closed forms. Enters: states of the run; leaves: the largest differences, and the closed
 * forms behind inputs and modes in s->u, where outputs read them. */
#include <math.h>

#include "core/core.h"

int lag_closed_form_at(lag_sim *s, double t) {
  const lag_scene *c = s->scene;
  int nq = s->pb.nq;
  return c->nexact ? c->exact(c, t, s->begin, s->begin + nq, s->begin + 2 * nq, s->p, s->u,
                              s->u + c->model->nu + c->model->nmodes)
                   : 0;
}

/* Motion minus closed form k, which lag_closed_form_at has computed; of angles the nearest way around. */
static double difference(const lag_sim *s, const double *y, int k) {
  const lag_model *m = s->scene->model;
  int i = s->scene->exact_of[k];
  double d = y[i] - s->u[m->nu + m->nmodes + k];
  return i < m->nq && m->q[i].periodic ? remainder(d, 2 * 3.14159265358979323846) : d;
}

static int forms_at(lag_sim *s, double t) {
  int rc = lag_inputs(&s->pb, t);
  return rc ? rc : lag_closed_form_at(s, t);
}

int lag_closed_form_record(lag_sim *s, double t, const double *y) {
  const lag_scene *c = s->scene;
  if (c->nexact && forms_at(s, t))
    return lag_fail(s, LAG_EMODEL, "the closed forms cannot be computed at t = %s s", LAG_TEXT(t));
  for (int k = 0; k < c->nexact; k++) {
    double d = fabs(difference(s, y, k));
    if (d > s->exact_peak[k] || isnan(d)) { /* a NaN must not be forgotten */
      s->exact_peak[k] = d;
    }
  }
  return LAG_OK;
}

void lag_sim_exact(lag_sim *s, int k, double *largest, double *now) {
  if (!largest || !now) return;
  *largest = *now = NAN;
  if (!s || k < 0 || k >= s->scene->nexact) return;
  double factor = lag_sim_state_info(s, s->scene->exact_of[k], NULL, 0, NULL, 0);
  double d = forms_at(s, s->run->t) ? NAN : difference(s, s->now, k), peak = s->exact_peak[k];

  *now = d / factor;
  *largest = (isnan(d) || fabs(d) > peak ? fabs(d) : peak) / factor;
}
