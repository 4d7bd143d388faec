/* The tangent of a run: small changes of the state, carried along the motion. Enters: Y at one time; leaves: Y at a
 * later time. Holds: the run itself is the same, bit by bit, with a tangent or without: steps are differentiated
 * after they were made, and the counts of the run exclude that cost; with constraints Y lies in their tangent space
 * (constraints/tangent_space.c).
 *
 * An event changes the state from y to y+ = R(t, y) where g(t, y) = 0; its time moves with y. With the rates f and
 * f+ before and after it, small changes are multiplied by the saltation matrix
 *   S = R_y + (f+ - R_y f - R_t) g_y / (g_y f + g_t):
 * R.I. Leine, H. Nijmeijer, Dynamics and Bifurcations of Non-Smooth Mechanical Systems (2004), ch. 7, DOI
 * 10.1007/978-3-540-44398-8. A switch that ends its branch has R_y = 1; where the motion begins to slide on its
 * surface, f+ lies in the surface and S has one rank less. At an impact of a contact between two flights R_y, R_t and
 * derivatives by parameters are differences of the impact law; where a contact stays closed, the run with a tangent
 * fails. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/dense.h"

static size_t block(const lag_sim *s) { return (size_t)s->pb.n * (size_t)s->tangent_columns; }

void lag_tangent_free(lag_sim *s) {
  lag_parameter_columns_free(s);
  lag_record_free(s);
  free(s->tangent);
  s->tangent = s->tangent_jump = s->tangent_scratch = NULL;
  s->tangent_at_event = 0;
  s->tangent_columns = 0;
}

/* Whether steps of the method can be differentiated; if not, the message says what to do. */
static int check(lag_sim *s) {
  const lag_model *m = s->scene->model;
  int in_p = m->nq > 0 && (s->method->flags & LAG_METHOD_VARIATION) &&
             !((s->method->flags & LAG_METHOD_SPLITS) && (m->flags & LAG_SEPARABLE));
  for (int i = 0; i < m->ncontacts; i++) {
    const char *name = m->constraints->of[m->contacts[i].constraint].name;
    if (m->contacts[i].conditional || lag_guide_of(m, i) >= 0)
      return lag_fail(s, LAG_EMETHOD,
                      "there is no tangent of a motion whose constraint %s begins and ends: the impulses there have no "
                      "derivatives yet", name);
  }
  if (m->constraints && (!s->method->tangent || (s->method->flags & LAG_METHOD_VARIATION)))
    return lag_fail(s, LAG_EMETHOD,
                    "method %s has no derivative of its steps with constraints; dop853, rk45, rk4 and radau have",
                    s->method->name);
  if (!s->method->tangent) {
    return lag_fail(s, LAG_EMETHOD, "method %s has no derivative of its steps; %s has", s->method->name,
                    s->method->flags & LAG_METHOD_SYMPLECTIC ? "verlet8" : "dop853");
  }
  if (in_p && s->pb.by)
    return lag_fail(s, LAG_EMETHOD,
                    "method %s steps in momenta, and has no derivative of its steps by parameters; dop853, rk45, radau "
                    "and taylor have",
                    s->method->name);
  if (!in_p && !m->linear && !m->constraints) {
    return lag_fail(s, LAG_EMETHOD,
                    "the tangent needs the derivatives of the equations, which this program was built without; `lagc "
                    "run --tangent` builds "
                    "them in, and so does `lagc build --with linear`");
  }
  return LAG_OK;
}

static int njump(const lag_sim *s) {
  const lag_linear *l = s->scene->model->linear;
  return l && l->jumps ? l->njump : 0;
}

/* Scratch of a corner: rates before and after it, a state, the gradient of the event function and its rate, and
 * event functions. */
static size_t corner_size(const lag_sim *s, int k) {
  const lag_model *m = s->scene->model;
  return m->nmodes ? 4 * (size_t)s->pb.n + 1 + (size_t)(m->nev + m->nmodes) + (size_t)k : 0;
}

