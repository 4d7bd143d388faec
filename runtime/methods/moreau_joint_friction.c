/* Dry friction of joints and sliders in one step of moreau. Enters, leaves: moreau_joint_friction.h. Holds: each
 * surface obeys its law after its turn (kernels/impulses.h): no slip is left at the end where less than the bound
 * holds it, else friction is at its size, against the slip.
 *
 * Bounds are 1, or static friction in parts of that of motion where the body rests at the begin. In a step with an
 * impact friction opposes the mean of the slips at both ends, as that of contacts (moreau_contacts.c): it drives the
 * slip s into the interval from -s0 to 0, so it brings no energy in where the impact turns the slip round. */
#include "methods/moreau_joint_friction.h"

#include <float.h>
#include <stdio.h>
#include <string.h>

#include "kernels/impulses.h"
#include "methods/steps.h"
#include "numeric/workspace.h"

static int is_surface(const lag_problem *pb, int k) { return pb->model->switches[k].jumps; }

static size_t lay_out(const lag_problem *pb, double *room, JointFriction *w) {
  const lag_model *m = pb->model;
  w->n = 0;
  for (int k = 0; k < m->nmodes; k++) w->n += is_surface(pb, k) != 0;
  size_t n = (size_t)w->n, ns = (size_t)m->nswitch, ny = (size_t)pb->n;
  double **const parts[] = {&w->mode, &w->sticks, &w->at, &w->bound, &w->response, &w->before, &w->centre, &w->was,
                            &w->entry, &w->change, &w->stride, &w->slip, &w->other, &w->d, &w->x};
  const size_t sizes[] = {n, n, n, n, n, n, n, n, n, n, n, ns, ns, n * ny, ny};
  return w->n ? lag_workspace_slice(room, sizeof sizes / sizeof *sizes, parts, sizes) : 0;
}

size_t lag_joint_friction_size(const lag_problem *pb) { return lay_out(pb, NULL, &(JointFriction){0}); }

JointFriction lag_joint_friction(const lag_problem *pb, double *room) {
  JointFriction w = {0};
  lay_out(pb, room, &w);
  for (int k = 0, j = 0; j < w.n; k++)
    if (is_surface(pb, k)) w.at[j++] = k;
  return w;
}

/* Switch of surface j, and its mode for the model. */
static int switch_of(const JointFriction *w, int j) { return (int)w->at[j]; }
static double *held(const JointFriction *w, lag_problem *pb, int j) {
  return &pb->hold[pb->model->nu + switch_of(w, j)];
}

static void hold(const JointFriction *w, lag_problem *pb, int j, double mode) { w->mode[j] = *held(w, pb, j) = mode; }

/* g[nswitch] := the switching functions for coordinates y, velocities and states x. */
static int slips_at(lag_problem *pb, double t, const double *y, const double *x, double *g) {
  const lag_model *m = pb->model;
  int rc = lag_inputs(pb, t);
  rc = rc ? rc : m->switch_values(m, t, y, x + m->nq, x + 2 * m->nq, pb->p, pb->u, g, pb->work);
  return rc ? lag_step_refused(pb, rc, t) : 0;
}

int lag_joint_friction_begin(JointFriction *w, lag_problem *pb, double t, const double *y) {
  const lag_model *m = pb->model;
  for (int j = 0; j < w->n; j++) {
    w->entry[j] = *held(w, pb, j);
    hold(w, pb, j, w->mode[j]);
  }
  int rc = slips_at(pb, t, y, y, w->slip);
  if (rc) return rc;
  if (m->switch_grips) rc = m->switch_grips(m, t, y, y + m->nq, y + 2 * m->nq, pb->p, pb->u, w->other, pb->work);
  for (int j = 0; j < w->n && rc == 0; j++) {
    int k = switch_of(w, j), rests = w->sticks[j] != 0.0 || w->slip[k] == 0.0;
    w->before[j] = w->slip[k];
    w->change[j] = w->stride[j] = 0;
    w->bound[j] = m->switch_grips && rests && w->other[k] > 1 ? w->other[k] : 1;
  }
  return rc ? lag_step_refused(pb, rc, t) : 0;
}

void lag_joint_friction_back(JointFriction *w, lag_problem *pb) {
  for (int j = 0; j < w->n; j++) *held(w, pb, j) = w->entry[j];
}

