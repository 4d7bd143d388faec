/* Contacts in one step of moreau. Enters, leaves: moreau_contacts.h. Holds: no contact does work on the motion,
 * measured by its impulse and the mean of its rates at both ends.
 *
 * A contact takes part where its gap is closed at the middle of the step, and where it may close until the end at a
 * rate that forces cause in a step, its pace: so that what lies stays where it is. Its rate afterwards, u, is
 * bounded by Newton's law u >= -e u0 where it was closing faster than its pace, by u >= 0 (or what is left of a gap)
 * where slower, and by u >= -u0 where it was opening; so P (u0 + u) <= 0. Where the gap is curved, its rate is 0 at
 * the end of the step, not at the middle, and curvature belongs to the pace: a bead in a hoop does not strike it.
 * Friction opposes the mean of the slip velocities at both ends: it drives the slip s into the ball whose diameter
 * goes from -s0 to 0, so F (s0 + s) <= 0. In an impact it opposes the slip at the end, driven to 0, or with
 * tangential restitution to -e_t s0, as in the papers below; at a contact where this would add energy, as it may
 * where the impulse turns the slip round (T.R. Kane, D.A. Levinson, Dynamics (1985), 5.8), the mean of both, too, so
 * P (u0 + u) + F (s0 + s) <= 0 always. J.J. Moreau, in: Nonsmooth Mechanics and Applications (1988), 1, DOI
 * 10.1007/978-3-7091-2624-0_1; D.E. Stewart, J.C. Trinkle, Int. J. Numer. Methods Eng. 39 (1996) 2673, DOI
 * 10.1002/(SICI)1097-0207(19960815)39:15<2673::AID-NME972>3.0.CO;2-I. */
#include "methods/moreau_contacts.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

#include "kernels/band_matrix.h"
#include "methods/steps.h"
#include "numeric/complementarity.h"
#include "numeric/workspace.h"

enum { MOST_SWEEPS = 200000 };

int lag_contact_tangents(const lag_model *m, int i) {
  int n = 0;
  while (i + n + 1 < m->ncontacts && m->contacts[i + n + 1].is_tangent) n++;
  return n;
}

/* Bandwidth of M. */
static int band_of(const lag_constraints *of) {
  int band = 0;
  for (int e = 0; e < of->nmass; e++)
    band = of->mass[e].row - of->mass[e].col > band ? of->mass[e].row - of->mass[e].col : band;
  return band;
}

static size_t lay_out(const lag_model *m, double *room, MoreauContacts *w) {
  const lag_constraints *of = m->constraints;
  double *contacts;
  size_t p = (size_t)m->ncontacts, n = (size_t)of->n, nq = (size_t)m->nq, state = 2 * nq + (size_t)m->nz,
         nj = (size_t)of->njacobian;
  double **const parts[] = {&contacts,    &w->A.first, &w->A.col, &w->A.value, &w->D.first, &w->D.col,    &w->D.value,
                            &w->response, &w->b,       &w->P,     &w->before,  &w->c,       &w->r0,       &w->r1,
                            &w->pace,     &w->bend,    &w->g,     &w->d,       &w->effort,  &w->jacobian, &w->mass,
                            &w->band,     &w->pivot,   &w->scale, &w->test,    &w->after};
  const size_t sizes[] = {p * sizeof(lag_pressing) / sizeof(double),
                          p + 1, nj, nj, p + 1, p * nq, p * nq, p, p, p, p, n, n, n, n, n, n, nq, nq, nj,
                          (size_t)of->nmass, (size_t)lag_band_matrix_size(m->nq, band_of(of)), nq, nq, state,
                          state};
  size_t all = lag_workspace_slice(room, sizeof sizes / sizeof *sizes, parts, sizes);
  if (room) w->of = (lag_pressing *)(void *)contacts;
  return all;
}

size_t lag_moreau_contacts_size(const lag_model *m) {
  return m->ncontacts ? lay_out(m, NULL, &(MoreauContacts){0}) : 0;
}

