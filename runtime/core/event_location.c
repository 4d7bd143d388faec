/* Event location: an instance of kernels/locate.h along the dense output of a step. Enters: a step, and
 * the signs of g just after run->from; leaves: the time of its first event. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"
#include "kernels/locate.h"

/* y[n] := the state at time t of the step, exact at its ends. loosely: else dense output beside the constraints. */
static int state_at(lag_sim *s, int loosely, double t, double *y) {
  size_t bytes = (size_t)s->pb.n * sizeof *y;
  if (t == s->run->step_t1) memcpy(y, s->y, bytes);
  else if (t == s->run->step_t0) memcpy(y, s->y0, bytes);
  else if (loosely) s->method->dense(s->method_work, &s->pb, t, y);
  else return lag_dense_state(s, t, y);
  return LAG_OK;
}

/* g[nev] := the event functions at time t of the step; shaken: with t and the state changed in their last digits. */
static int sample_state(lag_sim *s, int loosely, int shaken, double t, double *g) {
  double last = shaken ? 4 * DBL_EPSILON : 0;
  int rc = state_at(s, loosely, t, s->yc);
  for (int j = 0; j < s->pb.n && shaken; j++)
    s->yc[j] += (j % 2 ? -last : last) * (fabs(s->yc[j]) + fabs(s->y[j] - s->y0[j]));
  return rc ? rc : lag_events_eval(s, t * (1 + last), s->yc, g);
}

static int sample(void *sim, int shaken, double t, double *g) { return sample_state(sim, 0, shaken, t, g); }

/* The same beside the constraints. A gap on the other side of a closed one counts from there. */
static int sample_loosely(void *sim, int shaken, double t, double *g) {
  lag_sim *s = sim;
  int rc = sample_state(s, 1, shaken, t, g);
  return rc ? rc : lag_contact_pairs(s, t, s->yc, g);
}

static int direction(void *sim, int k) {
  const lag_sim *s = sim;
  const lag_model *m = s->scene->model;
  if (k >= m->nev || lag_contact_of(m, k)) return LAG_LOCATE_UNSEEN;
  return k + 1 == s->forwards && s->pb.dir < 0 && m->ev[k].direction != LAG_KICK ? -m->ev[k].direction
                                                                              : m->ev[k].direction;
}

static lag_locator locator(lag_sim *s) {
  return (lag_locator){lag_watched(s), sample,   direction, s,      DBL_EPSILON,
                       0x1p-40,        s->sign_end, s->noise,  s->root, s->spare};
}

/* Marks jumps, of the events due now, whose functions go on at some distance from zero, as sign(x) does: from one
 * sample to the next (2^-50 of t) values on the same side hardly change, and the change over zero is no rounding.
 * at_event: values now; rounding: scratch. */
static int confirm_jumps(lag_sim *s, const double *at_event, const double *spread, double *jumps, double *rounding) {
  const Run *r = s->run;
  int nev = lag_watched(s), some = 0, rc = 0;
  for (int k = 0; k < nev; k++) some |= jumps[k] != 0.0;
  const lag_locator l = locator(s);
  if (some) rc = lag_locate_rounding(&l, r->from + (r->limit - r->from) / 2, rounding);
  for (int k = 0; k < nev && some && rc == 0; k++)
    jumps[k] = jumps[k] != 0.0 && fmax(spread[k], fabs(at_event[k])) > 1000 * rounding[k];
  return rc;
}

int lag_events_spread(lag_sim *s, const double *at_event, double *spread, double *jumps) {
  const Run *r = s->run;
  int nev = lag_watched(s), rc = 0;
  double last = 4 * DBL_EPSILON * fmax(fabs(r->step_t0), fabs(r->step_t1)), *previous = jumps + nev;
  for (int k = 0; k < nev; k++) {
    spread[k] = previous[k] = 0;
    jumps[k] = k < s->scene->model->nev && !lag_is_kick(s->scene->model, k) && fabs(s->root[k] - r->limit) <= last;
  }
  for (int i = -2; i <= 2 && rc == 0; i++) {
    double t = r->limit + i * last * r->dir;
    if (i != 0 && ((t - r->from) * r->dir < 0 || (t - r->step_t1) * r->dir > 0)) continue;
    const double *g = i ? s->g1 : at_event;
    rc = i ? sample(s, 0, t, s->g1) : 0;
    for (int k = 0; k < nev && rc == 0; k++) {
      spread[k] = fmax(spread[k], fabs(g[k] - at_event[k]));
      if (previous[k] * g[k] > 0 && fabs(g[k] - previous[k]) > fabs(g[k]) / 4) jumps[k] = 0;
      previous[k] = g[k];
    }
  }
  return rc ? rc : confirm_jumps(s, at_event, spread, jumps, previous);
}

