/* Events: where g changes its sign along the dense output of a step, and what happens there. Enters: a step;
 * leaves: the time of its first event, and later the state after it.
 * Holds: sign[k] is the sign of g_k just after `from`; an event that has just fired has sign 0 ("not known
 * yet") until g has clearly left zero, so it never fires twice for one crossing. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "core/core.h"

enum { SAMPLES = 4, MOST_SAMPLES = 1024, PROBES = 5 };

/* After an event g may leave zero and return within a small part of the step: look there first. */
static const double probe_at[PROBES] = {0x1p-40, 0x1p-32, 0x1p-24, 0x1p-16, 0x1p-8};

int lag_events_eval(lag_sim *s, double t, const double *y, double *g)
{
  const lag_model *m = s->scene->model;
  int rc = lag_inputs(&s->pb, t);

  if (rc == 0) {
    rc = m->events(t, y, y + m->nq, y + 2 * m->nq, s->p, s->u, g, s->work);
  }
  int bad = rc ? -1 : lag_not_finite(m->nev, g);
  if (rc || bad >= 0) {
    return lag_fail(s, rc < 0 ? rc : LAG_ENAN, "event %s: its function is not a number at t = %.17g s",
                    bad >= 0 ? m->ev[bad].name : "", t);
  }
  return LAG_OK;
}

static double sign_of(double g)
{
  return (g > 0) - (g < 0);
}

int lag_events_arm(lag_sim *s)
{
  int nev = s->scene->model->nev;

  if (nev == 0) {
    return LAG_OK;
  }
  int rc = lag_events_eval(s, s->run->t, s->now, s->g1);
  for (int k = 0; k < nev && rc == 0; k++) {
    s->sign[k] = sign_of(s->g1[k]);
    s->noise[k] = 0;
  }
  return rc;
}

/* The state at t of the step, exactly at its ends. */
static void state_at(lag_sim *s, double t, double *y)
{
  size_t bytes = (size_t)s->pb.n * sizeof *y;

  if (t == s->run->step_t1) {
    memcpy(y, s->y, bytes);
  } else if (t == s->run->step_t0) {
    memcpy(y, s->y0, bytes);
  } else {
    s->method->dense(s->method_work, &s->pb, t, y);
  }
}

typedef struct Crossing {
  lag_sim *sim;
  int k, rc;
} Crossing;

static double g_of(void *context, double t)
{
  Crossing *c = context;
  lag_sim *s = c->sim;

  state_at(s, t, s->yc);
  int rc = lag_events_eval(s, t, s->yc, s->g1);
  c->rc = rc ? rc : c->rc;
  return s->g1[c->k];
}

/* Event k between two samples, where its signs differ: its time into root[k]. */
static int find_root(lag_sim *s, int k, double ta, double ga, double tb, double gb)
{
  Crossing c = {s, k, 0};

  s->root[k] = lag_root(g_of, &c, ta, ga, tb, gb);
  return c.rc;
}

/* One sample: g in g1 at tb, after g0 at ta. Sets root[] of the events that fire between. */
static int sample(lag_sim *s, double ta, double tb, int *found)
{
  const lag_model *m = s->scene->model;

  state_at(s, tb, s->yc);
  int rc = lag_events_eval(s, tb, s->yc, s->g1);
  memcpy(s->e + 2, s->g1, (size_t)m->nev * sizeof(double)); /* find_root overwrites g1 */
  const double *g = s->e + 2;
  for (int k = 0; k < m->nev && rc == 0; k++) {
    double now = sign_of(g[k]), was = s->sign_end[k];
    if (was == 0.0) {
      s->sign_end[k] = fabs(g[k]) > s->noise[k] ? now : 0;
    } else if (now == -was) {
      int direction = m->ev[k].direction;
      s->sign_end[k] = now;
      if (direction == 0 || direction == (int)now) {
        rc = find_root(s, k, ta, s->g0[k], tb, g[k]);
        *found = 1;
      }
    }
  }
  memcpy(s->g0, s->e + 2, (size_t)m->nev * sizeof(double));
  return rc;
}

/* limit := the earliest root. */
static void first_root(lag_sim *s)
{
  Run *r = s->run;

  r->pending = 1;
  r->limit = r->step_t1;
  for (int k = 0; k < s->scene->model->nev; k++) {
    if (!isnan(s->root[k]) && (s->root[k] - r->limit) * r->dir < 0) {
      r->limit = s->root[k];
    }
  }
}

/* For methods whose dense output is rough: integrates from (a, ya) to te itself. ya is overwritten. */
static int integrate_to(lag_sim *s, double a, double te, double *y)
{
  int rc = 0;

  s->method->reset(s->method_work, &s->pb);
  while (rc == 0 && (te - a) * s->run->dir > 0) {
    rc = s->method->step(s->method_work, &s->pb, &a, y, te);
  }
  return rc;
}

/* Replaces the step by one that ends at the event k, by false position on the interpolant between a state
 * before it and a state after it; the interpolant's error shrinks with the bracket's distance from the root. */
