/* Contacts: gaps that stay at least 0. Enters: a state set by an event or a user; leaves: the state after all
 * impacts, with the gaps closed that are pressed. Holds: a closed gap is a constraint of the model, switched on by
 * its input in `hold` (1); no closed gap pulls; an open gap that touches is armed anew, so that its next closing is
 * seen. Constraints with a condition (conditional_constraints.c) count as other constraints here.
 *
 * Impacts that follow each other ever faster come to an end in finite time (a ball that loses a fifth of its speed
 * at each bounce). The gap is closed when the rest of that time is too short to matter, or the next flight stays
 * within rounding; Brogliato, Nonsmooth Mechanics, 3rd ed. (2016), 1.4 and 8.1, DOI 10.1007/978-3-319-28664-8.
 *
 * An impact is Newton's law for all gaps at once, each with its coefficient of restitution, as a linear
 * complementarity problem: rate after + e rate before >= 0 where a gap was closing, rate after >= 0 where it rests,
 * an impulse >= 0, and of the two one is 0. Rates are unique, as the nearest ones in the metric of the mass matrix;
 * impulses are unique where no contact depends on others. J.J. Moreau, in: Nonsmooth Mechanics and Applications
 * (1988), 1, DOI 10.1007/978-3-7091-2624-0_1; B. Brogliato, Nonsmooth Mechanics, 3rd ed. (2016), ch. 5, DOI
 * 10.1007/978-3-319-28664-8; Ch. Glocker, Set-Valued Force Laws (2001), DOI 10.1007/978-3-540-44479-4. Forces: the
 * same problem with accelerations in place of rates, P. Loetstedt, SIAM J. Appl. Math. 42 (1982) 281, DOI
 * 10.1137/0142022. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "contacts/contact_set.h"
#include "core/rhs.h"
#include "kernels/band_matrix.h"
#include "numeric/complementarity.h"
#include "numeric/release.h"
#include "numeric/workspace.h"

static int is_of(const lag_contact *c, int event) { return c->impact == event || c->release == event; }

const lag_contact *lag_contact_of(const lag_model *m, int event) {
  const lag_contact *of = m->contacts;
  int low = 0, high = m->ncontacts;
  if (event / 2 < high && is_of(&of[event / 2], event)) return &of[event / 2]; /* two events each, as a rule */
  while (high - low > 1) { /* events rise with contacts, as a rule */
    int mid = (low + high) / 2;
    if (of[mid].impact <= event) low = mid;
    else high = mid;
  }
  if (high && is_of(&of[low], event)) return &of[low];
  for (int i = 0; i < m->ncontacts; i++)
    if (is_of(&of[i], event)) return &of[i];
  return NULL;
}

int lag_has_gaps(const lag_model *m) {
  int i = 0;
  while (i < m->ncontacts && m->contacts[i].conditional) i++;
  return i < m->ncontacts || m->families != NULL;
}

int lag_event_is_located(const lag_sim *s, int k) {
  const lag_contact *c = lag_contact_of(s->scene->model, k);
  return !s->pb.contacts || !c || c->conditional;
}

int lag_contact_is_closed(const lag_sim *s, const lag_contact *c) { return s->hold[c->input] > 0.5; }

void lag_contact_set_closed(lag_sim *s, int i, int closed) {
  const lag_contact *c = &s->scene->model->contacts[i];
  s->hold[c->input] = closed ? 1 : NAN;
  if (c->is_tangent) s->hold[c->force] = NAN;
}

int lag_tangent_of(const lag_model *m, int i) {
  return i + 1 < m->ncontacts && m->contacts[i + 1].is_tangent && lag_guide_of(m, i + 1) < 0 ? i + 1 : -1;
}

void lag_contact_open(lag_sim *s) {
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->ncontacts; i++)
    if (!m->contacts[i].conditional) lag_contact_set_closed(s, i, 0);
}

