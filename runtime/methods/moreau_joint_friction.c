/* Dry friction of joints and sliders in one step of moreau. Enters, leaves: moreau_joint_friction.h. Holds: each surface obeys its law after its turn: no slip is left at the end where less than the bound holds it, else friction is at its
 * size, against the slip. src/emit/header_friction.c writes the same arithmetic into headers, to the last digit.
 *
 * A mode is the mean of sign(slip) in the step. Bounds are 1, or static friction in parts of that of motion where the body rests at the begin. In a step with an impact friction opposes the mean of the slips at both ends, as that of
 * contacts (moreau_contacts.c): it drives the slip s into the interval from -s0 to 0, so it brings no energy in where the impact turns the slip round. */
#include "methods/moreau_joint_friction.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

#include "methods/steps.h"
#include "numeric/workspace.h"

static int is_surface(const lag_problem *pb, int k) { return pb->model->switches[k].jumps; }

static size_t lay_out(const lag_problem *pb, double *room, JointFriction *w) {
  const lag_model *m = pb->model;
  size_t nm = (size_t)m->nmodes, ns = (size_t)m->nswitch;
  double **const parts[] = {&w->mode, &w->sticks, &w->bound, &w->response, &w->before, &w->was, &w->entry, &w->change, &w->stride, &w->slip, &w->other, &w->d, &w->at};
  const size_t sizes[] = {nm, nm, nm, nm, nm, nm, nm, nm, nm, ns, ns, nm * (size_t)pb->n, (size_t)pb->n};
  for (int k = 0; k < m->nmodes; k++) w->n += is_surface(pb, k) != 0;
  return w->n ? lag_workspace_slice(room, sizeof sizes / sizeof *sizes, parts, sizes) : 0;
}

size_t lag_joint_friction_size(const lag_problem *pb) { return lay_out(pb, NULL, &(JointFriction){0}); }

JointFriction lag_joint_friction(const lag_problem *pb, double *room) {
  JointFriction w = {0};
  lay_out(pb, room, &w);
  return w;
}

static void hold(const JointFriction *w, lag_problem *pb, int k, double mode) {
  w->mode[k] = mode;
  pb->hold[pb->model->nu + k] = mode;
}

/* g[nswitch] := the switching functions for coordinates y, velocities and states x. */
static int slips_at(lag_problem *pb, double t, const double *y, const double *x, double *g) {
  const lag_model *m = pb->model;
  int rc = lag_inputs(pb, t);
  rc = rc ? rc : m->switch_values(t, y, x + m->nq, x + 2 * m->nq, pb->p, pb->u, g, pb->work);
  return rc ? lag_step_refused(pb, rc, t) : 0;
}

int lag_joint_friction_begin(JointFriction *w, lag_problem *pb, double t, const double *y) {
  const lag_model *m = pb->model;
  for (int k = 0; k < m->nmodes; k++) {
    w->entry[k] = pb->hold[m->nu + k];
    if (is_surface(pb, k)) hold(w, pb, k, w->mode[k]);
  }
  int rc = slips_at(pb, t, y, y, w->slip);
  if (rc == 0 && m->switch_grips && (rc = m->switch_grips(t, y, y + m->nq, y + 2 * m->nq, pb->p, pb->u, w->bound, pb->work)) != 0) rc = lag_step_refused(pb, rc, t);
  for (int k = 0; k < m->nmodes && rc == 0; k++) {
    w->before[k] = w->slip[k];
    w->change[k] = w->stride[k] = 0;
    if (!m->switch_grips || !(w->bound[k] > 1) || !(w->sticks[k] != 0.0 || w->slip[k] == 0.0)) w->bound[k] = 1;
  }
  return rc;
}

void lag_joint_friction_back(JointFriction *w, lag_problem *pb) {
  for (int k = 0; k < pb->model->nmodes; k++)
    if (is_surface(pb, k)) pb->hold[pb->model->nu + k] = w->entry[k];
}

int lag_joint_friction_response(JointFriction *w, lag_problem *pb, double tm, double t, double h, const double *mid, const double *x) {
  int n = pb->n, rc = 0;
  for (int k = 0; k < pb->model->nmodes && rc == 0; k++) {
    double mode = w->mode[k], *d = w->d + k * n, *at = w->at;
    if (!is_surface(pb, k)) continue;
    hold(w, pb, k, -1);
    rc = lag_step_rhs(pb, tm, mid, at);
    hold(w, pb, k, 1);
    rc = rc ? rc : lag_step_rhs(pb, tm, mid, d);
    hold(w, pb, k, mode);
    for (int i = 0; i < n && rc == 0; i++) {
      d[i] = 0.5 * (d[i] - at[i]);
      at[i] = x[i] + h * d[i];
    }
    rc = rc ? rc : slips_at(pb, t, mid, x, w->slip);
    rc = rc ? rc : slips_at(pb, t, mid, at, w->other);
    w->response[k] = w->other[k] - w->slip[k];
  }
  return rc;
}

