/* A symplectic step for q'' = f(t, q) as data: kicks v += kick_i h f and drifts q += drift_i h v by turns, beginning and
 * ending with a kick. */
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

extern const lag_composition lag_compose_euler, lag_compose_verlet, lag_compose_verlet4, lag_compose_verlet6,
    lag_compose_verlet8;

#endif
