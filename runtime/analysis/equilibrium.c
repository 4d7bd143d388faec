/* The equations of a model at rest, their perturbation noise, and the search for an equilibrium: trust region,
 * Newton's method and overdamped motion (equilibrium.h), with a test for roots that accounts for rounding of the
 * model's numbers. */
#include "analysis/equilibrium.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "numeric/dense.h"
#include "numeric/magnitudes.h"

enum { MOST_STEPS = 200, MOST_DESCENT = 200, MOST_TURNS = 32 };

/* A root is reached when a Newton step is no longer than this, relative to the state and its scale. */
static const double NEAR = 1e-9;
/* A force up to this many times its perturbation noise counts as 0: it takes a few more operations. */
static const double CERTAIN = 8;
/* Relative perturbation: differences of values then keep half of their digits. */
static const double MOVE = 1.0 / (1 << 26);

/* ---- The model at rest */

void lag_equilibrium_state(Equilibrium *r, const double *x) {
  int nq = r->sim->pb.nq;
  for (int i = 0; i < r->n; i++) r->y[i < nq ? i : nq + i] = x[i] * r->scale[i];
}

/* An lag_equations: forces M a (a from the model, so that both vanish together) and rates, of an Equilibrium at
 * x[n]. Leaves the state in y, y' in rate, and M. */
static int equations(void *context, const double *x, double *f, double *J) {
  Equilibrium *r = context;
  lag_problem *pb = &r->sim->pb;
  int nq = pb->nq, n = r->n;
  double t = r->sim->run->t;
  lag_equilibrium_state(r, x);
  int rc = lag_rhs(pb, t, r->y, r->rate);
  rc = rc ? rc : lag_linearise(pb, t, r->y, NULL, r->dr, r->M, r->work);
  for (int i = 0; i < n && rc == 0; i++) {
    double weight = (i < nq ? r->scale[i] : 1 / r->scale[i]) * r->row[i], sum = 0;
    for (int j = 0; j < nq && i < nq; j++) sum += r->M[i * nq + j] * r->rate[nq + j];
    f[i] = weight * (i < nq ? sum : r->rate[nq + i]);
    for (int j = 0; j < n && J; j++) J[i * n + j] = weight * r->dr[i * pb->n + (j < nq ? j : nq + j)] * r->scale[j];
  }
  return rc;
}

/* ---- Perturbation noise */

/* Perturbs the elements of z[n] that belong to pass `turn`: those whose number, counted from `first`, is `turn`
 * modulo MOST_TURNS. */
static void perturb(double *z, int n, int first, int turn) {
  for (int i = 0; i < n; i++) {
    int at = first + i;
    if (at % MOST_TURNS == turn) z[i] *= at / MOST_TURNS % 2 ? 1 - MOVE : 1 + MOVE;
  }
}

int lag_perturbation_noise(Equilibrium *r, lag_values *values, const double *x, size_t count, double *base,
                           double *noise, double *scratch) {
  lag_problem *pb = &r->sim->pb;
  const double *given = pb->p;
  int np = pb->model->np, n = r->n, turns = np + n < MOST_TURNS ? np + n : MOST_TURNS;
  double *out = scratch, *p = out + count, *at = p + np + pb->model->nderived;
  int rc = values(r, x, base);
  memset(noise, 0, count * sizeof *noise);
  for (int turn = 0; turn < turns && rc == 0; turn++) {
    memcpy(p, given, (size_t)np * sizeof *p);
    memcpy(at, x, (size_t)n * sizeof *at);
    perturb(p, np, 0, turn);
    if (pb->model->derive) pb->model->derive(pb->model, p);
    perturb(at, n, np, turn);
    pb->p = p;
    if (values(r, at, out) == 0 && lag_not_finite((int)count, out) < 0)
      for (size_t i = 0; i < count; i++) noise[i] += fabs(out[i] - base[i]) * (DBL_EPSILON / MOVE);
    pb->p = given;
  }
  return rc;
}

/* ---- Regularity of a place */

/* Distance of M[n * n] from a singular matrix: the least pivot of symmetric elimination relative to size[n], the
 * usual diagonal. M is destroyed. */
