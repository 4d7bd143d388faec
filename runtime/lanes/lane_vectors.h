/* Vectors of LAG_LANES doubles, and memory for them. Included by lanes_4.c and lanes_8.c alone. */
#pragma once

#include <float.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifndef LAG_LANES
#define LAG_LANES 4
#endif
#include "core/core.h"
#include "kernels/compensated_sum.h"
#include "lag_math.h"
#include "lanes/lane_kernel.h"

typedef LAG_REAL Lanes;
typedef LAG_MASK LaneMask;

LAG_INLINE Lanes lane_all(double x) { return lag_lanes_all(x); }
LAG_INLINE Lanes lane_select(LaneMask c, Lanes a, Lanes b) { return lag_lanes_select(c, a, b); }
LAG_INLINE Lanes lane_abs(Lanes x) { return (Lanes)((LaneMask)x & 0x7fffffffffffffffLL); }
/* As lag_min: b where a or b is NaN, as the processors' instructions have it, too. */
#if LAG_LANES == 8 && defined(__AVX512F__) && !defined(__clang__)
LAG_INLINE Lanes lane_min(Lanes a, Lanes b) { return __builtin_ia32_minpd512_mask(a, b, a, (unsigned char)-1, 4); }
#else
LAG_INLINE Lanes lane_min(Lanes a, Lanes b) { return lane_select(a < b, a, b); }
#endif

LAG_INLINE LaneMask lane_select_mask(LaneMask c, LaneMask a, LaneMask b) { return (c & a) | (~c & b); }

/* Lanes whose bit is set. */
LAG_INLINE LaneMask lane_mask(unsigned bits) {
  LaneMask m = {0};
  for (int k = 0; k < LAG_LANES; k++) m[k] = -(long long)(bits >> k & 1);
  return m;
}

/* Lanes in which some of x[n] is not finite. */
LAG_INLINE LaneMask lane_not_finite(int n, const Lanes *x) {
  Lanes zero = lane_all(0);
  for (int i = 0; i < n; i++) zero += x[i] * lane_all(0);
  return zero != zero;
}

/* Steps before the caller is asked again. */
enum { LANE_TURNS = 1000 };

/* Vectors in one block of zeros, aligned to their size. */
typedef struct LaneRoom {
  char *block;
  Lanes *next;
} LaneRoom;

static inline int lane_room(LaneRoom *r, size_t n) {
  r->block = calloc(n + 1, sizeof(Lanes));
  if (r->block)
    r->next = (Lanes *)(void *)(r->block + (sizeof(Lanes) - (uintptr_t)r->block % sizeof(Lanes)) % sizeof(Lanes));
  return r->block != NULL;
}

static inline Lanes *lane_take(LaneRoom *r, size_t n) {
  Lanes *x = r->next;
  r->next += n;
  return x;
}

/* x[n] := of lane k; of[n] := lane k of x. */
static inline void lane_put(int n, Lanes *x, int k, const double *of) {
  for (int i = 0; i < n; i++) x[i][k] = of[i];
}
static inline void lane_get(int n, const Lanes *x, int k, double *to) {
  for (int i = 0; i < n; i++) to[i] = x[i][k];
}

/* The runs in the lanes, as all kernels hold them: the first member of a batch. */
typedef struct LaneProblem {
  char *block;            /* of the batch */
  const lag_model *model; /* compiled for lanes */
  int n, nq, nz, nu, np;
  double dir, tol;
  int equal;              /* 1: steps of equal size, which may cross a pole of a force: core/force_pole.c */
  LaneMask pause, judged; /* pause after each step; the energy is conserved, and is to be kept */
  Lanes t, to, t0;        /* present time; where to pause; start of the last step */
  /* steps since load; start of the run; energy then, and the loss that would be too large */
  Lanes steps, t_begin, energy, floor;
  Lanes *p, *u, *hold, *y, *work;
  const Lanes *from;      /* [n] state before the last step */
  /* [n] rates of the last step, of the one before, and their fading peak; the same before the last step */
  Lanes *pace[3], *before[3];
} LaneProblem;

static inline size_t lane_problem_size(const lag_sim *s, const lag_model *m) {
  size_t nw = (size_t)(m->taylor && m->taylor->nw > m->nw ? m->taylor->nw : m->nw);
  return (size_t)(m->np + m->nderived + 2 * m->nu + s->pb.n) + nw + 6 * (size_t)s->pb.n + 8;
}

