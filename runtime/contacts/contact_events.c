/* Signs of events of contacts once all that touch are settled. Enters: the state after an event; leaves: a contact that
 * touches armed anew, so that its next closing is seen, and pairs of contacts without play. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "contacts/contact_set.h"
#include "core/rhs.h"

/* size[constraints] of tangents := size of the terms of their slip velocities. */
static int tangent_sizes(lag_sim *s, double *size) {
  const lag_model *m = s->scene->model;
  double *rates = size + m->constraints->n;
  int rc = lag_constraint_terms(&s->pb, s->run->t, s->now, 0, rates);
  for (int i = 0; i < m->ncontacts && rc == 0; i++)
    if (m->contacts[i].is_tangent) size[m->contacts[i].constraint] = rates[m->contacts[i].constraint];
  return rc;
}

/* The largest force of contacts that are closed; law: of the model's contact_laws, NULL without friction. Where
 * friction holds at its limit g is rounding, the force is not. */
static double largest_force(const lag_sim *s, const double *g, const double *law) {
  const lag_model *m = s->scene->model;
  double most = 0;
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    if (!lag_contact_is_closed(s, c) || c->conditional) continue;
    most = fmax(most, fabs(g[c->release]));
    if (law && c->is_tangent) most = fmax(most, fabs(law[3 * i + 2] + s->pb.u[c->force]));
  }
  return most;
}

int lag_contact_not_open(lag_sim *s, double t, const double *y) {
  const lag_model *m = s->scene->model;
  if (m->ncontacts && lag_events_eval(s, t, y, s->g1)) return -2;
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    if (lag_contact_is_closed(s, c) || (!c->is_tangent && !(s->g1[c->impact] > 0))) return i;
  }
  return -1;
}

/* contact_pair of open contact i, which touches: a closed one whose gap has the opposite gradient. A: of all gaps. */
static void find_pair(lag_sim *s, const double *A, int i) {
  const lag_model *m = s->scene->model;
  const lag_constraints *of = m->constraints;
  const double rounding = 1e-12;
  double *a = s->contact_rows + of->njacobian + of->nmass, *same = s->contact_scratch, entries = 0;
  memset(a, 0, (size_t)m->nq * sizeof *a);
  memset(same, 0, (size_t)of->n * sizeof *same);
  for (int e = 0; e < of->njacobian; e++)
    if (of->jacobian[e].row == m->contacts[i].constraint && A[e] != 0.0) a[of->jacobian[e].col] = A[e], entries++;
  for (int e = 0; e < of->njacobian; e++) {
    int opposite = fabs(A[e] + a[of->jacobian[e].col]) <= rounding * fabs(A[e]);
    if (A[e] != 0.0) same[of->jacobian[e].row] += opposite ? 1 : NAN;
  }
  for (int j = 0; j < m->ncontacts; j++)
    if (s->contact_was[j] > 0.5 && !m->contacts[j].is_tangent && same[m->contacts[j].constraint] == entries)
      s->contact_pair[i] = j + 1;
}

/* Pairs of contacts without play. */
static int find_pairs(lag_sim *s) {
  const lag_model *m = s->scene->model;
  const lag_constraints *of = m->constraints;
  const double *q = s->now, *v = q + m->nq;
  double *A = s->contact_rows;
  int rc = 0, known = 0;
  for (int i = 0; i < m->ncontacts && rc == 0; i++) {
    const lag_contact *c = &m->contacts[i];
    s->contact_pair[i] = 0;
    if (c->is_tangent || c->conditional || s->contact_was[i] > 0.5 || s->sign[c->impact] != 0.0) continue;
    for (int j = 0; j < m->ncontacts && !known; j++) s->pb.u[m->contacts[j].input] = 1;
    if (!known++) rc = of->matrices(of, s->run->t, q, v, v + m->nq, s->pb.p, s->pb.u, A, A + of->njacobian, s->pb.work);
    if (rc == 0) find_pair(s, A, i);
  }
  return rc;
}

int lag_contact_pairs(lag_sim *s, double t, const double *y, double *g) {
  const lag_model *m = s->scene->model;
  double *c = s->contact_scratch;
  int known = 0, rc = 0;
  for (int i = 0; i < m->ncontacts && rc == 0; i++) {
    if (s->contact_pair[i] == 0.0) continue;
    if (!known++) rc = lag_residuals(&s->pb, t, y, c, c + m->constraints->n);
    g[m->contacts[i].impact] += c[m->contacts[(int)s->contact_pair[i] - 1].constraint];
  }
  return rc;
}

/* Event k, whose function is g there: up to `noise` it has no sign yet; below -noise it fires. */
static int arm(lag_sim *s, int k, double g, double noise) {
  if (g > noise) return 0;
  s->sign[k] = 0;
  s->noise[k] = fmax(noise, fabs(g) * (1 + 0x1p-20)); /* with a larger factor it would grow at each impact */
  return 1;
}

int lag_contact_arm(lag_sim *s, const double *g) {
  const lag_model *m = s->scene->model;
  double *size = s->contact_scratch;
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    int k = lag_contact_is_closed(s, c) ? c->release : c->impact;
    if (c->conditional) arm(s, k, g[k], 0);
  }
  if (m->ncontacts == 0 || s->pb.contacts) return LAG_OK;
  const double *law = m->contact_laws && lag_contact_laws(s, s->now, s->pb.rub) == LAG_OK ? s->pb.rub : NULL;
  const double most = largest_force(s, g, law);
  for (int i = 0; i < m->ncontacts; i++) s->contact_was[i] = s->hold[m->contacts[i].input];
  for (int i = 0; i < m->ncontacts; i++)
    if (!m->contacts[i].conditional) s->hold[m->contacts[i].input] = 1;
  int rc = lag_contact_term_sizes(s, s->now, 1, size, size + m->constraints->n);
  if (rc == 0 && m->contact_laws) rc = tangent_sizes(s, size);
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    s->hold[c->input] = s->contact_was[i];
    int k = lag_contact_is_closed(s, c) ? c->release : c->impact;
    double least = fmax(lag_no_flight * size[c->constraint], lag_slip_noise(&s->pb, i));
    if (c->conditional || arm(s, k, g[k], k == c->release ? 1e-12 * most : least)) continue;
    if (k == c->release) s->sign[k] = 1; /* its force before may be that of an open contact */
  }
  return rc ? rc : find_pairs(s);
}
