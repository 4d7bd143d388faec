/* Forces within Coulomb's cones, by a linear programme. Contract: cone_forces.h. */
#include "contacts/cone_forces.h"

#include <math.h>

enum { MOST_DIRECTIONS = 2 * LAG_MOST_TOUCHES, MOST_LIMITS = 2 * LAG_MOST_TOUCHES + 1, MOST_COLUMNS = MOST_DIRECTIONS + 2 };

/* Relative to the largest element of a direction: rounding of coefficients, with room for directions that depend on others. */
static const double small = 1e-7;

/* Slack k = T[k] . (c, margin, 1) >= 0; the last row is the margin. Variables: 0..n-1 c, n the margin, n + 1 + k slack k. */
typedef struct Programme {
  int n, limits, row[MOST_LIMITS + 1], column[MOST_COLUMNS];
  double T[MOST_LIMITS + 1][MOST_COLUMNS];
} Programme;

static int is_free(const Programme *p, int variable) { return variable <= p->n; }

/* Exchanges the variable of row r with that of column c. */
static void exchange(Programme *p, int r, int c) {
  double *row = p->T[r], pivot = row[c];
  int variable = p->row[r];
  for (int j = 0; j <= p->n + 1; j++) row[j] = j == c ? 1 / pivot : -row[j] / pivot;
  for (int k = 0; k <= p->limits; k++) {
    double factor = p->T[k][c];
    if (k == r) continue;
    for (int j = 0; j <= p->n + 1; j++) p->T[k][j] = (j == c ? 0 : p->T[k][j]) + factor * row[j];
  }
  p->row[r] = p->column[c];
  p->column[c] = variable;
}

/* The row that limits variable c as it moves to the side `to`; -1: none. */
static int find_limit(const Programme *p, int c, double to) {
  int limit = -1;
  double most = HUGE_VAL;
  for (int k = 0; k < p->limits; k++) {
    double slope = to * p->T[k][c];
    if (is_free(p, p->row[k]) || slope > -small || !(p->T[k][p->n + 1] / -slope < most)) continue;
    most = p->T[k][p->n + 1] / -slope;
    limit = k;
  }
  return limit;
}

static void maximise(Programme *p) {
  int first = 0, turns = 0;
  for (int k = 1; k < p->limits; k++)
    if (p->T[k][p->n + 1] < p->T[first][p->n + 1]) first = k;
  exchange(p, first, p->n);
  for (int c = 0; c <= p->n && turns < 1000; c++) {
    double gain = p->T[p->limits][c];
    int limit = gain > small || (gain < -small && is_free(p, p->column[c])) ? find_limit(p, c, gain > 0 ? 1 : -1) : -1;
    if (limit < 0) continue;
    exchange(p, limit, c);
    turns++;
    c = -1;
  }
}

/* Adds the limit sum over rows i, k of (fi x_i + fk x_k) >= margin. */
static void add_limit(Programme *p, const double *x, const double *D, int rows, int i, double fi, int k, double fk) {
  double *row = p->T[p->limits++];
  for (int j = 0; j < p->n; j++) row[j] = fi * D[j * rows + i] + fk * D[j * rows + k];
  row[p->n] = -1;
  row[p->n + 1] = fi * x[i] + fk * x[k];
}

/* Divides column j by its largest element, and returns that. */
static double scale_column(Programme *p, int j) {
  double most = 0;
  for (int k = 0; k < p->limits; k++) most = fmax(most, fabs(p->T[k][j]));
  for (int k = 0; k < p->limits && most > 0; k++) p->T[k][j] /= most;
  return most > 0 ? most : 1;
}

double lag_cone_forces(int n, const lag_touch *of, int rows, double *x, int n_directions, const double *D, double *c, int *wedged) {
  Programme p = {.n = n_directions};
  double size = 0, unit[MOST_DIRECTIONS];
  for (int i = 0; i < n; i++) {
    if (of[i].mode == LAG_CONTACT_OPEN) continue;
    int sticks = of[i].mode == LAG_CONTACT_STICKS;
    for (int side = -1; side <= sticks; side += 2) add_limit(&p, x, D, rows, i, sticks ? lag_touch_holds(&of[i]) : 1, sticks ? of[i].tangent : i, sticks ? side : 0);
  }
  for (int k = 0; k < p.limits; k++) size = fmax(size, fabs(p.T[k][p.n + 1]));
  p.T[p.limits][p.n] = -1; /* the margin is at most as large as the forces */
  p.T[p.limits][p.n + 1] = size;
  int most = p.limits++;
  for (int k = 0; k < p.limits; k++) {
    p.T[k][p.n + 1] /= size > 0 ? size : 1;
    p.row[k] = p.n + 1 + k;
  }
  for (int j = 0; j <= p.n; j++) {
    p.column[j] = j;
    p.T[p.limits][j] = j == p.n;
  }
  for (int j = 0; j < p.n; j++) unit[j] = scale_column(&p, j);
  maximise(&p);
  for (int j = 0; j < p.n; j++) c[j] = 0;
  *wedged = 0;
  for (int k = 0; k < p.limits; k++)
    if (p.row[k] < p.n) c[p.row[k]] = p.T[k][p.n + 1] * size / unit[p.row[k]];
  for (int j = 0; j <= p.n; j++) *wedged |= p.column[j] == p.n + 1 + most;
  for (int i = 0; i < rows; i++)
    for (int j = 0; j < p.n; j++) x[i] += c[j] * D[j * rows + i];
  return p.T[p.limits][p.n + 1] * size;
}
