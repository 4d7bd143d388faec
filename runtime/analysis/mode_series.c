/* Coefficients and harmonics of series in the amplitude (mode_series.h): coefficients of y' along a curve are those of
 * the model's Taylor recurrences, exact but for rounding. */
#include "analysis/mode_series.h"

#include <math.h>
#include <string.h>

#include "numeric/dense.h"

enum { ORDER = SERIES_ORDER, HARMONICS = SERIES_HARMONICS };

double *lag_series_harmonic(const Series *s, int order, int h) {
  return s->y + (size_t)(order * HARMONICS + h) * 2 * (size_t)s->n;
}

int lag_series_rates(Series *s, int order) {
  lag_problem *pb = s->pb;
  const lag_taylor *ty = pb->model->taylor;
  const int nq = pb->nq, n = s->n, columns = ty->columns;
  const double *y = s->rest;
  memset(s->x, 0, (size_t)(ORDER + 2) * (size_t)columns * sizeof *s->x);
  int rc = lag_inputs_inline(pb, s->t);
  if (rc) return rc;
  rc = ty->first(ty, s->t, y, y + nq, y + 2 * nq, pb->p, pb->u, s->held, s->x, pb->work);
  if (rc) return rc;
  for (int j = 1; j <= order; j++)
    for (int i = 0; i < n; i++) s->x[j * columns + i] = s->scale[i] * s->curve[j * n + i];
  ty->along(ty, order + 1, s->x, pb->work);
  for (int i = 0; i < n; i++) {
    int column = i < nq ? nq + i : pb->nq + pb->nz + i;
    s->rates[i] = s->x[order * columns + column] / (s->scale[i] * s->w);
  }
  return LAG_OK;
}

static int linearise(Series *s) {
  for (int j = 0; j < s->n; j++) {
    memset(s->curve, 0, (size_t)(HARMONICS * s->n) * sizeof *s->curve);
    s->curve[s->n + j] = 1;
    int rc = lag_series_rates(s, 1);
    if (rc) return rc;
    for (int i = 0; i < s->n; i++) s->B[i * s->n + j] = s->rates[i];
  }
  return LAG_OK;
}

int lag_series_resonant(const Series *s, int own, double h, double near, int *with, double *divisor) {
  int count = 0;
  *divisor = near;
  for (int j = 0; j < s->modes->n; j++) {
    const Mode *m = &s->modes->mode[j];
    double off = hypot(m->re, m->im - fabs(h) * s->w) / s->w;
    if (j == own || !(off < near)) continue;
    if (!count++ || off < *divisor) *with = j, *divisor = off;
  }
  return count;
}

int lag_series_equations(Series *s, double h, int real, const double *u, int leads) {
  const int n = s->n, N = real ? n : u ? 2 * n + 2 : 2 * n;
  memset(s->M, 0, sizeof(double) * (size_t)N * (size_t)N);
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < n; j++) s->M[i * N + j] = -s->B[i * n + j];
    if (real) continue;
    for (int j = 0; j < n; j++) s->M[(n + i) * N + n + j] = -s->B[i * n + j];
    s->M[i * N + n + i] -= h, s->M[(n + i) * N + i] += h;
    if (!u) continue;
    s->M[i * N + 2 * n] = -u[n + i], s->M[i * N + 2 * n + 1] = -u[i];
    s->M[(n + i) * N + 2 * n] = u[i], s->M[(n + i) * N + 2 * n + 1] = -u[n + i];
  }
  if (u) s->M[2 * n * N + leads] = s->M[(2 * n + 1) * N + n + leads] = 1;
  return N;
}

int lag_series_solve(Series *s, int N, int free, double rounding) {
  const double vanishes = 1e-9;
  double *M = s->M, *b = s->rhs, *x = s->perm + N;
  int rank = N;
  for (int i = 0; i < N; i++) s->perm[i] = i;
  for (int k = 0; k < rank; k++) {
    if (k == N - free)
      for (int i = k; i < N; i++)
        if (fabs(b[i]) > rounding) return 1;
    int row, col;
    double pivot = lag_complete_pivot(N, k, M, &row, &col);
    lag_swap(&b[k], &b[row]);
    lag_swap(&s->perm[k], &s->perm[col]);
    if (k >= N - free && pivot < vanishes) rank = k;
    else if (!(pivot > 0)) return 1;
    for (int i = k + 1; i < N && k < rank; i++) b[i] -= lag_eliminate_row(N, M, k, i) * b[k];
  }
  for (int i = N - 1; i >= 0; i--) {
    double sum = i < rank ? b[i] : 0;
    for (int j = i + 1; j < rank && i < rank; j++) sum -= M[i * N + j] * x[(int)s->perm[j]];
    x[(int)s->perm[i]] = i < rank ? sum / M[i * N + i] : 0;
  }
  memcpy(b, x, (size_t)N * sizeof *b);
  return 0;
}

