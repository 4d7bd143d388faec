/* Listener process beside the simulator that lagc becomes by exec: it keeps the compiled model, and waits for the state at which a run ended for
 * want of a finite value. */
#ifndef LAGC_TOOLCHAIN_LAST_STATE_LISTENER_H
#define LAGC_TOOLCHAIN_LAST_STATE_LISTENER_H

#include <stdint.h>

#include "base/arena.h"

/* Forks. Returns in the process that becomes the simulator, which finds the pipe's descriptor in $LAG_LAST_STATE. The listener calls
 * tell(data, number, n) when n numbers have arrived, and ends with the simulator. If fork or pipe fails, there is no listener. */
void last_state_listen(Arena *a, void (*tell)(void *data, const double *number, uint32_t n), void *data);

#endif
