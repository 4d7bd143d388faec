/* The model of contacts in one step of moreau, memory and statistics of the step: methods/moreau_contacts.h. */
#include "methods/moreau_contacts.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

#include "methods/moreau_families.h"
#include "methods/steps.h"

/* ---- memory */

/* Bandwidth of M. */
static int band_of(const lag_entry *mass, int n) {
  int band = 0;
  for (int e = 0; e < n; e++) band = mass[e].row - mass[e].col > band ? mass[e].row - mass[e].col : band;
  return band;
}

int lag_moreau_has_others(const lag_model *m) {
  int others = m->constraints && m->constraints->n > m->ncontacts;
  for (int i = 0; i < m->ncontacts; i++) others |= m->contacts[i].conditional;
  return others;
}

/* Sizes of the kernel, for all contacts that a step may have; entries of responses: *responses. */
static lag_moreau_contacts sizes_of(const lag_model *m, int *responses) {
  const lag_constraints *of = m->constraints;
  lag_moreau_contacts w = {.nq = m->nq, .epsilon = DBL_EPSILON};
  if (m->families) {
    w.contacts = w.constraints = lag_family_rows_of(m);
    w.entries = w.contacts * lag_family_parts_of(m);
    w.nmass = m->families->nmass;
    w.mass_at = m->families->mass;
  } else {
    w.contacts = m->ncontacts - m->nguides;
    w.others = lag_moreau_has_others(m);
    w.constraints = of->n;
    w.entries = of->njacobian;
    w.nmass = of->nmass;
    w.mass_at = of->mass;
    w.at = m->contacts;
    w.jacobian_at = of->jacobian;
    w.loads = m->guide_loads ? 3 * m->nguides : 0;
  }
  w.band = band_of(w.mass_at, w.nmass);
  *responses = m->families && w.band == 0 ? w.entries : (m->families ? w.contacts : m->ncontacts) * m->nq;
  return w;
}

static size_t kernel_size(const lag_moreau_contacts *w, int contacts, int responses) {
  return (size_t)LAG_CONTACT_ROOM(contacts, w->constraints, w->nq, w->entries, w->nmass, responses,
                                  lag_band_matrix_size(w->nq, w->band), w->loads);
}

/* One state, the room of the kernel, and that of families. */
size_t lag_moreau_contacts_size(const lag_model *m) {
  int responses;
  if (!m->ncontacts && !m->families) return 0;
  const lag_moreau_contacts w = sizes_of(m, &responses);
  return (size_t)(2 * m->nq + m->nz) + kernel_size(&w, w.contacts + m->nguides, responses) + lag_families_size(m);
}

lag_moreau_contacts lag_moreau_contacts_of(lag_problem *pb, double *law) {
  const lag_model *m = pb->model;
  int responses;
  if (!m->ncontacts && !m->families) return (lag_moreau_contacts){0};
  lag_moreau_contacts w = sizes_of(m, &responses);
  lag_contacts_place(&w, responses, pb->contact_room + pb->n);
  if (m->families) lag_families_begin(pb, pb->contact_room + pb->n + kernel_size(&w, w.contacts, responses));
  else w.law = law, w.guess = pb->contact_impulse, w.load = pb->guide_load;
  return w;
}

int lag_moreau_find(lag_problem *pb, lag_moreau_contacts *w, double t, double h, const double *mid, const double *end) {
  /* impulses of more than so many contacts of families agree to 64 times AGREE, in rates, or after
   * some sweeps to LOOSE: to rounding they would take thousands, and the next step goes on with what they lack */
  enum { MANY = 200 };
  const double AGREE = 1e-10, LOOSE = 3e-3;
  lag_family_step s;
  int rc = pb->model->families ? lag_families_find(pb, t, h, mid, end, &s) : 0;
  if (pb->model->families && rc == 0) {
    w->contacts = w->constraints = s.rows;
    w->entries = s.entries;
    w->at = s.at;
    w->jacobian_at = s.jacobian;
    w->guess = s.guess;
    w->epsilon = s.contacts > MANY ? AGREE : DBL_EPSILON;
    w->loose = s.contacts > MANY ? LOOSE : 0;
  }
  return rc ? rc : lag_contacts_find(pb, w, t, h, mid, end);
}

/* ---- the model */

int lag_moreau_close(lag_problem *pb, double t, int only) {
  const lag_model *m = pb->model;
  int rc = lag_inputs(pb, t);
  for (int i = 0; i < m->ncontacts; i++) {
    if (m->contacts[i].conditional) continue;
    pb->u[m->contacts[i].input] = only < 0 || i == only;
    if (m->contacts[i].is_tangent) pb->u[m->contacts[i].force] = 0;
  }
  return lag_step_checked(pb, rc, t);
}