/* Whether no switch can end its branch in the step, as the parabola through three values of each event function
 * shows; row 0 is the first of them. A step resolves the motion, so that functions of the state are smooth on it;
 * those that contain t are searched, and so are events. */
static int is_quiet(lag_sim *s, int *rc) {
  const lag_model *m = s->scene->model;
  const Run *r = s->run;
  double *first = s->spare, *mid = first + lag_watched(s), *last = mid + lag_watched(s);
  int quiet = m->nev == 0;
  for (int k = 0; k < m->nmodes && quiet; k++) quiet = !m->switches[k].is_timed && s->sign[k] > 0 && s->pb.nslide == 0;
  if (!quiet) return 0;
  *rc = sample(s, 0, r->from + (r->step_t1 - r->from) / 2, mid);
  *rc = *rc ? *rc : sample(s, 0, r->step_t1, last);
  for (int k = 0; k < m->nmodes && quiet && *rc == 0; k++) {
    double least = fmin(fmin(first[k], mid[k]), last[k]), bend = fabs(first[k] - 2 * mid[k] + last[k]);
    quiet = least > fabs(last[k] - first[k]) / 2 + 4 * bend;
  }
  return quiet && *rc == 0;
}

/* Whether no function changes its sign at the samples of a step that resolves all, beside the constraints, by far more
 * than the way back there changes them; that costs a Newton iteration a sample. Row 0 is the first of them. */
static int is_clear(lag_sim *s) {
  const int n = lag_watched(s), far = 16;
  lag_locator l = locator(s);
  double ta = s->run->from, tb = s->run->step_t1, *exact = l.value + (LAG_LOCATE_ROWS - 1) * n, *apart = exact - n;
  int known = 0, most = 0, clear = s->scene->model->constraints != NULL;
  l.sample = sample_loosely;
  if (!clear || lag_sample_part(&l, ta, tb, &known, &most) || most) return 0;
  for (int k = 0; k < n; k++) apart[k] = 0;
  for (int j = LAG_DEGREE / 4; j < LAG_DEGREE && clear; j += LAG_DEGREE / 2 - 1) {
    clear = sample(s, 0, lag_locate_time(ta, tb, j), exact) == LAG_OK;
    for (int k = 0; k < n; k++) apart[k] = fmax(apart[k], far * fabs(exact[k] - l.value[j * n + k]));
  }
  for (int j = 1; j <= LAG_DEGREE && clear; j++)
    for (int k = 0; k < n && clear; k++) {
      double g = l.value[j * n + k];
      clear = s->sign[k] == 0.0 ? fabs(g) + apart[k] <= s->noise[k] : s->sign[k] * g > apart[k];
    }
  return clear;
}

/* limit := the earliest root; pending: whether there is one. Roots are late by s->late. */
static void first_root(lag_sim *s) {
  Run *r = s->run;
  r->limit = r->step_t1;
  for (int k = 0; k < lag_watched(s); k++) {
    if (isnan(s->root[k])) continue;
    double later = s->root[k] + r->dir * s->late * fabs(s->root[k]);
    if (s->late > 0 && !lag_is_kick(s->scene->model, k))
      s->root[k] = (later - r->step_t1) * r->dir < 0 ? later : r->step_t1;
    r->pending = 1;
    if ((s->root[k] - r->limit) * r->dir < 0) r->limit = s->root[k];
  }
}

LAG_RARE int locate_first(lag_sim *s, int nev) {
  const Run *r = s->run;
  int found, unknown = 0;
  for (int k = 0; k < nev; k++) {
    s->root[k] = NAN;
    s->sign_end[k] = s->sign[k];
    unknown |= s->sign[k] == 0.0;
  }
  const lag_locator l = locator(s);
  int rc = sample(s, 0, r->from, l.value);
  if (rc == 0 && !unknown && is_quiet(s, &rc)) return LAG_OK;
  if (rc == 0 && is_clear(s)) return LAG_OK;
  rc = rc ? rc : lag_locate(&l, r->from, lag_kicks_locate(s, l.value), &found); /* roots of kicks are known before */
  memcpy(s->g0, l.value, (size_t)nev * sizeof(double));
  if (rc == 0) first_root(s);
  return rc;
}

int lag_events_locate(lag_sim *s) {
  Run *r = s->run;
  int nev = lag_watched(s);
  r->limit = r->step_t1;
  r->pending = 0;
  const lag_model *m = s->scene->model;
  int met = 0; /* contacts and guides that are met by impulses have no other events */
  for (int i = 0; i < m->nguides && s->pb.contacts; i++) met += m->guides[i].turn >= 0;
  for (int i = 0; i < m->ncontacts && s->pb.contacts; i++) met += m->contacts[i].conditional ? 0 : 2;
  return nev == met ? LAG_OK : locate_first(s, nev);
}
