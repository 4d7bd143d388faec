/* Independence of constraints by Gram-Schmidt orthogonalisation, in the solver's scaled coordinates (lag_scales of
 * lag_kkt.h), so that units of coordinates do not matter. Holds: rows are taken in the order of the constraints. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "core/core.h"
#include "lag_kkt.h"
#include "numeric/magnitudes.h"

/* Elements of A and M at most, with the diagonal of M. */
static size_t most_elements(const lag_model *m) {
  return (size_t)m->constraints->njacobian + 2 * (size_t)m->constraints->nmass + (size_t)m->nq;
}

/* Doubles that hold the integers of list_elements. */
static size_t integer_room(const lag_model *m) {
  size_t nq = (size_t)m->nq, n = (size_t)m->constraints->n;
  return (6 * most_elements(m) + n + 3 * nq + 2) * sizeof(int) / sizeof(double) + 1;
}

size_t lag_rank_scratch_size(const lag_model *m) {
  const lag_constraints *of = m->constraints;
  size_t nq = (size_t)m->nq, n = of ? (size_t)of->n : 0;
  if (!of) return 0;
  return (size_t)(of->njacobian + of->nmass) + 2 * (nq + n) + 2 * most_elements(m) + integer_room(m) +
         (n * nq + nq + n);
}

double *lag_independence_scratch(const lag_problem *pb) {
  size_t nq = (size_t)pb->nq, n = (size_t)pb->model->constraints->n;
  return pb->ranks + lag_rank_scratch_size(pb->model) - (n * nq + nq + n);
}

/* to[count] := from[count] (NULL: 0, 1, ...), sorted by key[from[k]], equal ones in their order; begin[keys + 1]:
 * where each key begins. */
static void sort_by(int count, int keys, const int *key, const int *from, int *begin, int *to) {
  memset(begin, 0, ((size_t)keys + 1) * sizeof *begin);
  for (int k = 0; k < count; k++) begin[key[k]]++;
  for (int k = 0; k < keys; k++) begin[k + 1] += begin[k];
  for (int k = count - 1; k >= 0; k--) {
    int e = from ? from[k] : k;
    to[--begin[key[e]]] = e;
  }
}

/* row[], col[], value[] := the elements of A, of M, whose lower triangle of->mass lists, and zeros where M's diagonal
 * is not listed; returns their number. listed[nq] is scratch. */
static int gather_elements(const lag_problem *pb, const double *A, const double *M, int *row, int *col, int *listed,
                           double *value) {
  const lag_constraints *of = pb->model->constraints;
  int count = 0;
  for (; count < of->njacobian; count++) {
    row[count] = of->jacobian[count].row, col[count] = of->jacobian[count].col;
    value[count] = A[count];
  }
  memset(listed, 0, (size_t)pb->nq * sizeof *listed);
  for (int k = 0; k < of->nmass; k++) {
    int i = of->mass[k].row, j = of->mass[k].col;
    listed[i] |= i == j;
    for (int turn = 0; turn < (i == j ? 1 : 2); turn++, count++) {
      row[count] = of->n + (turn ? j : i), col[count] = turn ? i : j;
      value[count] = M[k];
    }
  }
  for (int i = 0; i < pb->nq; i++) {
    if (listed[i]) continue;
    row[count] = of->n + i, col[count] = i;
    value[count++] = 0;
  }
  return count;
}

/* unit[nq] := scales of the coordinates, by lists of the elements of A and M. room: of lag_rank_scratch_size. */
static void find_units(const lag_problem *pb, const double *A, const double *M, double *room, double *unit) {
  int nq = pb->nq, n = pb->model->constraints->n, most = (int)most_elements(pb->model);
  double *scale = room, *top = scale + n + nq, *size = top + n + nq, *value = size + most;
  int *rows = (int *)(void *)(value + most), *cols = rows + most, *row = cols + most, *col = row + most,
      *order = col + most, *at = order + most, *first = at + most, *down = first + n + nq + 1, *diag = down + nq + 1;
  int count = gather_elements(pb, A, M, rows, cols, diag, value);
  sort_by(count, nq, cols, NULL, down, at);
  sort_by(count, n + nq, rows, at, first, order);
  for (int k = 0; k < count; k++) {
    row[k] = rows[order[k]], col[k] = cols[order[k]];
    size[k] = lag_element_size(value[order[k]]);
    if (row[k] == n + col[k]) diag[col[k]] = k;
  }
  sort_by(first[n], nq, col, NULL, down, at);
  const lag_elements of = {nq, n, first, col, row, diag, down, at};
  lag_scales(&of, scale, top, size);
  memcpy(unit, scale + n, (size_t)nq * sizeof *unit);
}

int lag_constraint_jacobian(lag_problem *pb, double t, const double *y, double *A, double *unit, double *mass) {
  const lag_constraints *of = pb->model->constraints;
  size_t nq = (size_t)pb->nq;
  double *entries = pb->ranks, *masses = entries + of->njacobian;
  int rc = lag_inputs(pb, t);
  rc = rc ? rc : of->matrices(of, t, y, y + nq, y + 2 * nq, pb->p, pb->u, entries, masses, pb->work);
  memset(A, 0, (size_t)of->n * nq * sizeof *A);
  if (rc) return rc;
  for (int e = 0; e < of->njacobian; e++)
    A[(size_t)of->jacobian[e].row * nq + (size_t)of->jacobian[e].col] = entries[e];
  find_units(pb, entries, masses, masses + of->nmass, unit);
  if (mass) lag_symmetric_matrix(nq, of->nmass, of->mass, masses, mass);
  return 0;
}

