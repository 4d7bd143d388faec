/* Friction of contacts. Enters: a state between events; leaves: in pb->u the force of each contact that slips, mu
 * times the force that presses, solved together with it. At events: the contacts that touch; leaves: the state after
 * their impacts, and which of them stay closed, stick and slip. Holds: forces are found at each state, so steps keep
 * their order; input `force` of a tangent is held at the side to which its contact slips, 1 or -1, at 0 where it
 * sticks by a force that is not unique, or NaN: it sticks or is open. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "contacts/contact_set.h"
#include "core/rhs.h"
#include "contacts/contact_modes.h"
#include "numeric/dense.h"
#include "contacts/planar_impact.h"

/* ---- forces while contacts slip */

/* A tangent's contact is the one before it. law: of pb->model->contact_laws. */
static double largest_force(const double *law, int tangent) { return law[3 * tangent] * law[3 * (tangent - 1) + 2]; }

static int laws_at(lag_problem *pb, double t, const double *y, double *law) {
  const lag_model *m = pb->model;
  pb->rhs_calls++;
  return m->contact_laws(m, t, y, y + m->nq, y + 2 * m->nq, pb->p, pb->u, law, pb->work);
}

/* The side to which tangent i slips; 0: it sticks by a force that is not unique; NaN: it sticks or is open, or is no
 * tangent. */
static double side_of(const lag_problem *pb, int i) {
  return pb->model->contacts[i].is_tangent ? pb->hold[pb->model->contacts[i].force] : NAN;
}

/* left[n] := force + side * largest force of the contacts of[n], which is 0 for the forces sought. *size := the
 * largest term. */
static int imbalance(lag_problem *pb, double t, const double *y, const int *of, int n, double *law, double *left,
                     double *size) {
  int rc = laws_at(pb, t, y, law);
  for (int k = 0; k < n && rc == 0; k++) {
    int input = pb->model->contacts[of[k]].force;
    double most = pb->hold[input] * largest_force(law, of[k]);
    left[k] = pb->u[input] + most;
    *size = fmax(*size, fabs(most));
  }
  return rc;
}

/* Finds the forces of contacts that slip. */
static int find_friction(lag_problem *pb, double t, const double *y) {
  enum { ROUNDS = 4 };
  const double enough = 16 * DBL_EPSILON;
  const lag_model *m = pb->model;
  int of[LAG_MOST_TOUCHES], n = 0, rc; /* no more are closed together */
  for (int i = 0; i < m->ncontacts && n < LAG_MOST_TOUCHES; i++)
    if (fabs(side_of(pb, i)) > 0) of[n++] = i;
  if (!n) return 0;
  double *law = pb->rub, *left = law + 3 * m->ncontacts, *x = left + n, *B = x + n, *A = B + n * n, size = 0;
  for (int k = 0; k < n; k++) pb->u[m->contacts[of[k]].force] = 0;
  if ((rc = imbalance(pb, t, y, of, n, law, left, &size)) != 0) return rc;
  double unit = size > 0 ? size : 1;
  for (int j = 0; j < n; j++) { /* the equations are linear */
    double *force = &pb->u[m->contacts[of[j]].force];
    *force = unit;
    if ((rc = imbalance(pb, t, y, of, n, law, x, &size)) != 0) return rc;
    *force = 0;
    for (int k = 0; k < n; k++) B[k * n + j] = (x[k] - left[k]) / unit;
  }
  for (int round = 0; round < ROUNDS; round++) {
    for (int k = 0; k < n * n; k++) A[k] = B[k];
    for (int k = 0; k < n; k++) x[k] = -left[k];
    if (lag_solve_dense((size_t)n, 1, A, x)) return LAG_ERETRY;
    for (int k = 0; k < n; k++) pb->u[m->contacts[of[k]].force] += x[k];
    if ((rc = imbalance(pb, t, y, of, n, law, left, &size)) != 0) return rc;
    double most = 0;
    for (int k = 0; k < n; k++) most = fmax(most, fabs(left[k]));
    if (most <= enough * size) break;
  }
  return 0;
}

