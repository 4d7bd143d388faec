/* A program evaluated beside the same program compiled: evaluator BYTES LIBRARY.so SCENE prints a line `accel NS NS
 * RATIO` at the scene's start, and one for a Taylor step of order 16 where there is one: nanoseconds a call, evaluated
 * and compiled. Both take turns; the least of 20 turns counts. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "evaluator/evaluator.h"

enum { ORDER = 16, TURNS = 20 };

static double now(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double *numbers(int n) {
  double *x = calloc((size_t)n + 1, sizeof *x);
  if (!x) exit(2);
  return x;
}

static const lag_program *evaluated(const char *path) {
  const char *why = "";
  FILE *f = fopen(path, "rb");
  size_t room = 1u << 26;
  void *bytes = malloc(room);
  if (!f || !bytes) exit(2);
  const lag_program *p = lag_program_read(bytes, fread(bytes, 1, room, f), &why);
  if (!p) printf("%s\n", why), exit(2);
  fclose(f);
  return p;
}

static const lag_program *compiled(const char *path) {
  void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL), *f = library ? dlsym(library, "lag_library") : NULL;
  const lag_program *(*get)(void);
  if (!f) printf("%s\n", dlerror()), exit(2);
  memcpy(&get, &f, sizeof get);
  return get();
}

static const lag_scene *scene_of(const lag_program *p, const char *name) {
  for (int i = 0; i < p->nscenes; i++)
    if (strcmp(p->scenes[i]->name, name) == 0) return p->scenes[i];
  exit(2);
}

typedef struct State {
  double *q, *v, *z, *p, *u, *a, *zd, *w, *x, *follows;
} State;

static void call(const lag_model *m, const State *s, int taylor) {
  const lag_taylor *of = m->taylor;
  if (taylor ? of->first(of, 0, s->q, s->v, s->z, s->p, s->u, s->follows, s->x, s->w)
             : m->accel(m, 0, s->q, s->v, s->z, s->p, s->u, s->a, s->zd, s->w))
    printf("no value at the start\n"), exit(2);
  if (taylor) of->rest(of, ORDER, 0.01, s->x, s->w);
}

/* Seconds of a call, of as many as take some 2 ms. */
static double seconds(const lag_model *m, const State *s, int taylor) {
  for (int n = 1;; n *= 2) {
    double t0 = now();
    for (int i = 0; i < n; i++) call(m, s, taylor);
    double took = now() - t0;
    if (took > 2e-3) return took / n;
  }
}

int main(int argc, char **argv) {
  if (argc != 4) return 2;
  const lag_scene *scenes[] = {scene_of(evaluated(argv[1]), argv[3]), scene_of(compiled(argv[2]), argv[3])};
  const lag_model *of[] = {scenes[0]->model, scenes[1]->model};
  for (int taylor = 0; taylor <= (of[0]->taylor != NULL); taylor++) {
    const lag_model *m = of[0];
    int nw = m->taylor && m->taylor->nw > m->nw ? m->taylor->nw : m->nw,
        columns = m->taylor ? (m->taylor->order + ORDER + 1) * m->taylor->columns : 0;
    State s = {numbers(m->nq), numbers(m->nq), numbers(m->nz), numbers(m->np),  numbers(m->nu),
               numbers(m->nq), numbers(m->nz), numbers(nw),    numbers(columns), numbers(m->nu)};
    unsigned char *fixed = calloc((size_t)m->np + 1, 1);
    if (!fixed) return 2;
    scenes[1]->params(scenes[1], s.p, fixed);
    scenes[1]->start(scenes[1], s.p, s.q, s.v, s.z);
    double least[] = {1, 1};
    for (int turn = 0; turn < TURNS; turn++)
      for (int k = 0; k < 2; k++) {
        double t = seconds(of[k], &s, taylor);
        least[k] = t < least[k] ? t : least[k];
      }
    printf("%s %.1f %.1f %.2f\n", taylor ? "taylor" : "accel", 1e9 * least[0], 1e9 * least[1], least[0] / least[1]);
  }
  return 0;
}
