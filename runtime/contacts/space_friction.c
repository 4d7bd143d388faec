/* Contacts in space, whose slip has two components along perpendicular directions. Enters: slip velocities at a state;
 * leaves: the direction of each slip, by which its friction acts. Holds: inputs `force` of its two tangents hold the
 * direction at the last step's end times the size of slips, NaN where it sticks or is open; within a step friction
 * acts against the slip itself, and on along the held direction once the slip has passed 0, so that no step sees a
 * jump. A slip that turns away from the held direction without passing 0 is no end of it. */
#include <math.h>

#include "contacts/contact_set.h"
#include "core/rhs.h"

int lag_second_of(const lag_model *m, int i) {
  int next = i + 1, contacts = m->ncontacts - m->nguides; /* guides stand behind the contacts */
  if (i < 1 || next >= contacts || m->contacts[i - 1].is_tangent || !m->contacts[i].is_tangent) return -1;
  return m->contacts[next].is_tangent ? next : -1;
}

int lag_gap_of(const lag_model *m, int tangent) {
  return m->contacts[tangent - 1].is_tangent ? tangent - 2 : tangent - 1;
}

/* The held vector of the first tangent i; its length, 0 where it does not slip. */
static double held(const double *hold, const lag_model *m, int i, double *h) {
  h[0] = hold[m->contacts[i].force];
  h[1] = hold[m->contacts[i + 1].force];
  double size = lag_norm(h, 2);
  return size > 0 ? size : 0;
}

int lag_slips_in_space(const lag_problem *pb, int i) {
  double h[2];
  return lag_second_of(pb->model, i) >= 0 && held(pb->hold, pb->model, i, h) > 0;
}

/* Sets inputs of slipping tangents in space: their velocities count among the residuals, or not. */
static int count_slips(lag_problem *pb, double counts) {
  const lag_model *m = pb->model;
  int some = 0;
  for (int i = 0; i < m->ncontacts; i++) {
    if (!lag_slips_in_space(pb, i)) continue;
    pb->u[m->contacts[i].input] = pb->u[m->contacts[i + 1].input] = counts;
    some = 1;
  }
  return some;
}

int lag_slip_velocities(lag_problem *pb, double t, const double *y, double *c, double *r) {
  if (!count_slips(pb, 1)) return 0;
  const lag_constraints *of = pb->model->constraints;
  int rc = of->residuals(of, t, y, y + pb->nq, y + 2 * pb->nq, pb->p, pb->u, c, r, pb->work);
  count_slips(pb, 0);
  return rc;
}

/* Slip below which friction acts along the held direction: its direction changes fast there. */
static double small_slip(const lag_problem *pb, double size) {
  return fmin(fmax(1e3 * pb->tol, 1e-8), 1e-4) * size;
}

double lag_slip_noise(const lag_problem *pb, int i) {
  double h[2];
  return lag_slips_in_space(pb, i) ? 1e-3 * small_slip(pb, held(pb->hold, pb->model, i, h)) : 0;
}

void lag_slip_direction(const lag_problem *pb, const double *r, int i, double *e) {
  const lag_model *m = pb->model;
  double h[2], size = held(pb->hold, m, i, h), d[2] = {h[0] / size, h[1] / size};
  double s[2] = {r[m->contacts[i].constraint], r[m->contacts[i + 1].constraint]}, along = s[0] * d[0] + s[1] * d[1];
  double more = fmax(along, small_slip(pb, size)) - along, length;
  for (int k = 0; k < 2; k++) e[k] = s[k] + more * d[k];
  length = lag_norm(e, 2);
  for (int k = 0; k < 2; k++) e[k] /= length;
}

int lag_slip_ends(const lag_problem *pb, const double *s, double size) {
  return lag_norm(s, 2) <= fmax(10 * pb->tol, lag_no_gap) * size;
}

static int sticks(const lag_sim *s, int i) {
  const lag_model *m = s->scene->model;
  return lag_second_of(m, i) >= 0 && s->hold[m->contacts[i].input] > 0.5;
}

int lag_some_stick_in_space(const lag_sim *s) {
  int i = 0;
  while (i < s->scene->model->ncontacts && !sticks(s, i)) i++;
  return i < s->scene->model->ncontacts;
}

/* Events of the pair whose first tangent is i; law: of the model's contact_laws, where it sticks. */
static void pair_events(const lag_sim *s, int i, const double *law, double *g) {
  const lag_model *m = s->scene->model;
  const lag_contact *a = &m->contacts[i], *b = a + 1;
  int gap = lag_gap_of(m, i);
  double h[2], size = held(s->hold, m, i, h), force[2] = {law[3 * i + 2], law[3 * i + 5]};
  g[a->impact] = size > 0 ? (h[0] * g[a->impact] + h[1] * g[b->impact]) / size : 1;
  g[a->release] = sticks(s, i) ? law[3 * gap] * law[3 * gap + 2] - lag_norm(force, 2) : 1;
  g[b->impact] = g[b->release] = 1;
}

void lag_space_events(const lag_sim *s, const double *law, double *g) {
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->ncontacts; i++)
    if (lag_second_of(m, i) >= 0) pair_events(s, i, law, g);
}

void lag_contacts_turn(lag_sim *s) {
  const lag_model *m = s->scene->model;
  double *c = s->contact_scratch, *r = c + m->constraints->n, h[2];
  if (lag_inputs(&s->pb, s->run->t) || lag_slip_velocities(&s->pb, s->run->t, s->now, c, r)) return;
  for (int i = 0; i < m->ncontacts; i++) {
    if (!lag_slips_in_space(&s->pb, i)) continue;
    double size = held(s->hold, m, i, h);
    double slip[2] = {r[m->contacts[i].constraint], r[m->contacts[i + 1].constraint]}, length = lag_norm(slip, 2);
    if (lag_slip_ends(&s->pb, slip, size) || !(slip[0] * h[0] + slip[1] * h[1] > 0)) continue;
    for (int k = 0; k < 2; k++) s->hold[m->contacts[i + k].force] = size * slip[k] / length;
  }
}