/* y_1 := the mode with amplitude 1 of the leading unknown, refined by Newton's method. 0: no shape of its own. */
static int place_mode(Series *s) {
  const double equal = 1e-3;
  const Mode *m = &s->modes->mode[s->k];
  const int n = s->n, nq = s->pb->nq, nz = s->pb->nz, lead = s->leads < nq ? s->leads : s->leads - nq;
  double *u = lag_series_harmonic(s, 1, 1), unit = s->scale[s->leads];
  double re = m->shape_re[lead], im = m->shape_im[lead], size = 2 * (re * re + im * im);
  for (int i = 0; i < nq + nz; i++) {
    int to = i < nq ? i : nq + i;
    double part = unit / s->scale[to] / size;
    u[to] = (m->shape_re[i] * re + m->shape_im[i] * im) * part;
    u[n + to] = (m->shape_im[i] * re - m->shape_re[i] * im) * part;
    if (i < nq) u[nq + i] = -u[n + i], u[n + nq + i] = u[i];
  }
  for (int step = 0; step < 2; step++) {
    for (int i = 0; i < n; i++) {
      s->rhs[i] = u[n + i] + lag_dot(n, s->B + i * n, u);
      s->rhs[n + i] = -u[i] + lag_dot(n, s->B + i * n, u + n);
    }
    s->rhs[2 * n] = s->rhs[2 * n + 1] = 0;
    int with, N = lag_series_equations(s, 1, 0, u, s->leads);
    double divisor;
    if (lag_series_solve(s, N, 2 * lag_series_resonant(s, s->k, 1, equal, &with, &divisor), HUGE_VAL)) return 0;
    for (int i = 0; i < 2 * n; i++) u[i] += s->rhs[i];
  }
  return 1;
}

/* The unknown that moves most, in its unit; of equal ones the first. */
static int leading(const Series *s, const Mode *m) {
  int nq = s->pb->nq, leads = 0;
  double most = 0;
  for (int i = 0; i < nq + s->pb->nz; i++) {
    int at = i < nq ? i : nq + i;
    double size = hypot(m->shape_re[i], m->shape_im[i]) / s->scale[at];
    if (size > most * (1 + 1e-6)) leads = at, most = size;
  }
  return leads;
}

int lag_series_open(Series *s, const Modes *modes, int k, Equilibrium *rest, double **u) {
  lag_problem *pb = &rest->sim->pb;
  *s = (Series){.modes = modes, .k = k, .pb = pb, .rest = rest->y, .n = pb->n, .w = modes->mode[k].im,
                .t = rest->sim->scene->t0, .out = s->out};
  const size_t n = (size_t)s->n, N = 2 * n + 2;
  const lag_part parts[] = {
      {&s->scale, n}, {&s->x, (size_t)(ORDER + 2) * (size_t)s->pb->model->taylor->columns + 8},
      {&s->held, (size_t)s->pb->model->nu + 1}, {&s->B, n * n}, {&s->y, HARMONICS * HARMONICS * 2 * n},
      {&s->r, HARMONICS * 2 * n}, {&s->curve, HARMONICS * n}, {&s->rates, n}, {&s->M, N * N}, {&s->rhs, N},
      {&s->perm, 2 * N}};
  lag_pool_parts(&s->pool, sizeof parts / sizeof *parts, parts);
  if (s->pool.failed) return LAG_ENOMEM;
  for (int i = 0; i < s->n; i++) {
    int of = i >= s->pb->nq && i < 2 * s->pb->nq ? i - s->pb->nq : i;
    s->scale[i] = lag_difference_scale(s->pb, rest->y, of) * (of < i ? s->w : 1);
  }
  s->leads = leading(s, &s->modes->mode[s->k]);
  int rc = linearise(s);
  *u = lag_series_harmonic(s, 1, 1);
  return rc ? rc : !place_mode(s);
}

int lag_mode_oscillates(const Mode *m) {
  const double undamped = 1e-9;
  return m->im > 0 && fabs(m->re) <= undamped * m->im && m->repeats <= 1;
}