MoreauContacts lag_moreau_contacts(const lag_problem *pb) {
  MoreauContacts w = {0};
  if (pb->model->ncontacts) lay_out(pb->model, pb->contact_room, &w);
  w.force = pb->contact_impulse;
  return w;
}

/* pb->u with all contacts closed, or `only` alone. */
static int close(lag_problem *pb, double t, int only) {
  const lag_model *m = pb->model;
  int rc = lag_inputs(pb, t);
  for (int i = 0; i < m->ncontacts; i++) {
    pb->u[m->contacts[i].input] = only < 0 || i == only;
    if (m->contacts[i].is_tangent) pb->u[m->contacts[i].force] = 0;
  }
  return rc;
}

static const char *name_of(const lag_problem *pb, int i) {
  return pb->model->constraints->of[pb->model->contacts[i].constraint].name;
}

static int fail(lag_problem *pb, double t, int i, const char *what) {
  snprintf(pb->words, sizeof pb->words, "the contact %s %s", name_of(pb, i), what);
  pb->detail = pb->words;
  return lag_step_failed(pb, LAG_EMETHOD, t);
}

/* ---- responses */

/* d := change of velocities by a unit impulse of contact i of the model, whose row of A is `row`, under the other
 * constraints. */
static int respond(MoreauContacts *w, lag_problem *pb, double t, const double *y, int i, int row) {
  const lag_constraints *of = pb->model->constraints;
  int nq = pb->nq, k = pb->model->contacts[i].constraint, rc = 0;
  memset(w->d, 0, (size_t)nq * sizeof *w->d);
  if (of->n == pb->model->ncontacts) {
    lag_band_matrix M = {nq, band_of(of), w->band, w->pivot};
    for (int e = (int)w->A.first[row]; e < (int)w->A.first[row + 1]; e++) w->d[(int)w->A.col[e]] = w->A.value[e];
    lag_band_matrix_solve(&M, w->d);
    return 0;
  }
  memset(w->g, 0, (size_t)of->n * sizeof *w->g);
  w->g[k] = 1;
  rc = close(pb, t, i);
  rc = rc ? rc : of->velocity(of, t, y, y + nq, y + 2 * nq, pb->p, pb->u, w->g, w->d, w->effort, pb->work);
  double work = 0;
  for (int j = 0; j < nq && rc == 0; j++) work += w->d[j] * w->effort[j];
  int moves = rc == 0 && work > 0 && lag_row_moves(lag_row_product(&w->A, row, w->d));
  for (int j = 0; j < nq && rc == 0; j++) w->d[j] = moves ? w->d[j] / work : 0;
  return rc;
}

/* Factors M of the entries in w->mass. */
static int factor(MoreauContacts *w, const lag_problem *pb) {
  const lag_constraints *of = pb->model->constraints;
  lag_band_matrix M = {pb->nq, band_of(of), w->band, w->pivot};
  memset(w->band, 0, (size_t)lag_band_matrix_size(M.n, M.band) * sizeof *w->band);
  for (int e = 0; e < of->nmass; e++) {
    *lag_band_matrix_at(&M, of->mass[e].row, of->mass[e].col) = w->mass[e];
    *lag_band_matrix_at(&M, of->mass[e].col, of->mass[e].row) = w->mass[e];
  }
  return lag_band_matrix_factor(&M, w->scale) ? LAG_ESINGULAR : 0;
}

/* Rows of A and D for contact i of the model, its next row being w->rows. */
static int add_row(MoreauContacts *w, lag_problem *pb, double t, const double *y, int i) {
  const lag_constraints *of = pb->model->constraints;
  int r = w->rows++, e = (int)w->A.first[r], f = (int)w->D.first[r], k = pb->model->contacts[i].constraint;
  for (int j = 0; j < of->njacobian; j++) {
    if (of->jacobian[j].row != k) continue;
    w->A.col[e] = of->jacobian[j].col;
    w->A.value[e++] = w->jacobian[j];
  }
  w->A.first[r + 1] = e;
  int rc = respond(w, pb, t, y, i, r);
  for (int j = 0; j < pb->nq && rc == 0; j++) {
    if (w->d[j] == 0.0) continue;
    w->D.col[f] = j;
    w->D.value[f++] = w->d[j];
  }
  w->D.first[r + 1] = f;
  w->response[r] = rc ? 0 : lag_row_product(&w->A, r, w->d);
  w->before[r] = w->r0[k];
  w->b[r] = w->r0[k] - lag_row_product(&w->A, r, y + pb->nq);
  w->P[r] = w->force[i];
  return rc;
}

