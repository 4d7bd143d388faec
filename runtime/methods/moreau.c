/* moreau: time-stepping with contacts, in velocities and impulses. Enters: t, y; leaves: t + h, y one step later.
 * Holds: where no contact acts it is the symmetric method of order 2 that drifts half a step, kicks with the mean
 * velocity, and drifts again; sums over steps of q, v, z and t are compensated.
 *
 * Impacts are not located: all impulses of a step act at its middle, at once (kernels/contact_step.h). So impacts may
 * follow each other in ever shorter time, or come in any number; positions at an impact are off by at most half a
 * step's path, and an error of order 1 follows. Constraints are held by projection, and impulses respect them. J.J.
 * Moreau, in: Nonsmooth Mechanics and Applications (1988), 1, DOI 10.1007/978-3-7091-2624-0_1; M. Jean, Comput.
 * Methods Appl. Mech. Eng. 177 (1999) 235, DOI 10.1016/S0045-7825(98)00383-1. Dense output is the parabola of a
 * step, or two about an impact. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "kernels/dense_output.h"
#include "kernels/impulses.h"
#include "lag.h"
#include "methods/moreau_contacts.h"
#include "methods/moreau_families.h"
#include "methods/moreau_joint_friction.h"
#include "methods/steps.h"

static const lag_method_option options[] = {
    {"step", "size of the step [s]; 0: a 10000th of the scene's span, and with up to 8 contacts less by the tolerance",
     0, 0, HUGE_VAL, .choices = NULL}};

/* Head of the saved state; behind it arrays of n, 2 doubles a contact of the model, friction and tangential
 * restitution, and the room of dry friction; then a copy of all that and of pb->hold, and two ends of trials. */
typedef struct Moreau {
  lag_fixed_step step;
  double struck; /* the last step had an impact */
  double most;   /* longest step; 0: steps are of equal size */
  double half;   /* 1: the next step is the second half of a pair */
  double calm;   /* the step before an impact shortened it; 0: none did */
  double x[];
} Moreau;
enum { Y0, Y1, RATE, RATE0, MID, COMP, FREE, SIZE, ARRAYS };

/* Doubles that a trial must not change. */
static size_t kept_size(const lag_problem *pb) {
  return sizeof(Moreau) / sizeof(double) + ARRAYS * (size_t)pb->n + 2 * (size_t)pb->model->ncontacts +
         lag_joint_friction_size(pb);
}

static size_t held_size(const lag_problem *pb) { return (size_t)(pb->model->nu + pb->model->nmodes); }

static size_t work_size(const lag_problem *pb) { return 2 * kept_size(pb) + held_size(pb) + 2 * (size_t)pb->n; }

static double *law_of(Moreau *w, const lag_problem *pb) { return w->x + ARRAYS * pb->n; }
static JointFriction friction_of(Moreau *w, const lag_problem *pb) {
  return lag_joint_friction_of(pb, law_of(w, pb) + 2 * pb->model->ncontacts);
}

static void reset(void *work, lag_problem *pb) {
  Moreau *w = work;
  w->step.tc = w->struck = w->half = 0;
  memset(w->x + COMP * pb->n, 0, (size_t)pb->n * sizeof(double));
  if (pb->contacts) pb->contacts->due = 0;
}

static int init(void *work, lag_problem *pb, const double *opt) {
  Moreau *w = work;
  const lag_model *m = pb->model;
  int rc = 0;
  w->step.h = lag_step_size(pb, opt[0]);
  w->most = opt[0] > 0 || !lag_few_contacts(m) ? 0 : w->step.h;
  w->calm = 0;
  memset(law_of(w, pb) + 2 * m->ncontacts, 0, lag_joint_friction_size(pb) * sizeof(double));
  reset(work, pb);
  if (m->families) {
    lag_moreau_contacts_of(pb, NULL);
    rc = lag_families_check_start(pb, 0, pb->begin);
    if (rc) return rc;
  }
  if (!m->contact_laws) return LAG_OK;
  rc = lag_inputs(pb, 0);
  rc = rc ? rc
          : m->contact_laws(m, 0, pb->begin, pb->begin + pb->nq, pb->begin + 2 * pb->nq, pb->p, pb->u, pb->rub,
                            pb->work);
  for (int i = 0; i < 2 * m->ncontacts; i++) law_of(w, pb)[i] = pb->rub[3 * (i / 2) + i % 2];
  return rc ? lag_step_refused(pb, rc, 0) : LAG_OK;
}

