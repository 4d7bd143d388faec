#include "cli/files.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

static int write_all(FILE *f, const char *text, size_t n) {
  return fwrite(text, 1, n, f) == n && fflush(f) == 0;
}

int file_write(Arena *a, const char *path, const char *text, size_t n, const char **error) {
  if (strcmp(path, "-") == 0) {
    if (write_all(stdout, text, n)) return 1;
    *error = strerror(errno);
    return 0;
  }
  const char *part = arena_printf(a, "%s.%ld.part", path, (long)getpid());
  FILE *f = fopen(part, "wb");
  if (!f) {
    *error = strerror(errno);
    return 0;
  }
  int ok = write_all(f, text, n);
  if (fclose(f) != 0) ok = 0;
  if (ok && rename(part, path) == 0) return 1;
  *error = strerror(errno);
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

int file_exists(const char *path) { return access(path, F_OK) == 0; }
