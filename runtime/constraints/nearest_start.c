/* Consistent start. Enters: the start as scene and caller set it, and which components they set; leaves: the nearest
 * start on the constraints. Holds: components that nobody set move first, the others only where that does not
 * suffice; a start that obeys the constraints to rounding is not touched. numeric/consistent_state.c searches; here
 * are the model's functions for it, and messages. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"
#include "numeric/consistent_state.h"
#include "numeric/release.h"
#include "numeric/workspace.h"
#include "lag_kkt.h"

typedef struct Start {
  lag_sim *sim;
  lag_problem *pb;
  const lag_constraints *of;
  int nq, nheld;             /* coordinates; those that a constraint contains, which alone may move */
  lag_level level;           /* positions or velocities, at hand */
  double *y, *asked, *best;  /* [pb->n] */
  double *other;             /* [constraints] residual of the level not at hand; marks of rank */
  double *M;                 /* sparse entries */
  double *full, *kkt;        /* [nheld nheld] M of the held coordinates; work of lag_kkt */
  int *place;                /* [nq] index of a coordinate among the free ones; -1: it is none */
  int *number;               /* [nq] index of a coordinate among the held ones; -1: it is none */
  int *held;                 /* [nheld] those coordinates, rising */
  int *index;                /* block of all integers */
} Start;

/* ---- the model at the state of a level */

/* Writes the level's components into y; returns y. */
static const double *put(const lag_level *w) {
  Start *s = w->context;
  double *level = s->y + (w->positions ? 0 : s->nq);
  memcpy(level, w->x, (size_t)w->n * sizeof *level);
  return s->y;
}

static int residuals(const lag_level *w, double *residual) {
  Start *s = w->context;
  return lag_residuals(s->pb, s->sim->scene->t0, put(w), w->positions ? residual : s->other,
                       w->positions ? s->other : residual);
}

static int jacobian(const lag_level *w, double *A) {
  Start *s = w->context;
  lag_problem *pb = s->pb;
  const double *y = put(w);
  int rc = lag_inputs(pb, s->sim->scene->t0);
  return rc ? rc
            : s->of->matrices(s->of, s->sim->scene->t0, y, y + s->nq, y + 2 * s->nq, pb->p, pb->u, A, s->M, pb->work);
}

static int terms(const lag_level *w, double *size) {
  Start *s = w->context;
  return lag_constraint_terms(s->pb, s->sim->scene->t0, put(w), w->positions, size);
}

static void scales(const lag_level *w, const double *x, double *reach) {
  const Start *s = w->context;
  for (int i = 0; i < w->n; i++) { /* of positions: lag_consistent_state asks at no other level */
    const lag_var *q = &s->pb->model->q[i];
    reach[i] = i > 0 && lag_are_alike(q, q - 1) ? reach[i - 1] : lag_typical_magnitude(s->pb, x, 1, i);
  }
}

