/* Detects runs without progress. Enters: a step that a method has made, from s->now to s->y; leaves: whether the run
 * is to end, and why.
 *
 * 1. Sliding: where a force jumps with the velocities, as dry friction does, and both sides lead back to the place,
 *   the motion stays there (Filippov's sliding mode); steps of any size would go back and forth for ever. Across a
 *   sign change of a switching function the derivative is taken on both sides of the surface; of a function that is
 *   nowhere negative, as |v|, at both ends of a step that leads past its zero. Equal steps may stay on one side with
 *   stages on both: by rk4 a body that sticks would creep for ever.
 * 2. Shrinking steps: near a position where constraints become dependent, with independence s, accelerations have an
 *   error of eps/s^2, and where the mass matrix is almost singular, of eps times its condition; a tolerance below that
 *   makes steps shrink in front of it, accepted one by one, for ever. So do places where a constraint or a force jumps
 *   with the position. Criterion: MOST steps advanced the time by less than 1e-5 of the run so far, at less than 1e-2
 *   of its mean pace (a fast event, as a stiff spring that is struck, takes some hundred steps); and there is one of
 *   these causes. Ten times in a row where it is the mass matrix: light bodies may pass such a place. The same of 1000
 *   restarts, by events, contacts, impacts and switches, whatever the cause: these would go on for ever.
 * 3. Equal steps longer than half a period: an implicit method keeps the energy of such an oscillation, and nothing
 *   else of it. The square of the frequency is estimated along a step as -(change of acceleration).(change of
 *   position)/|change of position|^2. It does not end the run; the report mentions it. */
#include <float.h>
#include <math.h>
#include <stdio.h>

#include "core/core.h"
#include "core/rhs.h"

enum { MOST = 10000 };

/* to[nswitch] := the switching functions at y, t. 0: they have values. */
static int sides_at(lag_sim *s, double t, const double *y, double *to) {
  const lag_model *m = s->scene->model;
  int rc = lag_inputs(&s->pb, t);
  rc = rc ? rc : m->switch_values(m, t, y, y + m->nq, y + 2 * m->nq, s->p, s->u, to, s->work);
  return rc || lag_not_finite(m->nswitch, to) >= 0;
}

/* to[n] := the state at fraction x of the line from now to y at t1; *t := its time. */
static void on_line(const lag_sim *s, double x, double t1, double *t, double *to) {
  for (int i = 0; i < s->pb.n; i++) to[i] = s->now[i] + x * (s->y[i] - s->now[i]);
  *t = s->run->t + x * (t1 - s->run->t);
}

/* Rate of switching function k along the flow at y, t; NaN: no value. Uses yb, yc. */
static double rate_of(lag_sim *s, int k, double t, double dt, const double *y) {
  double *now = s->sides + 2 * s->scene->model->nswitch, before, calls = s->pb.rhs_calls;
  if (lag_rhs(&s->pb, t, y, s->yb) || sides_at(s, t, y, now)) return NAN;
  s->pb.rhs_calls = calls;
  before = now[k];
  for (int i = 0; i < s->pb.n; i++) s->yc[i] = y[i] + dt * s->yb[i];
  return sides_at(s, t + dt, s->yc, now) ? NAN : (now[k] - before) / dt;
}

/* Whether a step of equal size has stayed on one side of a surface although its first derivative leads across and
 * the derivative there leads back: its path is not that of the derivatives at its ends, r0 and r1. */
static int equal_step_sticks(lag_sim *s, int k, double t, double dt) {
  const double part = 0.25;
  double first = s->sides[k], last = s->sides[k + s->scene->model->nswitch], whole = t - s->run->t, r0, r1;
  if (!(lag_equal_step(s) > 0) || !(first * (r0 = rate_of(s, k, s->run->t, dt, s->now)) * whole < 0) ||
      !(fabs(first) < fabs(r0 * whole)))
    return 0;
  for (int i = 0; i < s->pb.n; i++) {
    s->ya[i] = s->now[i] + whole * s->yb[i]; /* rate_of has left the derivative there */
  }
  r1 = rate_of(s, k, t, dt, s->y);
  return fabs(last - first - whole * (r0 + r1) / 2) > part * fabs(whole * r0) &&
         rate_of(s, k, t, dt, s->ya) * first * whole > 0;
}

