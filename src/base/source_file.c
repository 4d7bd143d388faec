/* Texts of a compilation that are files. */
#include "base/source.h"

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include "base/posix.h" /* generated: a copy of runtime/io/posix.h */

#include "base/strbuf.h"

static const Source *read_file(Sources *s, FILE *f, const char *path, const char **error) {
  /* Reading may run out of memory; the file must be closed before the failure goes on. */
  jmp_buf here;
  jmp_buf *before = arena_guard(s->arena, &here);
  if (setjmp(here)) {
    fclose(f);
    arena_guard(s->arena, before);
    arena_fail(s->arena);
  }
  StrBuf all = strbuf(s->arena);
  char block[16 * 1024];
  for (size_t got; all.n <= SOURCE_MAX_BYTES && (got = fread(block, 1, sizeof block, f)) > 0;)
    sb_putn(&all, block, got);
  const char *text = sb_text(&all);
  size_t len = all.n;
  arena_guard(s->arena, before);
  int failed = ferror(f);
  fclose(f);
  if (failed) {
    *error = "it cannot be read (is it a directory?)";
    return NULL;
  }
  size_t mark = len >= 3 && memcmp(text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0; /* byte order mark of some editors */
  if (!source_add(s, arena_strdup(s->arena, path), text + mark, len - mark)) {
    *error = "it is larger than 64 MiB";
    return NULL;
  }
  Source *file = &s->files.at[s->files.n - 1];
  file->is_file = 1;
  return file;
}

const Source *source_read_model(Sources *s, const char *path, const char **error) {
  FILE *f = lag_open_to_read(path);
  if (f) return read_file(s, f, path, error);
  *error = lag_read_error();
  return NULL;
}

FILE *source_open(const char *path, const char **error) {
  struct stat st;
  int fd = open(path, O_RDONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC); /* a pipe without a writer must not block */
  FILE *f = NULL;
  if (fd < 0) *error = strerror(errno);
  else if (fstat(fd, &st) != 0 || !S_ISREG(st.st_mode)) *error = "it is not a regular file";
  else if (!(f = fdopen(fd, "rb"))) *error = strerror(errno);
  if (!f && fd >= 0) close(fd);
  return f;
}

const Source *source_read(Sources *s, const char *path, const char **error) {
  FILE *f = source_open(path, error);
  return f ? read_file(s, f, path, error) : NULL;
}

int source_is_readable(const char *path) {
  const char *error;
  FILE *f = source_open(path, &error);
  if (f) fclose(f);
  return f != NULL;
}
