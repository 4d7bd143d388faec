/* Switching surfaces: jumps and corners of the equations. Enters: a state on a surface, or a new one; leaves: the
 * branch of each switch, in `hold` behind the inputs, for the motion from there on. Holds: no step sees a jump,
 * since the branch is fixed until an event of its own ends it.
 *
 * A mode is 1 or -1, the sign of the switching function g; 0: the motion slides on g = 0, and the value that keeps
 * it there is found at each state (the equivalent control); of floor: its value; LAG_FREE: the state decides. The
 * event of a switch is that its mode ceases to fit: mode*g falls below 0, or grip^2 - mode^2 of a sliding motion
 * does; grip is 1, or more where static friction is.
 *
 * Where surfaces meet, rates r = dg/dt are linear in the modes, r = r0 + B m: each m is 1 with r >= 0, -1 with r <=
 * 0, or between with r = 0, a problem of numeric/complementarity.h; for a P-matrix -B it has one solution. A.F.
 * Filippov, Differential Equations with Discontinuous Righthand Sides (1988), DOI 10.1007/978-94-015-7793-9; L.
 * Dieci, L. Lopez, Numer. Math. 117 (2011) 779, DOI 10.1007/s00211-011-0365-4, for intersections. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"
#include "numeric/complementarity.h"
#include "numeric/dense.h"

static double *mode(const lag_sim *s, int k) { return &s->hold[s->scene->model->nu + k]; }
/* Whether the method finds the mode of switch k itself, step by step, as friction beside contacts that are met by
 * impulses. */
static int is_stepped(const lag_sim *s, int k) {
  return (s->method->flags & LAG_METHOD_IMPULSES) && s->scene->model->switches[k].jumps;
}
static int slides(const lag_sim *s, int k) {
  return *mode(s, k) == 0.0 && !s->scene->model->switches[k].is_floor && !is_stepped(s, k);
}

/* ---- The sliding motion */

/* r[nmodes] := rates of the switching functions at y, t with the modes in pb->u, and with the friction of contacts
 * that slip under these. */
static int rates_at(lag_problem *pb, double t, const double *y, double *r) {
  const lag_model *m = pb->model;
  int rc = m->contact_laws ? lag_contact_friction_forces(pb, t, y) : 0;
  pb->rhs_calls++;
  return rc ? rc : m->switch_rates(m, t, y, y + m->nq, y + 2 * m->nq, pb->p, pb->u, r, pb->work);
}

/* B[n n] := derivatives of the rates of the sliding switches by their modes; r: rates now. *size := the largest
 * term. */
static int rate_matrix(lag_problem *pb, double t, const double *y, const double *r, double *other, double *B,
                       double *size) {
  const int *of = pb->sliding, n = pb->nslide;
  double *u = pb->u + pb->model->nu;
  for (int j = 0; j < n; j++) {
    double before = u[of[j]];
    u[of[j]] = before + 1;
    int rc = rates_at(pb, t, y, other);
    u[of[j]] = before;
    if (rc) return rc;
    for (int i = 0; i < n; i++) {
      B[i * n + j] = other[of[i]] - r[of[i]];
      *size = fmax(*size, fabs(B[i * n + j]) + fabs(r[of[i]]));
    }
  }
  return 0;
}

/* Switches that hold one motion, as frictions of two joints of one crank, share what holds it as springs do that give
 * way by this part. */
static const double gives_way = 1e-6;

/* Whether sliding switches hold one motion: a row of B[n n] depends on others. C[n n]: scratch. */
static int holds_twice(int n, const double *B, double *C) {
  for (int k = 0; k < n * n; k++)
    C[k] = B[k] / sqrt(fabs(B[k / n * (n + 1)] * B[k % n * (n + 1)])); /* diagonal -1 where it can slide */
  for (int k = 0; k < n; k++) {
    if (!(fabs(C[k * (n + 1)]) > lag_dependent_row)) return 1;
    for (int i = k + 1; i < n; i++)
      for (int j = n - 1; j >= k; j--) C[i * n + j] -= C[i * n + k] / C[k * (n + 1)] * C[k * n + j];
  }
  return 0;
}

