/* Interpolant within a step of q'' = f(t, q, q'). Enters: states and accelerations at both ends; leaves: polynomials
 * of q and v. Holds: v has error O(h^(m+4)) and q O(h^(m+6)) with m accelerations inside the step, if these are as
 * accurate. Where f depends on velocities the accelerations have the error of v, one order less, and a second pass
 * recovers it.
 *
 * Construction: a(x) interpolates the accelerations at equal distances, x = 0..M, M = m + 1; with W = x (x-1) ...
 * (x-M), zero at these x, v = v0 + int (a + alpha W) meets v1, and q = q0 + v0 t + iint (a + alpha W + beta (x -
 * M/2) W) meets q1. For m = 0 this is lag_hermite, of order 4. Its q gives the accelerations inside for m = 2 (order
 * 6), that path those for m = 4 (order 8): "bootstrapping", W.H. Enright, K.R. Jackson, S.P. Norsett, P.G. Thomsen,
 * ACM Trans. Math. Softw. 12 (1986) 193, DOI 10.1145/7921.7923. As in lag_hermite beta stays out of v: it would
 * magnify errors of q by 1/h. */
#include "methods/step_interpolant.h"

#include <string.h>

enum { MAX_INTERVALS = 5, NV = MAX_INTERVALS + 2, NQ = MAX_INTERVALS + 3 };

static int intervals(int level) { return 2 * level + 1; }

/* A path: accelerations at x = 0..MAX_INTERVALS, coefficients of the accelerations of v and of q, a stage and its f. */
size_t lag_interpolant_size(int nq) { return (size_t)nq * (MAX_INTERVALS + 1 + NV + NQ + 4); }

/* p := p (x - r); the degree rises from n to n + 1. */
static void times_root(double *p, int n, double r) {
  p[n + 1] = p[n];
  for (int k = n; k > 0; k--) p[k] = p[k - 1] - r * p[k];
  p[0] *= -r;
}

/* int_0^x p, for p of degree n. */
static double integral(const double *p, int n, double x) {
  double s = 0;
  for (int k = n; k >= 0; k--) s = s * x + p[k] / (k + 1);
  return s * x;
}

/* int_0^x int_0^x p. */
static double integral2(const double *p, int n, double x) {
  double s = 0;
  for (int k = n; k >= 0; k--) s = s * x + p[k] / ((k + 1) * (k + 2));
  return s * x * x;
}

/* p := the polynomial of degree m that has the values a[k stride] at x = k, by Newton's forward differences. */
static void interpolate(const double *a, int stride, int m, double *p) {
  double d[MAX_INTERVALS + 1];
  for (int k = 0; k <= m; k++) d[k] = a[k * stride];
  for (int j = 1; j <= m; j++)
    for (int k = m; k >= j; k--) d[k] = (d[k] - d[k - 1]) / j;
  p[0] = d[m];
  for (int k = m - 1, n = 0; k >= 0; k--, n++) {
    times_root(p, n, k);
    p[0] += d[k];
  }
}

/* Computes the coefficients of both polynomials from the accelerations in path. */
static void fit(double *path, int nq, const StepEnds *e, int m) {
  double w[NV + 1] = {1}, w2[NQ + 1], g = e->h / m;
  for (int k = 0; k <= m; k++) times_root(w, k, k);
  memcpy(w2, w, sizeof w);
  times_root(w2, m + 1, 0.5 * m);
  double wi = integral(w, m + 1, m), w2i = integral2(w2, m + 2, m);
  for (int i = 0; i < nq; i++) {
    double *cv = path + (MAX_INTERVALS + 1) * nq + i * NV, *cq = path + (MAX_INTERVALS + 1 + NV) * nq + i * NQ;
    double q0 = e->y0[i], v0 = e->y0[nq + i];
    interpolate(path + i, nq, m, cv);
    double alpha = ((e->y1[nq + i] - v0) / g - integral(cv, m, m)) / wi;
    cv[m + 1] = 0;
    for (int k = 0; k <= m + 1; k++) cv[k] += alpha * w[k];
    double beta = ((e->y1[i] - q0 - e->h * v0) / (g * g) - integral2(cv, m + 1, m)) / w2i;
    for (int k = 0; k <= m + 2; k++) cq[k] = (k <= m + 1 ? cv[k] : 0) + beta * w2[k];
  }
}

void lag_interpolant_at(const double *path, const lag_problem *pb, const StepEnds *e, int level, double s, double *y) {
  int nq = pb->nq, m = intervals(level);
  double g = e->h / m, x = s * m;
  if (level == 0) {
    lag_hermite(nq, 0, e->h, s, e->y0, e->f0, e->y1, e->f1, y);
    return;
  }
  for (int i = 0; i < nq; i++) {
    const double *cv = path + (MAX_INTERVALS + 1) * nq + i * NV, *cq = path + (MAX_INTERVALS + 1 + NV) * nq + i * NQ;
    y[i] = e->y0[i] + (s * e->h * e->y0[nq + i] + g * g * integral2(cq, m + 2, x));
    y[nq + i] = e->y0[nq + i] + g * integral(cv, m + 1, x);
  }
}

/* Evaluates the accelerations of level l along the interpolant of level `from`, and fits the polynomials. */
static int refine(double *path, lag_problem *pb, const StepEnds *e, int l, int from) {
  int nq = pb->nq, m = intervals(l);
  size_t bytes = (size_t)nq * sizeof(double);
  double *ys = path + (MAX_INTERVALS + 1 + NV + NQ) * nq, *fs = ys + 2 * nq;
  memcpy(path, e->f0 + nq, bytes);
  for (int k = 1; k < m; k++) {
    double s = (double)k / m;
    lag_interpolant_at(path, pb, e, from, s, ys);
    int rc = lag_rhs(pb, e->t0 + s * e->h, ys, fs);
    if (rc || lag_not_finite(nq, fs + nq) >= 0) return LAG_ENAN;
    memcpy(path + k * nq, fs + nq, bytes);
  }
  memcpy(path + m * nq, e->f1 + nq, bytes);
  fit(path, nq, e, m);
  return LAG_OK;
}

int lag_interpolant_make(double *path, lag_problem *pb, const StepEnds *e, int level, int passes) {
  for (int l = 1; l <= level; l++)
    for (int pass = 0; pass < passes; pass++) {
      int rc = refine(path, pb, e, l, pass ? l : l - 1);
      if (rc) return rc;
    }
  return LAG_OK;
}

void lag_interpolant_cubic(int nq, const StepEnds *e, double s, double *y) {
  double h = e->h, r = 1 - s;
  for (int i = 0; i < nq; i++) {
    double d = e->y1[i] - e->y0[i], a = h * e->y0[nq + i] - d, b = d - h * e->y1[nq + i];
    y[i] = e->y0[i] + s * (d + r * (r * a + s * b));
    y[nq + i] = (d + r * (1 - 3 * s) * a + s * (2 - 3 * s) * b) / h;
  }
}
