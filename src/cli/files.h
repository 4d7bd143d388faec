/* Files that appear whole or not at all. */
#ifndef LAGC_FILES_H
#define LAGC_FILES_H

#include <stddef.h>

#include "base/arena.h"

/* Writes text to path ("-": standard output) through a temporary file beside it. On failure
 * returns 0 with *error set (an English sentence part), and path is as it was. */
int file_write(Arena *a, const char *path, const char *text, size_t n, const char **error);

/* Makes a directory and those above it. */
int dir_make(Arena *a, const char *path);

/* Whether both paths lead to one regular file. */
int file_same(const char *a, const char *b);

/* Whether it is a file that is not empty and may be executed. */
int file_runs(const char *path);

int file_exists(const char *path);

#endif
