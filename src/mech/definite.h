/* Whether the mass matrix is positive definite where it is regular: then no order of elimination needs pivoting. */
#ifndef LAGC_DEFINITE_H
#define LAGC_DEFINITE_H

#include "mech/eqns.h"

/* L is a sum of terms that are linear in velocities, free of them, or never negative; by the signs that parameters declare, and
 * products u*v of velocities by the squares beside them. s is any form of the system. */
int mass_is_definite(const Eqns *e, const LinearSystem *s, Expr lagrangian);

/* The same with parameters that declare no sign taken for what their values in the scene are: pivots tell where others break it. */
int mass_is_definite_by_values(const Eqns *e, const LinearSystem *s, Expr lagrangian);

/* Warns of parameters whose values in the scene are not positive and make an entry of the diagonal of M, of parameters alone, negative or zero. */
void mass_warn(const Eqns *e);

#endif