static double least_pivot(int n, double *M, const double *size) {
  double least = HUGE_VAL;
  for (int k = 0; k < n; k++) {
    double pivot = M[k * n + k];
    least = size[k] > 0 ? fmin(least, fabs(pivot) / size[k]) : least;
    for (int i = k + 1; i < n && pivot != 0.0; i++) lag_eliminate_row(n, M, k, i);
  }
  return least;
}

/* Whether the mass matrix is nearly singular at r->x and not nearby: a coordinate loses its meaning, as longitude
 * does at a pole. This test and the next leave r's values undefined. */
static int is_coordinate_pole(Equilibrium *r) {
  int n = r->n, nq = r->sim->pb.nq;
  double *size = r->dx;
  for (int i = 0; i < n; i++) { /* a tenth of a scale away, along no diagonal */
    r->trial[i] = r->x[i] + 0.1 / (1 + 0.3 * (i % 3));
  }
  if (equations(r, r->trial, r->f, NULL)) return 0;
  for (int i = 0; i < nq; i++) size[i] = fabs(r->M[i * nq + i]);
  double beside = least_pivot(nq, r->M, size);
  double here = equations(r, r->x, r->f, NULL) ? 0 : least_pivot(nq, r->M, size);
  return here < 1e-9 * beside;
}

/* to[n * n] := derivatives of the forces with each unknown displaced by +-c. */
static int displaced_derivatives(Equilibrium *r, int pattern, double c, double *to) {
  for (int i = 0; i < r->n; i++) {
    double sign = (pattern & 1 ? -1 : 1) * (pattern & 2 && i % 2 ? -1 : 1);
    r->trial[i] = r->x[i] + sign * c;
  }
  return equations(r, r->trial, r->f, to);
}

/* Whether derivatives change within 1e-9 of a scale as much as within 1e-3; smooth ones change a million times less. */
static int changes_at_once(int n, const double *here, const double *near, const double *far) {
  for (int i = 0; i < n; i++) {
    double most = 0;
    for (int j = 0; j < n; j++) most = fmax(most, fmax(fabs(here[i * n + j]), fabs(far[i * n + j])));
    for (int j = 0; j < n; j++) {
      double a = fabs(near[i * n + j] - here[i * n + j]), b = fabs(far[i * n + j] - here[i * n + j]);
      if (a > 0.1 * b && a > 1e-6 * most) return 1;
    }
  }
  return 0;
}

/* Whether derivatives of forces jump here, or have no limit. */
static int is_nonsmooth(Equilibrium *r) {
  double *here = r->J, *near = r->W, *far = r->scratch;
  int rough = 0;
  for (int pattern = 0; pattern < 4 && !rough; pattern++) {
    rough = displaced_derivatives(r, pattern, 0, here) == 0 && displaced_derivatives(r, pattern, 1e-9, near) == 0 &&
            displaced_derivatives(r, pattern, 1e-3, far) == 0 && changes_at_once(r->n, here, near, far);
  }
  return rough;
}

/* ---- Scales */

static const lag_var *unknown(const Equilibrium *r, int i) {
  const lag_model *m = r->sim->scene->model;
  return i < m->nq ? &m->q[i] : &m->z[i - m->nq];
}

static void choose_scales(Equilibrium *r) {
  for (int i = 0; i < r->n; i++) {
    const lag_var *v = unknown(r, i);
    double largest = 0;
    for (int j = 0; j < r->n; j++)
      largest = strcmp(unknown(r, j)->unit, v->unit) == 0 ? fmax(largest, fabs(r->start[j])) : largest;
    r->scale[i] = lag_is_angle(v->periodic, v->unit) ? 1 : largest > 0 ? largest : v->factor;
  }
}

/* Row scales that give forces as a whole, and rates as a whole, the size 1: units and magnitudes of models differ by
 * any factor. */
static int choose_rows(Equilibrium *r) {
  int nq = r->sim->pb.nq, n = r->n;
  double largest[2] = {0, 0};
  for (int i = 0; i < n; i++) r->row[i] = 1;
  int rc = equations(r, r->x, r->f, r->J);
  if (rc) return rc;
  for (int i = 0; i < n; i++) {
    double *size = &largest[i >= nq];
    *size = fmax(*size, fabs(r->f[i]));
    for (int j = 0; j < n; j++) *size = fmax(*size, fabs(r->J[i * n + j]));
  }
  for (int i = 0; i < n; i++) {
    double size = largest[i >= nq];
    r->row[i] = size > 0 && isfinite(size) ? 1 / size : 1;
  }
  return LAG_OK;
}