static int fail(lag_problem *pb, double t, int k, const char *what) {
  snprintf(pb->words, sizeof pb->words, "the dry friction of `%s` %s", pb->model->switches[k].text, what);
  pb->detail = pb->words;
  return lag_step_failed(pb, LAG_EMETHOD, t);
}

/* The slip that friction aims at, from that without friction: 0, or in an impact the nearest in the interval from -before to 0. */
static double aim(double before, double free, int struck) { return struck ? fmin(fmax(free, fmin(-before, 0)), fmax(-before, 0)) : 0; }

int lag_joint_friction_solve(JointFriction *w, lag_problem *pb, double t, double h, int struck, const double *mid, double *x, double *moved) {
  enum { SWEEPS = 10000 };
  int nm = pb->model->nmodes, n = pb->n, rc = 0;
  double size = 0, last = 0;
  memcpy(w->was, w->mode, (size_t)nm * sizeof *w->was);
  for (int sweep = 0; sweep < SWEEPS; sweep++) {
    double change = 0;
    for (int k = 0; k < nm; k++) {
      if (!is_surface(pb, k)) continue;
      if ((rc = slips_at(pb, t, mid, x, w->slip)) != 0) return rc;
      double g = w->slip[k], own = w->response[k], goal = own < 0 ? aim(w->before[k], g - w->mode[k] * own, struck) : 0;
      double to = own < 0 ? w->mode[k] - (g - goal) / own : (g > 0) - (g < 0);
      if (!isfinite(to)) return fail(pb, t, k, "has no finite values");
      if (fabs(to) > w->bound[k]) to = to > 0 ? 1 : -1;
      double by = to - w->mode[k];
      for (int i = pb->nq; i < n; i++) x[i] += h * by * w->d[k * n + i];
      hold(w, pb, k, to);
      w->sticks[k] = goal == 0.0 && fabs(to) != 1.0;
      change = fmax(change, fabs(by * own));
      size = fmax(size, fmax(fabs(g), fabs(own)));
    }
    if (change <= 64 * DBL_EPSILON * size || (sweep > 0 && change <= 1e7 * DBL_EPSILON * size && change >= last / 2)) {
      *moved = 0;
      for (int k = 0; k < nm; k++) *moved = is_surface(pb, k) ? fmax(*moved, fabs((w->mode[k] - w->was[k]) * w->response[k])) : *moved;
      *moved = size > 0 ? *moved / size : 0;
      return 0;
    }
    last = change;
  }
  int k = 0;
  while (!is_surface(pb, k)) k++;
  return fail(pb, t, k, "and others find no forces that agree: take smaller steps");
}

int lag_joint_friction_note(JointFriction *w, lag_problem *pb, double t, const double *mid, const double *x) {
  int rc = slips_at(pb, t, mid, x, w->slip);
  for (int k = 0; k < pb->model->nmodes && rc == 0; k++) {
    if (!is_surface(pb, k)) continue;
    w->sticks[k] = fabs(w->slip[k]) <= 1e-9 * fabs(w->response[k]);
    if (w->sticks[k] != 0.0 && fabs(w->mode[k]) == 1.0) pb->hold[pb->model->nu + k] *= 1 - DBL_EPSILON; /* 1 is that of a body that slips */
  }
  return rc;
}

void lag_joint_friction_lengthen(JointFriction *w, lag_problem *pb) {
  for (int k = 0; k < pb->model->nmodes; k++) {
    double change = w->mode[k] - w->was[k];
    int goes_on = change * w->change[k] > 0 && fabs(change) >= fabs(w->change[k]) / 2;
    w->stride[k] = goes_on ? fmin(2 * w->stride[k] + 1, 1e6) : 0;
    w->change[k] = change;
    if (!is_surface(pb, k) || !goes_on) continue;
    double to = w->mode[k] + w->stride[k] * change;
    hold(w, pb, k, fabs(to) > w->bound[k] ? copysign(1, to) : to);
  }
}

void lag_joint_friction_carry(const JointFriction *w, const lag_problem *pb, double part, double *x) {
  for (int k = 0; k < pb->model->nmodes; k++)
    for (int i = pb->nq; i < pb->n && is_surface(pb, k); i++) x[i] += part * (w->mode[k] - w->was[k]) * w->d[k * pb->n + i];
}
