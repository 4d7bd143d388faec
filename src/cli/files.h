/* Files that appear whole or not at all, and folders that only the user can write. */
#ifndef LAGC_FILES_H
#define LAGC_FILES_H

#include <stddef.h>

#include "base/arena.h"

/* Writes text to path ("-": standard output) through a temporary file beside it (runtime/io/outfile.h). On failure
 * returns 0 with *error set (an English sentence part), and path is as it was. */
int file_write(Arena *a, const char *path, const char *text, size_t n, const char **error);

/* Likewise the bytes of the file `from`, which become a program. */
int file_install(const char *path, const char *from, const char **error);

/* Makes a directory and those above it, for the user alone. */
int dir_make(Arena *a, const char *path);

/* Whether nobody but the user (and root) can put anything into the folder, or another folder in its place. */
int dir_is_safe(const char *path);

/* Whether both paths lead to one regular file. */
int file_same(const char *a, const char *b);

/* Whether it is the user's own regular file, no link, not empty, which others cannot write. */
int file_is_own(const char *path);

int file_exists(const char *path);

/* A folder for one build, with a lock in it that its process holds to its end, programs that it becomes by exec included. */
typedef struct {
  const char *path;
  int lock;
} BuildFolder;

/* Makes one in the folder `base`. 0, with errno. */
int build_folder_make(Arena *a, const char *base, BuildFolder *f);
/* Removes the files in it, and the folder. keep: all but this file, for a program that is run from there. */
void build_folder_remove(BuildFolder *f, const char *keep);
/* Removes those in `base` whose processes are gone. */
void build_folder_remains(Arena *a, const char *base);

#endif
