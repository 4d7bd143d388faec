/* Programs run as child processes. */
#pragma once

#include <stdint.h>
#include <stdio.h>

#include "base/strbuf.h"

/* Runs the program at `path`; *said gets its standard output and error. Returns its exit status, or -1. */
int process_run(Arena *a, const char *path, char *const *argv, char **said);

/* Runs the program at path with its standard output to a file; its messages are dropped. Returns its exit status, or
 * -1. */
int process_to_file(const char *path, char *const *argv, FILE *out);

/* Becomes the program at path, which takes over the standard streams. Returns only where that fails. */
void process_become(const char *path, char *const *argv);

/* Puts the bytes in a file that only programs begun by this one find, at the path in the environment variable `name`.
 * Returns 0 where that fails. */
int process_give(const char *name, const StrBuf *bytes);

/* Sets an environment variable of the programs begun by this one. */
void process_set(const char *name, const char *value);
/* Writes a line to a descriptor. */
void process_tell(int fd, const char *line);

/* Begins work(data, fd) beside the program that this one becomes, without its standard streams. That program finds in
 * the variable `name` the number of the descriptor from which it reads what work writes to fd; where that fails, as on
 * Windows, it finds none. */
void process_beside(void (*work)(void *data, int fd), void *data, const char *name);
/* Whether the reader of fd ends within so many seconds. */
int process_reader_ends(int fd, double seconds);

/* Begins work(data) in a child process, whose exit status is what work returns. Returns the process, or -1, as
 * on Windows, which has no fork. */
long process_begin(int (*work)(void *data), void *data);
/* Waits for its end, but no longer than `seconds`; then it is ended with all that it began. Its exit status, or -1. */
int process_end(long process, double seconds);
/* Whether messages are read at a terminal. */
int stderr_is_terminal(void);
/* Makes what the file holds the standard input. Returns 0 where it is empty or that fails. */
int process_read_from(FILE *f);

/* Forks a listener beside the simulator that lagc becomes by exec: it keeps the compiled model, and waits for the
 * state at which a run ended for want of a finite value. Returns in the process that becomes the simulator, which
 * finds the pipe's descriptor in $LAG_LAST_STATE. The listener calls tell(data, number, n) when n numbers have
 * arrived, and ends with the simulator. If fork or pipe fails, as on Windows, there is no listener. */
void last_state_listen(Arena *a, void (*tell)(void *data, const double *number, uint32_t n), void *data);