/* Steps by lag_kkt, with the identity in place of a singular M. */
static int direction(const lag_level *w, double pull, double *d) {
  Start *s = w->context;
  const lag_constraints *of = s->of;
  int nq = s->nq, nf = w->nfree, nh = s->nheld, rc = jacobian(w, w->A);
  double *A = s->kkt + nf * nf, *x = A + w->rows * nf, *l = x + nf;
  int *place = s->place, *number = s->number;
  for (int i = 0; i < nq; i++) place[i] = -1;
  for (int regular = 0, pass = 0; pass < 2 && rc == 0 && !regular; pass++) {
    memset(s->full, 0, (size_t)nh * (size_t)nh * sizeof(double));
    for (int e = 0; e < of->nmass && pass == 0; e++) {
      int i = number[of->mass[e].row], j = number[of->mass[e].col];
      if (i >= 0 && j >= 0) s->full[i * nh + j] = s->full[j * nh + i] = s->M[e];
    }
    for (int i = 0; i < nh && pass == 1; i++) s->full[i * nh + i] = 1; /* M is singular: the identity takes its place */
    memset(A, 0, (size_t)(w->rows * nf) * sizeof(double));
    for (int a = 0; a < nf; a++) {
      const double *row = s->full + number[w->free[a]] * nh;
      x[a] = 0;
      place[w->free[a]] = a;
      for (int b = 0; b < nf; b++) {
        double m = row[number[w->free[b]]];
        if (m != 0.0) m *= lag_level_weight(w, w->free[a]) * lag_level_weight(w, w->free[b]);
        s->kkt[a * nf + b] = m;
        if (m != 0.0) x[a] += pull * m * (w->asked[w->free[b]] - w->x[w->free[b]]);
      }
    }
    for (int e = 0; e < of->njacobian; e++) {
      int row = of->jacobian[e].row, a = place[of->jacobian[e].col];
      if (row < w->rows && a >= 0) A[row * nf + a] = w->A[e];
    }
    for (int k = 0; k < w->rows; k++) l[k] = -w->residual[k];
    regular = lag_kkt(nf, w->rows, 0, s->kkt);
    rc = regular || pass == 0 ? 0 : LAG_ESINGULAR;
  }
  memcpy(d, x, (size_t)nf * sizeof *d);
  return rc ? rc : lag_not_finite(nf, d) >= 0 ? LAG_ENAN : 0;
}

/* In the metric of the last step's M, in s->full. */
static double distance(const lag_level *w) {
  const Start *s = w->context;
  double sum = 0;
  for (int e = 0; e < s->nheld * s->nheld; e++) {
    int i = s->held[e / s->nheld], j = s->held[e % s->nheld];
    if (s->full[e] != 0.0)
      sum += lag_level_weight(w, i) * (w->x[i] - w->asked[i]) * s->full[e] * lag_level_weight(w, j) *
             (w->x[j] - w->asked[j]);
  }
  return sum;
}

static int stage(const lag_level *w, int i) {
  const Start *s = w->context;
  const lag_scene *c = s->sim->scene;
  int at = w->positions ? i : s->nq + i;
  if (!isnan(s->sim->start[at]) || (c->given && c->given[at] == 1)) return LAG_MOVES_LAST;
  return c->given && c->given[at] ? LAG_MOVES_SECOND : LAG_MOVES_FIRST;
}

static int is_contact(const lag_level *w, int k) {
  const Start *s = w->context;
  const lag_model *m = s->pb->model;
  int i = 0;
  while (i < m->ncontacts && m->contacts[i].constraint != k) i++;
  return i < m->ncontacts;
}

static void set_gaps(lag_sim *s, int closed) {
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->ncontacts; i++) {
    const lag_contact *c = &m->contacts[i];
    if (!c->is_tangent && !c->conditional) s->hold[c->input] = closed ? 1 : s->contact_was[i];
  }
}

/* Gaps that touch, by the rounding of their terms; rates of all gaps at x and as asked in residual and slope, their
 * sizes in terms_here. */
static int measure_gaps(Start *s, unsigned char *touch) {
  lag_level *w = &s->level;
  const lag_model *m = s->pb->model;
  const double t = s->sim->scene->t0, rounding = 0x1p12 * DBL_EPSILON;
  double *velocities = s->y + s->nq;
  memcpy(velocities, w->asked, (size_t)w->n * sizeof *velocities);
  int rc = lag_residuals(s->pb, t, s->y, s->other, w->slope);
  put(w);
  rc = rc ? rc : lag_constraint_terms(s->pb, t, s->y, 1, w->terms_here);
  for (int i = 0; i < m->ncontacts && rc == 0; i++) {
    int k = m->contacts[i].constraint;
    touch[i] = fabs(s->other[k]) <= rounding * w->terms_here[k];
  }
  rc = rc ? rc : lag_residuals(s->pb, t, s->y, s->other, w->residual);
  return rc ? rc : lag_constraint_terms(s->pb, t, s->y, 0, w->terms_here);
}

