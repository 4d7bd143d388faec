/* The tangent of a run over an event that changes the state, from y to y+ = R(t, y) where g(t, y) = 0. Enters: small
 * changes before it; leaves: those behind it. Holds: the event's time moves with y. With the rates f and f+ before and
 * after it, small changes are multiplied by the saltation matrix
 *   S = R_y + (f+ - R_y f - R_t) g_y / (g_y f + g_t):
 * R.I. Leine, H. Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems (2004), ch. 7, DOI
 * 10.1007/978-3-540-44398-8. At an impact of a contact R_y, R_t and derivatives by
 * parameters are differences of the impact law; where it opens without a jump of the state, S = 1, as the rates do not
 * jump. Where a contact with friction stays closed, or one after ever faster impacts, the run with a tangent fails. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/tangent.h"
#include "numeric/dense.h"

static int refuse(lag_sim *s, int k, const char *why) {
  return lag_fail(s, LAG_EMETHOD,
                  "event %s changes the state at t = %s s: %s; take a scene without it, or end the run before",
                  s->scene->model->ev[k].name, LAG_TEXT(s->run->t), why);
}

typedef struct Jump {
  /* entries; S[n n]; gradient of g and g_t; R_t; f and f+; copies of the tangent and of S; changes of g and R by the
   * parameter of each column, [k] and [n k] */
  double *d, *S, *g, *Rt, *before, *after, *Y, *copy, *g_by, *R_by;
} Jump;

static Jump jump_layout(const lag_sim *s) {
  int n = s->pb.n;
  double *x = s->tangent_jump;
  Jump j = {.d = x};
  j.S = j.d + lag_tangent_jumps(s);
  j.g = j.S + n * n;
  j.Rt = j.g + n + 1;
  j.before = j.Rt + n + 1;
  j.after = j.before + n + 1;
  j.Y = j.after + n + 1;
  j.copy = j.Y + n * s->tangent_columns;
  j.g_by = j.copy + n * n;
  j.R_by = j.g_by + s->tangent_columns;
  return j;
}

/* S := R_y, and R_t, gradient of g and g_t of event k. 0: the model lists none. */
static int collect_derivatives(const lag_sim *s, int k, const Jump *j) {
  const lag_linear *l = s->scene->model->linear;
  int n = s->pb.n, listed = 0;
  memset(j->S, 0, (size_t)(n * n) * sizeof(double));
  memset(j->Rt, 0, (size_t)n * sizeof(double));
  memset(j->g, 0, (size_t)(n + 1) * sizeof(double));
  for (int i = 0; i < n; i++) j->S[i * n + i] = 1;
  for (int e = 0; e < lag_tangent_jumps(s); e++) { /* each component that is set has an entry for itself */
    const lag_jump *at = &l->jump[e];
    if (at->event == k) {
      double *to = at->row < 0 ? &j->g[at->col] : at->col < n ? &j->S[at->row * n + at->col] : &j->Rt[at->row];
      *to = j->d[e];
      listed = 1;
    }
  }
  return listed;
}

/* Y := S Y; returns whether it is finite. */
static int apply_saltation(lag_sim *s, const Jump *j) {
  int n = s->pb.n, k = s->tangent_columns;
  memcpy(j->Y, s->tangent, lag_tangent_block(s) * sizeof(double));
  memset(s->tangent, 0, lag_tangent_block(s) * sizeof(double));
  for (int i = 0; i < n; i++)
    for (int c = 0; c < n; c++)
      for (int b = 0; b < k; b++) s->tangent[i * k + b] += j->S[i * n + c] * j->Y[c * k + b];
  return lag_not_finite(n * k, s->tangent) < 0;
}

/* R_by := what parameters add to the tangent behind event k, with the gain of each component for a later event: the
 * event's delay is -g_by/rate, of a kick that of its number of periods. */
