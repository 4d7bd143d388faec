/* Prints what the functions of emitted models compute at the same random states in every LAG_REAL:
 * a line a state and function, `scene function status values...`. Linked with scenes.c, which
 * lists the models' scenes, all compiled for one LAG_REAL. LANES is 4 for vectors of doubles. */
#include <stdint.h>
#include <stdio.h>

#include "lag_model.h"

extern const lag_scene *const all_scenes[];

enum { MAX = 64, STATES = 8 };

#ifndef LANES
#define LANES 1
static void put(LAG_REAL *x, int lane, double value) { (void)lane, *x = (LAG_REAL)value; }
static long double get(const LAG_REAL *x, int lane) { return (void)lane, (long double)*x; }
#else
static void put(LAG_REAL *x, int lane, double value) { (*x)[lane] = value; }
static long double get(const LAG_REAL *x, int lane) { return (*x)[lane]; }
#endif

static uint64_t seed;
static double next(void) { /* in (-0.75, 0.75), a multiple of 2^-20: exact in every precision */
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return ((double)(seed >> 44) - 524288.0) / 524288.0 * 0.75;
}

typedef struct {
  LAG_REAL t, q[MAX], v[MAX], z[MAX], p[MAX], u[MAX], w[1024], out[4][MAX];
} Work;
static Work k;

static void fill(LAG_REAL *x, int n, int lane) {
  for (int i = 0; i < n; i++) put(&x[i], lane, next());
}

static void print(const char *scene, const char *function, int status, const LAG_REAL *x, int n, int lane) {
  printf("%s %s %d", scene, function, status);
  for (int i = 0; i < n; i++) printf(" %.21Lg", get(&x[i], lane));
  putchar('\n');
}

/* LANES states at once. */
static void evaluate(const lag_scene *s) {
  const lag_model *m = s->model;
  int status[4] = {0, 0, 0, 0};
  if (m->inputs) m->inputs(k.t, k.p, k.u);
  status[0] = m->accel(k.t, k.q, k.v, k.z, k.p, k.u, k.out[0], k.out[0] + m->nq, k.w);
  if (m->energy) status[1] = m->energy(k.t, k.q, k.v, k.z, k.p, k.u, k.out[1], k.w);
  if (m->events) status[2] = m->events(k.t, k.q, k.v, k.z, k.p, k.u, k.out[2], k.w);
  status[3] = s->observe(k.t, k.q, k.v, k.z, k.p, k.u, k.out[3], k.w);
  for (int lane = 0; lane < LANES; lane++) {
    print(m->name, "accel", status[0], k.out[0], m->nq + m->nz, lane);
    if (m->energy) print(m->name, "energy", status[1], k.out[1], 2, lane);
    if (m->events) print(m->name, "events", status[2], k.out[2], m->nev, lane);
    print(m->name, "observe", status[3], k.out[3], s->nout, lane);
  }
}

int main(void) {
  static const unsigned char none[MAX];
  for (int i = 0; all_scenes[i]; i++) {
    const lag_scene *s = all_scenes[i];
    s->params(k.p, none);
    seed = 1;
    for (int state = 0; state < STATES; state += LANES) {
      for (int lane = 0; lane < LANES; lane++) {
        put(&k.t, lane, next());
        fill(k.q, s->model->nq, lane);
        fill(k.v, s->model->nq, lane);
        fill(k.z, s->model->nz, lane);
      }
      evaluate(s);
    }
  }
  return 0;
}
