/* The order in which a linear system is eliminated.
 *
 * A definition goes after all that contain it; a coordinate after all definitions that contain its
 * velocity, and when it has a pivot. Ties go to the lower number, so that a dense system keeps its order. */
#ifndef LAGC_ORDER_H
#define LAGC_ORDER_H

#include "mech/eqns.h"

typedef enum {
  ORDER_CHEAPEST,         /* greedy: the cheapest step first (Markowitz, Management Science 3 (1957) 255; Tinney
                           * & Walker, Proc. IEEE 55 (1967) 1801, scheme 3) */
  ORDER_OUTERMOST,        /* the definition farthest from the coordinates first, these as soon as they can: from the
                           * tips of a tree to its root (Featherstone, Rigid Body Dynamics Algorithms, 2008, section 7.3) */
  ORDER_OUTERMOST_HUBS_LAST, /* the same, but coordinates that are coupled with many variables wait: a cart under a chain */
  ORDER_DEFINITIONS_FIRST /* which makes the mass matrix */
} OrderRule;

/* Sets s->order and s->ops, the operations of elimination and substitution. Gives up, with an
 * incomplete order, when more than `enough` operations have come together. */
void order_elimination(Arena *a, ExprGraph *g, LinearSystem *s, OrderRule rule, uint64_t enough);

/* The best of the first three rules. */
void order_best(Arena *a, ExprGraph *g, LinearSystem *s);

#endif
