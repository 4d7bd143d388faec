/* Firing of events, where g changes its sign (event_location.c finds the time). Enters: the time; leaves: the state
 * after the actions. Holds: sign[k] is the sign of g_k just after `from`; an event that has just fired has sign 0
 * ("not known yet") until g has clearly left zero, so it never fires twice for one crossing. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/core.h"
#include "kernels/locate.h"
#include "numeric/dense.h"


/* Signs of the event functions of switches, g: 1 where the branch fits, 0 at the surface. */
static void arm_switches(lag_sim *s, const double *g) {
  int nev = s->scene->model->nev;
  for (int k = nev; k < lag_watched(s); k++) {
    s->noise[k] = lag_switch_noise(s, k - nev);
    s->sign[k] = g[k] > s->noise[k];
  }
}

int lag_events_arm(lag_sim *s) {
  int nev = s->scene->model->nev;
  if (lag_watched(s) == 0) return LAG_OK;
  int rc = lag_events_eval(s, s->run->t, s->now, s->g1);
  for (int k = 0; k < nev && rc == 0; k++) {
    s->sign[k] = lag_sign(s->g1[k]);
    s->noise[k] = 0;
  }
  if (rc == 0) arm_switches(s, s->g1);
  rc = rc ? rc : lag_kicks_begin(s, s->g1);
  return rc ? rc : lag_contact_arm(s, s->g1);
}

int lag_events_inputs_jump(lag_sim *s) {
  int rc = lag_switch_before_events(s);
  rc = rc ? rc : lag_switch_place(s);
  rc = rc ? rc : lag_events_eval(s, s->run->t, s->now, s->g1);
  if (rc == 0) arm_switches(s, s->g1);
  return rc;
}

/* Intervals below this part of a series, or of the run so far, count as 0. */
static const double at_once = 1e-7;

static double time_rounding(const lag_sim *s) { return 4 * DBL_EPSILON * fabs(s->run->t); }

static lag_series series_of(const lag_sim *s, int k) {
  return (lag_series){s->interval[k], s->flight[k], s->shorter[k]};
}

/* The rest of the series of event k, dt after it fired last (kernels/locate.h). */
static double series_rest(lag_sim *s, int k, double dt) {
  lag_series of = series_of(s, k);
  double rest = lag_series_rest(&of, dt, time_rounding(s));
  s->interval[k] = of.interval, s->flight[k] = of.flight, s->shorter[k] = of.shorter;
  return rest;
}

/* Whether the event accumulates. A contact, which goes on at rest, takes the tolerance; a block that rocks loses most
 * of its speed at once. */
static int is_zeno(const lag_sim *s, int k, double rest, int contact) {
  lag_series of = series_of(s, k);
  return lag_series_ends(&of, rest, contact ? fmin(s->tol, at_once) : at_once, contact ? 3 : 10, time_rounding(s));
}

static int fail_zeno(lag_sim *s, int k) {
  return lag_fail(
      s, LAG_EZENO,
      "event %s repeats in ever shorter intervals: %.3g s at t = %s s. Let it stop the run, or make it a contact, "
      "which comes to rest",
      s->scene->model->ev[k].name, s->interval[k], LAG_TEXT(s->run->t));
}

/* Fails where restarts, the last of which is event k, do not advance the time. A series of ever shorter intervals
 * ends by itself, in the time `rest`. */
static int watch_restarts(lag_sim *s, int k, double rest) {
  const lag_model *m = s->scene->model;
  int which = k - m->nev;
  double led;
  if (!lag_restarts_stall(s, &led) || rest < 1000 * led) return LAG_OK;
  if (which >= 0) return lag_switch_fail_zeno(s, which);
  const lag_contact *c = lag_contact_of(m, k);
  if (c && c->impact == k && !c->is_tangent && !c->conditional && !lag_contact_is_closed(s, c))
    return lag_fail(
        s, LAG_EZENO,
        "contact %s strikes at t = %s s again and again, and neither closes nor opens: the dense output of %s is too "
        "rough there; take verlet or dop853, or moreau, which does not locate impacts",
        m->ev[k].name, LAG_TEXT(s->run->t), s->method->name);
  return lag_fail(
      s, LAG_EZENO,
      "at t = %s s event %s and others happen again and again: the last 1000 advanced the time by only %.3g s; %s",
      LAG_TEXT(s->run->t), m->ev[k].name, led,
      c ? "take moreau, which does not locate contacts"
        : "let it stop the run, or set a state from which its function moves away from 0");
}