static int is_closed(const lag_problem *pb, int i) { return pb->hold[pb->model->contacts[i].input] > 0.5; }

/* of[n] := the closed contacts, with rows as in lag_contact_modes; at[rows] := their numbers in the model. Returns
 * the number of rows. */
static int list_closed(const lag_problem *pb, const double *law, lag_touch *of, int *at, int *n) {
  const lag_model *m = pb->model;
  *n = 0;
  for (int i = 0; i < m->ncontacts && *n < LAG_MOST_TOUCHES; i++) {
    if (m->contacts[i].conditional || m->contacts[i].is_tangent || !is_closed(pb, i)) continue;
    at[*n] = i;
    of[(*n)++] = (lag_touch){.tangent = -1, .mode = LAG_CONTACT_SLIPS};
  }
  int rows = *n;
  for (int k = 0; k < *n; k++) {
    int tangent = at[k] + 1;
    if (tangent >= m->ncontacts || !m->contacts[tangent].is_tangent || !is_closed(pb, tangent)) continue;
    of[k] = (lag_touch){.mu = law[3 * tangent], .hold = law[3 * at[k]], .tangent = rows, .mode = LAG_CONTACT_STICKS};
    at[rows++] = tangent;
  }
  return rows;
}

/* x[rows] := forces of the contacts at[rows]. */
static int forces_at(lag_problem *pb, double t, const double *y, int rows, const int *at, double *x) {
  int rc = find_friction(pb, t, y);
  rc = rc ? rc : laws_at(pb, t, y, pb->rub);
  for (int k = 0; k < rows && rc == 0; k++) {
    const lag_contact *c = &pb->model->contacts[at[k]];
    x[k] = pb->rub[3 * at[k] + 2] + (c->is_tangent ? pb->u[c->force] : 0);
  }
  return rc;
}

/* Chooses forces within Coulomb's cones for contacts that stick by forces that are not unique: inputs take the part
 * that the least multipliers lack. */
static int share_forces(lag_problem *pb, double t, const double *y) {
  const double none = 1e-9; /* rounding of a part of a force */
  lag_touch of[LAG_MOST_TOUCHES];
  int at[2 * LAG_MOST_TOUCHES], row[LAG_MOST_TOUCHES], n, shared = 0, wedged, rc = laws_at(pb, t, y, pb->rub);
  double x[2 * LAG_MOST_TOUCHES], D[2 * LAG_MOST_TOUCHES * LAG_MOST_TOUCHES], c[LAG_MOST_TOUCHES], size = 0;
  int rows = list_closed(pb, pb->rub, of, at, &n);
  rc = rc ? rc : forces_at(pb, t, y, rows, at, x);
  for (int k = 0; k < rows && rc == 0; k++) size = fmax(size, fabs(x[k]));
  double unit = size > 0 ? size : 1;
  for (int k = n; k < rows && rc == 0; k++) {
    if (side_of(pb, at[k]) != 0) continue;
    double *force = &pb->u[pb->model->contacts[at[k]].force], *d = D + shared * rows, most = 0;
    *force = unit;
    rc = forces_at(pb, t, y, rows, at, d);
    *force = 0;
    for (int i = 0; i < rows; i++) {
      d[i] = (d[i] - x[i]) / unit;
      d[i] = fabs(d[i]) > none ? d[i] : 0;
      most = fmax(most, fabs(d[i]));
    }
    if (most > 0) row[shared++] = k;
  }
  if (rc) return rc;
  lag_cone_forces(n, of, rows, x, shared, D, c, &wedged);
  for (int j = 0; j < shared; j++) pb->u[pb->model->contacts[at[row[j]]].force] = c[j];
  return find_friction(pb, t, y);
}

int lag_contact_friction_forces(lag_problem *pb, double t, const double *y) {
  for (int i = 0; i < pb->model->ncontacts; i++)
    if (side_of(pb, i) == 0) return share_forces(pb, t, y);
  return find_friction(pb, t, y);
}

