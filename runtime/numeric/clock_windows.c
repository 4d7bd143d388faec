/* Clocks of Windows. Compiled for Windows only (Makefile). */
#include "numeric/clock.h"

#define WIN32_LEAN_AND_MEAN
#include <windows.h>

double lag_clock_seconds(void) {
  LARGE_INTEGER now, each;
  QueryPerformanceFrequency(&each);
  QueryPerformanceCounter(&now);
  return (double)now.QuadPart / (double)each.QuadPart;
}

static double seconds_of(FILETIME t) { return 1e-7 * (4294967296.0 * t.dwHighDateTime + t.dwLowDateTime); }

double lag_processor_seconds(void) {
  FILETIME begun, ended, kernel, user;
  GetProcessTimes(GetCurrentProcess(), &begun, &ended, &kernel, &user);
  return seconds_of(kernel) + seconds_of(user);
}
