/* Contacts: gaps that stay at least 0. Enters: a state set by an event or a user; leaves: the state after all impacts, with the gaps closed that
 * are pressed. Holds: a closed gap is a constraint of the model, switched on by its input in `hold` (1); no closed gap pulls; an open gap that
 * touches is armed anew, so that its next closing is seen.
 *
 * Impacts that follow each other ever faster come to an end in finite time (a ball that loses a fifth of its speed at each bounce). The gap is
 * closed when the rest of that time is too short to matter, or the next flight stays within rounding; Brogliato, Nonsmooth Mechanics, 3rd ed.
 * (2016), 1.4 and 8.1, DOI 10.1007/978-3-319-28664-8. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "constraints/contact_impulses.h"

const lag_contact *lag_contact_of(const lag_model *m, int event) {
  for (int i = 0; i < m->ncontacts; i++)
    if (m->contacts[i].impact == event || m->contacts[i].release == event) return &m->contacts[i];
  return NULL;
}

int lag_contact_is_closed(const lag_sim *s, const lag_contact *c) { return s->hold[c->input] > 0.5; }

void lag_contact_open(lag_sim *s) {
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->ncontacts; i++) s->hold[m->contacts[i].input] = NAN;
}

static const lag_constraint *constraint_of(const lag_sim *s, int i) {
  const lag_model *m = s->scene->model;
  return &m->constraints->of[m->contacts[i].constraint];
}

/* Relative tolerances: a speed after an impact that counts as 0; rounding of a gap or of its rate, relative to their terms; a flight too low to
 * be followed, relative to the terms of the gap. */
static const double no_speed = 1e-9, no_gap = 0x1p12 * DBL_EPSILON, no_flight = 0x1p6 * DBL_EPSILON;

/* ---- contacts that take part */

/* of[n] := contacts that take part: closed before, of this event, or without a gap. Refuses a state set by `who` (if not NULL) with a negative
 * gap. */
static int find_touching(ContactSet *w, const char *who, int event) {
  lag_sim *s = w->sim;
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    int inside = w->gap[i] < -no_gap * w->gap_size[i];
    if (inside && who) {
      const lag_constraint *of = constraint_of(s, i);
      return lag_fail(s, LAG_EINVAL, "%s is inside the contact %s: its gap is %.3g%s%s", who, of->name, w->gap[i], of->unit[0] ? " " : "", of->unit);
    }
    if (c->impact == event || c->release == event || w->was[i] || w->gap[i] <= no_gap * w->gap_size[i]) w->of[w->n++] = i;
  }
  return LAG_OK;
}

static int check_restitution(lag_sim *s, int i, double e) {
  if (!isnan(e) && !(e >= -no_speed && e <= 1 + no_speed))
    return lag_fail(s, LAG_EINVAL, "the contact %s has a restitution of %.3g, which must be between 0 and 1", constraint_of(s, i)->name, e);
  if (s->run->dir < 0 && e < 1 - no_speed) {
    return lag_fail(s, LAG_EINVAL, "at t = %.9g s the contact %s, of restitution %.3g, ends the run backwards in time: an impact that loses energy "
                    "cannot be reversed", s->run->t, constraint_of(s, i)->name, e);
  }
  return LAG_OK;
}

/* ---- impacts */

/* Marks event k as due now, unless it has fired already. */
static void mark_due(lag_sim *s, int k) { s->root[k] = s->root[k] == HUGE_VAL ? HUGE_VAL : s->run->limit; }

/* Impacts of the gaps that close; before[n] := their rates before it. */
static int apply_impacts(ContactSet *w, int event, int ends, double *before, double *e, unsigned char *struck) {
  lag_sim *s = w->sim;
  const lag_model *m = s->scene->model;
  int any = 0;
  for (int a = 0; a < w->n; a++) {
    int i = w->of[a];
    before[a] = s->run->dir * w->rate[i];
    struck[a] = before[a] < -no_gap * w->rate_size[i];
    any |= struck[a];
    if (struck[a]) {
      e[a] = lag_contacts_restitution(w, i);
      int rc = check_restitution(s, i, e[a]);
      if (rc) return rc;
      e[a] = isnan(e[a]) || (ends && m->contacts[i].impact == event) ? 0 : e[a];
      mark_due(s, m->contacts[i].impact);
    }
  }
  return any ? lag_contacts_impact(w, e, struck) : LAG_OK;
}

/* ---- resting contacts */

