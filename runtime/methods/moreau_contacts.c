/* The model of contacts in one step of moreau, memory and statistics of the step: methods/moreau_contacts.h. */
#include "methods/moreau_contacts.h"

#include <float.h>
#include <limits.h>
#include <math.h>
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

/* The model's own contacts, without guides; families' stand behind them. */
static int own_contacts(const lag_model *m) { return m->ncontacts - m->nguides; }
static int own_constraints(const lag_model *m) { return m->constraints ? m->constraints->n : 0; }
static int own_entries(const lag_model *m) { return m->constraints ? m->constraints->njacobian : 0; }

/* Entries of a family's row of responses. */
static double family_responses(const lag_model *m, const lag_moreau_contacts *w) {
  const double parts = lag_family_parts_of(m) + (w->others ? own_entries(m) : 0);
  return w->band > 0 || w->loads > 0 || parts > m->nq ? m->nq : parts;
}

/* Sizes of the kernel, for all contacts that a step may have; entries of responses: *responses. */
static lag_moreau_contacts sizes_of(const lag_model *m, double *responses) {
  const lag_constraints *of = m->constraints;
  const int rows = lag_family_rows_of(m);
  lag_moreau_contacts w = {.nq = m->nq, .epsilon = DBL_EPSILON, .others = lag_moreau_has_others(m)};
  w.contacts = own_contacts(m) + rows;
  w.constraints = own_constraints(m) + rows;
  w.entries = own_entries(m) + rows * lag_family_parts_of(m);
  w.nmass = of ? of->nmass : m->families->nmass;
  w.mass_at = of ? of->mass : m->families->mass;
  w.at = m->contacts;
  if (of) w.jacobian_at = of->jacobian;
  w.loads = m->guide_loads ? 3 * m->nguides : 0;
  w.band = band_of(w.mass_at, w.nmass);
  *responses = (double)m->ncontacts * m->nq + rows * family_responses(m, &w);
  return w;
}

static size_t kernel_size(const lag_moreau_contacts *w, int contacts, double responses) {
  return (size_t)LAG_CONTACT_ROOM(contacts, w->constraints, w->nq, w->entries, w->nmass, (int)responses,
                                  lag_band_matrix_size(w->nq, w->band), w->loads);
}

int lag_moreau_is_too_large(const lag_model *m) {
  double responses;
  if (!m->families) return 0;
  const lag_moreau_contacts w = sizes_of(m, &responses);
  return 2 * responses + 32.0 * w.contacts + 4.0 * w.entries > INT_MAX;
}

/* One state, the room of the kernel, and that of families. */
size_t lag_moreau_contacts_size(const lag_model *m) {
  double responses;
  if ((!m->ncontacts && !m->families) || lag_moreau_is_too_large(m)) return 0;
  const lag_moreau_contacts w = sizes_of(m, &responses);
  return (size_t)(2 * m->nq + m->nz) + kernel_size(&w, w.contacts + m->nguides, responses) + lag_families_size(m);
}

lag_moreau_contacts lag_moreau_contacts_of(lag_problem *pb, double *law) {
  const lag_model *m = pb->model;
  double responses;
  if (!m->ncontacts && !m->families) return (lag_moreau_contacts){0};
  lag_moreau_contacts w = sizes_of(m, &responses);
  lag_contacts_place(&w, (int)responses, pb->contact_room + pb->n);
  w.guess = pb->contact_impulse;
  w.load = pb->guide_load;
  if (!m->families) w.law = law;
  else lag_families_begin(pb, pb->contact_room + pb->n + kernel_size(&w, w.contacts + m->nguides, responses));
  if (m->families && law) memcpy(w.law, law, 2 * (size_t)own_contacts(m) * sizeof *law);
  return w;
}

int lag_moreau_find(lag_problem *pb, lag_moreau_contacts *w, double t, double h, const double *mid, const double *end) {
  /* impulses of more than so many contacts of families agree to 64 times AGREE, in rates, or after
   * some sweeps to LOOSE: to rounding they would take thousands, and the next step goes on with what they lack */
  enum { MANY = 200 };
  const double AGREE = 1e-10, LOOSE = 3e-3;
  lag_family_step s;
  const lag_model *m = pb->model;
  int rc = m->families ? lag_families_find(pb, t, h, mid, end, w->band > 0, &s) : 0;
  if (m->families && rc == 0) {
    w->contacts = own_contacts(m) + s.rows;
    w->constraints = own_constraints(m) + s.rows;
    w->entries = own_entries(m) + s.entries;
    w->at = s.at;
    w->jacobian_at = s.jacobian;
    w->guess = s.guess;
    w->bound = s.bound;
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
    pb->u[m->contacts[i].input] = only < 0 || (i == only && i < own_contacts(m)); /* of a family's: none */
    if (m->contacts[i].is_tangent) pb->u[m->contacts[i].force] = 0;
  }
  return lag_step_checked(pb, rc, t);
}

int lag_moreau_gaps(lag_problem *pb, double t, const double *q, const double *v, const double *z, double *c,
                    double *r) {
  const lag_model *m = pb->model;
  const lag_constraints *of = m->constraints;
  const int first = own_constraints(m), rc = of ? of->residuals(of, t, q, v, z, pb->p, pb->u, c, r, pb->work) : 0;
  if (rc || !m->families) return lag_step_checked(pb, rc, t);
  return lag_families_gaps(pb, t, q, v, c + first, r + first);
}