/* ---- laws */

/* The law of contact i of the model, whose rows are there. */
static int set_law(MoreauContacts *w, lag_problem *pb, double t, double h, const double *y, const double *law, int i,
                   lag_pressing *c) {
  int row = (int)c->row, k = pb->model->contacts[i].constraint,
      strikes = lag_contact_strikes(w->r0[k], w->pace[k]) && w->response[row] > 0;
  double e = 0;
  if (strikes) {
    int rc = close(pb, t, i);
    for (int j = 0; j < pb->nq; j++) w->d[j] = 0;
    for (int n = (int)w->D.first[row]; n < (int)w->D.first[row + 1]; n++)
      w->d[(int)w->D.col[n]] = w->D.value[n] / w->response[row];
    e = rc ? NAN : lag_contact_restitution(pb, t, y, i, w->r0[k], -w->r0[k], w->d, w->jacobian, w->test, w->after);
    if (!isfinite(e)) return fail(pb, t, i, "has no finite restitution");
    w->impacts++;
  }
  c->mu = c->tangents > 0 ? law[2 * (i + 1)] : 0;
  lag_contact_law(c, w->c[k], w->r0[k], w->bend[k], h, e, strikes && c->tangents > 0 ? law[2 * (i + 1) + 1] : 0,
                  strikes, w->before + row + 1);
  return 0;
}

/* Gaps, rates at both ends without contacts, what forces and curvature change them by, and matrices. */
static int evaluate(MoreauContacts *w, lag_problem *pb, double t, double h, const double *y, const double *free) {
  const lag_constraints *of = pb->model->constraints;
  int nq = pb->nq, rc = close(pb, t - h / 2, -1);
  for (int i = 0; i < nq; i++) w->test[i] = y[i] - h / 2 * y[nq + i];
  rc = rc ? rc : of->residuals(of, t - h / 2, w->test, y + nq, y + 2 * nq, pb->p, pb->u, w->c, w->bend, pb->work);
  rc = rc ? rc : close(pb, t, -1);
  rc = rc ? rc : of->residuals(of, t, y, free, y + 2 * nq, pb->p, pb->u, w->c, w->r1, pb->work);
  rc = rc ? rc : of->residuals(of, t, y, y + nq, y + 2 * nq, pb->p, pb->u, w->c, w->r0, pb->work);
  rc = rc ? rc : of->matrices(of, t, y, y + nq, y + 2 * nq, pb->p, pb->u, w->jacobian, w->mass, pb->work);
  for (int k = 0; k < of->n; k++) {
    w->bend[k] = w->r0[k] - w->bend[k];
    w->pace[k] = 2 * fabs(w->bend[k]);
  }
  for (int e = 0; e < of->njacobian && rc == 0; e++) {
    int j = of->jacobian[e].col;
    w->pace[of->jacobian[e].row] += fabs(w->jacobian[e] * (free[j] - y[nq + j]));
  }
  for (int i = 0; i < pb->model->ncontacts && rc == 0; i++) {
    int k = pb->model->contacts[i].constraint;
    if (!isfinite(w->r0[k]) || !isfinite(w->r1[k]) || (!pb->model->contacts[i].is_tangent && !isfinite(w->c[k])))
      return fail(pb, t, i, "has no finite values");
  }
  return rc ? lag_step_refused(pb, rc, t) : 0;
}