static int close_gap(const lag_level *w) {
  Start *s = w->context;
  const lag_model *m = s->pb->model;
  const double rounding = 0x1p12 * DBL_EPSILON;
  unsigned char *touch = calloc((size_t)m->ncontacts + 1, 1);
  double fastest = rounding;
  int which = -1;
  for (int i = 0; i < m->ncontacts; i++) s->sim->contact_was[i] = s->sim->hold[m->contacts[i].input];
  set_gaps(s->sim, 1);
  int rc = touch ? measure_gaps(s, touch) : LAG_ENOMEM;
  set_gaps(s->sim, 0);
  for (int i = 0; i < m->ncontacts && rc == 0; i++) {
    const lag_contact *c = &m->contacts[i];
    double size = w->terms_here[c->constraint], closing = -w->residual[c->constraint] / size;
    if (c->is_tangent || c->conditional || !touch[i] || lag_contact_is_closed(s->sim, c) || !(closing > fastest))
      continue;
    if (w->slope[c->constraint] < -rounding * size) continue; /* an impact that was asked for */
    fastest = closing;
    which = i;
  }
  free(touch);
  if (which >= 0) s->sim->hold[m->contacts[which].input] = 1;
  return which >= 0;
}

/* ---- starts that are refused */

static int refuse_start(Start *s, lag_start_kind kind, int k) {
  if (k < 0) return lag_fail(s->sim, LAG_EINVAL, "the constraints have no value at the start");
  const lag_constraint *c = &s->of->of[k];
  int positions = s->level.positions;
  char line[32];
  if (kind == LAG_START_BROKEN || kind == LAG_START_NONE)
    lag_report_residual(s->pb, k, positions, fabs(s->level.residual[k]), "");
  switch (kind) {
  case LAG_START_NO_VALUE:
    return lag_fail(s->sim, LAG_EINVAL, "the constraint %s%s has no value at the start: start where it has one",
                    c->name, lag_line_text(c, line));
  case LAG_START_STEEP:
    return lag_fail(s->sim, LAG_EINVAL,
                    "the derivatives of the constraint %s%s have no value where it holds: write it so that they have, "
                    "x = 1 in place of sqrt(x - 1) = 0",
                    c->name, lag_line_text(c, line));
  case LAG_START_FLAT:
    return lag_fail(
        s->sim, LAG_EINVAL,
        "the derivatives of the constraint %s%s vanish where it holds, so that no force can hold it: write it "
        "so that they do not, x = 0 in place of x^2 = 0",
        c->name, lag_line_text(c, line));
  case LAG_START_BROKEN:
    return lag_fail(s->sim, LAG_EINVAL,
                    "the start contradicts its constraints: %s%s; without `exactly` the nearest start is taken",
                    s->pb->words, positions ? "" : ", in its velocities");
  default:
    return lag_fail(s->sim, LAG_EINVAL,
                    "no start obeys the constraints; the nearest state found from the given start: %s%s", s->pb->words,
                    positions ? "" : " in its rate");
  }
}

/* Number of constraints stated on positions: without rates held at their start value. */
static int count_stated(const lag_constraints *of) {
  int n = 0;
  while (n < of->nholonomic && of->of[n].holonomic) n++;
  return n;
}

/* Takes up positions, or velocities, of y. */
static void begin_level(Start *s, int positions) {
  lag_level *w = &s->level;
  w->positions = positions;
  w->rows = positions ? count_stated(s->of) : s->of->n;
  memcpy(w->x, s->y + (positions ? 0 : s->nq), (size_t)s->nq * sizeof *w->x);
}

/* Brings positions or velocities to the constraints. */
static int project_level(Start *s, int positions) {
  int k;
  begin_level(s, positions);
  lag_start_kind kind = lag_consistent_state(&s->level, &k);
  put(&s->level);
  for (int i = 0; i < s->nq && positions; i++) s->sim->elsewhere[i] = s->level.ambiguous ? s->level.other[i] : NAN;
  return kind == LAG_START_FOUND ? LAG_OK : refuse_start(s, kind, k);
}