int lag_joint_friction_response(JointFriction *w, lag_problem *pb, double tm, double t, double h, const double *mid,
                                const double *x) {
  int n = pb->n, rc = 0;
  for (int j = 0; j < w->n && rc == 0; j++) {
    double mode = w->mode[j], *d = w->d + j * n, *at = w->x;
    hold(w, pb, j, -1);
    rc = lag_step_rhs(pb, tm, mid, at);
    hold(w, pb, j, 1);
    rc = rc ? rc : lag_step_rhs(pb, tm, mid, d);
    hold(w, pb, j, mode);
    for (int i = 0; i < n && rc == 0; i++) {
      d[i] = 0.5 * (d[i] - at[i]);
      at[i] = x[i] + h * d[i];
    }
    rc = rc ? rc : slips_at(pb, t, mid, x, w->slip);
    rc = rc ? rc : slips_at(pb, t, mid, at, w->other);
    w->response[j] = w->other[switch_of(w, j)] - w->slip[switch_of(w, j)];
  }
  return rc;
}

static int fail(lag_problem *pb, double t, int k, const char *what) {
  snprintf(pb->words, sizeof pb->words, "the dry friction of `%s` %s", pb->model->switches[k].text, what);
  pb->detail = pb->words;
  return lag_step_failed(pb, LAG_EMETHOD, t);
}

/* End of a step: velocities and states x at time t, from its middle. */
typedef struct StepEnd {
  JointFriction *of;
  lag_problem *pb;
  double t, h, *x;
  const double *mid;
} StepEnd;

static int end_slip(void *context, int j, double *slip) {
  const StepEnd *e = context;
  int rc = slips_at(e->pb, e->t, e->mid, e->x, e->of->slip);
  *slip = e->of->slip[switch_of(e->of, j)];
  return rc;
}

static void change_mode(void *context, int j, double mode) {
  const StepEnd *e = context;
  JointFriction *w = e->of;
  double by = mode - w->mode[j];
  for (int i = e->pb->nq; i < e->pb->n; i++) e->x[i] += e->h * by * w->d[j * e->pb->n + i];
  hold(w, e->pb, j, mode);
}

int lag_joint_friction_solve(JointFriction *w, lag_problem *pb, double t, double h, int struck, const double *mid,
                             double *x, double *moved) {
  StepEnd end = {w, pb, t, h, x, mid};
  double size;
  int j;
  memcpy(w->was, w->mode, (size_t)w->n * sizeof *w->was);
  for (int k = 0; k < w->n; k++) w->centre[k] = struck ? -w->before[k] / 2 : 0;
  const lag_surfaces s = {w->n,        end_slip, change_mode, &end,    DBL_EPSILON,
                          w->response, w->bound, w->centre,   w->mode, w->sticks};
  int rc = lag_surface_sweeps(&s, &size, &j);
  if (rc == LAG_SURFACE_INFINITE) return fail(pb, t, switch_of(w, j), "has no finite values");
  if (rc == LAG_SURFACES_DISAGREE)
    return fail(pb, t, switch_of(w, j), "and others find no forces that agree: take smaller steps");
  if (rc) return rc;
  *moved = 0;
  for (int k = 0; k < w->n; k++) *moved = fmax(*moved, fabs((w->mode[k] - w->was[k]) * w->response[k]));
  *moved = size > 0 ? *moved / size : 0;
  return 0;
}

int lag_joint_friction_note(JointFriction *w, lag_problem *pb, double t, const double *mid, const double *x) {
  int rc = slips_at(pb, t, mid, x, w->slip);
  for (int j = 0; j < w->n && rc == 0; j++) {
    w->sticks[j] = fabs(w->slip[switch_of(w, j)]) <= 1e-9 * fabs(w->response[j]);
    /* 1 is the mode of a body that slips */
    if (w->sticks[j] != 0.0 && fabs(w->mode[j]) == 1.0) *held(w, pb, j) *= 1 - DBL_EPSILON;
  }
  return rc;
}

void lag_joint_friction_lengthen(JointFriction *w, lag_problem *pb) {
  for (int j = 0; j < w->n; j++) {
    double change = w->mode[j] - w->was[j];
    int goes_on = change * w->change[j] > 0 && fabs(change) >= fabs(w->change[j]) / 2;
    w->stride[j] = goes_on ? fmin(2 * w->stride[j] + 1, 1e6) : 0;
    w->change[j] = change;
    if (!goes_on) continue;
    double to = w->mode[j] + w->stride[j] * change;
    hold(w, pb, j, fabs(to) > w->bound[j] ? copysign(1, to) : to);
  }
}

void lag_joint_friction_carry(const JointFriction *w, const lag_problem *pb, double part, double *x) {
  for (int j = 0; j < w->n; j++)
    for (int i = pb->nq; i < pb->n; i++) x[i] += part * (w->mode[j] - w->was[j]) * w->d[j * pb->n + i];
}
