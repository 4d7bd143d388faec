/* Files that appear whole or not at all, and folders that only the user can write. */
#ifndef LAGC_TOOLCHAIN_FILES_H
#define LAGC_TOOLCHAIN_FILES_H

#include <stddef.h>

#include "base/arena.h"

/* Writes text[n] to path ("-": standard output) through a temporary file beside it (runtime/io/outfile.h). On failure
 * returns 0 with the reason in *error (part of an English sentence), and path is unchanged. */
int file_write(const char *path, const char *text, size_t n, const char **error);

/* Copies the file `from` to path in the same way, as an executable. */
int file_install(const char *path, const char *from, const char **error);

/* Makes a directory, for the user alone, and the directories above it. */
int dir_make(Arena *a, const char *path);

/* Whether only the user and root can write into the folder, or put another folder in its place. */
int dir_is_safe(const char *path);

/* Whether both paths lead to one regular file. */
int file_same(const char *a, const char *b);

/* Whether path is a regular file of the user's, no link, not empty, not writable by others. */
int file_is_own(const char *path);

int file_exists(const char *path);

/* A folder for one build, with a lock that its process holds until it ends, across exec. */
typedef struct {
  const char *path;
  int lock;
} BuildFolder;

/* Makes a build folder in the folder `base`. Returns 0, with errno, on failure. */
int build_folder_make(Arena *a, const char *base, BuildFolder *f);
/* Removes the folder and its files. */
void build_folder_remove(BuildFolder *f);
/* Removes the build folders in `base` whose processes are gone. */
void build_folder_remove_stale(Arena *a, const char *base);

#endif
