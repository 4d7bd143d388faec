/* Frequencies over the amplitudes of other modes (mode_coupling.h): Lindstedt's series in two phases,
 *
 *     y(p, q) = y0 + e (y_a(p) + y_b(q)) + e^2 y_2(p, q) + ...,   p' = w_a (1 + e^2 (c_aa + c_ab)), q' likewise,
 *
 * by the method of mode_amplitude.c: harmonics exp(i (k p + l q)) of the rates give those of y_2, and at the third
 * order, for (1, 0) and (0, 1), the shifts. c_aa is known from the series of the mode alone. */
#include "analysis/mode_coupling.h"

#include <float.h>
#include <math.h>
#include <string.h>

#include "analysis/mode_series.h"
#include "numeric/dense.h"

enum { SECOND = 5, THIRD = 8 };

static const int second[SECOND][2] = {{0, 0}, {2, 0}, {0, 2}, {1, 1}, {-1, 1}};
static const int third[THIRD][2] = {{1, 0}, {0, 1}, {3, 0}, {0, 3}, {2, 1}, {2, -1}, {1, 2}, {-1, 2}};

typedef struct Pair {
  Series *s; /* of mode a */
  int a, b;  /* modes */
  double w[2];          /* frequencies over that of a */
  const double *u[2];   /* shapes, 2 n each, in units of s */
  int leads[2];         /* leading unknowns in the state */
  double own[2], c[2], c_im[2]; /* shifts by the mode's own amplitude; by both */
  double *y, *r;        /* [SECOND][2 n], [THIRD][2 n] */
  ModeCoupling *out;    /* resonances */
} Pair;

/* ---- Harmonics */

/* to[n] += `times` the real part of Y exp(i phase). */
static void add_wave(int n, double times, const double *Y, double phase, double *to) {
  double re = times * cos(phase), im = times * sin(phase);
  for (int i = 0; i < n; i++) to[i] += re * Y[i] - im * Y[n + i];
}

/* The curve at phases p, q, to the order given. */
static void set_curve(Pair *w, int order, double p, double q) {
  Series *s = w->s;
  memset(s->curve, 0, sizeof(double) * (SERIES_ORDER + 1) * (size_t)s->n);
  add_wave(s->n, 2, w->u[0], p, s->curve + s->n);
  add_wave(s->n, 2, w->u[1], q, s->curve + s->n);
  for (int k = 0; k < SECOND && order > 1; k++)
    add_wave(s->n, k ? 2 : 1, w->y + k * 2 * s->n, second[k][0] * p + second[k][1] * q, s->curve + 2 * s->n);
}

/* w->r := harmonics of the rates of that order, from points^2 phases. LAG_OK or a status. */
static int force(Pair *w, int order, const int (*harmonic)[2], int count, int points) {
  const double turn = 2 * acos(-1) / points, part = 1.0 / (points * points);
  Series *s = w->s;
  int n = s->n, rc = LAG_OK;
  memset(w->r, 0, sizeof(double) * THIRD * 2 * (size_t)n);
  for (int k = 0; k < points * points && rc == LAG_OK; k++) {
    double p = k / points * turn, q = k % points * turn;
    set_curve(w, order - 1, p, q);
    rc = lag_series_rates(s, order);
    for (int h = 0; h < count && rc == LAG_OK; h++) {
      double phase = harmonic[h][0] * p + harmonic[h][1] * q, *r = w->r + h * 2 * n;
      for (int i = 0; i < n; i++) {
        r[i] += part * s->rates[i] * cos(phase);
        r[n + i] -= part * s->rates[i] * sin(phase);
      }
    }
  }
  return rc;
}

/* s->rhs := the part of y with right-hand side r and harmonic h; along: the mode whose shift is found, or -1.
 * 0: resonance. */
