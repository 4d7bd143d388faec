/* Firing of events, where g changes its sign (event_location.c finds the time). Enters: the time; leaves: the state after the actions. Holds: sign[k] is
 * the sign of g_k just after `from`; an event that has just fired has sign 0 ("not known yet") until g has clearly left zero, so it never fires
 * twice for one crossing. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/core.h"

int lag_events_eval(lag_sim *s, double t, const double *y, double *g) {
  const lag_model *m = s->scene->model;
  int rc = lag_inputs(&s->pb, t);
  if (rc == 0) rc = m->events(t, y, y + m->nq, y + 2 * m->nq, s->p, s->u, g, s->work);
  int bad = rc ? -1 : lag_not_finite(m->nev, g);
  if (rc || bad >= 0) {
    return lag_fail(s, rc < 0 ? rc : LAG_ENAN, "event %s: its function is not a number at t = %s s",
                    bad >= 0 ? m->ev[bad].name : "", LAG_TEXT(t));
  }
  return LAG_OK;
}

static double sign_of(double g) { return (g > 0) - (g < 0); }

int lag_events_arm(lag_sim *s) {
  int nev = s->scene->model->nev;
  if (nev == 0) return LAG_OK;
  int rc = lag_events_eval(s, s->run->t, s->now, s->g1);
  for (int k = 0; k < nev && rc == 0; k++) {
    s->sign[k] = sign_of(s->g1[k]);
    s->noise[k] = 0;
  }
  return rc ? rc : lag_contact_arm(s, s->g1);
}

/* Intervals below this part of the run so far count as 0. */
static const double at_once = 1e-7;

/* Whether event k accumulates: `few` intervals in a row, each shorter than the one before, the last of them, dt, next to nothing (a ball coming
 * to rest would never let time pass; a block that rocks loses most of its speed at once). Others may fire between. */
static int is_zeno(lag_sim *s, int k, double dt, int few) {
  s->shorter[k] = dt < s->interval[k] ? s->shorter[k] + 1 : 0;
  s->interval[k] = dt;
  return s->shorter[k] >= few && dt <= at_once * fabs(s->run->t - s->scene->t0);
}

static int fail_zeno(lag_sim *s, int k) {
  return lag_fail(s, LAG_EZENO,
                  "event %s repeats in ever shorter intervals: %.3g s at t = %s s. Let it stop the run, or make it a contact, "
                  "which comes to rest", s->scene->model->ev[k].name, s->interval[k], LAG_TEXT(s->run->t));
}

/* Fails after 1000 impacts of event k in a row that follow at once (dt since the last) and leave contact c open, since nothing presses there.
 * Some happen; without end where a floor falls away and the first-order path of a method lies below it at once. */
static int fail_chatter(lag_sim *s, int k, const lag_contact *c, double dt) {
  const int most = 1000;
  const double pace = 1e-5; /* of the run so far */
  Run *r = s->run;
  if (lag_contact_is_closed(s, c) || !(dt <= at_once * fabs(r->t - s->scene->t0))) return LAG_OK;
  if (!(fabs(r->t - r->chatter_since) <= pace * fabs(r->t - s->scene->t0))) {
    r->chatter_since = r->t;
    r->chatter = 0;
  }
  if (++r->chatter < most) return LAG_OK;
  return lag_fail(s, LAG_EZENO, "contact %s strikes at t = %s s again and again, and neither closes nor opens: the dense output of %s is too "
                  "rough there; take verlet or dop853", s->scene->model->ev[k].name, LAG_TEXT(r->t), s->method->name);
}

