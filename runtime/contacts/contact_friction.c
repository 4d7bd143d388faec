/* Friction of contacts. Enters: a state between events; leaves: in pb->u the force of each contact that slips, mu
 * times the force that presses, solved together with it. At events: the contacts that touch; leaves: the state after
 * their impacts, and which of them stay closed, stick and slip. Holds: forces are found at each state, so steps keep
 * their order; input `force` of a tangent is held at the side to which its contact slips, 1 or -1, at 0 where it
 * sticks by a force that is not unique, or NaN: it sticks or is open. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "contacts/contact_set.h"
#include "core/rhs.h"
#include "contacts/contact_modes.h"
#include "contacts/planar_impact.h"

_Static_assert((int)LAG_MOST_GUIDES <= (int)LAG_MOST_TOUCHES, "guides alone are never too many");

/* ---- forces while contacts slip */

int lag_contact_laws_at(lag_problem *pb, double t, const double *y, double *law) {
  const lag_model *m = pb->model;
  pb->rhs_calls++;
  return m->contact_laws(m, t, y, y + m->nq, y + 2 * m->nq, pb->p, pb->u, law, pb->work);
}

/* The side to which tangent i slips; 0: it sticks by a force that is not unique; NaN: it sticks or is open, or is no
 * tangent. In space a part of the direction of slipping. */
static double side_of(const lag_problem *pb, int i) {
  return pb->model->contacts[i].is_tangent ? pb->hold[pb->model->contacts[i].force] : NAN;
}

/* The friction of tangents that slip, of contacts and guides: kernels/slipping_forces.h for a lag_problem. */
typedef struct lag_slipping lag_slipping;
typedef struct Slipping {
  lag_problem *pb;
  double t;
  const double *y;
} Slipping;

static int pressing(const Slipping *s, lag_slipping *w);
static int fail_slipping(const Slipping *s, const lag_slipping *w, int k, double gain);

#define LAG_MODEL const Slipping *s
#define LAG_THE_MODEL s
#define LAG_PRESSING(w) pressing(s, w)
#define LAG_SLIPPING_FAILS(w, k, by) fail_slipping(s, w, k, by)
#include "kernels/slipping_forces.h"

/* mu, N: in the laws, of a contact beside its gap. */
static int pressing(const Slipping *s, lag_slipping *w) {
  const lag_problem *pb = s->pb;
  const lag_model *m = pb->model;
  for (int k = 0; k < w->n; k++) pb->u[m->contacts[(int)w->of[k]].force] = w->x[k];
  int rc = lag_contact_laws_at(s->pb, s->t, s->y, pb->rub);
  for (int k = 0; k < w->n && rc == 0; k++) {
    int i = (int)w->of[k], guide = lag_guide_of(m, i);
    w->mu[k] = pb->rub[3 * i];
    for (int c = 0; c < 3; c++)
      w->N[3 * k + c] = guide >= 0 ? lag_guide_law(m, pb->rub, guide)[1 + c] + pb->guide_load[3 * guide + c]
                        : c == 0   ? pb->rub[3 * lag_gap_of(m, i) + 2]
                                   : 0;
  }
  return rc;
}

static int fail_slipping(const Slipping *s, const lag_slipping *w, int k, double gain) {
  lag_problem *pb = s->pb;
  const lag_model *m = pb->model;
  if (k < 0) return LAG_ERETRY;
  snprintf(pb->words, sizeof pb->words,
           "the friction %s, of %.6g, presses its guide more than the force that it follows: no motion or several "
           "(Painleve's paradox, from a friction of %.6g on)",
           m->constraints->of[m->contacts[(int)w->of[k]].constraint].name, w->mu[k], w->mu[k] / gain);
  pb->detail = pb->words;
  return LAG_ERETRY;
}

static int is_closed(const lag_problem *pb, int i) { return pb->hold[pb->model->contacts[i].input] > 0.5; }

/* Whether friction holds a motion, in which others that slip may have none. */
static int some_sticks(const lag_problem *pb) {
  const lag_model *m = pb->model;
  for (int i = 0; i < m->ncontacts; i++)
    if (m->contacts[i].is_tangent && is_closed(pb, i)) return 1;
  return 0;
}

/* Frictions that act together: those of all guides, and of so many contacts. */
static int most_slipping(const lag_model *m) { return m->nguides + LAG_MOST_TOUCHES; }