int lag_moreau_contacts_find(MoreauContacts *w, lag_problem *pb, double t, double h, const double *y,
                             const double *free, const double *law) {
  const lag_model *m = pb->model;
  int known = 0, rc = evaluate(w, pb, t, h, y, free);
  w->n = w->rows = 0;
  w->impacts = w->sweeps = 0;
  w->A.first[0] = w->D.first[0] = 0;
  for (int i = 0; i < m->ncontacts && rc == 0; i++) {
    int k = m->contacts[i].constraint, tangents = lag_contact_tangents(m, i);
    if (m->contacts[i].is_tangent || !lag_contact_takes_part(w->c[k], w->r0[k], w->r1[k], w->pace[k], h)) continue;
    if (!known++ && m->constraints->n == m->ncontacts && (rc = factor(w, pb)) != 0) return lag_step_refused(pb, rc, t);
    lag_pressing *c = &w->of[w->n++];
    *c = (lag_pressing){.contact = i, .row = w->rows, .tangents = tangents};
    for (int j = 0; j <= tangents && rc == 0; j++) rc = add_row(w, pb, t, y, i + j);
    if (rc) return lag_step_refused(pb, rc, t);
    rc = set_law(w, pb, t, h, y, law, i, c);
    pb->contacts->depth = fmax(pb->contacts->depth, 0 - w->c[k]);
    if (rc == 0 && !(w->response[(int)c->row] > 0) && w->r1[k] < 0)
      return fail(pb, t, i, "closes, and nothing can keep it from closing");
  }
  return rc;
}

int lag_moreau_contacts_solve(MoreauContacts *w, lag_problem *pb, double t, double *v) {
  const double enough = 64 * DBL_EPSILON;
  double size = 0;
  for (int r = 0; r < w->rows; r++)
    for (int e = (int)w->A.first[r]; e < (int)w->A.first[r + 1]; e++)
      size = fmax(size, fabs(w->A.value[e] * v[(int)w->A.col[e]]));
  if (!w->n) return 0;
  const lag_impulses impulses = {w->n, w->of, w->A, w->D, w->response, w->b, w->P, v};
  int sweeps = lag_contact_impulses(&impulses, enough * size, MOST_SWEEPS);
  w->sweeps += sweeps;
  return sweeps > MOST_SWEEPS
             ? fail(pb, t, (int)w->of[0].contact,
                    "and others find no impulses that agree: take smaller steps, or look for bodies that are wedged")
             : 0;
}

void lag_moreau_contacts_note(MoreauContacts *w, lag_problem *pb, double h, double from, const double *v0,
                              const double *v1) {
  lag_contact_stats *s = pb->contacts;
  double work[2] = {0, 0}, own = 0, size = 0;
  memset(w->force, 0, (size_t)pb->model->ncontacts * sizeof *w->force);
  memset(pb->contact_change, 0, (size_t)pb->nq * sizeof *pb->contact_change);
  for (int i = 0; i < w->n; i++)
    for (int j = 0; j <= (int)w->of[i].tangents; j++) {
      int r = (int)w->of[i].row + j;
      double mean = w->P[r] * (lag_row_product(&w->A, r, v0) + lag_row_product(&w->A, r, v1)) / 2;
      w->force[(int)w->of[i].contact + j] = w->P[r];
      for (int e = (int)w->D.first[r]; e < (int)w->D.first[r + 1]; e++)
        pb->contact_change[(int)w->D.col[e]] += w->P[r] * w->D.value[e];
      work[j > 0] += mean;
      own += mean + w->P[r] * w->b[r];
      size += fabs(w->P[r]) * (fabs(w->before[r]) + fabs(lag_row_product(&w->A, r, v1) + w->b[r]) +
                               w->pace[pb->model->contacts[(int)w->of[i].contact + j].constraint]);
    }
  s->length = h;
  s->work = work[0];
  s->rubbed = work[1];
  s->from = from;
  s->due = w->n > 0;
  s->steps += w->n > 0;
  s->touching = fmax(s->touching, w->n);
  s->impacts += w->impacts;
  s->sweeps += w->sweeps;
  s->gained += own > 1e-10 * size ? own : 0;
}
