/* Contacts: gaps that stay at least 0. Enters: a state in which one closes, opens, or is closed at the start; leaves: the model with that
 * gap as a constraint, or without. Holds: a closed gap is one whose input in `hold` is 1; its multiplier is not negative, but for the
 * time until its event is found. Impacts themselves are the model's (lag_model.act), after Newton's law of restitution.
 *
 * Impacts that follow each other ever faster come to an end in finite time (a ball that loses a fifth of its speed at each bounce). The
 * gap is closed when what is left of that time is too short to matter; Brogliato, Nonsmooth Mechanics, 3rd ed. (2016), 1.4 and 8.1, DOI
 * 10.1007/978-3-319-28664-8. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "core/core.h"

const lag_contact *lag_contact_of(const lag_model *m, int event)
{
  for (int i = 0; i < m->ncontacts; i++) {
    if (m->contacts[i].impact == event || m->contacts[i].release == event) {
      return &m->contacts[i];
    }
  }
  return NULL;
}

int lag_contact_is_closed(const lag_sim *s, const lag_contact *c)
{
  return s->hold[c->input] > 0.5;
}

/* The gap and its rate, as a constraint has them while it is closed. */
static int gap_at(lag_sim *s, const lag_contact *c, const double *y, double *gap, double *rate)
{
  double was = s->hold[c->input], *room = s->contact_room, *r = room + s->scene->model->constraints->nholonomic;

  s->hold[c->input] = 1;
  int rc = lag_residuals(&s->pb, s->run->t, y, room, r);
  s->hold[c->input] = was;
  *gap = room[c->constraint];
  *rate = r[c->constraint];
  return rc;
}

/* Closes it, if its multiplier then presses; y loses the speed that is left. */
static int close_gap(lag_sim *s, const lag_contact *c, double *y)
{
  double *g = s->contact_room;

  s->hold[c->input] = 1;
  int rc = lag_project(&s->pb, s->run->t, y, NULL);
  rc = rc ? LAG_EMODEL : lag_events_eval(s, s->run->t, y, g);
  if (rc == 0 && !(g[c->release] >= 0)) { /* pulled apart at once */
    s->hold[c->input] = NAN;
  }
  return rc;
}

/* Of what an impact leaves of the speed, this is none; and a gap of this part of what there is of coordinates is closed. */
static const double no_speed = 1e-9, no_gap = 1e-12;

/* The model's impact at the state y. */
static int strike(lag_sim *s, const lag_contact *c, double *y)
{
  const lag_model *m = s->scene->model;
  size_t bytes = (size_t)s->pb.n * sizeof(double);
  int stop = 0, nq = m->nq, rc = lag_inputs(&s->pb, s->run->t);

  memcpy(s->yc, y, bytes);
  return rc ? rc : m->act(c->impact, s->run->t, s->yc, s->yc + nq, s->yc + 2 * nq, s->p, s->u, y, y + nq, y + 2 * nq, &stop, s->work);
}

static int no_values(lag_sim *s, const char *name)
{
  return lag_fail(s, LAG_EMODEL, "the contact %s has no finite values at t = %.17g s", name, s->run->t);
}

/* What the model makes of a rate must be Newton's law with 0 <= e <= 1. */
static int check_restitution(lag_sim *s, const char *name, double before, double after)
{
  double e = before < 0 ? -after / before : 0;

  return e >= -no_speed && e <= 1 + no_speed ? LAG_OK
                                             : lag_fail(s, LAG_EINVAL, "the contact %s has a restitution of %.3g: it is between 0 and 1", name, e);
}

int lag_contact_after(lag_sim *s, int event, int ends, const double *before, double *y)
{
  const lag_contact *c = lag_contact_of(s->scene->model, event);
  double gap, rate, was;

  if (!c) {
    return LAG_OK;
  }
  const char *name = s->scene->model->constraints->of[c->constraint].name;
  if (c->release == event) {
    s->hold[c->input] = NAN;
    return LAG_OK;
  }
  int rc = gap_at(s, c, before, &gap, &was);
  rc = rc ? rc : gap_at(s, c, y, &gap, &rate);
  if (rc) {
    return no_values(s, name);
  }
  if ((rc = check_restitution(s, name, was, rate)) != 0) {
    return rc;
  }
  return (ends || rate <= no_speed * fabs(was)) && close_gap(s, c, y) ? no_values(s, name) : LAG_OK;
}

/* The open contact c at the state y, which no motion has led to. *again: it has changed y. */
static int meet(lag_sim *s, const lag_contact *c, double *y, const char *who, int *again)
{
  const lag_constraint *of = &s->scene->model->constraints->of[c->constraint];
  double gap, rate, was, size = 1, speed = 1;

  for (int i = 0; i < s->pb.nq; i++) {
    size = fmax(size, fabs(y[i]));
    speed = fmax(speed, fabs(y[s->pb.nq + i]));
  }
  if (gap_at(s, c, y, &gap, &was)) {
    return no_values(s, of->name);
  }
  if (gap > no_gap * size || was > no_gap * speed) {
    return LAG_OK;
  }
  if (gap < -no_gap * size) {
    return lag_fail(s, LAG_EINVAL, "%s is inside the contact %s: its gap is %.3g %s", who, of->name, gap, of->unit);
  }
  rate = was;
  if (was < -no_gap * speed) { /* it strikes */
    *again = 1;
    if (strike(s, c, y) || gap_at(s, c, y, &gap, &rate)) {
      return no_values(s, of->name);
    }
    int rc = check_restitution(s, of->name, was, rate);
    if (rc) {
      return rc;
    }
  }
  return rate <= fmax(no_gap * speed, no_speed * fabs(was)) && close_gap(s, c, y) ? no_values(s, of->name) : LAG_OK;
}

void lag_contact_open(lag_sim *s)
{
  const lag_model *m = s->scene->model;

  for (int i = 0; i < m->ncontacts; i++) {
    s->hold[m->contacts[i].input] = NAN;
  }
}

int lag_contact_meet(lag_sim *s, double *y, const char *who)
{
  enum { MOST = 100 }; /* impacts that lead to others at the same place, as of balls in a row */
  const lag_model *m = s->scene->model;
  int again = 1, rc = LAG_OK;

  for (int turn = 0; turn < MOST && again && rc == 0; turn++) {
    again = 0;
    for (int i = 0; i < m->ncontacts && rc == 0; i++) {
      if (!lag_contact_is_closed(s, &m->contacts[i])) {
        rc = meet(s, &m->contacts[i], y, who, &again);
      }
    }
  }
  return rc;
}

int lag_contact_begin(lag_sim *s)
{
  int rc = lag_contact_meet(s, s->now, "the start");

  memcpy(s->y, s->now, (size_t)s->pb.n * sizeof(double));
  return rc;
}
