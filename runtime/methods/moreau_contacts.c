/* The model of contacts in one step of moreau, memory and statistics of the step: methods/moreau_contacts.h. */
#include "methods/moreau_contacts.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

#include "methods/steps.h"

/* ---- memory */

/* Bandwidth of M. */
static int band_of(const lag_constraints *of) {
  int band = 0;
  for (int e = 0; e < of->nmass; e++)
    band = of->mass[e].row - of->mass[e].col > band ? of->mass[e].row - of->mass[e].col : band;
  return band;
}

/* One state, and the room of the kernel. */
size_t lag_moreau_contacts_size(const lag_model *m) {
  const lag_constraints *of = m->constraints;
  return m->ncontacts ? (size_t)(2 * m->nq + m->nz +
                                 LAG_CONTACT_ROOM(m->ncontacts, of->n, m->nq, of->njacobian, of->nmass,
                                                  m->ncontacts * m->nq, lag_band_matrix_size(m->nq, band_of(of))))
                      : 0;
}

lag_moreau_contacts lag_moreau_contacts_of(const lag_problem *pb, double *law) {
  const lag_model *m = pb->model;
  const lag_constraints *of = m->constraints;
  if (!m->ncontacts) return (lag_moreau_contacts){0};
  lag_moreau_contacts w = {.contacts = m->ncontacts - m->nguides,
                           .constraints = of->n,
                           .nq = m->nq,
                           .entries = of->njacobian,
                           .nmass = of->nmass,
                           .band = band_of(of),
                           .at = m->contacts,
                           .jacobian_at = of->jacobian,
                           .mass_at = of->mass,
                           .epsilon = DBL_EPSILON,
                           .guess = pb->contact_impulse};
  lag_contacts_place(&w, m->ncontacts * m->nq, pb->contact_room + pb->n);
  w.law = law;
  return w;
}

/* ---- the model */

int lag_moreau_close(lag_problem *pb, double t, int only) {
  const lag_model *m = pb->model;
  int rc = lag_inputs(pb, t);
  for (int i = 0; i < m->ncontacts; i++) {
    pb->u[m->contacts[i].input] = only < 0 || i == only;
    if (m->contacts[i].is_tangent) pb->u[m->contacts[i].force] = 0;
  }
  return lag_step_checked(pb, rc, t);
}

int lag_moreau_gaps(lag_problem *pb, double t, const double *q, const double *v, const double *z, double *c,
                    double *r) {
  const lag_constraints *of = pb->model->constraints;
  return lag_step_checked(pb, of->residuals(of, t, q, v, z, pb->p, pb->u, c, r, pb->work), t);
}

int lag_moreau_matrices(lag_problem *pb, double t, const double *y, double *A, double *M) {
  const lag_constraints *of = pb->model->constraints;
  return lag_step_checked(pb, of->matrices(of, t, y, y + pb->nq, y + 2 * pb->nq, pb->p, pb->u, A, M, pb->work), t);
}

int lag_moreau_unit_change(lag_problem *pb, double t, const double *y, const double *g, double *d, double *effort) {
  const lag_constraints *of = pb->model->constraints;
  return lag_step_checked(pb, of->velocity(of, t, y, y + pb->nq, y + 2 * pb->nq, pb->p, pb->u, g, d, effort, pb->work), t);
}

int lag_moreau_strike(lag_problem *pb, double t, const double *y, int i, double *v) {
  const lag_model *m = pb->model;
  double *after = pb->contact_room;
  int nq = pb->nq, stop = 0;
  memcpy(after, y, (size_t)pb->n * sizeof *y);
  int rc = m->act(m, m->contacts[i].impact, t, y, v, y + 2 * nq, pb->p, pb->u, after, after + nq, after + 2 * nq, &stop,
                  pb->work);
  memcpy(v, after + nq, (size_t)nq * sizeof *v);
  return rc ? lag_moreau_contact_fails(pb, t, i, "has no finite restitution") : 0;
}

int lag_moreau_contact_fails(lag_problem *pb, double t, int i, const char *words) {
  snprintf(pb->words, sizeof pb->words, "the contact %s %s",
           pb->model->constraints->of[pb->model->contacts[i].constraint].name, words);
  pb->detail = pb->words;
  return lag_step_failed(pb, LAG_EMETHOD, t);
}

int lag_moreau_singular(lag_problem *pb, double t) { return lag_step_refused(pb, LAG_ESINGULAR, t); }

/* ---- statistics */

void lag_moreau_contacts_note(const lag_moreau_contacts *w, lag_problem *pb, double h, double from, const double *v0,
                              const double *v1) {
  lag_contact_stats *s = pb->contacts;
  const lag_pressing *of = w->all.of;
  const lag_sparse_rows *A = &w->all.A;
  const double *P = w->all.P;
  double work[2] = {0, 0}, own = 0, size = 0;
  memset(pb->contact_impulse, 0, (size_t)pb->model->ncontacts * sizeof *pb->contact_impulse);
  memset(pb->contact_change, 0, (size_t)pb->nq * sizeof *pb->contact_change);
  for (int i = 0; i < w->all.n; i++)
    for (int j = 0; j <= (int)of[i].tangents; j++) {
      int r = (int)of[i].row + j;
      double mean = P[r] * (lag_row_product(A, r, v0) + lag_row_product(A, r, v1)) / 2;
      pb->contact_impulse[(int)of[i].contact + j] = P[r];
      for (int e = (int)w->all.D.first[r]; e < (int)w->all.D.first[r + 1]; e++)
        pb->contact_change[(int)w->all.D.col[e]] += P[r] * w->all.D.value[e];
      work[j > 0] += mean;
      own += mean + P[r] * w->b[r];
      size += fabs(P[r]) * (fabs(w->before[r]) + fabs(lag_row_product(A, r, v1) + w->b[r]) +
                               w->pace[pb->model->contacts[(int)of[i].contact + j].constraint]);
    }
  s->length = h;
  s->work = work[0];
  s->rubbed = work[1];
  s->from = from;
  s->due = w->all.n > 0;
  s->steps += w->all.n > 0;
  for (int i = 0; i < w->all.n; i++)
    s->depth = fmax(s->depth, 0 - w->c[pb->model->contacts[(int)of[i].contact].constraint]);
  s->touching = fmax(s->touching, w->all.n);
  s->impacts += w->impacts;
  s->sweeps += w->sweeps;
  s->gained += own > 1e-10 * size ? own : 0;
}
