/* Finite differences (finite_difference.h). */
#include "analysis/finite_difference.h"

#include "lag.h"

/* Places in steps, on the side that `sign` chooses, and weights. */
typedef struct Stencil {
  int order, n, sign;
  double at[5], weight[5];
} Stencil;

static const Stencil stencils[] = {
    {2, 2, 1, {-1, 1}, {-1.0 / 2, 1.0 / 2}},
    {2, 3, 1, {0, 1, 2}, {-3.0 / 2, 2, -1.0 / 2}},
    {2, 3, -1, {0, 1, 2}, {-3.0 / 2, 2, -1.0 / 2}},
    {4, 4, 1, {-1, 1, -2, 2}, {-2.0 / 3, 2.0 / 3, 1.0 / 12, -1.0 / 12}},
    {4, 5, 1, {0, 1, 2, 3, 4}, {-25.0 / 12, 4, -3, 4.0 / 3, -1.0 / 4}},
    {4, 5, -1, {0, 1, 2, 3, 4}, {-25.0 / 12, 4, -3, 4.0 / 3, -1.0 / 4}},
};

static int by_stencil(const FiniteDifference *f, const Stencil *s, ValuesAt *values, void *of, double x, double *d) {
  int rc = LAG_OK;
  for (int i = 0; i < f->n; i++) d[i * f->stride] = 0;
  for (int k = 0; k < s->n && rc == LAG_OK; k++) {
    rc = values(of, x + s->sign * s->at[k] * f->h, f->out);
    for (int i = 0; i < f->n && rc == LAG_OK; i++) d[i * f->stride] += s->sign * s->weight[k] * f->out[i] / f->part;
  }
  return rc;
}

int lag_finite_difference(const FiniteDifference *f, ValuesAt *values, void *of, double x, double *d) {
  int rc = LAG_EINVAL;
  for (unsigned k = 0; k < sizeof stencils / sizeof *stencils && rc != LAG_OK && rc != LAG_ENOMEM; k++)
    if (stencils[k].order == f->order) rc = by_stencil(f, &stencils[k], values, of, x, d);
  return rc;
}
