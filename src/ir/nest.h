/* Nests of loops for sums over pairs, sites or bodies.
 *
 * The search is one for connected components of a program's graph, so that bodies written out by hand are found as a family is. Hubs are
 * sums of many terms, and values with many users; without hubs the graph falls into pieces, one for each pair of bodies. Pieces that
 * differ only in the array elements that they read and the sums that they add to are a group. Where these indices are affine in two
 * counters, or go by tables, a group becomes a Nest (ir/prog.h) of the size of one piece. */
#ifndef LAGC_NEST_H
#define LAGC_NEST_H

#include "ir/prog.h"

/* The program with nests; p itself where there are none, p has fewer than `from` instructions, or it has solves. Needs a tidy
 * program and leaves one; adds sums in another order. */
Prog *prog_find_nests(Prog *p, uint32_t from);

/* The shorter of the nests of a program before and after prog_factor, which may make rows alike, or break up sums of single pieces.
 * `factored` itself where neither has nests. */
Prog *prog_find_shorter_nests(Prog *factored, Prog *tidy, uint32_t from);

#endif
