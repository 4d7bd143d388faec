/* Step-size search of equal steps, and of radau, at positions where constraints become dependent, as of bars that come to lie in one line.
 * Enters: a step to make; leaves: that step, of the method's own size, or of another where that ends badly.
 *
 * Several motions meet in a singular position. Where a step ends within rounding of it, the velocities that constraints allow there are any
 * mixture of those motions; where a step ends near it on another branch, the mean of the velocities at its ends is not the displacement over the
 * time. A slightly shorter or longer step passes. Where no size helps the run ends; without that a rhomb went on with another energy.
 *
 * rk45 and dop853 choose their end points by their own estimates (methods/embedded.c), except with adapt=off. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"

enum { TRIES = 8, FEW = 32, MOST_UNLOOKED = 16 };

/* Limits of independence: at the end of a step; for examining a step. Limits of the detour: another size is tried; the run ends. hopeless: the
 * badness at which the run of an adaptive method ends. */
static const double least_apart = 1e-4, near_by = 0.1, doubtful = 0.02, wrong = 0.2, hopeless = 10;

/* Detour of a step: |displacement/dt - mean of the velocities at its ends|, relative to these velocities; of order step^2 where the motion is
 * smooth. */
static double detour(const lag_problem *pb, double dt, const double *y0, const double *y)
{
  const int nq = pb->nq;
  double most = 0;

  for (int i = 0; i < nq; i++) {
    double off = fabs((y[i] - y0[i]) / dt - (y[nq + i] + y0[nq + i]) / 2);
    if (off > most * fmax(fabs(y[nq + i]), fabs(y0[nq + i]))) { /* else velocities of the same unit cannot make it larger */
      double size = fmax(lag_unit_magnitude(pb, y + nq, i), lag_unit_magnitude(pb, y0 + nq, i));
      most = size > 0 ? fmax(most, off / size) : most;
    }
  }
  return most;
}

/* Independence at y; sets the number of steps until the next look: a quarter of those that would lead near a dependent position, at the pace of
 * the last ones, since a look costs as much as a step of rk4. With more than FEW constraints only steps whose velocities disagree are looked at:
 * in a long chain the weakest constraint is mostly below near_by (50 four-bars by rk4: three times as long). */
static double look(Run *r, lag_problem *pb, double t, const double *y)
{
  int k;
  double s = lag_independence(pb, t, y, &k), pace = fabs(s - r->apart) / (r->steps_since_rank + 1);

  r->steps_until_rank = s > near_by ? fmin(MOST_UNLOOKED, floor((s - near_by) / (4 * pace + DBL_MIN))) : 0;
  r->apart = s;
  r->steps_since_rank = 0;
  return s;
}

/* Badness of the end s->y of a step from s->now at t0: 0 good, more than 1 where another size may be better. *way: its detour, where an end is
 * near a dependent position. */
static double badness(lag_sim *s, double t0, double t, double *way)
{
  lag_problem *pb = &s->pb;
  int k, dear = pb->model->constraints->n > FEW;

  *way = detour(pb, t - t0, s->now, s->y);
  if (*way <= doubtful && (dear || s->run->steps_until_rank > 0)) {
    s->run->steps_until_rank -= s->run->steps_until_rank > 0;
    s->run->steps_since_rank++;
    return 0;
  }
  double apart = look(s->run, pb, t, s->y), near = apart;
  if (*way > doubtful && !(near < near_by)) { /* it may have begun near one and been thrown off */
    near = lag_independence(pb, t0, s->now, &k);
  }
  *way = near < near_by ? *way : 0;
  double at = apart < least_apart && lag_independence(pb, t0, s->now, &k) >= least_apart ? least_apart / fmax(apart, 1e-20) : 0;
  return fmax(at, *way / doubtful);
}

/* One step of the method; LAG_EDOMAIN where it crosses a pole of the constraints. */
static int one_step(lag_sim *s, double *t, double t_stop)
{
  double t0 = *t;
  int rc = s->method->step(s->method_work, &s->pb, t, s->y, t_stop);

  return rc ? rc : lag_crosses_constraint_pole(&s->pb, t0, s->now, *t, s->y) ? LAG_EDOMAIN : LAG_OK;
}