static int refine(lag_sim *s, int k)
{
  Run *r = s->run;
  int n = s->pb.n, rc = 0;
  size_t bytes = (size_t)n * sizeof(double);
  double te = s->root[k], before = -s->sign_end[k];

  for (int i = 0; i < 12; i++) {
    memcpy(s->ya, s->y0, bytes);
    if ((rc = integrate_to(s, r->step_t0, te, s->ya)) != 0) {
      return lag_explain(s, rc);
    }
    if ((rc = lag_events_eval(s, te, s->ya, s->g1)) != 0) {
      return rc;
    }
    double g = s->g1[k];
    /* Slope along the flow: a secant over the last bits of time would be noise. */
    double dt = 1e-6 * fabs(te - r->step_t0) * r->dir;
    if ((rc = lag_rhs(&s->pb, te, s->ya, s->yb)) != 0) {
      return lag_explain(s, rc);
    }
    for (int j = 0; j < n; j++) {
      s->yb[j] = s->ya[j] + dt * s->yb[j];
    }
    if ((rc = lag_events_eval(s, te + dt, s->yb, s->g1)) != 0) {
      return rc;
    }
    double slope = (s->g1[k] - g) / dt, next = te - g / slope;
    if (g == 0.0 || !isfinite(next) || fabs(next - te) <= 4 * DBL_EPSILON * fabs(te) || slope * r->dir * before >= 0) {
      break;
    }
    if ((next - r->step_t0) * r->dir <= 0 || (next - r->step_t1) * r->dir > 0) {
      break;
    }
    te = next;
  }
  s->root[k] = r->step_t1 = r->limit = te;
  memcpy(s->y, s->ya, bytes);
  return LAG_OK;
}

static int refine_first(lag_sim *s)
{
  for (int k = 0; k < s->scene->model->nev; k++) {
    if (s->root[k] == s->run->limit) {
      return refine(s, k);
    }
  }
  return LAG_OK;
}

/* Where in interval j to look whether the function bends: not at even distances, which a periodic function may
 * share (multiples of the golden ratio, Weyl 1916, between 0.3 and 0.7). */
static double look_at(int j)
{
  return 0.3 + 0.4 * fmod(0.6180339887498949 * j, 1);
}

/* Whether `samples` intervals of the step show the event functions as they are: between two samples none bends
 * by more than a small part of its range. (A sine has then more than six samples a period.) */
static int shows(lag_sim *s, int samples, int *enough)
{
  const double bend_most = 0.15, rounding = 1e-9;
  int nev = s->scene->model->nev;
  double *last = s->spare, *mid = last + nev, *lo = mid + nev, *hi = lo + nev, *bend = hi + nev;
  double span = s->run->step_t1 - s->run->from;

  for (int i = 0; i <= 2 * samples; i++) {
    double part = look_at(i / 2), t = s->run->from + span * (i / 2 + (i % 2 ? part : 0)) / samples;
    t = i == 2 * samples ? s->run->step_t1 : t;
    part = look_at(i / 2 - 1); /* of the point between the last two samples, at the next one */
    state_at(s, t, s->yc);
    int rc = lag_events_eval(s, t, s->yc, s->g1);
    if (rc) {
      return rc;
    }
    for (int k = 0; k < nev; k++) {
      double g = s->g1[k];
      lo[k] = i ? fmin(lo[k], g) : g;
      hi[k] = i ? fmax(hi[k], g) : g;
      bend[k] = i == 0 ? 0 : i % 2 ? bend[k] : fmax(bend[k], fabs(mid[k] - (last[k] + part * (g - last[k]))));
      *(i % 2 ? &mid[k] : &last[k]) = g;
    }
  }
  *enough = 1;
  for (int k = 0; k < nev; k++) {
    *enough &= bend[k] <= bend_most * (hi[k] - lo[k]) || bend[k] <= rounding * fmax(fabs(lo[k]), fabs(hi[k]));
  }
  return LAG_OK;
}

/* How many intervals to look at: an event driven by time may turn many times in one long step. */
static int samples_for(lag_sim *s, int *samples)
{
  int rc = 0, enough = 0;

  for (*samples = SAMPLES; *samples < MOST_SAMPLES; *samples *= 2) {
    rc = shows(s, *samples, &enough);
    if (rc || enough) {
      return rc;
    }
  }
  return rc;
}

int lag_events_locate(lag_sim *s)
{
  Run *r = s->run;
  int nev = s->scene->model->nev, found = 0, rc = 0, unknown = 0, samples = SAMPLES;
  double ta = r->from, span = r->step_t1 - r->from;

  r->limit = r->step_t1;
  r->pending = 0;
  if (nev == 0) {
    return LAG_OK;
  }
  if ((rc = samples_for(s, &samples)) != 0) {
    return rc;
  }
  state_at(s, ta, s->yc);
  rc = lag_events_eval(s, ta, s->yc, s->g0);
  for (int k = 0; k < nev; k++) {
    s->root[k] = NAN;
    s->sign_end[k] = s->sign[k];
    unknown |= s->sign[k] == 0.0;
  }
  for (int i = unknown ? -PROBES : 1; i <= samples && rc == 0 && !found; i++) {
    if (i == 0) {
      continue;
    }
    double tb = i < 0 ? ta : r->from;
    tb = i == samples ? r->step_t1 : r->from + span * (i < 0 ? probe_at[i + PROBES] : (double)i / samples);
    rc = sample(s, ta, tb, &found);
    ta = tb;
  }
  if (rc == 0 && found) {
    first_root(s);
    if (s->method->flags & LAG_METHOD_STEPS_TO) {
      rc = refine_first(s);
    }
  }
  return rc;
}

