/* Consistent start. Enters: the start as scene and caller set it, and which components they set; leaves: the nearest start on the constraints.
 * Holds: components that nobody set move first, the others only where that does not suffice; a start that obeys the constraints to rounding is
 * not touched.
 *
 * Positions: Gauss-Newton steps, damped until the residual falls (P. Deuflhard, Newton Methods for Nonlinear Problems (2004), 4.3, DOI
 * 10.1007/978-3-642-23899-4), then Newton-like steps along the constraints to the nearest place in the mass metric. Velocities: one linear
 * problem, repeated for its rounding. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "numeric/workspace.h"
#include "lag_kkt.h"

enum { MOST_STEPS = 100, MOST_HALVINGS = 30, TRIES = 9 };

typedef struct Start {
  lag_sim *sim;
  lag_problem *pb;
  const lag_constraints *of;
  int n, nq, holonomic;      /* level at hand, positions (holonomic) or velocities, and its number of constraints */
  int *free, nfree;          /* [nfree] components of q, or of v, that may move */
  double *y, *asked, *best;  /* [pb->n] */
  double *residual, *other;  /* [constraints] residual of the level at hand, c or r, and of the other level */
  double *size;              /* [constraints] size of terms, by which residuals are divided in the merit function */
  double *says;              /* [constraints] 1: the constraint has terms of finite size */
  double *A, *M;             /* sparse entries */
  double *full, *kkt;        /* [nq nq], work of lag_kkt */
} Start;

/* Solves for the step d of the free components: M d - A^T l = pull M (asked - y), A d = -residual. */
static int direction(Start *w, double pull, double *d)
{
  lag_problem *pb = w->pb;
  const lag_constraints *of = w->of;
  int nq = w->nq, nf = w->nfree, at = w->holonomic ? 0 : nq, rc = lag_inputs(pb, w->sim->scene->t0);
  const double *y = w->y;
  double *A = w->kkt + nf * nf, *x = A + w->n * nf, *l = x + nf;

  rc = rc ? rc : of->matrices(w->sim->scene->t0, y, y + nq, y + 2 * nq, pb->p, pb->u, w->A, w->M, pb->work);
  for (int regular = 0, pass = 0; pass < 2 && rc == 0 && !regular; pass++) {
    memset(w->full, 0, (size_t)(nq * nq) * sizeof(double));
    for (int e = 0; e < of->nmass; e++) {
      int i = of->mass[e].row, j = of->mass[e].col;
      w->full[i * nq + j] = w->full[j * nq + i] = w->M[e];
    }
    for (int i = 0; i < nq && pass == 1; i++) { /* M is singular: the identity takes its place */
      memset(w->full + i * nq, 0, (size_t)nq * sizeof(double));
      w->full[i * nq + i] = 1;
    }
    memset(A, 0, (size_t)(w->n * nf) * sizeof(double));
    for (int a = 0; a < nf; a++) {
      x[a] = 0;
      for (int b = 0; b < nf; b++) {
        double m = w->full[w->free[a] * nq + w->free[b]];
        w->kkt[a * nf + b] = m;
        x[a] += pull * m * (w->asked[at + w->free[b]] - y[at + w->free[b]]);
      }
      for (int e = 0; e < of->njacobian; e++) {
        if (of->jacobian[e].row < w->n && of->jacobian[e].col == w->free[a]) {
          A[of->jacobian[e].row * nf + a] = w->A[e];
        }
      }
    }
    for (int k = 0; k < w->n; k++) {
      l[k] = -w->residual[k];
    }
    regular = lag_kkt(nf, w->n, 0, w->kkt);
    rc = regular || pass == 0 ? 0 : LAG_ESINGULAR;
  }
  memcpy(d, x, (size_t)nf * sizeof *d);
  return rc ? rc : lag_not_finite(nf, d) >= 0 ? LAG_ENAN : 0;
}

static int residuals(Start *w)
{
  return lag_residuals(w->pb, w->sim->scene->t0, w->y, w->holonomic ? w->residual : w->other, w->holonomic ? w->other : w->residual);
}

/* Merit function: sum of squared residuals relative to their terms at the start. Infinite where it has no value, so that no step leads there. */
static double merit(Start *w)
{
  double s = 0;

  if (residuals(w)) {
    return HUGE_VAL;
  }
  for (int k = 0; k < w->n; k++) {
    double x = w->residual[k] / w->size[k];
    s += x * x;
  }
  return isfinite(s) ? s : HUGE_VAL;
}