int lag_sliding_values(lag_problem *pb, double t, const double *y) {
  enum { ROUNDS = 8 };
  const double enough = 64 * DBL_EPSILON, some = 1e-9; /* of the largest term */
  int n = pb->nslide, nm = pb->model->nmodes, rc = 0;
  double *u = pb->u + pb->model->nu, *r = pb->slide, *other = r + nm, *x = other + nm, *B = x + nm, size = 0,
         left = HUGE_VAL;
  for (int round = 0; round < ROUNDS && (rc = rates_at(pb, t, y, r)) == 0; round++) {
    left = 0;
    for (int i = 0; i < n; i++) left = fmax(left, fabs(r[pb->sliding[i]]));
    if (round && left <= enough * size) return 0;
    if ((rc = rate_matrix(pb, t, y, r, other, B, &size)) != 0) return rc;
    for (int i = 0; i < n; i++) x[i] = -r[pb->sliding[i]];
    int twice = holds_twice(n, B, B + n * n);
    for (int i = 0; i < n && twice; i++) B[i * (n + 1)] *= 1 + gives_way;
    if (lag_solve_dense((size_t)n, 1, B, x)) return LAG_ERETRY;
    for (int i = 0; i < n; i++) u[pb->sliding[i]] += x[i];
  }
  return rc ? rc : left <= some * size ? 0 : LAG_ERETRY;
}

LAG_RARE int inputs_and_modes(lag_problem *pb, double t, const double *y) {
  int rc = lag_inputs_inline(pb, t);
  if (rc || pb->nslide) return rc ? rc : lag_sliding_values(pb, t, y);
  return pb->model->contact_laws ? lag_contact_friction_forces(pb, t, y) : 0;
}

int lag_inputs_at(lag_problem *pb, double t, const double *y) {
  const lag_model *m = pb->model;
  return m->nu | m->nmodes || m->contact_laws ? inputs_and_modes(pb, t, y) : 0;
}

void lag_switch_count(lag_sim *s) {
  s->pb.nslide = 0;
  for (int k = 0; k < s->scene->model->nmodes; k++)
    if (slides(s, k)) s->pb.sliding[s->pb.nslide++] = k;
}

void lag_hold_swap(lag_sim *s, double *other) {
  for (int i = 0; i < s->pb.model->nu + s->pb.model->nmodes; i++) {
    double x = s->hold[i];
    s->hold[i] = other[i], other[i] = x;
  }
  lag_switch_count(s);
}

void lag_switch_hold(lag_sim *s, int k, double m) {
  *mode(s, k) = m;
  lag_switch_count(s);
}

void lag_switch_set_free(lag_sim *s, int is_free) {
  int nm = s->scene->model->nmodes;
  for (int k = 0; k < nm; k++) {
    double *kept = &s->left[k];
    if (is_free) *kept = *mode(s, k);
    *mode(s, k) = is_free ? LAG_FREE : *kept;
    if (!is_free) *kept = 0;
  }
  lag_switch_count(s);
}

/* ---- Event functions */

/* g[nswitch] := the switching functions at y, t. */
static int sides_at(lag_sim *s, double t, const double *y, double *g) {
  const lag_model *m = s->scene->model;
  int rc = m->switch_values(m, t, y, y + m->nq, y + 2 * m->nq, s->p, s->u, g, s->work);
  return rc ? rc : lag_not_finite(m->nmodes, g) >= 0 ? LAG_ENAN : 0;
}

/* grip[nmodes] := the largest mode of a sliding motion at y, t: 1, or more where static friction is; or less than 1
 * by more than rounding, which choose() refuses. */
static int find_grips(lag_sim *s, double t, const double *y) {
  const lag_model *m = s->scene->model;
  int rc = m->switch_grips ? m->switch_grips(m, t, y, y + m->nq, y + 2 * m->nq, s->p, s->u, s->grip, s->work) : 0;
  for (int k = 0; k < m->nmodes; k++) s->grip[k] = m->switch_grips && fabs(s->grip[k] - 1) > 1e-9 ? s->grip[k] : 1;
  return rc;
}

