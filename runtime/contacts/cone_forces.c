/* Forces within Coulomb's cones, by a linear programme. Contract: contact_modes.h. */
#include "contacts/contact_modes.h"

#include <math.h>
#include <string.h>

#include "numeric/complementarity.h"

/* Variables: coefficients c, the margin, prices of the limits, the last of which bounds the
 * margin. */
enum {
  MOST_DIRECTIONS = 2 * LAG_MOST_TOUCHES,
  MOST_LIMITS = 2 * LAG_MOST_TOUCHES + 1,
  MOST_VARIABLES = MOST_DIRECTIONS + 1 + MOST_LIMITS
};

/* Limit k: slope[k] . c - margin + value[k] >= 0. */
typedef struct Programme {
  int n, limits, rows;
  double *x;       /* [rows] forces given */
  const double *D; /* [n rows] directions */
  double slope[MOST_LIMITS][MOST_DIRECTIONS], value[MOST_LIMITS];
} Programme;

/* Adds the limit sum over rows i, k of (fi x_i + fk x_k) >= margin. */
static void add_limit(Programme *p, int i, double fi, int k, double fk) {
  double *slope = p->slope[p->limits];
  for (int j = 0; j < p->n; j++) slope[j] = fi * p->D[j * p->rows + i] + fk * p->D[j * p->rows + k];
  p->value[p->limits++] = fi * p->x[i] + fk * p->x[k];
}

/* Divides column j by its largest element, and returns that. */
static double scale_column(Programme *p, int j) {
  double most = 0;
  for (int k = 0; k < p->limits; k++) most = fmax(most, fabs(p->slope[k][j]));
  for (int k = 0; k < p->limits && most > 0; k++) p->slope[k][j] /= most;
  return most > 0 ? most : 1;
}

/* z := c, margin, prices for the largest margin: conditions of optimality. Returns whether only
 * the last limit bounds it. */
static int maximise(const Programme *p, double *z) {
  const double small = 1e-7; /* rounding of directions, with room for those that depend on others */
  int n = p->n + 1 + p->limits, margin = p->n;
  double M[MOST_VARIABLES * MOST_VARIABLES] = {0}, scale[MOST_VARIABLES];
  lag_box box[MOST_VARIABLES];
  unsigned char at[MOST_VARIABLES] = {0};
  for (int i = 0; i < n; i++) {
    box[i] = (lag_box){i <= margin ? -HUGE_VAL : 0, HUGE_VAL, 0, 0};
    z[i] = i < margin ? 0 : i == margin ? -1 : p->value[i - margin - 1];
  }
  for (int k = 0; k < p->limits; k++) {
    int i = margin + 1 + k;
    for (int j = 0; j <= margin; j++) {
      M[i * n + j] = j == margin ? -1 : p->slope[k][j];
      M[j * n + i] = -M[i * n + j];
    }
  }
  lag_complementarity q = {n, -1, M, z, scale, box, at, small, 1e-12};
  int found = lag_solve_complementarity(&q) == LAG_SOLVED;
  for (int i = 0; i < n && !found; i++) z[i] = 0;
  return found && at[n - 1] == LAG_BETWEEN;
}

int lag_cone_forces(int n, const lag_touch *of, int rows, double *x, int n_directions, const double *D, double *c) {
  Programme p = {.n = n_directions, .rows = rows, .x = x, .D = D};
  double size = 0, unit[MOST_DIRECTIONS], z[MOST_VARIABLES];
  for (int i = 0; i < n; i++) {
    if (of[i].mode == LAG_CONTACT_OPEN) continue;
    int sticks = of[i].mode == LAG_CONTACT_STICKS, other = sticks ? of[i].tangent : i;
    double part = sticks ? lag_touch_holds(&of[i]) : 1;
    for (int side = -1; side <= sticks; side += 2) add_limit(&p, i, part, other, sticks ? side : 0);
  }
  for (int k = 0; k < p.limits; k++) size = fmax(size, fabs(p.value[k]));
  for (int k = 0; k < p.limits; k++) p.value[k] /= size > 0 ? size : 1;
  for (int j = 0; j < p.n; j++) unit[j] = scale_column(&p, j);
  memset(p.slope[p.limits], 0, sizeof p.slope[0]); /* the margin is at most as large as the forces */
  p.value[p.limits++] = size > 0 ? 1 : 0;
  int wedged = maximise(&p, z);
  for (int j = 0; j < p.n; j++) c[j] = z[j] * size / unit[j];
  c[p.n] = z[p.n] * size;
  for (int i = 0; i < rows; i++)
    for (int j = 0; j < p.n; j++) x[i] += c[j] * D[j * rows + i];
  return wedged;
}
