/* Runs in the lanes of one batch: as one ends, its lane takes the next. Holds: whatever a lane cannot do is left to the
 * run alone, from its start. */
#pragma once

#include "lanes/lane_choice.h"

enum { LAG_MOST_LANES = 8 };

/* The lanes, and functions of who has the runs. */
typedef struct LaneRuns {
  const LaneChoice *choice;
  void *batch;                              /* of the choice's kernel */
  unsigned busy;                            /* bit k: a run is in lane k */
  lag_sim *sim[LAG_MOST_LANES];
  lag_sim *(*next)(void *context, int k);   /* another run for lane k, at its start; NULL: there is none */
  int (*advance)(void *context, int k);     /* its status, or one of lag_lane_waits: it is called again */
  int (*follows)(void *context, int k);     /* whether each of its steps has to be looked at */
  void (*end)(void *context, int k, int status);
  void (*alone)(void *context, int k);      /* makes all of it, alone */
  void *context;
} LaneRuns;

/* Begins runs in all free lanes. 0: none is under way. */
int lag_lane_runs_fill(LaneRuns *r);
/* Steps all lanes until some pause, and looks at these. 0: a thousand steps have not led there. */
int lag_lane_runs_step(LaneRuns *r);
