/* Frequency over amplitude (mode_amplitude.h): the family of periodic motions as a power series in its amplitude e,
 *
 *     y(phi) = y0 + e y_1(phi) + e^2 y_2(phi) + ...,   phi' = w (1 + c_1 e + c_2 e^2 + ...),
 *
 * by A. Lindstedt's and H. Poincare's method. Coefficients of y' along such a curve are those of the model's Taylor
 * recurrences, exact but for rounding, at some phases; their harmonics h give linear equations
 * (i h - B) Y = R for those of y_k, with B the linearised model, and for h = 1 one more unknown, c_(k-1). y_k has
 * harmonics of the parity of k, up to k. In units of 1/w and of each unknown. */
#include "analysis/mode_amplitude.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "analysis/mode_series.h"
#include "numeric/dense.h"

enum { ORDER = SERIES_ORDER, HARMONICS = SERIES_HARMONICS };

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
          const double *y = lag_series_harmonic(s, j, h);
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

/* Harmonic h of y_k from its right-hand side; with h = 1 also c_(k-1). 0: resonance. */
static int solve_harmonic(Series *s, int k, int h, double rounding) {
  const double near = 0.1, equal = 1e-3;
  ModeAmplitude *a = s->out;
  double *y = lag_series_harmonic(s, k, h), divisor;
  int with = 0, n = s->n, N = lag_series_equations(s, h, !h, h == 1 ? lag_series_harmonic(s, 1, 1) : NULL, s->leads),
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
      const double *y = lag_series_harmonic(s, k - j, h);
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
      const double *y = lag_series_harmonic(s, k, h);
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
      memset(lag_series_harmonic(&s, order, 0), 0, sizeof(double) * HARMONICS * 2 * (size_t)s.n);
    if (rc == LAG_OK) rc = expand(&s, 2 * ORDER + 5);
    a->error2 = fabs(a->a2 - other.a2), a->error4 = fabs(a->a4 - other.a4);
  }
  lag_pool_free(&s.pool);
  return rc == 1 ? LAG_OK : rc;
}