int lag_switch_eval(lag_sim *s, double t, const double *y, double *g) {
  const lag_model *m = s->scene->model;
  int rc = sides_at(s, t, y, s->sides);
  if (rc == 0 && s->pb.nslide) rc = find_grips(s, t, y);
  for (int k = 0; k < m->nmodes && rc == 0; k++) {
    double held = *mode(s, k), side = s->sides[k], now = s->u[m->nu + k];
    g[k] = is_stepped(s, k)          ? 1
           : m->switches[k].is_floor ? (side - held) * (held + 1 - side)
           : held == 0.0             ? s->grip[k] * s->grip[k] - now * now
                                     : held * side;
  }
  return rc;
}

int lag_switch_hold_sides(lag_sim *s, double t, const double *y) {
  int rc = s->scene->model->nmodes ? sides_at(s, t, y, s->sides) : 0;
  for (int k = 0; k < s->scene->model->nmodes && rc == 0; k++)
    *mode(s, k) = s->scene->model->switches[k].is_floor ? floor(s->sides[k]) : s->sides[k] < 0 ? -1 : 1;
  lag_switch_count(s);
  return rc;
}

double lag_switch_noise(const lag_sim *s, int k) { return slides(s, k) ? 1e-12 : 2 * s->side_noise[k]; }

/* side_noise[nmodes] := change of the switching functions g[nmodes] when the state at the present time changes in
 * its last digits, velocities in those at the begin of the step: an impact, and constraints, leave as much of them. */
static int find_noise(lag_sim *s, const double *g) {
  const double last = 4 * DBL_EPSILON;
  const lag_model *m = s->scene->model;
  double *other = s->sides + m->nswitch;
  for (int i = 0; i < s->pb.n; i++) {
    int struck = i >= m->nq && i < 2 * m->nq && m->constraints && s->run->have_step != 0.0;
    double size = struck ? fmax(fabs(s->now[i]), fabs(s->y0[i])) : fabs(s->now[i]);
    s->yc[i] = s->now[i] + (i % 2 ? -last : last) * size;
  }
  int rc = sides_at(s, s->run->t * (1 + last), s->yc, other);
  for (int k = 0; k < m->nmodes && rc == 0; k++)
    s->side_noise[k] = 2 * fabs(other[k] - g[k]) + 2 * last * (m->switches[k].is_floor ? 1 + fabs(g[k]) : 0);
  return rc;
}

/* ---- Failures */

static int fail_at(lag_sim *s, int status, int k, const char *why) {
  const lag_switch *c = &s->scene->model->switches[k];
  char line[32] = "";
  if (c->line) snprintf(line, sizeof line, " in line %d", c->line);
  return lag_fail(s, status, "at t = %s s the motion meets %s = %s, where `%s`%s switches: %s", LAG_TEXT(s->run->t),
                  c->surface, lag_switch_value(c), c->text, line, why);
}

/* ---- Which branches follow */

/* The switches at their surface: of[n], with r = r0 + B m and the present choice m. */
typedef struct Meeting {
  int n, *of;
  double *r0, *B, *m, *x, *C, *scale; /* [n], [n n], [n]; scratch [n], [n n], [n] */
  lag_box *box;
  unsigned char *at; /* [n] where m is: at an end, or between */
} Meeting;

static void set_mode(lag_sim *s, int k, double m) {
  const lag_switch *c = &s->scene->model->switches[k];
  *mode(s, k) = c->is_floor ? round(s->sides[k]) - (m < 0) : m;
}

/* Rates with each switch of the meeting at mode m of its own, in s->pb.slide. */
static int meeting_rates(lag_sim *s, const Meeting *w) {
  for (int i = 0; i < w->n; i++) set_mode(s, w->of[i], w->m[i]);
  int rc = lag_inputs(&s->pb, s->run->t);
  return rc ? rc : rates_at(&s->pb, s->run->t, s->now, s->pb.slide);
}

