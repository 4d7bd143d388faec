/* Symmetries of the equations of motion, and steady motions along them (steady_motion.h). Symmetries: shifts of
 * coordinates, and rotations in the planes of two coordinates of one unit, which for the four numbers of a rotation
 * turn the body and the space; a combination with generator X is a symmetry if [f, X] = 0 for y' = f and X is
 * tangent to the constraints. Steady: f = X at y (J. E. Marsden, Lectures on Mechanics, 1992, chapter 4), by
 * Gauss-Newton steps of least length. Derivatives: C. J. F. Ridders, Adv. Eng. Software 4 (1982) 75, DOI
 * 10.1016/S0141-1195(82)80057-0. */
#include "analysis/steady_motion.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "numeric/dense.h"
#include "numeric/magnitudes.h"

enum { LEVELS = 10, MOST_STEPS = 60, MOST_PLANES = 24, SAMPLES = 4, DESCENT = 2000 };

/* ---- Rows and their derivatives */

/* out[nrows] at y. */
static int rows_at(const SteadyMotion *s, const double *y, double *out) {
  lag_problem *pb = &s->sim->pb;
  const lag_constraints *of = pb->model->constraints;
  int rc = s->without_rates ? LAG_OK : lag_rhs(pb, s->sim->run->t, y, out);
  if (s->without_rates) memset(out, 0, (size_t)s->n * sizeof *out);
  rc = rc || !of ? rc : lag_residuals(pb, s->sim->run->t, y, out + s->n, out + s->n + of->nholonomic);
  return rc ? rc : lag_not_finite(s->nrows, out) >= 0 ? LAG_ENAN : LAG_OK;
}

/* d[nrows] := central difference of the rows at y along x[n], in units, half-width h. */
static int central_difference(SteadyMotion *s, const double *y, const double *x, double h, double *d) {
  int rc = LAG_OK;
  for (int side = 0; side < 2 && rc == LAG_OK; side++) {
    for (int i = 0; i < s->n; i++) s->at[i] = y[i] + (side ? -h : h) * x[i] * s->unit[i];
    rc = rows_at(s, s->at, s->out + side * s->nrows);
  }
  for (int k = 0; k < s->nrows && rc == LAG_OK; k++) d[k] = (s->out[k] - s->out[s->nrows + k]) / (2 * h);
  return rc;
}

/* Column i of D, derivatives along x, and of its errors, where they become smaller: differences extrapolated from
 * half-widths up to h to 0, for each row from the level where two extrapolations agree best. */
static int extrapolate(SteadyMotion *s, const double *y, const double *x, int i, double h, double *D, double *error) {
  const double ratio = 1.5;
  size_t n = (size_t)s->n, rows = (size_t)s->nrows;
  double *before = s->table, *now = before + LEVELS * rows;
  for (int level = 0; level < LEVELS; level++, h /= ratio) {
    int rc = central_difference(s, y, x, h, now);
    if (rc) return rc;
    double factor = 1;
    for (int j = 1; j <= level; j++) {
      factor *= ratio * ratio;
      for (size_t k = 0; k < rows; k++) {
        size_t at = (size_t)j * rows + k, e = k * n + (size_t)i;
        now[at] = (factor * now[at - rows] - before[at - rows]) / (factor - 1);
        double rounding = DBL_EPSILON * fmax(fabs(s->out[k]), fabs(s->out[rows + k])) / h;
        double off = fmax(rounding, fmax(fabs(now[at] - now[at - rows]), fabs(now[at] - before[at - rows])));
        if (off >= error[e]) continue;
        error[e] = off;
        D[e] = now[at];
      }
    }
    lag_swap_rows(LEVELS * rows, before, 0, 1);
  }
  return LAG_OK;
}

/* The largest error of column i, relative to the size of its row; errors not below rounding, as two extrapolations
 * may agree by chance. */
