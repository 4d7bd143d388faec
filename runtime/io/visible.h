/* Makes hidden characters visible in messages and titles: C0 and C1 controls, DEL, and characters that change the
 * direction of text (Unicode TR36, "bidirectional text spoofing") are shown as <U+202E>, a byte that is not UTF-8 as
 * <9B>. The compiler is built with a copy of this file (Makefile). */
#pragma once

#include <stdio.h>
#include <string.h>

enum { VISIBLE_SIZE = 16 };

static inline int is_hidden(unsigned long code) {
  return code < 0x20 || (code >= 0x7f && code < 0xa0) || code == 0x61c || code == 0x200e || code == 0x200f ||
         (code >= 0x2028 && code <= 0x202e) || (code >= 0x2066 && code <= 0x2069);
}

/* Decodes the UTF-8 character at s of n > 0 bytes: returns its length and *code. Invalid: length 1, *code = 0xDC00 +
 * the byte. */
static inline size_t utf8_at(const char *s, size_t n, unsigned long *code) {
  static const unsigned long least[] = {0, 0, 0x80, 0x800, 0x10000};
  unsigned char c = (unsigned char)*s;
  size_t len = c < 0x80 ? 1 : c < 0xc0 ? 0 : c < 0xe0 ? 2 : c < 0xf0 ? 3 : c < 0xf8 ? 4 : 0, k = 1;
  *code = len == 1 ? c : len == 0 ? 0 : c & (0x7fu >> len);
  while (k < len && k < n && ((unsigned char)s[k] & 0xc0) == 0x80) *code = *code << 6 | ((unsigned char)s[k++] & 0x3f);
  if (len == 0 || k < len || *code < least[len]) {
    *code = 0xdc00ul + c;
    return 1;
  }
  return len;
}

/* out[VISIBLE_SIZE] := visible form of the character at s of n > 0 bytes. Returns the length of the character in
 * bytes. */
static inline size_t show_visible(const char *s, size_t n, char *out) {
  unsigned long code;
  size_t len = utf8_at(s, n, &code);
  if (len == 1 && code >= 0xdc00ul) snprintf(out, VISIBLE_SIZE, "<%02lX>", (code - 0xdc00ul) & 0xfful);
  else if (is_hidden(code)) snprintf(out, VISIBLE_SIZE, "<U+%04lX>", code);
  else snprintf(out, VISIBLE_SIZE, "%.*s", (int)len, s);
  return len;
}

/* Writes s with hidden characters made visible, except those in `keep`. */
static inline void fput_visible(FILE *f, const char *s, const char *keep) {
  char shown[VISIBLE_SIZE];
  for (size_t n = strlen(s), at = 0; at < n;) {
    if (strchr(keep, s[at])) {
      putc(s[at++], f);
    } else {
      at += show_visible(s + at, n - at, shown);
      fputs(shown, f);
    }
  }
}
