/* Whether the runs of a sweep can be computed in lanes, and in how many. */
#pragma once

#include "lanes/lane_kernel.h"

typedef struct LaneChoice {
  const LaneKernel *kernel; /* NULL: one run after the other */
  const void *model;        /* compiled for these lanes */
  int lanes, pause;         /* 1: each step has to be looked at */
} LaneChoice;

/* The kernel for simulations like this one, whose scene is four and eight with a model compiled for so many lanes
 * (NULL: there is none). wanted: 4 or 8 lanes, 1 for none; 0: as many as this processor has. Returns NULL, or why
 * there are none: a clause that begins with "since", or wanted lanes that this processor does not have; then *c has
 * no kernel. */
const char *lag_lanes_choose(const lag_sim *like, const lag_scene *four, const lag_scene *eight, int wanted,
                             LaneChoice *c);
/* How many lanes runs like this one would have in a program compiled for lanes; 1: none. */
int lag_lanes_possible(const lag_sim *like);
