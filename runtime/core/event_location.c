/* Event location: where g changes its sign along the dense output of a step. Enters: a step, and the signs of g just after run->from; leaves: the
 * time of its first event. A part of the step is resolved when the polynomial of degree 8 through nine values of g has no zero there, or is
 * monotonic; otherwise it is halved. So crossings are found one by one, however short the time between them. Chebyshev coefficients bound the error
 * of the polynomial: J.P. Boyd, Chebyshev and Fourier Spectral Methods, 2nd ed. (2001), ch. 2.12; the subdivision is J.P. Boyd, J. Eng. Math. 56
 * (2006) 203, DOI 10.1007/s10665-006-9087-5. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "core/core.h"
#include "numeric/root.h"

enum {
  N = 8,            /* degree */
  MOST_ROUGH = 12,  /* halvings where g is not resolved: 4096 parts a step, of nine values each */
  MOST_HALVINGS = 30, /* halvings where g is resolved, and touches zero */
  PROBES = 5
};

/* After an event g may leave zero and return within a small part of the step: probe there first. */
static const double probe_at[PROBES] = {0x1p-40, 0x1p-32, 0x1p-24, 0x1p-16, 0x1p-8};

/* cos(pi m/8). */
static const double cosine[2 * N] = {1,  0.92387953251128674, 0.70710678118654752, 0.38268343236508977,
                                     0,  -0.38268343236508977, -0.70710678118654752, -0.92387953251128674,
                                     -1, -0.92387953251128674, -0.70710678118654752, -0.38268343236508977,
                                     0,  0.38268343236508977, 0.70710678118654752, 0.92387953251128674};

static double sign_of(double g) { return (g > 0) - (g < 0); }

/* y[n] := the state at time t of the step, exact at its ends. */
static int state_at(lag_sim *s, double t, double *y) {
  size_t bytes = (size_t)s->pb.n * sizeof *y;
  if (t == s->run->step_t1) memcpy(y, s->y, bytes);
  else if (t == s->run->step_t0) memcpy(y, s->y0, bytes);
  else return lag_dense_state(s, t, y);
  return LAG_OK;
}

/* g[nev] := the event functions at time t of the step. */
static int g_at(lag_sim *s, double t, double *g) {
  int rc = state_at(s, t, s->yc);
  return rc ? rc : lag_events_eval(s, t, s->yc, g);
}

/* ---- one crossing */

typedef struct Crossing {
  lag_sim *sim;
  int k, rc;
  double lift; /* shift of g */
} Crossing;

static double g_of(void *context, double t) {
  Crossing *c = context;
  int rc = g_at(c->sim, t, c->sim->g1);
  c->rc = rc ? rc : c->rc;
  return c->sim->g1[c->k] + c->lift;
}

/* root[k] := the zero of g + lift; the end of a step may be one. A change of sign at a pole is none: there g exceeds both samples beyond measure. */
static int find_crossing(lag_sim *s, int k, double lift, double ta, double ga, double tb, double gb, int *found) {
  const double pole = 100;
  const lag_model *m = s->scene->model;
  Crossing c = {s, k, 0, lift};
  int may_be_pole = k < m->nev && !lag_contact_of(m, k);
  s->root[k] = ga + lift == 0 ? ta : ga + lift > 0 || gb + lift > 0 ? lag_root(g_of, &c, ta, ga + lift, tb, gb + lift) : tb;
  if (may_be_pole && c.rc == 0 && fabs(g_of(&c, s->root[k])) > pole * fmax(fabs(ga + lift), fabs(gb + lift))) s->root[k] = NAN;
  else *found = 1;
  return c.rc;
}

