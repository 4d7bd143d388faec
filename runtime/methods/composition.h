/* Splitting methods as data: kicks v += kick_i h f and drifts q += drift_i h v in turn, a kick first and last.
 *
 * For an L that is not separable a kick with the drift after it becomes symplectic Euler, a drift with the kick after it its
 * adjoint, both implicit. With substeps of lengths a_0, b_0, a_1, b_1, ... and kick_0 = a_0, drift_i = a_i + b_i, kick_i = b_(i-1) + a_i
 * the composition has the order that the splitting has for any two flows: R.I. McLachlan, SIAM J. Sci. Comput. 16 (1995) 151, DOI
 * 10.1137/0916010; Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), III.3.4. */
#pragma once

enum { LAG_MAX_DRIFTS = 19 };

typedef struct lag_composition {
  int order;
  int stages;   /* number of drifts, and of evaluations of f a step: the last one serves the next step, too */
  double drift[(LAG_MAX_DRIFTS + 1) / 2], kick[(LAG_MAX_DRIFTS + 1) / 2]; /* the first halves, in the middle included; of order 1: all */
} lag_composition;

static inline double lag_composition_drift(const lag_composition *c, int i) { return c->drift[2 * i < c->stages ? i : c->stages - 1 - i]; }

static inline double lag_composition_kick(const lag_composition *c, int i) {
  return c->kick[2 * i <= c->stages || c->order == 1 ? i : c->stages - i];
}

/* For q'' = f(t, q) with constant M; symplectic Euler and Verlet for any two flows. */
extern const lag_composition lag_compose_euler, lag_compose_verlet, lag_compose_verlet4, lag_compose_verlet6,
    lag_compose_verlet8;
/* For any two flows. */
extern const lag_composition lag_compose_any4, lag_compose_any6, lag_compose_any8;

/* part[2 LAG_MAX_DRIFTS] := lengths of the substeps a_0, b_0, a_1, ...; a last one of length 0 is left out. Returns their number. */
int lag_composition_substeps(const lag_composition *c, double *part);
