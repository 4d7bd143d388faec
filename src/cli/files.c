#include "cli/files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int write_all(FILE *f, const char *text, size_t n) {
  return fwrite(text, 1, n, f) == n && fflush(f) == 0;
}

/* Devices and pipes are written as they are; renaming a file onto /dev/null would replace it. */
static int is_special(const char *path) {
  struct stat st;
  return stat(path, &st) == 0 && !S_ISREG(st.st_mode);
}

static int write_and_close(FILE *f, const char *text, size_t n, const char **error) {
  errno = 0;
  int ok = f && write_all(f, text, n);
  int why = errno;
  if (f && fclose(f) != 0 && ok) {
    ok = 0;
    why = errno;
  }
  if (!ok) *error = strerror(why ? why : EIO);
  return ok;
}

int file_write(Arena *a, const char *path, const char *text, size_t n, const char **error) {
  if (strcmp(path, "-") == 0) {
    if (write_all(stdout, text, n)) return 1;
    *error = strerror(errno);
    return 0;
  }
  if (is_special(path)) return write_and_close(fopen(path, "wb"), text, n, error);
  char *target = realpath(path, NULL); /* through a symbolic link, where there is one */
  if (target) {
    path = arena_strdup(a, target);
    free(target);
  }
  const char *part = arena_printf(a, "%s.%ld.part", path, (long)getpid());
  if (write_and_close(fopen(part, "wb"), text, n, error)) {
    if (rename(part, path) == 0) return 1;
    *error = strerror(errno);
  }
  remove(part);
  return 0;
}

int dir_make(Arena *a, const char *path) {
  char *p = arena_strdup(a, path);
  for (char *c = p + 1; *c; c++)
    if (*c == '/') {
      *c = '\0';
      mkdir(p, 0777);
      *c = '/';
    }
  return mkdir(p, 0777) == 0 || errno == EEXIST;
}

int file_same(const char *a, const char *b) {
  struct stat x, y;
  return stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino && S_ISREG(x.st_mode);
}

int file_runs(const char *path) {
  struct stat st;
  return stat(path, &st) == 0 && S_ISREG(st.st_mode) && st.st_size > 0 && access(path, X_OK) == 0;
}

int file_exists(const char *path) { return access(path, F_OK) == 0; }
