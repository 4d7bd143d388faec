/* StrBuf: growing text in an arena; NUL-terminated once it is not empty. */
#pragma once

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

/* Appends s[n] with control characters and characters that reverse the direction of text shown as <U+202E>, except
 * those of `keep`. */
void sb_visible(StrBuf *b, const char *s, size_t n, const char *keep);

/* Appends the text as a string of JSON, in quotes. */
void sb_json(StrBuf *b, const char *text);

/* The text; "" when it is empty. */
const char *sb_text(const StrBuf *b);
