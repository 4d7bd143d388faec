/* A symplectic step as data: kicks v += kick_i h f and drifts q += drift_i h v by turns, beginning and ending with a kick.
 *
 * For an L that is not separable a kick and the drift after it become symplectic Euler, a drift and the kick after it its
 * adjoint, both implicit: kick_0 = a_0, drift_i = a_i + b_i, kick_i = b_(i-1) + a_i with links of lengths a_0, b_0, a_1, b_1
 * ... has the same order as the splitting does for any two flows: R.I. McLachlan, SIAM J. Sci. Comput. 16 (1995) 151, DOI
 * 10.1137/0916010; Hairer, Lubich, Wanner, Geometric Numerical Integration, 2nd ed. (2006), III.3.4. */
#ifndef LAG_METHODS_COMPOSITION_H
#define LAG_METHODS_COMPOSITION_H

enum { LAG_MAX_DRIFTS = 19 };

typedef struct lag_composition {
  int order;
  int refine;   /* levels of path.h that its dense output needs */
  int stages;   /* drifts; so many evaluations of f a step, because the last one is the first of the next step */
  double drift[LAG_MAX_DRIFTS];
  double kick[LAG_MAX_DRIFTS + 1];
} lag_composition;

/* For q'' = f(t, q) with constant mass; symplectic Euler and Verlet for any two flows. */
extern const lag_composition lag_compose_euler, lag_compose_verlet, lag_compose_verlet4, lag_compose_verlet6,
    lag_compose_verlet8;
/* For any two flows. */
extern const lag_composition lag_compose_any4, lag_compose_any6, lag_compose_any8;

/* part[2 LAG_MAX_DRIFTS] := the lengths of the links, without those at the end that are zero. Returns how many. */
int lag_compose_links(const lag_composition *c, double *part);

#endif
