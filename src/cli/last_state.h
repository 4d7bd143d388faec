/* A process beside the simulator that lagc becomes: it has what lagc knew, and waits for the state at which a run ended for want of a finite value. */
#ifndef LAGC_LAST_STATE_H
#define LAGC_LAST_STATE_H

#include <stdint.h>

#include "base/arena.h"

/* Returns in the process that goes on to be the simulator, which finds the pipe's number in $LAG_LAST_STATE. In the other one tell(data, number, n) is called when n numbers
 * came, and it ends with the simulator. Without room for a process nothing happens. */
void last_state_wait(Arena *a, void (*tell)(void *data, const double *number, uint32_t n), void *data);

#endif
