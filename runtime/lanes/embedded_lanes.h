/* Explicit Runge-Kutta methods over lanes: the steps of methods/adaptive_rk.c, whose comments say why, of several
 * runs at once. A lane whose step is rejected tries a shorter one in the next turn. */
#pragma once

#include "kernels/steppers.def"
#include "lanes/lane_vectors.h"
#include "methods/adaptive_rk.h"

typedef struct EmbeddedLanes {
  LaneProblem pb;
  const EmbeddedPair *pair;
  double per, h_max, h_fixed, longest; /* h_fixed > 0: all steps have this size */
  LaneMask fresh; /* the last stage is the first of this step */
  Lanes h, err_power, tc, dt;
  Lanes *comp, *comp1, *y0, *y1, *ys, *floor, *k; /* k[stages * n] */
} EmbeddedLanes;

static void *embedded_open(const lag_sim *like, const void *model) {
  const EmbeddedPair *pair = like->pb.variant;
  size_t n = (size_t)like->pb.n, head = (sizeof(EmbeddedLanes) + sizeof(Lanes) - 1) / sizeof(Lanes);
  LaneRoom room;
  if (!lane_room(&room, head + lane_problem_size(like, model) + (6 + (size_t)pair->tab->stages) * n)) return NULL;
  EmbeddedLanes *b = (EmbeddedLanes *)(void *)lane_take(&room, head);
  Lanes **const parts[] = {&b->comp, &b->comp1, &b->y0, &b->y1, &b->ys, &b->floor};
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) *parts[i] = lane_take(&room, n);
  b->k = lane_take(&room, n * (size_t)pair->tab->stages);
  lane_problem_init(&b->pb, &room, like, model);
  b->pb.from = b->y0;
  b->pair = pair;
  return b;
}

static int embedded_load(void *batch, int lane, lag_sim *s, int pause) {
  EmbeddedLanes *b = batch;
  Embedded *w = (Embedded *)(void *)s->method_work;
  int rc = lag_adaptive_rk_prepare(b->pair, w, &s->pb, s->run->t, s->y);
  if (rc) return rc;
  lane_problem_load(&b->pb, lane, s, pause, w->limits.t_begin);
  for (int i = 0; i < s->pb.n; i++) b->floor[i][lane] = lag_tolerance_floor(&w->limits, &s->pb, i);
  b->h_max = w->limits.h_max;
  b->h_fixed = w->limits.fixed != 0.0 ? w->limits.h_option : 0;
  b->per = w->per;
  b->longest = s->pb.longest;
  b->fresh[lane] = 0;
  b->h[lane] = w->h;
  b->err_power[lane] = w->err_power;
  b->tc[lane] = w->tc;
  lane_put(s->pb.n, b->comp, lane, lag_adaptive_rk_array(w, &s->pb, EMBEDDED_COMP));
  lane_put(s->pb.n, b->k, lane, lag_adaptive_rk_array(w, &s->pb, EMBEDDED_K1));
  return LAG_OK;
}

static void embedded_store(void *batch, int lane, lag_sim *s) {
  EmbeddedLanes *b = batch;
  Embedded *w = (Embedded *)(void *)s->method_work;
  int n = s->pb.n;
  lane_problem_store(&b->pb, lane, s);
  lane_get(n, b->comp, lane, lag_adaptive_rk_array(w, &s->pb, EMBEDDED_COMP));
  lane_get(n, b->y0, lane, lag_adaptive_rk_array(w, &s->pb, EMBEDDED_Y0));
  lane_get(n, b->pb.y, lane, lag_adaptive_rk_array(w, &s->pb, EMBEDDED_Y1));
  for (int j = 0; j < b->pair->tab->stages; j++)
    lane_get(n, b->k + j * n, lane, lag_adaptive_rk_array(w, &s->pb, EMBEDDED_K1 + j));
  w->h = b->h[lane];
  w->err_power = b->err_power[lane];
  w->tc = b->tc[lane];
  w->t0 = b->pb.t0[lane];
  w->dt = b->dt[lane];
  w->ready = 2;
  w->have_extra = 0;
  b->pb.steps[lane] = 0;
}

static int embedded_aim(void *batch, int lane, const lag_sim *s) {
  ((EmbeddedLanes *)batch)->pb.to[lane] = s->outside.to;
  return ((const Embedded *)(const void *)s->method_work)->ready != 0.0;
}

/* Instance of kernels/runge_kutta.h. */
LAG_INLINE int embedded_lane_rates(EmbeddedLanes *b, Lanes t, const Lanes *y, Lanes *f) {
  return -lag_lanes_bits(lane_rates(&b->pb, t, y, f));
}

LAG_INLINE void embedded_lane_add(EmbeddedLanes *b, int i, Lanes d) {
  b->comp1[i] = b->comp[i];
  b->y1[i] = lag_compensated_sum(b->y0[i], d, &b->comp1[i]);
}

#define LAG_RATES(t, x, s) embedded_lane_rates(b, t, x, k[s])
#define LAG_ADD(i, d) embedded_lane_add(b, i, d)
#define LAG_ALLOWED(i, size) (lane_all(b->pb.tol) * b->floor[i] + lane_all(b->pb.tol) * (size))
#include "kernels/runge_kutta.h"

/* Methods by number: where it is a constant, compilers leave the others out. */
enum {
#define RK_ID(name, NAME, kind, dense, order, line, words) ID_##name,
  LAG_RUNGE_KUTTA_METHODS(RK_ID)
};
#define RK_STAGES(name, NAME, kind, dense, order, line, words) \
  case ID_##name: { LAG_##NAME##_STAGES LAG_##NAME##_RESULT } break;
#define FIXED_ERRORS(name, NAME)
#define ADAPTIVE_ERRORS(name, NAME) case ID_##name: { LAG_##NAME##_ERRORS } break;
#define LATE_ERRORS ADAPTIVE_ERRORS
#define RK_ERRORS(name, NAME, kind, dense, order, line, words) kind##_ERRORS(name, NAME)
#define EMBEDDED_STAGES switch (id) { LAG_RUNGE_KUTTA_METHODS(RK_STAGES) default: break; }
#define EMBEDDED_ERRORS switch (id) { LAG_RUNGE_KUTTA_METHODS(RK_ERRORS) default: break; }
#include "lanes/embedded_step.h"
LAG_RUNGE_KUTTA_METHODS(EMBEDDED_KERNEL)