static int parameters_at_jump(lag_sim *s, int k, const Jump *j, const double *gain, double rate) {
  int n = s->pb.n, columns = s->tangent_columns, kick = lag_is_kick(s->scene->model, k), rc;
  double *there = j->copy;
  if ((rc = lag_action_by_parameters(s, k, there, j->R_by)) != 0) return rc;
  if ((rc = lag_event_by_parameters(s, k, j->g_by)) != 0) return rc;
  if (kick) { /* g is the period */
    if ((rc = lag_events_eval(s, s->run->t, s->now, s->g1)) != 0) return rc;
    rate = -s->g1[k] / (s->run->t - s->scene->t0 + s->kicks_late);
  }
  for (int i = 0; i < n; i++)
    for (int c = 0; c < columns; c++) j->R_by[i * columns + c] += gain[i] * j->g_by[c] / rate;
  return LAG_OK;
}

/* log |det S|, in `a`, a copy of S. */
static double log_det(int n, const double *S, double *a) {
  double log_of = 0;
  memcpy(a, S, (size_t)(n * n) * sizeof *a);
  if (lag_eliminate((size_t)n, 0, a, a)) return -HUGE_VAL;
  for (int c = 0; c < n; c++) log_of += log(fabs(a[c * n + c]));
  return log_of;
}

static const char either_order[] =
    "another event does so at the same time, and neighbouring motions may meet the two in either order";

/* NULL, or why an event has no saltation matrix. more: another event happens at the same time. */
static const char *jump_lacks(const lag_model *m, int more) {
  return m->constraints ? "what constraints make of its effect has no derivative yet"
         : !m->linear
             ? "its effect on neighbouring motions needs derivatives, which `lagc build --with linear` builds in"
         : more ? either_order
                : NULL;
}

/* ---- Impacts of contacts */

/* State, besides y, that the search for impacts changes: signals of contacts, inputs, events that are due. */
typedef struct Strike {
  double *hold, *root, *u, *there, *slope; /* [nu], [nev + nmodes], [nu], [n]; gradient of the gap, and its rate */
  double *after;                           /* [nu]: hold behind the impact, which may close contacts */
} Strike;

/* there := the state after impact k. The search leaves no trace. */
static int impact_at(lag_sim *s, int k, const Strike *w) {
  const lag_model *m = s->scene->model;
  int rc = lag_contact_resolve(s, w->there, NULL, k, 0);
  memcpy(s->hold, w->hold, (size_t)m->nu * sizeof *w->hold);
  memcpy(s->root, w->root, (size_t)lag_watched(s) * sizeof *w->root);
  memcpy(s->pb.u, w->u, (size_t)m->nu * sizeof *w->u);
  return rc;
}

/* column[n] := change of the state after impact k along component i of the state before, or of t for i = n, by central
 * differences of order 4. */
static int impact_slope(lag_sim *s, int k, int i, const Strike *w, double *column) {
  const double part = 0x1p-9;
  int n = s->pb.n, rc = LAG_OK;
  double t = s->run->t, step = fabs(s->run->step_t1 - s->run->step_t0),
         h = part * (i < n ? lag_difference_scale(&s->pb, s->now, i) : step);
  memset(column, 0, (size_t)n * sizeof *column);
  for (int j = -2; j <= 2 && rc == LAG_OK; j++) {
    if (j == 0) continue;
    memcpy(w->there, s->now, (size_t)n * sizeof *w->there);
    if (i < n) w->there[i] += j * h;
    s->run->t = i == n ? t + j * h : t;
    rc = impact_at(s, k, w);
    for (int c = 0; c < n; c++) column[c] += (j % 2 ? 8 : -1) * (j < 0 ? -1 : 1) / 12.0 * w->there[c] / h;
  }
  s->run->t = t;
  return rc;
}

