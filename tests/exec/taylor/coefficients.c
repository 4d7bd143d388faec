/* The Taylor coefficients of functions.lag, emitted for LAG_REAL, against those that mpmath has computed.
 *   coefficients FILE.expected     prints what is wrong; exit status 1 then */
#include <string.h>

#include "real.h"

extern const lag_scene functions_go;

enum { MOST = 64, ORDERS = 14 };

/* Rounding: a dozen operations an order, and coefficients of earlier orders that are up to 100 times as large. */
static const long double allowed = 2000 * REAL_EPSILON;

static int state_named(const lag_model *m, const char *name) {
  for (int i = 0; i < m->nz; i++)
    if (strcmp(m->z[i].name, name) == 0) return i;
  return -1;
}

/* With unit of time T, coefficient k of a rate is T^k times that of the file. */
static int compare(const char *file, Real T, int print) {
  const lag_scene *s = &functions_go;
  const lag_model *m = s->model;
  const lag_taylor *ty = m->taylor;
  static const unsigned char none[MOST];
  Real z[MOST] = {0}, p[MOST], u[MOST], follows[MOST] = {1, 0},
       *x = calloc((size_t)((ty->order + 1) * ty->columns), sizeof *x);
  Real *w = calloc((size_t)ty->nw, sizeof *w), worst = 0;
  char name[64], digits[64];
  int k, n = 0, wrong = 0;
  if (m->np + m->nderived > MOST) return 1;
  s->params(s, p, none);
  z[state_named(m, "x")] = REAL_READ("0.3");
  z[state_named(m, "y")] = REAL_READ("0.8");
  m->inputs(m, REAL_READ("0.25"), p, u);
  u[1] = 3; /* `still`, held */
  if (ty->first(ty, REAL_READ("0.25"), NULL, NULL, z, p, u, follows, x, w) != LAG_OK) return 1;
  ty->rest(ty, ORDERS + 2, T, x, w);
  FILE *f = fopen(file, "r");
  while (f && fscanf(f, "%63s %d %63s", name, &k, digits) == 3) {
    Real scale = 1, want = REAL_READ(digits);
    for (int i = 0; i < k; i++) scale *= T;
    Real got = x[k * ty->columns + m->nz + state_named(m, name)] / scale;
    Real error = real_abs(got - want) / real_max(1, real_abs(want));
    worst = real_max(worst, error);
    if (!(error <= (Real)allowed)) {
      printf("%s, order %d: %.21Lg, not %s\n", name, k, (long double)got, digits);
      wrong = 1;
    }
    n++;
  }
  if (f) fclose(f);
  if (print) printf("%d coefficients, error at most %.2Lg\n", n, (long double)worst);
  free(x);
  free(w);
  return wrong || n < 500;
}

int main(int argc, char **argv) {
  if (argc != 2) return 2;
  int wrong = compare(argv[1], 1, 1);
  return compare(argv[1], (Real)0.125, 0) || wrong;
}
