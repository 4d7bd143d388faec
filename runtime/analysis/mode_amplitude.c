/* Frequency over amplitude (mode_amplitude.h): the family of periodic motions as a power series in its amplitude e,
 *
 *     y(phi) = y0 + e y_1(phi) + e^2 y_2(phi) + ...,   phi' = w (1 + c_1 e + c_2 e^2 + ...),
 *
 * by A. Lindstedt's and H. Poincare's method. Coefficients of y' along such a curve are those of the model's Taylor
 * recurrences, exact but for rounding, at some phases; their harmonics h give linear equations
 * (i h - B) Y = R for those of y_k, with B the linearised model, and for h = 1 one more unknown, c_(k-1). y_k has
 * harmonics of the parity of k, up to k. In units of 1/w and of each unknown. */
#include "analysis/mode_series.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "numeric/dense.h"

enum { ORDER = SERIES_ORDER, HARMONICS = SERIES_HARMONICS };

static double *harmonic(const Series *s, int order, int h) {
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

/* Harmonics r[h] of the rates of order k that y_1 .. y_(k-1) cause, from `points` phases. */
static int force(Series *s, int k, int points) {
  const double turn = 2 * acos(-1) / points;
  const int n = s->n;
  memset(s->r, 0, sizeof(double) * HARMONICS * 2 * (size_t)n);
  memset(s->curve, 0, sizeof(double) * HARMONICS * (size_t)n);
  for (int p = 0; p < points; p++) {
    for (int j = 1; j < k; j++)
      for (int i = 0; i < n; i++) {
        double sum = 0;
        for (int h = j % 2; h <= j; h += 2) {
          const double *y = harmonic(s, j, h);
          sum += (h ? 2 : 1) * (y[i] * cos(h * p * turn) - y[n + i] * sin(h * p * turn));
        }
        s->curve[j * n + i] = sum;
      }
    int rc = lag_series_rates(s, k);
    if (rc) return rc;
    for (int h = k % 2; h <= k; h += 2)
      for (int i = 0; i < n; i++) {
        s->r[h * 2 * n + i] += s->rates[i] * cos(h * p * turn) / points;
        s->r[h * 2 * n + n + i] -= s->rates[i] * sin(h * p * turn) / points;
      }
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

/* Harmonic h of y_k from its right-hand side; with h = 1 also c_(k-1). 0: resonance. */
static int solve_harmonic(Series *s, int k, int h, double rounding) {
  const double near = 0.1, equal = 1e-3;
  ModeAmplitude *a = s->out;
  double *y = harmonic(s, k, h), divisor;
  int with = 0, n = s->n, N = lag_series_equations(s, h, !h, h == 1 ? harmonic(s, 1, 1) : NULL, s->leads),
      count = lag_series_resonant(s, s->k, h, equal, &with, &divisor),
      forced = lag_largest(N, s->rhs) > rounding;
  if (lag_series_solve(s, N, h ? 2 * count : count, rounding)) {
    a->limit = AMPLITUDE_RESONANCE, a->with = with, a->times = h, a->divisor = divisor;
    return 0;
  }
  if (!count && forced && lag_series_resonant(s, s->k, h, near, &with, &divisor) && !(a->divisor <= divisor))
    a->with = with, a->times = h, a->divisor = divisor;
  for (int i = 0; i < (h ? 2 : 1) * n; i++) y[i] += s->rhs[i];
  if (h == 1) s->c[k - 1] = s->rhs[2 * n], s->c_im[k - 1] = s->rhs[2 * n + 1];
  return 1;
}

/* rhs := r[h] - sum of c_j i h Y_(k-j), j = 1 .. k - 2. */
static void right_side(Series *s, int k, int h) {
  const int n = s->n;
  for (int i = 0; i < n; i++) {
    double re = s->r[h * 2 * n + i], im = s->r[h * 2 * n + n + i];
    for (int j = 1; j <= k - 2; j++) {
      const double *y = harmonic(s, k - j, h);
      re += h * (s->c[j] * y[n + i] + s->c_im[j] * y[i]);
      im -= h * (s->c[j] * y[i] - s->c_im[j] * y[n + i]);
    }
    s->rhs[i] = re, s->rhs[n + i] = im;
  }
  if (h == 1) s->rhs[2 * n] = s->rhs[2 * n + 1] = 0;
}

/* y_k, of the last order only c. 1: found, 0: resonance, < 0: a status. */
static int solve_order(Series *s, int k, int points) {
  const double part = 1e-9, rounding = 64 * DBL_EPSILON;
  int rc = force(s, k, points), n = s->n;
  if (rc) return rc;
  double size = rounding * (1 + lag_largest(n * n, s->B)) + part * lag_largest(HARMONICS * 2 * n, s->r);
  for (int h = k % 2; h <= (k == ORDER ? 1 : k); h += 2) {
    right_side(s, k, h);
    if (!solve_harmonic(s, k, h, size)) return 0;
  }
  return 1;
}

/* y_1 := the mode with amplitude 1 of the leading unknown, refined by Newton's method. 0: no shape of its own. */
static int place_mode(Series *s) {
  const Mode *m = &s->modes->mode[s->k];
  const int n = s->n, nq = s->pb->nq, nz = s->pb->nz, lead = s->leads < nq ? s->leads : s->leads - nq;
  double *u = harmonic(s, 1, 1), unit = s->scale[s->leads];
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
    if (!solve_harmonic(s, 1, 1, HUGE_VAL)) return 0;
  }
  return 1;
}

/* (re, im)[ORDER] := the series exp(i h d(e)) of a series d with d[0] = 0. */
static void turned(int h, const double *d, double *re, double *im) {
  re[0] = 1, im[0] = 0;
  for (int k = 1; k < ORDER; k++) { /* f' = i h d' f */
    re[k] = im[k] = 0;
    for (int j = 1; j <= k; j++) re[k] -= h * j * d[j] * im[k - j] / k, im[k] += h * j * d[j] * re[k - j] / k;
  }
}

/* q[ORDER] := sum of e^(k - less) times the leading unknown of y_k at the phase d(e), or its slope by the phase. */
static void leading_value(const Series *s, const double *d, int slope, double *q) {
  double re[ORDER], im[ORDER];
  memset(q, 0, ORDER * sizeof *q);
  for (int h = 0; h < ORDER; h++) {
    turned(h, d, re, im);
    for (int k = 1; k < ORDER; k++) {
      const double *y = harmonic(s, k, h);
      double a = (h ? 2 : 1) * y[s->leads], b = (h ? 2 : 1) * y[s->n + s->leads];
      for (int j = 0; j + k < ORDER + slope && j < ORDER; j++)
        q[j + k - slope] += slope ? -h * (a * im[j] + b * re[j]) : a * re[j] - b * im[j];
    }
  }
}

/* Half the swing is e (1 + s2 e^2 + ...): returns s2. The lower turning value is the upper one for -e. */
static double swing(const Series *s) {
  double d[ORDER] = {0}, q[ORDER];
  for (int step = 1; step < ORDER; step++) { /* the slope is -d and higher orders */
    leading_value(s, d, 1, q);
    for (int k = 1; k < ORDER; k++) d[k] += q[k];
  }
  leading_value(s, d, 0, q);
  return q[3];
}

static double beyond(double rounding, double x) { return fabs(x) > rounding ? x : 0; }

/* Orders 2 to 5. LAG_OK or a status. */
static int expand(Series *s, int points) {
  const double part = 1e-9, rounding = 64 * DBL_EPSILON * (1 + lag_largest(s->n * s->n, s->B));
  ModeAmplitude *a = s->out;
  const double unit = s->scale[s->leads] * s->scale[s->leads];
  int rc = 1;
  a->a2 = a->a4 = NAN;
  for (int k = 2; k <= ORDER && rc == 1; k++) {
    rc = solve_order(s, k, points);
    if (k != 3 || rc != 1) continue;
    if (fabs(s->c_im[2]) > part * fabs(s->c[2]) + rounding) {
      a->limit = AMPLITUDE_GROWTH, a->growth = -s->c_im[2] * s->w / unit;
      return LAG_OK;
    }
    s->c_im[2] = 0;
    a->a2 = beyond(rounding, s->c[2]) / unit;
  }
  if (rc == 1) a->a4 = beyond(rounding, s->c[4] - 2 * swing(s) * s->c[2]) / (unit * unit);
  return rc < 0 ? rc : LAG_OK;
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
  *u = harmonic(s, 1, 1);
  return rc ? rc : !place_mode(s);
}

int lag_mode_oscillates(const Mode *m) {
  const double undamped = 1e-9;
  return m->im > 0 && fabs(m->re) <= undamped * m->im && m->repeats <= 1;
}

int lag_mode_amplitude(ModeAmplitude *a, const Modes *modes, int k, Equilibrium *rest) {
  *a = (ModeAmplitude){.a2 = NAN, .a4 = NAN, .divisor = NAN, .limit = AMPLITUDE_NO_OSCILLATION};
  if (!lag_mode_oscillates(&modes->mode[k])) return LAG_OK;
  Series s = {.out = a};
  double *u;
  int rc = lag_series_open(&s, modes, k, rest, &u);
  if (rc == LAG_OK) {
    ModeAmplitude other;
    a->limit = AMPLITUDE_WHOLE;
    a->leads = s.leads < s.pb->nq ? s.leads : s.leads - s.pb->nq;
    rc = expand(&s, 2 * ORDER + 2);
    other = *a;
    for (int order = 2; order <= ORDER; order++)
      memset(harmonic(&s, order, 0), 0, sizeof(double) * HARMONICS * 2 * (size_t)s.n);
    if (rc == LAG_OK) rc = expand(&s, 2 * ORDER + 5);
    a->error2 = fabs(a->a2 - other.a2), a->error4 = fabs(a->a4 - other.a4);
  }
  lag_pool_free(&s.pool);
  return rc == 1 ? LAG_OK : rc;
}
