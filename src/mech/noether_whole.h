/* Generators xi by M xi, M the mass matrix: where M is made of numbers and not diagonal, and L is not written with sums in which it is, coefficients
 * of xi are quotients by determinants of M, with twenty digits, and those of M xi, with which charges are made, have as few as L has. */
#ifndef LAGC_NOETHER_WHOLE_H
#define LAGC_NOETHER_WHOLE_H

#include "base/dense.h"
#include "mech/noether_search.h"

/* M [n*n]. NULL: it is not made of numbers, or diagonal; p is not M q'; there are constraints; the ansatz leaves entries out, or is made in other
 * coordinates. */
const Num *whole_mass(Arena *a, const Ansatz *s);

/* Short rows of whole numbers that span what they can of the space of rows xi, [blocks*shown] each as in a table: coefficients of M xi, as numbers of
 * g, and those of xi by value. to[space->n], value[space->n]. Returns how many there are. */
uint32_t whole_generators(Arena *a, const Ansatz *s, const Num *M, const DenseRows *space, Expr **to, long double **value);

/* Coefficients of M xi become those of xi. 0: numbers are too long. */
int whole_raise(Arena *a, const Ansatz *s, const Num *M, uint32_t blocks, Expr *c);

#endif