/* One step of another size, stretched by `stretch`, from the state before the step. */
static int try_step(lag_sim *s, const double *was, size_t bytes, double *t, double t_stop, double stretch)
{
  double rejected = s->pb.rejected;

  memcpy(s->method_work, was, bytes);
  lag_copy(s->pb.n, s->now, s->y);
  *t = s->run->t;
  s->pb.detail = NULL;
  s->pb.stretch = stretch;
  int rc = one_step(s, t, t_stop);
  s->pb.stretch = 0;
  s->pb.rejected = rejected;
  return rc;
}

/* Reports that the step continues another motion, whatever its size. */
static int say_wrong(lag_sim *s, double t)
{
  lag_problem *pb = &s->pb;
  char line[32];
  int k;
  double apart = lag_independence(pb, t, s->y, &k);
  const lag_constraint *weakest = k >= 0 ? &pb->model->constraints->of[k] : NULL;

  if (weakest) {
    snprintf(pb->words, sizeof pb->words, "several motions meet here, and no step continues the present one: constraint %s%s is within %.1g of "
             "being redundant; rk45 and dop853 may pass",
             weakest->name, lag_line_text(weakest, line), apart);
    pb->detail = pb->words;
  }
  pb->bad_t = t;
  lag_copy(pb->n, s->now, s->y);
  return LAG_EMETHOD;
}

/* Whether a step that failed near a dependent position may succeed with another size. */
static int may_pass(lag_sim *s, int rc)
{
  int k;

  return (rc == LAG_EMETHOD || rc == LAG_ENAN || rc == LAG_EDOMAIN || rc == LAG_ESINGULAR) &&
         lag_independence(&s->pb, s->run->t, s->now, &k) < near_by;
}

/* Whether the method makes steps of another size on request. */
static int stretches(const lag_sim *s)
{
  const lag_method *m = s->method;
  int i = 0;

  if (!s->pb.model->constraints || !(m->flags & LAG_METHOD_STRETCHES)) {
    return 0;
  }
  while (m->flags & LAG_METHOD_LANDS && i < m->noptions && strcmp(m->options[i].name, "adapt") != 0) {
    i++;
  }
  return !(m->flags & LAG_METHOD_LANDS) || (i < m->noptions && s->options[i] != 0.0);
}

int lag_resized_step(lag_sim *s, double *t, double t_stop)
{
  double way = 0, bad = 0, t0 = *t;

  if (!stretches(s)) {
    return s->method->step(s->method_work, &s->pb, t, s->y, t_stop);
  }
  double *const was = s->method_work + s->nwork;
  const size_t bytes = s->nwork * sizeof *was;
  memcpy(was, s->method_work, bytes);
  int rc = one_step(s, t, t_stop);
  bad = rc ? may_pass(s, rc) ? HUGE_VAL : 0 : badness(s, t0, *t, &way);
  if (!(bad > 1)) {
    return rc;
  }
  double best = 0, least = bad, stretch = 0;
  for (int k = 0; k < TRIES && least > 1; k++) { /* 1/1.25, 1.25, 1/1.25^2, 1.25^2, ... */
    stretch = pow(1.25, k % 2 ? (k + 1) / 2 : -(k + 2) / 2) - 1;
    int failed = try_step(s, was, bytes, t, t_stop, stretch);
    bad = failed ? HUGE_VAL : badness(s, t0, *t, &way);
    s->pb.rejected++;
    if (bad < least) {
      least = bad;
      best = stretch;
    }
  }
  if (best != stretch || least > 1) {
    rc = try_step(s, was, bytes, t, t_stop, best);
    if (rc == 0) {
      badness(s, t0, *t, &way);
    }
  } else {
    rc = 0;
  }
  int lost = least > hopeless && s->method->flags & LAG_METHOD_ADAPTIVE; /* an adaptive method would shrink its steps into the position */
  return rc == 0 && (way > wrong || lost) ? say_wrong(s, *t) : rc;
}
