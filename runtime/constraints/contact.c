/* Contacts: gaps that stay at least 0. Enters: a state set by an event or a user; leaves: the state after all impacts, with the gaps closed that
 * are pressed. Holds: a closed gap is a constraint of the model, switched on by its input in `hold` (1); no closed gap pulls; an open gap that
 * touches is armed anew, so that its next closing is seen.
 *
 * Impacts that follow each other ever faster come to an end in finite time (a ball that loses a fifth of its speed at each bounce). The gap is
 * closed when the rest of that time is too short to matter, or the next flight stays within rounding; Brogliato, Nonsmooth Mechanics, 3rd ed.
 * (2016), 1.4 and 8.1, DOI 10.1007/978-3-319-28664-8.
 *
 * An impact is Newton's law for all gaps at once, each with its coefficient of restitution, as a linear complementarity problem: rate after + e
 * rate before >= 0 where a gap was closing, rate after >= 0 where it rests, an impulse >= 0, and of the two one is 0. Rates are unique, as the
 * nearest ones in the metric of the mass matrix; impulses are unique where no contact depends on others. J.J. Moreau, in: Nonsmooth Mechanics
 * and Applications (1988), 1, DOI 10.1007/978-3-7091-2624-0_1; B. Brogliato, Nonsmooth Mechanics, 3rd ed. (2016), ch. 5, DOI
 * 10.1007/978-3-319-28664-8; Ch. Glocker, Set-Valued Force Laws (2001), DOI 10.1007/978-3-540-44479-4. Forces: the same problem with
 * accelerations in place of rates, P. Loetstedt, SIAM J. Appl. Math. 42 (1982) 281, DOI 10.1137/0142022. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/complementarity.h"
#include "numeric/workspace.h"

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

/* All contacts of a model at a state: gaps, rates and the sizes of their terms; and of[n], the contacts that touch, with W: impulses L change
 * their rates by W L, where all constraints hold. Memory is freed by free_contacts. */
typedef struct ContactSet {
  lag_sim *sim;
  double *y;                    /* [n of the state] */
  int n, *of;
  double *gap, *rate, *gap_size, *rate_size; /* [contacts] */
  double *W;                    /* [n n] */
  double *pull;                 /* [n] acceleration of each gap while all are open */
  double *push;                 /* [n] impulses, or forces */
  double *M, *scale;            /* [n n], [n] matrix and scales of the complementarity problem, whose row k is contact at[k] */
  int *at;
  unsigned char *part, *in;     /* [n] takes part; pushes */
  unsigned char *was;           /* [contacts] closed before */
  unsigned char *follows;       /* [n] its gap is held by the contacts that push */
  double *g, *c, *r, *d, *force, *test, *events; /* scratch: [constraints], [constraints], [constraints], [nq], [nq], [n of the state], [nev] */
  double *A, *mass;             /* sparse entries of the constraints' Jacobian, with all contacts closed, and of M */
  double *block;
} ContactSet;

static const lag_contact *contact(const ContactSet *w, int a) { return &w->sim->scene->model->contacts[w->of[a]]; }

static const char *name(const ContactSet *w, int a) { return w->sim->scene->model->constraints->of[contact(w, a)->constraint].name; }

/* Closes all contacts, or contact `which` alone, or none (which = -1). */
static void close_only(const ContactSet *w, int all, int which) {
  const lag_model *m = w->sim->scene->model;
  for (int i = 0; i < m->ncontacts; i++) w->sim->hold[m->contacts[i].input] = all || i == which ? 1 : NAN;
}

/* Closes the contacts of w with closed[n], and no others. */
static void close_contacts(const ContactSet *w, const unsigned char *closed) {
  close_only(w, 0, -1);
  for (int a = 0; a < w->n; a++) w->sim->hold[contact(w, a)->input] = closed[a] ? 1 : NAN;
}

static int no_values(ContactSet *w, int i) {
  const lag_model *m = w->sim->scene->model;
  return lag_fail(w->sim, LAG_EMODEL, "the contact %s has no finite values at t = %s s", m->constraints->of[m->contacts[i].constraint].name,
                  LAG_TEXT(w->sim->run->t));
}

/* ---- gaps and rates */