/* Rounding of event functions at this time: their own, and of those that have fired also the distance from zero. */
static const double *rounding_of_events(const lag_sim *s) {
  int n = lag_watched(s);
  const double *before = s->e + 2, *spread = s->spare;
  double *zero = s->spare + n;
  for (int k = 0; k < n; k++) zero[k] = 16 * spread[k] + (s->root[k] == HUGE_VAL ? 2 * fabs(before[k]) : 0);
  return zero;
}

/* ... and that contacts have changed their forces alone. */
enum { BY_EVENT = 1, BY_KICK = 2, BY_CONTACT = 4 };

/* Whether event k of a contact with friction, or of a constraint with `while`, changes what acts; with a tangent. */
static int changes_forces(const lag_sim *s, int k) {
  const lag_model *m = s->scene->model;
  const lag_contact *c = s->tangent ? lag_contact_of(m, k) : NULL;
  return c && (c->conditional || m->contact_laws) && memcmp(s->hold, s->hold_before, (size_t)m->nu * sizeof *s->hold);
}

/* The state after event k, yb, becomes that of the run. *changed: it was, at this time already. A kick changes
 * neighbouring states where it leaves this one, and is told after it. */
static int replace_state(lag_sim *s, int k, int *changed) {
  int kick = lag_is_kick(s->scene->model, k), more = *changed & (kick ? BY_EVENT : BY_EVENT | BY_KICK);
  double t = s->run->t;
  size_t bytes = (size_t)s->pb.n * sizeof(double);
  if (!kick && memcmp(s->yb, s->now, bytes) == 0 && !changes_forces(s, k))
    return lag_contact_of(s->scene->model, k) || lag_guide_turns(s->scene->model, k) ? lag_tangent_carry(s) : 0;
  int rc = lag_tangent_jump(s, k, more);
  if (rc) return rc;
  *changed |= kick ? BY_KICK : BY_EVENT;
  rc = lag_monitors_jump(s, t, s->now, s->yb);
  memcpy(s->yc, s->now, bytes);
  memcpy(s->now, s->yb, bytes);
  if (kick && s->on_event) s->on_event(s->on_event_context, k, t, s->yc, s->now);
  return rc;
}

/* after := the state y after the action of event k; that of a contact's is found later. */
static int state_after(lag_sim *s, int k, const double *y, double *after, int *stop) {
  const lag_model *m = s->scene->model;
  const double t = s->run->t;
  int nq = m->nq, rc = lag_inputs(&s->pb, t);
  memcpy(after, y, (size_t)s->pb.n * sizeof(double));
  if (rc == 0 && m->act && !lag_contact_of(m, k))
    rc = m->act(m, k, t, y, y + nq, y + 2 * nq, s->p, s->u, after, after + nq, after + 2 * nq, stop, s->work);
  return rc == 0 && lag_not_finite(s->pb.n, after) < 0
             ? LAG_OK
             : lag_fail(s, rc < 0 ? rc : LAG_ENAN, "event %s: its action gives no finite state at t = %s s",
                        m->ev[k].name, LAG_TEXT(t));
}

/* after, set by event k at y, comes to the constraints and contacts that act from there on. who: for messages. */
static int settle(lag_sim *s, int k, const double *y, double *after, const char *who, int ends, const double *zero) {
  const lag_model *m = s->scene->model;
  int of = lag_contact_of(m, k) != NULL, moved = memcmp(after, y, (size_t)s->pb.n * sizeof *y) != 0,
      elsewhere = memcmp(after, y, (size_t)m->nq * sizeof *y) != 0;
  return of || moved ? lag_settle_constraints(s, after, of && !moved ? NULL : who, k, ends, moved + elsewhere, zero)
                     : LAG_OK;
}