/* Rank of the constraints at y; marks[k] := 1 where constraint k depends on those before it; held[i] := squared
 * projection of coordinate i on their row space. The threshold is the coarse one of lag_kkt.h: at a singular place a
 * start is found to sqrt(eps) only. */
static int rank(Start *w, double *marks, double *held) {
  const double least = cbrt(DBL_EPSILON);
  int nq = w->nq, m = w->of->n, r = 0;
  double *Q = w->kkt, *unit = Q + m * nq;
  if (lag_constraint_jacobian(w->pb, w->sim->scene->t0, w->y, Q, unit, NULL))
    memset(Q, 0, (size_t)(m * nq + nq) * sizeof *Q);
  for (int k = 0; k < m; k++) {
    double left = lag_independent_part(nq, r, least, unit, Q, Q + k * nq);
    marks[k] = left >= 0 && !(left > least); /* an open contact is a row of zeros, and not marked */
    r += left > least;
  }
  memset(held, 0, (size_t)nq * sizeof *held);
  for (int i = 0; i < r * nq; i++) held[i % nq] += Q[i] * Q[i];
  return r;
}

/* Rank at the start and, where constraints are redundant, at a displaced solution: a larger rank there is a singular
 * start; sets loose. */
static void look_beside(Start *w) {
  lag_sim *s = w->sim;
  /* full is scratch of direction */
  double *here = w->best, *held = s->loose, *held_beside = w->full, *marks = w->other;
  s->run->rank = s->run->beside = rank(w, s->redundant, held);
  if (s->run->rank >= w->of->n - w->pb->model->ncontacts || w->nq < 2) {
    memset(s->loose, 0, (size_t)w->nq * sizeof(double));
    return;
  }
  memcpy(here, w->y, (size_t)w->pb->n * sizeof *here);
  begin_level(w, 1);
  int found = lag_state_beside(&w->level);
  put(&w->level);
  int r = found ? rank(w, marks, held_beside) : 0, singular = r > s->run->rank;
  s->run->beside = singular ? r : s->run->rank;
  memset(s->loose, 0, (size_t)(singular ? 0 : w->nq) * sizeof *s->loose);
  if (singular) lag_loose_directions(w->nq, held, held_beside, s->loose);
  memcpy(w->y, here, (size_t)w->pb->n * sizeof *here);
}

void lag_note_redundant(lag_sim *s) {
  const lag_constraints *of = s->scene->model->constraints;
  s->pb.redundant = 0;
  for (int k = 0; of && k < of->n; k++) s->pb.redundant |= s->redundant[k] > 0;
}

/* Refuses a start where accelerations do not exist because a coordinate has neither inertia nor a constraint that
 * moves it. */
static int check_inertia(Start *w) {
  lag_problem *pb = w->pb;
  int which;
  if (lag_rhs(pb, w->sim->scene->t0, w->y, w->best) != LAG_ESINGULAR ||
      !(lag_mass_condition(pb, w->sim->scene->t0, w->y, &which) > 1e12))
    return LAG_OK;
  return lag_fail(w->sim, LAG_EINVAL,
                  "the mass matrix is singular: %s has no inertia at the start, and no "
                  "constraint determines its motion; give it a mass, or a constraint that depends on it",
                  pb->model->q[which].name);
}

/* Refuses constraints that are dependent at the start `now` and contradict each other soon after: x = 0 and x' = a t
 * agree at t = 0 and nowhere else. Without this check such a run would write its first row and end after 1e-13 s.
 * lagc check (claims/mobility.c) tests at the same time. */
static int check_compatibility(lag_sim *s) {
  lag_problem *pb = &s->pb;
  const lag_constraints *of = pb->model->constraints;
  const lag_scene *scene = s->scene;
  double after = (scene->has_span ? scene->t1 - scene->t0 : 1) / 1024;
  int dependent = s->run->rank < of->n - pb->model->ncontacts, singular = s->run->beside > s->run->rank;
  if (!dependent || singular) return LAG_OK;
  lag_copy(pb->n, s->now, s->yc);
  int rc = lag_project(pb, scene->t0 + after, s->yc, NULL);
  const char *why = pb->detail;
  pb->detail = NULL;
  return rc > 0 && why ? lag_fail(s, LAG_EINVAL,
                                  "constraints contradict each other soon after the start: at t = %.3g s %s; leave one "
                                  "of them out, or make "
                                  "them agree",
                                  scene->t0 + after, why)
                       : LAG_OK;
}

