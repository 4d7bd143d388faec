/* The tangent of a run over an event that changes the state, from y to y+ = R(t, y) where g(t, y) = 0. Enters: small
 * changes before it; leaves: those behind it. Holds: the event's time moves with y. With the rates f and f+ before and
 * after it, small changes are multiplied by the saltation matrix
 *   S = R_y + (f+ - R_y f - R_t) g_y / (g_y f + g_t):
 * R.I. Leine, H. Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems (2004), ch. 7, DOI
 * 10.1007/978-3-540-44398-8. With constraints and contacts R_y, R_t and derivatives by parameters are differences of
 * what the event does, from states on the constraints before it, with the contacts that stay closed, stick and slip
 * behind it: where these are others beside it there is no tangent. Where friction begins or ceases to hold, or a
 * contact opens, R = 1. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/tangent.h"
#include "numeric/dense.h"
#include "numeric/workspace.h"

static int refuse(lag_sim *s, int k, const char *why) {
  return lag_fail(s, LAG_EMETHOD,
                  "event %s changes the state at t = %s s: %s; take a scene without it, or end the run before",
                  s->scene->model->ev[k].name, LAG_TEXT(s->run->t), why);
}

typedef struct Jump {
  /* entries; S[n n]; gradient of g and g_t; R_t; f and f+; copies of the tangent and of S; changes of g and R by the
   * parameter of each column, [k] and [n k] */
  double *d, *S, *g, *Rt, *before, *after, *gain, *Y, *copy, *g_by, *R_by;
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
  return !m->linear
             ? "its effect on neighbouring motions needs derivatives, which `lagc build --with linear` builds in"
         : more ? either_order
                : NULL;
}

/* ---- Events of contacts and constraints */

/* State, besides y, that the search for impacts changes: signals of contacts, inputs, integrals, due events. */
typedef struct Strike {
  double *hold, *root, *u, *kept; /* [nu], [nev + nmodes], [nu], [constraints] */
  double *there, *behind, *slope; /* [n], [n]; gradient of the gap, and its rate */
  double *after;                  /* [nu]: hold behind the event, which may close contacts */
  double *delay, *other;          /* [columns] of the event, along each; [columns + events] scratch */
} Strike;

static void put_back(lag_sim *s, const Strike *w) {
  const lag_model *m = s->scene->model;
  memcpy(s->hold, w->hold, (size_t)m->nu * sizeof *w->hold);
  memcpy(s->root, w->root, (size_t)lag_watched(s) * sizeof *w->root);
  memcpy(s->pb.u, w->u, (size_t)m->nu * sizeof *w->u);
  memcpy(s->kept, w->kept, (size_t)m->constraints->n * sizeof *w->kept);
}

/* Whether a signal keeps a contact closed, or friction on its side, as the other does. */
static int is_same(double a, double b) { return isnan(a) ? isnan(b) : (a > 0) == (b > 0) && (a < 0) == (b < 0); }

static const lag_contact *contact_at(const lag_sim *s, int i) { return &s->scene->model->contacts[i]; }

/* Whether tangent i is one of two; guides stand behind the contacts. */
static int is_in_space(const lag_sim *s, int i) {
  const lag_model *m = s->scene->model;
  return i + m->nguides < m->ncontacts && (contact_at(s, i - 1)->is_tangent ||
                                           (i + 1 + m->nguides < m->ncontacts && contact_at(s, i + 1)->is_tangent));
}

/* Whether contacts are closed, stick and slip as behind the event; in space the direction may be another. */
static int goes_on_alike(const lag_sim *s, const Strike *w) {
  int same = 1;
  for (int i = 0; i < s->scene->model->ncontacts && same; i++) {
    const lag_contact *c = contact_at(s, i);
    same = (s->hold[c->input] > 0.5) == (w->after[c->input] > 0.5);
    same &= !c->is_tangent || is_in_space(s, i) || is_same(s->hold[c->force], w->after[c->force]);
  }
  return same;
}

