/* Responses of velocities to impulses of contacts where these alone constrain the motion: M is factored once for all of
 * them, within its band. Contract: contact_set.h. */
#include <math.h>
#include <string.h>

#include "contacts/contact_set.h"
#include "kernels/band_matrix.h"

int lag_contacts_band(const lag_model *m) {
  const lag_constraints *of = m->constraints;
  int band = of->n == m->ncontacts ? 0 : -1;
  for (int i = 0; i < m->ncontacts; i++) band = m->contacts[i].conditional ? -1 : band;
  for (int e = 0; e < of->nmass && band >= 0; e++) band = (int)fmax(band, of->mass[e].row - of->mass[e].col);
  return band;
}

void lag_contacts_list_entries(ContactSet *w) {
  const lag_constraints *of = w->sim->scene->model->constraints;
  w->entry = w->row + of->n + 2;
  for (int e = 0; e < of->njacobian; e++) w->row[of->jacobian[e].row + 2]++;
  for (int k = 2; k <= of->n + 1; k++) w->row[k] += w->row[k - 1];
  for (int e = 0; e < of->njacobian; e++) w->entry[w->row[of->jacobian[e].row + 1]++] = e;
}

double lag_contacts_rate_change(const lag_model *m, const double *A, int i, const double *d) {
  const lag_constraints *of = m->constraints;
  double s = 0;
  for (int e = 0; e < of->njacobian; e++)
    s += of->jacobian[e].row == m->contacts[i].constraint ? A[e] * d[of->jacobian[e].col] : 0;
  return s;
}

double lag_contacts_change_of_rate(const ContactSet *w, int i, const double *d) {
  const lag_model *m = w->sim->scene->model;
  const int *row = w->row + m->contacts[i].constraint;
  double s = 0;
  for (int k = row[0]; k < row[1]; k++) s += w->A[w->entry[k]] * d[m->constraints->jacobian[w->entry[k]].col];
  return s;
}

void lag_contacts_factor_mass(ContactSet *w) {
  const lag_model *m = w->sim->scene->model;
  const lag_constraints *of = m->constraints;
  lag_band_matrix M = {m->nq, w->band, w->lu, w->pivot};
  for (int e = 0; e < of->nmass && w->band >= 0; e++) {
    *lag_band_matrix_at(&M, of->mass[e].row, of->mass[e].col) = w->mass[e];
    *lag_band_matrix_at(&M, of->mass[e].col, of->mass[e].row) = w->mass[e];
  }
  if (w->band >= 0 && lag_band_matrix_factor(&M, w->diagonal)) w->band = -1;
}

static int body_of(int *body, int j) {
  while (body[j] != j) j = body[j] = body[body[j]];
  return j;
}

static void join(int *body, int i, int j) { body[body_of(body, i)] = body_of(body, j); }

void lag_contacts_find_islands(ContactSet *w) {
  const lag_model *m = w->sim->scene->model;
  const lag_constraints *of = m->constraints;
  for (int j = 0; j < m->nq; j++) w->body[j] = j;
  for (int e = 0; e < of->nmass && w->band > 0; e++)
    if (w->mass[e] != 0) join(w->body, of->mass[e].row, of->mass[e].col);
  for (int pass = 0; pass < 2; pass++)
    for (int a = 0; a < w->rows; a++) {
      const int *row = w->row + m->contacts[w->of[a]].constraint;
      int first = -1;
      for (int k = row[0]; k < row[1] && w->band >= 0; k++) {
        int col = of->jacobian[w->entry[k]].col;
        if (w->A[w->entry[k]] == 0) continue;
        if (first >= 0) join(w->body, first, col);
        first = col;
      }
      w->island[a] = first < 0 ? -1 : body_of(w->body, first);
    }
}

double lag_contacts_free_response(ContactSet *w, int i) {
  const lag_model *m = w->sim->scene->model;
  const int *row = w->row + m->contacts[i].constraint;
  const lag_band_matrix M = {m->nq, w->band, w->lu, w->pivot};
  memset(w->d, 0, (size_t)m->nq * sizeof *w->d);
  for (int k = row[0]; k < row[1]; k++) {
    int col = m->constraints->jacobian[w->entry[k]].col;
    w->d[col] += w->A[w->entry[k]] / (w->band ? 1 : *lag_band_matrix_at(&M, col, col));
  }
  if (w->band) lag_band_matrix_solve(&M, w->d);
  double to = lag_contacts_change_of_rate(w, i, w->d);
  for (int j = 0; j < m->nq; j++) w->d[j] = to > 0 ? w->d[j] / to : 0;
  return to > 0 || isnan(to) ? to : 0;
}

int lag_contacts_keep_constraints(const ContactSet *w, const double *d, double square) {
  const double alike = 1e-6;
  const lag_model *m = w->sim->scene->model;
  const lag_constraints *of = m->constraints;
  double *rate = w->c, *free = w->r;
  memset(rate, 0, (size_t)of->n * sizeof *rate);
  memset(free, 0, (size_t)of->n * sizeof *free);
  for (int e = 0; e < of->njacobian; e++) {
    const lag_entry *at = &of->jacobian[e];
    double mass = 0;
    for (int k = 0; k < of->nmass; k++)
      mass += of->mass[k].row == at->col && of->mass[k].col == at->col ? w->mass[k] : 0;
    rate[at->row] += w->A[e] * d[at->col];
    free[at->row] += mass > 0 ? w->A[e] * w->A[e] / mass : HUGE_VAL;
  }
  for (int i = 0; i < m->ncontacts; i++) rate[m->contacts[i].constraint] = 0;
  for (int k = 0; k < of->n; k++)
    if (rate[k] * rate[k] > alike * alike * square * free[k]) return 0;
  return 1;
}
