/* Coordinates y in which the search for symmetries is done where the mass matrix is constant and not diagonal: those that L is written with
 * (mech/noether_forms.h), or some in which the kinetic energy is sum y'^2/2. Their equations are as well conditioned as those of Cartesian coordinates,
 * however skew the model's own are. */
#ifndef LAGC_NOETHER_FRAME_H
#define LAGC_NOETHER_FRAME_H

#include "mech/noether_search.h"

/* y = S q + shift. Generators stay those of y where L is written with them. */
struct NoetherFrame {
  uint32_t n;
  int stays;
  long double *S, *inverse; /* [n*n], row by row */
  long double *shift;       /* [n] */
};

/* NULL where the model's own coordinates are to be used. */
const NoetherFrame *frame_new(const Ansatz *a, Arena *scratch, const long double *parameters);

/* Components of a vector, or of a covector, in y; scratch is [n]. */
void frame_vector(const NoetherFrame *f, long double *x, long double *scratch);
void frame_covector(const NoetherFrame *f, long double *x, long double *scratch);

/* The other way, of a vector. */
void frame_vector_back(const NoetherFrame *f, long double *x, long double *scratch);

/* Coefficients of xi, affine in y, as those of xi, affine in q, unless they stay: the columns behind the first of `shown`. The shift is 0 then. scratch
 * is [2*n]. */
void frame_generator_back(const NoetherFrame *f, long double *shown, long double *scratch);

#endif