int lag_contact_laws(lag_sim *s, const double *y, double *law) {
  int rc = lag_inputs(&s->pb, s->run->t);
  rc = rc ? rc : laws_at(&s->pb, s->run->t, y, law);
  return rc ? lag_fail(s, LAG_EMODEL, "the contacts have no finite values at t = %s s", LAG_TEXT(s->run->t)) : LAG_OK;
}

void lag_tangent_events(const lag_sim *s, double *g) {
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    if (!c->is_tangent) continue;
    g[c->impact] = fabs(s->hold[c->force]) > 0 ? s->hold[c->force] * g[c->impact] : 1;
    g[c->release] = lag_contact_is_closed(s, c) ? g[c->release] : 1;
  }
}

/* ---- impacts */

/* Reports that the law of the tangent at row t brings energy in, or has no impulse. */
static int fail_impact(ContactSet *w, int a, int t, double gain) {
  static const char *const laws[] = {
      [LAG_IMPACT_STRONGE] = "Stronge", [LAG_IMPACT_POISSON] = "Poisson", [LAG_IMPACT_NEWTON] = "Newton"};
  lag_sim *s = w->sim;
  const lag_contact *c = lag_contacts_at(w, t < 0 ? a : t);
  double at = s->run->t;
  const char *name = lag_contacts_name(w, a);
  if (t >= 0 && w->law[3 * w->of[t] + 1] > 0)
    return lag_fail(s, LAG_EMODEL,
                    "at t = %.9g s the impact of the contact %s would add energy: its coefficients do not go together "
                    "there; leave `tangential` out, "
                    "and Stronge's law holds, which never does",
                    at, name);
  if (isnan(gain))
    return lag_fail(s, LAG_EMODEL, "at t = %.9g s the impact of the contact %s has no finite impulse", at, name);
  return lag_fail(s, LAG_EMODEL,
                  "at t = %.9g s the impact of the contact %s would add %.6g J of kinetic energy by %s's law, as "
                  "friction turns the slip in it; `law = stronge` never adds any",
                  at, name, gain, laws[c->law]);
}

/* The impact of contact a, with friction. */
static int strike(ContactSet *w, int a, double e) {
  lag_sim *s = w->sim;
  int rows = w->rows, t = w->at[a], nq = s->pb.nq;
  double mu = t < 0 ? 0 : w->law[3 * w->of[t]], back = t < 0 ? 0 : w->law[3 * w->of[t] + 1], P[2];
  double W[4] = {w->response[a * rows + a], 0, 0, 1}, v[2] = {w->rate[w->of[a]], t < 0 ? 0 : w->rate[w->of[t]]};
  if (t >= 0) {
    W[1] = W[2] = w->response[a * rows + t];
    W[3] = w->response[t * rows + t];
  }
  double gain = lag_planar_impact(W, v, t < 0 ? LAG_IMPACT_STRONGE : lag_contacts_at(w, t)->law, mu, e, back, P);
  if (!(gain == 0)) return fail_impact(w, a, t, gain);
  for (int k = 0; k < (t < 0 ? 1 : 2); k++) {
    double to = lag_contacts_response(w, w->of[k ? t : a]);
    for (int i = 0; i < nq; i++) w->y[nq + i] += P[k] * to * w->d[i];
  }
  for (int k = w->n; k < rows; k++) w->was_closed[w->of[k]] = 0; /* what stuck may slip */
  return lag_not_finite(nq, w->y + nq) >= 0 || lag_contacts_rates(w, w->y, w->rate)
             ? lag_contacts_no_values(w, w->of[a])
             : LAG_OK;
}

