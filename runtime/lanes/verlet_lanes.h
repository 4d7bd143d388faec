/* The Verlet family over lanes, for models whose accelerations depend on t and q only:
 * kernels/splitting.h over vectors. */
#pragma once

#include "kernels/steppers.def"
#include "lanes/lane_vectors.h"
#include "methods/verlet.h"

typedef struct VerletLanes {
  LaneProblem pb;
  const lag_composition *c;
  double h;
  Lanes tc;
  Lanes *f0, *f1, *y0, *y1, *dy, *comp, *comp1;
} VerletLanes;

static void *verlet_open(const lag_sim *like, const void *model) {
  size_t n = (size_t)like->pb.n, head = (sizeof(VerletLanes) + sizeof(Lanes) - 1) / sizeof(Lanes);
  LaneRoom room;
  if (!lane_room(&room, head + lane_problem_size(like, model) + 7 * n)) return NULL;
  VerletLanes *b = (VerletLanes *)(void *)lane_take(&room, head);
  Lanes **const parts[] = {&b->f0, &b->f1, &b->y0, &b->y1, &b->dy, &b->comp, &b->comp1};
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) *parts[i] = lane_take(&room, n);
  lane_problem_init(&b->pb, &room, like, model);
  b->pb.from = b->y0;
  b->c = ((const VerletMember *)like->pb.variant)->separable;
  return b;
}

static int verlet_load(void *batch, int lane, lag_sim *s, int pause) {
  VerletLanes *b = batch;
  Verlet *w = (Verlet *)(void *)s->method_work;
  int n = s->pb.n, rc = w->ready == 0.0 ? lag_step_rhs(&s->pb, s->run->t, s->y, w->x + VERLET_F1 * n) : LAG_OK;
  if (rc) return rc;
  lane_problem_load(&b->pb, lane, s, pause, s->run->t);
  b->h = w->step.h;
  b->tc[lane] = w->step.tc;
  lane_put(n, b->comp, lane, w->x + VERLET_COMP * n);
  lane_put(n, b->f1, lane, w->x + VERLET_F1 * n);
  return LAG_OK;
}

static void verlet_store(void *batch, int lane, lag_sim *s) {
  VerletLanes *b = batch;
  Verlet *w = (Verlet *)(void *)s->method_work;
  int n = s->pb.n;
  const struct {
    const Lanes *x;
    int place;
  } arrays[] = {
      {b->y0, VERLET_Y0}, {b->pb.y, VERLET_Y1}, {b->f0, VERLET_F0}, {b->f1, VERLET_F1}, {b->comp, VERLET_COMP}};
  lane_problem_store(&b->pb, lane, s);
  for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
    lane_get(n, arrays[i].x, lane, w->x + arrays[i].place * n);
  w->step.t0 = b->pb.t0[lane];
  w->step.dt = b->pb.t[lane] - b->pb.t0[lane];
  w->step.tc = b->tc[lane];
  w->ready = 1;
  w->have_path = 0;
  b->pb.steps[lane] = 0;
}

static int verlet_aim(void *batch, int lane, const lag_sim *s) {
  ((VerletLanes *)batch)->pb.to[lane] = s->outside.to;
  return ((const Verlet *)(const void *)s->method_work)->ready != 0.0;
}

/* a := accelerations, the second half of the rates; the lanes where the model fails, as bits of the negative. */
LAG_INLINE int verlet_lane_forces(LaneProblem *pb, Lanes t, const Lanes *y, Lanes *a) {
  Lanes *f = a - pb->nq;
  return -lag_lanes_bits(lane_rates(pb, t, y, f) | lane_not_finite(pb->n, f));
}
#define LAG_MODEL LaneProblem *pb
#define LAG_FORCES(t, q, v, a) verlet_lane_forces(pb, t, q, a)
#include "kernels/splitting.h"

/* All kicks and drifts of a step from y0 at t: y1, and f1 at its end. Returns the lanes where the model fails. */
static LaneMask verlet_lane_compose(VerletLanes *b, Lanes end, double dt) {
  int n = b->pb.n, nq = b->pb.nq;
  const lag_splitting s = {.n = nq,
                           .q = b->y0, .v = b->y0 + nq, .a = b->f0 + nq, .lost = b->comp, .q1 = b->y1, .v1 = b->y1 + nq,
                           .a1 = b->f1 + nq, .lost1 = b->comp1, .rate = b->y1 + nq, .dq = b->dy,
                           .dv = b->dy + nq};
  int status = lag_split(&b->pb, &s, b->c, b->pb.t, end, lane_all(dt));
  for (int i = 0; i < nq; i++) b->f1[i] = b->y1[nq + i];
  return lane_mask((unsigned)-status) | lane_not_finite(n, b->y1);
}

static LaneMask verlet_step(void *batch, LaneMask busy, LaneMask *bad) {
  VerletLanes *b = batch;
  LaneProblem *pb = &b->pb;
  double dt = b->h * pb->dir;
  Lanes tc = b->tc, end = lag_compensated_sum(pb->t, lane_all(dt), &tc), *was = b->f0;
  b->f0 = b->f1;
  b->f1 = was;
  for (int i = 0; i < pb->n; i++) b->y0[i] = pb->y[i];
  *bad = busy & (verlet_lane_compose(b, end, dt) | (end == pb->t));
  LaneMask taken = busy & ~*bad;
  for (int i = 0; i < pb->n; i++) {
    pb->y[i] = lane_select(taken, b->y1[i], pb->y[i]);
    b->comp[i] = lane_select(taken, b->comp1[i], b->comp[i]);
  }
  b->tc = lane_select(taken, tc, b->tc);
  lane_moved(pb, taken, end);
  return taken;
}

static unsigned verlet_advance(void *batch, unsigned busy, unsigned *bad) {
  return lane_advance(batch, busy, bad, verlet_step);
}

#define VERLET_KERNEL(name, general, order, flags, line, words) LANE_KERNEL(name, verlet)
LAG_SPLITTING_METHODS(VERLET_KERNEL)