static void move(Start *w, const double *from, double part, const double *d)
{
  int at = w->holonomic ? 0 : w->nq;

  for (int a = 0; a < w->nfree; a++) {
    w->y[at + w->free[a]] = from[at + w->free[a]] + part * d[a];
  }
}

/* The residual of the worst constraint in units of the rounding of its terms. */
static double worst(Start *w)
{
  double size = HUGE_VAL;

  lag_worst_constraint(w->pb, w->sim->scene->t0, w->y, w->holonomic, &size);
  return size;
}

/* Damped Gauss-Newton steps from y; returns whether they arrive at the constraints. */
static int descend(Start *w)
{
  double *d = w->best + w->pb->n, *from = d + w->nq, before = merit(w);

  for (int step = 0; step < MOST_STEPS && before > 0 && w->nfree > 0; step++) {
    double part = 1, now = HUGE_VAL;
    memcpy(from, w->y, (size_t)w->pb->n * sizeof *from);
    if (direction(w, 0, d)) {
      return 0;
    }
    for (int i = 0; i < MOST_HALVINGS && !(now < before); i++, part /= 2) {
      move(w, from, part, d);
      now = merit(w);
    }
    if (!(now < before * (1 - 1e-6))) {
      break;
    }
    before = now;
  }
  if (!(merit(w) <= before)) {
    memcpy(w->y, from, (size_t)w->pb->n * sizeof *from);
  }
  return worst(w) <= 0x1p10;
}

/* |y - asked|^2 in the mass metric at y; w->full holds M. */
static double distance(const Start *w)
{
  double s = 0;
  int at = w->holonomic ? 0 : w->nq;

  for (int i = 0; i < w->nq; i++) {
    for (int j = 0; j < w->nq; j++) {
      s += (w->y[at + i] - w->asked[at + i]) * w->full[i * w->nq + j] * (w->y[at + j] - w->asked[at + j]);
    }
  }
  return s;
}

/* Moves y along the constraints towards `asked`, as long as steps lead nearer. */
static void approach(Start *w)
{
  double *d = w->best + w->pb->n;
  size_t bytes = (size_t)w->pb->n * sizeof(double);

  for (int step = 0; step < MOST_STEPS; step++) {
    memcpy(w->best, w->y, bytes);
    if (residuals(w) || direction(w, 1, d)) {
      break;
    }
    double before = distance(w);
    move(w, w->best, 1, d);
    if (!descend(w) || !(distance(w) < before * (1 - 1e-14))) {
      memcpy(w->y, w->best, bytes);
      break;
    }
  }
}

/* Number of constraints stated on positions: without rates held at their start value. */
static int count_stated(const lag_constraints *of)
{
  int n = 0;

  while (n < of->nholonomic && of->of[n].holonomic) {
    n++;
  }
  return n;
}

/* Whether a constraint on positions contains coordinate i. */
static int is_held(const Start *w, int i)
{
  for (int e = 0; e < w->of->njacobian; e++) {
    if (w->of->jacobian[e].row < count_stated(w->of) && w->of->jacobian[e].col == i) {
      return 1;
    }
  }
  return 0;
}

/* Reaches the constraints by moving free components. Where no step helps, as half-way between two solutions, it tries displaced starts: above
 * first, then ever further. */
static int reach_constraints(Start *w)
{
  static const double beside[TRIES] = {0, 1e-3, -1e-3, 0.03, -0.03, 0.3, -0.3, 1, -1};
  double typical = 0;
  int at = w->holonomic ? 0 : w->nq, tries = w->holonomic ? TRIES : 1;

  for (int i = 0; i < w->nq; i++) {
    typical = fmax(typical, fabs(w->asked[at + i]));
  }
  for (int k = 0; k < tries && w->nfree > 0; k++) {
    memcpy(w->y + at, w->asked + at, (size_t)w->nq * sizeof(double));
    for (int a = 0; a < w->nfree; a++) {
      w->y[at + w->free[a]] += !is_held(w, w->free[a]) ? 0 : beside[k] * (typical > 0 ? typical : 1) * (0.5 + fmod(0.618033988749894848 * (a + 1), 1));
    }
    if (descend(w)) {
      if (w->holonomic) {
        approach(w);
      }
      return 1;
    }
  }
  return 0;
}

/* Stages, in the order in which components may move: those that nobody set, rotations that nobody set, all. */
enum { UNSET, ROTATIONS, ALL };

