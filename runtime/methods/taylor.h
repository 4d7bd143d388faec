/* Saved state of taylor, for taylor.c and for its steps over lanes (lanes/taylor_lanes.h). */
#pragma once

#include "methods/step_control.h" /* lag_rough_power */


/* Saved state of the method, doubles only; x holds the arrays named below. */
typedef struct Taylor {
  double order, reach; /* reach: r h of item 1 above */
  lag_step_limits limits;
  double ready;     /* 1: series[now] is expanded at t, y */
  double now;       /* 0 or 1: series of the next step; the other one is of the last step */
  double t0, dt;    /* the last step */
  double unit[2];   /* signed unit of time of each series */
  double noise;     /* defect found to be rounding, in tolerances; decays by a tenth a step */
  double tc;        /* fixed steps: compensation of t */
  double x[];
} Taylor;

/* arrays of `width` doubles; the two series follow */
enum { TAYLOR_COMP, TAYLOR_COMP1, TAYLOR_Y1, TAYLOR_SUM, TAYLOR_SLOPE, TAYLOR_SCALE, TAYLOR_ARRAYS };

static inline int lag_taylor_width(const lag_problem *pb) { return pb->model->taylor->width; }

static inline double *lag_taylor_array(Taylor *w, const lag_problem *pb, int which) {
  return w->x + which * lag_taylor_width(pb);
}

/* Series 0 or 1: (order + 1) rows of `columns` doubles. */
static inline double *lag_taylor_series(Taylor *w, const lag_problem *pb, double which) {
  const lag_taylor *ty = pb->model->taylor;
  return w->x + TAYLOR_ARRAYS * ty->width + (which > 0 ? (ty->order + 1) * ty->columns : 0);
}

/* [nu] 1 where the input is given by its formula, not held constant. */
static inline double *lag_taylor_follows(Taylor *w, const lag_problem *pb) {
  const lag_taylor *ty = pb->model->taylor;
  return w->x + TAYLOR_ARRAYS * ty->width + 2 * (ty->order + 1) * ty->columns;
}

/* Before a step at t, y: the series there, where none is known (at the start, and after an event). LAG_OK, or a
 * failure. */
int lag_taylor_prepare(Taylor *w, lag_problem *pb, double t, const double *y);