/* Fills r0 and B, in the direction of the run. */
static int linear_rates(lag_sim *s, Meeting *w) {
  const double *r = s->pb.slide;
  int n = w->n, rc;
  for (int i = 0; i < n; i++) w->m[i] = 0;
  if ((rc = meeting_rates(s, w)) != 0) return rc;
  for (int i = 0; i < n; i++) w->r0[i] = r[w->of[i]] * s->pb.dir;
  for (int j = 0; j < n; j++) {
    for (int end = -1; end <= 1; end += 2) {
      w->m[j] = end;
      if ((rc = meeting_rates(s, w)) != 0) return rc;
      for (int i = 0; i < n; i++) w->B[i * n + j] = (end < 0 ? 0 : w->B[i * n + j]) + end * r[w->of[i]] * s->pb.dir / 2;
    }
    w->m[j] = 0;
  }
  return 0;
}

static int can_slide(const lag_sim *s, const Meeting *w, int i) {
  return s->scene->model->switches[w->of[i]].jumps && w->B[i * w->n + i] < 0;
}

static double rate_of(const Meeting *w, int i) {
  double r = w->r0[i];
  for (int j = 0; j < w->n; j++) r += w->B[i * w->n + j] * w->m[j];
  return r;
}

/* Chooses m as a complementarity problem. p->at[n]: where the search begins, and ends. soft: part by which each gives
 * way. */
static int solve_modes(const lag_sim *s, Meeting *w, lag_complementarity *p, double soft) {
  int n = w->n;
  for (int i = 0; i < n; i++) {
    double grip = s->grip[w->of[i]];
    w->box[i] = (lag_box){-1, 1, grip - 1, !can_slide(s, w, i)};
    w->x[i] = -w->r0[i];
    for (int j = 0; j < n; j++) w->C[i * n + j] = -w->B[i * n + j] * (i == j ? 1 + soft : 1);
  }
  int status = lag_solve_complementarity(p);
  for (int i = 0; i < n && status == LAG_SOLVED; i++) w->m[i] = w->x[i];
  return status;
}

/* Rate of switch i after a short time dt on the branches m. */
static double rate_after(lag_sim *s, const Meeting *w, int i, double dt) {
  lag_problem *pb = &s->pb;
  if (meeting_rates(s, w) || lag_rhs(pb, s->run->t, s->now, s->ya)) return NAN;
  for (int k = 0; k < pb->n; k++) s->yb[k] = s->now[k] + dt * s->ya[k];
  return rates_at(pb, s->run->t + dt, s->yb, pb->slide) ? NAN : pb->slide[w->of[i]] * pb->dir;
}

/* Switch i is met at rest: the side to which the acceleration leads; 0: there is none, or both. */
static double side_from_rest(lag_sim *s, Meeting *w, int i) {
  double dt = 1e-9 * (s->pb.span > 0 ? s->pb.span : 1) * s->pb.dir, was = w->m[i], up, down;
  w->m[i] = 1;
  up = rate_after(s, w, i, dt);
  w->m[i] = -1;
  down = rate_after(s, w, i, dt);
  w->m[i] = was;
  return up >= 0 && down >= 0 ? 1 : up <= 0 && down <= 0 ? -1 : 0;
}

static const char no_branch[] =
  "it rests on the surface, or leaves it to either side, and no branch tells which; start beside it";
static const char no_slide[] = "the motions on both sides do not determine one on the surface";
static const char no_end[] = "it can neither leave the surface nor slide on it";
static const char weak_grip[] =
  "its static limit is smaller than the friction of a sliding body; `static = mu_s*N` has a mu_s of at least mu";
static const char several[] =
  "it can leave the surface to either side, so that several motions follow; start beside the surface";

/* Where the search begins. left: the side to which a switch has just slid off, else 0. */
static int begin_choice(lag_sim *s, Meeting *w, const double *left) {
  for (int i = 0; i < w->n; i++) {
    double to = left[w->of[i]];
    int in = can_slide(s, w, i) && to == 0.0;
    w->m[i] = to != 0.0 ? to : in ? 0 : w->r0[i] < 0 ? -1 : 1;
    w->at[i] = in ? LAG_BETWEEN : w->m[i] < 0 ? LAG_AT_LOWER : LAG_AT_UPPER;
  }
  for (int i = 0; i < w->n; i++) {
    if (w->at[i] == LAG_BETWEEN || fabs(rate_of(w, i)) > 0 || w->B[i * w->n + i] != 0.0) continue;
    double side = side_from_rest(s, w, i);
    if (side == 0.0) return fail_at(s, LAG_ESTALL, w->of[i], no_branch);
    w->m[i] = side;
    w->at[i] = side < 0 ? LAG_AT_LOWER : LAG_AT_UPPER;
  }
  return LAG_OK;
}