/* ---- Test for a root */

static int forces(Equilibrium *r, const double *x, double *out) { return equations(r, x, out, out + r->n); }

/* r->f, r->J and their noise, r->noise[n | n * n], at x[n]. */
static int forces_and_noise(Equilibrium *r, const double *x) {
  size_t n = (size_t)r->n;
  int rc = lag_perturbation_noise(r, forces, x, n + n * n, r->values, r->noise, r->scratch);
  if (rc || lag_not_finite((int)(n + n * n), r->values) >= 0) return rc ? rc : LAG_ENAN;
  memcpy(r->f, r->values, n * sizeof(double));
  memcpy(r->J, r->values + n, n * n * sizeof(double));
  for (size_t i = 0; i < n; i++) { /* rounding of the sum M a, which no perturbation of parameters shows */
    double sum = 0;
    size_t nq = (size_t)r->sim->pb.nq;
    for (size_t j = 0; j < nq && i < nq; j++) sum += fabs(r->M[i * nq + j] * r->rate[nq + j]);
    r->noise[i] += i < nq ? DBL_EPSILON * sum * r->scale[i] * r->row[i] : 0;
  }
  return equations(r, x, r->f, NULL); /* r->rate at x */
}

/* Solves J dx = -b, where b[n] and J have the given noise (NULL: none), by Gaussian elimination with complete
 * pivoting (J.H. Wilkinson, J. ACM 8 (1961) 281, DOI 10.1145/321075.321076) after rows were divided by the largest
 * size of terms in them; pivots that cancel among these, to rounding, count as 0. Destroys J and b. Returns the
 * rank; undetermined unknowns are 0; b[i] for i >= rank is the unbalanced force of a combination of equations that
 * no unknown changes, 0 if it is noise. Errors add as if independent. */
static int solve(Equilibrium *r, double *b, const double *noise) {
  int n = r->n, rank = 0;
  double *A = r->J, *x = r->dx, *error = r->scratch, *column = error + n;
  for (int i = 0; i < n; i++) {
    double size = 0;
    for (int j = 0; j < n; j++)
      size = fmax(size, fabs(A[i * n + j]) + (noise ? noise[n + i * n + j] / DBL_EPSILON : 0));
    double factor = size > 0 && isfinite(size) ? 1 / size : 1;
    for (int j = 0; j < n; j++) A[i * n + j] *= factor;
    b[i] *= -factor;
    error[i] = noise ? noise[i] * factor : 0;
    column[i] = i;
    x[i] = 0;
  }
  for (int row, col; rank < n; rank++) {
    double pivot = lag_complete_pivot(n, rank, A, &row, &col);
    lag_swap(&b[rank], &b[row]);
    lag_swap(&error[rank], &error[row]);
    lag_swap(&column[rank], &column[col]);
    if (!(pivot > 8 * n * DBL_EPSILON)) break;
    for (int i = rank + 1; i < n; i++) {
      double factor = lag_eliminate_row(n, A, rank, i);
      b[i] -= factor * b[rank];
      error[i] = hypot(hypot(error[i], factor * error[rank]), DBL_EPSILON * factor * b[rank]);
    }
  }
  for (int k = rank; k-- > 0;) {
    double sum = b[k];
    for (int j = k + 1; j < rank; j++) sum -= A[k * n + j] * x[(int)column[j]];
    x[(int)column[k]] = sum / A[k * n + k];
  }
  for (int i = rank; i < n && noise; i++) b[i] = fabs(b[i]) <= CERTAIN * error[i] ? 0 : b[i];
  return rank;
}

/* Length of dx, relative to the state and its scale. */
static double reach(const Equilibrium *r, const double *x, const double *dx) {
  double most = 0;
  for (int i = 0; i < r->n; i++) most = fmax(most, fabs(dx[i]) / (fabs(x[i]) + 1));
  return most;
}

/* Whether Newton's method would stay at x, and no force pulls along directions that it cannot move. */
static int newton_stays(Equilibrium *r, const double *x) {
  int n = r->n;
  double *b = r->step;
  memcpy(b, r->f, (size_t)n * sizeof *b);
  for (int k = solve(r, b, r->noise); k < n; k++)
    if (b[k] != 0.0) return 0;
  return reach(r, x, r->dx) <= NEAR;
}

