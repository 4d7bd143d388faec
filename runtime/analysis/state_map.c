/* Discrete symmetries (state_map.h). J. S. W. Lamb, J. A. G. Roberts, Physica D 112 (1998) 1, DOI
 * 10.1016/S0167-2789(97)00199-1: reversing symmetries. */
#include "analysis/state_map.h"

#include "lag.h"

int lag_map_open(StateMap *map, Pool *pool, int n, int nq, int reverses) {
  *map = (StateMap){.n = n, .nq = nq, .reverses = reverses, .sign = lag_pool_doubles(pool, (size_t)n)};
  map->from = (int *)(void *)lag_pool_doubles(pool, (size_t)n);
  if (!map->from || !map->sign) return LAG_ENOMEM;
  for (int i = 0; i < n; i++) {
    map->from[i] = i;
    map->sign[i] = reverses && i >= nq && i < 2 * nq ? -1 : 1;
  }
  return LAG_OK;
}

void lag_map_set(StateMap *map, int i, int from, double sign) {
  map->from[i] = from;
  map->sign[i] = sign;
  if (i >= map->nq) return;
  map->from[map->nq + i] = map->nq + from;
  map->sign[map->nq + i] = map->reverses ? -sign : sign;
}

void lag_map_apply(const StateMap *map, const double *y, double *image) {
  for (int i = 0; i < map->n; i++) image[i] = map->sign[i] * y[map->from[i]];
}

int lag_map_square(StateMap *map, Pool *pool, const StateMap *of) {
  if (lag_map_open(map, pool, of->n, of->nq, 0)) return LAG_ENOMEM;
  for (int i = 0; i < of->n; i++) {
    map->from[i] = of->from[of->from[i]];
    map->sign[i] = of->sign[i] * of->sign[of->from[i]];
  }
  return LAG_OK;
}

int lag_map_is_one_to_one(const StateMap *map) {
  for (int i = 0; i < map->n; i++)
    for (int j = 0; j < i; j++)
      if (map->from[i] == map->from[j]) return 0;
  return 1;
}

/* Applications after which component i is itself again, with its sign; 0: not within `most`. */
static int cycle(const StateMap *map, int i, int most) {
  double sign = 1;
  for (int k = 1, at = i; k <= most; k++) {
    sign *= map->sign[at];
    at = map->from[at];
    if (at == i && sign > 0) return k;
  }
  return 0;
}

int lag_map_order(const StateMap *map) {
  enum { MOST = 1000 };
  int order = 1;
  for (int i = 0; i < map->n; i++) {
    int c = cycle(map, i, MOST), a = order, b = c;
    if (c == 0) return 0;
    while (b) { /* Euclid's algorithm: a is the greatest common divisor */
      int rest = a % b;
      a = b;
      b = rest;
    }
    order = order / a * c;
    if (order > MOST) return 0;
  }
  return order;
}
