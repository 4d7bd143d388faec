/* Eqns -> the derivatives of events. */
#ifndef LAGC_MECH_EVENT_DERIVATIVES_H
#define LAGC_MECH_EVENT_DERIVATIVES_H

#include "mech/eqns.h"

/* Derivative of an event: of its function g (row < 0) or of the value that an action assigns to component `row` of [q|v|z], by component `col` of
 * the state, or by time (col = 2 n + states). Of g the nonzero ones; of a value also that by its own component, so that each assigned row is there.
 * Events that depend on inputs have none, since the compiler does not know the inputs' values. */
typedef struct {
  uint32_t event;
  int row;
  uint32_t col;
  Expr e;
} EventPartial;

typedef struct {
  const EventPartial *at;
  uint32_t n;
} EventPartials;

EventPartials eqns_event_derivatives(const Eqns *e);

#endif