/* Scratch of a jump: its entries, S[n n] and a copy, four vectors and a copy of Y[n k]. */
static size_t jump_size(const lag_sim *s, int k) {
  size_t n = (size_t)s->pb.n;
  return corner_size(s, k) + (njump(s) ? (size_t)njump(s) + 2 * n * n + 4 * (n + 1) + (2 * n + 1) * (size_t)k : 0);
}

/* Allocates k columns, when there is another number of them. */
static int make_room(lag_sim *s, int k) {
  size_t n = (size_t)s->pb.n, size = n * (size_t)k;
  if (s->tangent && s->tangent_columns == k) return LAG_OK;
  if (s->tangent) lag_tangent_free(s);
  size_t step = s->method->tangent_size(&s->pb, k), projection = lag_tangent_projection_size(&s->pb);
  s->tangent = calloc(size + jump_size(s, k) + (step > projection ? step : projection) + 1, sizeof *s->tangent);
  if (!s->tangent) return lag_fail(s, LAG_ENOMEM, "out of memory");
  s->tangent_jump = s->tangent + size;
  s->tangent_scratch = s->tangent_jump + jump_size(s, k);
  s->tangent_columns = k;
  return LAG_OK;
}

/* A contact that is closed; -1: none. */
static int closed_contact(const lag_sim *s) {
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->ncontacts; i++)
    if (!m->contacts[i].is_tangent && lag_contact_is_closed(s, &m->contacts[i])) return i;
  return -1;
}

/* Near a singular position, as of a folded linkage, there is no tangent space. */
int lag_tangent_exists(lag_sim *s, double t) {
  const double least = 1e-3;
  int weakest = -1, closed = closed_contact(s);
  if (closed >= 0)
    return lag_fail(s, LAG_EMETHOD,
                    "contact %s is closed at t = %s s, where neighbouring motions may fly: the tangent goes over "
                    "impacts between flights only; end the run before",
                    s->scene->model->constraints->of[s->scene->model->contacts[closed].constraint].name, LAG_TEXT(t));
  if (s->scene->model->constraints && lag_independence(&s->pb, t, s->now, &weakest) < least && weakest >= 0)
    return lag_fail(s, LAG_EMETHOD,
                    "at t = %s s constraint %s nearly depends on the others: neighbouring motions part there, and "
                    "there is no tangent; end the run before",
                    LAG_TEXT(t), s->scene->model->constraints->of[weakest].name);
  return LAG_OK;
}

/* Projects Y onto the tangent space of the constraints at the present state, t. */
static int stay_on_constraints(lag_sim *s, double t, double *Y) {
  int rc = lag_tangent_exists(s, t);
  if (rc) return rc;
  rc = lag_tangent_project(&s->pb, t, s->now, s->tangent_columns, Y, s->tangent_scratch);
  return rc ? lag_fail(s, rc < 0 ? rc : LAG_EDOMAIN,
                       "at t = %s s changes of the state cannot be projected onto the constraints", LAG_TEXT(t))
            : LAG_OK;
}

/* The start on the constraints, where the run has none yet; a singular one has no tangent space. */
static int check_start(lag_sim *s) {
  int d = lag_tangent_dimension(s);
  if (d < 0 || s->run->beside <= s->run->rank) return d < 0 ? d : LAG_OK;
  return lag_fail(s, LAG_EMETHOD,
                  "constraints depend on each other at the start, but not beside it: neighbouring motions are of "
                  "another kind, and there is no tangent");
}

int lag_sim_set_tangent(lag_sim *s, int k, const double *Y) {
  if (s && s->sensitivity) lag_tangent_free(s);
  return s ? lag_tangent_set(s, k, Y) : LAG_EINVAL;
}

