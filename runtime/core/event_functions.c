/* Event functions at a state: the model's, those of contacts, and of switches behind them. */
#include "core/core.h"

int lag_events_eval(lag_sim *s, double t, const double *y, double *g) {
  const lag_model *m = s->scene->model;
  int rc = lag_inputs_at(&s->pb, t, y);
  if (rc > 0 && s->pb.nslide)
    return lag_fail(s, LAG_EDOMAIN, "nothing keeps the motion on the surface on which it slides at t = %s s",
                    LAG_TEXT(t));
  if (rc == 0 && lag_watched(s) > m->nev && lag_switch_eval(s, t, y, g + m->nev))
    return lag_fail(s, LAG_ENAN, "a switching function is not a number at t = %s s", LAG_TEXT(t));
  if (rc == 0 && m->nev) rc = m->events(m, t, y, y + m->nq, y + 2 * m->nq, s->p, s->u, g, s->work);
  if (rc == 0 && s->pb.contacts) lag_contact_mute(s, g);
  else if (rc == 0 && m->contact_laws) rc = lag_tangent_events(s, t, y, g);
  int bad = rc ? -1 : lag_not_finite(m->nev, g);
  if (rc || bad >= 0) {
    return lag_fail(s, rc < 0 ? rc : LAG_ENAN, "event %s: its function is not a number at t = %s s",
                    bad >= 0 ? m->ev[bad].name : "", LAG_TEXT(t));
  }
  return LAG_OK;
}
