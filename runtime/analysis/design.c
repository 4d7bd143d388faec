/* D-optimal designs by exchange (V. V. Fedorov, Theory of Optimal Experiments, 1972, ch. 3): as long as an exchange of
 * a chosen row for another one raises the determinant of the information, the best one is made. Enters: rows of
 * derivatives; leaves: a choice that no exchange of one row improves, the best from several first ones. */
#include "analysis/design.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "lag.h"
#include "numeric/dense.h"
#include "numeric/release.h"

typedef struct Design {
  int rows, p, n;
  const double *G, *prior;
  double *scale;        /* [p] size of each column */
  double *M, *V, *A;    /* [p p] information of the chosen rows, its inverse; scratch */
  double *along;        /* [rows p] V g */
  int *chosen;          /* [n] */
  unsigned char *taken; /* [rows] */
} Design;

static double entry(const Design *d, int i, int j) { return d->G[(size_t)i * (size_t)d->p + (size_t)j] / d->scale[j]; }

static double *along(const Design *d, int i) { return d->along + (size_t)i * (size_t)d->p; }

/* Columns have length 1 each, so that no unit counts. */
static void take_scales(Design *d) {
  for (int j = 0; j < d->p; j++) {
    double sum = d->prior[j];
    d->scale[j] = 1;
    for (int i = 0; i < d->rows; i++) sum += entry(d, i, j) * entry(d, i, j);
    if (sum > 0) d->scale[j] = sqrt(sum);
  }
}

static void add_row(Design *d, int i) {
  for (int a = 0; a < d->p; a++)
    for (int b = 0; b < d->p; b++) d->M[a * d->p + b] += entry(d, i, a) * entry(d, i, b);
}

/* M := the information of n rows, all where chosen is NULL; with `more` on its diagonal. */
static void take_information(Design *d, int n, const int *chosen, double more) {
  memset(d->M, 0, (size_t)(d->p * d->p) * sizeof *d->M);
  for (int j = 0; j < d->p; j++) d->M[j * d->p + j] = d->prior[j] / (d->scale[j] * d->scale[j]) + more;
  for (int k = 0; k < n; k++) add_row(d, chosen ? chosen[k] : k);
}

/* V := M^-1, and V g of all rows where asked. Returns log det M; -infinity: singular up to rounding. */
static double invert(Design *d, int rows_too) {
  const double rounding = 1e-16;
  int p = d->p;
  double log_of = 0, largest = 0;
  memcpy(d->A, d->M, (size_t)(p * p) * sizeof *d->A);
  memset(d->V, 0, (size_t)(p * p) * sizeof *d->V);
  for (int j = 0; j < p; j++) d->V[j * p + j] = 1, largest = fmax(largest, d->M[j * p + j]);
  if (lag_eliminate((size_t)p, 0, d->A, d->A)) return -HUGE_VAL;
  for (int j = 0; j < p; j++) {
    double pivot = fabs(d->A[j * p + j]);
    if (!(pivot > rounding * largest)) return -HUGE_VAL;
    log_of += log(pivot);
  }
  memcpy(d->A, d->M, (size_t)(p * p) * sizeof *d->A);
  if (lag_solve_dense((size_t)p, (size_t)p, d->A, d->V)) return -HUGE_VAL;
  for (int i = 0; i < d->rows && rows_too; i++)
    for (int a = 0; a < p; a++) {
      double sum = 0;
      for (int b = 0; b < p; b++) sum += d->V[a * p + b] * entry(d, i, b);
      along(d, i)[a] = sum;
    }
  return log_of;
}

/* g_i V g_j */
static double variance(const Design *d, int i, int j) {
  double sum = 0;
  for (int a = 0; a < d->p; a++) sum += entry(d, i, a) * along(d, j)[a];
  return sum;
}

/* Makes the best exchange. 0: none raises the determinant. */
static int exchange(Design *d) {
  const double least = 1e-10;
  double best = 1 + least;
  int out = -1, in = -1;
  for (int k = 0; k < d->n; k++) {
    int i = d->chosen[k];
    double own = variance(d, i, i);
    for (int j = 0; j < d->rows; j++) {
      if (d->taken[j]) continue;
      double mixed = variance(d, i, j), gain = (1 - own) * (1 + variance(d, j, j)) + mixed * mixed;
      if (gain > best) best = gain, out = k, in = j;
    }
  }
  if (out < 0) return 0;
  d->taken[d->chosen[out]] = 0;
  d->taken[in] = 1;
  d->chosen[out] = in;
  return 1;
}