int lag_tangent_set(lag_sim *s, int k, const double *Y) {
  int n = s->pb.n, rc;

  if (k == 0) {
    lag_tangent_free(s);
    return LAG_OK;
  }
  if (k < 0 || (!Y && k != n))
    return lag_fail(s, LAG_EINVAL, "a tangent of %d columns: give them, or take all %d", k, n);
  if (s->run->have_step != 0.0)
    return lag_fail(s, LAG_EINVAL, "a tangent begins at the end of a step, and t = %s lies within one",
                    LAG_TEXT(s->run->t));
  if ((rc = check(s)) != 0 || (rc = check_start(s)) != 0 || (rc = make_room(s, k)) != 0) return rc;
  if (Y) memcpy(s->tangent, Y, block(s) * sizeof *Y);
  else memset(s->tangent, 0, block(s) * sizeof *s->tangent);
  for (int i = 0; i < n && !Y; i++) s->tangent[i * n + i] = 1;
  return stay_on_constraints(s, s->run->begun != 0.0 ? s->run->t : s->scene->t0, s->tangent);
}

int lag_tangent_over(lag_sim *s, double t, double *Y) {
  lag_problem *pb = &s->pb;
  double rhs_calls = pb->rhs_calls, systems = pb->systems, iterations = pb->iterations;
  pb->detail = NULL;
  pb->bad_index = -1;
  int rc = s->method->tangent(s->method_work, pb, t, s->tangent_columns, Y, s->tangent_scratch);
  pb->rhs_calls = rhs_calls;
  pb->systems = systems;
  pb->iterations = iterations;
  return rc ? lag_explain(s, rc) : stay_on_constraints(s, t, Y);
}

/* Y := D Y, or the record of it. */
static int advance_tangent(lag_sim *s, double t, double *Y) {
  return s->record ? lag_record_step(s, t) : lag_tangent_over(s, t, Y);
}

int lag_tangent_pass(lag_sim *s) {
  if (!s->tangent || s->run->have_step != 0.0 || s->tangent_at_event) {
    s->tangent_at_event = 0;
    return LAG_OK;
  }
  int rc = advance_tangent(s, s->run->t, s->tangent);
  return rc || !s->record ? rc : lag_record_cut(s);
}

/* Whether event k only touches zero: its rate there is negligible relative to its values at the ends of the step. */
static int only_touches(lag_sim *s, int k, double rate) {
  const Run *r = s->run;
  const double flat = 1e-6;
  double size = 0;
  for (int end = 0; end < 2; end++)
    if (lag_events_eval(s, end ? r->step_t1 : r->step_t0, end ? s->y : s->y0, s->g1) == LAG_OK)
      size = fmax(size, fabs(s->g1[k]));
  return fabs(rate * (r->step_t1 - r->step_t0)) < flat * size;
}

/* ---- Switches that end a branch */

typedef struct Corner {
  /* f and f+; a state; gradient of the event function and its rate along f; event functions */
  double *before, *after, *there, *gradient, *g;
  double *by; /* its change by the parameter of each column */
} Corner;

static Corner corner_layout(const lag_sim *s) {
  int n = s->pb.n;
  Corner c = {.before = s->tangent_scratch - corner_size(s, s->tangent_columns)};
  c.after = c.before + n;
  c.there = c.after + n;
  c.gradient = c.there + n;
  c.g = c.gradient + n + 1;
  c.by = c.g + s->scene->model->nev + s->scene->model->nmodes;
  return c;
}

/* *slope := change of event function k along component i of the state, or of t for i = n, by central differences of
 * order 4. */