static double settle_column(const SteadyMotion *s, int i, const double *D, double *error) {
  double most = 0;
  for (int k = 0; k < s->nrows; k++) {
    int at = k * s->n + i;
    double size = fabs(D[at]) + fabs(s->out[k]);
    error[at] = fmax(error[at], 4 * DBL_EPSILON * size);
    most = size > 0 ? fmax(most, error[at] / size) : most;
  }
  return most;
}

/* D at y along column k of Q[size * size] or, for NULL, by unknown k, and its errors: where the model has no values
 * as far away, or bends much, from nearer. */
static int along_column(SteadyMotion *s, const double *y, const double *Q, int size, int k) {
  double h = 0.25, off = HUGE_VAL, *x = s->direction;
  int known = 0;
  for (int r = 0; r < s->nrows; r++) s->error[r * s->n + k] = HUGE_VAL;
  for (int i = 0; i < s->n; i++) x[i] = Q ? Q[i * size + k] : i == k;
  for (int tries = 0; tries < 4 && !(off < 1e-10); tries++, h /= 16) {
    if (extrapolate(s, y, x, k, h, s->D, s->error)) continue;
    known = 1;
    off = settle_column(s, k, s->D, s->error);
  }
  return known ? LAG_OK : LAG_EDOMAIN;
}

/* G and noise of rates := D Q' and its errors, in SI, from columns of Q from `first` on. */
static void from_tangents(const SteadyMotion *s, const double *Q, int size, int first) {
  int n = s->n;
  for (int r = 0; r < n; r++)
    for (int i = 0; i < n; i++) {
      double sum = 0, off = 0;
      for (int k = first; k < n; k++) {
        sum += s->D[r * n + k] * Q[i * size + k];
        off += s->error[r * n + k] * fabs(Q[i * size + k]);
      }
      s->G[r * n + i] = sum / s->unit[i];
      s->noise[r * n + i] = off / s->unit[i];
    }
}

/* G and noise of rates at y along the tangents of redundant constraints; across they are set to 0: constraints that
 * are broken may be independent, as hinges out of line are, and then forces jump. */
static int derivatives_along_tangents(SteadyMotion *s, const double *y) {
  Pool pool = {0};
  int size = s->nrows;
  double *Q = lag_pool_doubles(&pool, (size_t)size * (size_t)size);
  int rank = Q ? lag_tangent_kernel(&pool, s, size, Q) : LAG_ENOMEM, rc = rank < 0 ? rank : LAG_OK;
  for (int k = rank; k < s->n && rc == LAG_OK; k++) rc = along_column(s, y, Q, size, k);
  if (rc == LAG_OK) from_tangents(s, Q, size, rank);
  lag_pool_free(&pool);
  return rc;
}

/* G and noise at y. */
static int derivatives(SteadyMotion *s, const double *y) {
  int redundant = s->sim->pb.redundant, n = s->n, rc = LAG_OK;
  s->without_rates = redundant;
  for (int k = 0; k < n && rc == LAG_OK; k++) rc = along_column(s, y, NULL, 0, k);
  s->without_rates = 0;
  for (int e = 0; e < n * s->nrows; e++) {
    s->G[e] = s->D[e] / s->unit[e % n];
    s->noise[e] = s->error[e] / s->unit[e % n];
  }
  return rc || !redundant ? rc : derivatives_along_tangents(s, y);
}

/* The largest derivative of row r by one unit, in its scale, and *noise: the largest error of these. */
static double row_top(const SteadyMotion *s, int r, double *noise) {
  double top = *noise = 0;
  for (int j = 0; j < s->n; j++) {
    top = fmax(top, fabs(s->G[r * s->n + j]) * s->unit[j] / s->row[r]);
    *noise = fmax(*noise, s->noise[r * s->n + j] * s->unit[j] / s->row[r]);
  }
  return top;
}

/* Factor that gives row r the size 1, so that soft forces count beside stiff ones, and its noise at most 1e-9. */
static double row_weight(const SteadyMotion *s, int r) {
  double noise, top = row_top(s, r, &noise), size = top + 1e9 * noise;
  return size > 0 ? 1 / size : 0;
}

/* ---- Symmetries */

