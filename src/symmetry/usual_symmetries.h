/* Symmetries of models too large for the linear equations of the search: usual generators are tried one by one. */
#ifndef LAGC_SYMMETRY_USUAL_SYMMETRIES_H
#define LAGC_SYMMETRY_USUAL_SYMMETRIES_H

#include "symmetry/found_symmetry.h"

/* Whether the model is too large for the full search. */
int too_large_to_search(const Eqns *e);

/* Tries the energy, momenta of cyclic coordinates, and translations, boosts and turns of all coordinates of a kind together: x, y, z of vectors,
 * members of a family. Past a thousand coordinates nothing is tried, and out->searched is 0. */
void try_usual_symmetries(Eqns *e, FoundSymmetries *out);

#endif