static int event_slope(lag_sim *s, const Corner *w, int k, int i, double *slope) {
  const double part = 0x1p-9;
  lag_problem *pb = &s->pb;
  int n = pb->n, rc = LAG_OK;
  double h = part * (i < n ? lag_difference_scale(pb, s->now, i) : fabs(s->run->step_t1 - s->run->step_t0));
  *slope = 0;
  for (int j = 1; j <= 2 && rc == LAG_OK; j++) {
    double difference = 0; /* exactly 0 where the function does not depend on the component */
    for (int side = -1; side <= 1 && rc == LAG_OK; side += 2) {
      memcpy(w->there, s->now, (size_t)n * sizeof(double));
      if (i < n) w->there[i] += side * j * h;
      rc = lag_events_eval(s, s->run->t + (i == n ? side * j * h : 0), w->there, w->g);
      difference = rc ? 0 : side < 0 ? -w->g[k] : difference + w->g[k];
    }
    *slope += (j == 1 ? 8 : -1) * difference / (12 * h);
  }
  return rc;
}

/* Change of the event function along column c, where its gradient is w->gradient. */
static double change_along(const lag_sim *s, const Corner *w, int c) {
  double along = w->by[c];
  for (int i = 0; i < s->pb.n; i++) along += w->gradient[i] * s->tangent[i * s->tangent_columns + c];
  return along;
}

int lag_tangent_meet(lag_sim *s, int k) {
  if (!s->tangent) return LAG_OK;
  int n = s->pb.n,
      rc = !s->tangent_at_event && s->run->t != s->run->step_t0 ? advance_tangent(s, s->run->t, s->tangent) : LAG_OK;
  double calls = s->pb.rhs_calls, slope = 0;
  Corner w = corner_layout(s);
  s->tangent_at_event = 1;
  s->tangent_meets++;
  rc = rc ? rc : lag_rhs(&s->pb, s->run->t, s->now, w.before);
  for (int i = 0; i <= n && rc == LAG_OK; i++) rc = event_slope(s, &w, k, i, i < n ? &w.gradient[i] : &slope);
  for (int i = 0; i < n && rc == LAG_OK; i++) {
    slope += w.gradient[i] * w.before[i];
    s->tangent_moves |= w.gradient[i] != 0.0;
  }
  w.gradient[n] = slope;
  rc = rc ? rc : lag_event_by_parameters(s, k, w.by);
  for (int c = 0; c < s->tangent_columns && rc == LAG_OK; c++) s->tangent_moves |= w.by[c] != 0.0;
  s->pb.rhs_calls = calls;
  s->tangent_touches = rc == LAG_OK && only_touches(s, k, slope);
  return rc;
}

static int refuse_corner(lag_sim *s, const char *why) {
  return lag_fail(s, LAG_EMETHOD, "at t = %s s a force jumps, and %s: there is no tangent over it; end the run before",
                  LAG_TEXT(s->run->t), why);
}

int lag_tangent_corner(lag_sim *s) {
  const double same = 1e-9;
  if (!s->tangent) return LAG_OK;
  int n = s->pb.n, k = s->tangent_columns, meets = s->tangent_meets, moves = s->tangent_moves;
  double calls = s->pb.rhs_calls, far = 0, size = 0;
  Corner w = corner_layout(s);
  int rc = lag_rhs(&s->pb, s->run->t, s->now, w.after);
  s->pb.rhs_calls = calls;
  s->tangent_meets = s->tangent_moves = 0;
  double rate = w.gradient[n], left = rate, terms = fabs(rate);
  for (int i = 0; i < n; i++) {
    far = fmax(far, fabs(w.after[i] - w.before[i]));
    size = fmax(size, fabs(w.before[i]));
    left += w.gradient[i] * (w.after[i] - w.before[i]);
    terms += fabs(w.gradient[i] * (w.after[i] - w.before[i]));
  }
  if (rc || !moves || far <= same * size) return rc;
  if (meets > 1)
    return refuse_corner(s, "two surfaces are met at once, which neighbouring motions may meet in either order");
  if (s->tangent_touches)
    return refuse_corner(s, "the motion only touches its surface, which neighbouring motions may miss");
  for (int c = 0; c < k; c++) {
    double along = change_along(s, &w, c);
    for (int i = 0; i < n; i++) s->tangent[i * k + c] += (w.after[i] - w.before[i]) * along / rate;
  }
  int joins = fabs(left) <= same * terms; /* a slide begins */
  s->tangent_log += joins ? -HUGE_VAL : log(fabs(left / rate));
  return s->record ? lag_record_jump(s) : LAG_OK;
}