static int yields_at(const Start *w, int i)
{
  const lag_scene *c = w->sim->scene;

  if (!isnan(w->sim->start[i]) || (c->given && c->given[i] == 1)) {
    return ALL;
  }
  return c->given && c->given[i] ? ROTATIONS : UNSET;
}

/* w->free := the components that may move at this stage. */
static void choose_free(Start *w, int stage)
{
  int at = w->holonomic ? 0 : w->nq;

  w->nfree = 0;
  for (int i = 0; i < w->nq; i++) {
    if (yields_at(w, at + i) <= stage) {
      w->free[w->nfree++] = i;
    }
  }
}

/* ---- starts that are refused */

/* Reports the worst constraint, which cannot be met, or (exactly) is not met by the start. */
static int refuse_start(Start *w, int exactly)
{
  int k = lag_worst_constraint(w->pb, w->sim->scene->t0, w->y, w->holonomic, NULL);

  if (residuals(w) || k < 0) {
    return lag_fail(w->sim, LAG_EINVAL, "the constraints have no value at the start");
  }
  const lag_constraint *c = &w->of->of[k];
  if (!isfinite(w->residual[k])) {
    char line[32];
    return lag_fail(w->sim, LAG_EINVAL, "the constraint %s%s has no value at the start: start where it has one", c->name, lag_line_text(c, line));
  }
  lag_report_residual(w->pb, k, w->holonomic, fabs(w->residual[k]), "");
  if (exactly) {
    return lag_fail(w->sim, LAG_EINVAL, "the start contradicts its constraints: %s%s; without `exactly` the nearest start is taken",
                    w->pb->words, w->holonomic ? "" : ", in its velocities");
  }
  return lag_fail(w->sim, LAG_EINVAL, "no start obeys the constraints; the nearest state found from the given start: %s%s",
                  w->pb->words, w->holonomic ? "" : " in its rate");
}

static int is_contact(const Start *w, int k)
{
  const lag_model *m = w->pb->model;
  int i = 0;

  while (i < m->ncontacts && m->contacts[i].constraint != k) {
    i++;
  }
  return i < m->ncontacts;
}

/* size[n] := first-order change of each constraint when every coordinate moves by its typical magnitude. */
static int first_order_sizes(Start *w, double *size)
{
  const lag_constraints *of = w->of;
  int nq = w->nq;

  memset(size, 0, (size_t)of->n * sizeof *size);
  if (of->matrices(w->sim->scene->t0, w->y, w->y + nq, w->y + 2 * nq, w->pb->p, w->pb->u, w->A, w->M, w->pb->work)) {
    return 0;
  }
  for (int e = 0; e < of->njacobian; e++) {
    int i = of->jacobian[e].col;
    size[of->jacobian[e].row] += fabs(w->A[e]) * fmax(lag_typical_magnitude(w->pb, w->y, 1, i), lag_typical_magnitude(w->pb, w->asked, 1, i));
  }
  return 1;
}

static int is_flat(const Start *w, int k, const double *size)
{
  return w->says[k] != 0.0 && size[k] < 1e-6 * w->size[k];
}

/* Whether constraint k, whose derivatives vanish at y, has vanishing derivatives at a displaced solution, too; not so for a linkage at its dead
 * centre. y stays. */
static int is_flat_beside(Start *w, int k)
{
  double *size = w->other, *here = w->best;
  size_t bytes = (size_t)w->pb->n * sizeof(double);

  memcpy(here, w->y, bytes);
  choose_free(w, ALL);
  for (int i = 0; i < w->nq; i++) {
    w->y[i] += !is_held(w, i) ? 0 : 0.01 * lag_typical_magnitude(w->pb, here, 1, i) * (0.5 + fmod(0.618033988749894848 * (i + 1), 1));
  }
  int flat = !descend(w) || !first_order_sizes(w, size) || is_flat(w, k, size);
  memcpy(w->y, here, bytes);
  first_order_sizes(w, size);
  return flat;
}

/* Refuses a constraint whose derivatives vanish where it holds, as those of x^2 = 0: no force can hold it. A constraint without terms, as with a
 * factor that is 0, is left alone. reached: y obeys the constraints. */
