/* Complementarity problems with boxes by the criss-cross method. Contract: complementarity.h.
 * Invariant: basic = q + M nonbasic, of each pair (z_i, w_i) one in row i, the other in column
 * i; z_i is basic where it is between its bounds. */
#include "numeric/complementarity.h"

#include <math.h>
#include <stddef.h>

#include "numeric/dense.h"

static const lag_box pushes = {0, HUGE_VAL, 0, 0};

static const lag_box *box_of(const lag_complementarity *p, int i) { return p->box ? &p->box[i] : &pushes; }
static double width_of(const lag_box *b) { return b->upper - b->lower; }
static int is_free(const lag_box *b) { return isinf(b->lower) && isinf(b->upper); }

lag_complementarity lag_contact_complementarity(int n, double *M, double *q, double *scale, unsigned char *at) {
  for (int i = 0; i < n; i++) at[i] = LAG_AT_LOWER;
  return (lag_complementarity){n, -1, M, q, scale, NULL, at, lag_dependent_row, 1e-13};
}

/* Exchanges basic variable r with nonbasic variable s. */
static void pivot(const lag_complementarity *p, int r, int s) {
  int n = p->n, first = s, end = s + 1; /* the row is zero outside */
  double *const row = p->M + r * n, at = row[s];
  for (int j = 0; j < n; j++) {
    first = row[j] != 0 && j < first ? j : first;
    end = row[j] != 0 && j >= end ? j + 1 : end;
    row[j] = j == s ? 1 / at : -row[j] / at; /* x_s = (basic_r - q_r - others)/at */
  }
  p->q[r] = -p->q[r] / at;
  for (int i = 0; i < n; i++) {
    double *const other = p->M + i * n, factor = other[s];
    if (i == r || factor == 0) continue; /* of another island */
    for (int j = first; j < end; j++) other[j] = j == s ? factor * row[j] : other[j] + factor * row[j];
    p->q[i] += factor * p->q[r];
  }
}

/* Exchanges both variables of the pairs r and s, and puts each pair back into its row. */
static void pivot_pairs(const lag_complementarity *p, int r, int s) {
  size_t n = (size_t)p->n;
  pivot(p, r, s);
  pivot(p, s, r);
  lag_swap(&p->q[r], &p->q[s]);
  lag_swap_rows(n, p->M, (size_t)r, (size_t)s);
  lag_swap_columns(n, n, p->M, (size_t)r, (size_t)s);
}

/* Scales M to a diagonal of ones, and q with it; z_i is in units of scale[i] from here on. */
static void scale_to_unit_diagonal(const lag_complementarity *p) {
  int n = p->n;
  for (int i = 0; i < n; i++) p->scale[i] = p->M[i * n + i] > 0 ? 1 / sqrt(p->M[i * n + i]) : 1;
  for (int i = 0; i < n; i++) {
    p->q[i] *= p->scale[i];
    for (int j = 0; j < n; j++) p->M[i * n + j] *= p->scale[i] * p->scale[j];
  }
}

/* z_i where it is at a bound; 0 where it has none. */
static double bound_of(const lag_complementarity *p, int i) {
  const lag_box *b = box_of(p, i);
  return is_free(b) ? 0 : p->at[i] == LAG_AT_LOWER ? b->lower : b->upper;
}

static double basic(const lag_complementarity *p, int i) {
  double x = p->q[i];
  for (int j = 0; j < p->n && p->box; j++) {
    double at = p->at[j] == LAG_BETWEEN ? 0 : bound_of(p, j);
    x += at != 0 ? p->M[i * p->n + j] * (at / p->scale[j]) : 0;
  }
  return x;
}

/* Size of a z beside its bound, or of a w, that counts as 0. most: the largest |q|. */
static double rounding_of(const lag_complementarity *p, int i, double most) {
  const lag_box *b = box_of(p, i);
  double width = width_of(b) / p->scale[i];
  if (b->is_switch > 0) return 0;
  if (isinf(width)) return p->rounding * most;
  return p->at[i] == LAG_BETWEEN ? 10 * p->rounding * (width + b->reserve / p->scale[i]) : 1e4 * p->rounding * width;
}

/* The direction in which basic variable r has to move, 0: none, by its lower bound (w >= 0, z >= lower), or by its
 * upper one. */
