/* moreau: time-stepping with contacts, in velocities and impulses. Enters: t, y; leaves: t + h, y one step later.
 * Holds: where no contact acts it is the symmetric method of order 2 that drifts half a step, kicks with the mean
 * velocity, and drifts again; sums over steps of q, v, z and t are compensated.
 *
 * Impacts are not located: all impulses of a step act at its middle, at once (moreau_contacts.c). So impacts may
 * follow each other in ever shorter time, or come in any number; positions at an impact are off by at most half a
 * step's path, and an error of order 1 follows. Constraints are held by projection, and impulses respect them. J.J.
 * Moreau, in: Nonsmooth Mechanics and Applications (1988), 1, DOI 10.1007/978-3-7091-2624-0_1; M. Jean, Comput.
 * Methods Appl. Mech. Eng. 177 (1999) 235, DOI 10.1016/S0045-7825(98)00383-1. Dense output is the parabola of a
 * step, or two about an impact. */
#include <float.h>
#include <string.h>

#include "kernels/dense_output.h"
#include "kernels/impulses.h"
#include "lag.h"
#include "methods/moreau_contacts.h"
#include "methods/moreau_joint_friction.h"
#include "methods/steps.h"

static const lag_method_option options[] = {LAG_STEP_OPTION};

/* Head of the saved state; behind it arrays of n, 2 doubles a contact of the model, friction and tangential
 * restitution, and the room of dry friction. */
typedef struct Moreau {
  lag_fixed_step step;
  double struck; /* the last step had an impact */
  double x[];
} Moreau;
enum { Y0, Y1, RATE, RATE0, MID, COMP, FREE, SIZE, ARRAYS };

static size_t work_size(const lag_problem *pb) {
  return sizeof(Moreau) / sizeof(double) + ARRAYS * (size_t)pb->n + 2 * (size_t)pb->model->ncontacts +
         lag_joint_friction_size(pb);
}

static double *law_of(Moreau *w, const lag_problem *pb) { return w->x + ARRAYS * pb->n; }
static JointFriction friction_of(Moreau *w, const lag_problem *pb) {
  return lag_joint_friction(pb, law_of(w, pb) + 2 * pb->model->ncontacts);
}

static void reset(void *work, lag_problem *pb) {
  Moreau *w = work;
  w->step.tc = w->struck = 0;
  memset(w->x + COMP * pb->n, 0, (size_t)pb->n * sizeof(double));
  if (pb->contacts) pb->contacts->due = 0;
}

static int init(void *work, lag_problem *pb, const double *opt) {
  Moreau *w = work;
  const lag_model *m = pb->model;
  int rc = 0;
  w->step.h = lag_step_size(pb, opt[0]);
  memset(law_of(w, pb) + 2 * m->ncontacts, 0, lag_joint_friction_size(pb) * sizeof(double));
  reset(work, pb);
  if (!m->contact_laws) return LAG_OK;
  rc = lag_inputs(pb, 0);
  rc = rc ? rc
          : m->contact_laws(m, 0, pb->begin, pb->begin + pb->nq, pb->begin + 2 * pb->nq, pb->p, pb->u, pb->rub,
                            pb->work);
  for (int i = 0; i < 2 * m->ncontacts; i++) law_of(w, pb)[i] = pb->rub[3 * (i / 2) + i % 2];
  for (int i = 0; i + 1 < m->ncontacts && rc == 0; i++) {
    if (m->contacts[i].is_tangent || !m->contacts[i + 1].is_tangent || !(pb->rub[3 * i] > pb->rub[3 * i + 3])) continue;
    pb->detail = "a static friction above that of slipping is not followed by moreau; dop853 follows it";
    return lag_step_failed(pb, LAG_EMETHOD, 0);
  }
  return rc ? lag_step_refused(pb, rc, 0) : LAG_OK;
}

static const char *refuses(const lag_model *m, const double *opt) {
  (void)opt;
  if (m->flags & LAG_MASSLESS)
    return "some coordinates have no inertia, and impulses would move them by any amount; dop853 takes such a model";
  for (int i = 0; i < m->ncontacts; i++)
    if (m->contacts[i].law)
      return "it has a law of impact of its own, and one contact or more name another; dop853 follows these";
  for (int i = 0; i < m->ncontacts; i++)
    if (m->contacts[i].conditional)
      return "constraints that hold while a condition is true are not followed; dop853 follows them";
  return NULL;
}