static int law_size(const lag_model *m) { return 3 * m->ncontacts + 4 * m->nguides; }

/* Time, state, parameters and inputs. */
static int place_size(const lag_model *m) {
  return m->nguides ? 1 + 2 * m->nq + m->nz + m->np + m->nderived + m->nu : 0;
}

size_t lag_contact_law_size(const lag_model *m) {
  int slopes = place_size(m) + LAG_SLOPES_ROOM(m->nguides, place_size(m));
  return m->contact_laws ? (size_t)(law_size(m) + 1 + LAG_SLIPPING_ROOM(most_slipping(m)) + 2 * m->constraints->n +
                                    slopes + m->nguides)
                         : 0;
}

/* [guides] side to which each of one direction is pressed, for derivatives, which no corner is near then; 0: any. */
static double *pressed_sides(const lag_problem *pb) {
  return pb->rub + lag_contact_law_size(pb->model) - pb->model->nguides;
}

void lag_guides_hold_sides(lag_problem *pb, int held) {
  const lag_model *m = pb->model;
  for (int g = 0; g < m->nguides; g++) {
    double N = lag_guide_law(m, pb->rub, g)[1] + pb->guide_load[3 * g];
    pressed_sides(pb)[g] = held && m->guides[g].parts == 1 ? (N > 0) - (N < 0) : 0;
  }
}

/* place[place_size], on which slopes of the forces of guides depend. */
static void find_place(const lag_problem *pb, double t, const double *y, double *place) {
  const lag_model *m = pb->model;
  size_t np = (size_t)(m->np + m->nderived);
  double *p = place + 1 + pb->n, *u = p + np;
  place[0] = t;
  memcpy(place + 1, y, (size_t)pb->n * sizeof *y);
  memcpy(p, pb->p, np * sizeof *y);
  memcpy(u, pb->u, (size_t)m->nu * sizeof *y);
  for (int g = 0; g < m->nguides; g++) u[m->contacts[m->guides[g].tangent].force] = 0;
}

/* Finds the forces of contacts and guides that slip; the largest of the run stands behind the laws in pb->rub. */
static int find_friction(lag_problem *pb, double t, const double *y) {
  const lag_model *m = pb->model;
  const Slipping s = {pb, t, y};
  double *size = pb->rub + law_size(m);
  double *residuals = size + 1 + LAG_SLIPPING_ROOM(most_slipping(m)), *rates = residuals + m->constraints->n;
  double *place = rates + m->constraints->n, *kept = place + place_size(m);
  int contacts = 0, rc = lag_slip_velocities(pb, t, y, residuals, rates);
  lag_slipping w = {.guides = m->nguides, .alone = !some_sticks(pb), .epsilon = DBL_EPSILON, .size = *size};
  lag_slipping_place(&w, most_slipping(m), size + 1);
  for (int i = 0; i < m->ncontacts; i++) {
    int guide = lag_guide_of(m, i), in_space = lag_slips_in_space(pb, i);
    int acts = guide < 0 || is_closed(pb, i) ? fabs(side_of(pb, i)) > 0 : !isnan(side_of(pb, i));
    if (!in_space && (!acts || lag_slips_in_space(pb, i - 1))) continue;
    if (guide < 0 && (contacts += 1 + in_space) > LAG_MOST_TOUCHES) continue;
    if (in_space) lag_slip_direction(pb, rates, i, w.mode + w.n);
    else w.mode[w.n] = side_of(pb, i);
    double to = guide < 0 ? 0 : pressed_sides(pb)[guide];
    w.mode[w.n] *= to != 0 ? to : 1;
    for (int k = 0; k <= in_space; k++) {
      w.of[w.n] = i + k;
      w.parts[w.n++] = guide < 0 || to != 0 ? 0 : m->guides[guide].parts;
    }
  }
  int all = w.n > 0 && w.n == m->nguides && contacts == 0; /* in a step of moreau: of one state for many modes */
  if (all) find_place(pb, t, y, place);
  if (all) lag_slipping_recall(&w, place, place_size(m), kept);
  rc = rc || w.n == 0 ? rc : lag_slipping_solve(&s, &w);
  if (all) lag_slipping_keep(&w, place_size(m), kept);
  *size = w.size;
  return rc;
}

/* Closed contacts and guides that stick: touches of[n] and rows as in lag_contact_modes; at[rows]: their numbers in
 * the model, for the row of a guide that of its tangent. */