int lag_contacts_strike(ContactSet *w, const double *e) {
  const int most = 1000;
  for (int turn = 0; turn < most; turn++) {
    int first = -1;
    double fastest = 0;
    for (int a = 0; a < w->n; a++) {
      double rate = w->sim->run->dir * w->rate[w->of[a]];
      if (rate >= -lag_no_gap * w->rate_size[w->of[a]] || rate >= fastest) continue;
      fastest = rate;
      first = a;
    }
    if (first < 0) return LAG_OK;
    int rc = strike(w, first, e[first]);
    if (rc) return rc;
  }
  return lag_fail(w->sim, LAG_EZENO,
                  "at t = %.9g s the contacts %s and others strike each other more than %d times at once; take "
                  "--method \"moreau(step=1e-3)\", which has one impulse a step",
                  w->sim->run->t, lag_contacts_name(w, 0), most);
}

/* ---- contacts that rest */

/* The state after dt of the flow along the surfaces without friction, in two equal steps. */
static int flow_on(ContactSet *w, double dt) {
  lag_sim *s = w->sim;
  lag_contacts_close_only(w, 0, -1);
  for (int a = 0; a < w->n; a++) lag_contact_set_closed(s, w->of[a], w->active[a]);
  memcpy(w->test, w->y, (size_t)s->pb.n * sizeof *w->test);
  for (int half = 0; half < 2; half++) {
    if (lag_rhs(&s->pb, s->run->t, w->test, s->ya)) return LAG_ERETRY;
    for (int i = 0; i < s->pb.n; i++) w->test[i] += dt / 2 * s->ya[i];
  }
  return LAG_OK;
}

/* Acceleration of the slip at row a, which no force moves, since other constraints imply it, as at a dead centre:
 * its mean over the shortest time that shows a side; 0: none does. */
static double implied_acceleration(ContactSet *w, int a) {
  lag_sim *s = w->sim;
  const double first = 0x1p-30, last = 0x1p-8, span = s->pb.span > 0 ? s->pb.span : 1; /* of the run */
  double calls = s->pb.rhs_calls, slip = 0, part = first;
  int i = w->of[a];
  for (; part <= last && fabs(slip) <= lag_no_gap * w->rate_size[i]; part *= 32)
    slip = flow_on(w, part * span) || lag_contacts_rates(w, w->test, w->ahead) ? 0 : w->ahead[i] - w->rate[i];
  s->pb.rhs_calls = calls;
  return fabs(slip) <= lag_no_gap * w->rate_size[i] ? 0 : slip / (part / 32 * span);
}

/* law[3 contacts] at the state; pull[rows] := accelerations with all contacts open. */
static int find_free_accelerations(ContactSet *w) {
  for (int a = 0; a < w->rows; a++) {
    if (a >= w->n && !(w->response[a * w->rows + a] > 0)) {
      w->rhs[a] = implied_acceleration(w, a);
      continue;
    }
    lag_contacts_close_only(w, 0, w->of[a]);
    int rc = lag_contact_laws(w->sim, w->y, w->law);
    if (rc) return rc;
    w->rhs[a] = -w->response[a * w->rows + a] * w->law[3 * w->of[a] + 2];
  }
  return LAG_OK;
}

/* Reports that Coulomb's law has no motion, or several. */
static int fail_paradox(ContactSet *w, const lag_touch *of, int n, int motions) {
  int worst = 0;
  double least = HUGE_VAL;
  for (int k = 0; k < n; k++) { /* the contact that comes closest to jamming */
    int a = of[k].contact, t = w->at[a];
    double limit = t < 0 ? HUGE_VAL : w->response[a * w->rows + a] / fabs(w->response[a * w->rows + t]);
    if (limit >= least) continue;
    least = limit;
    worst = a;
  }
  return lag_fail(w->sim, LAG_ESTALL,
                  "at t = %.9g s %s at the contact %s, of friction %.6g: %s (Painleve's paradox, from a friction of "
                  "%.6g on in this position)",
                  w->sim->run->t, motions ? "several motions follow" : "no motion follows", lag_contacts_name(w, worst),
                  w->law[3 * w->of[w->at[worst] < 0 ? 0 : w->at[worst]]],
                  motions ? "it may slip on or lift off"
                          : "friction would press it against the surface more than the surface presses back",
                  least);
}

