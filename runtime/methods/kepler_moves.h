/* Text of kepler_lanes.h for one width of lanes, by kernels/kepler.h: included by kepler_lanes_1.c and so on alone. */
#pragma once

#if defined(__GNUC__) && !defined(__clang__) && defined(__OPTIMIZE__)
#pragma GCC optimize("O3") /* loops over vectors unrolled: a twentieth of the time */
#endif
#include "kernels/kepler.h"
#include "methods/kepler_lanes.h"

#ifdef LAG_LANES
enum { KEPLER_LANES = LAG_LANES };
typedef double KeplerNear __attribute__((vector_size(8 * LAG_LANES), aligned(8), may_alias));
#define KEPLER_AT(x) (*(KeplerNear *)(x))
#define KEPLER_LANE(x, k) (x)[k]
#define KEPLER_BITS(c) lag_lanes_bits(c)
#else
enum { KEPLER_LANES = 1 };
#define KEPLER_AT(x) (*(x))
#define KEPLER_LANE(x, k) (x)
#define KEPLER_BITS(c) (c)
#endif

/* Distances of the bodies at x. */
LAG_KEPLER_INLINE void kepler_distances(int m, const double *mu, double *x) {
  double *const to = x + KEPLER_DISTANCE * 3 * m;
  LAG_REAL at[3], r[3];
  for (int c = 0; c < 3; c++) at[c] = KEPLER_AT(x + c * m);
  lag_kepler_distance(KEPLER_AT(mu), KEPLER_AT(mu + m), at, r);
  for (int c = 0; c < 3; c++) KEPLER_AT(to + c * m) = r[c];
}

/* Lanes that the kernel leaves out, one by one. */
LAG_KEPLER_INLINE void kepler_far(int far, const lag_kepler_orbit *o, double h, lag_kepler_motion *to) {
  for (int k = 0; far >> k; k++) {
    if (!(far >> k & 1)) continue;
    const double orbit[] = {KEPLER_LANE(o->mu, k),  KEPLER_LANE(o->r, k),    KEPLER_LANE(o->inverse, k),
                            KEPLER_LANE(o->eta, k), KEPLER_LANE(o->beta, k), KEPLER_LANE(o->zeta, k)};
    double of[4];
    lag_kepler_move_far(orbit, h, of);
    KEPLER_LANE(to->f, k) = of[0], KEPLER_LANE(to->g, k) = of[1];
    KEPLER_LANE(to->df, k) = of[2], KEPLER_LANE(to->dg, k) = of[3];
  }
}

/* Motions of `vectors` vectors of bodies for the time h, in phases, so that vectors overlap in time. */
LAG_KEPLER_INLINE void kepler_drift(int vectors, int m, const double *mu, double h, double *x) {
  const int n = 3 * m;
  struct {
    lag_kepler_orbit o;
    LAG_REAL s, G[4], x[3], v[3];
    lag_kepler_motion to;
  } b[KEPLER_BLOCK / KEPLER_LANES];
  for (int i = 0; i < vectors; i++) {
    const int k = i * KEPLER_LANES;
    LAG_REAL r[3];
    for (int c = 0; c < 3; c++) {
      const double *const at = x + c * m + k;
      b[i].x[c] = KEPLER_AT(at), b[i].v[c] = KEPLER_AT(at + KEPLER_V * n), r[c] = KEPLER_AT(at + KEPLER_DISTANCE * n);
    }
    b[i].o = lag_kepler_orbit_at(KEPLER_AT(mu + k), KEPLER_AT(mu + m + k), r, b[i].x, b[i].v);
  }
  for (int i = 0; i < vectors; i++) b[i].s = lag_kepler_estimate(&b[i].o, LAG_C(h), b[i].G);
  for (int i = 0; i < vectors; i++) {
    const LAG_MASK far = lag_kepler_correct(&b[i].o, LAG_C(h), b[i].s, b[i].G);
    b[i].to = lag_kepler_moved(&b[i].o, LAG_C(h), b[i].G);
    if (LAG_ANY(far)) kepler_far(KEPLER_BITS(far), &b[i].o, h, &b[i].to);
  }
  for (int i = 0; i < vectors; i++)
    for (int c = 0; c < 3; c++) {
      double *const at = x + c * m + i * KEPLER_LANES;
      const LAG_REAL q = b[i].x[c], v = b[i].v[c];
      LAG_REAL lost_x = KEPLER_AT(at + KEPLER_LOST_X * n), lost_v = KEPLER_AT(at + KEPLER_LOST_V * n);
      KEPLER_AT(at) = lag_compensated_sum(q, b[i].to.f * q + b[i].to.g * v, &lost_x);
      KEPLER_AT(at + KEPLER_V * n) = lag_compensated_sum(v, b[i].to.df * q + b[i].to.dg * v, &lost_v);
      KEPLER_AT(at + KEPLER_LOST_X * n) = lost_x, KEPLER_AT(at + KEPLER_LOST_V * n) = lost_v;
    }
  for (int i = 0; i < vectors; i++) kepler_distances(m, mu + i * KEPLER_LANES, x + i * KEPLER_LANES);
}

/* A kick for the time h by the perturbation: accelerations less those of Kepler. */
LAG_KEPLER_INLINE void kepler_kick(int m, double h, double *x) {
  const int n = 3 * m;
  const LAG_REAL pull = KEPLER_AT(x + KEPLER_DISTANCE * n + 2 * m);
  for (int c = 0; c < 3; c++) {
    double *const at = x + c * m;
    LAG_REAL lost = KEPLER_AT(at + KEPLER_LOST_V * n);
    const LAG_REAL d = LAG_C(h) * (KEPLER_AT(at + KEPLER_ACCEL * n) + pull * KEPLER_AT(at));
    KEPLER_AT(at + KEPLER_V * n) = lag_compensated_sum(KEPLER_AT(at + KEPLER_V * n), d, &lost);
    KEPLER_AT(at + KEPLER_LOST_V * n) = lost;
  }
}

/* A kick for the time `kick`, then motions for the time dt; 0: none. */
static void kepler_move(int m, const double *mu, double kick, double dt, double *x) {
  for (int i = 0; i < m && (kick > 0 || kick < 0); i += KEPLER_LANES) kepler_kick(m, kick, x + i);
  if (!(dt > 0 || dt < 0)) return;
  if (m < KEPLER_BLOCK) kepler_drift(KEPLER_FEW / KEPLER_LANES, m, mu, dt, x);
  for (int i = 0; i + KEPLER_BLOCK <= m; i += KEPLER_BLOCK)
    kepler_drift(KEPLER_BLOCK / KEPLER_LANES, m, mu + i, dt, x + i);
}