typedef struct Closed {
  int n, rows, at[2 * LAG_MOST_TOUCHES];
  lag_touch of[LAG_MOST_TOUCHES];
} Closed;

static void add_closed(Closed *w, int i, lag_touch touch) {
  if (w->n == LAG_MOST_TOUCHES) return;
  w->at[w->n] = i;
  w->of[w->n++] = touch;
}

static Closed list_closed(const lag_problem *pb, const double *law) {
  const lag_model *m = pb->model;
  Closed w = {0};
  for (int i = 0; i < m->ncontacts; i++)
    if (!m->contacts[i].conditional && !m->contacts[i].is_tangent && is_closed(pb, i))
      add_closed(&w, i, (lag_touch){.tangent = -1, .mode = LAG_CONTACT_SLIPS});
  for (int g = 0; g < m->nguides; g++)
    if (is_closed(pb, m->guides[g].tangent))
      add_closed(&w, m->guides[g].tangent, (lag_touch){.hold = lag_guide_law(m, law, g)[0], .guide = 1 + g});
  w.rows = w.n;
  for (int k = 0; k < w.n; k++) {
    lag_touch *of = &w.of[k];
    int tangent = of->guide ? w.at[k] : lag_tangent_of(m, w.at[k]);
    if (tangent < 0 || !is_closed(pb, tangent)) continue;
    of->mu = law[3 * tangent];
    of->hold = of->guide ? of->hold : law[3 * w.at[k]];
    of->tangent = w.rows;
    of->mode = LAG_CONTACT_STICKS;
    w.at[w.rows++] = tangent;
  }
  return w;
}

/* x[rows] := their forces, of a guide along of.toward, which `begins` sets to the direction of its force. */
static int forces_at(lag_problem *pb, double t, const double *y, Closed *w, int begins, double *x) {
  const lag_model *m = pb->model;
  int rc = find_friction(pb, t, y);
  rc = rc ? rc : lag_contact_laws_at(pb, t, y, pb->rub);
  for (int k = 0; k < w->rows && rc == 0; k++) {
    const lag_contact *c = &m->contacts[w->at[k]];
    x[k] = pb->rub[3 * w->at[k] + 2] + (c->is_tangent ? pb->u[c->force] : 0);
    lag_touch *of = k < w->n && w->of[k].guide ? &w->of[k] : NULL;
    const double *N = of ? lag_guide_law(m, pb->rub, of->guide - 1) + 1 : NULL;
    double size = of ? lag_norm(N, 3) : 0;
    for (int i = 0; of && begins && i < 3; i++) of->toward[i] = size > 0 ? N[i] / size : i == 0;
    if (of) x[k] = N[0] * of->toward[0] + N[1] * of->toward[1] + N[2] * of->toward[2];
  }
  return rc;
}

/* Chooses forces within Coulomb's cones for contacts that stick by forces that are not unique: inputs take the part
 * that the least multipliers lack. */
static int share_forces(lag_problem *pb, double t, const double *y) {
  const double none = 1e-9; /* rounding of a part of a force */
  int row[LAG_MOST_TOUCHES], shared = 0, rc = lag_contact_laws_at(pb, t, y, pb->rub);
  double x[2 * LAG_MOST_TOUCHES], D[2 * LAG_MOST_TOUCHES * LAG_MOST_TOUCHES], c[LAG_MOST_TOUCHES + 1], size = 0;
  Closed w = list_closed(pb, pb->rub);
  rc = rc ? rc : forces_at(pb, t, y, &w, 1, x);
  for (int k = 0; k < w.rows && rc == 0; k++) size = fmax(size, fabs(x[k]));
  double unit = size > 0 ? size : 1;
  for (int k = w.n; k < w.rows && rc == 0; k++) {
    if (side_of(pb, w.at[k]) != 0) continue;
    double *force = &pb->u[pb->model->contacts[w.at[k]].force], *d = D + shared * w.rows, most = 0;
    *force = unit;
    rc = forces_at(pb, t, y, &w, 0, d);
    *force = 0;
    for (int i = 0; i < w.rows; i++) {
      d[i] = (d[i] - x[i]) / unit;
      d[i] = fabs(d[i]) > none ? d[i] : 0;
      most = fmax(most, fabs(d[i]));
    }
    if (most > 0) row[shared++] = k;
  }
  if (rc) return rc;
  lag_cone_forces(w.n, w.of, w.rows, x, shared, D, c);
  for (int j = 0; j < shared; j++) pb->u[pb->model->contacts[w.at[row[j]]].force] = c[j];
  return find_friction(pb, t, y);
}