/* of[*n], row[rows] := the contacts that take part and their rows in w, gaps first. Returns the number of rows; -1:
 * there are too many. */
static int list_touches(const ContactSet *w, int event, lag_touch *of, int *row, int *n) {
  const lag_model *m = w->sim->scene->model;
  *n = 0;
  for (int a = 0; a < w->n; a++) {
    if (!w->active[a]) continue;
    if (*n == LAG_MOST_TOUCHES) return -1;
    of[*n] = (lag_touch){.contact = a, .tangent = -1};
    row[(*n)++] = a;
  }
  int rows = *n;
  for (int k = 0; k < *n; k++) {
    int t = w->at[row[k]];
    if (t < 0) continue;
    const lag_contact *c = &m->contacts[w->of[t]];
    double slip = w->rate[w->of[t]];
    of[k].mu = w->law[3 * w->of[t]];
    of[k].hold = w->law[3 * w->of[row[k]]];
    of[k].slip = fabs(slip) <= lag_no_gap * w->rate_size[w->of[t]] || c->impact == event || w->was_closed[w->of[t]] ? 0
                 : slip > 0                                                                                         ? 1
                            : -1;
    of[k].cannot_stick = c->release == event;
    of[k].tangent = rows;
    row[rows++] = t;
  }
  return rows;
}

int lag_contacts_choose_modes(ContactSet *w, int event, double *acceleration) {
  lag_sim *s = w->sim;
  lag_touch of[LAG_MOST_TOUCHES];
  int row[2 * LAG_MOST_TOUCHES], n, rows = list_touches(w, event, of, row, &n);
  for (int a = 0; a < w->n; a++) w->closed[a] = 0;
  if (rows < 0)
    return lag_fail(s, LAG_EMODEL,
                    "at t = %.9g s more than %d contacts touch at once, some of them with friction, which only moreau "
                    "follows: take --method \"moreau(step=1e-3)\"",
                    s->run->t, LAG_MOST_TOUCHES);
  int rc = find_free_accelerations(w);
  double W[4 * LAG_MOST_TOUCHES * LAG_MOST_TOUCHES], pull[2 * LAG_MOST_TOUCHES], x[2 * LAG_MOST_TOUCHES],
      room[2 * LAG_MOST_TOUCHES * (2 * LAG_MOST_TOUCHES + 5)];
  for (int i = 0; i < rows && rc == 0; i++) {
    pull[i] = w->rhs[row[i]];
    for (int j = 0; j < rows; j++) W[i * rows + j] = w->response[row[i] * w->rows + row[j]];
  }
  int motions = rc ? 0 : n == 0 ? 1 : lag_contact_modes(n, of, rows, W, pull, x, room);
  if (rc || motions != 1) return rc ? rc : fail_paradox(w, of, n, motions);
  for (int a = 0; a < w->n; a++) {
    acceleration[a] = w->rhs[a];
    for (int k = 0; k < rows; k++) acceleration[a] += w->response[a * w->rows + row[k]] * x[k];
  }
  for (int k = 0; k < n; k++) {
    w->closed[row[k]] = of[k].mode != LAG_CONTACT_OPEN;
    w->side[row[k]] = of[k].mode == LAG_CONTACT_SLIPS ? of[k].to : of[k].shared ? 0 : (double)NAN;
  }
  lag_contacts_close_only(w, 0, -1);
  return LAG_OK;
}

void lag_contacts_set_friction(ContactSet *w) {
  lag_sim *s = w->sim;
  for (int a = 0; a < w->n; a++) {
    if (w->at[a] < 0 || !w->closed[a]) continue;
    int i = w->of[w->at[a]], slips = fabs(w->side[a]) > 0;
    if (w->was_closed[i] && slips) lag_mark_due(s, s->scene->model->contacts[i].release);
    lag_contact_set_closed(s, i, !slips);
    s->hold[s->scene->model->contacts[i].force] = w->side[a];
  }
}