/* Finds the contacts that rest, and among them those that are pressed and stay closed. */
static int rest(ContactSet *w, int event, int ends, const double *before, double *acceleration) {
  const lag_model *m = w->sim->scene->model;
  double dir = w->sim->run->dir;
  for (int a = 0; a < w->n; a++) {
    const lag_contact *c = &m->contacts[w->of[a]];
    double after = dir * w->rate[w->of[a]];
    w->part[a] = after <= no_gap * w->rate_size[w->of[a]] || after <= no_speed * fabs(before[a]) || (ends && c->impact == event);
  }
  int rc = lag_contacts_at_rest(w, acceleration), more = 0;
  for (int a = 0; a < w->n && rc == 0; a++) { /* its flight would stay within rounding */
    double after = w->rate[w->of[a]], back = -2 * acceleration[a] * no_flight * w->gap_size[w->of[a]];
    if (!w->part[a] && after * after <= back) {
      w->part[a] = 1;
      more = 1;
    }
  }
  return rc == 0 && more ? lag_contacts_at_rest(w, acceleration) : rc;
}

/* Closes the contacts that are pressed, and projects away the speed and gap that remain. */
static int close_gaps(ContactSet *w) {
  lag_sim *s = w->sim;
  for (int a = 0; a < w->n; a++)
    if (w->was[w->of[a]] && !w->in[a]) mark_due(s, s->scene->model->contacts[w->of[a]].release);
  lag_contacts_close(w, w->in);
  if (lag_project(&s->pb, s->run->t, w->y, NULL) == LAG_OK) return LAG_OK;
  return lag_fail(s, LAG_EMODEL, "at t = %.9g s contacts cannot stay closed: %s", s->run->t, s->pb.detail ? s->pb.detail : "");
}

static int resolve_contacts(ContactSet *w, const char *who, int event, int ends) {
  int rc = find_touching(w, who, event);
  lag_contact_open(w->sim);
  if (rc || w->n == 0) return rc;
  size_t n = (size_t)w->n;
  double *room = calloc(3 * n, sizeof *room);
  unsigned char *struck = calloc(n, 1);
  rc = room && struck ? lag_contacts_responses(w) : lag_fail(w->sim, LAG_ENOMEM, "out of memory");
  rc = rc ? rc : apply_impacts(w, event, ends, room, room + n, struck);
  rc = rc ? rc : rest(w, event, ends, room, room + 2 * n);
  rc = rc ? rc : close_gaps(w);
  free(room);
  free(struck);
  return rc;
}

int lag_contact_resolve(lag_sim *s, double *y, const char *who, int event, int ends) {
  ContactSet w;
  if (s->scene->model->ncontacts == 0) return LAG_OK;
  int rc = lag_contacts_evaluate(s, y, &w);
  rc = rc ? rc : resolve_contacts(&w, who, event, ends);
  lag_contacts_free(&w);
  return rc;
}

/* Checks that every coefficient of restitution is between 0 and 1. */
static int check_all(lag_sim *s) {
  ContactSet w;
  int rc = lag_contacts_evaluate(s, s->now, &w);
  for (int i = 0; i < s->scene->model->ncontacts && rc == 0; i++) {
    double e = lag_contacts_restitution(&w, i);
    rc = isfinite(e) ? check_restitution(s, i, s->run->dir < 0 ? fmax(e, 1) : e) : LAG_OK;
  }
  lag_contacts_free(&w);
  lag_contact_open(s);
  return rc;
}

int lag_contact_begin(lag_sim *s) {
  int rc = LAG_OK;
  if (s->scene->model->ncontacts > 0) {
    lag_contact_open(s);
    rc = check_all(s);
    rc = rc ? rc : lag_contact_resolve(s, s->now, "the start", -1, 0);
  }
  memcpy(s->y, s->now, (size_t)s->pb.n * sizeof(double));
  return rc;
}

int lag_contact_arm(lag_sim *s, const double *g) {
  const lag_model *m = s->scene->model;
  double most = 0, *size = s->contact_scratch;
  if (m->ncontacts == 0) return LAG_OK;
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    s->contact_was[i] = s->hold[c->input];
    most = lag_contact_is_closed(s, c) ? fmax(most, fabs(g[c->release])) : most;
  }
  for (int i = 0; i < m->ncontacts; i++) s->hold[m->contacts[i].input] = 1;
  int rc = lag_contacts_term_sizes(s, s->now, 1, size, size + m->constraints->n);
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    s->hold[c->input] = s->contact_was[i];
    int k = lag_contact_is_closed(s, c) ? c->release : c->impact;
    double noise = k == c->release ? 1e-12 * most : no_flight * size[c->constraint];
    if (g[k] <= noise) { /* no sign yet; below -noise the event fires */
      s->sign[k] = 0;
      s->noise[k] = fmax(noise, fabs(g[k]) * (1 + 0x1p-20)); /* with a larger factor it would grow at each impact */
    }
  }
  return rc;
}