/* Whether a motion that meets the surface of switching function k within the step to t stays on it. */
static int stays(lag_sim *s, int k, double t) {
  const double near = 0x1p-6;
  const double *first = s->sides, *last = first + s->scene->model->nswitch;
  double *at = s->sides + 2 * s->scene->model->nswitch, dt = near * (t - s->run->t), a = 0, b = 1, when = 0, r0, r1;
  if (s->scene->model->switches[k].nonnegative) {
    r0 = rate_of(s, k, s->run->t, dt, s->now) * s->pb.dir;
    r1 = rate_of(s, k, t, dt, s->y) * s->pb.dir;
    return r0 < 0 && r1 < 0 && first[k] < -r0 * fabs(t - s->run->t) && r1 < near * r0;
  }
  if (!(first[k] * last[k] < 0)) return first[k] * last[k] > 0 && equal_step_sticks(s, k, t, dt);
  for (int turn = 0, on_it = 0; turn < 60 && on_it < 4; turn++) {
    double mid = a + (b - a) * (on_it ? 0.3 + 0.1 * on_it : 0.5);
    on_line(s, mid, t, &when, s->ya);
    if (sides_at(s, when, s->ya, at)) return 0;
    on_it = at[k] == 0.0 ? on_it + 1 : 0; /* exactly on the surface, where sign(0) belongs to neither side */
    if (!on_it) *(at[k] * first[k] > 0 ? &a : &b) = mid;
  }
  on_line(s, a, t, &when, s->ya);
  r0 = rate_of(s, k, when, dt, s->ya) * s->pb.dir;
  on_line(s, b, t, &when, s->ya);
  r1 = rate_of(s, k, when, dt, s->ya) * s->pb.dir;
  return r0 * first[k] < 0 && r1 * last[k] < 0;
}

static int say_switch(lag_sim *s, int k, double t) {
  const lag_switch *c = &s->scene->model->switches[k];
  char line[32] = "";
  if (c->line) snprintf(line, sizeof line, " in line %d", c->line);
  return lag_note(&s->pb, LAG_ESTALL, t,
                  "it stays where %s is 0: the force of `%s`%s jumps there and pulls back from both sides, as dry "
                  "friction does on a "
                  "body that sticks, which is not supported; smooth the force, as tanh(v/w) for sign(v), or let an "
                  "event stop the run",
                  c->surface, c->text, line);
}

/* Criterion 1: a sliding motion. */
LAG_RARE int check_sliding(lag_sim *s, double t) {
  const lag_model *m = s->scene->model;
  if (sides_at(s, s->run->t, s->now, s->sides) || sides_at(s, t, s->y, s->sides + m->nswitch)) return LAG_OK;
  for (int k = m->nmodes; k < m->nswitch; k++)
    if (stays(s, k, t)) return say_switch(s, k, t);
  return LAG_OK;
}

/* The switching function without a mode near whose surface the motion has stayed: |value| < |rate| led. -1: none. */
static int hangs_at(lag_sim *s, double t, double led) {
  int k = s->scene->model->nswitch - 1;
  while (k >= s->scene->model->nmodes &&
         (sides_at(s, t, s->y, s->sides) || !(fabs(s->sides[k]) < fabs(rate_of(s, k, t, t - s->run->t, s->y)) * led)))
    k--;
  return k < s->scene->model->nmodes ? -1 : k;
}

/* Whether `most` steps or restarts, of `all`, hardly advanced the time from *since to t; *led := by how much.
 * `never`: of the whole run. */
static int crawls(const lag_sim *s, double *since, double t, double most, double all, double *led) {
  const double pace = 1e-5, mean = 1e-2, never = 1e-9;
  double gone = fabs(t - s->scene->t0);
  *led = fabs(t - *since);
  *since = t;
  return *led <= never * s->pb.span || (*led <= pace * gone && *led * all <= mean * most * gone);
}

