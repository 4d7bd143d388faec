/* Quasi-random sequences of GSL, for samples of sweeps (lag_extras of lag.h). */
#include <gsl/gsl_qrng.h>
#include <string.h>

#include "gsl/quasi_random.h"

int lag_gsl_points(const char *sequence, int dimensions, long long n, double *u) {
  const gsl_qrng_type *type = strcmp(sequence, "sobol") == 0 ? gsl_qrng_sobol : gsl_qrng_halton;
  if (dimensions > (int)type->max_dimension) return (int)type->max_dimension;
  gsl_qrng *q = gsl_qrng_alloc(type, (unsigned)dimensions);
  if (!q) return (int)type->max_dimension;
  for (long long i = 0; i < n; i++) gsl_qrng_get(q, u + i * dimensions);
  gsl_qrng_free(q);
  return 0;
}
