/* lag-run: a simulator of any model. Enters: the command line of a simulator; a library of the model, $LAG_LIBRARY, or
 * where there is none the bytes that lagc wrote, $LAG_PROGRAM, which are evaluated; $LAG_NO_GSL leaves GSL out. While
 * it evaluates lagc may compile: then the path of the library comes from the descriptor $LAG_COMPILED, and the run
 * changes over between two steps. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#ifndef _WIN32
#include <dlfcn.h>
#include <fcntl.h>
#include <unistd.h>
#endif

#include "evaluator/evaluator.h"
#include "lag.h"

enum { FAILED = 2 };

/* The bytes of a file, *n of them; NULL: it cannot be read. */
static void *read_file(const char *path, size_t *n) {
  FILE *f = fopen(path, "rb");
  size_t room = 1 << 16, part = 1;
  char *bytes = f ? malloc(room) : NULL;
  for (*n = 0; bytes && part > 0; *n += part) {
    char *bigger = *n == room ? realloc(bytes, room *= 2) : bytes;
    if (!bigger) free(bytes);
    bytes = bigger;
    part = bytes ? fread(bytes + *n, 1, room - *n, f) : 0;
  }
  if (f) fclose(f);
  return bytes;
}

#ifdef _WIN32
static const lag_program *library(const char *path) { return path ? NULL : NULL; }
static void look_for_library(const lag_program *program) { (void)program; }
static int is_compiled_meanwhile(void) { return 0; }
static void tell_of_compiler(void) {}
#else
/* The program in a library; NULL: there is none, or it is of another version. */
static const lag_program *library(const char *path) {
  const lag_program *(*get)(void) = NULL;
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL), *f = handle ? dlsym(handle, "lag_library") : NULL;
  memcpy(&get, &f, sizeof get);
  return f ? get() : NULL;
}

static int compiled_fd = -1; /* where the library's path will be read; -1: nothing is compiled, or all is done */
static int compiler_failed;
static time_t begun;

static int is_compiled_meanwhile(void) {
  const char *fd = getenv("LAG_COMPILED");
  if (fd) compiled_fd = atoi(fd), fcntl(compiled_fd, F_SETFL, O_NONBLOCK);
  begun = time(NULL);
  return fd != NULL;
}

/* The path comes in one piece. */
static void look(const lag_program *program) {
  enum { ROOM = 4096 };
  char path[ROOM];
  ssize_t n = read(compiled_fd, path, sizeof path - 1);
  if (n < 0) return; /* not yet */
  close(compiled_fd), compiled_fd = -1;
  path[n] = '\0';
  path[strcspn(path, "\n")] = '\0';
  const lag_program *compiled = n > 0 ? library(path) : NULL;
  compiler_failed = !compiled;
  if (compiled) lag_program_change_over(program, compiled);
}

/* After a step: a look at the descriptor once in 2^8 steps, or in fewer that take a while. */
static void look_for_library(const lag_program *program) {
  enum { SELDOM = 1 << 8 };
  const double a_while = 0.01;
  static unsigned steps, between = 1;
  static clock_t before;
  if (compiled_fd < 0 || ++steps < between) return;
  const clock_t now = clock();
  if ((double)(now - before) > a_while * CLOCKS_PER_SEC) between -= between / 2;
  else if (between < SELDOM) between *= 2;
  before = now;
  steps = 0;
  look(program);
}

/* Behind a run: why the compiler did not speed it up. */
static void tell_of_compiler(void) {
  enum { LONG = 20 };
  const long waited = (long)(time(NULL) - begun);
  if (compiler_failed)
    fputs("lag-run: the C compiler failed, so the run was evaluated; `lagc build` prints its messages\n", stderr);
  else if (compiled_fd >= 0 && waited > LONG)
    fprintf(stderr, "lag-run: the C compiler had not ended after %ld s, so the run was evaluated\n", waited);
}
#endif

/* The program of $LAG_LIBRARY, or else of $LAG_PROGRAM; NULL with the reason said. */
static const lag_program *find_program(int *evaluated) {
  const char *path = getenv("LAG_LIBRARY"), *why = NULL;
  const lag_program *program = path ? library(path) : NULL;
  size_t n = 0;
  *evaluated = !program;
  if (program) return program;
  path = getenv("LAG_PROGRAM");
  why = path ? "it cannot be read" : "LAG_PROGRAM names no program; `lagc run --compile never` runs this";
  void *bytes = path ? read_file(path, &n) : NULL;
  program = bytes ? lag_program_read(bytes, n, &why) : NULL;
  free(bytes);
  if (!program) fprintf(stderr, "lag-run: %s%s%s\n", path ? path : "", path ? ": " : "", why);
  return program;
}

int main(int argc, char **argv) {
#ifdef LAG_WITH_GSL
  lag_extras extras = getenv("LAG_NO_GSL") ? (lag_extras){0} : lag_gsl;
#else
  lag_extras extras = {0};
#endif
  int evaluated;
  const lag_program *program = find_program(&evaluated);
  if (!program) return FAILED;
  if (evaluated && is_compiled_meanwhile()) extras.after_step = look_for_library;
  int status = lag_app_main(argc, argv, program, &extras);
  if (evaluated) tell_of_compiler(), lag_program_free(program);
  return status;
}
