/* The impact of one contact with friction in space, along the growing normal impulse. Contract: planar_impact.h. */
#include <math.h>

#include "contacts/planar_impact.h"

/* State along the impulse: normal velocity, slip, tangential impulse, work of the normal impulse. */
enum { VN, SX, SY, PX, PY, WORK, STATES };

typedef struct Flow {
  const double *W;
  double mu, still[2]; /* friction per normal impulse at rest: what holds it, or against the way that it takes */
  int rests;
} Flow;

static void slopes(const Flow *w, const double *x, double *d) {
  const double *W = w->W, slip = hypot(x[SX], x[SY]);
  double f[2];
  for (int k = 0; k < 2; k++) f[k] = w->rests || !(slip > 0) ? w->still[k] : -w->mu * x[SX + k] / slip;
  d[VN] = W[0] + W[1] * f[0] + W[2] * f[1];
  d[SX] = W[3] + W[4] * f[0] + W[5] * f[1];
  d[SY] = W[6] + W[7] * f[0] + W[8] * f[1];
  d[PX] = f[0];
  d[PY] = f[1];
  d[WORK] = x[VN];
}

/* to := x after the normal impulse p, by a step of Runge and Kutta. */
static void advance(const Flow *w, const double *x, double p, double *to) {
  double k[4][STATES], y[STATES];
  for (int stage = 0; stage < 4; stage++) {
    double part = stage == 0 ? 0 : stage == 3 ? p : p / 2;
    for (int i = 0; i < STATES; i++) y[i] = x[i] + (stage ? part * k[stage - 1][i] : 0);
    slopes(w, y, k[stage]);
  }
  for (int i = 0; i < STATES; i++) to[i] = x[i] + p / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
}

/* Friction at rest: holds the slip if it can, else acts against the way in which the contact begins to slip. */
static void find_still(Flow *w) {
  enum { ROUNDS = 2000 };
  const double *W = w->W, det = W[4] * W[8] - W[5] * W[7], by = w->mu * (W[4] + W[8]);
  double x = -(W[8] * W[3] - W[5] * W[6]) / det, y = -(W[4] * W[6] - W[7] * W[3]) / det, size = hypot(x, y);
  w->still[0] = x;
  w->still[1] = y;
  w->rests = size <= w->mu;
  if (w->rests) return;
  double way[2] = {-x / size, -y / size};
  for (int round = 0; round < ROUNDS; round++) {
    double a = W[3] - w->mu * (W[4] * way[0] + W[5] * way[1]) + by * way[0],
           b = W[6] - w->mu * (W[7] * way[0] + W[8] * way[1]) + by * way[1];
    way[0] = a / hypot(a, b);
    way[1] = b / hypot(a, b);
  }
  for (int k = 0; k < 2; k++) w->still[k] = -w->mu * way[k];
}

/* Rest of the phase, > 0 until it ends. owed: work, impulse or velocity of restitution; p: impulse of it. */
static double left(int returns, int law, double owed, const double *x, double p) {
  if (!returns) return -x[VN];
  return law == LAG_IMPACT_STRONGE ? owed - x[WORK] : law == LAG_IMPACT_POISSON ? owed - p : owed - x[VN];
}

/* A step p of the flow, shorter where the phase ends in it. Returns whether it does; *p := its impulse. */
static int step_to_end(const Flow *w, int returns, int law, double owed, double done, const double *x, double *p,
                       double *to) {
  double low = 0, high = *p;
  advance(w, x, high, to);
  if (left(returns, law, owed, to, done + high) > 0) return 0;
  for (int k = 0; k < 100; k++) {
    double mid = (low + high) / 2;
    advance(w, x, mid, to);
    if (left(returns, law, owed, to, done + mid) > 0) low = mid;
    else high = mid;
  }
  *p = high;
  advance(w, x, high, to);
  return 1;
}