/* Whether the forces computed last are noise. Sets the worst. */
static int none_pulls(Equilibrium *r) {
  double most = 0;
  r->worst = 0;
  for (int i = 0; i < r->n; i++)
    if (fabs(r->f[i]) > CERTAIN * r->noise[i] && fabs(r->f[i]) > most) {
      most = fabs(r->f[i]);
      r->worst = i;
    }
  return most == 0.0;
}

/* Whether all forces vanish at x[n]. */
static int vanish(Equilibrium *r, const double *x) { return forces_and_noise(r, x) == 0 && none_pulls(r); }

/* Whether x[n] is a root: all forces vanish there, or within a Newton step of rounding size. The size of a force
 * alone says little, as stiff ones stand beside soft ones. */
static int is_root(Equilibrium *r, const double *x) {
  return forces_and_noise(r, x) == 0 && (none_pulls(r) || newton_stays(r, x));
}

/* Rounds small components of x to 0 where forces vanish there, too. */
static void round_to_zero(Equilibrium *r) {
  static const double small[] = {1e-4, 1e-8, 1e-12};
  for (size_t k = 0; k < sizeof small / sizeof *small; k++) {
    int changes = 0;
    for (int i = 0; i < r->n; i++) {
      int is_small = fabs(r->x[i]) <= small[k];
      changes |= is_small && r->x[i] != 0.0;
      r->trial[i] = is_small ? 0 : r->x[i];
    }
    if (changes && vanish(r, r->trial)) {
      memcpy(r->x, r->trial, (size_t)r->n * sizeof *r->x);
      break;
    }
  }
}

/* Moves undetermined unknowns back to the start where forces vanish there, too. */
static void restore_undetermined(Equilibrium *r) {
  size_t bytes = (size_t)r->n * sizeof(double);
  if (forces_and_noise(r, r->x) || solve(r, r->f, r->noise) == r->n) return;
  for (int i = 0; i < r->n; i++) {
    memcpy(r->trial, r->x, bytes);
    r->trial[i] = r->begin[i];
    if (r->x[i] != r->begin[i] && vanish(r, r->trial)) memcpy(r->x, r->trial, bytes);
  }
}

/* ---- Newton's method */

/* Newton's method without step control: along the floor of a steep valley its steps are large where a method that
 * must reduce forces at each step is slow. 1: x[n] has converged. */
static int newton(Equilibrium *r, lag_equations *zero, double *x, int most) {
  double last = HUGE_VAL;
  for (int k = 0; k < most; k++) {
    if (zero(r, x, r->f, r->J) || lag_not_finite(r->n, r->f) >= 0 || lag_not_finite(r->n * r->n, r->J) >= 0) return 0;
    solve(r, r->f, NULL);
    double far = reach(r, x, r->dx);
    for (int i = 0; i < r->n; i++) x[i] += r->dx[i];
    r->steps++;
    if (!isfinite(far) || far < DBL_EPSILON || (far < 1e-6 && far > 0.95 * last)) return isfinite(far);
    last = far;
  }
  return 0;
}

/* ---- Downhill */

/* Largest component of x - y, in scales. */
static double distance(const Equilibrium *r, const double *x, const double *y) {
  double most = 0;
  for (int i = 0; i < r->n; i++) most = fmax(most, fabs(x[i] - y[i]));
  return most;
}

/* Equations of an implicit Euler step of length delta of the overdamped motion M q' = f: f(x) - W (x - from)/delta. */
static int overdamped_step(void *context, const double *x, double *f, double *J) {
  Equilibrium *r = context;
  int n = r->n, rc = equations(r, x, f, J);
  for (int i = 0; i < n && rc == 0; i++)
    for (int j = 0; j < n; j++) {
      f[i] -= r->W[i * n + j] * (x[j] - r->from[j]) / r->delta;
      if (J) J[i * n + j] -= r->W[i * n + j] / r->delta;
    }
  return rc;
}

/* W := the mass matrix in the units of the equations, and the identity for rates; delta: a first step of 0.3 of a
 * scale. */