int lag_contact_friction_forces(lag_problem *pb, double t, const double *y) {
  for (int i = 0; i < pb->model->ncontacts; i++)
    if (side_of(pb, i) == 0 && is_closed(pb, i)) return share_forces(pb, t, y);
  return find_friction(pb, t, y);
}

int lag_contact_laws(lag_sim *s, const double *y, double *law) {
  int rc = lag_inputs(&s->pb, s->run->t);
  rc = rc ? rc : lag_contact_laws_at(&s->pb, s->run->t, y, law);
  return rc ? lag_fail(s, LAG_EMODEL, "the contacts have no finite values at t = %s s", LAG_TEXT(s->run->t)) : LAG_OK;
}

double lag_sim_guide_part(lag_sim *s, int k) {
  const lag_model *m = s->scene->model;
  if (!s || k < 0 || k >= m->nguides) return NAN;
  const lag_guide *guide = &m->guides[k];
  const lag_contact *c = &m->contacts[guide->tangent];
  const double *law = s->pb.rub, *own = lag_guide_law(m, law, k);
  if (!lag_contact_is_closed(s, c) || lag_inputs_at(&s->pb, s->run->t, s->now)) return NAN;
  if (lag_contact_laws_at(&s->pb, s->run->t, s->now, s->pb.rub)) return NAN;
  double held = fabs(law[3 * guide->tangent + 2] + s->pb.u[c->force]), most = own[0] * lag_norm(own + 1, guide->parts);
  return held > 0 ? held / most : 0;
}

