/* Programs run as child processes: the C compiler, simulators. */
#include "toolchain/process.h"

#include <errno.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "base/vec.h"

static char *read_fd(Arena *a, int fd) {
  StrBuf b = strbuf(a);
  char buffer[4096];
  for (ssize_t n; (n = read(fd, buffer, sizeof buffer)) != 0;) {
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) break;
    sb_putn(&b, buffer, (size_t)n);
  }
  return arena_strdup(a, sb_text(&b));
}

int stderr_is_terminal(void) { return isatty(2); }

/* Waits for the process; its exit status, or -1 when it ended by a signal. */
static int wait_for(pid_t pid) {
  int status = 0;
  pid_t got;
  do got = waitpid(pid, &status, 0);
  while (got < 0 && errno == EINTR);
  return got == pid && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

int process_run(Arena *a, const char *path, char *const *argv, char **said) {
  int pipe_fd[2];
  *said = arena_strdup(a, "");
  if (pipe(pipe_fd) != 0) return -1;
  pid_t pid = fork();
  if (pid == 0) {
    dup2(pipe_fd[1], 1);
    dup2(pipe_fd[1], 2);
    close(pipe_fd[0]);
    close(pipe_fd[1]);
    execvp(path, argv);
    _exit(127);
  }
  close(pipe_fd[1]);
  if (pid > 0) *said = read_fd(a, pipe_fd[0]);
  close(pipe_fd[0]);
  return pid < 0 ? -1 : wait_for(pid);
}

int process_to_file(const char *path, char *const *argv, FILE *out) {
  pid_t pid = fork();
  if (pid == 0) {
    dup2(fileno(out), 1);
    if (!freopen("/dev/null", "w", stderr)) _exit(127);
    execv(path, argv);
    _exit(127);
  }
  return pid > 0 ? wait_for(pid) : -1;
}

int process_give(const char *name, const StrBuf *bytes) {
  enum { ROOM = 40 };
  char path[ROOM];
  FILE *f = tmpfile();
  if (!f || fwrite(bytes->at, 1, bytes->n, f) != bytes->n || fflush(f) != 0 || fseek(f, 0, SEEK_SET) != 0) return 0;
  snprintf(path, sizeof path, "/dev/fd/%d", dup(fileno(f))); /* a copy stays open across exec */
  return setenv(name, path, 1) == 0;
}

void process_become(const char *path, char *const *argv) { execv(path, argv); }

long process_begin(int (*work)(void *data), void *data) {
  fflush(NULL);
  pid_t pid = fork();
  if (pid == 0) {
    setpgid(0, 0);
    _exit(work(data));
  }
  return pid;
}

void process_set(const char *name, const char *value) { setenv(name, value, 1); }
void process_tell(int fd, const char *line) { dprintf(fd, "%s\n", line); }

int process_reader_ends(int fd, double seconds) {
  struct pollfd of = {.fd = fd};
  return poll(&of, 1, (int)(1000 * seconds)) != 0;
}

typedef struct {
  void (*work)(void *data, int fd);
  void *data;
  int fd;
} Beside;

static int work_to_the_end(void *beside) {
  const Beside *b = beside;
  b->work(b->data, b->fd);
  return 0;
}

/* Whether the process ends within so many seconds; it is not reaped. */
static int ends_within(long process, double seconds) {
  const struct timespec pause = {0, 10000000};
  siginfo_t end = {0};
  for (double waited = 0;; waited += 0.01) {
    if (waitid(P_PID, (id_t)process, &end, WEXITED | WNOHANG | WNOWAIT) != 0 || end.si_pid) return 1;
    if (!(waited < seconds)) return 0;
    nanosleep(&pause, NULL);
  }
}

/* Ends a compiler that hangs: after 600 s, or a minute after the run. */
static void wait_for_compiler(long process, int run) {
  const int longest = 600, behind = 60;
  for (int s = 0, end = longest; s < end && !ends_within(process, 1); s++)
    if (end == longest && process_reader_ends(run, 0) && s + behind < end) end = s + behind;
  process_end(process, 0);
}

/* The process of work has no streams but fd, so that nobody who reads from this program waits for it, and no parent. */
static void work_beside(void (*work)(void *data, int fd), void *data, int fd) {
  int null = open("/dev/null", O_RDWR);
  if (fork() != 0) _exit(0);
  signal(SIGPIPE, SIG_IGN);
  for (int k = 0; k < 3; k++) dup2(null, k);
  for (int k = 3; k < (int)sysconf(_SC_OPEN_MAX) && k < 256; k++)
    if (k != fd) close(k);
  if (nice(5) == -1) errno = 0; /* the run goes first */
  Beside b = {work, data, fd};
  wait_for_compiler(process_begin(work_to_the_end, &b), fd);
  _exit(0);
}

void process_beside(void (*work)(void *data, int fd), void *data, const char *name) {
  int end[2];
  char number[16];
  if (pipe(end) != 0) return;
  fflush(NULL);
  pid_t pid = fork();
  if (pid == 0) work_beside(work, data, end[1]);
  close(end[1]);
  snprintf(number, sizeof number, "%d", end[0]);
  if (pid > 0 && wait_for(pid) == 0) setenv(name, number, 1);
  else close(end[0]);
}

int process_end(long process, double seconds) {
  if (!ends_within(process, seconds)) kill(-(pid_t)process, SIGKILL);
  return wait_for((pid_t)process);
}

int process_read_from(FILE *f) {
  return lseek(fileno(f), 0, SEEK_END) > 0 && lseek(fileno(f), 0, SEEK_SET) == 0 && dup2(fileno(f), 0) == 0;
}

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
