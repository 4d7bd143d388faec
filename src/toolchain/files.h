/* Files that appear whole or not at all. */
#pragma once

#include <stddef.h>

#include "base/arena.h"

/* Writes text[n] to path ("-": standard output) through a temporary file beside it (runtime/io/outfile.h). On failure
 * returns 0 with the reason in *error (part of an English sentence), and path is unchanged. */
int file_write(const char *path, const char *text, size_t n, const char **error);

/* Copies the file `from` to path in the same way, as an executable. */
int file_install(const char *path, const char *from, const char **error);

/* Whether both paths lead to one regular file. */
int file_same(const char *a, const char *b);

int file_exists(const char *path);