/* An event that repeats faster and faster (a ball coming to rest) would never let time pass. */
static int zeno(lag_sim *s, int k, double t)
{
  Run *r = s->run;
  double dt = fabs(t - r->zeno_t), since = fabs(t - s->scene->t0);
  int same = r->events > 1 && r->zeno_k == (double)k;

  r->zeno_count = same && dt < r->zeno_dt ? r->zeno_count + 1 : 0;
  r->zeno_k = k;
  r->zeno_t = t;
  r->zeno_dt = dt;
  if (r->zeno_count >= 10 && dt <= 1e-7 * since) {
    return lag_fail(s, LAG_EZENO,
                    "event %s repeats in ever shorter intervals: %.3g s at t = %.17g s. Let it stop the run, or come to rest",
                    s->scene->model->ev[k].name, dt, t);
  }
  return LAG_OK;
}

/* The action of event k on `now`, by way of yb. changed: the state is another one. */
static int act(lag_sim *s, int k, int *stop, int *changed)
{
  const lag_model *m = s->scene->model;
  Run *r = s->run;
  int nq = m->nq, n = s->pb.n;
  size_t bytes = (size_t)n * sizeof(double);

  r->events++;
  s->first[k] = s->count[k] > 0 ? s->first[k] : r->t;
  s->last[k] = r->t;
  s->count[k]++;
  int rc = lag_inputs(&s->pb, r->t);
  memcpy(s->yb, s->now, bytes);
  if (rc == 0 && m->act) {
    rc = m->act(k, r->t, s->now, s->now + nq, s->now + 2 * nq, s->p, s->u, s->yb, s->yb + nq, s->yb + 2 * nq, stop,
                s->work);
  }
  if (rc || lag_not_finite(n, s->yb) >= 0) {
    return lag_fail(s, rc < 0 ? rc : LAG_ENAN, "event %s: its action gives no finite state at t = %.17g s", m->ev[k].name,
                    r->t);
  }
  if (s->on_event) {
    s->on_event(s->on_event_context, k, r->t, s->now, s->yb);
  }
  if (memcmp(s->yb, s->now, bytes) != 0) {
    *changed = 1;
    if ((rc = lag_tangent_refuse(s, k)) != 0) {
      return rc;
    }
    rc = lag_watch_jump(s, r->t, s->now, s->yb);
    memcpy(s->now, s->yb, bytes);
  }
  return rc ? rc : zeno(s, k, r->t);
}

/* Signs after the events at t: g0 are the values before the actions. */
static int rearm(lag_sim *s, const double *before)
{
  const lag_model *m = s->scene->model;
  int rc = lag_events_eval(s, s->run->t, s->now, s->g1);

  for (int k = 0; k < m->nev && rc == 0; k++) {
    double g = s->g1[k], residue = fabs(before[k]);
    double same = fmax(2 * residue, 1e-12 * fabs(s->g0[k])); /* g0: a sample of this step, for the size of g */
    int fired = s->root[k] == HUGE_VAL;
    if (fired && fabs(g) <= same) {
      s->sign[k] = 0;
      s->noise[k] = fmax(2 * fabs(g), 2 * residue);
    } else if (!fired && !isnan(s->root[k]) && fabs(g - before[k]) <= same) {
      s->sign[k] = -s->sign_end[k]; /* it is still to come */
    } else {
      s->sign[k] = sign_of(g);
      s->noise[k] = 0;
    }
  }
  return rc;
}

int lag_events_fire(lag_sim *s)
{
  Run *r = s->run;
  int nev = s->scene->model->nev, stop = 0, changed = 0;
  double *before = s->e + 2, together = 4 * DBL_EPSILON * fmax(fabs(r->limit), fabs(r->step_t1));

  int rc = lag_events_eval(s, r->t, s->now, before);
  for (int k = 0; k < nev && rc == 0; k++) {
    if (!isnan(s->root[k]) && fabs(s->root[k] - r->limit) <= together) {
      s->root[k] = HUGE_VAL; /* fired */
      rc = act(s, k, &stop, &changed);
    }
  }
  rc = rc ? rc : rearm(s, before);
  r->from = r->t;
  r->pending = 0;
  if (changed || r->t == r->step_t1) {
    r->have_step = 0;
    memcpy(s->y, s->now, (size_t)s->pb.n * sizeof(double));
  }
  if (changed || (s->method->flags & LAG_METHOD_STEPS_TO)) {
    s->method->reset(s->method_work, &s->pb);
  }
  if (rc == 0 && !stop && r->have_step != 0.0) {
    rc = lag_events_locate(s);
  }
  return rc ? rc : stop ? LAG_STOPPED : LAG_OK;
}
