/* rusage COMMAND...: what it took, `CPU_SECONDS KILOBYTES`, on standard error; its exit status. */
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static double seconds(struct timeval t) { return (double)t.tv_sec + 1e-6*(double)t.tv_usec; }

int main(int argc, char **argv) {
  int status = 0;
  struct rusage r;
  pid_t child = argc > 1 ? fork() : -1;
  if (child == 0) {
    execvp(argv[1], argv + 1);
    _exit(127);
  }
  if (child < 0 || waitpid(child, &status, 0) < 0 || getrusage(RUSAGE_CHILDREN, &r) != 0) return 2;
  fprintf(stderr, "rusage %.3f %ld\n", seconds(r.ru_utime) + seconds(r.ru_stime), r.ru_maxrss);
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1;
}