/* behind := the state after event k from there, which is brought to the constraints before it. The search leaves no
 * trace. 1: neighbouring motions go on with other contacts. */
static int effect_at(lag_sim *s, int k, const Strike *w) {
  lag_release_integrals(s);
  int rc = lag_project(&s->pb, s->run->t, w->there, NULL);
  s->forced = w->after;
  rc = rc ? rc : lag_event_effect(s, k, w->there, w->behind);
  s->forced = NULL;
  rc = rc ? rc : !goes_on_alike(s, w);
  put_back(s, w);
  return rc;
}

static const double smallest_part = 0x1p-21;

/* column[n] := change of the state after event k along component i of the state before, or of t for i = n, by central
 * differences of order 4; smaller ones where others would stay closed. */
static int effect_slope(lag_sim *s, int k, int i, const Strike *w, double *column) {
  int n = s->pb.n, rc = 1;
  double t = s->run->t, step = fabs(s->run->step_t1 - s->run->step_t0), span = s->pb.span > 0 ? s->pb.span : 1;
  if (!(step > 0)) step = 0x1p-9 * span; /* of a kick at once */
  for (double part = 0x1p-9; rc > 0 && part >= smallest_part; part *= 0x1p-6) {
    double h = part * (i < n ? lag_difference_scale(&s->pb, s->now, i) : step);
    memset(column, 0, (size_t)n * sizeof *column);
    rc = LAG_OK;
    for (int j = -2; j <= 2 && rc == LAG_OK; j++) {
      if (j == 0) continue;
      memcpy(w->there, s->now, (size_t)n * sizeof *w->there);
      if (i < n) w->there[i] += j * h;
      s->run->t = i == n ? t + j * h : t;
      rc = effect_at(s, k, w);
      for (int c = 0; c < n; c++) column[c] += (j % 2 ? 8 : -1) * (j < 0 ? -1 : 1) / 12.0 * w->behind[c] / h;
    }
  }
  s->run->t = t;
  return rc;
}

/* R_by[n columns] := change of the state after event k by parameters, at the same state before. */
static int effect_by_parameters(lag_sim *s, int k, const Strike *w, double *R_by) {
  const lag_parameter_columns *by = s->pb.by;
  int n = s->pb.n, columns = s->tangent_columns, rc = LAG_OK;
  for (int j = 0; by && j < by->n && rc == LAG_OK; j++)
    LAG_EACH_DIFFERENCE(step) {
      memcpy(w->there, s->now, (size_t)n * sizeof *w->there);
      lag_use_parameters(s, j, step);
      rc = rc ? rc : effect_at(s, k, w);
      lag_use_parameters(s, 0, 0);
      for (int c = 0; c < n; c++)
        R_by[c * columns + by->column[j]] += lag_difference_weight(step) * w->behind[c] / by->h[j];
    }
  return rc;
}

/* Whether friction begins or ceases to hold at event k, or a contact opens: the state goes on as it is. */
static int is_quiet(const lag_sim *s, int k) {
  const lag_contact *c = lag_contact_of(s->scene->model, k);
  double size = 0, far = 0;
  for (int i = s->pb.nq; i < s->pb.n; i++)
    size = fmax(size, fabs(s->now[i])), far = fmax(far, fabs(s->yb[i] - s->now[i]));
  return c && (c->is_tangent || (c->release == k && far <= 1e-12 * size));
}

/* Whether rates behind the event are those before it, up to rounding of what the run has. */
static int goes_on(const lag_sim *s, const Jump *j) {
  double span = s->pb.span > 0 ? s->pb.span : 1, far = 0, size = 0;
  for (int i = 0; i < s->pb.n; i++) {
    far = fmax(far, fabs(j->after[i] - j->before[i]));
    size = fmax(size, fmax(fabs(j->before[i]), s->pb.size[i] / span));
  }
  return far <= 1e-9 * size;
}

