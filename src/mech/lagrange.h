/* The parts of Lagrange's equations: momenta, mass matrix, forces. */
#ifndef LAGC_LAGRANGE_H
#define LAGC_LAGRANGE_H

#include "mech/eqns.h"

/* Fills e's momenta, forces, mass matrix and the system that is solved. */
void lagrange_momenta_and_forces(Eqns *e);

/* Fills e->squares; after all that is printed, as the order of terms is that in which they were made. */
void lagrange_squares(Eqns *e);

/* The short forms of raw[n] when they cost no more operations together, or raw itself: entry by entry they may be shorter
 * and still lose what they share. */
const Expr *lagrange_short_forms(const Eqns *e, const Expr *raw, uint32_t n);

/* Says why the mass matrix cannot be solved with, in m->diags, and returns 0; 1 when it can. */
int lagrange_check_mass(Eqns *e);

#endif
