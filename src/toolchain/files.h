/* Files that appear whole or not at all. */
#pragma once

#include <stddef.h>

#include "base/strbuf.h"

/* Writes text[n] to path ("-": standard output) through a temporary file beside it (runtime/io/outfile.h). On failure
 * returns 0 with the reason in *error (part of an English sentence), and path is unchanged. */
int file_write(const char *path, const char *text, size_t n, const char **error);

/* Copies the file `from` to path in the same way, as an executable. */
int file_install(const char *path, const char *from, const char **error);

/* Appends the bytes of a file. On failure returns 0 with the reason in *error. */
int file_append(const char *path, StrBuf *out, const char **error);

/* Whether both paths lead to one regular file. */
int file_same(const char *a, const char *b);

/* Its name without folders. */
const char *file_name(const char *path);

int file_exists(const char *path);

/* Path, size, times of modification and of the last change; "" where there is no such file. */
const char *file_identity(Arena *a, const char *path);

/* The path from the root on; NULL: there is no such file. */
const char *file_absolute(Arena *a, const char *path);
