/* The mistake that explains how a function by hand differs from the equations of motion: order or choice of its
 * arguments, or one term. */
#pragma once

#include "claims/monomial_fit.h"
#include "claims/sample_points.h"

enum { DIFFERENCE_STATES = FEATURE_STATES };

typedef struct {
  SamplePoints *points;
  const uint32_t *map; /* component of y at each place of the function's y */
  uint32_t n;          /* number of states */
  long double *state[DIFFERENCE_STATES];      /* by symbol */
  long double *rate[DIFFERENCE_STATES];       /* dydt of the function, by component of y */
  long double *difference[DIFFERENCE_STATES]; /* dydt less the derived one, */
  long double *bound[DIFFERENCE_STATES];      /* and how much of it rounding explains */
} DifferenceData;

/* The mistake, as the rest of a sentence about the function; NULL: none was found. */
const char *difference_cause(const Eqns *e, const DifferenceData *d);
