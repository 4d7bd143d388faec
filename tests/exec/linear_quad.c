/* The emitted linearisation of every model of all_scenes against central differences of its emitted accelerations,
 * in quadruple precision, at random states: J = M^-1 dr. With h = 1e-12 a difference has an error of h^2 times the
 * third derivative, 1e-24, and of rounding, 1e-34/h = 1e-22 times the accelerations: 1e-15 relative to the largest
 * entry of its column leaves room for large third derivatives, 1e-19 times the acceleration for what cancels in it
 * (two atoms that nearly touch push with 1e30; a density of exp(177) has the rounding of 177), and neither for a
 * wrong sign. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>

#include "lag_model.h"

extern const lag_scene *const all_scenes[];

enum { MAX = 64, PARAMS = 512, STATES = 20 }; /* parameters with derived ones */

typedef LAG_REAL Real;
typedef struct {
  Real t, y[3 * MAX], p[PARAMS], u[MAX], w[8192];
} Point;

static uint64_t seed = 11;
static Real next(void) {
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return 1.5 * ((double)(seed >> 11) / 9007199254740992.0 - 0.5);
}

static Real size_of(Real x) { return x < 0 ? -x : x; }

static int rhs(const lag_model *m, Point *s, Real *f) {
  return m->accel(m, s->t, s->y, s->y + m->nq, s->y + 2 * m->nq, s->p, s->u, f, f + m->nq, s->w);
}

/* B[n * k] := M^-1 B by elimination with partial pivoting. */
static void solve(int n, int k, Real *M, Real *B) {
  for (int c = 0; c < n; c++) {
    int best = c;
    for (int i = c; i < n; i++)
      if (size_of(M[i * n + c]) > size_of(M[best * n + c])) best = i;
    for (int j = 0; j < n; j++) { Real x = M[c * n + j]; M[c * n + j] = M[best * n + j]; M[best * n + j] = x; }
    for (int j = 0; j < k; j++) { Real x = B[c * k + j]; B[c * k + j] = B[best * k + j]; B[best * k + j] = x; }
    for (int i = 0; i < n; i++) {
      if (i == c) continue;
      Real factor = M[i * n + c] / M[c * n + c];
      for (int j = 0; j < n; j++) M[i * n + j] -= factor * M[c * n + j];
      for (int j = 0; j < k; j++) B[i * k + j] -= factor * B[c * k + j];
    }
  }
  for (int c = 0; c < n; c++)
    for (int j = 0; j < k; j++) B[c * k + j] /= M[c * n + c];
}

static Real J[2 * MAX * 3 * MAX], M[MAX * MAX], dr[2 * MAX * 3 * MAX], mass[MAX * MAX];

static int jacobian(const lag_model *m, Point *s, const Real *f) {
  int n = 2 * m->nq + m->nz;
  const lag_linear *l = m->linear;
  int rc = l->eval(l, s->t, s->y, s->y + m->nq, s->y + 2 * m->nq, s->p, s->u, f, dr, mass, s->w);
  if (rc) return rc;
  for (int i = 0; i < (m->nq + m->nz) * n; i++) J[i] = 0;
  for (int i = 0; i < m->nq * m->nq; i++) M[i] = 0;
  for (int k = 0; k < l->ndr; k++) J[l->dr[k].row * n + l->dr[k].col] = dr[k];
  for (int k = 0; k < l->nmass; k++) {
    M[l->mass[k].row * m->nq + l->mass[k].col] = mass[k];
    M[l->mass[k].col * m->nq + l->mass[k].row] = mass[k];
  }
  solve(m->nq, n, M, J);
  return 0;
}

static int check_column(const lag_model *m, Point *s, const Real *f, int j) {
  enum { ROWS = 2 * MAX };
  const Real h = 1e-12;
  Real up[ROWS], down[ROWS], at = s->y[j], scale = 1;
  int n = 2 * m->nq + m->nz, rows = m->nq + m->nz;
  s->y[j] = at + h;
  if (rhs(m, s, up)) return 0;
  s->y[j] = at - h;
  if (rhs(m, s, down)) return 0;
  s->y[j] = at;
  for (int i = 0; i < rows; i++) {
    up[i] = (up[i] - down[i]) / (2 * h);
    if (size_of(up[i]) > scale) scale = size_of(up[i]);
  }
  for (int i = 0; i < rows; i++)
    if (!(size_of(up[i] - J[i * n + j]) <= 1e-15 * scale + 1e-19 * size_of(f[i]))) {
      printf("%s: J[%d][%d] = %.17g, by differences %.17g\n", m->name, i, j, (double)J[i * n + j], (double)up[i]);
      return 1;
    }
  return 0;
}

static int check_model(const lag_scene *scene) {
  static const unsigned char none[MAX];
  static Point s;
  const lag_model *m = scene->model;
  Real f[2 * MAX];
  int n = 2 * m->nq + m->nz, good = 0;
  if (m->constraints) return 0; /* multipliers would change, too: there is none */
  if (!m->linear) return printf("%s has no linearisation\n", m->name), 1;
  if (m->np + m->nderived > PARAMS) return printf("%s has too many parameters\n", m->name), 1;
  scene->params(scene, s.p, none);
  for (int trial = 0; trial < STATES; trial++) {
    s.t = next();
    for (int i = 0; i < n; i++) s.y[i] = next();
    for (int i = 0; i < m->nmodes; i++) s.u[m->nu + i] = 1e300; /* LAG_FREE: the state decides */
    if (m->inputs && m->inputs(m, s.t, s.p, s.u)) continue;
    if (rhs(m, &s, f) || jacobian(m, &s, f)) continue;
    int finite = 1;
    for (int i = 0; i < m->nq + m->nz; i++) finite &= f[i] - f[i] == 0;
    if (!finite) continue; /* outside of the model's domain */
    good++;
    for (int j = 0; j < n; j++)
      if (check_column(m, &s, f, j)) return 1;
  }
  return good < STATES / 4 ? printf("%s: only %d states inside its domain\n", m->name, good), 1 : 0;
}

int main(void) {
  int bad = 0;
  for (int i = 0; all_scenes[i]; i++) bad |= check_model(all_scenes[i]);
  return bad;
}
