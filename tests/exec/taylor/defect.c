/* The Taylor polynomials of models against their accelerations, in quadruple precision: y'(s) of the polynomial of
 * order n less f(y(s)) must fall as s^n, at states at random near the scenes' starts. A coefficient that is wrong by
 * a part d adds a term of lower order, which shows as soon as it is larger than the next term: at the smallest s, d
 * of about 1e-20.
 *   defect      prints what is wrong, and the models without series; linked with all_scenes */
#include <math.h>
#include <stdint.h>
#include <string.h>

#include "real.h"

extern const lag_scene *const all_scenes[];

enum { MOST = 1024, ORDER = 9, STATES = 3 };

typedef struct {
  Real t, q[MOST], v[MOST], z[MOST], p[MOST], u[MOST], follows[MOST];
} Point;

static uint64_t seed = 5;
static Real next(void) { /* in (-1/8, 1/8) */
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return (Real)((double)(seed >> 11) / 9007199254740992.0 - 0.5) / 4;
}

/* Near the start, by an eighth of what it is at most; what is zero is moved by an eighth of a declared unit. Time by
 * an eighth of a second, or of the span where that is shorter: the phase of a fast field would have no digits after
 * a second. */
static void place(const lag_scene *s, Point *at) {
  const lag_model *m = s->model;
  static const unsigned char none[MOST];
  if (m->np + m->nderived > MOST) exit(1);
  s->params(s, at->p, none);
  s->start(s, at->p, at->q, at->v, at->z);
  at->t = (Real)s->t0 + next() * (fabs(s->t1 - s->t0) < 1 ? (Real)fabs(s->t1 - s->t0) : 1);
  for (int i = 0; i < m->nq; i++) {
    Real unit = at->q[i] == 0 ? (Real)m->q[i].factor : at->q[i],
         unit_v = at->v[i] == 0 ? (Real)m->q[i].factor : at->v[i];
    at->q[i] += next() * unit;
    at->v[i] += next() * unit_v;
  }
  for (int i = 0; i < m->nz; i++) at->z[i] += next() * (at->z[i] == 0 ? (Real)m->z[i].factor : at->z[i]);
  for (int i = 0; i < m->nu; i++) at->follows[i] = 1;
  if (m->inputs) m->inputs(m, at->t, at->p, at->u);
}

/* The largest k |x[k]| of the components from i to j. */
static Real size_of(const Real *x, int columns, int i, int j) {
  Real size = 0;
  for (int k = 1; k <= ORDER; k++)
    for (int c = i; c < j; c++) size = real_max(size, k * real_abs(x[k * columns + c]));
  return size;
}

/* The largest |T y'(s) - T f(y(s))| over the size of the motion: of all velocities, and of all states. */
static Real defect_at(const lag_model *m, const Point *at, const Real *x, Real T, Real s, Real *w) {
  const lag_taylor *ty = m->taylor;
  int nv = 2 * m->nq, n = nv + m->nz;
  static Real y[3 * MOST], dy[3 * MOST], rates[2 * MOST], u[MOST];
  Real of_v = size_of(x, ty->columns, m->nq, nv), of_z = size_of(x, ty->columns, nv, n), worst = 0;
  ty->at(ty, ORDER, s, x, y, dy);
  for (int i = 0; i < n; i++) y[i] += x[i];
  if (m->inputs) m->inputs(m, at->t + s * T, at->p, u);
  if (m->accel(m, at->t + s * T, y, y + m->nq, y + 2 * m->nq, at->p, u, rates, rates + m->nq, w) != LAG_OK)
    return (Real)NAN;
  for (int i = m->nq; i < n; i++) {
    Real size = i < nv ? of_v : of_z;
    if (size > 0) worst = real_max(worst, real_abs(dy[i] - T * rates[i - m->nq]) / size);
  }
  return worst;
}

static int check_state(const lag_scene *s, Real *x, Real *w) {
  const lag_model *m = s->model;
  Point at = {0};
  Real T = 1, before = 0;
  place(s, &at);
  if (m->taylor->first(m->taylor, at.t, at.q, at.v, at.z, at.p, at.u, at.follows, x, w) != LAG_OK)
    return printf("%s: order 0 failed\n", m->name), 1;
  for (int i = 0; i < 2 * m->nq + m->nz; i++) { /* a tenth of the time in which the state changes */
    Real y = i < m->nq       ? at.q[i]
             : i < 2 * m->nq ? at.v[i - m->nq]
                             : at.z[i - 2 * m->nq],
         rate = i < m->nq ? at.v[i] : x[m->nq + m->nz + i];
    if (real_abs(rate) * T > real_abs(y) / 10 && y != 0) T = real_abs(y / rate) / 10;
  }
  m->taylor->rest(m->taylor, ORDER, T, x, w);
  for (int i = 1; i <= 8; i++) { /* halves of s */
    Real d = defect_at(m, &at, x, T, (Real)1 / (Real)(1 << i), w), rounding = (Real)(1000 * REAL_EPSILON);
    if (i == 8 && d < rounding) return 0; /* a polynomial, or of higher order */
    if (i > 4 && before > 1e3L * rounding && !(d < before / (Real)(1 << (ORDER - 1)) / (Real)1.7L))
      return printf("%s: defect %.3Lg at s = 1/%d after %.3Lg: not of order %d\n", m->name, (long double)d, 1 << i,
                    (long double)before, ORDER),
             1;
    before = d;
  }
  return 0;
}

int main(void) {
  int wrong = 0;
  for (int i = 0; all_scenes[i]; i++) {
    const lag_model *m = all_scenes[i]->model;
    const lag_taylor *ty = m->taylor;
    if (!ty) {
      printf("without: %s\n", m->name);
      continue;
    }
    Real *x = calloc((size_t)((ty->order + 1) * ty->columns), sizeof *x),
         *w = calloc((size_t)(ty->nw + m->nw + 1), sizeof *w);
    for (int k = 0; k < STATES; k++) wrong |= check_state(all_scenes[i], x, w);
    free(x);
    free(w);
  }
  return wrong;
}
