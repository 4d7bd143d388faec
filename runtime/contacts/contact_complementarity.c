/* Newton's impact law, and contact forces, of all touching gaps at once without friction, as linear complementarity
 * problems (numeric/complementarity.h). Enters: contacts that touch, with responses; leaves: those that stay closed. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "contacts/contact_set.h"
#include "numeric/complementarity.h"

void lag_contacts_close(const ContactSet *w, const unsigned char *closed) {
  lag_contacts_close_only(w, 0, -1);
  for (int a = 0; a < w->n; a++) lag_contact_set_closed(w->sim, w->of[a], closed[a]);
}

/* Reports that no impulse, or force, keeps contact a from closing. */
static int fail_incompatible(ContactSet *w, int a) {
  int against = -1;
  double most = 0;
  for (int b = 0; b < w->n && a >= 0; b++)
    if (w->active[b] && w->response[a * w->n + b] < most) {
      most = w->response[a * w->n + b];
      against = b;
    }
  if (against >= 0) {
    return lag_fail(w->sim, LAG_EMODEL,
                    "at t = %.9g s the contacts %s and %s contradict each other: no force keeps both gaps from closing",
                    w->sim->run->t, lag_contacts_name(w, a), lag_contacts_name(w, against));
  }
  return lag_fail(w->sim, LAG_EMODEL, "at t = %.9g s nothing can keep the contact %s from closing further",
                  w->sim->run->t, lag_contacts_name(w, a < 0 ? 0 : a));
}

enum { WAITS = 2 }; /* in follows[n]: its island is still to be solved */

/* |q| of contact a, in units of its own response. */
static double scaled(const ContactSet *w, const double *q, int a) {
  double own = w->response[a * w->n + a];
  return fabs(q[a]) * (own > 0 ? 1 / sqrt(own) : 1);
}

/* Solves the problem of the island of contact a. most: the largest scaled q of all, whose rounding counts. */
static int complement_island(ContactSet *w, const double *q, int a, double most) {
  int m = 0, n = w->n;
  double own = 0;
  for (int b = a; b < n; b++) {
    if (w->follows[b] != WAITS || w->island[b] != w->island[a]) continue;
    w->at[m] = b;
    w->impulse[m++] = q[b];
    own = fmax(own, scaled(w, q, b));
  }
  for (int k = 0; k < m * m; k++) w->lcp[k] = w->response[w->at[k / m] * n + w->at[k % m]];
  lag_complementarity p = lag_contact_complementarity(m, w->lcp, w->impulse, w->scale, w->state);
  if (own > 0) p.rounding *= most / own;
  int status = lag_solve_complementarity(&p);
  for (int k = 0; k < m; k++) {
    int b = w->at[k];
    w->push[b] = w->impulse[k];
    w->closed[b] = w->state[k] == LAG_BETWEEN;
    w->follows[b] = !w->closed[b] && w->lcp[k * m + k] <= p.zero;
  }
  return status == LAG_SOLVED ? LAG_OK : fail_incompatible(w, status == LAG_NO_SOLUTION ? w->at[p.row] : -1);
}

/* Solves the complementarity problem of the contacts that take part: in[n]; push[n] := impulses where in[n]. */
static int complement(ContactSet *w, const double *q) {
  int rc = LAG_OK;
  double most = 0;
  for (int a = 0; a < w->n; a++) {
    w->push[a] = w->closed[a] = 0;
    w->follows[a] = w->active[a] ? WAITS : 0;
    if (w->active[a]) most = fmax(most, scaled(w, q, a));
  }
  for (int a = 0; a < w->n && rc == LAG_OK; a++)
    if (w->follows[a] == WAITS) rc = complement_island(w, q, a, most);
  memcpy(w->impulse, w->push, (size_t)w->n * sizeof *w->push);
  return rc;
}