/* Neighbouring motions fall onto the surface at once, from either side along the jump of the rates: S = 1 - (f+ -
 * f-) g_y / (g_y (f+ - f-)). */
int lag_tangent_begin(lag_sim *s) {
  if (!s->tangent || s->pb.nslide == 0) return LAG_OK;
  if (s->pb.nslide > 1)
    return lag_fail(s, LAG_EMETHOD,
                    "a motion that begins by sliding on several surfaces has no tangent yet; start beside them");
  int n = s->pb.n, columns = s->tangent_columns, k = s->pb.sliding[0], rc = LAG_OK;
  Corner w = corner_layout(s);
  double calls = s->pb.rhs_calls, across = 0;
  for (int side = -1; side <= 1 && rc == LAG_OK; side += 2) {
    lag_switch_hold(s, k, side);
    rc = lag_rhs(&s->pb, s->run->t, s->now, side < 0 ? w.before : w.after);
  }
  for (int i = 0; i < n && rc == LAG_OK; i++) rc = event_slope(s, &w, s->scene->model->nev + k, i, &w.gradient[i]);
  rc = rc ? rc : lag_event_by_parameters(s, s->scene->model->nev + k, w.by);
  lag_switch_hold(s, k, 0);
  s->pb.rhs_calls = calls;
  for (int i = 0; i < n && rc == LAG_OK; i++) across += w.gradient[i] * (w.after[i] - w.before[i]);
  for (int c = 0; c < columns && rc == LAG_OK; c++) {
    double along = change_along(s, &w, c);
    for (int i = 0; i < n; i++) s->tangent[i * columns + c] -= (w.after[i] - w.before[i]) * along / across;
  }
  s->tangent_log = -HUGE_VAL;
  if (rc == LAG_OK && s->record) return lag_record_jump(s);
  return rc ? lag_fail(s, LAG_EMETHOD,
                       "the start slides, and the rates beside its surface, which its tangent needs, have no values")
            : LAG_OK;
}