static inline void lane_problem_init(LaneProblem *pb, LaneRoom *room, const lag_sim *like, const void *model) {
  const lag_model *m = like->pb.model;
  *pb = (LaneProblem){.model = model,
                      .n = like->pb.n, .nq = m->nq, .nz = m->nz, .nu = m->nu, .np = m->np + m->nderived,
                      .tol = like->pb.tol};
  pb->p = lane_take(room, (size_t)pb->np);
  pb->u = lane_take(room, (size_t)pb->nu);
  pb->hold = lane_take(room, (size_t)pb->nu);
  pb->y = lane_take(room, (size_t)pb->n);
  for (int i = 0; i < 3; i++) {
    pb->pace[i] = lane_take(room, (size_t)pb->n);
    pb->before[i] = lane_take(room, (size_t)pb->n);
  }
  pb->equal = like->steps_equal;
  pb->work = room->next;
  pb->block = room->block;
}

static void lane_close(void *batch) {
  if (batch) free(((LaneProblem *)batch)->block);
}

static inline void lane_problem_load(LaneProblem *pb, int lane, const lag_sim *s, int pause, double t_begin) {
  const Charge *energy = lag_sim_ncharges(s) ? &s->charges[0] : NULL;
  const double least = 1e-12, half = 0.5; /* charges.c, lag_energy_retained */
  pb->dir = s->pb.dir;
  pb->pause[lane] = pause ? -1 : 0;
  pb->judged[lane] = !pause && energy && energy->balanced != 0.0 ? -1 : 0;
  pb->t[lane] = s->run->t;
  pb->to[lane] = s->outside.to;
  pb->steps[lane] = 0;
  pb->t_begin[lane] = t_begin;
  pb->energy[lane] = energy ? energy->first : 0;
  pb->floor[lane] = energy ? fmax(half * fabs(energy->begin), least) : 0;
  lane_put(pb->np, pb->p, lane, s->pb.p);
  lane_put(pb->nu, pb->hold, lane, s->pb.hold);
  lane_put(pb->n, pb->y, lane, s->y);
  for (int i = 0; i < 3 && pb->equal; i++) lane_put(pb->n, pb->pace[i], lane, s->rate_history + i * pb->n);
}

/* u := the inputs at t. */
static inline int lane_inputs(LaneProblem *pb, Lanes t) {
  int rc = pb->nu && pb->model->inputs ? pb->model->inputs(pb->model, t, pb->p, pb->u) : 0;
  for (int i = 0; i < pb->nu; i++)
    pb->u[i] = lane_select(pb->hold[i] == pb->hold[i], pb->hold[i], pb->model->inputs ? pb->u[i] : lane_all(0));
  return rc;
}

/* Lanes whose energy is not finite, or may be lost: where a run alone ends by its energy, or is judged at its end,
 * and in some more. */
static inline LaneMask lane_energy_lost(LaneProblem *pb) {
  Lanes e[2];
  const lag_model *m = pb->model;
  if (!m->energy || !lag_lanes_any(~pb->pause)) return lane_mask(0);
  if (m->energy(m, pb->t, pb->y, pb->y + pb->nq, pb->y + 2 * pb->nq, pb->p, pb->u, e, pb->work)) return lane_mask(~0u);
  const Lanes d = lane_abs(e[0] - pb->energy);
  return ~pb->pause & (((d > pb->floor) & pb->judged) | lane_not_finite(1, e));
}

/* After steps of equal size in the lanes of `taken`: their rates. Returns the lanes in which one is rough
 * (force_pole.c, find_rough): these pause. */
