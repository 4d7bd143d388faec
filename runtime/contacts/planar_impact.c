/* The impact of one contact with friction in a plane, along the growing normal impulse. Contract: planar_impact.h. */
#include "contacts/planar_impact.h"
#include "numeric/dense.h"

#include <float.h>
#include <math.h>


/* Friction per normal impulse at the slip velocity vt: on the edge of the cone, or what holds it. */
static double friction(const double *W, double vt, double mu) {
  double hold = -W[2] / W[3];
  if (vt != 0) return -mu * lag_sign(vt);
  return fabs(hold) <= mu ? hold : mu * lag_sign(hold);
}

/* The normal impulse after which a velocity v that changes by `slope` per impulse is 0; infinite: never. */
static double until_zero(double v, double slope) { return v * slope < 0 ? -v / slope : HUGE_VAL; }

/* The normal impulse that does the work `work` >= 0 from the velocity v >= 0. */
static double until_work(double v, double slope, double work) {
  double root = sqrt(fmax(v * v + 2 * slope * work, 0));
  return work > 0 ? 2 * work / (v + root) : 0;
}

/* The normal impulse until restitution ends, from the velocity v; owed: work, impulse, or the last velocity. */
static double until_end(int law, double v, double slope, double owed) {
  if (law == LAG_IMPACT_STRONGE) return until_work(v, slope, owed);
  return law == LAG_IMPACT_POISSON ? owed : slope > 0 ? fmax(owed - v, 0) / slope : HUGE_VAL;
}

static void by_impulse(const double *W, const double *v, int law, double mu, double e, double *P) {
  double vn = v[0], vt = v[1], stored = 0, owed = 0;
  P[0] = P[1] = 0;
  /* slip, stick or slip back, each in compression and restitution */
  for (int phase = 0, returns = 0; phase < 8; phase++) {
    double f = friction(W, vt, mu), up = W[0] + W[1] * f,
           along = vt == 0 && fabs(W[2] / W[3]) <= mu ? 0 : W[2] + W[3] * f;
    double stops = until_zero(vt, along), turns = returns ? until_end(law, vn, up, owed) : until_zero(vn, up),
           p = fmin(stops, turns);
    double work = vn * p + up * p * p / 2;
    P[0] += p;
    P[1] += f * p;
    vt = stops <= turns ? 0 : vt + along * p;
    vn = !returns && turns <= stops ? 0 : vn + up * p;
    if (returns) owed -= law == LAG_IMPACT_STRONGE ? work : law == LAG_IMPACT_POISSON ? p : 0;
    else stored -= work;
    if (turns > stops) continue;
    if (returns) return;
    returns = 1;
    owed = law == LAG_IMPACT_STRONGE ? e * e * stored : law == LAG_IMPACT_POISSON ? e * P[0] : -e * v[0];
  }
}

/* Whether both velocities follow from one, as of a body that other constraints guide, and friction holds it: then
 * compression ends in rest, and friction bears all that would push the body back. P := an impulse that stops it. */
static int jams(const double *W, const double *v, double mu, double *P) {
  const double same = 1e-9; /* rounding of the entries of W and v, with room */
  if (W[0] * W[3] - W[1] * W[2] > same * W[0] * W[3] || fabs(v[1] * W[0] - v[0] * W[2]) > same * fabs(v[0] * W[2]) ||
      fabs(W[2]) > mu * W[3])
    return 0;
  P[0] = -v[0] / W[0];
  P[1] = 0;
  return 1;
}

/* P on the edge of the cone, slipping to the side s, with the normal velocity -e v. */
static void on_the_edge(const double *W, const double *v, double mu, double e, double s, double *P) {
  P[0] = -(1 + e) * v[0] / (W[0] - s * mu * W[1]);
  P[1] = -s * mu * P[0];
}

static void by_velocities(const double *W, const double *v, double mu, double e, double back, double *P) {
  double n = -(1 + e) * v[0], t = -(1 + back) * v[1], det = W[0] * W[3] - W[1] * W[2];
  P[0] = (W[3] * n - W[1] * t) / det;
  P[1] = (W[0] * t - W[2] * n) / det;
  if (!(P[0] > 0 && fabs(P[1]) <= mu * P[0])) on_the_edge(W, v, mu, e, v[1] != 0 ? lag_sign(v[1]) : lag_sign(W[2]), P);
}

/* Kinetic energy that P brings in; 0 where it is rounding. */
static double energy_gain(const double *W, const double *v, const double *P) {
  double vn = v[0] + W[0] * P[0] + W[1] * P[1], vt = v[1] + W[2] * P[0] + W[3] * P[1];
  double gain = P[0] * (v[0] + vn) + P[1] * (v[1] + vt), size = fabs(P[0] * v[0]) + fabs(P[1] * v[1]);
  return gain > 64 * DBL_EPSILON * size ? gain / 2 : 0;
}

double lag_planar_impact(const double *W, const double *v, int law, double mu, double e, double back, double *P) {
  if (back > 0) by_velocities(W, v, mu, e, back, P);
  else if (!jams(W, v, mu, P)) by_impulse(W, v, law, mu, e, P);
  return P[0] > 0 ? energy_gain(W, v, P) : (double)NAN;
}