void lag_contacts_close_only(const ContactSet *w, int all, int which) {
  const lag_model *m = w->sim->scene->model;
  for (int i = 0; i < m->ncontacts; i++)
    if (!m->contacts[i].conditional) lag_contact_set_closed(w->sim, i, all || i == which);
}

int lag_contacts_no_values(ContactSet *w, int i) {
  const lag_model *m = w->sim->scene->model;
  return lag_fail(w->sim, LAG_EMODEL, "the contact %s has no finite values at t = %s s",
                  m->constraints->of[m->contacts[i].constraint].name, LAG_TEXT(w->sim->run->t));
}

/* ---- gaps and rates */

static int make_room(ContactSet *w) {
  const lag_model *m = w->sim->scene->model;
  const lag_constraints *of = m->constraints;
  size_t p = (size_t)m->ncontacts, n = (size_t)of->n, nq = (size_t)m->nq;
  size_t apart = (w->band = lag_contacts_band(m)) < 0 ? 0 : nq;
  const lag_part parts[] = {{&w->gap, p}, {&w->rate, p}, {&w->gap_size, p}, {&w->rate_size, p}, {&w->g, n},
      {&w->c, n}, {&w->r, n}, {&w->d, nq}, {&w->force, nq}, {&w->test, (size_t)w->sim->pb.n},
      {&w->events, (size_t)(m->nev + m->nmodes)}, {&w->ahead, p}, {&w->A, (size_t)of->njacobian},
      {&w->mass, (size_t)of->nmass}, {&w->law, 3 * p + 4 * (size_t)m->nguides}, {&w->side, p}, {&w->way, 2 * p},
      {&w->push, p}, {&w->pressed, 3 * (size_t)m->nguides * (p + 1)}, {&w->pivot, apart}, {&w->diagonal, apart},
      {&w->lu, apart ? (size_t)lag_band_matrix_size(m->nq, w->band) : 0}};
  w->block = lag_workspace(sizeof parts / sizeof *parts, parts);
  w->row = calloc(n + 2 + (size_t)of->njacobian, sizeof *w->row);
  w->of = calloc(p, sizeof *w->of);
  w->at = calloc(p, sizeof *w->at);
  w->island = calloc(p + nq, sizeof *w->island);
  w->body = w->island + p;
  w->active = calloc(5 * p, 1);
  w->closed = w->active + p;
  w->was_closed = w->closed + p;
  w->follows = w->was_closed + p;
  w->state = w->follows + p;
  if (!w->block || !w->row || !w->of || !w->at || !w->island || !w->active)
    return lag_fail(w->sim, LAG_ENOMEM, "out of memory");
  lag_contacts_list_entries(w);
  return LAG_OK;
}

static void free_contacts(ContactSet *w) {
  lag_free_all(w->block, w->row, w->of, w->at, w->island, w->active, w->response);
}

int lag_contacts_rates(ContactSet *w, const double *y, double *rate) {
  const lag_model *m = w->sim->scene->model;
  lag_contacts_close_only(w, 1, -1);
  int rc = lag_residuals(&w->sim->pb, w->sim->run->t, y, w->c, w->r);
  for (int i = 0; i < m->ncontacts; i++)
    rate[i] = rc ? NAN : m->contacts[i].conditional ? 0 : w->r[m->contacts[i].constraint];
  return rc;
}