/* S := R_y, Rt := R_t, R_by; at a quiet event R is the identity where its function is 0, which is where it counts. */
static int effect_slopes(lag_sim *s, int k, const Strike *w, const Jump *j) {
  int n = s->pb.n, rc = LAG_OK, quiet = is_quiet(s, k);
  for (int i = 0; i <= n && rc == LAG_OK && !quiet; i++) {
    rc = effect_slope(s, k, i, w, j->Rt);
    for (int c = 0; c < n && i < n; c++) j->S[c * n + i] = j->Rt[c];
  }
  for (int i = 0; i < n && quiet; i++) j->S[i * n + i] = 1;
  return rc || quiet ? rc : effect_by_parameters(s, k, w, j->R_by);
}

/* delay[columns] of event k, whose rate along the motion is *rate; j.g := its gradient. */
static int find_delays(lag_sim *s, int k, const Strike *w, const Jump *j, double *rate, double *delay) {
  int n = s->pb.n, columns = s->tangent_columns, kick = lag_is_kick(s->scene->model, k), rc = LAG_OK;
  Corner corner = {.there = w->there, .gradient = j->g, .g = w->slope};
  for (int i = 0; i <= n && rc == LAG_OK && !kick; i++) rc = lag_event_slope(s, &corner, k, i, &j->g[i]);
  rc = rc ? rc : lag_event_by_parameters(s, k, j->g_by);
  rc = rc ? rc : kick ? lag_events_eval(s, s->run->t, s->now, s->g1) : LAG_OK;
  *rate = kick ? -s->g1[k] / (s->run->t - s->scene->t0 + s->kicks_late) : j->g[n];
  for (int i = 0; i < n; i++) *rate += j->g[i] * j->before[i];
  for (int c = 0; c < columns && rc == LAG_OK; c++) {
    delay[c] = -j->g_by[c];
    for (int i = 0; i < n; i++) delay[c] -= j->g[i] * s->tangent[i * columns + c];
    delay[c] /= *rate;
  }
  return rc;
}

/* Whether gap or condition i changes at this time by a function of its own, and not by the impulse of event k. */
static int coincides(const lag_sim *s, int k, int i, const Strike *w) {
  const lag_contact *c = contact_at(s, i);
  int was = w->hold[c->input] > 0.5, is = w->after[c->input] > 0.5, event = was ? c->release : c->impact;
  int struck = !c->conditional && w->root[c->impact] == s->run->limit;
  if (c->is_tangent || c->impact == k || c->release == k || (was == is && !struck)) return 0;
  return c->conditional ? !(fabs(w->slope[event]) > 1e-9 * fabs(s->g0[event])) : !was;
}

/* Whether others change at this time, which neighbouring motions meet before or after event k. */
static int others_meet(lag_sim *s, int k, const Strike *w, const Jump *j) {
  const lag_model *m = s->scene->model;
  double *other = w->other, rate, *g = other + s->tangent_columns;
  int rc = lag_events_eval(s, s->run->t, s->now, g), parts = 0;
  for (int i = 0; i < m->ncontacts && rc == LAG_OK && !parts; i++) {
    memcpy(w->slope, g, (size_t)lag_watched(s) * sizeof *g);
    if (!coincides(s, k, i, w)) continue;
    const lag_contact *c = contact_at(s, i);
    rc = find_delays(s, w->hold[c->input] > 0.5 ? c->release : c->impact, w, j, &rate, other);
    for (int b = 0; b < s->tangent_columns; b++)
      parts |= !(fabs(other[b] - w->delay[b]) <= 1e-7 * (fabs(other[b]) + fabs(w->delay[b])));
  }
  return rc || parts;
}

