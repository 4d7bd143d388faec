/* Writes files atomically. */
#include "toolchain/files.h"

#include <errno.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "base/posix.h" /* generated: a copy of runtime/io/posix.h */

#include "toolchain/outfile.h" /* generated: a copy of runtime/io/outfile.h */

/* --- files --- */

/* Closes the file, and keeps or drops it. */
static int close_outfile(Outfile *o, int ok, const char **error) {
  int why = errno;
  if (lag_outfile_close(o, ok ? OUTFILE_KEEP : OUTFILE_DROP) != 0 && ok) {
    ok = 0;
    why = errno;
  }
  if (!ok) *error = strerror(why ? why : EIO);
  return ok;
}

int file_write(const char *path, const char *text, size_t n, const char **error) {
  Outfile o;
  errno = 0;
  if (lag_outfile_open(&o, path) != 0) return fail_with(error, strerror(errno));
  return close_outfile(&o, fwrite(text, 1, n, o.f) == n && fflush(o.f) == 0, error);
}

static int copy(FILE *from, FILE *to) {
  char block[65536];
  for (size_t n; (n = fread(block, 1, sizeof block, from)) > 0;)
    if (fwrite(block, 1, n, to) != n) return 0;
  return !ferror(from) && fflush(to) == 0;
}

int file_install(const char *path, const char *from, const char **error) {
  Outfile o;
  struct stat st;
  FILE *f = fopen(from, "rb");
  int ok = 0;
  errno = f ? 0 : errno;
  if (!f || lag_outfile_open(&o, path) != 0) *error = strerror(errno);
  else {
    ok = copy(f, o.f) && fstat(fileno(o.f), &st) == 0;
    /* readers may execute it */
    ok = close_outfile(&o, ok && fchmod(fileno(o.f), (st.st_mode | (st.st_mode & 0444) >> 2) & 0777) == 0, error);
  }
  if (f) fclose(f);
  return ok;
}

int file_append(const char *path, StrBuf *out, const char **error) {
  char block[65536];
  FILE *f = fopen(path, "rb");
  if (!f) return fail_with(error, strerror(errno));
  for (size_t n; (n = fread(block, 1, sizeof block, f)) > 0;) sb_putn(out, block, n);
  int ok = !ferror(f);
  fclose(f);
  return ok ? 1 : fail_with(error, strerror(EIO));
}

int file_same(const char *a, const char *b) {
  struct stat x, y;
  return stat(a, &x) == 0 && stat(b, &y) == 0 && x.st_dev == y.st_dev && x.st_ino == y.st_ino && S_ISREG(x.st_mode);
}

const char *file_name(const char *path) {
  const char *slash = lag_last_slash(path);
  return slash ? slash + 1 : path;
}

int file_exists(const char *path) { return access(path, F_OK) == 0; }

const char *file_absolute(Arena *a, const char *path) {
  char *found = realpath(path, NULL);
  const char *copy = found ? arena_strdup(a, found) : NULL;
  free(found);
  return copy;
}

const char *file_identity(Arena *a, const char *path) {
  struct stat st;
  if (stat(path, &st) != 0) return "";
  return arena_printf(a, "%s %lld %lld.%09ld %lld.%09ld", path, (long long)st.st_size, (long long)st.st_mtim.tv_sec,
                      st.st_mtim.tv_nsec, (long long)st.st_ctim.tv_sec, st.st_ctim.tv_nsec);
}