static const char *refuses(const lag_model *m, const double *opt) {
  (void)opt;
  if (m->flags & LAG_MASSLESS && (m->families || !lag_moreau_has_others(m)))
    return "some coordinates have no inertia, and impulses would move them by any amount; dop853 takes such a model";
  if (lag_moreau_is_too_large(m))
    return "the impulses of its families of contacts take more memory than indices count: take fewer members";
  for (int i = 0; i < m->ncontacts; i++)
    if (m->contacts[i].law)
      return "it has a law of impact of its own, and one contact or more name another; dop853 follows these";
  return NULL;
}

/* Whether forces depend on no velocity, nor on states. */
static int is_explicit(const lag_problem *pb) {
  const lag_model *m = pb->model;
  return (m->flags & LAG_SEPARABLE) && !lag_moreau_has_others(m);
}

static int changes_too_much(lag_problem *pb, double t, const char *what) {
  pb->detail = what;
  return lag_step_failed(pb, LAG_EMETHOD, t);
}

static int meet(lag_problem *pb, const lag_kick *s, lag_moreau_contacts *w) {
  static const char others[] =
      "and others find no impulses that agree: take smaller steps, or look for bodies that are wedged";
  return lag_contacts_solve(w, s->y1 + s->nq) ? lag_moreau_contact_fails(pb, s->t, (int)w->all.of[0].contact, others)
                                              : 0;
}

#define LAG_FIND_CONTACTS(s, w) lag_moreau_find(pb, &(w)->contacts, (s)->t, (s)->h, (s)->mid, (s)->y1 + (s)->nq)
#define LAG_MEET(s, w) meet(pb, s, &(w)->contacts)
#define LAG_COUPLING_FAILS(t) \
  changes_too_much(pb, t, "impulses of contacts and dry friction do not agree: take smaller steps")
#include "kernels/coupled_friction.h"

#define LAG_LAWS lag_coupled_friction
#define LAG_KICK_RATES(t, y, w, k) lag_step_rhs(pb, t, y, k)
#define LAG_RESPONSES(s, w, turn) lag_coupled_respond(pb, w, s, turn)
#define LAG_OBEY(s, w) lag_coupled_obey(pb, w, s)
#define LAG_STRUCK(w) ((w)->contacts.impacts > 0)
#define LAG_ENOUGH(w, epsilon) lag_contacts_enough(&(w)->contacts, epsilon)
#define LAG_TERM_SIZE(w, i, rate) lag_joints_size((w)->joints, i, rate)
#define LAG_KICK_FAILS(t)                                                                                         \
  changes_too_much(pb, t,                                                                                         \
                   "forces that depend on velocities or states change too much within a step: take smaller steps, " \
                   "or radau")
#include "kernels/moreau_step.h"

/* From y, with no effect outside s and w after a failure but in pb->hold. */
static int kick(lag_problem *pb, const lag_kick *s, lag_coupled_friction *w, JointFriction *f, double t) {
  int rc = f->of.n ? lag_joints_begin(pb, &f->of, t, s->y) : 0;
  rc = rc ? rc : lag_moreau_kick(pb, s, w);
  if (rc || !f->of.n || !w->contacts.contacts) return rc;
  rc = lag_coupled_note(pb, &f->of, s);
  if (rc == 0) lag_joint_friction_stick(f, pb);
  return rc;
}

/* y := the end of the step from y0, on the constraints. */
static int drift(lag_problem *pb, const lag_kick *s, double *lost, double tb, const double *y0, double *y) {
  lag_kick_end(s, lost, y);
  pb->bad_index = lag_not_finite(pb->n, y);
  if (pb->bad_index >= 0) return lag_step_failed(pb, LAG_ENAN, tb);
  int rc = lag_project_step(pb, tb, y0, y, lost);
  return rc ? lag_step_not_projected(pb, rc, tb) : 0;
}

