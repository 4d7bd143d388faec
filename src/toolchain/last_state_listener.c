/* Forks a listener that reads the last state of a run from a pipe. */
#include "toolchain/last_state_listener.h"

#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <unistd.h>

#include "base/vec.h"

static void wait_and_tell(Arena *a, int fd, void (*tell)(void *data, const double *number, uint32_t n), void *data) {
  FILE *f = fdopen(fd, "r");
  VEC(double) number = {0};
  double x;
  while (f && fscanf(f, "%lf", &x) == 1) vec_push(a, &number, x);
  if (number.n) tell(data, number.at, number.n);
}

void last_state_listen(Arena *a, void (*tell)(void *data, const double *number, uint32_t n), void *data) {
  int end[2];
  if (pipe(end) != 0) return;
  pid_t pid = fork();
  if (pid == 0) {
    signal(SIGINT, SIG_IGN); /* it ends when the simulator does */
    close(end[1]);
    close(0);
    close(1);
    wait_and_tell(a, end[0], tell, data);
    _exit(0);
  }
  close(end[0]);
  if (pid < 0) close(end[1]);
  else setenv("LAG_LAST_STATE", arena_printf(a, "%d", end[1]), 1);
}
