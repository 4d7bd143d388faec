/* The kernels of all methods, in vectors of LAG_LANES doubles. Included by lanes_4.c and lanes_8.c alone. */
#pragma once

#include "lanes/embedded_lanes.h"
#include "lanes/taylor_lanes.h"
#include "lanes/verlet_lanes.h"

#define VERLET_ENTRY(name, general, order, flags, line, words) &name##_kernel,
#define RK_ENTRY(name, NAME, kind, dense, order, line, words) &name##_kernel,
static const LaneKernel *const kernels[] = {&taylor_kernel, LAG_RUNGE_KUTTA_METHODS(RK_ENTRY)
                                            LAG_SPLITTING_METHODS(VERLET_ENTRY) NULL};
