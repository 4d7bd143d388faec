/* A gradient whose record has little room, so that units of steps are repeated, is the same number by number as one of
 * a record of all steps. Compiled for one scene, SCENE, and a method, METHOD. TAP. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lag.h"

extern const lag_scene SCENE;
enum { MOST = 64, ROWS = 4 };

/* g[n + np] of a weighted sum of states at ROWS times; bytes: room of a unit. */
static int gradient(size_t bytes, double *g, int *n) {
  lag_sim *s = lag_sim_new(&SCENE);
  const lag_model *m = SCENE.model;
  double t[ROWS], weight[ROWS * MOST], end = SCENE.t1;
  *n = 2 * m->nq + m->nz;
  int rc = lag_sim_set_method(s, lag_find_method(METHOD), NULL, 0);
  if (rc == 0) rc = lag_sim_record_within(s, bytes);
  for (int k = 0; k < ROWS && rc == 0; k++) {
    t[k] = end * (k + 1) / ROWS - 0.0137 * (k < ROWS - 1);
    rc = lag_sim_advance(s, t[k]);
    for (int i = 0; i < *n; i++) weight[k * *n + i] = 1.0 / (1 + i + k);
  }
  if (rc == 0) rc = lag_sim_gradient(s, ROWS, t, weight, g, g + *n);
  if (rc) printf("# %s\n", lag_sim_message(s));
  lag_sim_free(s);
  return rc;
}

int main(void) {
  static const size_t rooms[] = {1 << 26, 20000, 2000, 1};
  double all[2 * MOST], g[2 * MOST];
  int n = 0, bad = gradient(rooms[0], all, &n);
  puts("1..3");
  for (int i = 1; i < 4; i++) {
    int rc = bad ? bad : gradient(rooms[i], g, &n);
    int same = rc == 0 && memcmp(g, all, (size_t)(n + SCENE.model->np) * sizeof *g) == 0 && all[0] != 0.0;
    printf("%sok %d - units of %zu bytes\n", same ? "" : "not ", i, rooms[i]);
    for (int k = 0; k < n + SCENE.model->np && !same; k++) printf("# %.17g %.17g\n", all[k], g[k]);
  }
  return 0;
}