/* Whether forces depend on no velocity, nor on states. */
static int is_explicit(const lag_problem *pb) {
  const lag_model *m = pb->model;
  return (m->flags & LAG_SEPARABLE) && (!m->constraints || m->constraints->n == m->ncontacts);
}

/* Y1 := FREE with impulses of contacts and dry friction, which agree: in turns, until friction changes nothing more. */
static int agree(Moreau *w, lag_problem *pb, double tm, double t, double dt, MoreauContacts *contacts,
                 JointFriction *f) {
  enum { ROUNDS = 500 };
  /* of the largest slip, or of what friction changes: friction that follows it to its limit by many small steps */
  const double little = 1e-5;
  int n = pb->n, nq = pb->nq, rc = 0;
  double *y1 = w->x + Y1 * n, *free = w->x + FREE * n, moved = 0, before = 0;
  for (int round = 0; round < ROUNDS; round++) {
    memcpy(y1 + nq, free + nq, (size_t)(n - nq) * sizeof *y1);
    rc = lag_moreau_contacts_solve(contacts, pb, tm, y1 + nq);
    rc = rc ? rc : lag_joint_friction_solve(f, pb, t, dt, contacts->impacts > 0, w->x + MID * n, y1, &moved);
    if (rc || moved <= 64 * DBL_EPSILON || (round > 0 && moved <= 1e7 * DBL_EPSILON && moved >= before / 2)) return rc;
    lag_joint_friction_lengthen(f, pb);
    lag_joint_friction_carry(f, pb, dt, free);
    lag_joint_friction_carry(f, pb, 1, w->x + RATE0 * n);
    before = moved;
  }
  if (moved <= little) return 0;
  pb->detail = "impulses of contacts and dry friction do not agree: take smaller steps";
  return lag_step_failed(pb, LAG_EMETHOD, tm);
}

/* Y1: velocities and states at the end t of a step from y. Forces are those at the mean velocity; of a step with an
 * impact the mean of those at both ends, since the mean of velocities that jump is none that occurs. */
static int kick(Moreau *w, lag_problem *pb, double tm, double t, double dt, const double *y, MoreauContacts *contacts,
                JointFriction *f) {
  enum { TURNS = 100 };
  int n = pb->n, nq = pb->nq, meets = pb->model->ncontacts > 0, rc = 0;
  double *y1 = w->x + Y1 * n, *rate = w->x + RATE * n, *rate0 = w->x + RATE0 * n, *mid = w->x + MID * n,
         *size = w->x + SIZE * n, before = HUGE_VAL, moved;
  for (int turn = 0; turn < TURNS; turn++) {
    if ((rc = lag_step_rhs(pb, tm, mid, rate)) != 0) return rc;
    if (turn == 0) memcpy(rate0, rate, (size_t)n * sizeof *rate);
    for (int i = nq; i < n && contacts->impacts > 0; i++) rate[i] = (rate0[i] + rate[i]) / 2;
    for (int i = nq; i < n; i++) y1[i] = y[i] + dt * rate[i];
    if (f->n && turn == 0) rc = lag_joint_friction_response(f, pb, tm, t, dt, mid, y1);
    if (f->n && (turn == 0 || !meets) && rc == 0) {
      rc = lag_joint_friction_solve(f, pb, t, dt, 0, mid, y1, &moved);
      if (turn == 0) lag_joint_friction_carry(f, pb, 1, rate0);
    }
    if (meets && turn == 0 && rc == 0) rc = lag_moreau_contacts_find(contacts, pb, tm, dt, mid, y1 + nq, law_of(w, pb));
    memcpy(w->x + FREE * n, y1, (size_t)n * sizeof *y1);
    if (meets && rc == 0)
      rc = f->n ? agree(w, pb, tm, t, dt, contacts, f) : lag_moreau_contacts_solve(contacts, pb, tm, y1 + nq);
    if (rc || (is_explicit(pb) && !f->n)) return rc;
    for (int i = nq; i < n; i++) {
      size[i] = rate[i];
      /* at rest forces cancel: rounding is that of friction */
      for (int k = 0; k < f->n; k++) size[i] = fabs(size[i]) + fabs(f->d[k * n + i]);
    }
    const lag_moreau_ends ends = {dt, y, y1, size};
    double most = lag_moreau_mean(&ends, contacts->impacts > 0 ? 1 : 0.5, DBL_EPSILON, nq, pb->nz, mid);
    if (most <= 8 || (most <= 1e4 && most >= before / 2)) return LAG_OK;
    before = most;
  }
  pb->detail = "forces that depend on velocities or states change too much within a step: take smaller steps, or radau";
  return lag_step_failed(pb, LAG_EMETHOD, tm);
}

