/* The tangent of a run: small changes of the state, carried along the motion. Enters: Y at one time; leaves: Y at a
 * later time. Holds: the run itself is the same, bit by bit, with a tangent or without: steps are differentiated
 * after they were made, and the counts of the run exclude that cost; with constraints Y lies in their tangent space
 * (constraints/tangent_space.c). A switch that ends its branch has the saltation matrix of saltation.c with R_y = 1;
 * where the motion begins to slide on its surface, f+ lies in the surface and the matrix has one rank less. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/tangent.h"

void lag_tangent_free(lag_sim *s) {
  lag_parameter_columns_free(s);
  lag_record_free(s);
  free(s->tangent);
  s->tangent = s->tangent_jump = s->tangent_scratch = s->hold_before = NULL;
  s->tangent_at_event = 0;
  s->tangent_columns = 0;
}

/* Whether steps of the method can be differentiated; if not, the message says what to do. */
static int check(lag_sim *s) {
  const lag_model *m = s->scene->model;
  int in_p = m->nq > 0 && (s->method->flags & LAG_METHOD_VARIATION) &&
             !((s->method->flags & LAG_METHOD_SPLITS) && (m->flags & LAG_SEPARABLE));
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

/* Scratch of a corner: rates before and after it, a state, the gradient of the event function and its rate, and
 * event functions. */
static size_t corner_size(const lag_sim *s, int k) {
  const lag_model *m = s->scene->model;
  return m->nmodes ? 4 * (size_t)s->pb.n + 1 + (size_t)(m->nev + m->nmodes) + (size_t)k : 0;
}

/* Scratch of a jump: its entries, S[n n] and a copy, four vectors and a copy of Y[n k]. */
static size_t jump_size(const lag_sim *s, int k) {
  size_t n = (size_t)s->pb.n, listed = (size_t)lag_tangent_jumps(s);
  return corner_size(s, k) + (listed ? listed + 2 * n * n + 4 * (n + 1) + (2 * n + 1) * (size_t)k : 0);
}

/* Allocates k columns, when there is another number of them. */
static int make_room(lag_sim *s, int k) {
  size_t n = (size_t)s->pb.n, size = n * (size_t)k;
  if (s->tangent && s->tangent_columns == k) return LAG_OK;
  if (s->tangent) lag_tangent_free(s);
  size_t step = s->method->tangent_size(&s->pb, k), projection = lag_tangent_projection_size(&s->pb);
  const lag_model *m = s->scene->model;
  size_t scratch = step > projection ? step : projection, held = (size_t)(m->nu + m->nmodes);
  size_t all = size + jump_size(s, k) + scratch + held + 1;
  s->tangent = calloc(all, sizeof *s->tangent);
  if (!s->tangent)
    return lag_fail(s, LAG_ENOMEM,
                    "out of memory: derivatives of %d components of the state in %d columns take %zu MB; ask for fewer "
                    "columns, as by `--sensitivity NAME` for one start or parameter",
                    s->pb.n, k, all / ((1 << 20) / sizeof *s->tangent) + 1);
  s->tangent_jump = s->tangent + size;
  s->tangent_scratch = s->tangent_jump + jump_size(s, k);
  s->hold_before = s->tangent_scratch + scratch;
  s->tangent_columns = k;
  return LAG_OK;
}

/* Near a singular position, as of a folded linkage, there is no tangent space. */
int lag_tangent_exists(lag_sim *s, double t) {
  const double least = 1e-3;
  int weakest = -1;
  if (s->scene->model->constraints && lag_independence(&s->pb, t, s->now, &weakest) < least && weakest >= 0)
    return lag_fail(s, LAG_EMETHOD,
                    "at t = %s s constraint %s nearly depends on the others: neighbouring motions part there, and "
                    "there is no tangent; end the run before",
                    LAG_TEXT(t), s->scene->model->constraints->of[weakest].name);
  return LAG_OK;
}

/* Projects Y onto the tangent space of the constraints at y, t. */
static int stay_on_constraints(lag_sim *s, double t, const double *y, double *Y) {
  int rc = lag_tangent_exists(s, t);
  if (rc) return rc;
  rc = lag_tangent_project(&s->pb, t, y, s->tangent_columns, Y, s->tangent_scratch);
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
  if (Y) memcpy(s->tangent, Y, lag_tangent_block(s) * sizeof *Y);
  else memset(s->tangent, 0, lag_tangent_block(s) * sizeof *s->tangent);
  for (int i = 0; i < n && !Y; i++) s->tangent[i * n + i] = 1;
  return stay_on_constraints(s, s->run->begun != 0.0 ? s->run->t : s->scene->t0, s->now, s->tangent);
}

/* Guides press to the side of the middle of the step, up to t, also where stages at its ends pass the corner. */
static int hold_sides(lag_sim *s, double t) {
  if (s->scene->model->nguides == 0) return LAG_OK;
  double middle = s->run->step_t0 + (t - s->run->step_t0) / 2;
  int rc = lag_dense_state(s, middle, s->yc);
  rc = rc ? rc : lag_rhs(&s->pb, middle, s->yc, s->ya);
  if (rc == LAG_OK) lag_guides_hold_sides(&s->pb, 1);
  return rc;
}

int lag_tangent_over(lag_sim *s, double t, double *Y) {
  lag_problem *pb = &s->pb;
  double rhs_calls = pb->rhs_calls, systems = pb->systems, iterations = pb->iterations;
  pb->detail = NULL;
  pb->bad_index = -1;
  int rc = hold_sides(s, t);
  rc = rc ? rc : s->method->tangent(s->method_work, pb, t, s->tangent_columns, Y, s->tangent_scratch);
  lag_guides_hold_sides(pb, 0);
  pb->rhs_calls = rhs_calls;
  pb->systems = systems;
  pb->iterations = iterations;
  return rc ? lag_explain(s, rc) : stay_on_constraints(s, t, s->now, Y);
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

/* With the contacts that were closed during the step. */
int lag_tangent_carry(lag_sim *s) {
  if (!s->tangent) return LAG_OK;
  int within = s->run->have_step != 0.0 && s->run->t != s->run->step_t0 && !s->tangent_at_event;
  lag_hold_swap(s, s->hold_before);
  int rc = within ? advance_tangent(s, s->run->t, s->tangent) : LAG_OK;
  lag_hold_swap(s, s->hold_before);
  s->tangent_at_event = 1;
  return rc;
}

int lag_tangent_settle(lag_sim *s) { return stay_on_constraints(s, s->run->t, s->yb, s->tangent); }

int lag_tangent_edges(lag_sim *s) {
  const lag_model *m = s->scene->model;
  for (int i = 0; s->tangent && i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    if (c->is_tangent && lag_contact_is_closed(s, c) && s->sign[c->release] == 0.0)
      return lag_fail(s, LAG_EMETHOD,
                      "at t = %s s the friction of %s holds with all its force: neighbouring motions slip or stick, "
                      "and there is no tangent; start beside, or end the run before",
                      LAG_TEXT(s->run->t), m->constraints->of[m->contacts[i].constraint].name);
  }
  return LAG_OK;
}

int lag_event_touches(lag_sim *s, int k, double rate) {
  const Run *r = s->run;
  const double flat = 1e-6;
  double size = 0;
  for (int end = 0; end < 2; end++)
    if (lag_events_eval(s, end ? r->step_t1 : r->step_t0, end ? s->y : s->y0, s->g1) == LAG_OK)
      size = fmax(size, fabs(s->g1[k]));
  return fabs(rate * (r->step_t1 - r->step_t0)) < flat * size;
}

/* ---- Switches that end a branch */

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

int lag_event_slope(lag_sim *s, const Corner *w, int k, int i, double *slope) {
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
  for (int i = 0; i <= n && rc == LAG_OK; i++) rc = lag_event_slope(s, &w, k, i, i < n ? &w.gradient[i] : &slope);
  for (int i = 0; i < n && rc == LAG_OK; i++) {
    slope += w.gradient[i] * w.before[i];
    s->tangent_moves |= w.gradient[i] != 0.0;
  }
  w.gradient[n] = slope;
  rc = rc ? rc : lag_event_by_parameters(s, k, w.by);
  for (int c = 0; c < s->tangent_columns && rc == LAG_OK; c++) s->tangent_moves |= w.by[c] != 0.0;
  s->pb.rhs_calls = calls;
  s->tangent_touches = rc == LAG_OK && lag_event_touches(s, k, slope);
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
  for (int i = 0; i < n && rc == LAG_OK; i++) rc = lag_event_slope(s, &w, s->scene->model->nev + k, i, &w.gradient[i]);
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

int lag_sim_tangent(lag_sim *s, double *Y) {
  if (!s || !Y) return LAG_EINVAL;
  const Run *r = s->run;

  if (!s->tangent || s->record)
    return lag_fail(s, LAG_EINVAL, "this run has no tangent: lag_sim_set_tangent");
  memcpy(Y, s->tangent, lag_tangent_block(s) * sizeof *Y);
  return r->have_step != 0.0 && r->t != r->step_t0 && !s->tangent_at_event ? advance_tangent(s, r->t, Y) : LAG_OK;
}