static int solve(Pair *w, const int *h, const double *r, int along, double rounding) {
  const double near = 0.1, equal = 1e-3;
  Series *s = w->s;
  int n = s->n, real = !h[0] && !h[1], with = 0, own = along < 0 ? -1 : along ? w->b : w->a;
  double frequency = h[0] * w->w[0] + h[1] * w->w[1], divisor;
  int N = lag_series_equations(s, frequency, real, along < 0 ? NULL : w->u[along], along < 0 ? 0 : w->leads[along]),
      count = lag_series_resonant(s, own, frequency, equal, &with, &divisor), all = real ? n : 2 * n,
      forced = lag_largest(all, r) > rounding;
  memset(s->rhs, 0, (size_t)N * sizeof *s->rhs);
  memcpy(s->rhs, r, (size_t)all * sizeof *r);
  ModeCoupling found = {.with = with, .times = {h[0], h[1]}, .divisor = divisor, .limit = AMPLITUDE_RESONANCE};
  if (lag_series_solve(s, N, real ? count : 2 * count, rounding)) return *w->out = found, 0;
  if (count || !forced || !lag_series_resonant(s, own, frequency, near, &found.with, &found.divisor)) return 1;
  found.limit = AMPLITUDE_WHOLE;
  if (!(w->out->divisor <= found.divisor)) *w->out = found;
  return 1;
}

/* ---- A pair */

/* c and c_im of both modes. 1: found, 0: resonance, < 0: a status. */
static int expand(Pair *w, int points) {
  const double part = 1e-9, noise = 64 * DBL_EPSILON * (1 + lag_largest(w->s->n * w->s->n, w->s->B));
  const int n = w->s->n;
  int rc = force(w, 2, second, SECOND, points);
  double rounding = noise + part * lag_largest(SECOND * 2 * n, w->r);
  memset(w->y, 0, sizeof(double) * SECOND * 2 * (size_t)n);
  for (int k = 0; k < SECOND && rc == LAG_OK; k++) {
    if (!solve(w, second[k], w->r + k * 2 * n, -1, rounding)) return 0;
    memcpy(w->y + k * 2 * n, w->s->rhs, sizeof(double) * (size_t)(k ? 2 * n : n));
  }
  rc = rc ? rc : force(w, 3, third, THIRD, points);
  rounding = noise + part * lag_largest(THIRD * 2 * n, w->r);
  for (int k = 0; k < THIRD && rc == LAG_OK; k++) {
    if (!solve(w, third[k], w->r + k * 2 * n, k < 2 ? k : -1, rounding)) return 0;
    if (k < 2) w->c[k] = w->s->rhs[2 * n] / w->w[k], w->c_im[k] = w->s->rhs[2 * n + 1] / w->w[k];
  }
  return rc ? rc : 1;
}

/* Both shifts of the pair, of mode a by b and of b by a. LAG_OK or a status. */
static int couple(Pair *w, ModeCoupling *ab, ModeCoupling *ba) {
  enum { FEW = 7, MORE = 9 }; /* harmonics up to 3 */
  const double part = 1e-9, noise = 64 * DBL_EPSILON * (1 + lag_largest(w->s->n * w->s->n, w->s->B));
  ModeCoupling near = {.shift = NAN, .error = NAN, .divisor = NAN}, *to[] = {ab, ba};
  double first[2];
  w->out = &near;
  int rc = expand(w, FEW);
  first[0] = w->c[0], first[1] = w->c[1];
  rc = rc == 1 ? expand(w, MORE) : rc;
  near.shift = near.error = NAN;
  *ab = *ba = near;
  for (int k = 0; k < 2 && rc == 1; k++) {
    double unit = w->s->scale[w->leads[1 - k]];
    if (fabs(w->c_im[k]) > part * (1 + fabs(w->c[k]))) {
      to[k]->limit = AMPLITUDE_GROWTH;
      continue;
    }
    double shift = w->c[k] - w->own[k];
    to[k]->shift = fabs(shift) > noise ? shift / (unit * unit) : 0;
    to[k]->error = fabs(w->c[k] - first[k]) / (unit * unit);
  }
  return rc < 0 ? rc : LAG_OK;
}

/* ---- Actions */

/* Energy of a motion along the mode with amplitude A, over w A^2: v M v/2 - x M (da/dx) x/2 over the mean of a
 * period. shape: SI. */