static int of_one_unit(const lag_model *m, int i, int j) { return strcmp(m->q[i].unit, m->q[j].unit) == 0; }

/* Number of shifts: of coordinates; of a model with states alone, a Hamiltonian or an L linear in velocities, of all
 * states. */
static int count_shifts(const lag_model *m) { return m->nq ? m->nq : m->nz; }

/* Adds candidate k, times c, to X at y and to DX: a shift by one unit, or a turn. */
static void add_candidate(const SteadyMotion *s, int k, double c, const double *y, double *X, double *DX) {
  int nq = s->nq, at = nq;
  if (k < count_shifts(s->sim->pb.model)) X[k] += c * s->unit[k];
  for (int i = 0; i < nq && k >= nq && nq <= MOST_PLANES; i++)
    for (int j = 0; j < i; j++) {
      if (!of_one_unit(s->sim->pb.model, i, j) || at++ != k) continue;
      for (int part = 0; part < 2; part++) { /* positions, then velocities */
        int a = i + part * nq, b = j + part * nq;
        X[a] += c * y[b];
        X[b] -= c * y[a];
        if (!DX) continue;
        DX[a * s->n + b] += c;
        DX[b * s->n + a] -= c;
      }
    }
}

static int count_candidates(const lag_model *m) {
  int count = count_shifts(m);
  for (int i = 0; i < m->nq && m->nq <= MOST_PLANES; i++)
    for (int j = 0; j < i; j++) count += of_one_unit(m, i, j);
  return count;
}

void lag_steady_generator(const SteadyMotion *s, const double *c, const double *y, double *X, double *DX) {
  memset(X, 0, (size_t)s->n * sizeof *X);
  if (DX) memset(DX, 0, (size_t)s->n * (size_t)s->n * sizeof *DX);
  for (int k = 0; k < s->ncandidates; k++) {
    double sum = 0;
    for (int i = 0; i < s->m; i++) sum += c[i] * s->generators[i * s->ncandidates + k];
    if (sum != 0.0) add_candidate(s, k, sum, y, X, DX);
  }
}

/* column[rows] := G X - DX f for a candidate, in units; zero where it is a symmetry. scratch[2 n]. */
static void symmetry_defect(const SteadyMotion *s, int k, const double *y, double *column, double *scratch) {
  int n = s->n;
  double *X = scratch, *DXf = scratch + n;
  memset(X, 0, (size_t)n * sizeof *X);
  memset(DXf, 0, (size_t)n * sizeof *DXf);
  add_candidate(s, k, 1, y, X, NULL);
  if (k >= count_shifts(s->sim->pb.model)) add_candidate(s, k, 1, s->f, DXf, NULL); /* linear, so DX f is X at f */
  for (int r = 0; r < s->nrows; r++) {
    double sum = r < n ? -DXf[r] : 0;
    for (int j = 0; j < n; j++) sum += s->G[r * n + j] * X[j];
    column[r] = sum / s->row[r] * row_weight(s, r);
  }
}

/* y := a place beside the state, on the constraints. */
static int sample(const SteadyMotion *s, int k, double far, double *y) {
  for (int i = 0; i < s->n; i++)
    y[i] = s->y[i] + far * s->unit[i] * (fmod(0.754877666 * (i + 1) + 0.569840291 * (k + 1) * (i + 2), 1) - 0.5);
  return lag_project(&s->sim->pb, s->sim->run->t, y, NULL);
}

int lag_padded_kernel(Pool *pool, const lag_algebra *algebra, int size, Rectangle A, double tol, double *Q) {
  double *square = lag_pool_doubles(pool, (size_t)size * (size_t)size);
  int rank = 0;
  if (!square) return LAG_ENOMEM;
  for (int i = 0; i < A.rows; i++)
    for (int j = 0; j < A.columns; j++) square[i * size + j] = A.at[i * A.columns + j];
  int rc = algebra->kernel(size, square, tol, Q, &rank);
  return rc ? rc : rank;
}