static int make_room(ContactSet *w) {
  const lag_model *m = w->sim->scene->model;
  const lag_constraints *of = m->constraints;
  size_t p = (size_t)m->ncontacts, n = (size_t)of->n, nq = (size_t)m->nq;
  double **const parts[] = {&w->gap, &w->rate, &w->gap_size, &w->rate_size, &w->g, &w->c, &w->r, &w->d, &w->force, &w->test, &w->events,
                            &w->A, &w->mass};
  const size_t sizes[] = {p, p, p, p, n, n, n, nq, nq, (size_t)w->sim->pb.n, (size_t)m->nev, (size_t)of->njacobian, (size_t)of->nmass};
  w->block = lag_workspace(sizeof sizes / sizeof *sizes, parts, sizes);
  w->of = calloc(p, sizeof *w->of);
  w->at = calloc(p, sizeof *w->at);
  w->part = calloc(4 * p, 1);
  w->in = w->part + p;
  w->was = w->in + p;
  w->follows = w->was + p;
  return w->block && w->of && w->at && w->part ? LAG_OK : lag_fail(w->sim, LAG_ENOMEM, "out of memory");
}

static void free_contacts(ContactSet *w) {
  free(w->block);
  free(w->of);
  free(w->at);
  free(w->part);
  free(w->W);
}

/* rate[i] := rate of each gap at the state y; leaves all contacts closed. */
static int find_rates(ContactSet *w, const double *y, double *rate) {
  const lag_model *m = w->sim->scene->model;
  close_only(w, 1, -1);
  int rc = lag_residuals(&w->sim->pb, w->sim->run->t, y, w->c, w->r);
  for (int i = 0; i < m->ncontacts; i++) rate[i] = rc ? NAN : w->r[m->contacts[i].constraint];
  return rc;
}

/* size[constraints] := size of the terms of gaps, or of their rates, at y or at the start, whichever is larger: a ball that has come to lie at 0
 * is measured by its fall. Leaves all contacts closed. */
static int term_sizes(lag_sim *s, const double *y, int holonomic, double *size, double *scratch) {
  const lag_constraints *of = s->scene->model->constraints;
  int rc = lag_constraint_terms(&s->pb, s->run->t, y, holonomic, size);
  rc = rc ? rc : lag_constraint_terms(&s->pb, s->run->t, s->begin, holonomic, scratch);
  for (int k = 0; k < (holonomic ? of->nholonomic : of->n) && rc == 0; k++) size[k] = fmax(size[k], isfinite(scratch[k]) ? scratch[k] : 0);
  return rc;
}

/* *w := all contacts at the state y, which stays the caller's; w->of has room for all, n is 0. */
static int evaluate_contacts(lag_sim *s, double *y, ContactSet *w) {
  const lag_model *m = s->scene->model;
  lag_problem *pb = &s->pb;
  double t = s->run->t;
  *w = (ContactSet){.sim = s, .y = y};
  int rc = make_room(w), nq = pb->nq;
  if (rc) return rc;
  for (int i = 0; i < m->ncontacts; i++) w->was[i] = s->hold[m->contacts[i].input] > 0.5;
  rc = find_rates(w, y, w->rate);
  for (int i = 0; i < m->ncontacts; i++) {
    w->gap[i] = w->c[m->contacts[i].constraint];
    if (rc || !isfinite(w->gap[i]) || !isfinite(w->rate[i])) return no_values(w, i);
  }
  rc = term_sizes(s, y, 1, w->g, w->c);
  for (int i = 0; i < m->ncontacts; i++) w->gap_size[i] = w->g[m->contacts[i].constraint];
  rc = rc ? rc : term_sizes(s, y, 0, w->g, w->c);
  for (int i = 0; i < m->ncontacts; i++) w->rate_size[i] = w->g[m->contacts[i].constraint];
  rc = rc ? rc : lag_inputs(pb, t);
  rc = rc ? rc : m->constraints->matrices(t, y, y + nq, y + 2 * nq, pb->p, pb->u, w->A, w->mass, pb->work);
  return rc ? no_values(w, 0) : LAG_OK;
}

/* Change of the rate of contact i by a change d of velocities. */
static double change_of_rate(const ContactSet *w, int i, const double *d) {
  const lag_constraints *of = w->sim->scene->model->constraints;
  double s = 0;
  for (int e = 0; e < of->njacobian; e++)
    s += of->jacobian[e].row == w->sim->scene->model->contacts[i].constraint ? w->A[e] * d[of->jacobian[e].col] : 0;
  return s;
}

/* w->d := the least change of velocities that changes the rate of contact i by 1, the others open. Returns the change of the rate per unit
 * impulse; 0 if no impulse changes it; NaN: no finite values. */
static double response(ContactSet *w, int i) {
  lag_problem *pb = &w->sim->pb;
  int nq = pb->nq, k = w->sim->scene->model->contacts[i].constraint;
  double s = 0;
  close_only(w, 0, i);
  memset(w->g, 0, (size_t)pb->model->constraints->n * sizeof *w->g);
  w->g[k] = 1;
  if (lag_least_change(pb, w->sim->run->t, w->y, 0, w->g, w->d, w->force)) return NAN;
  for (int j = 0; j < nq; j++) s += w->d[j] * w->force[j];
  return fabs(change_of_rate(w, i, w->d) - 1) > 0.5 ? 0 : 1 / s;
}

