/* Elimination order of a sparse linear system.
 *
 * A definition is eliminated after all definitions that contain it; a coordinate after all definitions that contain
 * its velocity, and once its diagonal entry is nonzero. Ties go to the lower number, so that a dense system keeps
 * its order. */
#pragma once

#include "mech/eqns.h"

typedef enum {
  ORDER_CHEAPEST,         /* greedy: the cheapest step first (Markowitz, Management Science 3 (1957) 255; Tinney
                           * & Walker, Proc. IEEE 55 (1967) 1801, scheme 3) */
  /* the definition farthest from the coordinates first, coordinates as soon as possible: from the tips of a tree to
   * its root (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 7.3) */
  ORDER_OUTERMOST,
  /* as ORDER_OUTERMOST, but coordinates coupled with many variables wait: a cart under a chain */
  ORDER_OUTERMOST_HUBS_LAST,
  ORDER_DEFINITIONS_FIRST /* eliminating all definitions leaves the dense mass matrix */
} EliminationRule;

/* Sets s->order and s->ops, the operations of elimination and substitution. Stops with an incomplete order past
 * `enough` operations. */
void elimination_order(Arena *a, ExprGraph *g, LinearSystem *s, EliminationRule rule, uint64_t enough);

/* Sets s->order and s->ops by the cheapest of the first three rules. */
void elimination_order_best(Arena *a, ExprGraph *g, LinearSystem *s);
