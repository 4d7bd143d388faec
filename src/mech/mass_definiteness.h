/* Proof that the mass matrix is positive definite where it is regular: then elimination needs no pivoting, in any
 * order. */
#pragma once

#include "mech/eqns.h"

/* 1: proved from the declared signs of parameters. Each term of L is linear in velocities, free of them, or
 * nonnegative, products u*v of velocities being bounded by the squares of u and v in L. s: any form of the linear
 * system. */
int mass_is_definite(const Eqns *e, const LinearSystem *s, Expr lagrangian);

/* The same if parameters without a declared sign have that of their value in the scene. Other values are caught by
 * the pivots in a run. */
int mass_is_definite_by_values(const Eqns *e, const LinearSystem *s, Expr lagrangian);

/* Warns of diagonal entries of M, made of parameters alone, that the scene's values make negative or zero. */
void mass_warn_nonpositive(const Eqns *e);

/* e->sizes: sizes of the model, and diagonal entries of M made of parameters alone that the scene's values make
 * positive, as others must. */
void sizes_find(Eqns *e);

/* 0, reported: the mass matrix is singular at the start of a scene without constraints, and no acceleration follows
 * there. */
int mass_regular_at_start(const Eqns *e);
