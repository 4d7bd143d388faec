/* Guides at events: the slip that ends, and the force of each guide as a linear map of the forces of contacts and
 * friction. Contract: contact_set.h. */
#include <math.h>
#include <string.h>

#include "contacts/contact_set.h"
#include "core/rhs.h"

int lag_guide_of(const lag_model *m, int contact) {
  for (int i = 0; i < m->nguides; i++)
    if (m->guides[i].tangent == contact) return i;
  return -1;
}

int lag_guide_turns(const lag_model *m, int event) {
  for (int i = 0; i < m->nguides; i++)
    if (m->guides[i].turn == event) return 1;
  return 0;
}

int lag_guides_stop(ContactSet *w, int event) {
  const lag_model *m = w->sim->scene->model;
  int nq = w->sim->pb.nq;
  for (int a = w->rows - m->nguides; a < w->rows; a++) {
    int i = w->of[a];
    if (lag_contacts_at(w, a)->impact != event || !(lag_contacts_response(w, i) > 0)) continue;
    for (int k = 0; k < nq; k++) w->y[nq + k] -= w->rate[i] * w->d[k];
    if (lag_contacts_rates(w, w->y, w->rate)) return lag_contacts_no_values(w, i);
  }
  return LAG_OK;
}

double *lag_guide_pressed(const ContactSet *w, int guide, int c) {
  return w->pressed + (3 * guide + c) * (1 + w->rows);
}

/* to[guides][3] := forces of the guides, with the inputs as they are. */
static int forces(ContactSet *w, double *to, double *law) {
  const lag_model *m = w->sim->scene->model;
  int rc = lag_contact_laws_at(&w->sim->pb, w->sim->run->t, w->y, law);
  for (int g = 0; g < m->nguides && rc == 0; g++) memcpy(to + 3 * g, lag_guide_law(m, law, g) + 1, 3 * sizeof *to);
  return rc;
}

/* A force of `unit` along tangent i, which is open; 0: none. */
static void push(ContactSet *w, int i, double unit) { w->sim->pb.u[w->sim->scene->model->contacts[i].force] = unit; }

/* column r of the map, from forces N with force `by` of row r. */
static void set_column(ContactSet *w, int r, const double *N, const double *N0, double by) {
  for (int k = 0; k < 3 * w->sim->scene->model->nguides; k++)
    lag_guide_pressed(w, k / 3, k % 3)[1 + r] = by != 0 ? (N[k] - N0[k]) / by : 0;
}

/* Column of a gap, which presses as it has to while it alone is closed: beside no other force, or beside that of the
 * tangent that makes it press most. N0[guides][3]: without any force. */
static int press_gap(ContactSet *w, int a, double unit, const double *N0, double *N, double *law) {
  const lag_model *m = w->sim->scene->model;
  int best = -1, rc;
  double most = 0;
  for (int r = w->n - 1; r < w->rows; r++) { /* w->n - 1: no other */
    double press = w->rhs[a] + (r < w->n ? 0 : w->response[a * w->rows + r] * unit);
    if (!(fabs(press) > most)) continue;
    most = fabs(press);
    best = r;
  }
  if (best < 0 || !(w->response[a * w->rows + a] > 0)) return LAG_OK;
  lag_contacts_close_only(w, 0, w->of[a]);
  rc = lag_inputs(&w->sim->pb, w->sim->run->t);
  if (best >= w->n) push(w, w->of[best], unit);
  rc = rc ? rc : forces(w, N, law);
  double by = law[3 * w->of[a] + 2];
  for (int k = 0; k < 3 * m->nguides && best >= w->n; k++) N[k] -= unit * lag_guide_pressed(w, k / 3, k % 3)[1 + best];
  set_column(w, a, N, N0, by);
  return rc;
}

int lag_guides_find_pressed(ContactSet *w) {
  const lag_model *m = w->sim->scene->model;
  double *law = w->sim->pb.rub, unit = 1, N0[3 * LAG_MOST_GUIDES], N[3 * LAG_MOST_GUIDES];
  if (m->nguides == 0) return LAG_OK;
  lag_contacts_close_only(w, 0, -1);
  int rc = lag_inputs(&w->sim->pb, w->sim->run->t);
  rc = rc ? rc : forces(w, N0, law);
  for (int k = 0; k < 3 * m->nguides; k++) lag_guide_pressed(w, k / 3, k % 3)[0] = N0[k];
  if (rc == 0 && lag_norm(N0, 3 * m->nguides) > 0) unit = lag_norm(N0, 3 * m->nguides);
  for (int r = w->n; r < w->rows && rc == 0; r++) {
    push(w, w->of[r], unit);
    rc = forces(w, N, law);
    push(w, w->of[r], 0);
    set_column(w, r, N, N0, unit);
  }
  for (int a = 0; a < w->n && rc == 0; a++) rc = press_gap(w, a, unit, N0, N, law);
  lag_contacts_close_only(w, 0, -1);
  return rc ? lag_contacts_no_values(w, w->of[w->rows - 1]) : LAG_OK;
}

double lag_guide_gain(const ContactSet *w, int a) {
  int guide = a - (w->rows - w->sim->scene->model->nguides);
  double by[3];
  for (int c = 0; c < 3; c++) by[c] = lag_guide_pressed(w, guide, c)[1 + a];
  return lag_norm(by, 3);
}