int lag_tangent_kernel(Pool *pool, const SteadyMotion *s, int size, double *Q) {
  int n = s->n, rows = s->nrows - n, rank = 0, last = -1;
  double *A = lag_pool_doubles(pool, (size_t)rows * (size_t)n);
  for (int r = 0; r < rows && A; r++)
    for (int i = 0; i < n; i++) A[r * n + i] = s->G[(n + r) * n + i] * s->unit[i] / s->row[n + r];
  /* rounding: 1e-12; a rank that depends on the tolerance is none */
  for (double tol = 1e-5; A && tol > 1e-9; tol /= 1e3) {
    rank = lag_padded_kernel(pool, s->algebra, size, (Rectangle){rows, n, A}, tol, Q);
    if (rank < 0 || (last >= 0 && rank != last)) return rank < 0 ? rank : LAG_ESINGULAR;
    last = rank;
  }
  return A ? rank : LAG_ENOMEM;
}

/* generators := the columns of Q[size * size] from `first` on, in a basis with many zeros. Coefficients that are
 * halves but for rounding become halves, as they are for turns of a rotation's four numbers beside those of points.
 * */
static int keep_generators(SteadyMotion *s, const double *Q, int size, int first) {
  int K = s->ncandidates, m = s->m;
  double *v = lag_pool_doubles(&s->pool, (size_t)K * (size_t)(m + 1)), *one = v + (size_t)K * (size_t)m;
  if (!v) return LAG_ENOMEM;
  for (int i = 0; i < K; i++) {
    one[i] = 1;
    for (int k = 0; k < m; k++) v[i * m + k] = Q[i * size + first + k];
  }
  lag_reduce_columns(K, m, one, v);
  for (int i = 0; i < K * m; i++) {
    double half = round(2 * v[i]) / 2;
    s->generators[i % m * K + i / m] = fabs(v[i] - half) < 1e-5 ? half : v[i];
  }
  return LAG_OK;
}

/* Fills generators with the combinations of candidates that are symmetries at a few places. */
static int find_symmetries(SteadyMotion *s) {
  int n = s->n, K = s->ncandidates, rows = s->nrows * SAMPLES, size = K > rows ? K : rows;
  double *A = lag_pool_doubles(&s->pool, (size_t)rows * (size_t)K), *y = lag_pool_doubles(&s->pool, (size_t)n),
         *column = lag_pool_doubles(&s->pool, (size_t)s->nrows);
  double *X = lag_pool_doubles(&s->pool, 2 * (size_t)n), *Q = lag_pool_doubles(&s->pool, (size_t)size * (size_t)size);
  double *T = lag_pool_doubles(&s->pool, (size_t)s->nrows * (size_t)s->nrows);
  if (s->pool.failed) return LAG_ENOMEM;
  for (int k = 0; k < SAMPLES; k++) {
    int rc = LAG_EDOMAIN;
    for (double far = k ? 0.6 / (1 << 2 * k) : 0.6; rc != LAG_OK && far > 1e-4; far /= 8) {
      rc = sample(s, k, far, y);
      rc = rc ? rc : rows_at(s, y, s->f);
      rc = rc ? rc : derivatives(s, y);
    }
    if (rc) return rc < 0 ? rc : LAG_EDOMAIN;
    int independent = s->nrows > n ? lag_tangent_kernel(&s->pool, s, s->nrows, T) : 0;
    if (independent == LAG_ENOMEM) return independent;
    s->rank = independent > s->rank ? independent : s->rank;
    for (int c = 0; c < K; c++) {
      symmetry_defect(s, c, y, column, X);
      for (int r = 0; r < s->nrows; r++) A[(k * s->nrows + r) * K + c] = column[r];
    }
  }
  int rank = lag_padded_kernel(&s->pool, s->algebra, size, (Rectangle){rows, K, A}, 1e-8, Q);
  if (rank < 0) return rank;
  s->m = K - rank;
  s->generators = lag_pool_doubles(&s->pool, (size_t)s->m * (size_t)K + 1);
  s->c = lag_pool_doubles(&s->pool, (size_t)s->m + 1);
  return s->pool.failed ? LAG_ENOMEM : keep_generators(s, Q, size, rank);
}