/* Compares two successive values of g: updates sign_end, and root[] of the events that fire between them. */
static int detect_sign_changes(lag_sim *s, double ta, const double *ga, double tb, const double *gb, int *found) {
  const lag_model *m = s->scene->model;
  int rc = 0;
  for (int k = 0; k < lag_watched(s) && rc == 0; k++) {
    double now = sign_of(gb[k]), was = s->sign_end[k];
    if (was == 0.0) {
      s->sign_end[k] = fabs(gb[k]) > s->noise[k] ? now : 0;
      if (s->sign_end[k] < 0 && (k >= m->nev || lag_contact_of(m, k))) /* it may have been positive: a switch, a closing gap, a force that pulls */
        rc = find_crossing(s, k, s->noise[k], ta, ga[k], tb, gb[k], found);
    } else if (now == -was) {
      int direction = k < m->nev ? m->ev[k].direction : -1;
      s->sign_end[k] = now;
      if (direction == 0 || direction == (int)now) rc = find_crossing(s, k, 0, ta, ga[k], tb, gb[k], found);
    }
  }
  return rc;
}

/* ---- parts of the step */

/* Sample j of the N + 1 in a part of the step, and its time: at the Chebyshev extrema, both ends included. */
static double *value(lag_sim *s, int j) { return s->spare + j * lag_watched(s); }

static double time_at(double ta, double tb, int j) { return j == 0 ? ta : j == N ? tb : ta + (tb - ta) * (0.5 - 0.5 * cosine[j]); }

/* Rounding of the event functions: their change when the state changes in its last digits. */
static int find_rounding(lag_sim *s, double t, double *rounding) {
  const double last = 4 * DBL_EPSILON;
  int nev = lag_watched(s), n = s->pb.n;
  int rc = g_at(s, t, rounding);
  for (int j = 0; j < n; j++) s->yc[j] += (j % 2 ? -last : last) * (fabs(s->yc[j]) + fabs(s->y[j] - s->y0[j]));
  rc = rc ? rc : lag_events_eval(s, t * (1 + last), s->yc, s->g1);
  for (int k = 0; k < nev && rc == 0; k++) rounding[k] = 4 * (fabs(s->g1[k] - rounding[k]) + last * fabs(rounding[k]));
  return rc;
}

/* Marks jumps, of the events due now, whose functions go on at some distance from zero, as sign(x) does: from one sample to the next (2^-50 of t) values
 * on the same side hardly change, and the change over zero is no rounding. at_event: values now; rounding: scratch. */
static int confirm_jumps(lag_sim *s, const double *at_event, const double *spread, double *jumps, double *rounding) {
  const Run *r = s->run;
  int nev = lag_watched(s), some = 0, rc = 0;
  for (int k = 0; k < nev; k++) some |= jumps[k] != 0.0;
  if (some) rc = find_rounding(s, r->from + (r->limit - r->from) / 2, rounding);
  for (int k = 0; k < nev && some && rc == 0; k++) jumps[k] = jumps[k] != 0.0 && fmax(spread[k], fabs(at_event[k])) > 1000 * rounding[k];
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
    rc = i ? g_at(s, t, s->g1) : 0;
    for (int k = 0; k < nev && rc == 0; k++) {
      spread[k] = fmax(spread[k], fabs(g[k] - at_event[k]));
      if (previous[k] * g[k] > 0 && fabs(g[k] - previous[k]) > fabs(g[k]) / 4) jumps[k] = 0;
      previous[k] = g[k];
    }
  }
  return rc ? rc : confirm_jumps(s, at_event, spread, jumps, previous);
}

/* Chebyshev coefficients of the polynomial of degree N through N + 1 values (mirrored in time, which matters nowhere). */
static void coefficients(const double *value, int stride, double *c) {
  double even[N / 2 + 1], odd[N / 2];
  for (int j = 0; j < N / 2; j++) {
    double a = value[j * stride] / (j ? 1 : 2), b = value[(N - j) * stride] / (j ? 1 : 2);
    even[j] = a + b;
    odd[j] = a - b;
  }
  even[N / 2] = value[N / 2 * stride];
  for (int k = 0; k <= N; k++) {
    double sum = k % 2 ? 0 : even[N / 2] * cosine[k * N / 2 % (2 * N)];
    for (int j = 0; j < N / 2; j++) sum += (k % 2 ? odd[j] : even[j]) * cosine[j * k % (2 * N)];
    c[k] = sum * (k % N ? 2.0 / N : 1.0 / N);
  }
}

