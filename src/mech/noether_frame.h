/* Coordinates in which the kinetic energy is sum y'^2/2: the search for symmetries is done in them where the mass matrix is constant and not diagonal.
 * Their equations are as well conditioned as those of Cartesian coordinates, however skew the model's own are. */
#ifndef LAGC_NOETHER_FRAME_H
#define LAGC_NOETHER_FRAME_H

#include "mech/noether_search.h"

/* y = S q with S^T S the mass matrix. */
struct NoetherFrame {
  uint32_t n;
  long double *S, *inverse; /* [n*n], row by row, upper triangular */
};

/* NULL where the model's own coordinates are to be used: the mass matrix varies, is diagonal or not definite; there are constraints; a coordinate has
 * a sign. */
const NoetherFrame *frame_new(const Ansatz *a, Arena *scratch, const long double *parameters);

/* Components of a vector, or of a covector, in y; scratch is [n]. */
void frame_vector(const NoetherFrame *f, long double *x, long double *scratch);
void frame_covector(const NoetherFrame *f, long double *x, long double *scratch);

/* The other way, of a vector. */
void frame_vector_back(const NoetherFrame *f, long double *x, long double *scratch);

/* Coefficients of xi, affine in y, as those of xi, affine in q: the columns behind the first of `shown`. scratch is [n*n + n]. */
void frame_generator_back(const NoetherFrame *f, long double *shown, long double *scratch);

#endif