static void choose_row(Design *d, int k, int i) {
  d->chosen[k] = i;
  d->taken[i] = 1;
}

/* One row after the other, each the one that says most beside those before. */
static void choose_greedily(Design *d) {
  const double little = 1e-9;
  for (int k = 0; k < d->n; k++) {
    int best = -1;
    double most = -1;
    take_information(d, k, d->chosen, little);
    invert(d, 1);
    for (int i = 0; i < d->rows; i++) {
      double says = d->taken[i] ? -1 : variance(d, i, i);
      if (says > most) most = says, best = i;
    }
    choose_row(d, k, best);
  }
}

/* First choice number `which`: greedy, at equal distances, or by chance, the same at each call. */
static void choose_first(Design *d, int which) {
  uint64_t x = 0x9E3779B97F4A7C15u * (uint64_t)(which + 1);
  memset(d->taken, 0, (size_t)d->rows);
  if (which == 0) {
    choose_greedily(d);
    return;
  }
  for (int k = 0; k < d->n; k++) {
    x = x * 6364136223846793005u + 1442695040888963407u;
    int i = which == 1 ? (int)((k + 0.5) * d->rows / d->n) : (int)((x >> 33) % (uint64_t)d->rows);
    while (d->taken[i]) i = (i + 1) % d->rows;
    choose_row(d, k, i);
  }
}

/* Exchanges from a first choice until none raises the determinant, of which it returns the logarithm. */
static double improve(Design *d) {
  const double little = 1e-9; /* until the rows determine all values */
  double now;
  int most = 20 * d->n + 100;
  do {
    take_information(d, d->n, d->chosen, 0);
    now = invert(d, 1);
    if (now == -HUGE_VAL) {
      take_information(d, d->n, d->chosen, little);
      invert(d, 1);
    }
  } while (most-- > 0 && exchange(d));
  return now;
}

static int open_design(Design *d) {
  size_t p = (size_t)d->p, rows = (size_t)d->rows;
  d->scale = calloc(p + 3 * p * p + rows * p + 1, sizeof *d->scale);
  d->chosen = calloc((size_t)d->n + 1, sizeof *d->chosen);
  d->taken = calloc(rows + 1, 1);
  if (!d->scale || !d->chosen || !d->taken) return LAG_ENOMEM;
  d->M = d->scale + p;
  d->V = d->M + p * p;
  d->A = d->V + p * p;
  d->along = d->A + p * p;
  take_scales(d);
  return LAG_OK;
}

static void close_design(Design *d) {
  lag_free_all(d->scale, d->chosen, d->taken);
}

static int by_number(const void *a, const void *b) {
  int x = *(const int *)a, y = *(const int *)b;
  return (x > y) - (x < y);
}

int lag_design_choose(int rows, int p, const double *G, const double *prior, int n, int *chosen) {
  enum { FIRST = 8 };
  Design d = {.rows = rows, .p = p, .n = n, .G = G, .prior = prior};
  int rc = open_design(&d);
  double best = -HUGE_VAL;
  for (int which = 0; which < FIRST && rc == LAG_OK; which++) {
    choose_first(&d, which);
    double now = improve(&d);
    if (!(now > best)) continue;
    best = now;
    memcpy(chosen, d.chosen, (size_t)n * sizeof *chosen);
  }
  close_design(&d);
  if (rc == LAG_OK && best == -HUGE_VAL) return LAG_EDOMAIN;
  if (rc == LAG_OK) qsort(chosen, (size_t)n, sizeof *chosen, by_number);
  return rc;
}

int lag_design_errors(int rows, int p, const double *G, const double *prior, int n, const int *chosen, double *error) {
  Design d = {.rows = rows, .p = p, .n = 0, .G = G, .prior = prior};
  int rc = open_design(&d);
  if (rc == LAG_OK) {
    take_information(&d, chosen ? n : rows, chosen, 0);
    rc = invert(&d, 0) == -HUGE_VAL ? LAG_EDOMAIN : LAG_OK;
  }
  for (int j = 0; j < p && rc == LAG_OK; j++) error[j] = sqrt(d.V[j * p + j]) / d.scale[j];
  close_design(&d);
  return rc;
}
