/* Steps of several runs at once, one in each lane of a vector: what the files compiled for one width of vectors
 * (lanes_4.c, lanes_8.c) offer to sweep/run_lanes.c. Holds: every lane gets the numbers that lag_method.step gives
 * to its run alone, bit by bit. */
#pragma once

#include "lag.h"

/* Lets a simulation wait wherever it needs a step, which is then made in a lane; whether a status says that it
 * waits. */
void lag_lane_enter(lag_sim *sim);
int lag_lane_waits(int status);
/* Whether the energy of a run that has ended may be lost: a lane does not keep what a run alone is judged by. */
int lag_lane_doubts(lag_sim *sim);

typedef struct LaneKernel {
  const char *method;

  /* A batch for runs of the simulation `like`, whose method and tolerance are set, with the model compiled for
   * lanes. NULL: no memory. */
  void *(*new_batch)(const lag_sim *like, const void *model);
  void (*free_batch)(void *batch);

  /* Puts a run into a lane, at its present time and state. pause: 1: it pauses after each step; 0: at the step that
   * reaches sim->outside.to. LAG_OK, or the status of a run that cannot begin a step. */
  int (*load)(void *batch, int lane, lag_sim *sim, int pause);

  /* Some steps of all lanes in `busy` (bit k: lane k), until one pauses or gives up; returns these, 0 where a
   * thousand steps have not led there. *bad: those that give up: left to lag_method.step, from the start of the run.
   * */
  unsigned (*advance)(void *batch, unsigned busy, unsigned *bad);

  /* The state of a lane that pauses, and its last step, into its simulation: the step's start is the present time,
   * its end sim->outside.t. */
  void (*store)(void *batch, int lane, lag_sim *sim);

  /* Where a lane that goes on is to pause next. 0: it cannot go on, since the method was reset: load it. */
  int (*aim)(void *batch, int lane, const lag_sim *sim);
} LaneKernel;

typedef struct LaneWidth {
  int lanes;
  const LaneKernel *const *kernels; /* ends with NULL */
} LaneWidth;

/* Of vectors of 4 and 8 doubles; kernels is NULL where this library was compiled without. */
extern const LaneWidth lag_lane_width_4, lag_lane_width_8;