/* ---- The nearest steady motion */

/* x[cols] := the shortest vector of those that make A x + b least. A[rows * cols] and b[rows]. A status < 0, or 0. */
static int least_squares(SteadyMotion *s, int rows, int cols, const double *A, const double *b, double *x) {
  Pool pool = {0};
  int size = rows > cols ? rows : cols;
  double *Q = lag_pool_doubles(&pool, (size_t)size * (size_t)size),
         *B = lag_pool_doubles(&pool, (size_t)rows * (size_t)size);
  double *N = lag_pool_doubles(&pool, (size_t)size * (size_t)size), *z = lag_pool_doubles(&pool, (size_t)size);
  int rank = pool.failed ? LAG_ENOMEM : lag_padded_kernel(&pool, s->algebra, size, (Rectangle){rows, cols, A},
                                                          1e-7 * lag_largest(rows * cols, A), Q);
  for (int i = 0; i < rows && rank > 0; i++)
    for (int k = 0; k < rank; k++)
      for (int j = 0; j < cols; j++) B[i * rank + k] += A[i * cols + j] * Q[j * size + k];
  for (int k = 0; k < rank; k++)
    for (int i = 0; i < rows; i++) {
      z[k] -= B[i * rank + k] * b[i];
      for (int l = 0; l < rank; l++) N[k * rank + l] += B[i * rank + k] * B[i * rank + l];
    }
  int rc = rank < 0 ? rank : rank && lag_solve_dense((size_t)rank, 1, N, z) ? LAG_ESINGULAR : LAG_OK;
  memset(x, 0, (size_t)cols * sizeof *x);
  for (int j = 0; j < cols && rc == LAG_OK; j++)
    for (int k = 0; k < rank; k++) x[j] += Q[j * size + k] * z[k];
  lag_pool_free(&pool);
  return rc;
}

/* J[nrows * (n + m)], b[nrows]: the equations f - X = 0 and the constraints at y, in units; at rest velocities are
 * no unknowns. */
static int equations(SteadyMotion *s, int m, double *J, double *b, double *X, double *DX) {
  int n = s->n, nq = s->nq, cols = n + m, rc = rows_at(s, s->y, s->f);
  rc = rc ? rc : derivatives(s, s->y);
  if (rc) return rc < 0 ? rc : LAG_EDOMAIN;
  if (m) lag_steady_generator(s, s->c, s->y, X, DX);
  double *one = s->at;
  for (int r = 0; r < s->nrows; r++) {
    b[r] = (s->f[r] - (m && r < n ? X[r] : 0)) / s->row[r];
    for (int j = 0; j < n; j++)
      J[r * cols + j] = !s->moving && j >= nq && j < 2 * nq
                            ? 0
                            : (s->G[r * n + j] - (m && r < n ? DX[r * n + j] : 0)) * s->unit[j] / s->row[r];
  }
  for (int k = 0; k < m; k++) {
    for (int i = 0; i < m; i++) one[i] = i == k;
    lag_steady_generator(s, one, s->y, X, NULL);
    for (int r = 0; r < s->nrows; r++) J[r * cols + n + k] = r < n ? -X[r] / s->row[r] : 0;
  }
  return LAG_OK;
}

/* Whether what is left of every equation is rounding: of its own terms; where no unknown changes it, of the fastest
 * ones. */
static int is_root(const SteadyMotion *s, int cols, const double *J, const double *b) {
  double fastest = lag_largest(s->n * cols, J), noise;
  for (int r = 0; r < s->nrows; r++) {
    double top = row_top(s, r, &noise), rounding = r >= s->n      ? 1e-12
                                                   : top <= noise ? 4 * DBL_EPSILON * fastest
                                                                  : 1e-12 * top + noise;
    if (!(fabs(b[r]) <= rounding)) return 0;
  }
  return 1;
}

static void weigh_rows(const SteadyMotion *s, int cols, double *J, double *b) {
  for (int r = 0; r < s->nrows; r++) {
    double weight = row_weight(s, r);
    b[r] *= weight;
    for (int j = 0; j < cols; j++) J[r * cols + j] *= weight;
  }
}