int lag_moreau_matrices(lag_problem *pb, double t, const double *y, double *A, double *M) {
  const lag_model *m = pb->model;
  const lag_constraints *of = m->constraints;
  const double *v = y + pb->nq, *z = v + pb->nq;
  const int rc = of ? of->matrices(of, t, y, v, z, pb->p, pb->u, A, M, pb->work)
                    : m->families->inertia(m->families, t, y, v, z, pb->p, pb->u, M, pb->work);
  if (rc || !m->families) return lag_step_checked(pb, rc, t);
  return lag_families_rows(pb, t, y, A + own_entries(m));
}

/* Least change d of velocities with A d = g, and forces that make it. */
static int least_change(lag_problem *pb, double t, const double *y, const double *g, double *d, double *effort) {
  const lag_model *m = pb->model;
  const lag_constraints *of = m->constraints;
  const double *v = y + pb->nq, *z = v + pb->nq;
  int rc = m->guide_loads
               ? m->guide_loads(m, t, y, v, z, pb->p, pb->u, g, d, effort, effort + pb->nq, pb->work)
               : of->velocity(of, t, y, v, z, pb->p, pb->u, g, d, effort, pb->work);
  return lag_step_checked(pb, rc, t);
}

/* free[nq] := change of velocities by a unit impulse of a row of A, g: what constraints take away of it. */
static void free_change(const lag_problem *pb, lag_moreau_contacts *w, int row, double *free, double *g) {
  const lag_model *m = pb->model;
  const lag_constraints *of = m->constraints;
  const lag_sparse_rows *A = &w->all.A;
  const lag_band_matrix M = lag_contact_inertia(w);
  memset(free, 0, (size_t)pb->nq * sizeof *free);
  for (int e = (int)A->first[row]; e < (int)A->first[row + 1]; e++) free[(int)A->col[e]] = A->value[e];
  lag_band_matrix_solve(&M, free);
  memset(g, 0, (size_t)of->n * sizeof *g);
  for (int e = 0; e < of->njacobian; e++) g[of->jacobian[e].row] -= w->jacobian[e] * free[of->jacobian[e].col];
  for (int i = 0; i < m->ncontacts; i++)
    if (!m->contacts[i].conditional) g[m->contacts[i].constraint] = 0;
}

/* Of a family's row the change by its impulse alone and by those of constraints that it calls forth. */
int lag_moreau_unit_change(lag_problem *pb, lag_moreau_contacts *w, int row, double t, const double *y, double *d,
                           double *effort) {
  const double rounding = 1e-12; /* of a row that constraints hold */
  const lag_sparse_rows *A = &w->all.A;
  const int of_family = w->all.of[w->all.n - 1].contact >= own_contacts(pb->model);
  double *free = w->x, size = 0;
  if (!of_family) return least_change(pb, t, y, w->g, d, effort);
  const char *tied = lag_families_tied(pb);
  free_change(pb, w, row, free, w->g);
  const int rc = least_change(pb, t, y, w->g, d, effort);
  for (int j = 0; j < pb->nq && rc == 0; j++) d[j] = free[j] + (tied[j] || w->band > 0 ? d[j] : 0);
  for (int e = (int)A->first[row]; e < (int)A->first[row + 1]; e++) {
    size += fabs(A->value[e] * free[(int)A->col[e]]);
    effort[(int)A->col[e]] += A->value[e];
  }
  const double response = lag_row_product(A, row, d), unit = response > rounding * size ? 1 / response : 0;
  for (int j = 0; j < pb->nq; j++) d[j] *= unit;
  for (int j = 0; j < pb->nq + w->loads; j++) effort[j] *= unit;
  return rc;
}

/* Of the model's own contacts those at the start of the run. */
int lag_moreau_frictions(lag_problem *pb, double t, const double *y, double *law) {
  return pb->model->families ? lag_families_laws(pb, t, y, law + 2 * own_contacts(pb->model)) : 0;
}

int lag_moreau_strike(lag_problem *pb, double t, const double *y, int i, double *v) {
  const lag_model *m = pb->model;
  if (i >= own_contacts(m)) return lag_families_strike(pb, t, y, i - own_contacts(m), v);
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
  const char *name = i < own_contacts(m) ? m->constraints->of[m->contacts[i].constraint].name
                                         : lag_families_member(pb, i - own_contacts(m), text, sizeof text);
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
  const int contacts = own_contacts(pb->model), guides = pb->model->nguides;
  double work[2] = {0, 0}, own = 0, size = 0;
  if (pb->model->families) lag_families_note(pb);
  memset(pb->contact_impulse, 0, (size_t)(w->contacts + guides) * sizeof *pb->contact_impulse);
  memset(pb->contact_change, 0, (size_t)pb->nq * sizeof *pb->contact_change);
  for (int i = 0; i < w->all.n; i++)
    for (int j = 0; j <= (int)of[i].tangents; j++) {
      int r = (int)of[i].row + j;
      double mean = P[r] * (lag_row_product(A, r, v0) + lag_row_product(A, r, v1)) / 2;
      const int contact = (int)of[i].contact + j;
      pb->contact_impulse[contact < contacts ? contact : contact + guides] = P[r]; /* families' behind all others */
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
