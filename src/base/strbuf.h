/* StrBuf: text that grows, in an arena; always NUL-terminated once something was put in. */
#ifndef LAGC_STRBUF_H
#define LAGC_STRBUF_H

#include "base/arena.h"

typedef struct {
  Arena *arena;
  char *at;
  size_t n, cap;
} StrBuf;

StrBuf strbuf(Arena *a);
void sb_putc(StrBuf *b, char c);
void sb_puts(StrBuf *b, const char *s);
void sb_putn(StrBuf *b, const char *s, size_t n);
void sb_printf(StrBuf *b, const char *fmt, ...) __attribute__((format(printf, 2, 3)));

/* s, with control characters and those that turn the direction of text shown as <U+202E>; characters of `keep` stay. */
void sb_visible(StrBuf *b, const char *s, size_t n, const char *keep);

/* The text; "" when nothing was put in. */
const char *sb_text(const StrBuf *b);

#endif
