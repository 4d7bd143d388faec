/* Sums over pairs, sites, bodies: what many turns of one computation add to long sums becomes loops inside loops.
 *
 * The search is one for components of a graph, in the program and nowhere else: bodies that a user wrote out by hand are found as
 * a family is. Sums of many terms, and values that many use, are hubs: without them the program falls into pieces, one for each
 * pair of bodies. Pieces that compute the same but for the elements of arrays that they read and the sums that they add to are a
 * group; where these indices are affine in two counters, a group is a Nest (ir/prog.h), and its size that of one piece. */
#ifndef LAGC_NEST_H
#define LAGC_NEST_H

#include "ir/prog.h"

/* The same program with its nests, or p itself where there are none, or it has fewer than `from` instructions. Needs a tidy
 * program, and leaves one; sums are added up in another order. Programs with solves stay what they are. */
Prog *prog_nest(Prog *p, uint32_t from);

/* The shorter one of nests of the same program before and after prog_factor: what is factored may be a sum that some pieces have to
 * themselves, or what makes rows alike. The factored one where there are none. */
Prog *prog_nest_either(Prog *factored, Prog *tidy, uint32_t from);

#endif