/* Undoes moves below the last digit of the largest component of the same unit. */
static void keep_rounding_out(const Start *w) {
  for (int i = 0; i < 2 * w->nq; i++) {
    const double *level = i < w->nq ? w->y : w->y + w->nq;
    if (w->y[i] != w->asked[i] &&
        fabs(w->y[i] - w->asked[i]) <= DBL_EPSILON / 4 * lag_unit_magnitude(w->pb, level, i % w->nq))
      w->y[i] = w->asked[i];
  }
}

/* Lists the coordinates that a constraint contains. */
static void list_held(Start *s) {
  for (int i = 0; i < s->nq; i++) s->number[i] = -1;
  for (int e = 0; e < s->of->njacobian; e++) s->number[s->of->jacobian[e].col] = 0;
  for (int i = 0; i < s->nq; i++) {
    if (s->number[i] < 0) continue;
    s->held[s->nheld] = i;
    s->number[i] = s->nheld++;
  }
}

/* Allocates the work space, one block of doubles and one of integers. 0: no memory. */
static int make_room(Start *s, double **block) {
  lag_level *w = &s->level;
  size_t n = (size_t)s->pb->n, nq = (size_t)s->nq, m = (size_t)s->of->n, entries = (size_t)s->of->njacobian;
  *block = NULL;
  s->index = malloc((4 * nq + 2 * entries + 1) * sizeof *s->index);
  if (!s->index) return 0;
  int *row = s->index + nq, *col = row + entries;
  for (size_t e = 0; e < entries; e++) {
    row[e] = s->of->jacobian[e].row;
    col[e] = s->of->jacobian[e].col;
  }
  w->free = s->index;
  w->row = row;
  w->col = col;
  s->place = col + entries;
  s->number = s->place + nq;
  s->held = s->number + nq;
  list_held(s);
  size_t nh = (size_t)s->nheld, step = 2 * (nh * nh + m * nh) + 3 * nh + m + m * m + 9 * m, rows = m * nq + nq + 2 * m;
  const lag_part parts[] = {{&s->y, n}, {&s->asked, n}, {&s->best, n}, {&s->other, m}, {&s->M, (size_t)s->of->nmass},
      {&s->full, nh * nh > nq ? nh * nh : nq}, {&s->kkt, step > rows ? step : rows}, {&w->x, nq},
      {&w->asked, nq}, {&w->best, nq}, {&w->from, nq}, {&w->d, nq}, {&w->along, nq}, {&w->reach, nq},
      {&w->nearest, nq}, {&w->other, nq}, {&w->residual, m}, {&w->size, m}, {&w->terms_here, m}, {&w->slope, m},
      {&w->has_terms, m},
      {&w->A, entries}};
  *block = lag_workspace(sizeof parts / sizeof *parts, parts);
  return *block != NULL;
}

static int begin_start(Start *w, double **block) {
  lag_sim *s = w->sim;
  w->level = (lag_level){.context = w,
                         .n = w->nq, .entries = w->of->njacobian, .exactly = s->scene->exactly != 0,
                         .rounding = DBL_EPSILON, .residuals = residuals, .jacobian = jacobian, .terms = terms,
                         .scales = scales, .direction = direction, .distance = distance, .stage = stage,
                         .is_contact = is_contact, .close_gap = w->pb->model->ncontacts ? close_gap : NULL};
  return make_room(w, block);
}

