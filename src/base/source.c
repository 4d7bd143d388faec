/* Texts of a compilation: finds lines and columns of offsets, and joins paths. */
#include "base/source.h"

#include <string.h>
#include "base/posix.h" /* generated: a copy of runtime/io/posix.h */


Sources *sources_new(Arena *a) {
  Sources *s = ARENA_NEW(a, Sources);
  s->arena = a;
  s->next_base = 1;
  return s;
}

const Source *source_add(Sources *s, const char *path, const char *text, size_t len) {
  if (len > SOURCE_MAX_BYTES || s->next_base > UINT32_MAX - SOURCE_MAX_BYTES - 2) return NULL;
  Source file = {.path = path, .text = text, .len = (uint32_t)len, .base = s->next_base};
  s->next_base += file.len + 1;
  vec_push(s->arena, &file.lines, 0);
  for (const char *end;
       (end = memchr(text + file.lines.at[file.lines.n - 1], '\n', len - file.lines.at[file.lines.n - 1]));)
    vec_push(s->arena, &file.lines, (uint32_t)(end - text) + 1);
  vec_push(s->arena, &s->files, file);
  return &s->files.at[s->files.n - 1];
}

/* The number of the line, from 1. */
static uint32_t line_of(const Source *f, uint32_t at) {
  uint32_t lo = 0, hi = f->lines.n;
  while (hi - lo > 1) {
    uint32_t middle = lo + (hi - lo) / 2;
    if (f->lines.at[middle] <= at) lo = middle;
    else hi = middle;
  }
  return lo + 1;
}

const Source *source_of(const Sources *s, uint32_t offset) {
  for (uint32_t i = 0; i < s->files.n; i++)
    if (offset >= s->files.at[i].base && offset <= s->files.at[i].base + s->files.at[i].len) return &s->files.at[i];
  return NULL;
}

Place source_place(const Sources *s, uint32_t offset) {
  const Source *f = source_of(s, offset);
  if (!f) return (Place){0};
  uint32_t at = offset - f->base, line = line_of(f, at), start = f->lines.at[line - 1], column = 1;
  for (uint32_t k = start; k < at; k++)
    if (((unsigned char)f->text[k] & 0xC0) != 0x80) column++;
  const char *text = f->text + start;
  uint32_t len = 0;
  while (start + len < f->len && text[len] != '\n') len++;
  len -= len > 0 && text[len - 1] == '\r'; /* elsewhere a \r is part of the line */
  return (Place){
      .file = f, .line = line, .column = column, .line_text = text, .line_len = len, .line_byte = at - start};
}

/* --- paths --- */

/* Copies `path` to `out` without its `.` parts, and with `a/..` removed; returns the new end. */
static size_t add_parts(char *out, size_t n, const char *path) {
  while (*path) {
    size_t len = strcspn(path, "/");
    const char *part = path;
    path += len + (path[len] == '/');
    if (len == 0 || (len == 1 && part[0] == '.')) continue;
    size_t last = n;
    while (last > 0 && out[last - 1] != '/') last--;
    int up = len == 2 && memcmp(part, "..", 2) == 0;
    if (up && n > last && !(n - last == 2 && memcmp(out + last, "..", 2) == 0)) {
      n = last ? last - 1 : 0;
      if (last == 1) n = 1; /* the root */
      continue;
    }
    if (n && out[n - 1] != '/') out[n++] = '/';
    memcpy(out + n, part, len);
    n += len;
  }
  return n;
}

const char *path_relative_to(Arena *a, const char *from, const char *path) {
  char *out = arena_alloc(a, strlen(from) + strlen(path) + 3);
  size_t n = 0;
  const char *slash = lag_last_slash(from);
  int whole = lag_is_absolute(path);
  if ((whole ? path : from)[0] == '/') out[n++] = '/';
  if (!whole && slash) n = add_parts(out, n, arena_strndup(a, from, (size_t)(slash - from)));
  n = add_parts(out, n, path);
  out[n] = '\0';
  return out;
}

const char *source_locate(Sources *s, const char *from, const char *path) {
  const char *beside = path_relative_to(s->arena, from, path);
  if (!s->library || lag_is_absolute(path) || source_is_readable(beside)) return beside;
  const char *other = arena_printf(s->arena, "%s/%s", s->library, path);
  if (!source_is_readable(other)) return beside;
  vec_push(s->arena, &s->absent, beside);
  return other;
}
