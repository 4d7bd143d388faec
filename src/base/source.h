/* Sources: the texts of a compilation, and how an offset becomes file, line and column.
 *
 * All texts share one range of offsets (each starts where the one before ended, plus one), so that a Span of two
 * numbers says file and place at once. Offset 0 is never used by a text: a zero Span means "no place". */
#pragma once

#include <stdint.h>
#include <stdio.h>

#include "base/vec.h"

typedef struct {
  uint32_t begin, end; /* half open */
} Span;

static inline Span span_join(Span a, Span b) {
  if (!a.end) return b;
  if (!b.end) return a;
  return (Span){a.begin < b.begin ? a.begin : b.begin, a.end > b.end ? a.end : b.end};
}

typedef struct {
  const char *path; /* as the user named it */
  int is_file;      /* or a word of the command line */
  const char *text; /* NUL-terminated */
  uint32_t len;
  uint32_t base; /* offset of text[0] */
  VEC(uint32_t) lines; /* offset of each line in text */
} Source;

typedef struct {
  Arena *arena;
  VEC(Source) files;
  uint32_t next_base;
  const char *library; /* folder of files that models name from anywhere; NULL: none */
  VEC(const char *) absent; /* files that were looked for beside the one that names them, and found in the library */
} Sources;

typedef struct {
  const Source *file;
  uint32_t line, column;      /* from 1; the column counts characters, not bytes */
  const char *line_text;      /* start of that line */
  uint32_t line_len;          /* without its newline */
  uint32_t line_byte;         /* byte index of the place in the line */
} Place;

enum { SOURCE_MAX_BYTES = 64 * 1024 * 1024 };

Sources *sources_new(Arena *a);

/* Adds a text (not copied: it must outlive the sources). Texts over SOURCE_MAX_BYTES: NULL. */
const Source *source_add(Sources *s, const char *path, const char *text, size_t len);

/* Reads the model, a file or a pipe, into the arena. On failure NULL, with the reason in *error (part of an English
 * sentence). */
const Source *source_read_model(Sources *s, const char *path, const char **error);
/* Reads a file that a model names. It must be a regular file: models come from anywhere, and must not make lagc wait
 * for a pipe or touch a device. */
const Source *source_read(Sources *s, const char *path, const char **error);

/* Opens a regular file for reading, or NULL with *error. */
FILE *source_open(const char *path, const char **error);

/* The text of an offset, or NULL; at once, where a place takes as long as its line. */
const Source *source_of(const Sources *s, uint32_t offset);

/* The place of an offset; file NULL for offset 0 and offsets past all texts. */
Place source_place(const Sources *s, uint32_t offset);

/* `path` as written in the file `from`: relative to its folder, in one spelling for each file. */
const char *path_relative_to(Arena *a, const char *from, const char *path);

/* The file that is `path` in the file `from`: beside it; or, where none can be read there, in the library that comes
 * with lagc. */
const char *source_locate(Sources *s, const char *from, const char *path);
int source_is_readable(const char *path);