/* Finds the choice m of the switches that meet. */
static int choose(lag_sim *s, Meeting *w, const double *left) {
  int rc = linear_rates(s, w);
  rc = rc ? rc : find_grips(s, s->run->t, s->now);
  if (rc) return fail_at(s, LAG_EMODEL, w->of[0], "the model has no rates there");
  for (int i = 0; i < w->n; i++)
    if (s->grip[w->of[i]] < 1) return fail_at(s, LAG_EDOMAIN, w->of[i], weak_grip);
  if ((rc = begin_choice(s, w, left)) != 0) return rc;
  lag_complementarity p = {w->n, -1, w->C, w->x, w->scale, w->box, w->at, 1e-13, 5e-14};
  int status = solve_modes(s, w, &p, 0);
  if (status != LAG_SOLVED && begin_choice(s, w, left) == LAG_OK) status = solve_modes(s, w, &p, gives_way);
  if (status == LAG_CYCLES) return fail_at(s, LAG_ESTALL, w->of[p.row], no_end);
  if (status != LAG_SOLVED) return fail_at(s, LAG_ESTALL, w->of[0], no_slide);
  for (int i = 0; i < w->n; i++) {
    double r = rate_of(w, i), jump = w->B[i * w->n + i];
    if (w->at[i] != LAG_BETWEEN && r + jump * (1 - w->m[i]) > 0 && r - jump * (1 + w->m[i]) < 0)
      return fail_at(s, LAG_ESTALL, w->of[i], several);
  }
  return LAG_OK;
}

/* ---- Surfaces that contacts imply */

/* Response of the rate of switch k to its mode; NaN: there is none. */
static double own_response(lag_sim *s, int k) {
  double was = *mode(s, k), r[2] = {NAN, NAN};
  for (int up = 0; up < 2; up++) {
    *mode(s, k) = up ? 1 : -1;
    if (lag_inputs(&s->pb, s->run->t) == 0 && rates_at(&s->pb, s->run->t, s->now, s->pb.slide) == 0)
      r[up] = s->pb.slide[k];
  }
  *mode(s, k) = was;
  return (r[1] - r[0]) / 2;
}

/* Opens contacts along their surface that stick, or closes those again; returns how many. */
static int open_tangents(lag_sim *s, int open) {
  const lag_model *m = s->scene->model;
  int some = 0;
  for (int i = 0; i < m->ncontacts; i++) {
    double *closed = &s->hold[m->contacts[i].input];
    if (!m->contacts[i].is_tangent || !(open ? *closed > 0.5 : *closed == 0.0)) continue;
    *closed = !open;
    some++;
  }
  return some;
}

/* Whether friction of contacts and guides that stick holds the slip of switch k, which changes no rate then. */
static int is_implied(lag_sim *s, int k) {
  if (!s->scene->model->switches[k].jumps || is_stepped(s, k) || !open_tangents(s, 1)) return 0;
  double alone = own_response(s, k);
  open_tangents(s, 0);
  return fabs(alone) > 0 && fabs(own_response(s, k)) <= 1e-9 * fabs(alone);
}

/* Friction of a switch that contacts imply is any within its size: it stays as it is, from none on; 1 and -1 would be
 * branches of a body that slips. */
static double implied_mode(double was) {
  return fabs(was) == 1.0 ? nextafter(was, 0) : was != 0.0 ? was : DBL_MIN;
}

/* ---- The run */

/* The mode of switch k becomes m; counts the time of sliding. */
static void change_mode(lag_sim *s, int k, double m) {
  int slid = slides(s, k);
  set_mode(s, k, m);
  if (slid) s->slid[k] += fabs(s->run->t - s->slid_since[k]);
  s->slid_since[k] = s->run->t;
  if (!slid && slides(s, k)) s->slips[k]++;
}