int lag_contact_term_sizes(lag_sim *s, const double *y, int holonomic, double *size, double *scratch) {
  const lag_constraints *of = s->scene->model->constraints;
  int rc = lag_constraint_terms(&s->pb, s->run->t, y, holonomic, size);
  rc = rc ? rc : lag_constraint_terms(&s->pb, s->run->t, s->begin, holonomic, scratch);
  for (int k = 0; k < (holonomic ? of->nholonomic : of->n) && rc == 0; k++)
    size[k] = fmax(size[k], isfinite(scratch[k]) ? scratch[k] : 0);
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
  for (int i = 0; i < m->ncontacts; i++) w->was_closed[i] = s->hold[m->contacts[i].input] > 0.5;
  rc = lag_contacts_rates(w, y, w->rate);
  for (int i = 0; i < m->ncontacts; i++) {
    if (m->contacts[i].conditional) continue;
    w->gap[i] = m->contacts[i].is_tangent ? 1 : w->c[m->contacts[i].constraint];
    if (rc || !isfinite(w->gap[i]) || !isfinite(w->rate[i])) return lag_contacts_no_values(w, i);
  }
  rc = lag_contact_term_sizes(s, y, 1, w->g, w->c);
  for (int i = 0; i < m->ncontacts; i++)
    w->gap_size[i] = m->contacts[i].is_tangent ? 1 : w->g[m->contacts[i].constraint];
  rc = rc ? rc : lag_contact_term_sizes(s, y, 0, w->g, w->c);
  for (int i = 0; i < m->ncontacts; i++) w->rate_size[i] = w->g[m->contacts[i].constraint];
  rc = rc ? rc : lag_inputs(pb, t);
  if (rc == 0 && m->contact_laws) rc = lag_contact_laws(s, y, w->law);
  rc = rc ? rc
          : m->constraints->matrices(m->constraints, t, y, y + nq, y + 2 * nq, pb->p, pb->u, w->A, w->mass, pb->work);
  lag_contacts_factor_mass(w);
  return rc ? lag_contacts_no_values(w, 0) : LAG_OK;
}

double lag_contacts_response(ContactSet *w, int i) {
  lag_problem *pb = &w->sim->pb;
  int nq = pb->nq, k = w->sim->scene->model->contacts[i].constraint;
  double s = 0;
  if (w->band >= 0) return lag_contacts_free_response(w, i);
  lag_contacts_close_only(w, 0, i);
  memset(w->g, 0, (size_t)pb->model->constraints->n * sizeof *w->g);
  w->g[k] = 1;
  if (lag_least_change(pb, w->sim->run->t, w->y, 0, w->g, w->d, w->force)) return NAN;
  for (int j = 0; j < nq; j++) s += w->d[j] * w->force[j];
  int moves = lag_row_moves(lag_contacts_change_of_rate(w, i, w->d));
  return isnan(s) || (moves && lag_contacts_keep_constraints(w, w->d, s)) ? 1 / s : 0;
}

/* The coefficient of restitution of contact i, from Newton's law in the model for the state whose velocities are
 * changed by w->d, so that the gap closes with `speed`. pb.u: this contact is closed, others are open. NaN: none. */
static double restitution_at(ContactSet *w, int i, double speed) {
  lag_problem *pb = &w->sim->pb;
  const lag_model *m = pb->model;
  int nq = m->nq, stop = 0;
  size_t bytes = (size_t)pb->n * sizeof *w->y;
  double *before = w->sim->yc, *after = w->test;
  memcpy(before, w->y, bytes);
  for (int j = 0; j < nq; j++) before[nq + j] -= (speed + w->rate[i]) * w->d[j];
  memcpy(after, before, bytes);
  if (m->act(m, m->contacts[i].impact, w->sim->run->t, before, before + nq, before + 2 * nq, pb->p, pb->u, after,
             after + nq, after + 2 * nq, &stop, pb->work))
    return NAN;
  for (int j = 0; j < nq; j++) before[nq + j] = after[nq + j] - before[nq + j];
  return lag_contacts_rate_change(m, w->A, i, before + nq) / speed - 1;
}

/* The coefficient of restitution of contact i, at a typical speed, where it has the most digits, unless it depends
 * on the speed; NaN where no impulse moves it. */
