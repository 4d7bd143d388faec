/* Explicit Runge-Kutta methods over lanes: the steps of methods/adaptive_rk.c, whose comments say why, of several runs at once. A lane whose step is rejected
 * tries a shorter one in the next turn. */
#pragma once

#include "lanes/lane_vectors.h"
#include "methods/adaptive_rk.h"

typedef struct EmbeddedLanes {
  LaneProblem pb;
  const EmbeddedPair *pair;
  double per, h_max, h_fixed, longest; /* h_fixed > 0: all steps have this size */
  LaneMask fresh, again; /* the last stage is the first of this step; the last step was rejected */
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
  b->fresh[lane] = b->again[lane] = 0;
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
  for (int j = 0; j < b->pair->tab->stages; j++) lane_get(n, b->k + j * n, lane, lag_adaptive_rk_array(w, &s->pb, EMBEDDED_K1 + j));
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

/* out[n] := sum_j coef[j] k_j over j < count. */
LAG_INLINE void embedded_lane_sum(int n, const double *coef, int count, const Lanes *k, Lanes *out) {
  for (int i = 0; i < n; i++) out[i] = lane_all(coef[0]) * k[i];
  for (int j = 1; j < count; j++) {
    if (coef[j] == 0.0) continue;
    const Lanes c = lane_all(coef[j]), *const kj = k + j * n;
    for (int i = 0; i < n; i++) out[i] += c * kj[i];
  }
}

/* y1, comp1 and the stages but the last, of n components. Returns the lanes where the model fails. */
LAG_INLINE LaneMask embedded_lane_stages(int n, EmbeddedLanes *b, Lanes dt) {
  const lag_tableau *tab = b->pair->tab;
  int last = tab->stages - 1;
  Lanes sum[n], *k = b->k, *ys = b->ys;
  LaneMask bad = {0};
  for (int s = 1; s < last; s++) {
    Lanes newest = dt * lane_all(tab->a[s][s - 1]);
    if (s > 1) embedded_lane_sum(n, tab->a[s], s - 1, k, sum);
    for (int i = 0; i < n; i++) ys[i] = (s > 1 ? b->y0[i] + dt * sum[i] : b->y0[i]) + newest * k[(s - 1) * n + i];
    bad |= lane_rates(&b->pb, b->pb.t + lane_all(tab->c[s]) * dt, ys, k + s * n);
  }
  embedded_lane_sum(n, tab->a[last], last - 1, k, sum);
  for (int i = 0; i < n; i++) {
    b->comp1[i] = b->comp[i];
    b->y1[i] = lag_compensated_sum(b->y0[i], dt * (sum[i] + lane_all(tab->a[last][last - 1]) * k[(last - 1) * n + i]), &b->comp1[i]);
  }
  return bad;
}

/* Squared norms of the errors. */
LAG_INLINE Lanes embedded_lane_errors(int n, EmbeddedLanes *b, Lanes dt) {
  const EmbeddedPair *pair = b->pair;
  const lag_tableau *tab = pair->tab;
  Lanes fine = lane_all(0), coarse = fine, e[n + 1], e3[n + 1];
  embedded_lane_sum(n, tab->e, tab->stages - pair->late, b->k, e);
  if (pair->late) embedded_lane_sum(n, tab->e3, tab->stages - 1, b->k, e3);
  for (int i = 0; i < n; i++) {
    Lanes a = lane_abs(b->y0[i]), c = lane_abs(b->y1[i]), scale = lane_all(b->pb.tol) * b->floor[i] + lane_all(b->pb.tol) * lane_max(a, c), per = lane_all(1) / scale;
    e[i] = per * e[i];
    e3[i] = pair->late ? per * e3[i] : lane_all(0);
  }
  e[n] = e3[n] = lane_all(0);
  for (int i = 0; i < n; i += 2) {
    fine += e[i] * e[i] + e[i + 1] * e[i + 1];
    if (pair->late) coarse += e3[i] * e3[i] + e3[i + 1] * e3[i + 1];
  }
  fine *= dt * dt * lane_all(b->per);
  coarse *= lane_all(0.01) * dt * dt * lane_all(b->per);
  Lanes both = fine + coarse;
  return pair->late ? lane_select(both > lane_all(0), fine * (fine / both), both * lane_all(0)) : fine + both * lane_all(0);
}

/* The sizes of the next steps of the lanes in `taken`, and of the next tries of others in `busy`. */
static void embedded_lane_sizes(EmbeddedLanes *b, Lanes h, Lanes err2, LaneMask taken, LaneMask busy) {
  const EmbeddedPair *pair = b->pair;
  const double least = 1e-8;
  Lanes known = lag_rough_power(lane_all(least), lane_all(-pair->beta / 2));
  Lanes power = lag_rough_power(lane_max(err2, lane_all(1e-24)), lane_all(-pair->beta / 2)), f = lane_all(pair->safety);
  f /= lane_select(b->err_power > lane_all(0), b->err_power, known);
  for (int i = 0; i < pair->ratio; i++) f *= power;
  Lanes most = lane_select(b->again, lane_all(1), lane_all(pair->grow_most));
  Lanes next = h * lane_max(lane_all(pair->shrink_most), lane_min(most, f));
  Lanes shorter = h * lane_max(lane_all(pair->safety) * lag_rough_power(err2, lane_all(-0.5 * pair->ratio * pair->beta)), lane_all(pair->shrink_most));
  b->h = lane_select(taken, next, lane_select(busy, shorter, b->h));
  b->err_power = lane_select(taken, lane_select(err2 > lane_all(least), power, known), lane_select(busy, lane_all(0), b->err_power));
}

LAG_INLINE LaneMask embedded_lane_step(int n, EmbeddedLanes *b, LaneMask busy, LaneMask *bad) {
  LaneProblem *pb = &b->pb;
  const EmbeddedPair *pair = b->pair;
  int last = pair->tab->stages - 1;
  for (int i = 0; i < n; i++) {
    b->k[i] = lane_select(b->fresh, b->k[last * n + i], b->k[i]);
    b->y0[i] = pb->y[i];
  }
  Lanes seen = lane_abs(pb->t - pb->t_begin), none = lane_all(0);
  Lanes most = b->h_max > 0 ? lane_all(b->h_max) : lane_select(seen > none, seen, lane_all(HUGE_VAL));
  Lanes h = b->h_fixed > 0 ? lane_all(b->h_fixed) : lane_min(b->h, b->longest > 0 ? lane_min(most, lane_all(b->longest)) : most);
  Lanes dt = lane_all(pb->dir) * h, tc = b->tc, end = lag_compensated_sum(pb->t, dt, &tc);
  *bad = (h <= lane_all(4 * DBL_EPSILON) * lane_abs(pb->t)) | (h < lane_all(DBL_MIN / DBL_EPSILON));
  *bad |= embedded_lane_stages(n, b, dt) | lane_rates(pb, end, b->y1, b->k + last * n);
  Lanes err2 = pair->tab->order_embedded ? embedded_lane_errors(n, b, dt) : none;
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

static LaneMask embedded_step(void *batch, LaneMask busy, LaneMask *bad) {
  EmbeddedLanes *b = batch;
  switch (b->pb.n) { /* numbers of components that the compiler knows */
  case 2: return embedded_lane_step(2, b, busy, bad);
  case 4: return embedded_lane_step(4, b, busy, bad);
  case 6: return embedded_lane_step(6, b, busy, bad);
  default: return embedded_lane_step(b->pb.n, b, busy, bad);
  }
}

static unsigned embedded_advance(void *batch, unsigned busy, unsigned *bad) { return lane_advance(batch, busy, bad, embedded_step); }

LANE_KERNEL(dop853, embedded)
LANE_KERNEL(rk45, embedded)
LANE_KERNEL(rk4, embedded)
