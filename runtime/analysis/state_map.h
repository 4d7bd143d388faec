/* Discrete symmetries of motions: each component of the state becomes another one, or its negative, as where equal
 * bodies are exchanged or a plane is a mirror. A reversing one also turns time round, and velocities with it. */
#pragma once

#include "analysis/memory_pool.h"

typedef struct StateMap {
  int n, nq;
  int reverses;   /* 1: time runs backwards after it */
  int *from;      /* [n] component i of the image is sign[i] y[from[i]] */
  double *sign;
} StateMap;

/* The identity, or for `reverses` that with all velocities turned round. LAG_OK, or LAG_ENOMEM. */
int lag_map_open(StateMap *map, Pool *pool, int n, int nq, int reverses);
/* Coordinate or state i becomes sign times component `from`; its velocity follows. */
void lag_map_set(StateMap *map, int i, int from, double sign);
/* image[n] := map of y[n]; they may not overlap. */
void lag_map_apply(const StateMap *map, const double *y, double *image);
/* map := `of` applied twice. LAG_OK, or LAG_ENOMEM. */
int lag_map_square(StateMap *map, Pool *pool, const StateMap *of);
/* Whether each component is taken once. */
int lag_map_is_one_to_one(const StateMap *map);
/* How often it is applied until all is as before; 0: more often than 1000 times. */
int lag_map_order(const StateMap *map);