/* Chooses the branches of the switches that meets[k] says are at their surface. *changed, unless NULL: whether any
 * is another than before. */
static int settle(lag_sim *s, int *changed) {
  const lag_model *m = s->scene->model;
  int nm = m->nmodes;
  double *was = s->meeting, *r0 = was + nm, *ends = r0 + nm, *x = ends + nm, *scale = x + nm, *box = scale + nm;
  double *B = box + 4 * nm, *C = B + nm * nm;
  unsigned char *at = (unsigned char *)(s->meeting_of + 2 * nm);
  Meeting w = {0, s->meeting_of, r0, B, ends, x, C, scale, (lag_box *)(void *)box, at};
  for (int k = 0; k < nm; k++) {
    was[k] = *mode(s, k);
    if (s->meets[k] == 0.0) continue;
    if (!is_implied(s, k)) w.of[w.n++] = k;
    else change_mode(s, k, was[k] = implied_mode(was[k]));
  }
  int rc = w.n ? choose(s, &w, s->left) : LAG_OK;
  for (int k = 0; k < nm; k++) *mode(s, k) = was[k];
  for (int i = 0; i < w.n && rc == 0; i++) {
    int k = w.of[i];
    change_mode(s, k, w.at[i] == LAG_BETWEEN ? 0 : w.m[i]);
    if (changed) *changed |= *mode(s, k) != was[k];
    s->crossed[k] += m->switches[k].is_floor ? *mode(s, k) != was[k] : was[k] != 0.0 && *mode(s, k) == -was[k];
    /* a slide has left it a little beside 0 */
    if (!m->switches[k].is_floor) s->side_noise[k] = fmax(s->side_noise[k], fabs(s->sides[k]));
  }
  lag_switch_count(s);
  if (rc == 0 && s->pb.nslide && lag_inputs_at(&s->pb, s->run->t, s->now))
    rc = fail_at(s, LAG_ESTALL, s->pb.sliding[0],
                 "it sticks there, and the force is no sum of the switch and a rest, as in a condition with `and`; "
                 "write it by sign() or if() of one comparison");
  memset(s->left, 0, (size_t)nm * sizeof *s->left);
  memset(s->meets, 0, (size_t)nm * sizeof *s->meets);
  return rc;
}

int lag_switch_place(lag_sim *s) {
  const lag_model *m = s->scene->model;
  if (lag_watched(s) == m->nev) return LAG_OK;
  double *g = s->sides;
  int rc = lag_inputs(&s->pb, s->run->t);
  rc = rc ? rc : sides_at(s, s->run->t, s->now, g);
  rc = rc ? rc : find_noise(s, g);
  if (rc)
    return lag_fail(s, rc < 0 ? rc : LAG_ENAN, "the switching functions have no value at t = %s s",
                    LAG_TEXT(s->run->t));
  for (int k = 0; k < m->nmodes; k++) {
    if (is_stepped(s, k)) {
      if (s->slid[k] == 0.0) s->slid_since[k] = NAN; /* the last time at which it stuck */
      continue;
    }
    int is_floor = m->switches[k].is_floor, slid = slides(s, k);
    double far = is_floor ? fabs(g[k] - round(g[k])) : fabs(g[k]);
    if (far <= s->side_noise[k] + (slid ? s->slid_off[k] : 0) || s->meets[k] != 0.0) s->meets[k] = 1;
    else if (is_floor) *mode(s, k) = floor(g[k]);
    else change_mode(s, k, g[k] > 0 ? 1 : -1);
  }
  return settle(s, NULL);
}

/* Values of the switching functions before events act, for lag_switch_place. */
int lag_switch_before_events(lag_sim *s) {
  const lag_model *m = s->scene->model;
  if (lag_watched(s) == m->nev) return LAG_OK;
  int rc = sides_at(s, s->run->t, s->now, s->sides);
  for (int k = 0; k < m->nmodes; k++) s->slid_off[k] = 2 * fabs(s->sides[k]);
  return rc ? lag_fail(s, LAG_ENAN, "the switching functions have no value at t = %s s", LAG_TEXT(s->run->t)) : LAG_OK;
}