/* Indices of the components of x that are not 0, in order; -1: more than MOST_SPARSE. */
enum { MOST_SPARSE = 64 };
static int support_of(int n, const double *x, int *at) {
  int count = 0;
  for (int i = 0; i < n; i++) {
    if (x[i] == 0) continue;
    if (count == MOST_SPARSE) return -1;
    at[count++] = i;
  }
  return count;
}

static double length_of(int n, const double *x) {
  double s = 0;
  for (int i = 0; i < n; i++) s += x[i] * x[i];
  return sqrt(s);
}

/* Removes from x, of length 1, its projection on the rows of Q; returns what is left of the length. Where that is
 * little, a second pass removes the rounding of the first: J.W. Daniel, W.B. Gragg, L. Kaufman, G.W. Stewart, Math.
 * Comp. 30 (1976) 772, DOI 10.1090/S0025-5718-1976-0431641-8. Most rows have nothing in common with a constraint of few
 * coordinates; after one pass all rows have, by rounding. */
static double remainder_of(int n, int r, const double *Q, double *x) {
  const double little = 0.1;
  double left = 1;
  int at[MOST_SPARSE], count = support_of(n, x, at);
  for (int pass = 0; pass == 0 || (pass == 1 && left < little); pass++) {
    for (int k = 0; k < r; k++) {
      const double *q = Q + k * n;
      double along = 0;
      for (int i = 0; i < count; i++) along += q[at[i]] * x[at[i]];
      for (int i = 0; i < n && count < 0; i++) along += q[i] * x[i];
      if (along == 0.0) continue;
      for (int i = 0; i < n; i++) x[i] -= along * q[i];
      if (count >= 0) count = support_of(n, x, at);
    }
    left = length_of(n, x);
  }
  return left;
}

double lag_independent_part(int n, int r, double least, const double *unit, double *Q, double *row) {
  double most = 0;
  for (int i = 0; i < n; i++) {
    row[i] *= unit[i];
    most = fmax(most, fabs(row[i]));
  }
  for (int i = 0; i < n && most > 0; i++) { /* squares must not overflow or underflow */
    row[i] /= most;
  }
  double length = length_of(n, row);
  for (int i = 0; i < n && length > 0; i++) row[i] /= length;
  double left = length > 0 ? remainder_of(n, r, Q, row) : 0;
  for (int i = 0; i < n && left > least; i++) Q[r * n + i] = row[i] / left;
  return length > 0 ? left : -1;
}

/* Whether coordinate i has no scale: all of its unit begin at 0, as lengths of a track that starts at the origin. */
static int is_unscaled(const lag_problem *pb, int i) {
  const lag_var *q = &pb->model->q[i];
  int is_angle = lag_component_scale(DBL_MIN, q->periodic, q->unit) >= 1;
  return pb->begin && !is_angle && !(lag_unit_magnitude(pb, pb->begin, i) > 0);
}

/* Ratio of the first-order change of constraint k, when each coordinate moves by its typical magnitude, to the size
 * of its terms; at most 1, which is also that of a coordinate without a scale. */
static double slope(const lag_problem *pb, const double *y, const double *row, double size) {
  const lag_var *q = pb->model->q;
  double s = 0, reach = 0;
  for (int i = 0, last = -1; i < pb->nq; i++) {
    if (row[i] == 0.0) continue;
    if (last < 0 || !lag_are_alike(&q[last], &q[i])) {
      if (is_unscaled(pb, i)) return 1;
      reach = lag_typical_magnitude(pb, y, 1, i);
    }
    s += fabs(row[last = i]) * reach;
  }
  return size > 0 ? fmin(s / size, 1) : 1;
}

double lag_independence(lag_problem *pb, double t, const double *y, int *weakest) {
  const lag_constraints *of = pb->model->constraints;
  /* below: always redundant, as two feet of a block that stick */
  const double follows = pb->redundant || pb->model->ncontacts > 0 ? 1e-9 : 0;
  int nq = pb->nq, n = of->n, r = 0;
  double least = 1, *A = lag_independence_scratch(pb), *unit = A + n * nq, *size = unit + nq;
  int rc = lag_constraint_jacobian(pb, t, y, A, unit, NULL);
  *weakest = -1;
  rc = rc || (of->nholonomic > 0 && lag_constraint_terms(pb, t, y, 1, size));
  for (int k = 0; k < n && rc == 0; k++) {
    double *row = A + k * nq, part = k < of->nholonomic ? slope(pb, y, row, size[k]) : 1,
           left = fmax(lag_independent_part(nq, r, follows, unit, A, row), 0);
    if (left * part > follows && left * part < least) {
      least = left * part;
      *weakest = k;
    }
    r += left > follows;
  }
  return least;
}