static int follow(const double *W, const double *v, int law, double mu, double e, double *P) {
  enum { STEPS = 20000 };
  const double part = 1.0 / 256, whole = -v[0] / W[0], none = 1e-13 * hypot(hypot(v[1], v[2]), v[0]);
  Flow w = {W, mu, {0, 0}, 0};
  double x[STATES] = {v[0], v[1], v[2]}, to[STATES], d[STATES], owed = 0, p = 0, done = 0;
  find_still(&w);
  int holds = w.rests, returns = 0;
  for (int step = 0; step < STEPS; step++) {
    double slip = hypot(x[SX], x[SY]);
    w.rests = slip <= none;
    if (w.rests && holds) x[SX] = x[SY] = 0;
    slopes(&w, x, d);
    double by = part * (slip > none ? fmin(slip / hypot(d[SX], d[SY]), whole) : whole);
    int ends = step_to_end(&w, returns, law, owed, done, x, &by, to);
    p += by;
    done += by;
    for (int i = 0; i < STATES; i++) x[i] = to[i];
    if (ends && returns) {
      P[0] = p;
      P[1] = x[PX];
      P[2] = x[PY];
      return 1;
    }
    if (!ends) continue;
    owed = law == LAG_IMPACT_STRONGE ? -e * e * x[WORK] : law == LAG_IMPACT_POISSON ? e * p : -e * v[0];
    x[VN] = x[WORK] = done = 0;
    returns = 1;
    if (!(owed > 0)) return P[0] = p, P[1] = x[PX], P[2] = x[PY], 1;
  }
  return 0;
}

/* Kinetic energy that P brings in; 0 where it is rounding, and error of the integration. */
static double energy_gain(const double *W, const double *v, const double *P) {
  double gain = 0, size = 0;
  for (int i = 0; i < 3; i++) {
    double u = v[i];
    for (int k = 0; k < 3; k++) u += W[3 * i + k] * P[k];
    gain += P[i] * (v[i] + u);
    size += fabs(P[i] * v[i]);
  }
  return gain > 1e-8 * size ? gain / 2 : 0;
}

/* Whether the slip stays in its direction e, in which the impact is that of a plane, of U[4], u[2]. */
static int is_planar(const double *W, const double *v, const double *e, double *U, double *u) {
  const double same = 1e-12;
  double out[2] = {-e[1], e[0]}, size = W[0] + W[4] + W[8], tn = 0, ote = 0, otn = 0, ete = 0;
  for (int k = 0; k < 2; k++) {
    tn += e[k] * W[3 * (1 + k)];
    otn += out[k] * W[3 * (1 + k)];
    for (int j = 0; j < 2; j++) {
      ete += e[k] * W[3 * (1 + k) + 1 + j] * e[j];
      ote += out[k] * W[3 * (1 + k) + 1 + j] * e[j];
    }
  }
  U[0] = W[0];
  U[1] = U[2] = fabs(tn) > same * size ? tn : 0;
  U[3] = ete;
  u[0] = v[0];
  u[1] = v[1] * e[0] + v[2] * e[1];
  return fabs(otn) <= same * size && fabs(ote) <= same * size;
}

double lag_space_impact(const double *W, const double *v, int law, double mu, double e, double back, double *P) {
  double slip = hypot(v[1], v[2]), turn = hypot(W[3], W[6]), way[2] = {1, 0}, U[4], u[2], Q[2];
  for (int k = 0; k < 2; k++) way[k] = slip > 0 ? v[1 + k] / slip : turn > 0 ? W[3 * (1 + k)] / turn : way[k];
  if (is_planar(W, v, way, U, u)) {
    double gain = lag_planar_impact(U, u, law, mu, e, back, Q);
    P[0] = Q[0];
    for (int k = 0; k < 2; k++) P[1 + k] = Q[1] * way[k];
    return gain;
  }
  return !(back > 0) && follow(W, v, law, mu, e, P) ? energy_gain(W, v, P) : (double)NAN;
}