static void prepare_overdamped(Equilibrium *r) {
  int n = r->n, nq = r->sim->pb.nq;
  double fastest = 0;
  equations(r, r->x, r->f, r->J);
  for (int i = 0; i < n; i++) {
    fastest = fmax(fastest, fabs(r->rate[nq + i]) / r->scale[i]);
    for (int j = 0; j < n; j++) {
      int both = i < nq && j < nq;
      r->W[i * n + j] = both ? r->M[i * nq + j] * r->scale[i] * r->scale[j] * r->row[i] : i == j ? r->row[i] : 0;
    }
  }
  r->delta = fastest > 0 && isfinite(fastest) ? 0.3 / fastest : 1;
}

/* Follows the overdamped motion from x[n] until hardly anything moves. */
static void follow_overdamped(Equilibrium *r) {
  size_t bytes = (size_t)r->n * sizeof(double);
  prepare_overdamped(r);
  for (int k = 0; k < MOST_DESCENT; k++) {
    memcpy(r->from, r->x, bytes);
    int found = newton(r, overdamped_step, r->x, 20);
    double moved = distance(r, r->x, r->from);
    if (!found || !(moved < 0.5)) {
      memcpy(r->x, r->from, bytes);
      r->delta /= 4;
    } else if (moved < 1e-3) {
      return;
    } else {
      r->delta *= moved < 0.2 ? 2 : 1;
    }
  }
}

/* ---- The search */

static double largest_force(Equilibrium *r, const double *x) {
  double most = 0;
  for (int i = 0; i < r->n && (i > 0 || equations(r, x, r->f, NULL) == 0); i++) most = fmax(most, fabs(r->f[i]));
  return most;
}

/* Whether x has run away, or left nearly all of the force at the start: forces that fade have no root there. */
static int ran_away(Equilibrium *r) {
  double start = 1;
  for (int i = 0; i < r->n; i++) start = fmax(start, fabs(r->begin[i]));
  return distance(r, r->x, r->begin) > 1e4 * start || largest_force(r, r->x) < 1e-6 * largest_force(r, r->begin);
}

/* x := the root to which Newton's method leads from there[n], if it is a root and within `farthest`; else x is
 * unchanged. Whether x is a root. */
static int newton_polish(Equilibrium *r, const double *there, double farthest) {
  size_t bytes = (size_t)r->n * sizeof(double);
  memcpy(r->kept, r->x, bytes);
  memcpy(r->x, there, bytes);
  if (newton(r, equations, r->x, MOST_STEPS) && distance(r, r->x, there) <= farthest) {
    round_to_zero(r);
    if (is_root(r, r->x)) return 1;
  }
  memcpy(r->x, r->kept, bytes);
  return is_root(r, r->x);
}

/* Finds a root from x: by a trust region; if that gets stuck, by Newton's method. */
static int find_root(Equilibrium *r, const lag_algebra *algebra) {
  int steps = 0;
  memcpy(r->from, r->x, (size_t)r->n * sizeof(double));
  int rc = algebra->root(r->n, r->x, equations, r, MOST_STEPS, &steps);
  r->steps += steps;
  if (rc) return rc;
  round_to_zero(r);
  memcpy(r->near, r->x, (size_t)r->n * sizeof(double));
  return vanish(r, r->x) || newton_polish(r, r->near, 0.1) || newton_polish(r, r->from, 10);
}

/* Searches a root near the start, stable or not; else one downhill; else any. */
static int search(Equilibrium *r, const lag_algebra *algebra) {
  size_t bytes = (size_t)r->n * sizeof(double);
  int rc = find_root(r, algebra);
  if (rc < 0 || (rc == 1 && distance(r, r->x, r->begin) <= 1)) return rc;
  memcpy(r->first, r->x, bytes);
  r->away = rc == 0 && ran_away(r);
  int first = rc;
  memcpy(r->x, r->begin, bytes);
  follow_overdamped(r);
  rc = find_root(r, algebra);
  if (rc != 0) return rc;
  memcpy(r->x, r->first, bytes);
  is_root(r, r->x);
  return first;
}

