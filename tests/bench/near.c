/* A liquid of Lennard-Jones atoms by an emitted model with `near`, and by a loop by hand with lists of neighbours from
 * cells: ns a step and atom of both, and the largest difference of places behind the steps. Argument: steps. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "lag_model.h"

extern const lag_scene SCENE;

static int n;
static double side, cut;

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9*(double)t.tv_nsec;
}

static void *room(size_t n_, size_t size) {
  void *x = calloc(n_ + 8, size);
  if (!x) exit(2);
  return x;
}

/* ---- by hand: each pair once, lists kept until an atom has moved by half the skin */

static const double skin = 0.3;
static double *listed;              /* places when the lists were made */
static int *head, *next, *from, *with, pairs, most;

static double nearest(double x) { return x - side*nearbyint(x/side); }

static int cell_of(const double *q, int cells, int c) {
  const int k = (int)floor((q[c]/side - floor(q[c]/side))*cells);
  return k < cells ? k : cells - 1;
}

static void add_pairs(const double *q, int i, int cell, double reach2) {
  for (int j = head[cell]; j >= 0; j = next[j]) {
    double x = nearest(q[3*i] - q[3*j]), y = nearest(q[3*i + 1] - q[3*j + 1]), z = nearest(q[3*i + 2] - q[3*j + 2]);
    if (j >= i || x*x + y*y + z*z >= reach2) continue;
    if (pairs == most) with = realloc(with, sizeof *with*(size_t)(most = 2*most + 1000));
    with[pairs++] = j;
  }
}

static void make_lists(const double *q) {
  const int cells = (int)(side/(cut + skin));
  const double reach2 = (cut + skin)*(cut + skin);
  if (!listed) {
    listed = room(3*(size_t)n, sizeof *listed), next = room((size_t)n, sizeof *next);
    from = room((size_t)n + 1, sizeof *from), head = room((size_t)(cells*cells*cells), sizeof *head);
  }
  memcpy(listed, q, 3*(size_t)n*sizeof *q);
  for (int k = 0; k < cells*cells*cells; k++) head[k] = -1;
  for (int i = 0; i < n; i++) {
    const int at = (cell_of(q + 3*i, cells, 0)*cells + cell_of(q + 3*i, cells, 1))*cells + cell_of(q + 3*i, cells, 2);
    next[i] = head[at], head[at] = i;
  }
  pairs = 0;
  for (int i = 0; i < n; i++) {
    from[i] = pairs;
    const int a = cell_of(q + 3*i, cells, 0) + cells, b = cell_of(q + 3*i, cells, 1) + cells,
              c = cell_of(q + 3*i, cells, 2) + cells;
    for (int k = 0; k < 27; k++)
      add_pairs(q, i, ((a + k/9 - 1) % cells*cells + (b + k/3 % 3 - 1) % cells)*cells + (c + k % 3 - 1) % cells,
                reach2);
  }
  from[n] = pairs;
}

static void forces_by_hand(const double *q, double *a) {
  int moved = !listed;
  for (int i = 0; i < n && !moved; i++) {
    double x = q[3*i] - listed[3*i], y = q[3*i + 1] - listed[3*i + 1], z = q[3*i + 2] - listed[3*i + 2];
    moved = x*x + y*y + z*z > skin*skin/4;
  }
  if (moved) make_lists(q);
  memset(a, 0, 3*(size_t)n*sizeof *a);
  for (int i = 0; i < n; i++) {
    double ax = 0, ay = 0, az = 0;
    for (int k = from[i]; k < from[i + 1]; k++) {
      const int j = with[k];
      double x = nearest(q[3*i] - q[3*j]), y = nearest(q[3*i + 1] - q[3*j + 1]), z = nearest(q[3*i + 2] - q[3*j + 2]);
      double d2 = x*x + y*y + z*z;
      if (d2 >= cut*cut) continue;
      double s = 1/d2, s3 = s*s*s, f = 24*s*s3*(2*s3 - 1);
      ax += f*x, ay += f*y, az += f*z;
      a[3*j] -= f*x, a[3*j + 1] -= f*y, a[3*j + 2] -= f*z;
    }
    a[3*i] += ax, a[3*i + 1] += ay, a[3*i + 2] += az;
  }
}

/* ---- both */

static const double *params;
static double *work;
static void forces(int by_hand, const double *q, const double *v, double *a) {
  if (by_hand) forces_by_hand(q, a);
  else if (SCENE.model->accel(SCENE.model, 0, q, v, NULL, params, NULL, a, NULL, work)) exit(3);
}

/* Velocity Verlet steps of 0.004; returns ns a step and atom. */
static double run(int by_hand, double *q, double *v, double *a, long steps) {
  const double h = 0.004;
  forces(by_hand, q, v, a);
  const double begin = seconds();
  for (long k = 0; k < steps; k++) {
    for (int i = 0; i < 3*n; i++) v[i] += h/2*a[i], q[i] += h*v[i];
    forces(by_hand, q, v, a);
    for (int i = 0; i < 3*n; i++) v[i] += h/2*a[i];
  }
  return 1e9*(seconds() - begin)/(double)steps/n;
}

int main(int argc, char **argv) {
  const lag_model *m = SCENE.model;
  const long steps = argc > 1 ? atol(argv[1]) : 100;
  const size_t nq = (size_t)m->nq;
  double *p = room((size_t)(m->np + m->nderived), sizeof *p), *q[2], *v[2], *a = room(nq, sizeof *a), ns[2], apart = 0;
  n = m->nq/3, params = p, work = room((size_t)m->nw, sizeof *work);
  SCENE.params(&SCENE, p, room((size_t)m->np, 1));
  for (int k = 0; k < m->np; k++) {
    if (!strcmp(m->p[k].name, "L")) side = p[k];
    if (!strcmp(m->p[k].name, "cut")) cut = p[k];
  }
  for (int k = 0; k < 2; k++) {
    q[k] = room(nq, sizeof **q), v[k] = room(nq, sizeof **v);
    SCENE.start(&SCENE, p, q[k], v[k], NULL);
    for (int i = 0, m1 = (int)(cbrt(n) + 0.5); i < n; i++) /* a simple cubic crystal, which melts */
      q[k][3*i] = side/m1*(i % m1), q[k][3*i + 1] = side/m1*(i/m1 % m1), q[k][3*i + 2] = side/m1*(i/m1/m1);
    ns[k] = run(k, q[k], v[k], a, steps);
  }
  for (size_t i = 0; i < nq; i++) apart = fmax(apart, fabs(q[0][i] - q[1][i]));
  printf("%d %.1f %.1f %.3f %.1e\n", n, ns[0], ns[1], ns[0]/ns[1], apart);
  return 0;
}