static inline LaneMask lane_rough(LaneProblem *pb, LaneMask taken) {
  const double rough = 0.1, rounding = 1e-9, steep = 4, fading = 0.99;
  LaneMask found = {0};
  if (!pb->equal) return found;
  Lanes dt = pb->t - pb->t0, **one = &pb->pace[0], **two = &pb->pace[1], **peak = &pb->pace[2];
  for (int i = pb->nq; i < pb->n; i++) {
    Lanes pace = (pb->y[i] - pb->from[i]) / dt, size = lane_abs(pace), was = lane_abs((*one)[i]),
          old = lane_abs((*two)[i]);
    Lanes bend = lane_abs(pace - lane_all(2) * (*one)[i] + (*two)[i]), faded = lane_all(fading) * (*peak)[i],
          largest = size;
    LaneMask grows = (size > lane_all(steep) * old) & (size > (*peak)[i]);
    largest = lane_select(was > largest, was, largest); /* as fmax: what is not a number counts for nothing */
    largest = lane_select(old > largest, old, largest);
    found |= (grows | ~(bend <= lane_all(rough) * size)) & (grows | ~(bend <= lane_all(rough) * largest)) &
             (largest * lane_abs(dt) > lane_all(rounding) * lane_abs(pb->from[i]));
    for (int k = 0; k < 3; k++) pb->before[k][i] = lane_select(taken, pb->pace[k][i], pb->before[k][i]);
    (*two)[i] = lane_select(taken, (*one)[i], (*two)[i]);
    (*one)[i] = lane_select(taken, pace, (*one)[i]);
    (*peak)[i] = lane_select(taken, lane_select((size > faded) | ~(faded == faded), size, faded), (*peak)[i]);
  }
  return found & taken;
}

/* f[n] := the rates of y at t, but for lag_not_finite. Returns the lanes where the model fails. */
static inline LaneMask lane_rates(LaneProblem *pb, Lanes t, const Lanes *y, Lanes *f) {
  int nq = pb->nq, rc = lane_inputs(pb, t);
  for (int i = 0; i < nq; i++) f[i] = y[nq + i];
  rc = rc ? 1 : pb->model->accel(pb->model, t, y, y + nq, y + 2 * nq, pb->p, pb->u, f + nq, f + 2 * nq, pb->work);
  return rc == 0 ? (LaneMask){0} : lane_mask(rc > 0 ? ~0u : (unsigned)-rc);
}

/* The lanes in `taken` have made a step to the time `end`. */
static inline void lane_moved(LaneProblem *pb, LaneMask taken, Lanes end) {
  pb->t0 = lane_select(taken, pb->t, pb->t0);
  pb->t = lane_select(taken, end, pb->t);
  pb->steps += lane_select(taken, lane_all(1), lane_all(0));
}

/* After steps in the lanes of `taken`: the lanes that pause or give up, as bits; *bad: those that give up, of `lost`
 * or by their energy. */
static inline unsigned lane_some(LaneProblem *pb, LaneMask taken, LaneMask lost, unsigned *bad) {
  LaneMask rough = lane_rough(pb, taken), there = (pb->t - pb->to) * lane_all(pb->dir) >= lane_all(0);
  lost |= taken & lane_energy_lost(pb);
  *bad = (unsigned)lag_lanes_bits(lost);
  return *bad | (unsigned)lag_lanes_bits(rough | (taken & (pb->pause | there)));
}

/* LaneKernel.advance, by a method's step of the lanes of `busy`: returns those that took it; *bad: those that give
 * up. */
LAG_INLINE unsigned lane_advance(void *batch, unsigned busy, unsigned *bad,
                                 LaneMask (*step)(void *batch, LaneMask busy, LaneMask *bad)) {
  LaneMask on = lane_mask(busy), lost;
  *bad = 0;
  for (int turn = 0; turn < LANE_TURNS; turn++) {
    LaneMask taken = step(batch, on, &lost);
    unsigned some = lane_some(batch, taken, lost, bad);
    if (some) return some;
  }
  return 0;
}

/* The kernel of a method from the functions of its family. */
#define LANE_KERNEL(id, family)           \
  static const LaneKernel id##_kernel = { \
      #id, family##_open, lane_close, family##_load, family##_advance, family##_store, family##_aim};

/* The last step, to y at t, into its simulation. */
static inline void lane_problem_store(const LaneProblem *pb, int lane, lag_sim *s) {
  s->run->t = pb->t0[lane];
  s->run->steps += pb->steps[lane] - 1;
  s->pb.rhs_calls += pb->steps[lane];
  s->outside.t = pb->t[lane];
  s->outside.made = 1;
  lane_get(pb->n, pb->from, lane, s->now);
  lane_get(pb->n, pb->y, lane, s->y);
  for (int i = 0; i < 3 && pb->equal; i++) lane_get(pb->n, pb->before[i], lane, s->rate_history + i * pb->n);
}