int lag_moreau_gaps(lag_problem *pb, double t, const double *q, const double *v, const double *z, double *c,
                    double *r) {
  const lag_constraints *of = pb->model->constraints;
  if (pb->model->families) return lag_families_gaps(pb, t, q, v, z, c, r);
  return lag_step_checked(pb, of->residuals(of, t, q, v, z, pb->p, pb->u, c, r, pb->work), t);
}

int lag_moreau_matrices(lag_problem *pb, double t, const double *y, double *A, double *M) {
  const lag_constraints *of = pb->model->constraints;
  if (pb->model->families) return lag_families_matrices(pb, t, y, A, M);
  return lag_step_checked(pb, of->matrices(of, t, y, y + pb->nq, y + 2 * pb->nq, pb->p, pb->u, A, M, pb->work), t);
}

int lag_moreau_unit_change(lag_problem *pb, double t, const double *y, const double *g, double *d, double *effort) {
  const lag_model *m = pb->model;
  const lag_constraints *of = m->constraints;
  const double *v = y + pb->nq, *z = v + pb->nq;
  int rc = m->guide_loads
               ? m->guide_loads(m, t, y, v, z, pb->p, pb->u, g, d, effort, effort + pb->nq, pb->work)
               : of->velocity(of, t, y, v, z, pb->p, pb->u, g, d, effort, pb->work);
  return lag_step_checked(pb, rc, t);
}

int lag_moreau_frictions(lag_problem *pb, double t, const double *y, double *law) {
  return pb->model->families ? lag_families_laws(pb, t, y, law) : 0; /* others have those at the start of the run */
}

int lag_moreau_strike(lag_problem *pb, double t, const double *y, int i, double *v) {
  const lag_model *m = pb->model;
  if (m->families) return lag_families_strike(pb, t, y, i, v);
  double *after = pb->contact_room;
  int nq = pb->nq, stop = 0;
  memcpy(after, y, (size_t)pb->n * sizeof *y);
  int rc = m->act(m, m->contacts[i].impact, t, y, v, y + 2 * nq, pb->p, pb->u, after, after + nq, after + 2 * nq, &stop,
                  pb->work);
  memcpy(v, after + nq, (size_t)nq * sizeof *v);
  return rc ? lag_moreau_contact_fails(pb, t, i, "has no finite restitution") : 0;
}

int lag_moreau_contact_fails(lag_problem *pb, double t, int i, const char *words) {
  const lag_model *m = pb->model;
  char text[120];
  const char *name = m->families ? lag_families_member(pb, i, text, sizeof text)
                                 : m->constraints->of[m->contacts[i].constraint].name;
  snprintf(pb->words, sizeof pb->words, "the contact %s %s", name, words);
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
  if (pb->model->families) lag_families_note(pb);
  memset(pb->contact_impulse, 0,
         (size_t)(pb->model->families ? w->contacts : pb->model->ncontacts) * sizeof *pb->contact_impulse);
  memset(pb->contact_change, 0, (size_t)pb->nq * sizeof *pb->contact_change);
  for (int i = 0; i < w->all.n; i++)
    for (int j = 0; j <= (int)of[i].tangents; j++) {
      int r = (int)of[i].row + j;
      double mean = P[r] * (lag_row_product(A, r, v0) + lag_row_product(A, r, v1)) / 2;
      pb->contact_impulse[(int)of[i].contact + j] = P[r];
      for (int e = (int)w->all.D.first[r]; e < (int)w->all.D.first[r + 1]; e++)
        pb->contact_change[(int)w->all.D.col[e]] += P[r] * w->all.D.value[e];
      if (j) mean += P[r] * (of[i].tail[j - 1] - of[i].turn[j - 1]) / 2; /* slips at the ends */
      work[j > 0] += mean;
      own += mean + P[r] * w->b[r];
      size += fabs(P[r]) * (fabs(w->before[r]) + fabs(lag_row_product(A, r, v1) + w->b[r]) +
                               w->pace[w->at[(int)of[i].contact + j].constraint]);
    }
  s->length = h;
  s->work = work[0];
  s->rubbed = work[1];
  s->from = from;
  s->due = w->all.n > 0;
  s->steps += w->all.n > 0;
  for (int i = 0; i < w->all.n; i++)
    s->depth = fmax(s->depth, 0 - w->c[w->at[(int)of[i].contact].constraint]);
  s->touching = fmax(s->touching, w->all.n);
  s->impacts += w->impacts;
  s->sweeps += w->sweeps;
  s->gained += own > 1e-10 * size ? own : 0;
}