int lag_tangent_events(lag_sim *s, double t, const double *y, double *g) {
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    if (!c->is_tangent || lag_second_of(m, i) >= 0 || lag_second_of(m, i - 1) >= 0) continue;
    g[c->impact] = fabs(s->hold[c->force]) > 0 ? s->hold[c->force] * g[c->impact] : 1;
    g[c->release] = lag_contact_is_closed(s, c) ? g[c->release] : 1;
  }
  for (int i = 0; i < m->nguides; i++) {
    const lag_guide *guide = &m->guides[i];
    if (guide->turn >= 0 && !(fabs(s->hold[m->contacts[guide->tangent].force]) > 0)) g[guide->turn] = 1;
  }
  int rc = lag_some_stick_in_space(s) ? lag_contact_laws_at(&s->pb, t, y, s->pb.rub) : 0;
  if (rc == 0) lag_space_events(s, s->pb.rub, g);
  return rc;
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
  int rows = w->rows, t = w->at[a], nq = s->pb.nq, n = t < 0 ? 1 : lag_second_of(s->scene->model, w->of[t]) < 0 ? 2 : 3;
  double mu = t < 0 ? 0 : w->law[3 * w->of[t]], back = t < 0 ? 0 : w->law[3 * w->of[t] + 1], P[3];
  int row[3] = {a, t, t + 1}, law = t < 0 ? LAG_IMPACT_STRONGE : lag_contacts_at(w, t)->law;
  double W[9] = {w->response[a * rows + a], 0, 0, 1}, v[3] = {w->rate[w->of[a]]};
  for (int k = 0; k < n * n && n > 1; k++) W[k] = w->response[row[k / n] * rows + row[k % n]];
  for (int k = 1; k < n; k++) v[k] = w->rate[w->of[row[k]]];
  double gain = n < 3 ? lag_planar_impact(W, v, law, mu, e, back, P) : lag_space_impact(W, v, law, mu, e, back, P);
  if (!(gain == 0)) return fail_impact(w, a, t, gain);
  for (int k = 0; k < n; k++) {
    double to = lag_contacts_response(w, w->of[row[k]]);
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

/* Reports that Coulomb's law has no motion, or several; by friction that presses its own contact, or by the search. */
static int fail_paradox(ContactSet *w, const lag_touch *of, int n, int motions) {
  int worst = 0;
  double least = HUGE_VAL;
  for (int k = 0; k < n; k++) { /* the contact that comes closest to jamming */
    int a = of[k].contact, t = of[k].guide ? a : w->at[a];
    double by = t < 0 ? 0 : w->response[a * w->rows + t];
    int relieves = t < 0 || (!of[k].guide && !of[k].second && of[k].slip * by < 0);
    double limit = relieves      ? HUGE_VAL
                   : of[k].guide ? 1 / lag_guide_gain(w, a)
                                 : w->response[a * w->rows + a] / fabs(by);
    if (limit >= least) continue;
    least = limit;
    worst = k;
  }
  if (least > 1e9)
    return lag_fail(w->sim, LAG_ESTALL,
                    "at t = %.9g s %s of the %d contacts and guides that touch, the first of them %s: take moreau, "
                    "which finds their impulses step by step",
                    w->sim->run->t, motions ? "several motions follow" : "no motion is found", n,
                    lag_contacts_name(w, of[0].contact));
  return lag_fail(w->sim, LAG_ESTALL,
                  "at t = %.9g s %s at the %s %s, of friction %.6g: %s (Painleve's paradox, from a friction of "
                  "%.6g on in this position)",
                  w->sim->run->t, motions ? "several motions follow" : "no motion follows",
                  of[worst].guide ? "guide" : "contact", lag_contacts_name(w, of[worst].contact), of[worst].mu,
                  motions ? "it may slip on or lift off"
                          : "friction would press it against the surface more than the surface presses back",
                  least);
}

/* Whether the contact whose first tangent is at row t slips in space; way: there. */
static int slip_way(const ContactSet *w, int t, int event, double *way) {
  int i = w->of[t];
  double slip[2] = {w->rate[i], w->rate[i + 1]}, size = lag_norm(slip, 2);
  double most = fmax(w->rate_size[i], w->rate_size[i + 1]);
  int ends = lag_contacts_at(w, t)->impact == event && lag_slip_ends(&w->sim->pb, slip, most);
  if (size <= lag_no_gap * most || ends || w->was_closed[i]) return 0;
  for (int k = 0; k < 2; k++) way[k] = slip[k] / size;
  return 1;
}

static int slip_side(const ContactSet *w, int t, int event) {
  int i = w->of[t];
  double slip = w->rate[i];
  int rests = fabs(slip) <= lag_no_gap * w->rate_size[i] || lag_contacts_at(w, t)->impact == event || w->was_closed[i];
  return rests ? 0 : slip > 0 ? 1 : -1;
}

/* Contacts and guides that take part, as problem of lag_contact_modes: touches of[n], row[rows]: their rows in the
 * set, -1 for the force of a guide, whose map from forces stands in pressed. */
typedef struct Touches {
  int n, rows, row[2 * LAG_MOST_TOUCHES];
  lag_touch of[LAG_MOST_TOUCHES];
  double pressed[LAG_MOST_TOUCHES][3][1 + 2 * LAG_MOST_TOUCHES];
} Touches;

/* Returns 0 where there are too many. */
static int list_touches(const ContactSet *w, int event, Touches *to) {
  const lag_model *m = w->sim->scene->model;
  int guides = w->rows - m->nguides;
  *to = (Touches){0};
  for (int a = 0; a < w->rows; a++) {
    if (a < w->n ? !w->active[a] : a < guides) continue;
    if (to->n == (a < guides ? LAG_TRIED_TOUCHES : LAG_MOST_TOUCHES)) return 0;
    int guide = a < guides ? 0 : 1 + a - guides;
    to->of[to->n] = (lag_touch){.contact = a, .tangent = -1, .guide = guide};
    to->row[to->n++] = guide ? -1 : a;
  }
  to->rows = to->n;
  for (int k = 0; k < to->n; k++) {
    lag_touch *of = &to->of[k];
    int a = of->contact, t = of->guide ? a : w->at[a];
    if (t < 0) continue;
    of->mu = w->law[3 * w->of[t]];
    of->hold = of->guide ? lag_guide_law(m, w->law, of->guide - 1)[0] : w->law[3 * w->of[a]];
    int second = lag_second_of(m, w->of[t]) >= 0;
    of->slip = second ? slip_way(w, t, event, of->way) : slip_side(w, t, event);
    of->cannot_stick = lag_contacts_at(w, t)->release == event;
    of->tangent = to->rows;
    to->row[to->rows++] = t;
    if (second) {
      of->second = to->rows;
      to->row[to->rows++] = t + 1;
    }
  }
  return to->rows <= 2 * LAG_MOST_TOUCHES;
}

/* Forces of guides as maps from those of the rows. */
static void list_pressed(const ContactSet *w, Touches *to) {
  const lag_model *m = w->sim->scene->model;
  for (int k = 0; k < to->n; k++) {
    lag_touch *of = &to->of[k];
    if (!of->guide) continue;
    of->parts = m->guides[of->guide - 1].parts;
    of->pressed = &to->pressed[k][0][0];
    for (int c = 0; c < of->parts; c++) {
      const double *from = lag_guide_pressed(w, of->guide - 1, c);
      of->pressed[c * (1 + to->rows)] = from[0];
      for (int r = 0; r < to->rows; r++)
        of->pressed[c * (1 + to->rows) + 1 + r] = to->row[r] < 0 ? 0 : from[1 + to->row[r]];
    }
  }
}

int lag_contacts_choose_modes(ContactSet *w, int event, double *acceleration) {
  lag_sim *s = w->sim;
  Touches to;
  int some = list_touches(w, event, &to), n = to.n, rows = to.rows;
  for (int a = 0; a < w->rows; a++) w->closed[a] = 0;
  if (!some)
    return lag_fail(s, LAG_EMODEL,
                    "at t = %.9g s more than %d contacts touch at once, some of them with friction, which only moreau "
                    "follows: take --method \"moreau(step=1e-3)\"",
                    s->run->t, w->n > LAG_TRIED_TOUCHES ? LAG_TRIED_TOUCHES : LAG_MOST_TOUCHES);
  int rc = find_free_accelerations(w);
  rc = rc ? rc : lag_guides_find_pressed(w);
  list_pressed(w, &to);
  double W[4 * LAG_MOST_TOUCHES * LAG_MOST_TOUCHES], pull[2 * LAG_MOST_TOUCHES], x[2 * LAG_MOST_TOUCHES],
      room[2 * LAG_MOST_TOUCHES * (2 * LAG_MOST_TOUCHES + 5)];
  for (int i = 0; i < rows && rc == 0; i++) {
    pull[i] = to.row[i] < 0 ? 0 : w->rhs[to.row[i]];
    for (int j = 0; j < rows; j++)
      W[i * rows + j] = to.row[i] < 0 || to.row[j] < 0 ? 0 : w->response[to.row[i] * w->rows + to.row[j]];
  }
  int motions = rc ? 0 : n == 0 ? 1 : lag_contact_modes(n, to.of, rows, W, pull, x, room);
  if (rc || motions != 1) return rc ? rc : fail_paradox(w, to.of, n, motions);
  for (int a = 0; a < w->n; a++) {
    acceleration[a] = w->rhs[a];
    for (int k = 0; k < rows; k++) acceleration[a] += to.row[k] < 0 ? 0 : w->response[a * w->rows + to.row[k]] * x[k];
  }
  for (int k = 0; k < n; k++) {
    int a = to.of[k].contact;
    w->closed[a] = to.of[k].mode != LAG_CONTACT_OPEN;
    w->side[a] = to.of[k].mode == LAG_CONTACT_SLIPS ? to.of[k].to : to.of[k].shared ? 0 : (double)NAN;
    for (int c = 0; c < 2; c++) w->way[2 * a + c] = to.of[k].way[c];
  }
  lag_contacts_close_only(w, 0, -1);
  return LAG_OK;
}

void lag_contacts_set_friction(ContactSet *w) {
  lag_sim *s = w->sim;
  int guides = w->rows - s->scene->model->nguides;
  for (int a = 0; a < w->rows; a++) {
    int t = a < w->n ? w->at[a] : a < guides ? -1 : a;
    if (t < 0 || !w->closed[a]) continue;
    int i = w->of[t], slips = fabs(w->side[a]) > 0;
    if (w->was_closed[i] && slips) lag_mark_due(s, s->scene->model->contacts[i].release);
    lag_contact_set_closed(s, i, !slips);
    s->hold[s->scene->model->contacts[i].force] = w->side[a];
    if (lag_second_of(s->scene->model, i) < 0) continue;
    double size = fmax(w->rate_size[i], w->rate_size[i + 1]);
    lag_contact_set_closed(s, i + 1, !slips);
    for (int k = 0; k < 2; k++) /* least forces where they are not unique */
      s->hold[s->scene->model->contacts[i + k].force] = slips ? w->way[2 * a + k] * (size > 0 ? size : 1) : (double)NAN;
  }
}