static int violation(const lag_complementarity *p, int r, int upper, double most) {
  const lag_box *b = box_of(p, r);
  double x = basic(p, r), rounding = rounding_of(p, r, most);
  if (is_free(b)) return p->at[r] == LAG_BETWEEN || !(fabs(x) > rounding) || upper ? 0 : x < 0 ? 1 : -1;
  if (p->at[r] != LAG_BETWEEN && (p->at[r] == LAG_AT_UPPER) != upper) return 0;
  double bound = p->at[r] != LAG_BETWEEN ? 0 : (upper ? b->upper + b->reserve : b->lower - b->reserve) / p->scale[r];
  return upper ? -(x > bound + rounding) : x < bound - rounding;
}

/* The first violated bound: its direction, 0: none; *r := its pair. */
static int first_violation(const lag_complementarity *p, double most, int *r) {
  for (int k = 0; k < 2 * p->n; k += p->box ? 1 : 2) {
    int direction = violation(p, *r = k / 2, k % 2, most);
    if (direction) return direction;
  }
  return 0;
}

/* Whether nonbasic variable s of a bound may move away from it: z from its bound, w = 0 to the
 * side of a bound. *to: direction. */
static int may_move(const lag_complementarity *p, int s, int upper, int *to) {
  const lag_box *b = box_of(p, s);
  *to = upper ? -1 : 1;
  if (b->is_switch > 0) return 0;
  if (p->at[s] == LAG_BETWEEN) return isfinite(upper ? b->upper : b->lower);
  return is_free(b) || (p->at[s] == LAG_AT_UPPER) == upper;
}

/* Basic variable r moves by another's, its own response being 0; or w_r from one bound of z_r to
 * the other. 0: by none. */
static int move_by_another(lag_complementarity *p, int r, int direction) {
  int n = p->n;
  for (int k = 0; k < 2 * n; k++) {
    int s = k / 2, upper = k % 2, to;
    if (s == r && p->at[r] == (upper ? LAG_AT_LOWER : LAG_AT_UPPER) && isfinite(width_of(box_of(p, r)))) {
      p->at[r] = upper ? LAG_AT_UPPER : LAG_AT_LOWER;
      return 1;
    }
    if (s == r || !may_move(p, s, upper, &to) || !(p->M[r * n + s] * direction * to > p->zero)) continue;
    if (!(fabs(p->M[s * n + r]) > p->zero)) return 0;
    pivot_pairs(p, r, s);
    p->at[r] = p->at[r] != LAG_BETWEEN ? LAG_BETWEEN : direction > 0 ? LAG_AT_LOWER : LAG_AT_UPPER;
    p->at[s] = p->at[s] != LAG_BETWEEN ? LAG_BETWEEN : upper ? LAG_AT_UPPER : LAG_AT_LOWER;
    return 1;
  }
  return 0;
}

/* Pivots on the pairs with which the search begins between bounds. */
static int pivot_first(lag_complementarity *p) {
  for (int i = 0; i < p->n; i++) {
    if (p->at[i] != LAG_BETWEEN) continue;
    p->row = i;
    if (!(p->M[i * p->n + i] > p->zero)) return LAG_NOT_MONOTONE;
    pivot(p, i, i);
  }
  return LAG_SOLVED;
}

/* z_i in the caller's units, without rounding beyond its bounds. */
static double result(const lag_complementarity *p, int i) {
  const lag_box *b = box_of(p, i);
  if (p->at[i] != LAG_BETWEEN) return bound_of(p, i);
  return fmin(fmax(basic(p, i) * p->scale[i], b->lower - b->reserve), b->upper + b->reserve);
}

int lag_solve_complementarity(lag_complementarity *p) {
  double most = 0;
  int r = 0, direction;
  scale_to_unit_diagonal(p);
  for (int i = 0; i < p->n; i++) most = fmax(most, fabs(p->q[i]));
  int status = pivot_first(p);
  for (int turn = 0; turn < 1000 + 100 * p->n && status == LAG_SOLVED; turn++) {
    if ((direction = first_violation(p, most, &r)) == 0) {
      for (int i = 0; i < p->n; i++) p->q[i] = result(p, i);
      return LAG_SOLVED;
    }
    double own = p->M[r * p->n + r];
    p->row = r;
    if (box_of(p, r)->is_switch > 0) p->at[r] = p->at[r] == LAG_AT_LOWER ? LAG_AT_UPPER : LAG_AT_LOWER;
    else if (own > p->zero) {
      pivot(p, r, r);
      p->at[r] = p->at[r] != LAG_BETWEEN ? LAG_BETWEEN : direction > 0 ? LAG_AT_LOWER : LAG_AT_UPPER;
    } else if (own < -1e4 * p->zero) status = LAG_NOT_MONOTONE;
    else if (!move_by_another(p, r, direction)) status = LAG_NO_SOLUTION;
  }
  return status == LAG_SOLVED ? LAG_CYCLES : status;
}