/* Whether impact k alone, without others that would follow it ever faster, leads to the state yb. */
static int is_whole(lag_sim *s, int k, const Strike *w) {
  double size = 0, far = 0;
  memcpy(w->there, s->now, (size_t)s->pb.n * sizeof *w->there);
  int rc = effect_at(s, k, w);
  for (int i = s->pb.nq; i < s->pb.n; i++)
    size = fmax(size, fabs(s->now[i])), far = fmax(far, fabs(w->behind[i] - s->yb[i]));
  return rc == LAG_OK && far <= 1e-12 * size;
}

/* Whether event k leaves a contact or a constraint closed that was open. */
static int closes_more(const lag_sim *s, const Strike *w) {
  int more = 0;
  for (int i = 0; i < s->scene->model->ncontacts; i++)
    more |= w->after[contact_at(s, i)->input] > 0.5 && !(w->hold[contact_at(s, i)->input] > 0.5);
  return more;
}

/* Change of the state along column c that is no rounding, in scales. */
static double change_scale(lag_sim *s, const double *found, int c) {
  const lag_parameter_columns *by = s->pb.by;
  const double some = 1e-3;
  double size = 0;
  for (int j = 0; by && j < by->n; j++)
    if (by->column[j] == c) size = some * LAG_DIFFERENCE_PART / by->h[j];
  for (int i = 0; i < s->pb.n; i++) {
    double scale = lag_difference_scale(&s->pb, s->now, i);
    size = fmax(size, fmax(fabs(found[i]), fabs(s->tangent[i * s->tangent_columns + c])) / scale);
  }
  return size;
}

/* Y := S Y + R_by - gain delay; whether positions of neighbouring motions go on from where the event finds them. */
static int apply_effect(lag_sim *s, const Strike *w, const Jump *j) {
  int n = s->pb.n, columns = s->tangent_columns, met = 1;
  for (int c = 0; c < columns; c++) {
    double far = 0, *found = w->there;
    for (int i = 0; i < n; i++) {
      double to = j->R_by[i * columns + c];
      for (int b = 0; b < n; b++) to += j->S[i * n + b] * s->tangent[b * columns + c];
      j->Y[i * columns + c] = to - j->gain[i] * w->delay[c];
      found[i] = s->tangent[i * columns + c] + j->before[i] * w->delay[c];
      to = j->Y[i * columns + c] + j->after[i] * w->delay[c]; /* behind the event, at its time */
      if (i < s->pb.nq) far = fmax(far, fabs(to - found[i]) / lag_difference_scale(&s->pb, s->now, i));
    }
    met &= far <= 1e-6 * change_scale(s, found, c);
  }
  memcpy(s->tangent, j->Y, lag_tangent_block(s) * sizeof *j->Y);
  return met;
}

static const char other_contacts[] =
    "neighbouring motions go on with other contacts closed, sticking or slipping", unmet[] =
    "neighbouring motions do not meet its constraint there", stops_in_space[] =
    "a slip in space ends, before which its direction turns ever faster", only_touched[] =
    "the motion only touches it, and neighbouring motions may miss it";

