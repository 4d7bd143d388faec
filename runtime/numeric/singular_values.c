/* Singular values by one-sided Jacobi rotations (singular_values.h). */
#include "numeric/singular_values.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "numeric/dense.h"

enum { MOST_SWEEPS = 60 };

/* Columns i and j of A := their rotation by the angle with cosine c and sine s. */
static void rotate(int rows, int cols, double *A, int i, int j, double c, double s) {
  for (int r = 0; r < rows; r++) {
    double x = A[r * cols + i], y = A[r * cols + j];
    A[r * cols + i] = c * x - s * y;
    A[r * cols + j] = s * x + c * y;
  }
}

/* Makes columns i and j of A orthogonal; whether they were not. `floor`: squared length that counts as 0. */
static int orthogonalise(int rows, int cols, double *A, double *V, int i, int j, double floor) {
  double a = lag_columns_dot(rows, cols, A, i, i), b = lag_columns_dot(rows, cols, A, j, j);
  double d = lag_columns_dot(rows, cols, A, i, j);
  if (fabs(d) <= 4 * DBL_EPSILON * sqrt(a) * sqrt(b) || (a <= floor && b <= floor)) return 0;
  double z = (b - a) / (2 * d), t = (z < 0 ? -1 : 1) / (fabs(z) + hypot(1, z)), c = 1 / hypot(1, t);
  rotate(rows, cols, A, i, j, c, c * t);
  rotate(cols, cols, V, i, j, c, c * t);
  return 1;
}

/* Sorts columns by length, longest first. */
static void sort_columns(int rows, int cols, double *A, double *V, double *sigma) {
  for (int k = 0; k < cols; k++) sigma[k] = sqrt(lag_columns_dot(rows, cols, A, k, k));
  for (int k = 0; k < cols; k++) {
    int top = k;
    for (int i = k; i < cols; i++) top = sigma[i] > sigma[top] ? i : top;
    if (top == k) continue;
    lag_swap(&sigma[k], &sigma[top]);
    lag_swap_columns((size_t)rows, (size_t)cols, A, (size_t)k, (size_t)top);
    lag_swap_columns((size_t)cols, (size_t)cols, V, (size_t)k, (size_t)top);
  }
}

void lag_singular_values(int rows, int cols, double *A, double *V, double *sigma) {
  double size = 0;
  memset(V, 0, (size_t)cols * (size_t)cols * sizeof *V);
  for (int k = 0; k < cols; k++) V[k * cols + k] = 1;
  for (int k = 0; k < rows * cols; k++) size += A[k] * A[k];
  double floor = DBL_EPSILON * DBL_EPSILON * size;
  for (int sweep = 0, turned = 1; turned && sweep < MOST_SWEEPS; sweep++) {
    turned = 0;
    for (int i = 0; i < cols; i++)
      for (int j = i + 1; j < cols; j++) turned |= orthogonalise(rows, cols, A, V, i, j, floor);
  }
  sort_columns(rows, cols, A, V, sigma);
}

int lag_least_norm(lag_decomposed of, double least, double damping, const double *b, double *x) {
  int rank = 0, cols = of.cols;
  const double *sigma = of.sigma;
  memset(x, 0, (size_t)cols * sizeof *x);
  for (; rank < cols && sigma[rank] > 0 && sigma[rank] > least * sigma[0]; rank++) {
    double part = 0;
    for (int r = 0; r < of.rows; r++) part += of.AV[r * cols + rank] * b[r];
    part /= sigma[rank] * sigma[rank] + damping;
    for (int i = 0; i < cols; i++) x[i] += part * of.V[i * cols + rank];
  }
  return rank;
}