/* Applies the action of event k to `now`, by way of yb. *changed: the state has been replaced. */
static int act(lag_sim *s, int k, int *stop, int *changed) {
  const lag_model *m = s->scene->model;
  Run *r = s->run;
  int nq = m->nq, n = s->pb.n;
  size_t bytes = (size_t)n * sizeof(double);
  double since = s->count[k] > 0 ? fabs(r->t - s->last[k]) : HUGE_VAL;
  r->events++;
  s->first[k] = s->count[k] > 0 ? s->first[k] : r->t;
  s->last[k] = r->t;
  s->count[k]++;
  const lag_contact *contact = lag_contact_of(m, k);
  int rc = lag_inputs(&s->pb, r->t);
  memcpy(s->yb, s->now, bytes);
  if (rc == 0 && m->act && !contact) {
    rc = m->act(k, r->t, s->now, s->now + nq, s->now + 2 * nq, s->p, s->u, s->yb, s->yb + nq, s->yb + 2 * nq, stop,
                s->work);
  }
  if (rc || lag_not_finite(n, s->yb) >= 0) {
    return lag_fail(s, rc < 0 ? rc : LAG_ENAN, "event %s: its action gives no finite state at t = %s s", m->ev[k].name,
                    LAG_TEXT(r->t));
  }
  int ends = is_zeno(s, k, since, contact ? 3 : 10), moved = memcmp(s->yb, s->now, bytes) != 0;
  int elsewhere = memcmp(s->yb, s->now, (size_t)nq * sizeof(double)) != 0;
  if (moved) {
    lag_contact_open(s); /* bodies at rest may have been lifted or thrown */
  }
  if (elsewhere) lag_release_integrals(s);
  if (moved && lag_project(&s->pb, r->t, s->yb, NULL) != 0) {
    return lag_fail(s, LAG_EMODEL, "event %s: its action at t = %s s leaves the constraints: %s", m->ev[k].name, LAG_TEXT(r->t),
                    s->pb.detail ? s->pb.detail : "");
  }
  if (elsewhere) rc = lag_hold_integrals(s, r->t, s->yb);
  if (rc == 0 && (contact || moved)) {
    char who[128];
    snprintf(who, sizeof who, "at t = %.9g s event %s sets a state that", r->t, m->ev[k].name);
    rc = lag_contact_resolve(s, s->yb, contact ? NULL : who, contact ? k : -1, ends);
  }
  if (rc == 0 && contact) rc = fail_chatter(s, k, contact, since);
  if (rc) return rc;
  int more = *changed;
  *changed |= contact != NULL; /* the set of closed contacts may be another */
  if (s->on_event) s->on_event(s->on_event_context, k, r->t, s->now, s->yb);
  if (memcmp(s->yb, s->now, bytes) != 0) {
    if ((rc = lag_tangent_jump(s, k, more)) != 0) return rc;
    *changed = 1;
    rc = lag_monitors_jump(s, r->t, s->now, s->yb);
    memcpy(s->now, s->yb, bytes);
  }
  return rc ? rc : ends && !contact ? fail_zeno(s, k) : LAG_OK;
}

/* Signs after the events at t. before: g before the actions; spread: rounding of g. */
static int rearm(lag_sim *s, const double *before, const double *spread) {
  const lag_model *m = s->scene->model;
  int rc = lag_events_eval(s, s->run->t, s->now, s->g1);
  for (int k = 0; k < m->nev && rc == 0; k++) {
    double g = s->g1[k], residue = fabs(before[k]) + 4 * spread[k];
    double same = fmax(2 * residue, 1e-12 * fabs(s->g0[k])); /* g0: a sample of g in this step, for its size */
    int fired = s->root[k] == HUGE_VAL;
    if (fired && fabs(g) <= same) {
      s->sign[k] = 0;
      s->noise[k] = fmax(2 * fabs(g), 2 * residue);
    } else if (!fired && !isnan(s->root[k]) && fabs(g - before[k]) <= same) {
      s->sign[k] = -s->sign_end[k]; /* this event is still to come */
    } else if (fired || s->sign_end[k] != 0.0 || fabs(g) > s->noise[k]) { /* else: sign not known yet since it fired */
      s->sign[k] = sign_of(g);
      s->noise[k] = 0;
    }
  }
  return rc ? rc : lag_contact_arm(s, s->g1);
}

/* Index of the first event, in order of declaration, that is due now and has not fired; -1: none. */
static int next_due(const lag_sim *s) {
  const Run *r = s->run;
  double together = 4 * DBL_EPSILON * fmax(fabs(r->limit), fabs(r->step_t1));
  int k = 0, nev = s->scene->model->nev;
  while (k < nev && (isnan(s->root[k]) || !(fabs(s->root[k] - r->limit) <= together))) k++;
  return k < nev ? k : -1;
}

int lag_events_fire(lag_sim *s) {
  Run *r = s->run;
  int stop = 0, changed = 0;
  double *before = s->e + 2, *spread = s->spare;
  int rc = lag_events_eval(s, r->t, s->now, before);
  rc = rc ? rc : lag_events_spread(s, before, spread);
  for (int k; rc == 0 && (k = next_due(s)) >= 0;) { /* an impact may make others happen at once */
    s->root[k] = HUGE_VAL; /* fired */
    rc = act(s, k, &stop, &changed);
  }
  rc = rc ? rc : rearm(s, before, spread);
  r->from = r->t;
  r->pending = 0;
  if (changed || r->t == r->step_t1) {
    r->have_step = 0;
    memcpy(s->y, s->now, (size_t)s->pb.n * sizeof(double));
  }
  if (changed) s->method->reset(s->method_work, &s->pb);
  if (rc == 0 && !stop && r->have_step != 0.0) rc = lag_events_locate(s);
  return rc ? rc : stop ? LAG_STOPPED : LAG_OK;
}
