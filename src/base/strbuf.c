/* Growing text: doubles its block in the arena when it is full. */
#include "base/strbuf.h"

#include "base/visible.h" /* generated: a copy of runtime/io/visible.h */

#include <stdio.h>
#include <string.h>

StrBuf strbuf(Arena *a) { return (StrBuf){.arena = a}; }

/* Room for n more bytes and the NUL. */
static void reserve(StrBuf *b, size_t n) {
  if (b->n + n + 1 <= b->cap) return;
  size_t cap = b->cap ? b->cap : 128;
  while (cap < b->n + n + 1) cap *= 2;
  char *at = arena_alloc(b->arena, cap);
  if (b->n) memcpy(at, b->at, b->n);
  b->at = at;
  b->cap = cap;
}

void sb_putn(StrBuf *b, const char *s, size_t n) {
  reserve(b, n);
  memcpy(b->at + b->n, s, n);
  b->n += n;
  b->at[b->n] = '\0';
}

void sb_puts(StrBuf *b, const char *s) { sb_putn(b, s, strlen(s)); }
void sb_putc(StrBuf *b, char c) { sb_putn(b, &c, 1); }

void sb_printf(StrBuf *b, const char *fmt, ...) {
  va_list ap, again;
  va_start(ap, fmt);
  va_copy(again, ap);
  int n = vsnprintf(NULL, 0, fmt, again);
  va_end(again);
  if (n > 0) {
    reserve(b, (size_t)n);
    vsnprintf(b->at + b->n, (size_t)n + 1, fmt, ap);
    b->n += (size_t)n;
  }
  va_end(ap);
}

const char *sb_text(const StrBuf *b) { return b->at ? b->at : ""; }

void sb_visible(StrBuf *b, const char *s, size_t n, const char *keep) {
  char shown[VISIBLE_SIZE];
  for (size_t at = 0; at < n;) {
    if (s[at] && strchr(keep, s[at])) sb_putc(b, s[at++]);
    else {
      at += show_visible(s + at, n - at, shown);
      sb_puts(b, shown);
    }
  }
}

void sb_json(StrBuf *b, const char *text) {
  StrBuf visible = strbuf(b->arena);
  sb_visible(&visible, text, strlen(text), "\n\t");
  sb_putc(b, '"');
  for (const char *s = sb_text(&visible); *s; s++) {
    if (*s == '"' || *s == '\\') sb_printf(b, "\\%c", *s);
    else if ((unsigned char)*s < 0x20) sb_printf(b, "\\u%04x", (unsigned)*s);
    else sb_putc(b, *s);
  }
  sb_putc(b, '"');
}