static int action_of(const Series *s, Equilibrium *rest, const double *shape, double *action) {
  const int n = s->n, nq = s->pb->nq, rows = rest->n;
  Pool pool = {0};
  double *dr = lag_pool_doubles(&pool, (size_t)(rows * n + nq * nq)), *M = dr ? dr + rows * n : NULL,
         unit = s->scale[s->leads];
  *action = NAN;
  if (!dr) return LAG_ENOMEM;
  int rc = lag_linearise(s->pb, s->t, s->rest, NULL, dr, M, rest->work);
  double sum = 0; /* M a' = dr: forces by coordinates */
  for (int e = 0; e < nq * nq && rc == LAG_OK; e++) {
    int i = e / nq, j = e % nq;
    const double *x = shape, *v = shape + nq;
    sum += M[e] * (v[i] * v[j] + v[n + i] * v[n + j]) - dr[i * n + j] * (x[i] * x[j] + x[n + i] * x[n + j]);
  }
  if (rc == LAG_OK) *action = sum / (s->w * unit * unit);
  lag_pool_free(&pool);
  return rc;
}

/* ---- All pairs */

/* Shapes of all modes of c in SI, their leading unknowns, and actions. */
static int find_shapes(Couplings *c, const Modes *modes, Equilibrium *rest, double *shapes, int *leads) {
  int rc = LAG_OK, n = rest->sim->pb.n;
  for (int k = 0; k < c->n && rc == LAG_OK; k++) {
    ModeAmplitude unused;
    Series s = {.out = &unused};
    double *u, *shape = shapes + k * 2 * n;
    c->action[k] = NAN;
    rc = lag_series_open(&s, modes, c->mode[k], rest, &u);
    for (int i = 0; i < 2 * n && rc == LAG_OK; i++) shape[i] = u[i] * s.scale[i % n];
    leads[k] = s.leads;
    if (rc == LAG_OK && modes->conserves && !s.pb->nz) rc = action_of(&s, rest, shape, &c->action[k]);
    lag_pool_free(&s.pool);
  }
  return rc;
}

/* Row k of the pairs from column k + 1, and that column. */
static int couple_with(Couplings *c, int k, Series *s, const double *shapes, const int *leads,
                       const ModeAmplitude *bends) {
  int n = s->n, rc = LAG_OK;
  const size_t size = 2 * (size_t)n;
  double *u = lag_pool_doubles(&s->pool, 2 * size), *y = lag_pool_doubles(&s->pool, (SECOND + THIRD) * size);
  if (s->pool.failed) return LAG_ENOMEM;
  for (int l = k + 1; l < c->n && rc == LAG_OK; l++) {
    int pair[] = {k, l};
    Pair w = {.s = s, .a = c->mode[k], .b = c->mode[l], .u = {u, u + size}, .y = y, .r = y + SECOND * size};
    for (int i = 0; i < 2; i++) {
      int mode = c->mode[pair[i]];
      double ratio = s->modes->mode[mode].im / s->w, unit = s->scale[leads[pair[i]]];
      w.w[i] = ratio, w.leads[i] = leads[pair[i]];
      for (int j = 0; j < 2 * n; j++) u[i * (int)size + j] = shapes[pair[i] * 2 * n + j] / s->scale[j % n];
      w.own[i] = bends[mode].a2 * unit * unit;
    }
    rc = couple(&w, &c->pair[k][l], &c->pair[l][k]);
  }
  return rc;
}

int lag_mode_couplings(Couplings *c, const Modes *modes, const ModeAmplitude *bends, Equilibrium *rest) {
  Pool pool = {0};
  const size_t n = (size_t)rest->sim->pb.n;
  double *shapes = lag_pool_doubles(&pool, COUPLING_MOST * 2 * n);
  int leads[COUPLING_MOST], rc = pool.failed ? LAG_ENOMEM : LAG_OK;
  *c = (Couplings){0};
  for (int k = 0; k < modes->n && c->n < COUPLING_MOST; k++)
    if (bends[k].limit != AMPLITUDE_NO_OSCILLATION && lag_mode_oscillates(&modes->mode[k])) c->mode[c->n++] = k;
  rc = rc ? rc : find_shapes(c, modes, rest, shapes, leads);
  for (int k = 0; k < c->n && rc == LAG_OK; k++) {
    ModeAmplitude unused;
    Series s = {.out = &unused};
    double *u;
    rc = lag_series_open(&s, modes, c->mode[k], rest, &u);
    rc = rc ? rc : couple_with(c, k, &s, shapes, leads, bends);
    c->pair[k][k] = (ModeCoupling){.shift = bends[c->mode[k]].a2, .error = bends[c->mode[k]].error2,
                                   .limit = bends[c->mode[k]].limit, .divisor = NAN};
    lag_pool_free(&s.pool);
  }
  lag_pool_free(&pool);
  return rc;
}
