/* Accessors of the public interface: read values, names and units from a simulation; set its hooks. */
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/core.h"

double lag_sim_time(const lag_sim *s) { return s ? s->run->t : NAN; }

const double *lag_sim_q(const lag_sim *s) { return s ? s->now : NULL; }

const double *lag_sim_v(const lag_sim *s) { return s ? s->now + s->pb.nq : NULL; }

const double *lag_sim_z(const lag_sim *s) { return s ? s->now + 2 * s->pb.nq : NULL; }

const double *lag_sim_p(const lag_sim *s) { return s ? s->p : NULL; }

const lag_scene *lag_sim_scene(const lag_sim *s) { return s ? s->scene : NULL; }

const lag_method *lag_sim_method(const lag_sim *s) { return s ? s->method : NULL; }

double lag_sim_tolerance(const lag_sim *s) { return s ? s->tol : NAN; }

const double *lag_sim_options(const lag_sim *s) { return s ? s->options : NULL; }

const char *lag_sim_message(const lag_sim *s) { return s ? s->message : "no simulation"; }

double *lag_sim_output_grid(lag_sim *s) { return &s->run->row_origin; }

void lag_sim_on_step(lag_sim *s, int (*hook)(void *, const lag_sim *), void *context) {
  if (!s) return;
  s->on_step = hook;
  s->on_step_context = context;
}

long long lag_sim_event_times(const lag_sim *s, int k, double *first, double *last) {
  if (!first || !last) return 0;
  *first = *last = NAN;
  if (!s || k < 0 || k >= s->scene->model->nev) return 0;
  *first = s->count[k] > 0 ? s->first[k] : NAN;
  *last = s->count[k] > 0 ? s->last[k] : NAN;
  return (long long)s->count[k];
}

void lag_sim_on_event(lag_sim *s, lag_event_fn *hook, void *context) {
  if (!s) return;
  s->on_event = hook;
  s->on_event_context = context;
}

int lag_sim_noutputs(const lag_sim *s) { return s ? s->scene->nout > 0 ? s->scene->nout : s->pb.n : 0; }

double lag_sim_requested_start(const lag_sim *s, int i) {
  if (!s || i < 0 || i >= s->pb.n) return NAN;
  return lag_sim_declared(s, i, s->asked[i]);
}

double lag_sim_other_start(const lag_sim *s, int i) {
  if (!s || i < 0 || i >= s->pb.nq) return NAN;
  return lag_sim_declared(s, i, s->elsewhere[i]);
}

double lag_sim_actual_start(const lag_sim *s, int i) {
  if (!s || i < 0 || i >= s->pb.n) return NAN;
  return lag_sim_declared(s, i, s->begin[i]);
}

int lag_sim_rank(const lag_sim *s) { return s ? (int)s->run->rank : 0; }

int lag_sim_is_redundant(const lag_sim *s, int k) {
  if (!s || k < 0 || !s->scene->model->constraints || k >= s->scene->model->constraints->n) return 0;
  return s->redundant[k] != 0.0;
}

int lag_sim_nearby_rank(const lag_sim *s) { return s ? (int)s->run->beside : 0; }

int lag_sim_is_undetermined(const lag_sim *s, int i) {
  if (!s || i < 0 || i >= s->pb.nq) return 0;
  return s->loose[i] != 0.0;
}

int lag_observe(lag_sim *s, double t, const double *y, double *out) {
  /* with independence i, forces have an error of rounding/i^2 and of the state's error/i^2 */
  const double doubtful = 1e-3;
  const lag_scene *c = s->scene;
  int impulses = s->pb.contacts && c->forces && c->model->ncontacts, start = impulses && s->pb.contacts->length == 0.0;
  if (start) lag_contact_show_start(s, y);
  int weakest, rc = lag_inputs_at(&s->pb, t, y);
  if (start) lag_contact_open(s);
  rc = rc ? rc : lag_closed_form_at(s, t);
  if (rc == 0 && impulses && !start) lag_contact_show(s);
  rc = rc ? rc : c->observe(c, t, y, y + s->pb.nq, y + 2 * s->pb.nq, s->p, s->u, out, s->work);
  if (rc == 0 && c->forces && c->model->constraints && lag_independence(&s->pb, t, y, &weakest) < doubtful)
    for (int i = 0; i < c->nout; i++) out[i] = c->forces[i] ? NAN : out[i];
  return rc;
}

static int outputs(lag_sim *s, double t, const double *y, double *out) {
  const lag_scene *c = s->scene;
  int rc = 0, nout = lag_sim_noutputs(s);
  if (c->nout > 0) {
    if ((rc = lag_observe(s, t, y, out)) != 0)
      return lag_fail(s, rc < 0 ? rc : LAG_EDOMAIN, "the outputs cannot be computed at t = %s s", LAG_TEXT(t));
  } else {
    for (int i = 0; i < nout; i++) out[i] = lag_sim_declared(s, i, y[i]);
  }
  for (int i = 0; i < c->nout; i++) out[i] = lag_declared(&c->outputs[i], out[i]);
  return LAG_OK;
}

int lag_sim_outputs(lag_sim *s, double *out) {
  if (!s || !out) return LAG_EINVAL;
  return outputs(s, s->run->t, s->now, out);
}

int lag_sim_outputs_at(lag_sim *s, double t, double *y, double *out) {
  if (!out) return LAG_EINVAL;
  int rc = lag_sim_eval(s, t, y);

  return rc ? rc : outputs(s, t, y, out);
}

int lag_dense_state(lag_sim *s, double t, double *y) {
  s->method->dense(s->method_work, &s->pb, t, y);
  s->pb.detail = NULL;
  int rc = lag_project(&s->pb, t, y, NULL);
  return rc ? lag_explain(s, rc > 0 ? LAG_EMETHOD : rc) : LAG_OK;
}

int lag_sim_eval(lag_sim *s, double t, double *y) {
  if (!s || !y || !isfinite(t)) return LAG_EINVAL;
  const Run *r = s->run;
  size_t bytes = (size_t)s->pb.n * sizeof(double);

  if (t == r->t) {
    memcpy(y, s->now, bytes);
    return LAG_OK;
  }
  if (r->have_step == 0.0 || (t - r->step_t0) * r->dir < 0 || (t - r->limit) * r->dir > 0) return LAG_EINVAL;
  if (t == r->step_t1) {
    memcpy(y, s->y, bytes);
    return LAG_OK;
  }
  return lag_dense_state(s, t, y);
}