static double restitution(ContactSet *w, int i) {
  const double same = 1e-6, roundings = 1e4 * DBL_EPSILON;
  double to = lag_contacts_response(w, i), typical = w->rate_size[i] > 0 ? w->rate_size[i] : 1;
  lag_contacts_close_only(w, 0, i);
  if (!(to > 0) || lag_inputs(&w->sim->pb, w->sim->run->t)) return NAN;
  double e = restitution_at(w, i, typical), now = w->rate[i] < 0 ? restitution_at(w, i, -w->rate[i]) : e;
  return fabs(now - e) > fmax(same, roundings * typical / -w->rate[i]) ? now : e;
}

/* Computes W for the contacts of[n], which is 0 between islands. */
static int find_responses(ContactSet *w) {
  size_t n = (size_t)w->rows;
  double *x = w->response = calloc(2 * n * n + 3 * n + 1, sizeof *x);
  if (!x) return lag_fail(w->sim, LAG_ENOMEM, "out of memory");
  w->lcp = x + n * n;
  w->rhs = w->lcp + n * n;
  w->impulse = w->rhs + n;
  w->scale = w->impulse + n;
  lag_contacts_find_islands(w);
  for (int a = 0; a < w->rows; a++) {
    double to = lag_contacts_response(w, w->of[a]);
    if (!isfinite(to)) return lag_contacts_no_values(w, w->of[a]);
    for (int b = 0; b < w->rows; b++)
      if (w->island[a] == w->island[b])
        w->response[b * w->rows + a] = to * lag_contacts_change_of_rate(w, w->of[b], w->d);
    w->response[a * w->rows + a] = to;
  }
  for (int a = 0; a < w->rows; a++) { /* what constraints imply, others do not move either */
    int moves = w->response[a * (w->rows + 1)] > 0;
    for (int b = 0; b < w->rows && !moves; b++) w->response[a * w->rows + b] = w->response[b * w->rows + a] = 0;
  }
  return LAG_OK;
}

/* ---- contacts of a state */

static const lag_constraint *constraint_of(const lag_sim *s, int i) {
  const lag_model *m = s->scene->model;
  return &m->constraints->of[m->contacts[i].constraint];
}

/* A speed after an impact, relative to that before, that counts as 0. */
static const double no_speed = 1e-9;

/* ---- contacts that take part */

/* of[n] := contacts that take part, behind them tangents, those of guides last: closed before, of this event, or
 * without a gap. Refuses a state set by `who` (if not NULL) with a negative gap. */
static int find_touching(ContactSet *w, const char *who, int event) {
  lag_sim *s = w->sim;
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    if (c->conditional) continue;
    int inside = w->gap[i] < -lag_no_gap * w->gap_size[i];
    if (inside && who) {
      const lag_constraint *of = constraint_of(s, i);
      return lag_fail(s, LAG_EINVAL, "%s is inside the contact %s: its gap is %.3g%s%s", who, of->name, w->gap[i],
                      of->unit[0] ? " " : "", of->unit);
    }
    if (c->is_tangent) continue;
    if (c->impact == event || c->release == event || w->was_closed[i] || w->gap[i] <= lag_no_gap * w->gap_size[i])
      w->of[w->n++] = i;
  }
  w->rows = w->n;
  for (int a = 0; a < w->n; a++) {
    int tangent = lag_tangent_of(m, w->of[a]);
    w->at[a] = tangent < 0 ? -1 : w->rows;
    if (tangent >= 0) w->of[w->rows++] = tangent;
    if (tangent >= 0 && lag_second_of(m, tangent) >= 0) w->of[w->rows++] = tangent + 1;
  }
  for (int i = 0; i < m->nguides; i++) w->of[w->rows++] = m->guides[i].tangent;
  return LAG_OK;
}