/* y := the end of the step from Y0, with compensated sums. */
static void drift(Moreau *w, const lag_problem *pb, double dt, double *y) {
  int n = pb->n, nq = pb->nq;
  const double *y0 = w->x + Y0 * n, *y1 = w->x + Y1 * n;
  double *lost = w->x + COMP * n;
  for (int i = 0; i < n; i++)
    y[i] = lag_compensated_sum(y0[i], i < nq ? dt / 2 * (y0[nq + i] + y1[nq + i]) : y1[i] - y0[i], &lost[i]);
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  Moreau *w = work;
  int n = pb->n, nq = pb->nq, rc;
  double *y0 = w->x + Y0 * n, *y1 = w->x + Y1 * n, *mid = w->x + MID * n;
  const double *lost = w->x + COMP * n;
  lag_next_step next;
  (void)t_stop;
  if ((rc = lag_fixed_step_begin(&w->step, pb, *t, &next)) != 0) return rc;
  MoreauContacts contacts = lag_moreau_contacts(pb);
  double tm = *t + next.dt / 2;
  memcpy(mid, y, (size_t)n * sizeof *y);
  for (int i = 0; i < nq; i++) mid[i] = y[i] + (lost[i] + next.dt / 2 * y[nq + i]);
  JointFriction friction = friction_of(w, pb);
  rc = friction.n ? lag_joint_friction_begin(&friction, pb, *t, y) : 0;
  rc = rc ? rc : kick(w, pb, tm, *t + next.dt, next.dt, y, &contacts, &friction);
  if (rc == 0 && friction.n && pb->model->ncontacts) rc = lag_joint_friction_note(&friction, pb, *t + next.dt, mid, y1);
  if (rc) {
    if (friction.n) lag_joint_friction_back(&friction, pb);
    return rc;
  }
  memcpy(y0, y, (size_t)n * sizeof *y);
  drift(w, pb, next.dt, y);
  pb->bad_index = lag_not_finite(n, y);
  rc = pb->bad_index >= 0 ? lag_step_failed(pb, LAG_ENAN, next.tb)
                          : lag_project_step(pb, next.tb, y0, y, w->x + COMP * n);
  if (rc) {
    memcpy(y, y0, (size_t)n * sizeof *y);
    if (friction.n) lag_joint_friction_back(&friction, pb);
    return rc == LAG_ENAN ? rc : lag_step_not_projected(pb, rc, next.tb);
  }
  w->struck = contacts.impacts;
  if (pb->model->ncontacts)
    lag_moreau_contacts_note(&contacts, pb, next.dt, contacts.impacts > 0 ? tm : next.tb, y0 + nq, y1 + nq);
  memcpy(y1, y, (size_t)n * sizeof *y);
  lag_fixed_step_end(&w->step, &next, t);
  return LAG_OK;
}

static void dense(void *work, lag_problem *pb, double t, double *y) {
  const Moreau *w = work;
  int n = pb->n;
  const lag_step_ends ends = {w->step.dt, w->x + Y0 * n, w->x + RATE * n, w->x + Y1 * n, NULL};
  lag_parabola_within(&ends, w->struck > 0, pb->nq, pb->nz, t - w->step.t0, y);
}

const lag_method lag_moreau = {
    .name = "moreau",
    .order = 2,
    .dense_order = 2,
    .doc = "time-stepping with contacts and friction by impulses, for many contacts or impacts. DOI "
           "10.1007/978-3-7091-2624-0_1",
    .flags = LAG_METHOD_CONSTRAINTS | LAG_METHOD_IMPULSES,
    .noptions = 1,
    .options = options,
    .refuses = refuses,
    .work_size = work_size,
    .init = init,
    .step = step,
    .dense = dense,
    .reset = reset,
};