/* change[rows] of the level := that of its residuals along e[n] over h, with the parameters of column j (-1: none). */
static int residual_change(Start *w, const lag_parameter_columns *by, int positions, int j, double h, const double *e,
                           double *change) {
  lag_sim *s = w->sim;
  const double *p = w->pb->p;
  int rc = LAG_OK, rows = positions ? count_stated(w->of) : w->of->n;
  double *c = w->kkt, *r = c + w->of->n;
  memset(change, 0, (size_t)rows * sizeof *change);
  LAG_EACH_DIFFERENCE(k) {
    if (j >= 0) w->pb->p = lag_shifted_parameters(w->pb, by, j, k);
    for (int i = 0; i < w->pb->n; i++) w->y[i] = s->now[i] + k * h * e[i];
    rc = rc ? rc : lag_residuals(w->pb, s->scene->t0, w->y, c, r);
    for (int i = 0; i < rows; i++) change[i] += lag_difference_weight(k) * (positions ? c : r)[i] / h;
    w->pb->p = p;
  }
  memcpy(w->y, s->now, (size_t)w->pb->n * sizeof *w->y);
  return rc;
}

/* asked := the request, where the nearest state differs from it by rounding only that state. */
static void ask_again(Start *w, int positions) {
  const double rounding = 1e-12; /* the part of the change that the curvature of constraints then adds */
  lag_level *l = &w->level;
  const double *asked = w->sim->asked + (positions ? 0 : w->nq);
  for (int i = 0; i < w->nq; i++)
    l->asked[i] = fabs(l->x[i] - asked[i]) <= rounding * lag_unit_magnitude(w->pb, l->x, i) ? l->x[i] : asked[i];
}

int lag_start_change(lag_sim *s, const lag_parameter_columns *by, int j, double h, double *e) {
  Start w = {.sim = s, .pb = &s->pb, .of = s->scene->model->constraints, .nq = s->pb.nq};
  double *block, *change;
  if (w.pb->model->ncontacts || s->run->rank < w.of->n) return 0;
  change = calloc((size_t)(w.of->n + w.nq) + 1, sizeof *change);
  int known = begin_start(&w, &block) && change;
  for (int positions = 1; positions >= 0 && known; positions--) {
    double *d = change + w.of->n, *part = e + (positions ? 0 : w.nq);
    known = residual_change(&w, by, positions, j, h, e, change) == LAG_OK;
    begin_level(&w, positions);
    ask_again(&w, positions);
    known = known && lag_state_change(&w.level, change, d);
    for (int i = 0; i < w.nq && known; i++) part[i] += d[i];
  }
  lag_free_all(change, block, w.index);
  return known;
}

int lag_consistent_start(lag_sim *s) {
  Start w = {.sim = s, .pb = &s->pb, .of = s->scene->model->constraints, .nq = s->pb.nq};
  size_t bytes = (size_t)s->pb.n * sizeof(double);
  double *block;
  int rc = LAG_ENOMEM;
  memcpy(s->asked, s->now, bytes);
  if (!w.of) return LAG_OK;
  if (begin_start(&w, &block)) {
    memcpy(w.y, s->now, bytes);
    memcpy(w.asked, s->now, bytes);
    lag_release_integrals(s);
    rc = project_level(&w, 1);
    rc = rc ? rc : project_level(&w, 0);
    lag_contact_open(s);
    if (rc == 0) {
      keep_rounding_out(&w);
      memcpy(s->now, w.y, bytes);
      rc = lag_hold_integrals(s, s->scene->t0, s->now);
      look_beside(&w);
      lag_note_redundant(s);
      rc = rc ? rc : check_inertia(&w);
      rc = rc ? rc : check_compatibility(s);
    }
  }
  lag_free_all(block, w.index);
  if (rc != LAG_ENOMEM) return rc;
  double megabytes = 3e-6 * sizeof(double) * w.nheld * w.nheld; /* make_room: full, kkt */
  return lag_fail(s, rc,
                  "out of memory: the start on the constraints takes %.0f MB for the %d coordinates that they contain; "
                  "constraints of fewer coordinates take less",
                  megabytes, w.nheld);
}