/* Differences by a parameter may lead a little beyond 0 or 1. */
static int check_restitution(lag_sim *s, int i, double e) {
  if (s->parameters_shifted) return LAG_OK;
  if (!isnan(e) && !(e >= -no_speed && e <= 1 + no_speed))
    return lag_fail(s, LAG_EINVAL, "the contact %s has a restitution of %.3g, which must be between 0 and 1",
                    constraint_of(s, i)->name, e);
  if (s->run->dir < 0 && e < 1 - no_speed) {
    return lag_fail(s, LAG_EINVAL,
                    "at t = %.9g s the contact %s, of restitution %.3g, ends the run backwards in time: an impact that "
                    "loses energy "
                    "cannot be reversed",
                    s->run->t, constraint_of(s, i)->name, e);
  }
  return LAG_OK;
}

/* law: of the model's contact_laws. Signs of coefficients: lag_check_parameters, lag_check_moving_sizes. */
static int check_friction(lag_sim *s, int i, const double *law) {
  const lag_model *m = s->scene->model;
  int guide = lag_guide_of(m, i);
  const char *name = guide < 0 ? constraint_of(s, i - 1)->name : constraint_of(s, i)->name;
  const char *what = guide < 0 ? "contact" : "friction";
  double mu = law[3 * i], hold = guide < 0 ? law[3 * i - 3] : law[3 * m->ncontacts + 4 * guide];
  if (hold >= mu) return LAG_OK;
  return lag_fail(s, LAG_EINVAL,
                  "the %s %s has a static friction of %.3g, which must be at least its friction while it slips, %.3g",
                  what, name, hold, mu);
}

/* ---- impacts */

/* Marks event k as due now, unless it has fired already. */
void lag_mark_due(lag_sim *s, int k) { s->root[k] = s->root[k] == HUGE_VAL ? HUGE_VAL : s->run->limit; }

/* Scratch of an event, [n] each: rates before, restitutions, accelerations of gaps; contacts that rest after the
 * impact, that are struck, that rested before; the state and the rates before. */
typedef struct Impacts {
  double *before, *e, *acceleration;
  unsigned char *ends, *struck, *rested;
  double *y, *rate;
} Impacts;

/* Impacts of the gaps that close, without restitution for those in ends[n]; before[n] := their rates before it. */
static int apply_impacts(ContactSet *w, const Impacts *x) {
  const unsigned char *ends = x->ends;
  double *before = x->before, *e = x->e;
  unsigned char *struck = x->struck;
  lag_sim *s = w->sim;
  const lag_model *m = s->scene->model;
  int any = 0;
  for (int a = 0; a < w->n; a++) {
    int i = w->of[a];
    before[a] = s->run->dir * w->rate[i];
    struck[a] = before[a] < -lag_no_gap * w->rate_size[i];
    any |= struck[a];
    e[a] = 0;
    if (struck[a] || w->rows > w->n) { /* one impact may lead to others */
      e[a] = restitution(w, i);
      int rc = check_restitution(s, i, e[a]);
      if (rc) return rc;
      e[a] = isnan(e[a]) || ends[a] ? 0 : e[a];
      if (struck[a]) lag_mark_due(s, m->contacts[i].impact);
    }
  }
  return !any ? LAG_OK : w->rows > w->n ? lag_contacts_strike(w, e) : lag_contacts_impact(w, e, struck);
}

/* ---- resting contacts */

/* w->closed, acceleration[n] of the contacts that take part. */
static int find_closed(ContactSet *w, int event, double *acceleration) {
  return w->rows > w->n ? lag_contacts_choose_modes(w, event, acceleration) : lag_contacts_at_rest(w, acceleration);
}

/* Finds the contacts that rest, and among them those that are pressed and stay closed. ends[n]: those which rest
 * after this impact, more of them on return. */