/* Whether the derivative of the polynomial has one sign throughout. */
static int is_monotonic(const double *c, double error) {
  double d[N + 2] = {0}, others = 0;
  for (int k = N; k >= 1; k--) d[k - 1] = (k < N ? d[k + 1] : 0) + 2 * k * c[k];
  for (int k = 1; k < N; k++) others += fabs(d[k]);
  return fabs(d[0] / 2) > others + 2 * N * error;
}

/* Halvings allowed to resolve one event in a part; 0: it is resolved. */
static int halvings(const double *value, int stride, double rounding) {
  const double rough = 1e-3; /* of the range of g, in the last three coefficients */
  double c[N + 1], range = 0;
  coefficients(value, stride, c);
  for (int k = 1; k <= N; k++) range += fabs(c[k]);
  double error = fabs(c[N - 2]) + fabs(c[N - 1]) + fabs(c[N]);
  if (range <= rounding) return 0;
  if (error > rough * range && error > rounding) return fabs(c[0]) > 4 * range ? 0 : MOST_ROUGH;
  return fabs(c[0]) > range + error || is_monotonic(c, error) ? 0 : MOST_HALVINGS;
}

/* Samples 1 to N of a part; *most := halvings allowed. *known: rounding is known. */
static int sample_part(lag_sim *s, double ta, double tb, int *known, int *most) {
  int nev = lag_watched(s), rc = 0;
  double *rounding = value(s, N + 1);
  for (int j = 1; j <= N && rc == 0; j++) rc = g_at(s, time_at(ta, tb, j), value(s, j));
  for (int turn = *known; turn < 2 && rc == 0; turn++) {
    *most = 0;
    for (int k = 0; k < nev; k++) {
      int of_k = halvings(value(s, 0) + k, nev, turn ? rounding[k] : 0);
      *most = of_k > *most ? of_k : *most;
    }
    if (*most == 0 || turn) break;
    rc = find_rounding(s, time_at(ta, tb, N / 2), rounding);
    *known = 1;
  }
  return rc;
}

/* Walks the samples of a resolved part until an event is found. Sample 0 becomes the one at its end. */
static int scan_samples(lag_sim *s, double ta, double tb, int *found) {
  size_t bytes = (size_t)lag_watched(s) * sizeof(double);
  int rc = 0, j = 0;
  while (j < N && rc == 0 && !*found) {
    rc = detect_sign_changes(s, time_at(ta, tb, j), value(s, j), time_at(ta, tb, j + 1), value(s, j + 1), found);
    j++;
  }
  memmove(value(s, 0), value(s, j), bytes);
  memcpy(s->g0, value(s, 0), bytes);
  return rc;
}

/* The first event in [a, b]; sample 0 is the one at a. Part i of 2^level equal parts follows part i - 1, or is half of an unresolved one. */
static int search(lag_sim *s, double a, double b, int *found) {
  int level = 0, known = 0, rc = 0;
  long i = 0;
  while (rc == 0 && !*found && !(level == 0 && i == 1)) {
    double ta = a + (b - a) * ldexp((double)i, -level), tb = a + (b - a) * ldexp((double)(i + 1), -level);
    tb = i + 1 == 1L << level ? b : tb;
    int most = 0, long_enough = fabs(tb - ta) > 64 * DBL_EPSILON * fmax(fabs(ta), fabs(tb));
    rc = sample_part(s, ta, tb, &known, &most);
    if (rc == 0 && level < most && long_enough) {
      level++;
      i *= 2;
      continue;
    }
    rc = rc ? rc : scan_samples(s, ta, tb, found);
    for (i++; level > 0 && i % 2 == 0; i /= 2) level--;
  }
  return rc;
}