int lag_event_effect(lag_sim *s, int k, const double *y, double *after) {
  int stop = 0, rc = state_after(s, k, y, after, &stop);
  return rc ? rc : settle(s, k, y, after, NULL, 0, NULL);
}

/* Applies the action of event k to `now`, by way of yb. *changed: the state has been replaced, BY_ what. */
static int act(lag_sim *s, int k, int *stop, int *changed) {
  const lag_model *m = s->scene->model;
  Run *r = s->run;
  double since = s->count[k] > 0 ? fabs(r->t - s->last[k]) : HUGE_VAL, last = s->last[k];
  r->events++;
  s->first[k] = s->count[k] > 0 ? s->first[k] : r->t;
  s->last[k] = r->t;
  s->count[k]++;
  const lag_contact *of = lag_contact_of(m, k), *contact = of && !of->conditional ? of : NULL;
  int rc = state_after(s, k, s->now, s->yb, stop);
  if (rc) return rc;
  double rest = series_rest(s, k, since);
  if (contact && contact->is_tangent && k == contact->release && lag_switch_relieve(s, k)) {
    *changed |= BY_CONTACT;
    return watch_restarts(s, k, rest);
  }
  int kick = lag_is_kick(m, k), ends = !kick && is_zeno(s, k, rest, contact != NULL);
  if (s->tangent) memcpy(s->hold_before, s->hold, (size_t)(m->nu + m->nmodes) * sizeof *s->hold);
  char who[128];
  snprintf(who, sizeof who, "at t = %.9g s event %s sets a state that", r->t, m->ev[k].name);
  rc = settle(s, k, s->now, s->yb, who, ends, rounding_of_events(s));
  /* a longer rest is that of strokes without restitution, after each of which the contact opens again */
  if (rc == 0 && contact && rest < 1e-3 * fabs(r->t) && lag_contact_is_closed(s, contact))
    s->skipped[k] = fmax(s->skipped[k], rest);
  if (rc == 0 && !kick) rc = watch_restarts(s, k, rest);
  if (rc) return rc;
  int before = *changed;
  /* the set of closed contacts may be another; a force that has a corner goes on from there */
  *changed |= of || lag_guide_turns(m, k) ? BY_CONTACT : 0;
  /* slips back at once: no event */
  int turns = contact && contact->is_tangent && k == contact->impact && !lag_contact_is_closed(s, contact);
  if (turns) r->events--, s->count[k]--, s->last[k] = last;
  if (s->on_event && !turns && !kick) s->on_event(s->on_event_context, k, r->t, s->now, s->yb);
  rc = replace_state(s, k, &before);
  *changed |= before;
  return rc ? rc : ends && !contact ? fail_zeno(s, k) : LAG_OK;
}

/* Signs after the events at t. before: g before the actions; spread: rounding of g; jumps: 1 where g jumps over
 * zero; changed: the state was replaced. */
static int rearm(lag_sim *s, const double *before, const double *spread, const double *jumps, int changed) {
  const lag_model *m = s->scene->model;
  int rc = lag_events_eval(s, s->run->t, s->now, s->g1);
  for (int k = 0; k < m->nev && rc == 0; k++) {
    if (lag_is_kick(m, k)) continue;
    double g = s->g1[k], residue = fabs(before[k]) + 4 * spread[k];
    double same = fmax(2 * residue, 1e-12 * fabs(s->g0[k])); /* g0: a sample of g in this step, for its size */
    int fired = s->root[k] == HUGE_VAL;
    if (fired && jumps[k] != 0.0) { /* g is not near zero on either side */
      s->sign[k] = changed ? 0 : s->sign_end[k];
      s->noise[k] = 0;
    } else if (fired && fabs(g) <= same) {
      s->sign[k] = 0;
      s->noise[k] = fmax(2 * fabs(g), 2 * residue);
    } else if (!fired && !isnan(s->root[k]) && fabs(g - before[k]) <= same) {
      s->sign[k] = -s->sign_end[k]; /* this event is still to come */
    } else if (!fired && g == 0 && before[k] == 0) {
      s->sign[k] = s->sign_end[k]; /* still at zero: the next step finds the crossing at its start */
    } else if (fired || s->sign_end[k] != 0.0 || fabs(g) > s->noise[k]) { /* else: sign not known yet since it fired */
      s->sign[k] = lag_sign(g);
      s->noise[k] = 0;
    }
  }
  if (rc == 0) arm_switches(s, s->g1);
  return rc ? rc : lag_contact_arm(s, s->g1);
}