static int check_derivatives(Start *w, int reached)
{
  double *size = w->other;
  char line[32];

  if (!first_order_sizes(w, size)) {
    return LAG_OK;
  }
  for (int k = 0; k < count_stated(w->of); k++) {
    const lag_constraint *c = &w->of->of[k];
    if (is_contact(w, k)) {
      continue;
    }
    if (!isfinite(size[k]) && reached) {
      return lag_fail(w->sim, LAG_EINVAL, "the derivatives of the constraint %s%s have no value where it holds: write it so that they have, "
                      "x = 1 in place of sqrt(x - 1) = 0", c->name, lag_line_text(c, line));
    }
    int held = reached || fabs(w->residual[k]) <= 1e-6 * w->size[k];
    if (is_flat(w, k, size) && held && (!reached || is_flat_beside(w, k))) {
      return lag_fail(w->sim, LAG_EINVAL, "the derivatives of the constraint %s%s vanish where it holds, so that no force can hold it: write it "
                      "so that they do not, x = 0 in place of x^2 = 0", c->name, lag_line_text(c, line));
    }
  }
  return LAG_OK;
}

/* w->size := sizes of terms at the start, 1 where there are none; w->says: whether there are. */
static void look_at_terms(Start *w)
{
  int rc = lag_constraint_terms(w->pb, w->sim->scene->t0, w->y, w->holonomic, w->size);

  for (int k = 0; k < w->n; k++) {
    w->says[k] = rc == 0 && w->size[k] > 0 && isfinite(w->size[k]);
    w->size[k] = w->says[k] != 0.0 ? w->size[k] : 1;
  }
}

/* Brings positions (holonomic) or velocities to the constraints, stage by stage. */
static int project_level(Start *w, int holonomic)
{
  w->holonomic = holonomic;
  w->n = holonomic ? count_stated(w->of) : w->of->n;
  if (w->n == 0) {
    return LAG_OK;
  }
  double off = worst(w);
  look_at_terms(w);
  if (!isfinite(merit(w))) {
    return refuse_start(w, 0);
  }
  if (off <= 2) {
    return holonomic ? check_derivatives(w, 1) : LAG_OK;
  }
  if (w->sim->scene->exactly && !(off <= sqrt(DBL_EPSILON) / DBL_EPSILON)) {
    return refuse_start(w, 1);
  }
  for (int stage = UNSET; stage <= ALL; stage++) {
    int before = w->nfree;
    choose_free(w, stage);
    if ((stage == UNSET || w->nfree != before) && reach_constraints(w)) {
      return holonomic ? check_derivatives(w, 1) : LAG_OK;
    }
  }
  memcpy(w->y + (holonomic ? 0 : w->nq), w->asked + (holonomic ? 0 : w->nq), (size_t)w->nq * sizeof(double));
  descend(w); /* as near as possible, for the message */
  int rc = holonomic ? check_derivatives(w, 0) : LAG_OK;
  return rc ? rc : refuse_start(w, 0);
}

/* Rank of the constraints at y; marks[k] := 1 where constraint k depends on those before it; held[i] := squared projection of coordinate i on
 * their row space. The threshold is the coarse one of lag_kkt.h: at a singular place a start is found to sqrt(eps) only. */
static int rank(Start *w, double *marks, double *held)
{
  const double least = cbrt(DBL_EPSILON);
  int nq = w->nq, m = w->of->n, r = 0;
  double *Q = w->kkt, *unit = Q + m * nq;

  if (lag_constraint_jacobian(w->pb, w->sim->scene->t0, w->y, Q, unit, NULL)) {
    memset(Q, 0, (size_t)(m * nq + nq) * sizeof *Q);
  }
  for (int k = 0; k < m; k++) {
    double left = lag_independent_part(nq, r, least, unit, Q, Q + k * nq);
    marks[k] = left >= 0 && !(left > least); /* an open contact is a row of zeros, and not marked */
    r += left > least;
  }
  memset(held, 0, (size_t)nq * sizeof *held);
  for (int i = 0; i < r * nq; i++) {
    held[i % nq] += Q[i] * Q[i];
  }
  return r;
}

/* Moves y to a solution about a hundredth away from here[pb->n]; returns whether there is one. */
static int go_beside(Start *w, const double *here)
{
  choose_free(w, ALL);
  for (int i = 0; i < w->nq; i++) {
    w->y[i] += 0.01 * lag_typical_magnitude(w->pb, here, 1, i) * (0.5 + fmod(0.618033988749894848 * (i + 1), 1));
  }
  return descend(w);
}

