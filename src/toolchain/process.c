/* Programs run as child processes: the C compiler, simulators; interruptions reach them. */
#include "toolchain/process.h"

#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <signal.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

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

/* State for the signal handler: signal that came (0: none), process group of the running program (0: none), and whether signals are noted so that
 * builds end in order. */
static volatile sig_atomic_t interrupted, running, noting;
static const int signals[INTERRUPTION_SIGNALS] = {SIGINT, SIGTERM, SIGHUP};
static void on_interruption(int number) {
  interrupted = number;
  if (running) kill(-(pid_t)running, number);
}

/* From here on signals are noted, and forwarded to the running program; ignored signals stay ignored. */
void interruptions_note(Interruptions *before) {
  struct sigaction note = {.sa_handler = on_interruption};
  interrupted = 0;
  noting = 1;
  for (int i = 0; i < INTERRUPTION_SIGNALS; i++) {
    sigaction(signals[i], NULL, &before->was[i]);
    if (before->was[i].sa_handler != SIG_IGN) sigaction(signals[i], &note, NULL);
  }
}

int interruption_came(void) { return interrupted != 0; }

/* Restores the handlers and raises a signal that was noted. */
void interruptions_restore(const Interruptions *before) {
  for (int i = 0; i < INTERRUPTION_SIGNALS; i++) sigaction(signals[i], &before->was[i], NULL);
  noting = 0;
  if (interrupted) raise(interrupted);
}

/* Forks; where signals are noted the child leads a process group, to which they are forwarded. */
static pid_t fork_program(void) {
  sigset_t held, before;
  sigemptyset(&held);
  for (int i = 0; i < INTERRUPTION_SIGNALS; i++) sigaddset(&held, signals[i]);
  sigprocmask(SIG_BLOCK, &held, &before);
  pid_t pid = fork();
  if (noting && pid >= 0) setpgid(pid, 0); /* in both processes, whichever runs first */
  if (noting && pid > 0) running = (sig_atomic_t)pid;
  if (pid == 0 && noting)
    for (int i = 0; i < INTERRUPTION_SIGNALS; i++) {
      struct sigaction now;
      if (sigaction(signals[i], NULL, &now) == 0 && now.sa_handler == on_interruption) signal(signals[i], SIG_DFL);
    }
  sigprocmask(SIG_SETMASK, &before, NULL);
  return pid;
}

/* Waits for the process; its exit status, or -1 when it ended by a signal. */
static int wait_for(pid_t pid) {
  int status = 0;
  pid_t got;
  do got = waitpid(pid, &status, 0);
  while (got < 0 && errno == EINTR);
  running = 0;
  return got == pid && WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

int process_run(Arena *a, char *const *argv, char **said) { return process_run_as(a, argv[0], argv, said); }

int process_run_as(Arena *a, const char *path, char *const *argv, char **said) {
  int pipe_fd[2];
  *said = arena_strdup(a, "");
  if ((noting && interrupted) || pipe(pipe_fd) != 0) return -1;
  pid_t pid = fork_program();
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

int process_to_stdin(const char *path, char *const *argv) {
  FILE *out = tmpfile();
  pid_t pid = out ? fork() : -1;
  if (pid == 0) {
    dup2(fileno(out), 1);
    if (!freopen("/dev/null", "w", stderr)) _exit(127);
    execv(path, argv);
    _exit(127);
  }
  int status = -1;
  if (pid > 0 && waitpid(pid, &status, 0) == pid) status = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  if (status == 0 && (lseek(fileno(out), 0, SEEK_SET) != 0 || dup2(fileno(out), 0) != 0)) status = -1;
  if (out) fclose(out);
  return status;
}

Words process_words(Arena *a, const char *cc) {
  Words words = {0};
  char *text = arena_strdup(a, cc);
  for (char *w = strtok(text, " "); w; w = strtok(NULL, " ")) vec_push(a, &words, w);
  return words;
}