/* *to := end of the part to search first: the first probe at which an event that has just fired is back on its other side, else the end of the
 * step. Sample 0 is the one at its start. */
static int first_part(lag_sim *s, double *to) {
  Run *r = s->run;
  int nev = lag_watched(s), rc = 0, back = 0;
  double *left = value(s, 1), *g = value(s, 2);
  for (int k = 0; k < nev; k++) left[k] = 0;
  for (int i = 0; i < PROBES && rc == 0 && !back; i++) {
    *to = r->from + (r->step_t1 - r->from) * probe_at[i];
    rc = g_at(s, *to, g);
    for (int k = 0; k < nev && rc == 0; k++) {
      double now = s->sign[k] == 0.0 && fabs(g[k]) > s->noise[k] ? sign_of(g[k]) : 0;
      back |= now * left[k] < 0;
      left[k] = left[k] == 0.0 ? now : left[k];
    }
  }
  *to = back ? *to : r->step_t1;
  return rc;
}

/* Whether no switch can end its branch in the step, as the parabola through three values of each event function shows; sample 0 is the first of them.
 * A step resolves the motion, so that functions of the state are smooth on it; those that contain t are searched, and so are events. */
static int is_quiet(lag_sim *s, int *rc) {
  const lag_model *m = s->scene->model;
  const Run *r = s->run;
  const double *first = value(s, 0), *mid = value(s, 1), *last = value(s, 2);
  int quiet = m->nev == 0;
  for (int k = 0; k < m->nmodes && quiet; k++) quiet = !m->switches[k].is_timed && s->sign[k] > 0 && s->pb.nslide == 0;
  if (!quiet) return 0;
  *rc = g_at(s, r->from + (r->step_t1 - r->from) / 2, value(s, 1));
  *rc = *rc ? *rc : g_at(s, r->step_t1, value(s, 2));
  for (int k = 0; k < m->nmodes && quiet && *rc == 0; k++) {
    double least = fmin(fmin(first[k], mid[k]), last[k]), bend = fabs(first[k] - 2 * mid[k] + last[k]);
    quiet = least > fabs(last[k] - first[k]) / 2 + 4 * bend;
  }
  return quiet && *rc == 0;
}

/* limit := the earliest root; pending: whether there is one. */
static void first_root(lag_sim *s) {
  Run *r = s->run;
  r->limit = r->step_t1;
  for (int k = 0; k < lag_watched(s); k++) {
    if (isnan(s->root[k])) continue;
    r->pending = 1;
    if ((s->root[k] - r->limit) * r->dir < 0) r->limit = s->root[k];
  }
}

int lag_events_locate(lag_sim *s) {
  Run *r = s->run;
  int nev = lag_watched(s), found = 0, unknown = 0;
  double to = r->step_t1;
  r->limit = r->step_t1;
  r->pending = 0;
  if (nev == 0 || (s->pb.contacts && nev == 2 * s->scene->model->ncontacts)) return LAG_OK; /* contacts that are met by impulses have no other events */
  for (int k = 0; k < nev; k++) {
    s->root[k] = NAN;
    s->sign_end[k] = s->sign[k];
    unknown |= s->sign[k] == 0.0;
  }
  int rc = g_at(s, r->from, value(s, 0));
  if (rc == 0 && !unknown && is_quiet(s, &rc)) return LAG_OK;
  double end = rc == 0 ? lag_kicks_locate(s, value(s, 0)) : to; /* roots of kicks are known before */
  rc = rc == 0 && unknown ? first_part(s, &to) : rc;
  to = (to - end) * r->dir > 0 ? end : to;
  rc = rc ? rc : search(s, r->from, to, &found);
  if (rc == 0 && !found && to != end) rc = search(s, to, end, &found);
  if (rc == 0) first_root(s);
  return rc;
}