/* ---- Events that change the state */

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
  j.S = j.d + njump(s);
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
  for (int e = 0; e < njump(s); e++) { /* each component that is set has an entry for itself */
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
  memcpy(j->Y, s->tangent, block(s) * sizeof(double));
  memset(s->tangent, 0, block(s) * sizeof(double));
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
    rate = -s->g1[k] / (s->run->t - s->scene->t0);
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
  int n = s->pb.n, rc = lag_rhs(&s->pb, s->run->t, s->now, j->before);
  Corner corner = {.there = w->there, .gradient = j->g, .g = w->slope};
  rc = rc ? rc : lag_rhs(&s->pb, s->run->t, s->yb, j->after);
  *rate = 0;
  for (int i = 0; i <= n && rc == LAG_OK; i++) {
    rc = event_slope(s, &corner, k, i, &j->g[i]);
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

/* Y := that behind impact k, between flights. */
static int strike(lag_sim *s, int k, int more) {
  const lag_model *m = s->scene->model;
  size_t n = (size_t)s->pb.n, nu = (size_t)m->nu, watched = (size_t)lag_watched(s),
         columns = (size_t)s->tangent_columns;
  double rate, calls = s->pb.rhs_calls, *room;
  if (more) return refuse(s, k, either_order);
  if (closed_contact(s) >= 0) return refuse(s, k, "the contact stays closed, where neighbouring motions may fly");
  int rc = s->run->have_step != 0.0 && s->run->t != s->run->step_t0 && !s->tangent_at_event
               ? advance_tangent(s, s->run->t, s->tangent)
               : LAG_OK;
  if (rc) return rc;
  room = calloc(2 * nu + 2 * watched + 5 * (n + 1) + (n + 1) * columns + 2 * n * n, sizeof *room);
  if (!room) return LAG_ENOMEM;
  Strike w = {.hold = room, .root = room + nu};
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
  memcpy(w.hold, s->hold, nu * sizeof *room);
  memcpy(w.root, s->root, watched * sizeof *room);
  memcpy(w.u, s->pb.u, nu * sizeof *room);
  rc = impact_saltation(s, k, &w, &j, &rate);
  s->pb.rhs_calls = calls;
  s->tangent_at_event = 1;
  if (rc == LAG_OK) s->tangent_log += log_det((int)n, j.S, j.copy);
  if (rc == LAG_OK && (only_touches(s, k, rate) || !apply_saltation(s, &j)))
    rc = refuse(s, k, "the motion only touches it, and neighbouring motions may miss it");
  rc = rc ? rc : impact_by_parameters(s, k, &w, j.after, rate, j.g_by);
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
  if (njump(s) && (lag_inputs(pb, t) ||
                   m->linear->jumps(m->linear, t, s->now, s->now + nq, s->now + 2 * nq, s->p, s->u, j.d, s->work)))
    return refuse(s, k, "its derivatives cannot be computed");
  if (!njump(s) || !collect_derivatives(s, k, &j)) {
    return refuse(s, k, "it depends on an input, whose rate a model does not have"); /* the compiler lists all others */
  }
  int rc = s->run->have_step != 0.0 && t != s->run->step_t0 && !s->tangent_at_event ? advance_tangent(s, t, s->tangent)
                                                                                    : LAG_OK;
  rc = rc ? rc : lag_rhs(pb, t, s->now, j.before);
  lag_switch_set_free(s, 1); /* the event may have changed branches */
  int after = rc ? rc : lag_rhs(pb, t, s->yb, j.after);
  lag_switch_set_free(s, 0);
  if (rc || after) return rc ? rc : refuse(s, k, "the rates there cannot be computed");
  pb->rhs_calls = rhs_calls;
  for (int c = 0; c < n; c++) rate += j.g[c] * j.before[c];
  rate += j.g[n];
  int kick = lag_is_kick(m, k), touches = !kick && only_touches(s, k, rate);
  for (int i = 0; i < n; i++) {
    double gain = j.after[i] - j.Rt[i];
    for (int c = 0; c < n; c++) gain -= j.S[i * n + c] * j.before[c];
    for (int c = 0; c < n && !kick; c++) j.S[i * n + c] += gain * j.g[c] / rate; /* no state moves a kick */
    j.Rt[i] = gain;
  }
  if (s->pb.by && parameters_at_jump(s, k, &j, j.Rt, rate))
    return refuse(s, k, "its derivatives by parameters cannot be computed");
  s->tangent_at_event = 1;
  s->tangent_log += log_det(n, j.S, j.copy);
  int finite = apply_saltation(s, &j);
  for (size_t i = 0; i < block(s) && s->pb.by; i++) s->tangent[i] += j.R_by[i];
  if (!finite || touches) return refuse(s, k, "the motion only touches it, and neighbouring motions may miss it");
  return s->record ? lag_record_jump(s) : LAG_OK;
}

int lag_sim_tangent(lag_sim *s, double *Y) {
  if (!s || !Y) return LAG_EINVAL;
  const Run *r = s->run;

  if (!s->tangent || s->record)
    return lag_fail(s, LAG_EINVAL, "this run has no tangent: lag_sim_set_tangent");
  memcpy(Y, s->tangent, block(s) * sizeof *Y);
  return r->have_step != 0.0 && r->t != r->step_t0 && !s->tangent_at_event ? advance_tangent(s, r->t, Y) : LAG_OK;
}