int lag_restarts_stall(lag_sim *s, double *led) {
  const double most = 1000;
  Run *r = s->run;
  r->restarts++;
  return fmod(r->restarts, most) == 0 && crawls(s, &r->restart_since, r->t, most, r->restarts, led);
}

/* Criterion 2: shrinking steps. */
LAG_RARE int check_pace(lag_sim *s, double t) {
  enum { IN_A_ROW = 10 };
  const double dependent = 1e-2;
  Run *r = s->run;
  lag_problem *pb = &s->pb;
  double led;
  int k = -1, which;
  char line[32];
  r->creeps = crawls(s, &r->stall_since, t, MOST, r->steps, &led) ? r->creeps + 1 : 0;
  if (r->creeps < 1 || lag_equal_step(s) > 0) return 0;
  if (s->method->flags & LAG_METHOD_IMPULSES) return 0; /* its steps have a least size */
  double apart = pb->model->constraints ? lag_independence(pb, t, s->y, &k) : 1;
  int redundant = k >= 0 && apart <= dependent;
  if (!redundant && !(pb->model->flags & LAG_FIRST_ORDER) && r->creeps >= IN_A_ROW &&
      lag_mass_condition(pb, t, s->y, &which) > lag_sim_tolerance(s) / DBL_EPSILON) {
    return lag_note(pb, LAG_ESTEP, t,
                    "the last %d steps advanced the time by only %.3g s: accelerations have fewer digits here than the "
                    "tolerance asks for; take other coordinates, or a larger tolerance",
                    MOST, led);
  }
  if (!redundant && lag_facts(pb) & LAG_SMOOTH) return 0;
  int at = hangs_at(s, t, led);
  if (at >= 0) return say_switch(s, at, t);
  if (!redundant) {
    return lag_note(pb, LAG_ESTEP, t,
                    "the last %d steps advanced the time by only %.3g s: a force or a constraint jumps here, and the "
                    "motion does not leave "
                    "the place; smooth it, as sqrt(x^2 + w^2) for abs(x), or model the jump as a contact or an event",
                    MOST, led);
  }
  const lag_constraint *weakest = &pb->model->constraints->of[k];
  return lag_note(
      pb, LAG_ESTEP, t,
      "the last %d steps advanced the time by only %.3g s: constraint %s%s is within %.1g of being redundant, and no "
      "step is "
      "accurate to the tolerance; a larger tolerance, or steps of equal size (adapt=off, rk4, variational), may pass",
      MOST, led, weakest->name, lag_line_text(weakest, line), apart);
}

/* Criterion 3: counts equal steps longer than half a period. */
LAG_RARE void look_for_period(lag_sim *s, double t) {
  const double half_turn = 3.141592653589793;
  lag_problem *pb = &s->pb;
  double h = lag_equal_step(s), calls = pb->rhs_calls, square = 0, product = 0;
  if (!(h > 0) || pb->nq == 0 || lag_rhs(pb, s->run->t, s->now, s->ya) || lag_rhs(pb, t, s->y, s->yb)) {
    pb->rhs_calls = calls;
    return;
  }
  pb->rhs_calls = calls;
  for (int i = 0; i < pb->nq; i++) {
    double dx = s->y[i] - s->now[i];
    product -= dx * (s->yb[pb->nq + i] - s->ya[pb->nq + i]);
    square += dx * dx;
  }
  s->run->looks++;
  double rate = square > 0 && product > 0 ? sqrt(product / square) : 0;
  if (isfinite(rate) && rate * h > half_turn) {
    s->run->coarse++;
    s->run->period = 2 * half_turn / rate;
  }
}

int lag_detect_stall(lag_sim *s, double t) {
  Run *r = s->run;
  long long steps = (long long)r->steps + 1;
  int rc = 0;

  if (s->scene->model->nswitch > s->scene->model->nmodes) rc = check_sliding(s, t);
  if (rc == 0 && steps % MOST == 0) rc = check_pace(s, t);
  if (rc == 0 && (steps & (steps - 1)) == 0) { /* after 1, 2, 4, 8, ... steps */
    look_for_period(s, t);
  }
  return rc;
}