static int allocate(Equilibrium *r) {
  const lag_model *m = r->sim->scene->model;
  size_t n = (size_t)r->n, nq = (size_t)m->nq, ny = (size_t)r->sim->pb.n;
  const lag_part parts[] = {{&r->start, n}, {&r->found, n}, {&r->y, ny}, {&r->rate, ny}, {&r->scale, n}, {&r->x, n},
      {&r->begin, n}, {&r->from, n}, {&r->first, n}, {&r->trial, n}, {&r->near, n}, {&r->kept, n}, {&r->f, n},
      {&r->row, n}, {&r->dx, n}, {&r->step, n}, {&r->spread, n}, {&r->J, n * n}, {&r->W, n * n},
      {&r->values, n + n * n}, {&r->noise, n + n * n}, {&r->scratch, n * n + 3 * n + (size_t)(m->np + m->nderived)},
      {&r->dr, n * ny}, {&r->M, nq * nq}, {&r->work, lag_linear_work(m)}};
  lag_pool_parts(&r->pool, sizeof parts / sizeof *parts, parts);
  return r->pool.failed ? LAG_ENOMEM : LAG_OK;
}

const lag_switch *lag_jump_at(lag_sim *s, const double *y) {
  const lag_model *m = s->scene->model;
  if (!m->nmodes || m->switch_values(m, s->run->t, y, y + m->nq, y + 2 * m->nq, s->p, s->u, s->sides, s->work))
    return NULL;
  for (int k = 0; k < m->nmodes; k++)
    if (m->switches[k].jumps && s->sides[k] == 0) return &m->switches[k];
  return NULL;
}

/* spread := uncertainty of the root: Newton steps for noise of the forces with two patterns of signs, and for the
 * rest of the forces. Leaves all values at x. */
static int estimate_uncertainty(Equilibrium *r) {
  int n = r->n, rc = 0;
  for (int pattern = 0; pattern < 3 && rc == 0; pattern++) {
    rc = forces_and_noise(r, r->x);
    for (int i = 0; i < n; i++)
      r->step[i] = pattern == 0 ? r->f[i] : CERTAIN * r->noise[i] * (pattern == 2 && i % 2 ? -1 : 1);
    if (rc == 0) solve(r, r->step, r->noise);
    for (int i = 0; i < n && rc == 0; i++) r->spread[i] = fmax(r->spread[i], fmin(fabs(r->dx[i]), 0.1));
  }
  for (int i = 0; i < n; i++) r->found[i] = r->x[i] * r->scale[i];
  r->pole = is_coordinate_pole(r);
  r->rough = rc == 0 && is_nonsmooth(r);
  lag_equilibrium_state(r, r->x);
  r->held = rc == 0 && lag_jump_at(r->sim, r->y);
  rc = rc ? rc : equations(r, r->x, r->f, r->J);
  return rc ? (rc < 0 ? rc : LAG_EDOMAIN) : 1;
}

int lag_equilibrium_find(Equilibrium *r, lag_sim *sim, const lag_algebra *algebra) {
  int nq = sim->pb.nq, n = nq + sim->pb.nz;
  *r = (Equilibrium){.sim = sim, .n = n};
  int rc = allocate(r);
  if (rc) return rc;
  for (int i = 0; i < n; i++) r->start[i] = sim->now[i < nq ? i : nq + i];
  choose_scales(r);
  for (int i = 0; i < n; i++) r->x[i] = r->begin[i] = r->start[i] / r->scale[i];
  if ((rc = choose_rows(r)) != 0) return rc < 0 ? rc : LAG_EDOMAIN;
  rc = vanish(r, r->x) ? 1 : search(r, algebra);
  if (rc == 1) {
    round_to_zero(r);
    restore_undetermined(r);
    round_to_zero(r);
    return estimate_uncertainty(r);
  }
  if (rc == 0) {
    r->pole = is_coordinate_pole(r);
    is_root(r, r->x);
  }
  return rc;
}

int lag_equilibrium_continues(Equilibrium *r, const double *dx, double c) {
  double off = 0, far = 0;
  for (int i = 0; i < r->n; i++) r->trial[i] = r->from[i] = r->x[i] + c * dx[i] / r->scale[i];
  int found = is_root(r, r->from);
  if (!found) {
    found = newton(r, equations, r->trial, MOST_STEPS) && is_root(r, r->trial);
    off = distance(r, r->trial, r->from);
    far = distance(r, r->from, r->x);
  }
  lag_equilibrium_state(r, r->x);
  return found && off <= 0.4 * far;
}

void lag_equilibrium_free(Equilibrium *r) { lag_pool_free(&r->pool); }
