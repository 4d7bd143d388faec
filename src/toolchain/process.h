/* Programs run as child processes, and interruptions (Ctrl-C, SIGTERM, SIGHUP) that reach them. */
#ifndef LAGC_TOOLCHAIN_PROCESS_H
#define LAGC_TOOLCHAIN_PROCESS_H

#include <signal.h>

#include "base/strbuf.h"
#include "base/vec.h"

/* A command as words: CC may hold options, as make has it. */
typedef VEC(char *) Words;
Words process_words(Arena *a, const char *cc);

/* Runs a program; *said gets its standard output and error. Returns its exit status, or -1. */
int process_run(Arena *a, char *const *argv, char **said);
/* Runs the program at `path` in the same way, with any argv[0]. */
int process_run_as(Arena *a, const char *path, char *const *argv, char **said);

/* Runs the program at path; its standard output becomes the standard input of this process, its messages are dropped.
 * Returns its exit status, or -1; unless that is 0 the standard input is unchanged. */
int process_to_stdin(const char *path, char *const *argv);

enum { INTERRUPTION_SIGNALS = 3 };
typedef struct {
  struct sigaction was[INTERRUPTION_SIGNALS];
} Interruptions;

/* From here on interruptions are noted and handed on to the program that runs; ignored signals stay ignored. */
void interruptions_note(Interruptions *before);
/* Signal handlers are as they were; an interruption that came in between is raised now. */
void interruptions_restore(const Interruptions *before);
/* Whether an interruption was noted. */
int interruption_came(void);

#endif