/* Adds to the tangent behind impact k what parameters change there: the impact itself, and by gain/rate its time. */
static int impact_by_parameters(lag_sim *s, int k, const Strike *w, const double *gain, double rate, double *g_by) {
  const lag_parameter_columns *by = s->pb.by;
  int n = s->pb.n, columns = s->tangent_columns, rc = lag_event_by_parameters(s, k, g_by);
  for (int j = 0; by && j < by->n && rc == LAG_OK; j++) {
    double *to = s->tangent + by->column[j];
    for (int c = 0; c < n; c++) to[c * columns] += gain[c] * g_by[by->column[j]] / rate;
    LAG_EACH_DIFFERENCE(step) {
      memcpy(w->there, s->now, (size_t)n * sizeof *w->there);
      lag_use_parameters(s, j, step);
      rc = rc ? rc : impact_at(s, k, w);
      lag_use_parameters(s, 0, 0);
      for (int c = 0; c < n; c++) to[c * columns] += lag_difference_weight(step) * w->there[c] / by->h[j];
    }
  }
  return rc;
}

/* S := saltation matrix of impact k, with room for the rates. *rate := the speed of the gap. */
static int impact_saltation(lag_sim *s, int k, const Strike *w, const Jump *j, double *rate) {
  int n = s->pb.n, rc = lag_rhs(&s->pb, s->run->t, s->yb, j->after);
  Corner corner = {.there = w->there, .gradient = j->g, .g = w->slope};
  memcpy(s->hold, w->hold, (size_t)s->pb.model->nu * sizeof *s->hold);
  rc = rc ? rc : lag_rhs(&s->pb, s->run->t, s->now, j->before);
  *rate = 0;
  for (int i = 0; i <= n && rc == LAG_OK; i++) {
    rc = lag_event_slope(s, &corner, k, i, &j->g[i]);
    rc = rc ? rc : impact_slope(s, k, i, w, j->Rt);
    for (int c = 0; c < n; c++) {
      if (i < n) j->S[c * n + i] = j->Rt[c];
      j->after[c] -= j->Rt[c] * (i < n ? j->before[i] : 1);
    }
    *rate += j->g[i] * (i < n ? j->before[i] : 1);
  }
  for (int i = 0; i < n; i++)
    for (int c = 0; c < n; c++) j->S[i * n + c] += j->after[i] * j->g[c] / *rate;
  return rc;
}

/* Whether impact k alone, without others that would follow it ever faster, leads to the state yb. */
static int is_whole(lag_sim *s, int k, const Strike *w) {
  double size = 0, far = 0;
  memcpy(s->hold, w->hold, (size_t)s->pb.model->nu * sizeof *s->hold);
  memcpy(w->there, s->now, (size_t)s->pb.n * sizeof *w->there);
  int rc = impact_at(s, k, w);
  for (int i = s->pb.nq; i < s->pb.n; i++)
    size = fmax(size, fabs(s->now[i])), far = fmax(far, fabs(w->there[i] - s->yb[i]));
  memcpy(s->hold, w->after, (size_t)s->pb.model->nu * sizeof *s->hold);
  return rc == LAG_OK && far <= 1e-12 * size;
}

