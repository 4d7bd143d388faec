/* The kernels of all methods, in vectors of LAG_LANES doubles. Included by lanes_4.c and lanes_8.c alone. */
#pragma once

#include "lanes/embedded_lanes.h"
#include "lanes/taylor_lanes.h"
#include "lanes/verlet_lanes.h"

static const LaneKernel *const kernels[] = {&taylor_kernel, &dop853_kernel, &rk45_kernel, &rk4_kernel, &symplectic_euler_kernel, &verlet_kernel, &verlet4_kernel, &verlet6_kernel,
                                            &verlet8_kernel, NULL};
