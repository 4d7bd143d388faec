/* Coordinates y of the search for symmetries where the mass matrix is constant and not diagonal: those of symmetry/linear_forms.h, or some in which
 * the kinetic energy is sum y'^2/2. Their equations are as well conditioned as those of Cartesian coordinates, however oblique the model's own
 * are. */
#ifndef LAGC_SYMMETRY_SEARCH_FRAME_H
#define LAGC_SYMMETRY_SEARCH_FRAME_H

#include "symmetry/determining_equations.h"

/* y = S q + shift. stays: generators are reported in y, as L is written with them. */
struct NoetherFrame {
  uint32_t n;
  int stays;
  long double *S, *inverse; /* [n*n], row by row */
  long double *shift;       /* [n] */
};

/* The frame for given parameters (values by symbol), in `scratch`; NULL: the model's own coordinates serve. */
const NoetherFrame *frame_new(const Ansatz *a, Arena *scratch, const long double *parameters);

/* Converts components of a vector, or of a covector, to y, in place; scratch is [n]. */
void frame_vector(const NoetherFrame *f, long double *x, long double *scratch);
void frame_covector(const NoetherFrame *f, long double *x, long double *scratch);

/* Converts components of a vector back from y. */
void frame_vector_back(const NoetherFrame *f, long double *x, long double *scratch);

/* Converts a generator affine in y to one affine in q, in place, unless it stays: the columns behind the first of `shown`. The shift is 0 where it
 * does not stay. scratch is [2*n]. */
void frame_generator_back(const NoetherFrame *f, long double *shown, long double *scratch);

#endif