/* The part of parameter and state that event k of a model with contacts or constraints changes; hold: before it. */
static int multiply_effect(lag_sim *s, int k, const Strike *w, const Jump *j) {
  int n = s->pb.n, quiet = is_quiet(s, k), kick = lag_is_kick(s->scene->model, k);
  double rate, left = 1;
  const lag_contact *c = lag_contact_of(s->scene->model, k);
  if (!quiet && !is_whole(s, k, w))
    return refuse(s, k, "the contact closes after ever faster impacts, and neighbouring motions make others");
  int rc = effect_slopes(s, k, w, j);
  if (rc > 0) return refuse(s, k, other_contacts);
  rc = rc ? rc : find_delays(s, k, w, j, &rate, w->delay);
  if (rc || (!kick && lag_event_touches(s, k, rate))) return rc ? rc : refuse(s, k, only_touched);
  if (c && c->is_tangent && k == c->impact && is_in_space(s, (int)(c - s->scene->model->contacts)))
    return refuse(s, k, stops_in_space);
  if (!quiet && others_meet(s, k, w, j)) return refuse(s, k, either_order);
  for (int i = 0; i < n; i++) { /* after := gain */
    double gain = j->after[i] - (quiet ? 0 : j->Rt[i]);
    for (int b = 0; b < n; b++) gain -= j->S[i * n + b] * j->before[b];
    j->gain[i] = gain;
    left += j->g[i] * gain / rate;
  }
  int met = apply_effect(s, w, j);
  for (int e = 0; e < n * n; e++) j->S[e] += j->gain[e / n] * j->g[e % n] / rate;
  int joins = quiet ? !(fabs(left) > 1e-9) : closes_more(s, w);
  s->tangent_log += joins ? -HUGE_VAL : quiet ? log(fabs(left)) : log_det(n, j->S, j->copy);
  if (lag_not_finite(n * s->tangent_columns, s->tangent) >= 0) return refuse(s, k, only_touched);
  return met || !c ? LAG_OK : refuse(s, k, unmet);
}

/* Y := that behind event k of a model with contacts or constraints. */
static int over_constraints(lag_sim *s, int k, int more) {
  const lag_model *m = s->scene->model;
  size_t n = (size_t)s->pb.n, nu = (size_t)m->nu, watched = (size_t)lag_watched(s), nn = n * n,
         columns = (size_t)s->tangent_columns;
  double calls = s->pb.rhs_calls;
  int rc = lag_tangent_carry(s);
  if (rc) return rc;
  Strike w;
  Jump j;
  const lag_part parts[] = {{&w.hold, nu}, {&w.after, nu}, {&w.root, watched}, {&w.u, nu},
      {&w.kept, (size_t)m->constraints->n}, {&w.there, n}, {&w.behind, n}, {&w.slope, watched}, {&w.delay, columns},
      {&w.other, columns + watched}, {&j.g, n + 1}, {&j.Rt, n}, {&j.before, n}, {&j.after, n}, {&j.gain, n},
      {&j.Y, n * columns}, {&j.S, nn}, {&j.copy, nn}, {&j.g_by, columns}, {&j.R_by, n * columns}};
  double *room = lag_workspace(sizeof parts / sizeof *parts, parts);
  if (!room) return LAG_ENOMEM;
  memcpy(w.hold, s->hold_before, nu * sizeof *room);
  memcpy(w.after, s->hold, nu * sizeof *room);
  memcpy(w.root, s->root, watched * sizeof *room);
  memcpy(w.u, s->pb.u, nu * sizeof *room);
  memcpy(w.kept, s->kept, (size_t)m->constraints->n * sizeof *room);
  lag_switch_set_free(s, 1);
  rc = lag_rhs(&s->pb, s->run->t, s->yb, j.after);
  lag_switch_set_free(s, 0);
  put_back(s, &w);
  rc = rc ? rc : lag_rhs(&s->pb, s->run->t, s->now, j.before);
  if (rc == LAG_OK && !(is_quiet(s, k) && goes_on(s, &j)))
    rc = more ? refuse(s, k, either_order) : multiply_effect(s, k, &w, &j);
  memcpy(s->hold, w.after, nu * sizeof *room);
  free(room);
  rc = rc ? rc : lag_tangent_settle(s);
  s->pb.rhs_calls = calls;
  return rc || !s->record ? rc : lag_record_jump(s);
}

int lag_tangent_jump(lag_sim *s, int k, int more) {
  const lag_model *m = s->scene->model;
  lag_problem *pb = &s->pb;
  int n = pb->n, nq = pb->nq;
  double t = s->run->t, rhs_calls = pb->rhs_calls, rate = 0;
  if (!s->tangent) return LAG_OK;
  if (m->constraints) return over_constraints(s, k, more);
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