void lag_switch_meet(lag_sim *s, int k) {
  s->meets[k] = 1;
  if (slides(s, k)) s->left[k] = s->u[s->scene->model->nu + k] > 0 ? 1 : -1;
}

int lag_switch_settle(lag_sim *s, int *changed) {
  int rc = lag_inputs(&s->pb, s->run->t);
  rc = rc ? rc : sides_at(s, s->run->t, s->now, s->sides);
  rc = rc ? rc : find_noise(s, s->sides);
  if (rc) return lag_fail(s, LAG_ENAN, "the switching functions have no value at t = %s s", LAG_TEXT(s->run->t));
  for (int i = 0; i < s->pb.nslide; i++) s->meets[s->pb.sliding[i]] = 1;
  return settle(s, changed);
}

int lag_switch_relieve(lag_sim *s, int event) {
  const lag_model *m = s->scene->model;
  int relieved = 0;
  double t = s->run->t;
  if (lag_watched(s) == m->nev || sides_at(s, t, s->now, s->sides) || find_grips(s, t, s->now)) return 0;
  for (int k = 0; k < m->nmodes && !relieved; k++) {
    double was = *mode(s, k), little = s->side_noise[k] + lag_switch_noise(s, k);
    if (!(fabs(s->sides[k]) <= little) || !is_implied(s, k)) continue;
    for (int up = 0; up < 2 && !relieved; up++) {
      lag_switch_hold(s, k, implied_mode((up ? 1 : -1) * s->grip[k]));
      relieved = *mode(s, k) != was && lag_events_eval(s, t, s->now, s->g1) == 0 && s->g1[event] > 0;
      for (int i = 0; i < m->ncontacts && relieved; i++)
        relieved = !(m->contacts[i].is_tangent && s->g1[m->contacts[i].release] < 0);
    }
    if (!relieved) lag_switch_hold(s, k, was);
  }
  return relieved;
}

int lag_switch_fail_zeno(lag_sim *s, int k) {
  return fail_at(s, LAG_EZENO, k,
                 "it does so again and again in ever shorter time, and does not come to rest; smooth it, as tanh(v/w) "
                 "for sign(v), or let an event stop the run");
}

int lag_switch_sticks(const lag_sim *s, int k) {
  return is_stepped(s, k) ? s->slid_since[k] == s->run->step_t1 : slides(s, k);
}

LAG_RARE int follow_modes(lag_sim *s, double t) {
  const lag_model *m = s->scene->model;
  const lag_contact_stats *c = s->pb.contacts;
  int struck = c && c->from > s->run->t && c->from < t;
  double *before = s->sides, *after = s->sides + m->nswitch;
  int rc = lag_inputs(&s->pb, s->run->t);
  rc = rc ? rc : sides_at(s, s->run->t, s->now, before);
  rc = rc ? rc : lag_inputs(&s->pb, t);
  rc = rc ? rc : sides_at(s, t, s->y, after);
  for (int k = 0; k < m->nmodes && rc == 0; k++) {
    if (!is_stepped(s, k)) continue;
    int stuck = s->slid_since[k] == s->run->step_t1, sticks = fabs(*mode(s, k)) != 1.0 && !struck;
    if (sticks) s->slid[k] += t - (stuck ? s->slid_since[k] : s->run->t);
    if (sticks) s->slid_since[k] = t;
    s->slips[k] += sticks && !stuck;
    s->crossed[k] += !sticks && !stuck && before[k] * after[k] < 0;
  }
  return rc;
}

int lag_switch_step(lag_sim *s, double t) {
  return s->method->flags & LAG_METHOD_IMPULSES && s->scene->model->nmodes ? follow_modes(s, t) : LAG_OK;
}

double lag_sim_switch_times(const lag_sim *s, int k, long long *crossings, long long *slides_begun) {
  if (!s || k < 0 || k >= s->scene->model->nmodes) return NAN;
  if (crossings) *crossings = (long long)s->crossed[k];
  if (slides_begun) *slides_begun = (long long)s->slips[k];
  return s->slid[k] + (slides(s, k) ? fabs(s->run->t - s->slid_since[k]) : 0);
}
