/* Compares functions that compute the same accelerations: an emitted model and its peers.
 *
 *   driver check              largest difference to the emitted model, relative to the largest acceleration
 *   driver count NAME CALLS   calls one so often: callgrind counts, and the difference of two runs is what calls cost
 *   driver time               times of all, taken in turns: nanoseconds a call, and the model's over theirs: the least
 *                             of many, which are those that nothing else interrupted
 *
 * Compiled with -DSCENE=scene of the emitted model, '-DPEERS=X(name) X(name)'. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "hand/accel.h"
#include "lag_model.h"

#define X(name) ACCEL(name);
PEERS
#undef X
extern const lag_scene SCENE;

#ifndef WITHIN
#define WITHIN 2
#endif

typedef int (*Accel)(const void *, double, const double *, const double *, const double *, const double *,
                     const double *, double *, double *, double *);
typedef struct {
  const char *name;
  Accel f;
} Candidate;

enum { STATES = 16, MOST = 16, ROUNDS = 41 };

typedef struct {
  const lag_model *m;
  double *q[STATES], *v[STATES], *p, *a, *w;
  Candidate all[MOST];
  int n;
} Bench;

static double *room(int n) {
  double *x = calloc((size_t)n + 8, sizeof *x);
  if (!x) exit(2);
  return x;
}

/* States within WITHIN of rest at 0, or where SCENE_START is defined of the scene's start; the same in every run.
 * (What a sine costs depends on its argument: 108 instructions at 0.1, 140 at 3.) */
static Bench bench_new(void) {
  Bench b = {.m = SCENE.model, .n = 1};
  int n = b.m->nq;
  unsigned long long seed = 1;
  unsigned char *fixed = calloc((size_t)b.m->np + 1, 1);
  if (!fixed) exit(2);
  b.p = room(b.m->np + b.m->nderived), b.a = room(n), b.w = room(b.m->nw);
  SCENE.params(&SCENE, b.p, fixed);
  free(fixed);
  for (int s = 0; s < STATES; s++) {
    b.q[s] = room(n), b.v[s] = room(n);
#ifdef SCENE_START
    SCENE.start(&SCENE, b.p, b.q[s], b.v[s], NULL);
#endif
    for (int i = 0; i < 2*n; i++) {
      seed = seed*6364136223846793005u + 1442695040888963407u;
      (i < n ? b.q[s] : b.v[s])[i % n] += WITHIN*(2*((double)(seed >> 11)/9007199254740992.0) - 1);
    }
  }
  b.all[0] = (Candidate){"ours", SCENE.model->accel};
#define X(name) b.all[b.n++] = (Candidate){#name, name};
  PEERS
#undef X
  return b;
}

static void call(const Bench *b, Accel f, long times) {
  for (long k = 0; k < times; k++) {
    int s = (int)(k % STATES);
    if (f(b->m, 0, b->q[s], b->v[s], NULL, b->p, NULL, b->a, NULL, b->w) != 0) exit(3);
  }
}

static int check(const Bench *b) {
  double *ours = room(b->m->nq);
  int bad = 0;
  for (int k = 1; k < b->n; k++) {
    double worst = 0;
    for (int s = 0; s < STATES; s++) {
      double size = 0, off = 0;
      if (b->m->accel(b->m, 0, b->q[s], b->v[s], NULL, b->p, NULL, ours, NULL, b->w) != 0) return 3;
      if (b->all[k].f(b->m, 0, b->q[s], b->v[s], NULL, b->p, NULL, b->a, NULL, b->w) != 0) return 3;
      for (int i = 0; i < b->m->nq; i++) size = fmax(size, fabs(ours[i])), off = fmax(off, fabs(ours[i] - b->a[i]));
      worst = fmax(worst, off/size);
    }
    bad |= !(worst < 1e-8); /* condition numbers of some 1e6 at random states */
    printf("%s %.1e\n", b->all[k].name, worst);
  }
  free(ours);
  return bad;
}

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_MONOTONIC, &t);
  return (double)t.tv_sec + 1e-9*(double)t.tv_nsec;
}

static void times(const Bench *b) {
  double least[MOST];
  long calls = STATES;
  for (double t0; t0 = now(), call(b, b->all[0].f, calls), now() - t0 < 1e-3;) calls *= 2;
  for (int r = 0; r < ROUNDS; r++)
    for (int k = 0; k < b->n; k++) {
      double t0 = now();
      call(b, b->all[k].f, calls);
      double ns = 1e9*(now() - t0)/(double)calls;
      if (!r || ns < least[k]) least[k] = ns;
    }
  for (int k = 0; k < b->n; k++)
    printf(least[k] < 1000 ? "%s %.1f %.3f\n" : "%s %.0f %.3f\n", b->all[k].name, least[k], least[0]/least[k]);
}

int main(int argc, char **argv) {
  Bench b = bench_new();
  if (argc == 2 && strcmp(argv[1], "check") == 0) return check(&b);
  if (argc == 2 && strcmp(argv[1], "time") == 0) return times(&b), 0;
  for (int k = 0; argc == 4 && k < b.n; k++)
    if (strcmp(argv[1], "count") == 0 && strcmp(argv[2], b.all[k].name) == 0)
      return call(&b, b.all[k].f, atol(argv[3])), 0;
  return 2;
}