/* Index of the first event, in order of declaration, that is due now and has not fired; -1: none. */
static int next_due(const lag_sim *s) {
  const Run *r = s->run;
  double together = 4 * DBL_EPSILON * fmax(fabs(r->limit), fabs(r->step_t1));
  int k = 0, nev = lag_watched(s);
  while (k < nev && (isnan(s->root[k]) || !(fabs(s->root[k] - r->limit) <= together))) k++;
  return k < nev ? k : -1;
}

/* The branch of a switch ends, at event k. Fails where that comes to no end. */
static int meet_switch(lag_sim *s, int k) {
  Run *r = s->run;
  double since = s->count[k] > 0 ? fabs(r->t - s->last[k]) : HUGE_VAL;
  s->last[k] = r->t;
  s->count[k]++;
  double rest = series_rest(s, k, since);
  int which = k - s->scene->model->nev,
      rc = is_zeno(s, k, rest, 0) ? lag_switch_fail_zeno(s, which) : watch_restarts(s, k, rest);
  if (rc) return rc;
  lag_switch_meet(s, which);
  return lag_tangent_meet(s, k);
}

/* Branches of switches at the state that events have set; the energy of the new ones is a change by these events. */
static int place_switches(lag_sim *s) {
  if (s->scene->model->nmodes == 0) return LAG_OK;
  int rc = lag_monitors_side(s, s->run->t, s->now, 0);
  rc = rc ? rc : lag_switch_place(s);
  return rc ? rc : lag_monitors_side(s, s->run->t, s->now, 1);
}

/* Modes after the events at this time. */
static int settle_switches(lag_sim *s, int met, int *changed) {
  int rc = *changed ? place_switches(s) : LAG_OK;
  if (*changed && rc == LAG_OK && s->tangent && (met || s->pb.nslide))
    rc = lag_fail(s, LAG_EMETHOD,
                  "at t = %s s an event changes the state where the motion meets a surface or slides: there is no "
                  "tangent over it; end the run before",
                  LAG_TEXT(s->run->t));
  if (*changed) return rc;
  rc = met ? lag_switch_settle(s, changed) : LAG_OK;
  *changed |= met && s->tangent; /* which is at this time already */
  return rc || !*changed ? rc : lag_tangent_corner(s);
}

int lag_events_fire(lag_sim *s) {
  Run *r = s->run;
  int stop = 0, changed = 0, met = 0, nev = s->scene->model->nev;
  double *before = s->e + 2, *spread = s->spare, *jumps = spread + 2 * lag_watched(s);
  int rc = lag_events_eval(s, r->t, s->now, before);
  rc = rc ? rc : lag_events_spread(s, before, spread, jumps);
  rc = rc ? rc : lag_switch_before_events(s);
  for (int k; rc == 0 && (k = next_due(s)) >= 0;) { /* an impact may make others happen at once */
    s->root[k] = HUGE_VAL; /* fired */
    rc = k < nev ? act(s, k, &stop, &changed) : meet_switch(s, k);
    met |= k >= nev;
  }
  rc = rc ? rc : settle_switches(s, met, &changed);
  rc = rc ? rc : rearm(s, before, spread, jumps, changed);
  rc = rc ? rc : lag_tangent_edges(s);
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
