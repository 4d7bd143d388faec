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

/* Of what an impact leaves of the speed, this is none. */
static const double no_speed = 1e-9;

int lag_contact_after(lag_sim *s, int event, int ends, const double *before, double *y)
{
  const lag_contact *c = lag_contact_of(s->scene->model, event);
  double gap, rate, was;

  if (!c) {
    return LAG_OK;
  }
  if (c->release == event) {
    s->hold[c->input] = NAN;
    return LAG_OK;
  }
  int rc = gap_at(s, c, before, &gap, &was);
  rc = rc ? rc : gap_at(s, c, y, &gap, &rate);
  return rc || (!ends && rate > no_speed * fabs(was)) ? rc : close_gap(s, c, y);
}

int lag_contact_begin(lag_sim *s)
{
  const lag_model *m = s->scene->model;
  double gap, rate, size = 1, speed = 1;

  for (int i = 0; i < m->nq; i++) {
    size = fmax(size, fabs(s->now[i]));
    speed = fmax(speed, fabs(s->now[m->nq + i]));
  }
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    const char *name = m->constraints->of[c->constraint].name;
    int rc = gap_at(s, c, s->now, &gap, &rate), stop = 0;
    if (rc || lag_contact_is_closed(s, c) || gap > 1e-12 * size) {
      continue;
    }
    if (gap < -1e-12 * size) {
      return lag_fail(s, LAG_EINVAL, "the start is inside the contact %s: its gap is %.3g %s", name, gap, m->constraints->of[c->constraint].unit);
    }
    if (rate < -1e-12 * speed) { /* it begins with an impact */
      memcpy(s->yb, s->now, (size_t)s->pb.n * sizeof(double));
      rc = lag_inputs(&s->pb, s->run->t);
      rc = rc ? rc : m->act(c->impact, s->run->t, s->now, s->now + m->nq, s->now + 2 * m->nq, s->p, s->u, s->yb, s->yb + m->nq,
                            s->yb + 2 * m->nq, &stop, s->work);
      memcpy(s->now, s->yb, (size_t)s->pb.n * sizeof(double));
      rc = rc ? rc : gap_at(s, c, s->now, &gap, &rate);
    }
    if (rc == 0 && rate <= 1e-12 * speed) {
      rc = close_gap(s, c, s->now);
    }
    if (rc) {
      return lag_fail(s, LAG_EMODEL, "the contact %s has no finite values at the start", name);
    }
  }
  return LAG_OK;
}
