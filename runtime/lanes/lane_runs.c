/* Runs in lanes (lane_runs.h). */
#include "lanes/lane_runs.h"

/* Lets the owner look at where the run is; it goes on in its lane where another step is needed, or ends. */
static void look(LaneRuns *r, int k) {
  const LaneKernel *kernel = r->choice->kernel;
  int fresh = !(r->busy >> k & 1), rc = r->advance(r->context, k);
  r->busy &= ~(1u << k);
  if (!lag_lane_waits(rc) && rc >= 0 && !fresh && lag_lane_doubts(r->sim[k])) r->alone(r->context, k);
  else if (!lag_lane_waits(rc)) r->end(r->context, k, rc);
  else if (!fresh && kernel->aim(r->batch, k, r->sim[k])) r->busy |= 1u << k;
  else if (kernel->load(r->batch, k, r->sim[k], r->choice->pause || r->follows(r->context, k)) == LAG_OK)
    r->busy |= 1u << k;
  else r->alone(r->context, k);
}

/* Begins runs in a free lane until one stays there. */
static void fill(LaneRuns *r, int k) {
  while (!(r->busy >> k & 1) && (r->sim[k] = r->next(r->context, k)) != NULL) {
    lag_lane_enter(r->sim[k]);
    look(r, k);
  }
}

int lag_lane_runs_fill(LaneRuns *r) {
  for (int k = 0; k < r->choice->lanes; k++) fill(r, k);
  return r->busy != 0;
}

int lag_lane_runs_step(LaneRuns *r) {
  unsigned bad, some = r->choice->kernel->advance(r->batch, r->busy, &bad);
  for (int k = 0; k < r->choice->lanes; k++) {
    if (!(some >> k & 1)) continue;
    if (bad >> k & 1) {
      r->busy &= ~(1u << k);
      r->alone(r->context, k);
    } else {
      r->choice->kernel->store(r->batch, k, r->sim[k]);
      look(r, k);
    }
  }
  return some != 0;
}