int lag_contacts_impact(ContactSet *w, const double *e, const unsigned char *struck) {
  lag_sim *s = w->sim;
  int nq = s->pb.nq;
  double dir = s->run->dir;
  for (int a = 0; a < w->n; a++) {
    w->active[a] = 1;
    w->rhs[a] = dir * w->rate[w->of[a]] * (struck[a] ? 1 + e[a] : 1);
  }
  int rc = complement(w, w->rhs);
  if (rc) return rc;
  lag_contacts_close(w, w->closed);
  memset(w->g, 0, (size_t)s->pb.model->constraints->n * sizeof *w->g);
  for (int a = 0; a < w->n; a++) w->g[lag_contacts_at(w, a)->constraint] = w->closed[a] ? -dir * w->rhs[a] : 0;
  rc = lag_least_change(&s->pb, s->run->t, w->y, 0, w->g, w->d, w->force);
  for (int i = 0; i < nq; i++) w->y[nq + i] += w->d[i];
  return rc || lag_not_finite(nq, w->d) >= 0 || lag_contacts_rates(w, w->y, w->rate)
             ? lag_contacts_no_values(w, w->of[0])
             : LAG_OK;
}

/* ---- forces */

/* Whether contact b and those of the group move each other by no more than rounding. */
static int is_apart(const ContactSet *w, const unsigned char *group, int b) {
  const double *W = w->response, own = W[b * w->n + b];
  for (int a = 0; a < w->n; a++) {
    if (w->island[a] != w->island[b]) continue;
    double both = W[a * w->n + b] * W[b * w->n + a], square = DBL_EPSILON * DBL_EPSILON * own * W[a * w->n + a];
    if (group[a] && !(own > 0 && W[a * w->n + a] > 0 && fabs(both) <= square)) return 0;
  }
  return 1;
}

/* pull[n] := acceleration of each open gap: -(force if this contact alone is closed) * (its response). Contacts that
 * do not move each other are closed together. */
static int find_pulls(ContactSet *w) {
  const int n = w->n;
  unsigned char *done = w->follows, *group = w->closed;
  memset(done, 0, (size_t)n);
  for (int a = 0; a < n; a++) {
    if (done[a]) continue;
    memset(group, 0, (size_t)n);
    for (int b = a; b < n; b++)
      if (!done[b] && is_apart(w, group, b)) group[b] = done[b] = 1;
    lag_contacts_close(w, group);
    int rc = lag_events_eval(w->sim, w->sim->run->t, w->y, w->events);
    if (rc) return rc;
    for (int b = a; b < n; b++)
      if (group[b]) w->rhs[b] = -w->response[b * n + b] * w->events[lag_contacts_at(w, b)->release];
  }
  return LAG_OK;
}

/* Whether these closed contacts all press. */
static int none_pulls(ContactSet *w, const unsigned char *closed) {
  double least = 0, most = 0;
  lag_contacts_close(w, closed);
  if (lag_events_eval(w->sim, w->sim->run->t, w->y, w->events)) return 0;
  for (int a = 0; a < w->n; a++) {
    double force = closed[a] ? w->events[lag_contacts_at(w, a)->release] : 0;
    least = fmin(least, force);
    most = fmax(most, force);
  }
  return most > 0 && least >= 0;
}

int lag_contacts_at_rest(ContactSet *w, double *acceleration) {
  int n = w->n, rc = find_pulls(w), more = 0;
  rc = rc ? rc : complement(w, w->rhs);
  for (int a = 0; a < n && rc == 0; a++) {
    acceleration[a] = w->rhs[a];
    for (int b = 0; b < n; b++)
      if (w->closed[b] && w->island[a] == w->island[b]) acceleration[a] += w->response[a * n + b] * w->impulse[b];
    more |= w->follows[a];
    w->follows[a] |= w->closed[a];
  }
  if (more && none_pulls(w, w->follows)) memcpy(w->closed, w->follows, (size_t)n);
  lag_contacts_close_only(w, 0, -1);
  return rc;
}
