/* Parts of pages. */
#pragma once

#include "commands/compiler.h"

/* Appends bytes as text: 13 bits, the low ones first, as two of the 91 printable characters without " < and \;
 * up to 6 bits at the end as one. */
void page_bytes(StrBuf *out, const char *bytes, size_t n);
/* Appends a text as JSON that may stand in a script: without `<`, nothing in it is markup. */
void page_text(StrBuf *out, Arena *a, const char *text);
/* Appends a module that stands beside liblag, as page_bytes; packed, unless it is NAME.gz. 0, with what to install,
 * where it was not built. */
int page_module(Compiler *c, const char *name, StrBuf *out);

/* The script of live pages, packed, as page_bytes: @LIVE@ of their frame. */
const char *page_script(Arena *a);

/* A mark of a frame, and what takes its place, once a line. */
typedef struct {
  const char *mark, *text;
} PageMark;
void page_fill(StrBuf *out, const char *const *lines, size_t nlines, const PageMark *marks, size_t n);
