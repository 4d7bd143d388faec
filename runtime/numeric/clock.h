/* Clocks, in seconds. clock.c is for POSIX, clock_windows.c for Windows. */
#pragma once

/* Time that only goes forward. */
double lag_clock_seconds(void);
/* Processor time of this program. */
double lag_processor_seconds(void);
