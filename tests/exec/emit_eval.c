/* Prints what the functions of emitted models compute at the same random states in every LAG_REAL:
 * a line a state and function, `scene function status values...`. Linked with scenes.c, which
 * lists the models' scenes, all compiled for one LAG_REAL. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>

#include "lag_model.h"

extern const lag_scene *const all_scenes[];

enum { MAX = 128, PARAMS = 512, STATES = 8, WORK = 1 << 14 }; /* parameters with derived ones */

static uint64_t seed;
static double next(void) { /* in (-0.75, 0.75), a multiple of 2^-20: exact in every precision */
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return ((double)(seed >> 44) - 524288.0) / 524288.0 * 0.75;
}

typedef struct {
  LAG_REAL t, q[MAX], v[MAX], z[MAX], p[PARAMS], u[MAX], w[WORK], out[MAX];
} Work;
static Work k;

static void fill(LAG_REAL *x, int n) {
  for (int i = 0; i < n; i++) x[i] = (LAG_REAL)next();
}

static void print(const char *scene, const char *function, int status, const LAG_REAL *x, int n) {
  printf("%s %s %d", scene, function, status);
  for (int i = 0; i < n; i++) printf(" %.21Lg", (long double)x[i]);
  putchar('\n');
}

static void evaluate(const lag_scene *s) {
  const lag_model *m = s->model;
  if (m->inputs) m->inputs(m, k.t, k.p, k.u);
  int status = m->accel(m, k.t, k.q, k.v, k.z, k.p, k.u, k.out, k.out + m->nq, k.w);
  print(m->name, "accel", status, k.out, m->nq + m->nz);
  if (m->energy)
    status = m->energy(m, k.t, k.q, k.v, k.z, k.p, k.u, k.out, k.w), print(m->name, "energy", status, k.out, 2);
  if (m->events)
    status = m->events(m, k.t, k.q, k.v, k.z, k.p, k.u, k.out, k.w), print(m->name, "events", status, k.out, m->nev);
  status = s->observe(s, k.t, k.q, k.v, k.z, k.p, k.u, k.out, k.w);
  print(m->name, "observe", status, k.out, s->nout);
}

int main(void) {
  static const unsigned char none[MAX];
  for (int i = 0; all_scenes[i]; i++) {
    const lag_scene *s = all_scenes[i];
    if (s->model->np + s->model->nderived > PARAMS || s->model->nw > WORK) return 1;
    s->params(s, k.p, none);
    seed = 1;
    for (int i = 0; i < s->model->nu; i++) k.u[i] = 0; /* contacts are open */
    for (int i = 0; i < s->model->nmodes; i++) k.u[s->model->nu + i] = (LAG_REAL)LAG_FREE;
    /* of the second, to the span where that is shorter: the phase of a fast field has no digits in floats after a
     * second */
    int halvings = 0;
    while (halvings < 60 && ldexp(1, -halvings) > fabs(s->t1 - s->t0)) halvings++;
    for (int state = 0; state < STATES; state++) {
      k.t = (LAG_REAL)ldexp(next(), -halvings);
      fill(k.q, s->model->nq);
      fill(k.v, s->model->nq);
      fill(k.z, s->model->nz);
      evaluate(s);
    }
  }
  return 0;
}
