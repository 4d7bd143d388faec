/* Constraints that hold while a condition is true. Enters: a state at the start or after an event; leaves: those
 * constraints whose conditions are true, and velocities that obey them. Holds: a condition is true where its
 * constraint holds, and nowhere else, up to the rounding of its function; positions do not change.
 *
 * Where a constraint begins to hold, velocities make the least change in the metric of the mass matrix that obeys
 * all constraints (lag_project): a plastic impact, after which no state that obeys them is nearer in kinetic energy.
 * J.J. Moreau, in: Nonsmooth Mechanics and Applications (1988), 1, DOI 10.1007/978-3-7091-2624-0_1. Contacts that
 * touch then follow their own law: the nearest velocities of both are found so, one after the other, since those of
 * contacts are sought among those that obey the constraints. */
#include <math.h>

#include "core/core.h"

/* Part of a constraint's terms by which its position may be off where it begins to hold: events are located on the
 * dense output, to less. */
static const double no_distance = 1e-9;

/* Whether constraint c holds after the event at y, beside whose condition `margin` lies. Where the margin is
 * rounding, `zero`, a condition that had clearly been true, or false, until now ends at the same time as that of the
 * event: feet that follow each other. */
static int then_holds(lag_sim *s, const lag_contact *c, int event, double margin, const double *zero) {
  if (s->forced) return s->forced[c->input] > 0.5;
  int now = lag_contact_is_closed(s, c), came = now ? c->impact : c->release, goes = now ? c->release : c->impact;
  if (event == came || event == goes) return event == c->impact;
  if (fabs(margin) > (zero ? fmax(zero[came], zero[goes]) : 0)) return margin > 0;
  return now != (event >= 0 && isnan(s->root[came]) && s->sign[goes] > 0);
}

/* Sets which constraints hold at y. event: the one that happens, or -1. *changed: another set. */
static int place(lag_sim *s, double t, const double *y, int event, const double *zero, int *changed) {
  const lag_model *m = s->scene->model;
  int rc = lag_events_eval(s, t, y, s->g1);
  for (int i = 0; i < m->ncontacts && rc == 0; i++) {
    const lag_contact *c = &m->contacts[i];
    if (!c->conditional) continue;
    int now = lag_contact_is_closed(s, c);
    int then = then_holds(s, c, event, now ? s->g1[c->release] : -s->g1[c->impact], zero);
    s->contact_was[i] = now;
    s->hold[c->input] = then ? 1 : NAN;
    *changed |= then != now;
    if (then != now && event >= 0) lag_mark_due(s, then ? c->impact : c->release);
  }
  return rc;
}

static int has_conditions(const lag_model *m) {
  int i = 0;
  while (i < m->ncontacts && !m->contacts[i].conditional) i++;
  return i < m->ncontacts;
}

int lag_conditional_place(lag_sim *s, double t, const double *y) {
  int changed;
  return has_conditions(s->scene->model) ? place(s, t, y, -1, NULL, &changed) : LAG_OK;
}

static int fail_apart(lag_sim *s, int k, double distance) {
  const lag_constraint *c = &s->scene->model->constraints->of[k];
  return lag_fail(s, LAG_EMODEL,
                  "the constraint %s begins to hold at t = %.9g s, where it is off by %.3g%s%s, and an impulse changes "
                  "no positions: let its "
                  "condition become true where it is met, or demand its rate, as x' = 0",
                  c->name, s->run->t, distance, c->unit[0] ? " " : "", c->unit);
}

/* Whether the constraints on positions that have just begun to hold are met at y. */
static int check_positions(lag_sim *s, const double *y) {
  const lag_model *m = s->scene->model;
  int n = m->constraints->n, rc;
  double *c = s->contact_scratch, *terms = c + n;
  if ((rc = lag_residuals(&s->pb, s->run->t, y, c, terms)) != 0 ||
      (rc = lag_constraint_terms(&s->pb, s->run->t, y, 1, terms)) != 0)
    return rc;
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *of = &m->contacts[i];
    int k = of->constraint, begins = of->conditional && lag_contact_is_closed(s, of) && !(s->contact_was[i] > 0.5);
    if (begins && m->constraints->of[k].holonomic && !(fabs(c[k]) <= no_distance * terms[k]))
      return fail_apart(s, k, c[k]);
  }
  return LAG_OK;
}

static int fail_unmet(lag_sim *s, int event, int changed) {
  const char *name = event < 0 ? "" : s->scene->model->ev[event].name, *why = s->pb.detail ? s->pb.detail : "";
  if (!changed)
    return lag_fail(s, LAG_EMODEL, "event %s: its action at t = %s s leaves the constraints: %s", name,
                    LAG_TEXT(s->run->t), why);
  return lag_fail(s, LAG_EMODEL, "at t = %.9g s%s%s the constraints that hold from then on contradict each other: %s",
                  s->run->t, event < 0 ? "" : ", after event ", name, why);
}

/* Brings y to the constraints that hold now. changed: the set is another; elsewhere: positions have been set. */
static int obey(lag_sim *s, double *y, int event, int changed, int elsewhere) {
  double t = s->run->t;
  lag_contact_open(s); /* bodies at rest may have been lifted or thrown */
  if (changed || elsewhere) lag_release_integrals(s);
  int rc = changed && !s->forced ? check_positions(s, y) : LAG_OK;
  if (rc == 0 && lag_project(&s->pb, t, y, NULL)) return fail_unmet(s, event, changed);
  return rc == 0 && (changed || elsewhere) ? lag_hold_integrals(s, t, y) : rc;
}

static int fail_backwards(lag_sim *s) {
  return lag_fail(s, LAG_EINVAL,
                  "at t = %.9g s a constraint with `while` begins or ceases to hold: that ends a run backwards in "
                  "time, since its impact cannot "
                  "be reversed",
                  s->run->t);
}

static int fail_undecided(lag_sim *s) {
  const lag_model *m = s->scene->model;
  int i = 0; /* the first that was switched in the last turn */
  while (!m->contacts[i].conditional || lag_contact_is_closed(s, &m->contacts[i]) == (s->contact_was[i] > 0.5)) i++;
  return lag_fail(
      s, LAG_EMODEL,
      "at t = %.9g s the constraint %s can neither hold nor not hold: its own impulse makes its condition %s",
      s->run->t, m->constraints->of[m->contacts[i].constraint].name,
      lag_contact_is_closed(s, &m->contacts[i]) ? "true" : "false");
}

int lag_settle_constraints(lag_sim *s, double *y, const char *who, int event, int ends, int moved, const double *zero) {
  const lag_model *m = s->scene->model;
  const lag_contact *of = lag_contact_of(m, event);
  int any = has_conditions(m);
  for (int turn = 0; turn <= m->ncontacts; turn++) { /* an impulse may change other conditions */
    int changed = 0, rc = any ? place(s, s->run->t, y, turn ? -1 : event, zero, &changed) : LAG_OK;
    if (rc || (turn && !changed)) return rc;
    if (changed && s->run->dir < 0) return fail_backwards(s);
    if (changed || (moved && !turn)) rc = obey(s, y, event, changed, moved > 1);
    rc = rc ? rc : lag_contact_resolve(s, y, who, turn || !of || of->conditional ? -1 : event, ends);
    if (rc || !any) return rc;
  }
  return fail_undecided(s);
}
