/* The Taylor coefficients at a scene's start, bit by bit: the same however many numbers stand side by side.
 *   bits        prints all that rest and at give; linked with all_scenes */
#include <stdio.h>
#include <stdlib.h>

#include "lag_model.h"

extern const lag_scene *const all_scenes[];

enum { ORDER = 20 };

static double *room(int n) { return calloc((size_t)n + 8, sizeof(double)); }

static void print_scene(const lag_scene *s) {
  const lag_model *m = s->model;
  const lag_taylor *ty = m->taylor;
  double *p = room(m->np + m->nderived), *y = room(2 * m->nq + m->nz), *u = room(m->nu), *follows = room(m->nu);
  double *x = room((ty->order + 1) * ty->columns), *w = room(ty->nw), *sum = room(ty->width), *slope = room(ty->width);
  unsigned char *fixed = calloc((size_t)m->np + 1, 1);
  s->params(s, p, fixed);
  s->start(s, p, y, y + m->nq, y + 2 * m->nq);
  for (int i = 0; i < m->nq; i++) y[m->nq + i] += 0.1 * (i + 1) * m->q[i].factor;
  if (ty->first(ty, s->t0, y, y + m->nq, y + 2 * m->nq, p, u, follows, x, w) != LAG_OK)
    printf("%s: order 0 failed\n", m->name);
  ty->rest(ty, ORDER, 0.125, x, w);
  ty->at(ty, ORDER, 0.75, x, sum, slope);
  for (int k = 0; k <= ORDER; k++)
    for (int i = 0; i < 2 * m->nq + m->nz; i++) printf("%s %d %d %a\n", m->name, k, i, x[k * ty->columns + i]);
  for (int i = 0; i < 2 * m->nq + m->nz; i++) printf("%s %d %a %a\n", m->name, i, sum[i], slope[i]);
  free(p), free(y), free(u), free(follows), free(x), free(w), free(sum), free(slope), free(fixed);
}

int main(void) {
  for (int i = 0; all_scenes[i]; i++) print_scene(all_scenes[i]);
  return 0;
}