/* The coefficient of restitution of contact i; NaN where no impulse moves it. */
static double restitution(ContactSet *w, int i) {
  const lag_sim *s = w->sim;
  const lag_model *m = s->scene->model;
  size_t bytes = (size_t)s->pb.n * sizeof(double);
  int nq = m->nq, stop = 0;
  double to = response(w, i), speed = w->rate_size[i] > 0 ? w->rate_size[i] : 1;
  if (!(to > 0)) return NAN;
  memcpy(s->yc, w->y, bytes);
  for (int j = 0; j < nq; j++) { /* test velocity: the gap closes with a typical speed */
    s->yc[nq + j] -= (speed + w->rate[i]) * w->d[j];
  }
  memcpy(w->test, s->yc, bytes);
  if (m->act(m->contacts[i].impact, s->run->t, s->yc, s->yc + nq, s->yc + 2 * nq, s->p, s->u, w->test, w->test + nq, w->test + 2 * nq, &stop,
             s->work)) {
    return NAN;
  }
  for (int j = 0; j < nq; j++) w->d[j] = w->test[nq + j] - s->yc[nq + j];
  return change_of_rate(w, i, w->d) / speed - 1;
}

/* Computes W for the contacts of[n]. */
static int find_responses(ContactSet *w) {
  size_t n = (size_t)w->n;
  double *x = w->W = calloc(2 * n * n + 3 * n + 1, sizeof *x);
  if (!x) return lag_fail(w->sim, LAG_ENOMEM, "out of memory");
  w->M = x + n * n;
  w->pull = w->M + n * n;
  w->push = w->pull + n;
  w->scale = w->push + n;
  for (int a = 0; a < w->n; a++) {
    double to = response(w, w->of[a]);
    if (!isfinite(to)) return no_values(w, w->of[a]);
    for (int b = 0; b < w->n; b++) w->W[b * w->n + a] = to * change_of_rate(w, w->of[b], w->d);
    w->W[a * w->n + a] = to;
  }
  return LAG_OK;
}

/* ---- complementarity */

/* Reports that no impulse, or force, keeps contact a from closing. */
static int fail_incompatible(ContactSet *w, int a) {
  int against = -1;
  double most = 0;
  for (int b = 0; b < w->n && a >= 0; b++)
    if (w->part[b] && w->W[a * w->n + b] < most) {
      most = w->W[a * w->n + b];
      against = b;
    }
  if (against >= 0) {
    return lag_fail(w->sim, LAG_EMODEL, "at t = %.9g s the contacts %s and %s contradict each other: no force keeps both gaps from closing",
                    w->sim->run->t, name(w, a), name(w, against));
  }
  return lag_fail(w->sim, LAG_EMODEL, "at t = %.9g s nothing can keep the contact %s from closing further", w->sim->run->t, name(w, a < 0 ? 0 : a));
}

/* Solves the complementarity problem of the contacts that take part: in[n]; push[n] := impulses where in[n]. */
static int complement(ContactSet *w, const double *q) {
  int m = 0, n = w->n, row = -1;
  for (int a = 0; a < n; a++)
    if (w->part[a]) {
      w->at[m] = a;
      w->push[m++] = q[a];
    }
  for (int k = 0; k < m * m; k++) w->M[k] = w->W[w->at[k / m] * n + w->at[k % m]];
  int found = lag_solve_lcp(m, w->M, w->push, w->scale, w->in, &row);
  for (int k = n - 1; k >= m; k--) w->in[k] = w->follows[k] = 0;
  for (int k = m - 1; k >= 0; k--) { /* back to their places, which are not lower */
    double push = w->push[k];
    unsigned char in = w->in[k], follows = !in && w->M[k * m + k] <= lag_lcp_zero_pivot;
    w->push[k] = w->in[k] = w->follows[k] = 0;
    w->push[w->at[k]] = push;
    w->in[w->at[k]] = in;
    w->follows[w->at[k]] = follows;
  }
  return found ? LAG_OK : fail_incompatible(w, row < 0 ? -1 : w->at[row]);
}