static int rest(ContactSet *w, int event, unsigned char *ends, const double *before, double *acceleration) {
  double dir = w->sim->run->dir;
  for (int a = 0; a < w->n; a++) {
    double after = dir * w->rate[w->of[a]];
    w->active[a] = after <= lag_no_gap * w->rate_size[w->of[a]] || after <= no_speed * fabs(before[a]) || ends[a];
  }
  int rc = find_closed(w, event, acceleration), more = 0;
  for (int a = 0; a < w->n && rc == 0; a++) { /* its flight would stay within rounding */
    double after = w->rate[w->of[a]], back = -2 * acceleration[a] * lag_no_flight * w->gap_size[w->of[a]];
    if (!w->active[a] && after * after <= back) {
      w->active[a] = ends[a] = 1;
      more = 1;
    }
  }
  return rc == 0 && more ? find_closed(w, event, acceleration) : rc;
}

/* Closes the contacts that are pressed, and projects away the speed and gap that remain. */
static int close_gaps(ContactSet *w) {
  lag_sim *s = w->sim;
  for (int a = 0; a < w->n; a++)
    if (w->was_closed[w->of[a]] && !w->closed[a]) lag_mark_due(s, s->scene->model->contacts[w->of[a]].release);
  lag_contacts_close(w, w->closed);
  if (w->rows > w->n) lag_contacts_set_friction(w);
  if (lag_project(&s->pb, s->run->t, w->y, NULL) == LAG_OK) return LAG_OK;
  return lag_fail(s, LAG_EMODEL, "at t = %.9g s contacts cannot stay closed: %s", s->run->t,
                  s->pb.detail ? s->pb.detail : "");
}

/* The impacts, and what rests after them. Friction at impacts that are left out would be missing, whose sum is that
 * of one without restitution: where the flight after an impact would stay within rounding, the impact is replaced by
 * that one. */
static int strike_and_rest(ContactSet *w, int event, const Impacts *x) {
  const size_t size = (size_t)w->sim->pb.n * sizeof *x->y,
               rates = (size_t)w->sim->scene->model->ncontacts * sizeof *x->rate;
  memcpy(x->y, w->y, size);
  memcpy(x->rate, w->rate, rates);
  for (int again = 1; again;) {
    int rc = apply_impacts(w, x);
    memcpy(x->rested, x->ends, (size_t)w->n);
    rc = rc ? rc : rest(w, event, x->ends, x->before, x->acceleration);
    if (rc) return rc;
    again = 0;
    for (int a = 0; a < w->n && w->rows > w->n; a++) again |= x->struck[a] && x->ends[a] && !x->rested[a];
    if (!again) break;
    memcpy(w->y, x->y, size);
    memcpy(w->rate, x->rate, rates);
  }
  return LAG_OK;
}

static int resolve_contacts(ContactSet *w, const char *who, int event, int last) {
  int rc = find_touching(w, who, event);
  lag_contact_open(w->sim);
  if (rc || w->rows == 0) return rc;
  size_t n = (size_t)w->n, others = (size_t)w->sim->pb.n + (size_t)w->sim->scene->model->ncontacts;
  double *room = calloc(3 * n + others, sizeof *room), *y = room + 3 * n;
  unsigned char *ends = calloc(3 * n + 1, 1);
  rc = room && ends ? find_responses(w) : lag_fail(w->sim, LAG_ENOMEM, "out of memory");
  for (size_t a = 0; a < n && rc == 0; a++) ends[a] = last && lag_contacts_at(w, (int)a)->impact == event;
  rc = rc ? rc : lag_guides_stop(w, event);
  rc = rc ? rc : strike_and_rest(w, event, &(Impacts){room, room + n, room + 2 * n, ends, ends + n, ends + 2 * n,
                                                     y, y + w->sim->pb.n});
  rc = rc ? rc : close_gaps(w);
  lag_free_all(room, ends);
  return rc;
}

/* ---- contacts that are met by impulses (methods/moreau_contacts.c) */

void lag_contact_mute(const lag_sim *s, double *g) {
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->ncontacts; i++)
    if (!m->contacts[i].conditional) g[m->contacts[i].impact] = g[m->contacts[i].release] = 1;
  for (int i = 0; i < m->nguides; i++)
    if (m->guides[i].turn >= 0) g[m->guides[i].turn] = 1;
}