/* c := the symmetry that comes nearest to the motion at y. */
static int choose_generator(SteadyMotion *s, double *J, double *b, double *X) {
  int n = s->n, m = s->m, rc = rows_at(s, s->y, s->f);
  double *one = s->table;
  for (int k = 0; k < m; k++) {
    for (int i = 0; i < m; i++) one[i] = i == k;
    lag_steady_generator(s, one, s->y, X, NULL);
    for (int r = 0; r < n; r++) J[r * m + k] = X[r] / s->unit[r];
  }
  for (int r = 0; r < n; r++) b[r] = -s->f[r] / s->unit[r];
  return rc ? rc : m ? least_squares(s, n, m, J, b, s->c) : LAG_OK;
}

/* y := the state on the constraints next to y; where there is none, y stays. */
static void settle_on_constraints(SteadyMotion *s) {
  memcpy(s->at, s->y, (size_t)s->n * sizeof *s->y);
  if (lag_project(&s->sim->pb, s->sim->run->t, s->at, NULL)) return;
  for (int i = 0; i < s->n; i++) s->y[i] = !s->moving && i >= s->nq && i < 2 * s->nq ? 0 : s->at[i];
}

/* Gauss-Newton steps from y, until they are rounding; then y is on the constraints. 1: found. */
static int newton(SteadyMotion *s, int *steps) {
  int n = s->n, m = s->moving ? s->m : 0, cols = n + m;
  Pool pool = {0};
  double *J = lag_pool_doubles(&pool, (size_t)s->nrows * (size_t)(cols + s->m)),
         *b = lag_pool_doubles(&pool, (size_t)s->nrows), *x = lag_pool_doubles(&pool, (size_t)cols);
  double *X = lag_pool_doubles(&pool, (size_t)n), *DX = lag_pool_doubles(&pool, (size_t)n * (size_t)n), last = HUGE_VAL,
         step = HUGE_VAL;
  if (s->sim->pb.redundant) settle_on_constraints(s);
  int rc = pool.failed ? LAG_ENOMEM : m ? choose_generator(s, J, b, X) : LAG_OK, found = 0;
  for (int k = 0; k < MOST_STEPS && rc == LAG_OK; k++, last = step) {
    if ((rc = equations(s, m, J, b, X, DX)) != LAG_OK) break;
    found = is_root(s, cols, J, b);
    weigh_rows(s, cols, J, b);
    if ((rc = least_squares(s, s->nrows, cols, J, b, x)) != LAG_OK) break;
    step = lag_largest(n, x);
    found &= step < 1e-9;
    if (found && (k == 0 || step < 1e-14 || step > 0.5 * last)) break; /* a start that is steady to rounding stays */
    double part = step > 0.3 ? 0.3 / step : 1;
    for (int i = 0; i < n; i++) s->y[i] += part * x[i] * s->unit[i];
    for (int i = 0; i < m; i++) s->c[i] += part * x[n + i];
    if (step < 1e-6 || s->sim->pb.redundant) settle_on_constraints(s);
    ++*steps;
  }
  lag_pool_free(&pool);
  return rc < 0 && rc != LAG_ESINGULAR && rc != LAG_ENAN && rc != LAG_EDOMAIN ? rc : found && rc == LAG_OK;
}

/* Follows the motion at rest whose inertia is replaced by friction, q' = a, on the constraints, until little moves. */
static void descend(SteadyMotion *s) {
  int n = s->n, nq = s->nq;
  double delta = 0, *y = s->at;
  for (int k = 0; k < DESCENT; k++) {
    double fastest = 0;
    memset(s->y + nq, 0, (size_t)nq * sizeof(double));
    if (rows_at(s, s->y, s->f)) return;
    for (int i = 0; i < nq; i++) fastest = fmax(fastest, fabs(s->f[nq + i]) / s->unit[i]);
    if (!(fastest > 0)) return;
    delta = fmin(k ? 1.1 * delta : HUGE_VAL, 0.05 / fastest);
    for (int i = 0; i < n; i++) y[i] = s->y[i] + (i < nq ? delta * s->f[nq + i] : 0);
    if (lag_project(&s->sim->pb, s->sim->run->t, y, NULL)) return;
    memcpy(s->y, y, (size_t)n * sizeof *y);
  }
}

