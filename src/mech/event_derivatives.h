/* Eqns -> the derivatives of events. */
#ifndef LAGC_MECH_EVENT_DERIVATIVES_H
#define LAGC_MECH_EVENT_DERIVATIVES_H

#include "mech/eqns.h"

/* What an event does to small changes of the state: derivatives of its function (row < 0: of g) and of the values that its actions give
 * (row: the component of [q|v|z] that they are given to), by components of the state, and by the time (col 2 n + states).
 * Of g those that are not zero; of a value, those, and that by its own component, so that each row that is set is there.
 * An event that depends on an input has none: what the input is, is for the runtime to say. */
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
