/* The Kepler part of a Lagrangian, L = sum of m |v|^2/2 + sum of k/|r_i - r_j| or k/|r| + the rest: what a splitting
 * method solves in closed form. Found by the symbols of L; sums over pairs stay sums. */
#pragma once

#include "mech/eqns.h"

typedef struct {
  uint32_t bodies, dim;   /* dim: 2 or 3 */
  int fixed;              /* the bodies move about a centre at the origin; else about one of them */
  const uint32_t *at;     /* [bodies*dim] coordinates */
  const Expr *mass;       /* [bodies] */
  /* [bodies] the sum of k_ij s_j over the other bodies j, s_j being the first coordinate of body j; and with a fixed
   * centre k of the body */
  const Expr *coupling;
} KeplerPart;

/* NULL: found; else why L has none, the end of a sentence. */
const char *kepler_part(const Eqns *e, KeplerPart *out);