/* Y := that behind impact k. */
static int strike(lag_sim *s, int k, int more) {
  const lag_model *m = s->scene->model;
  size_t n = (size_t)s->pb.n, nu = (size_t)m->nu, watched = (size_t)lag_watched(s),
         columns = (size_t)s->tangent_columns;
  double rate, calls = s->pb.rhs_calls, *room;
  if (more) return refuse(s, k, either_order);
  int rc = lag_tangent_carry(s);
  if (rc) return rc;
  room = calloc(3 * nu + 2 * watched + 5 * (n + 1) + (n + 1) * columns + 2 * n * n, sizeof *room);
  if (!room) return LAG_ENOMEM;
  Strike w = {.hold = room, .after = room + nu, .root = room + 2 * nu};
  w.u = w.root + watched;
  w.there = w.u + nu;
  w.slope = w.there + n + 1;
  Jump j = {.g = w.slope + watched};
  j.Rt = j.g + n + 1;
  j.before = j.Rt + n + 1;
  j.after = j.before + n + 1;
  j.Y = j.after + n + 1;
  j.S = j.Y + n * columns;
  j.copy = j.S + n * n;
  j.g_by = j.copy + n * n;
  memcpy(w.hold, s->hold_before, nu * sizeof *room);
  memcpy(w.after, s->hold, nu * sizeof *room);
  memcpy(w.root, s->root, watched * sizeof *room);
  memcpy(w.u, s->pb.u, nu * sizeof *room);
  if (!is_whole(s, k, &w))
    rc = refuse(s, k, "the contact closes after ever faster impacts, and neighbouring motions make others");
  rc = rc ? rc : impact_saltation(s, k, &w, &j, &rate);
  s->pb.rhs_calls = calls;
  if (rc == LAG_OK) s->tangent_log += log_det((int)n, j.S, j.copy);
  if (rc == LAG_OK && (lag_event_touches(s, k, rate) || !apply_saltation(s, &j)))
    rc = refuse(s, k, "the motion only touches it, and neighbouring motions may miss it");
  rc = rc ? rc : impact_by_parameters(s, k, &w, j.after, rate, j.g_by);
  memcpy(s->hold, w.after, nu * sizeof *room);
  free(room);
  return rc || !s->record ? rc : lag_record_jump(s);
}

int lag_tangent_jump(lag_sim *s, int k, int more) {
  const lag_model *m = s->scene->model;
  lag_problem *pb = &s->pb;
  int n = pb->n, nq = pb->nq;
  double t = s->run->t, rhs_calls = pb->rhs_calls, rate = 0;
  if (!s->tangent) return LAG_OK;
  if (lag_contact_of(m, k)) return strike(s, k, more);
  const char *lacks = jump_lacks(m, more);
  if (lacks) return refuse(s, k, lacks);
  Jump j = jump_layout(s);
  if (lag_tangent_jumps(s) && (lag_inputs(pb, t) ||
                   m->linear->jumps(m->linear, t, s->now, s->now + nq, s->now + 2 * nq, s->p, s->u, j.d, s->work)))
    return refuse(s, k, "its derivatives cannot be computed");
  if (!lag_tangent_jumps(s) || !collect_derivatives(s, k, &j)) {
    return refuse(s, k, "it depends on an input, whose rate a model does not have"); /* the compiler lists all others */
  }
  int rc = lag_tangent_carry(s);
  rc = rc ? rc : lag_rhs(pb, t, s->now, j.before);
  lag_switch_set_free(s, 1); /* the event may have changed branches */
  int after = rc ? rc : lag_rhs(pb, t, s->yb, j.after);
  lag_switch_set_free(s, 0);
  if (rc || after) return rc ? rc : refuse(s, k, "the rates there cannot be computed");
  pb->rhs_calls = rhs_calls;
  for (int c = 0; c < n; c++) rate += j.g[c] * j.before[c];
  rate += j.g[n];
  int kick = lag_is_kick(m, k), touches = !kick && lag_event_touches(s, k, rate);
  for (int i = 0; i < n; i++) {
    double gain = j.after[i] - j.Rt[i];
    for (int c = 0; c < n; c++) gain -= j.S[i * n + c] * j.before[c];
    for (int c = 0; c < n && !kick; c++) j.S[i * n + c] += gain * j.g[c] / rate; /* no state moves a kick */
    j.Rt[i] = gain;
  }
  if (s->pb.by && parameters_at_jump(s, k, &j, j.Rt, rate))
    return refuse(s, k, "its derivatives by parameters cannot be computed");
  s->tangent_log += log_det(n, j.S, j.copy);
  int finite = apply_saltation(s, &j);
  for (size_t i = 0; i < lag_tangent_block(s) && s->pb.by; i++) s->tangent[i] += j.R_by[i];
  if (!finite || touches) return refuse(s, k, "the motion only touches it, and neighbouring motions may miss it");
  return s->record ? lag_record_jump(s) : LAG_OK;
}