void lag_contact_show(lag_sim *s) {
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    if (c->conditional || lag_guide_of(m, i) >= 0) continue; /* forces, not impulses */
    s->pb.u[c->input] = !c->is_tangent && s->pb.contact_impulse[i] > 0;
    if (c->is_tangent) s->pb.u[c->force] = s->pb.contact_impulse[i] / s->pb.contacts->length;
  }
}

/* Refuses a state set by `who` that is deeper inside a contact than this run was before. */
static int check_depth(ContactSet *w, const char *who) {
  for (int i = 0; i < w->sim->scene->model->ncontacts; i++) w->gap[i] += w->sim->pb.contacts->depth;
  return who ? find_touching(w, who, -1) : LAG_OK;
}

int lag_contact_resolve(lag_sim *s, double *y, const char *who, int event, int ends) {
  ContactSet w;
  if (s->scene->model->ncontacts == 0) return LAG_OK;
  int rc = evaluate_contacts(s, y, &w);
  if (s->pb.contacts) {
    rc = rc ? rc : check_depth(&w, who);
    lag_contact_open(s);
    free_contacts(&w);
    return rc;
  }
  rc = rc ? rc : resolve_contacts(&w, who, event, ends);
  free_contacts(&w);
  return rc;
}

void lag_contact_show_start(lag_sim *s, const double *y) {
  ContactSet w;
  double *after = calloc((size_t)s->pb.n, sizeof *after);
  if (!after) return;
  lag_contact_stats *stats = s->pb.contacts;
  memcpy(after, y, (size_t)s->pb.n * sizeof *after);
  s->pb.contacts = NULL; /* their events tell the forces */
  int rc = evaluate_contacts(s, after, &w);
  rc = rc ? rc : resolve_contacts(&w, NULL, -1, 0);
  s->pb.contacts = stats;
  if (rc) lag_contact_open(s);
  free_contacts(&w);
  free(after);
}

/* Checks that every coefficient of restitution is between 0 and 1. */
static int check_all(lag_sim *s) {
  ContactSet w;
  int rc = evaluate_contacts(s, s->now, &w);
  for (int i = 0; i < s->scene->model->ncontacts && rc == 0; i++) {
    if (s->scene->model->contacts[i].is_tangent) {
      if (lag_second_of(s->scene->model, i - 1) >= 0) continue;
      rc = check_friction(s, i, w.law);
      continue;
    }
    double e = s->scene->model->contacts[i].conditional ? NAN : restitution(&w, i);
    if (!(e < 0 || e > 1)) continue;
    /* of an impact's speed, not of any */
    if (isfinite(e) && fabs(restitution_at(&w, i, 2 * (w.rate_size[i] > 0 ? w.rate_size[i] : 1)) - e) > 1e-6) continue;
    rc = isfinite(e) ? check_restitution(s, i, s->run->dir < 0 ? fmax(e, 1) : e) : LAG_OK;
  }
  free_contacts(&w);
  lag_contact_open(s);
  return rc;
}

int lag_contact_begin(lag_sim *s) {
  int rc = LAG_OK;
  if (s->pb.contacts && lag_has_gaps(s->scene->model) && s->run->dir < 0)
    return lag_fail(s, LAG_EINVAL, "%s does not follow contacts backwards in time", s->method->name);
  if (s->scene->model->contact_laws && s->run->dir < 0)
    return lag_fail(
        s, LAG_EINVAL,
        "contacts with friction are not followed backwards in time: many motions come to rest in the same place");
  if (s->scene->model->ncontacts > 0) {
    lag_contact_open(s);
    rc = check_all(s);
    rc = rc ? rc : lag_settle_constraints(s, s->now, "the start", -1, 0, 0, NULL);
  }
  memcpy(s->y, s->now, (size_t)s->pb.n * sizeof(double));
  return rc;
}
