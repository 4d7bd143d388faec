/* taylor over lanes: the steps of methods/taylor.c, whose comments say why, of several runs at once. A lane whose
 * step is rejected keeps its series while the others go on. */
#pragma once

#include "lanes/lane_vectors.h"
#include "methods/taylor.h"

typedef struct TaylorLanes {
  LaneProblem pb;
  const lag_taylor *ty;
  int order, columns, width, now;      /* now: the series of the next step; the other one is of the last step */
  double reach, h_max;
  LaneMask again;                      /* the last step was rejected; h is the next to try */
  Lanes h, last, noise, unit, unit_last, dt;
  Lanes *x[2], *comp, *y1, *comp1, *sum, *slope, *scale, *floor, *follows;
} TaylorLanes;

static void *taylor_open(const lag_sim *like, const void *model) {
  const lag_taylor *ty = like->pb.model->taylor;
  size_t series = (size_t)((ty->order + 1) * ty->columns), n = (size_t)like->pb.n, width = (size_t)ty->width;
  TaylorLanes *b = NULL;
  LaneRoom room;
  size_t head = (sizeof *b + sizeof(Lanes) - 1) / sizeof(Lanes), nu = (size_t)like->pb.model->nu;
  if (!lane_room(&room, head + lane_problem_size(like, model) + 2 * series + 5 * n + 2 * width + nu)) return NULL;
  b = (TaylorLanes *)(void *)lane_take(&room, head);
  for (int i = 0; i < 2; i++) b->x[i] = lane_take(&room, series);
  Lanes **const parts[] = {&b->comp, &b->y1, &b->comp1, &b->scale, &b->floor};
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) *parts[i] = lane_take(&room, n);
  b->sum = lane_take(&room, width);
  b->slope = lane_take(&room, width);
  b->follows = lane_take(&room, nu);
  lane_problem_init(&b->pb, &room, like, model);
  b->ty = b->pb.model->taylor;
  b->columns = ty->columns;
  b->width = ty->width;
  return b;
}

static int taylor_load(void *batch, int lane, lag_sim *s, int pause) {
  TaylorLanes *b = batch;
  Taylor *w = (Taylor *)(void *)s->method_work;
  int rc = lag_taylor_prepare(w, &s->pb, s->run->t, s->y);
  if (rc) return rc;
  lane_problem_load(&b->pb, lane, s, pause, w->limits.t_begin);
  b->order = (int)w->order;
  b->reach = w->reach;
  for (int i = 0; i < s->pb.n; i++) b->floor[i][lane] = lag_tolerance_floor(&w->limits, &s->pb, i);
  b->h_max = w->limits.h_max;
  b->again[lane] = 0;
  b->last[lane] = HUGE_VAL;
  b->noise[lane] = w->noise;
  b->unit[lane] = w->unit[w->now > 0];
  lane_put(s->pb.n, b->comp, lane, lag_taylor_array(w, &s->pb, TAYLOR_COMP));
  lane_put(s->pb.model->nu, b->follows, lane, lag_taylor_follows(w, &s->pb));
  lane_put((b->order + 1) * b->columns, b->x[b->now], lane, lag_taylor_series(w, &s->pb, w->now));
  return LAG_OK;
}

static void taylor_store(void *batch, int lane, lag_sim *s) {
  TaylorLanes *b = batch;
  Taylor *w = (Taylor *)(void *)s->method_work;
  int all = (b->order + 1) * b->columns;
  lane_problem_store(&b->pb, lane, s);
  lane_get(all, b->x[b->now], lane, lag_taylor_series(w, &s->pb, 0));
  lane_get(all, b->x[1 - b->now], lane, lag_taylor_series(w, &s->pb, 1));
  lane_get(s->pb.n, b->comp, lane, lag_taylor_array(w, &s->pb, TAYLOR_COMP));
  w->ready = 1;
  w->now = 0;
  w->t0 = b->pb.t0[lane];
  w->dt = b->dt[lane];
  w->unit[0] = b->unit[lane];
  w->unit[1] = b->unit_last[lane];
  w->noise = b->noise[lane];
  b->pb.steps[lane] = 0;
}

static int taylor_aim(void *batch, int lane, const lag_sim *s) {
  ((TaylorLanes *)batch)->pb.to[lane] = s->outside.to;
  return ((const Taylor *)(const void *)s->method_work)->ready != 0.0;
}

