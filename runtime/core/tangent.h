/* The tangent of a run at events: for flow_tangent.c and saltation.c. */
#pragma once

#include "core/core.h"

/* Values where an event is met: f and f+, a state, the gradient of the event function and its rate along f,
 * event functions, the function's change by the parameter of each column. */
typedef struct Corner {
  double *before, *after, *there, *gradient, *g, *by;
} Corner;

/* Numbers of the tangent. */
static inline size_t lag_tangent_block(const lag_sim *s) { return (size_t)s->pb.n * (size_t)s->tangent_columns; }

/* Derivatives of events that the model lists. */
static inline int lag_tangent_jumps(const lag_sim *s) {
  const lag_linear *l = s->scene->model->linear;
  return l && l->jumps ? l->njump : 0;
}

/* flow_tangent.c. *slope := change of event function k along component i of the state, or of t for i = n, by central
 * differences of order 4. A status. */
int lag_event_slope(lag_sim *s, const Corner *w, int k, int i, double *slope);

/* flow_tangent.c. Whether event k only touches zero: its rate there is negligible relative to its values at the ends of
 * the step. */
int lag_event_touches(lag_sim *s, int k, double rate);
