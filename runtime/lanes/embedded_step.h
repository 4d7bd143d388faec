/* A step of one explicit Runge-Kutta method over lanes. embedded_lanes.h includes this file for each
 * method, behind its EMBEDDED_ID, EMBEDDED_STAGES and, of a pair, EMBEDDED_ERRORS. */
#define EMBEDDED_OF(name) EMBEDDED_PASTE(EMBEDDED_ID, name)
#define EMBEDDED_PASTE(id, name) EMBEDDED_PASTED(id, name)
#define EMBEDDED_PASTED(id, name) id##_##name
#define EMBEDDED_NAME(id) EMBEDDED_NAMED(id)
#define EMBEDDED_NAMED(id) #id

/* y1, comp1 and the stages but the last, of n components. Returns the lanes where the model fails. */
LAG_INLINE LaneMask EMBEDDED_OF(lane_stages)(int n, EmbeddedLanes *b, Lanes h) {
  const Lanes t = b->pb.t, *const y = b->y0;
  Lanes *const x = b->ys, (*const k)[n] = (Lanes (*)[n])(void *)b->k;
  int status = 0;
  EMBEDDED_STAGES
  return lane_mask((unsigned)-status);
}

#ifdef EMBEDDED_ERRORS
/* Squared norms of the errors. */
LAG_INLINE Lanes EMBEDDED_OF(lane_errors)(int n, const EmbeddedLanes *b, Lanes h) {
  const Lanes *const y = b->y0, *const x = b->y1, (*const k)[n] = (const Lanes (*)[n])(const void *)b->k;
  Lanes square[2] = {{0}, {0}}, even[2] = {{0}, {0}};
  LAG_SQUARES(EMBEDDED_ERRORS)
  return lag_squared_error(square, b->pair->late, h, b->per);
}
#endif

LAG_INLINE LaneMask EMBEDDED_OF(lane_step)(int n, EmbeddedLanes *b, LaneMask busy, LaneMask *bad) {
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
  *bad |= EMBEDDED_OF(lane_stages)(n, b, dt) | lane_rates(pb, end, b->y1, b->k + last * n);
  Lanes err2 = none;
#ifdef EMBEDDED_ERRORS
  err2 = EMBEDDED_OF(lane_errors)(n, b, dt);
#endif
  LaneMask taken = busy & ~*bad & (err2 <= lane_all(1));
  *bad |= (err2 != err2) | (taken & (lane_not_finite(n, b->y1) | lane_not_finite(n, b->k + last * n)));
  *bad &= busy;
  taken &= ~*bad;
  if (!(b->h_fixed > 0)) embedded_lane_sizes(b, h, err2, taken, busy);
  for (int i = 0; i < n; i++) {
    pb->y[i] = lane_select(taken, b->y1[i], pb->y[i]);
    b->comp[i] = lane_select(taken, b->comp1[i], b->comp[i]);
  }
  b->fresh = lane_select_mask(busy, taken, b->fresh);
  b->again = busy & ~taken;
  b->tc = lane_select(taken, tc, b->tc);
  b->dt = lane_select(taken, dt, b->dt);
  lane_moved(pb, taken, end);
  return taken;
}

static LaneMask EMBEDDED_OF(step)(void *batch, LaneMask busy, LaneMask *bad) {
  EmbeddedLanes *b = batch;
  switch (b->pb.n) { /* numbers of components that the compiler knows */
  case 2: return EMBEDDED_OF(lane_step)(2, b, busy, bad);
  case 4: return EMBEDDED_OF(lane_step)(4, b, busy, bad);
  case 6: return EMBEDDED_OF(lane_step)(6, b, busy, bad);
  default: return EMBEDDED_OF(lane_step)(b->pb.n, b, busy, bad);
  }
}

static unsigned EMBEDDED_OF(advance)(void *batch, unsigned busy, unsigned *bad) {
  return lane_advance(batch, busy, bad, EMBEDDED_OF(step));
}

static const LaneKernel EMBEDDED_OF(kernel) = {EMBEDDED_NAME(EMBEDDED_ID), embedded_open, lane_close, embedded_load,
                                              EMBEDDED_OF(advance), embedded_store, embedded_aim};

#undef EMBEDDED_ID
#undef EMBEDDED_STAGES
#undef EMBEDDED_ERRORS
#undef EMBEDDED_OF
#undef EMBEDDED_PASTE
#undef EMBEDDED_PASTED
#undef EMBEDDED_NAME
#undef EMBEDDED_NAMED
