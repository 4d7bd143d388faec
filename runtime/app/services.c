/* Services of all analyses: messages, signals, the clock with its progress line, outputs that would overwrite
 * something. */
#include <errno.h>
#include <stdarg.h>
#include <string.h>

#include "app/app.h"
#include "io/posix.h"
#include "io/visible.h"
#include "numeric/clock.h"

int lag_app_error(const Args *a, const char *format, ...) {
  char text[4096];
  va_list args;
  va_start(args, format);
  vsnprintf(text, sizeof text, format, args);
  va_end(args);
  fput_visible(stderr, a->self, "");
  fputs(": ", stderr);
  fput_visible(stderr, text, "\n\t");
  putc('\n', stderr);
  return EXIT_USAGE;
}

/* ---- Signals and the clock */

/* Signal received, 0: none. The only mutable global, since a signal handler can reach nothing else. */
static volatile sig_atomic_t interrupted;

static void on_interrupt(int signal_number) { interrupted = signal_number; }

void lag_app_catch_interrupt(void) {
  static const int signals[] = {SIGINT, SIGTERM, SIGHUP};
  struct sigaction action = {0}, before;
  action.sa_handler = on_interrupt;
  action.sa_flags = (int)SA_RESETHAND; /* a second Ctrl-C ends at once */
  sigemptyset(&action.sa_mask);
  for (size_t i = 0; i < sizeof signals / sizeof *signals; i++) {
    int nohup = signals[i] == SIGHUP && sigaction(SIGHUP, NULL, &before) == 0 && before.sa_handler == SIG_IGN;
    if (!nohup) sigaction(signals[i], &action, NULL);
  }
}

void lag_app_start_clock(App *app) {
  lag_app_catch_interrupt();
  app->progress = isatty(2) && !app->args.quiet ? 0 : -1;
  app->begun = app->shown = lag_clock_seconds();
}

void lag_app_stop_clock(App *app) {
  app->wall = lag_clock_seconds() - app->begun;
  if (app->progress > 0) fputs("\r\33[K", stderr);
}

int lag_app_interrupted(void) { return EXIT_SIGNAL + interrupted; }

/* ---- Files */

/* Whether two paths lead to the same existing regular file. */
static int same_file(const char *a, const char *b) {
  struct stat x, y;
  return stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino && S_ISREG(x.st_mode);
}

/* The path without ./ before it: files that are not there yet are told apart by their names. */
static const char *plain(const char *path) {
  while (strncmp(path, "./", 2) == 0) path += 2;
  return path;
}

int lag_app_check_outputs(const App *app) {
  const Args *a = &app->args;
  const char *const to[] = {a->out, a->svg, a->html, a->save, a->events, a->motions}, *const keep[] = {
                                                                                          app->program->source,
                                                                                          "/proc/self/exe", a->resume,
                                                                                          a->rows};
  enum { N = sizeof to / sizeof *to, KEPT = sizeof keep / sizeof *keep };

  for (int i = 0; i < N; i++) {
    for (int k = 0; to[i] && k < KEPT; k++)
      if (keep[k] && same_file(to[i], keep[k]) && !(to[i] == a->save && keep[k] == a->resume)) {
        return lag_app_error(a, "%s would be overwritten: it is %s; write to another file", to[i],
                             k == 0   ? "the model"
                             : k == 1 ? "this program"
                             : k == 2 ? "the state to go on from"
                                      : "the file of --rows");
      }
    for (int k = 0; to[i] && k < i; k++)
      if (to[k] && (strcmp(plain(to[i]), plain(to[k])) == 0 ? !lag_is_null_device(to[i]) : same_file(to[i], to[k])))
        return lag_app_error(a, "%s would be written twice; give each result a file of its own", to[i]);
  }
  return 0;
}

int lag_app_io_error(const App *app, const char *path) {
  return lag_app_error(&app->args, "cannot write %s: %s", path, strerror(errno ? errno : EIO));
}

int lag_app_flush(const App *app) {
  errno = 0;
  return fflush(stdout) || ferror(stdout) ? lag_app_io_error(app, "standard output") : 0;
}

int lag_app_bad_file(App *app, const char *path) {
  app->bad_file = path;
  app->bad_errno = errno;
  return LAG_EIO;
}

int lag_app_try_file(const App *app, const char *path) {
  Outfile o;
  return path && (lag_outfile_open(&o, path) || lag_outfile_close(&o, OUTFILE_DROP)) ? lag_app_io_error(app, path) : 0;
}