static double distance(const SteadyMotion *s, const Equilibrium *rest) {
  double most = 0;
  for (int i = 0; i < s->nq; i++) most = fmax(most, fabs(s->y[i] - rest->start[i]) / s->unit[i]);
  return most;
}

/* ---- The search */

/* A typical rate [1/s]: of the motion; at rest of oscillations, by the accelerations a quarter of a unit away. */
static double typical_rate(SteadyMotion *s) {
  const double far = 0.25;
  double rate = 0;
  for (int i = 0; i < s->nq; i++) rate = fmax(rate, fabs(s->y[s->nq + i]) / s->unit[i]);
  if (rate > 0) return rate;
  for (int i = 0; i < s->nq; i++) {
    memcpy(s->at, s->y, (size_t)s->n * sizeof *s->y);
    s->at[i] += far * s->unit[i];
    if (rows_at(s, s->at, s->out)) continue;
    for (int j = 0; j < s->nq; j++) rate = fmax(rate, sqrt(fabs(s->out[s->nq + j]) / (far * s->unit[j])));
  }
  return rate > 0 ? rate : 1;
}

/* Units of positions: of angles 1 rad, else the largest start in that unit, or one unit; of velocities the largest,
 * or a position's times a typical rate. */
static void choose_units(SteadyMotion *s, Equilibrium *rest) {
  const lag_model *m = s->sim->pb.model;
  double rate = 1;
  for (int part = 0; part < 2; part++) {
    for (int i = 0; i < s->nq; i++) {
      double most = 0;
      for (int j = 0; j < s->nq; j++) most = of_one_unit(m, i, j) ? fmax(most, fabs(s->y[part * s->nq + j])) : most;
      s->unit[part * s->nq + i] = !part && lag_is_angle(m->q[i].periodic, m->q[i].unit) ? 1
                                  : most > 0                      ? most
                                  : part                          ? rate * s->unit[i]
                                                                  : m->q[i].factor;
    }
    rate = typical_rate(s);
  }
  for (int i = 0; i < m->nz; i++)
    s->unit[2 * s->nq + i] = fabs(s->y[2 * s->nq + i]) > 0 ? fabs(s->y[2 * s->nq + i]) : m->z[i].factor;
  for (int i = 0; i < rest->n; i++) rest->scale[i] = s->unit[i < s->nq ? i : s->nq + i];
}

/* Sizes of rows: of rates the unit; of constraints the change by one unit of an unknown, so that a row whose
 * derivatives vanish here is seen. */
static void choose_rows(SteadyMotion *s) {
  const double far = 0.25;
  for (int r = 0; r < s->nrows; r++) s->row[r] = r < s->n ? s->unit[r] : 0;
  for (int i = 0; i < s->n; i++)
    for (int side = 0; side < 2; side++) {
      memcpy(s->at, s->y, (size_t)s->n * sizeof *s->y);
      s->at[i] += (side ? -far : far) * s->unit[i];
      if (rows_at(s, s->at, s->out)) continue;
      for (int r = s->n; r < s->nrows; r++) s->row[r] = fmax(s->row[r], fabs(s->out[r]) / far);
    }
  for (int r = s->n; r < s->nrows; r++) s->row[r] = s->row[r] > 0 ? s->row[r] : 1;
}