/* One step from y to next->tb; `noted`: statistics of contacts, which a trial leaves out. A failure changes nothing. */
static int advance(Moreau *w, lag_problem *pb, double t, const lag_next_step *next, int noted, double *y) {
  int n = pb->n, nq = pb->nq;
  double *x = w->x, *y0 = x + Y0 * n, *lost = x + COMP * n;
  JointFriction friction = friction_of(w, pb);
  lag_coupled_friction laws = {
      .contacts = lag_moreau_contacts_of(pb, law_of(w, pb)), .joints = &friction.of, .end = x + FREE * n};
  const lag_kick s = {nq, pb->nz, is_explicit(pb) && !friction.of.n, t + next->dt / 2, t + next->dt, next->dt,
                      DBL_EPSILON, y, x + MID * n, x + Y1 * n, x + RATE * n, x + RATE0 * n, x + SIZE * n};
  lag_kick_begin(&s, lost);
  memset(pb->guide_load, 0, 3 * (size_t)pb->model->nguides * sizeof(double));
  lag_joint_friction_enter(&friction, pb);
  lag_coupled_place(&laws, friction.coupled);
  int rc = kick(pb, &s, &laws, &friction, t);
  if (rc == 0) {
    memcpy(y0, y, (size_t)n * sizeof *y);
    rc = drift(pb, &s, lost, next->tb, y0, y);
    if (rc) memcpy(y, y0, (size_t)n * sizeof *y);
  }
  if (rc) {
    lag_joint_friction_back(&friction, pb);
    return rc;
  }
  w->struck = laws.contacts.impacts;
  if (noted && (pb->model->ncontacts || pb->model->families))
    lag_moreau_contacts_note(&laws.contacts, pb, next->dt, w->struck > 0 ? s.t : next->tb, y0 + nq, s.y1 + nq);
  memcpy(s.y1, y, (size_t)n * sizeof *y);
  return 0;
}

/* ---- steps by the tolerance */

/* end[n] := the state after `steps` steps h from y, with no other effect; *struck counts those with an impact. */
static int try_steps(Moreau *w, lag_problem *pb, double t, const double *y, double h, int steps, double *end,
                     int *struck) {
  size_t kept = kept_size(pb) * sizeof(double), held = held_size(pb) * sizeof(double);
  double *copy = (double *)(void *)w + kept_size(pb), *hold = copy + kept_size(pb);
  int rc = 0;
  memcpy(copy, w, kept);
  memcpy(hold, pb->hold, held);
  memcpy(end, y, (size_t)pb->n * sizeof *y);
  for (int k = 0; k < steps && rc == 0; k++) {
    double from = t + k * h * pb->dir;
    const lag_next_step next = {h * pb->dir, from + h * pb->dir, 0};
    rc = advance(w, pb, from, &next, 0, end);
    *struck += w->struck > 0;
  }
  memcpy(w, copy, kept);
  memcpy(pb->hold, hold, held);
  return rc;
}

/* Difference of one step of 2h and two of h, in parts of the tolerance; NaN where one fails. */
static double pair_error(Moreau *w, lag_problem *pb, double t, const double *y, double h, int *struck, int *rc) {
  const double rounding = 1e-13; /* of the impulses' sweeps */
  double *one = (double *)(void *)w + 2 * kept_size(pb) + held_size(pb), *two = one + pb->n, most = 0;
  *rc = try_steps(w, pb, t, y, 2 * h, 1, one, struck);
  *rc = *rc ? *rc : try_steps(w, pb, t, y, h, 2, two, struck);
  for (int i = 0; i < pb->n && *rc == 0; i++)
    most = fmax(most, fabs(two[i] - one[i]) / ((pb->tol + rounding) * (pb->size[i] + fabs(y[i]))));
  return *rc ? NAN : most;
}

/* Sets the step for the next two, which are not the same to the tolerance as one of twice the length if that would
 * take steps far shorter than the longest, above all in impacts, whose error falls as the step alone. */
static int find_step(Moreau *w, lag_problem *pb, double t, const double *y) {
  const double least = 1e-6, least_struck = 0x1p-8; /* of the longest step */
  if (w->calm > 0) w->step.h = w->calm;
  w->calm = 0;
  for (double before = w->step.h;; w->step.h /= 2) {
    int struck = 0, rc;
    double h = w->step.h, error = pair_error(w, pb, t, y, h, &struck, &rc);
    if (error <= 1 || h <= least * w->most || (struck && rc == 0 && h <= least_struck * w->most)) {
      if (rc) return rc;
      w->calm = struck ? before : error < 0.1 ? fmin(2 * h, w->most) : 0;
      return 0;
    }
    pb->rejected++;
  }
}

static int step(void *work, lag_problem *pb, double *t, double *y, double t_stop) {
  Moreau *w = work;
  lag_next_step next;
  int rc = w->most > 0 && w->half == 0.0 ? find_step(w, pb, *t, y) : 0;
  (void)t_stop;
  rc = rc ? rc : lag_fixed_step_begin(&w->step, pb, *t, &next);
  rc = rc ? rc : advance(w, pb, *t, &next, 1, y);
  if (rc) return rc;
  w->half = w->most > 0 && w->half == 0.0;
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
    LAG_METHOD_FUNCTIONS,
};