/* Applies the impulses where gaps close: changes y and w->rate. e[n]: coefficients of restitution; struck[n]: gaps that were closing. */
static int impact(ContactSet *w, const double *e, const unsigned char *struck) {
  lag_sim *s = w->sim;
  int nq = s->pb.nq;
  double dir = s->run->dir;
  for (int a = 0; a < w->n; a++) {
    w->part[a] = 1;
    w->pull[a] = dir * w->rate[w->of[a]] * (struck[a] ? 1 + e[a] : 1);
  }
  int rc = complement(w, w->pull);
  if (rc) return rc;
  close_contacts(w, w->in);
  memset(w->g, 0, (size_t)s->pb.model->constraints->n * sizeof *w->g);
  for (int a = 0; a < w->n; a++) w->g[contact(w, a)->constraint] = w->in[a] ? -dir * w->pull[a] : 0;
  rc = lag_least_change(&s->pb, s->run->t, w->y, 0, w->g, w->d, w->force);
  for (int i = 0; i < nq; i++) w->y[nq + i] += w->d[i];
  return rc || lag_not_finite(nq, w->d) >= 0 || find_rates(w, w->y, w->rate) ? no_values(w, w->of[0]) : LAG_OK;
}

/* ---- forces */

/* pull[n] := acceleration of each open gap: -(force if this contact alone is closed) * (its response). */
static int find_pulls(ContactSet *w) {
  for (int a = 0; a < w->n; a++) {
    close_only(w, 0, w->of[a]);
    int rc = lag_events_eval(w->sim, w->sim->run->t, w->y, w->events);
    if (rc) return rc;
    w->pull[a] = -w->W[a * w->n + a] * w->events[contact(w, a)->release];
  }
  return LAG_OK;
}

/* Whether these closed contacts all press. */
static int none_pulls(ContactSet *w, const unsigned char *closed) {
  double least = 0, most = 0;
  close_contacts(w, closed);
  if (lag_events_eval(w->sim, w->sim->run->t, w->y, w->events)) return 0;
  for (int a = 0; a < w->n; a++) {
    double force = closed[a] ? w->events[contact(w, a)->release] : 0;
    least = fmin(least, force);
    most = fmax(most, force);
  }
  return most > 0 && least >= 0;
}

/* w->in := contacts that stay closed under forces: those that press, and those that depend on them where they share the load and none pulls.
 * acceleration[n] := of each gap then. y does not change; contacts are left open. */
static int contacts_at_rest(ContactSet *w, double *acceleration) {
  int n = w->n, rc = find_pulls(w), more = 0;
  rc = rc ? rc : complement(w, w->pull);
  for (int a = 0; a < n && rc == 0; a++) {
    acceleration[a] = w->pull[a];
    for (int b = 0; b < n; b++) acceleration[a] += w->in[b] ? w->W[a * n + b] * w->push[b] : 0;
    more |= w->follows[a];
    w->follows[a] |= w->in[a];
  }
  if (more && none_pulls(w, w->follows)) memcpy(w->in, w->follows, (size_t)n);
  close_only(w, 0, -1);
  return rc;
}

/* ---- contacts of a state */

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
      e[a] = restitution(w, i);
      int rc = check_restitution(s, i, e[a]);
      if (rc) return rc;
      e[a] = isnan(e[a]) || (ends && m->contacts[i].impact == event) ? 0 : e[a];
      mark_due(s, m->contacts[i].impact);
    }
  }
  return any ? impact(w, e, struck) : LAG_OK;
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
  int rc = contacts_at_rest(w, acceleration), more = 0;
  for (int a = 0; a < w->n && rc == 0; a++) { /* its flight would stay within rounding */
    double after = w->rate[w->of[a]], back = -2 * acceleration[a] * no_flight * w->gap_size[w->of[a]];
    if (!w->part[a] && after * after <= back) {
      w->part[a] = 1;
      more = 1;
    }
  }
  return rc == 0 && more ? contacts_at_rest(w, acceleration) : rc;
}

/* Closes the contacts that are pressed, and projects away the speed and gap that remain. */
static int close_gaps(ContactSet *w) {
  lag_sim *s = w->sim;
  for (int a = 0; a < w->n; a++)
    if (w->was[w->of[a]] && !w->in[a]) mark_due(s, s->scene->model->contacts[w->of[a]].release);
  close_contacts(w, w->in);
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
  rc = room && struck ? find_responses(w) : lag_fail(w->sim, LAG_ENOMEM, "out of memory");
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
  int rc = evaluate_contacts(s, y, &w);
  rc = rc ? rc : resolve_contacts(&w, who, event, ends);
  free_contacts(&w);
  return rc;
}

/* Checks that every coefficient of restitution is between 0 and 1. */
static int check_all(lag_sim *s) {
  ContactSet w;
  int rc = evaluate_contacts(s, s->now, &w);
  for (int i = 0; i < s->scene->model->ncontacts && rc == 0; i++) {
    double e = restitution(&w, i);
    rc = isfinite(e) ? check_restitution(s, i, s->run->dir < 0 ? fmax(e, 1) : e) : LAG_OK;
  }
  free_contacts(&w);
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
  int rc = term_sizes(s, s->now, 1, size, size + m->constraints->n);
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
