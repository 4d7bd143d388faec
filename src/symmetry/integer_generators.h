/* Generators xi by M xi: where the mass matrix M is made of numbers and not diagonal, and L is not written with sums in which it is, coefficients
 * of xi are quotients by determinants of M, with twenty digits; those of M xi, with which charges are made, are as short as L's. */
#ifndef LAGC_SYMMETRY_INTEGER_GENERATORS_H
#define LAGC_SYMMETRY_INTEGER_GENERATORS_H

#include "base/dense.h"
#include "symmetry/determining_equations.h"

/* M [n*n] as exact numbers. NULL: M is not made of numbers, or diagonal; p is not M q'; there are constraints; the ansatz is restricted, or made
 * in other coordinates. */
const Num *exact_mass(Arena *a, const Ansatz *s);

/* Short integer rows of M xi for a space of rows xi, [blocks*shown] each as in a table; they may span a part of it. to[space->n]: coefficients of
 * M xi, as expressions; value[space->n]: those of xi. Returns their number. */
uint32_t integer_generators(Arena *a, const Ansatz *s, const Num *M, const DenseRows *space, Expr **to, long double **value);

/* Converts coefficients of M xi to those of xi, in place. 0: numbers are too long. */
int raise_generator(Arena *a, const Ansatz *s, const Num *M, uint32_t blocks, Expr *c);

#endif