/* Instance of kernels/taylor_step.h. */
#define LAG_SERIES_MODEL TaylorLanes *b
#define LAG_SERIES_FLOOR(i) b->floor[i]
#define LAG_SERIES_BEGIN(t, y, x) taylor_first(b, t, y, x)
#define LAG_SERIES_REST(order, unit, x) b->ty->rest(b->ty, order, unit, x, b->pb.work)
#define LAG_SERIES_AT(order, s, x, sum, slope) b->ty->at(b->ty, order, s, x, sum, slope)
LAG_INLINE int taylor_first(TaylorLanes *b, Lanes t, const Lanes *y, Lanes *x) {
  LaneProblem *pb = &b->pb;
  int rc = lane_inputs(pb, t);
  rc = rc ? 1 : b->ty->first(b->ty, t, y, y + pb->nq, y + 2 * pb->nq, pb->p, pb->u, b->follows, x, pb->work);
  unsigned lost = (unsigned)lag_lanes_bits(lane_not_finite(pb->nq + pb->nz, x + pb->n));
  return -(int)(lost | (rc > 0 ? (1u << LAG_LANES) - 1 : (unsigned)-rc));
}
#include "kernels/taylor_step.h"

/* Sizes of steps by the root test, or those of tries after a rejected one. */
LAG_INLINE Lanes taylor_sizes(TaylorLanes *b, const lag_taylor_frame *f) {
  Lanes none = lane_all(0), seen = lane_abs(b->pb.t - b->pb.t_begin);
  Lanes most = b->h_max > 0 ? lane_all(b->h_max) : lane_select(seen > none, seen, lane_all(HUGE_VAL));
  Lanes h = lag_taylor_size(b, f, b->pb.y, lane_abs(b->unit), lane_all(b->reach), most);
  return lane_select(b->again, b->h, h);
}

/* Lanes other than those in `taken` get back the series of before. */
static void taylor_keep(TaylorLanes *b, LaneMask taken) {
  const Lanes *was = b->x[b->now];
  Lanes *x = b->x[1 - b->now];
  for (int i = 0; i < (b->order + 1) * b->columns; i++) x[i] = lane_select(taken, x[i], was[i]);
}

static void taylor_reject(TaylorLanes *b, LaneMask lanes, Lanes h, Lanes error) {
  b->again |= lanes;
  b->last = lane_select(lanes, error, b->last);
  b->h = lane_select(lanes, h * lag_taylor_shrinkage(b->order, error), b->h);
}

/* A step of each lane of `busy`, of n components. Returns those accepted; *bad: those left to taylor.c. */
LAG_INLINE LaneMask taylor_lane_step(int n, TaylorLanes *b, LaneMask busy, LaneMask *bad) {
  LaneProblem *pb = &b->pb;
  Lanes *const now = b->x[b->now], *const next = b->x[1 - b->now], error;
  const lag_taylor_frame f = {b->order, b->columns, pb->nq, n - 2 * pb->nq, now, next, b->sum, b->slope, b->scale,
                              b->comp, b->y1, b->comp1};
  Lanes h = taylor_sizes(b, &f), end = pb->t + lane_all(pb->dir) * h, dt = end - pb->t;
  Lanes unit = lane_all(pb->dir) * lag_power_below(dt);
  *bad = ~((lane_abs(dt) > lane_all(4 * DBL_EPSILON) * lane_abs(pb->t)) & (h >= lane_all(DBL_MIN / DBL_EPSILON)));
  *bad |= lag_failed(lag_taylor_try(b, &f, pb->y, b->unit, end, dt, &error));
  error /= lane_all(pb->tol);
  LaneMask taken = lag_taylor_takes(busy & ~*bad, error, b->last, &b->noise);
  b->ty->rest(b->ty, b->order, unit, next, pb->work);
  *bad = busy & (*bad | (taken & lane_not_finite(n, next + b->order * b->columns)));
  LaneMask rejected = busy & ~taken & ~*bad;
  if (lag_lanes_any(~taken)) taylor_keep(b, taken);
  if (lag_lanes_any(rejected)) taylor_reject(b, rejected, h, error);
  pb->from = b->x[b->now]; /* order 0 of the last series is the state there */
  b->now = 1 - b->now;
  for (int i = 0; i < n; i++) {
    pb->y[i] = lane_select(taken, b->y1[i], pb->y[i]);
    b->comp[i] = lane_select(taken, b->comp1[i], b->comp[i]);
  }
  b->unit_last = lane_select(taken, b->unit, b->unit_last);
  b->unit = lane_select(taken, unit, b->unit);
  b->dt = lane_select(taken, dt, b->dt);
  lane_moved(pb, taken, end);
  b->again &= ~taken;
  b->last = lane_select(taken, lane_all(HUGE_VAL), b->last);
  return taken;
}

static LaneMask taylor_step(void *batch, LaneMask busy, LaneMask *bad) {
  TaylorLanes *b = batch;
  switch (b->pb.n) { /* numbers of components that the compiler knows */
  case 2: return taylor_lane_step(2, b, busy, bad);
  case 4: return taylor_lane_step(4, b, busy, bad);
  case 6: return taylor_lane_step(6, b, busy, bad);
  default: return taylor_lane_step(b->pb.n, b, busy, bad);
  }
}

static unsigned taylor_advance(void *batch, unsigned busy, unsigned *bad) {
  return lane_advance(batch, busy, bad, taylor_step);
}

LANE_KERNEL(taylor, taylor)
