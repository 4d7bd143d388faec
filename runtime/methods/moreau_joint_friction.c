/* The model of dry friction in one step of moreau, and memory: moreau_joint_friction.h. */
#include "methods/moreau_joint_friction.h"

#include <float.h>
#include <stdio.h>

/* ---- memory */

static int is_surface(const lag_model *m, int k) { return m->switches[k].jumps; }

static int surfaces(const lag_model *m) {
  int n = 0;
  for (int k = 0; k < m->nmodes; k++) n += is_surface(m, k) != 0;
  return n + m->nguides;
}

/* Values of all switches, or of the gaps and rates of all constraints for the slips of guides. */
static int values(const lag_model *m) {
  return m->nswitch + (m->nguides ? m->constraints->nholonomic + m->constraints->n : 0);
}

size_t lag_joint_friction_size(const lag_problem *pb) {
  int n = surfaces(pb->model);
  return n ? (size_t)(LAG_JOINT_ROOM(n, pb->n) + 2 * n + LAG_COUPLED_ROOM(n, pb->n) + values(pb->model)) : 0;
}

JointFriction lag_joint_friction_of(const lag_problem *pb, double *room) {
  const lag_model *m = pb->model;
  JointFriction w = {.of = {.n = surfaces(m), .states = pb->n, .nq = pb->nq}};
  int n = w.of.n;
  lag_joints_place(&w.of, room);
  w.at = room + LAG_JOINT_ROOM(n, pb->n);
  w.entry = w.at + n;
  w.coupled = w.entry + n;
  w.all = w.coupled + LAG_COUPLED_ROOM(n, pb->n);
  for (int k = 0, j = 0; j < n; k++) /* guides behind the switches */
    if (k >= m->nmodes || is_surface(m, k)) w.at[j++] = k;
  return w;
}

/* ---- the model */

static const JointFriction *whole(const lag_joint_friction *w) { return (const JointFriction *)(const void *)w; }
static int switch_of(const lag_joint_friction *w, int j) { return (int)whole(w)->at[j]; }
/* The tangent of a guide; NULL: surface j is a switch. */
static const lag_contact *tangent_of(const lag_model *m, const lag_joint_friction *w, int j) {
  int guide = switch_of(w, j) - m->nmodes;
  return guide < 0 ? NULL : &m->contacts[m->guides[guide].tangent];
}
static double *held(const lag_joint_friction *w, lag_problem *pb, int j) {
  const lag_contact *c = tangent_of(pb->model, w, j);
  return &pb->hold[c ? c->force : pb->model->nu + switch_of(w, j)];
}

void lag_joint_friction_hold(lag_problem *pb, lag_joint_friction *w, int j, double mode) {
  w->mode[j] = *held(w, pb, j) = mode;
}

/* Slips of guides, as rates of their tangents. */
static int guide_slips(lag_problem *pb, double t, const double *y, const double *x, const lag_joint_friction *w,
                       double *g) {
  const lag_model *m = pb->model;
  const lag_constraints *of = m->constraints;
  double *c = whole(w)->all + m->nswitch, *r = c + of->nholonomic;
  for (int j = 0; j < w->n; j++)
    if (tangent_of(m, w, j)) pb->u[tangent_of(m, w, j)->input] = 1;
  int rc = of->residuals(of, t, y, x + m->nq, x + 2 * m->nq, pb->p, pb->u, c, r, pb->work);
  for (int j = 0; j < w->n; j++)
    if (tangent_of(m, w, j)) g[j] = r[tangent_of(m, w, j)->constraint];
  return rc;
}

int lag_joint_friction_slips(lag_problem *pb, double t, const double *y, const double *x, const lag_joint_friction *w,
                             double *g) {
  const lag_model *m = pb->model;
  double *all = whole(w)->all;
  int rc = lag_inputs(pb, t);
  if (rc == 0 && w->n > m->nguides)
    rc = m->switch_values(m, t, y, x + m->nq, x + 2 * m->nq, pb->p, pb->u, all, pb->work);
  for (int j = 0; j < w->n - m->nguides; j++) g[j] = all[switch_of(w, j)];
  if (rc == 0 && m->nguides) rc = guide_slips(pb, t, y, x, w, g);
  return lag_step_checked(pb, rc, t);
}

int lag_joint_friction_grips(lag_problem *pb, double t, const double *y, const lag_joint_friction *w, double *g) {
  const lag_model *m = pb->model;
  const double *v = y + m->nq, *z = v + m->nq;
  double *all = whole(w)->all;
  int rc = m->switch_grips ? m->switch_grips(m, t, y, v, z, pb->p, pb->u, all, pb->work) : 0;
  for (int j = 0; j < w->n - m->nguides && m->switch_grips; j++) g[j] = all[switch_of(w, j)];
  if (rc == 0 && m->nguides) rc = m->contact_laws(m, t, y, v, z, pb->p, pb->u, pb->rub, pb->work);
  for (int k = 0; k < m->nguides; k++) {
    double mu = pb->rub[3 * m->guides[k].tangent], hold = pb->rub[3 * m->ncontacts + 4 * k];
    g[w->n - m->nguides + k] = mu > 0 ? hold / mu : 1;
  }
  return lag_step_checked(pb, rc, t);
}

int lag_joint_friction_fails(lag_problem *pb, double t, const lag_joint_friction *w, int j, const char *words) {
  const lag_contact *c = tangent_of(pb->model, w, j);
  snprintf(pb->words, sizeof pb->words, "the dry friction of `%s` %s",
           c ? pb->model->constraints->of[c->constraint].name : pb->model->switches[switch_of(w, j)].text, words);
  pb->detail = pb->words;
  return lag_step_failed(pb, LAG_EMETHOD, t);
}

/* ---- modes in pb->hold */

void lag_joint_friction_enter(JointFriction *w, lag_problem *pb) {
  for (int j = 0; j < w->of.n; j++) w->entry[j] = *held(&w->of, pb, j);
}

void lag_joint_friction_back(const JointFriction *w, lag_problem *pb) {
  for (int j = 0; j < w->of.n; j++) *held(&w->of, pb, j) = w->entry[j];
}

void lag_joint_friction_stick(JointFriction *w, lag_problem *pb) {
  for (int j = 0; j < w->of.n; j++) /* 1 is the mode of a body that slips */
    if (w->of.sticks[j] != 0.0 && fabs(w->of.mode[j]) == 1.0) *held(&w->of, pb, j) *= 1 - DBL_EPSILON;
}