/* Rank at the start and, where constraints are redundant, at a displaced solution: a larger rank there is a singular start; sets loose. */
static void look_beside(Start *w)
{
  lag_sim *s = w->sim;
  const double part = 0.05; /* change of a squared projection: twice the effect of turning a direction by a hundredth */
  double *here = w->best, *held = s->loose, *held_beside = w->full, *marks = w->other; /* full is scratch of go_beside */

  s->run->rank = s->run->beside = rank(w, s->redundant, held);
  if (s->run->rank >= w->of->n - w->pb->model->ncontacts || w->nq < 2) {
    memset(s->loose, 0, (size_t)w->nq * sizeof(double));
    return;
  }
  memcpy(here, w->y, (size_t)w->pb->n * sizeof *here);
  w->holonomic = 1;
  w->n = count_stated(w->of);
  look_at_terms(w);
  int r = go_beside(w, here) ? rank(w, marks, held_beside) : 0;
  int singular = r > s->run->rank;
  s->run->beside = singular ? r : s->run->rank;
  for (int i = 0; i < w->nq; i++) {
    s->loose[i] = singular && held_beside[i] - held[i] > part;
  }
  memcpy(w->y, here, (size_t)w->pb->n * sizeof *here);
}

void lag_note_redundant(lag_sim *s)
{
  const lag_constraints *of = s->scene->model->constraints;

  s->pb.redundant = 0;
  for (int k = 0; of && k < of->n; k++) {
    s->pb.redundant |= s->redundant[k] > 0;
  }
}

/* Refuses a start where accelerations do not exist because a coordinate has neither inertia nor a constraint that moves it. */
static int check_inertia(Start *w)
{
  lag_problem *pb = w->pb;
  int which;

  if (lag_rhs(pb, w->sim->scene->t0, w->y, w->best) != LAG_ESINGULAR || !(lag_mass_condition(pb, w->sim->scene->t0, w->y, &which) > 1e12)) {
    return LAG_OK;
  }
  return lag_fail(w->sim, LAG_EINVAL, "the mass matrix is singular: %s has no inertia at the start, and no "
                  "constraint determines its motion; give it a mass, or a constraint that depends on it", pb->model->q[which].name);
}

/* Undoes moves below the last digit of the largest component of the same unit. */
static void keep_rounding_out(const Start *w)
{
  for (int i = 0; i < 2 * w->nq; i++) {
    const double *level = i < w->nq ? w->y : w->y + w->nq;
    if (fabs(w->y[i] - w->asked[i]) <= DBL_EPSILON / 4 * lag_unit_magnitude(w->pb, level, i % w->nq)) {
      w->y[i] = w->asked[i];
    }
  }
}

/* Allocates the work space, one block. */
static double *make_room(Start *w)
{
  size_t n = (size_t)w->pb->n, nq = (size_t)w->nq, m = (size_t)w->of->n;
  const size_t sizes[] = {n, n, 2 * n + nq, m, m, m, m, (size_t)w->of->njacobian, (size_t)w->of->nmass, nq * nq,
                          2 * (nq * nq + m * nq) + 3 * nq + m + m * m + 9 * m};
  double **const parts[] = {&w->y, &w->asked, &w->best, &w->residual, &w->other, &w->size, &w->says, &w->A, &w->M, &w->full, &w->kkt};

  return lag_workspace(sizeof sizes / sizeof *sizes, parts, sizes);
}

int lag_consistent_start(lag_sim *s)
{
  Start w = {.sim = s, .pb = &s->pb, .of = s->scene->model->constraints, .nq = s->pb.nq};
  size_t bytes = (size_t)s->pb.n * sizeof(double);
  int rc = LAG_ENOMEM;

  memcpy(s->asked, s->now, bytes);
  if (!w.of) {
    return LAG_OK;
  }
  double *block = make_room(&w);
  w.free = malloc(((size_t)w.nq + 1) * sizeof *w.free);
  if (block && w.free) {
    memcpy(w.y, s->now, bytes);
    memcpy(w.asked, s->now, bytes);
    lag_release_integrals(s);
    rc = project_level(&w, 1);
    rc = rc ? rc : project_level(&w, 0);
    if (rc == 0) {
      keep_rounding_out(&w);
      memcpy(s->now, w.y, bytes);
      rc = lag_hold_integrals(s, s->scene->t0, s->now);
      look_beside(&w);
      lag_note_redundant(s);
      rc = rc ? rc : check_inertia(&w);
      rc = rc ? rc : lag_constraint_compatibility(s);
    }
  }
  free(block);
  free(w.free);
  return rc == LAG_ENOMEM ? lag_fail(s, rc, "out of memory") : rc;
}