static int allocate(SteadyMotion *s, Equilibrium *rest) {
  size_t n = (size_t)s->n, rows = (size_t)s->nrows;
  const lag_part parts[] = {{&s->unit, n}, {&s->row, rows}, {&s->y, n},
      {&s->at, n > (size_t)s->ncandidates ? n : (size_t)s->ncandidates}, {&s->f, rows}, {&s->out, 2 * rows},
      {&s->G, rows * n}, {&s->noise, rows * n}, {&s->D, rows * n}, {&s->error, rows * n}, {&s->direction, n},
      {&s->table, 2 * LEVELS * rows + (size_t)s->ncandidates}};
  lag_pool_parts(&s->pool, sizeof parts / sizeof *parts, parts);
  double **const report[] = {&rest->start, &rest->found, &rest->scale, &rest->y, &rest->rate};
  for (size_t i = 0; i < sizeof report / sizeof *report; i++) *report[i] = lag_pool_doubles(&rest->pool, n);
  return s->pool.failed || rest->pool.failed ? LAG_ENOMEM : LAG_OK;
}

int lag_steady_find(SteadyMotion *s, Equilibrium *rest, lag_sim *sim, const lag_algebra *algebra, int moving) {
  lag_problem *pb = &sim->pb;
  const lag_constraints *of = pb->model->constraints;
  int nq = pb->nq, n = pb->n;
  *s = (SteadyMotion){.sim = sim,
                      .algebra = algebra, .n = n, .nq = nq, .moving = moving,
                      .nrows = n + (of ? of->nholonomic + of->n : 0),
                      .ncandidates = count_candidates(pb->model)};
  *rest = (Equilibrium){.sim = sim, .n = nq + pb->nz};
  /* a row that is 0 here is marked nowhere else */
  pb->redundant |= of && sim->run->rank < of->n && sim->run->beside == sim->run->rank;
  int rc = allocate(s, rest);
  if (rc) return rc;
  for (int i = 0; i < n; i++) s->y[i] = !moving && i >= nq && i < 2 * nq ? 0 : sim->now[i];
  for (int i = 0; i < rest->n; i++) rest->start[i] = s->y[i < nq ? i : nq + i];
  choose_units(s, rest);
  choose_rows(s);
  rc = find_symmetries(s);
  if (rc) return rc;
  memcpy(rest->y, s->y, (size_t)n * sizeof *s->y);
  rc = newton(s, &rest->steps);
  if (!moving && (rc == 0 || (rc == 1 && distance(s, rest) > 1))) {
    memcpy(s->y, rest->y, (size_t)n * sizeof *s->y);
    descend(s);
    rc = newton(s, &rest->steps);
  }
  for (int i = 0; i < n; i++) s->y[i] = fabs(s->y[i]) < 1e-14 * s->unit[i] ? 0 : s->y[i];
  for (int i = 0; i < rest->n; i++) rest->found[i] = s->y[i < nq ? i : nq + i];
  memcpy(rest->y, s->y, (size_t)n * sizeof *s->y);
  return rc;
}

int lag_steady_continues(SteadyMotion *s, const double *dx, double far) {
  int n = s->n, steps = 0, moving = s->moving;
  double *y = lag_pool_doubles(&s->pool, 2 * (size_t)n + (size_t)s->m), *from = y + n, *c = from + n, off = 0;
  if (!y) return 0;
  memcpy(y, s->y, (size_t)n * sizeof *y);
  memcpy(c, s->c, (size_t)s->m * sizeof *c);
  double size = lag_largest(n, dx);
  for (int i = 0; i < n; i++) s->y[i] += far * dx[i] / size * s->unit[i];
  memcpy(from, s->y, (size_t)n * sizeof *y);
  s->moving = 1;
  int found = newton(s, &steps) == 1;
  for (int i = 0; i < n; i++) off = fmax(off, fabs(s->y[i] - from[i]) / s->unit[i]);
  memcpy(s->y, y, (size_t)n * sizeof *y);
  memcpy(s->c, c, (size_t)s->m * sizeof *c);
  s->moving = moving;
  return lag_steady_derivatives(s) == LAG_OK && found && off <= 0.4 * fabs(far);
}

int lag_steady_derivatives(SteadyMotion *s) {
  int rc = rows_at(s, s->y, s->f);
  return rc ? rc : derivatives(s, s->y);
}

void lag_steady_free(SteadyMotion *s) { lag_pool_free(&s->pool); }
