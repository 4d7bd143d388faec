/* A step of explicit Runge-Kutta method `id` over lanes, by EMBEDDED_STAGES and EMBEDDED_ERRORS of embedded_lanes.h. */
#pragma once

/* y1, comp1 and the stages but the last, of n components. Returns the lanes where the model fails. */
LAG_INLINE LaneMask embedded_lane_stages(int id, int n, EmbeddedLanes *b, Lanes h) {
  const Lanes t = b->pb.t, *const y = b->y0;
  Lanes *const x = b->ys, (*const k)[n] = (Lanes (*)[n])(void *)b->k;
  int status = 0;
  EMBEDDED_STAGES
  return lane_mask((unsigned)-status);
}

/* Squared norms of the errors. */
LAG_INLINE Lanes embedded_lane_errors(int id, int n, const EmbeddedLanes *b, Lanes h) {
  const Lanes *const y = b->y0, *const x = b->y1, (*const k)[n] = (const Lanes (*)[n])(const void *)b->k;
  Lanes square[2] = {{0}, {0}}, even[2] = {{0}, {0}};
  LAG_SQUARES(EMBEDDED_ERRORS)
  return lag_squared_error(square[0], square[1], b->pair->late, h, b->per);
}

LAG_INLINE LaneMask embedded_lane_step(int id, int n, EmbeddedLanes *b, LaneMask busy, LaneMask *bad) {
  LaneProblem *pb = &b->pb;
  int last = b->pair->tab->stages - 1;
  for (int i = 0; i < n; i++) {
    b->k[i] = lane_select(b->fresh, b->k[last * n + i], b->k[i]);
    b->y0[i] = pb->y[i];
  }
  Lanes seen = lane_abs(pb->t - pb->t_begin), none = lane_all(0);
  Lanes most = b->h_max > 0 ? lane_all(b->h_max) : lane_select(seen > none, seen, lane_all(HUGE_VAL));
  if (b->longest > 0) most = lane_min(most, lane_all(b->longest));
  Lanes h = b->h_fixed > 0 ? lane_all(b->h_fixed) : lane_min(b->h, most);
  Lanes dt = lane_all(pb->dir) * h, tc = b->tc, end = lag_compensated_sum(pb->t, dt, &tc);
  *bad = (h <= lane_all(4 * DBL_EPSILON) * lane_abs(pb->t)) | (h < lane_all(DBL_MIN / DBL_EPSILON));
  *bad |= embedded_lane_stages(id, n, b, dt) | lane_rates(pb, end, b->y1, b->k + last * n);
  Lanes err2 = b->pair->control.order > 0 ? embedded_lane_errors(id, n, b, dt) : none;
  LaneMask taken = busy & ~*bad & (err2 <= lane_all(1));
  *bad |= (err2 != err2) | (taken & (lane_not_finite(n, b->y1) | lane_not_finite(n, b->k + last * n)));
  *bad &= busy;
  taken &= ~*bad;
  const lag_aimed now = {.wanted = h, .h = h};
  if (!(b->h_fixed > 0)) lag_next_size(&b->pair->control, &now, err2, taken, busy, &b->h, &b->err_power);
  for (int i = 0; i < n; i++) {
    pb->y[i] = lane_select(taken, b->y1[i], pb->y[i]);
    b->comp[i] = lane_select(taken, b->comp1[i], b->comp[i]);
  }
  b->fresh = lane_select_mask(busy, taken, b->fresh);
  b->tc = lane_select(taken, tc, b->tc);
  b->dt = lane_select(taken, dt, b->dt);
  lane_moved(pb, taken, end);
  return taken;
}

LAG_INLINE LaneMask embedded_step(int id, void *batch, LaneMask busy, LaneMask *bad) {
  EmbeddedLanes *b = batch;
  switch (b->pb.n) { /* numbers of components that the compiler knows */
  case 2: return embedded_lane_step(id, 2, b, busy, bad);
  case 4: return embedded_lane_step(id, 4, b, busy, bad);
  case 6: return embedded_lane_step(id, 6, b, busy, bad);
  default: return embedded_lane_step(id, b->pb.n, b, busy, bad);
  }
}

#define EMBEDDED_KERNEL(name, NAME, kind, dense, order, line, words)                                       \
  static LaneMask name##_step(void *batch, LaneMask busy, LaneMask *bad) {                                 \
    return embedded_step(ID_##name, batch, busy, bad);                                                     \
  }                                                                                                        \
  static unsigned name##_advance(void *batch, unsigned busy, unsigned *bad) {                              \
    return lane_advance(batch, busy, bad, name##_step);                                                    \
  }                                                                                                        \
  static const LaneKernel name##_kernel = {#name,         embedded_open,  lane_close,  embedded_load,      \
                                           name##_advance, embedded_store, embedded_aim};
