/* Numbers and texts as bytes. */
#include "emit/program_bytes.h"

#include <string.h>

void put_word(StrBuf *out, uint32_t x) {
  const char bytes[] = {(char)(x & 255), (char)(x >> 8 & 255), (char)(x >> 16 & 255), (char)(x >> 24)};
  sb_putn(out, bytes, sizeof bytes);
}

void put_words(StrBuf *out, const uint32_t *x, uint32_t n) {
  put_word(out, n);
  for (uint32_t i = 0; i < n; i++) put_word(out, x[i]);
}

void put_signed(StrBuf *out, int64_t x) {
  put_word(out, (uint32_t)((uint64_t)x & UINT32_MAX));
  put_word(out, (uint32_t)((uint64_t)x >> 32));
}

void put_number(StrBuf *out, double x) {
  int64_t bits;
  memcpy(&bits, &x, sizeof bits);
  put_signed(out, bits);
}

void put_text(StrBuf *out, const char *s) {
  uint32_t n = s ? (uint32_t)strlen(s) : 0;
  put_word(out, s ? n + 1 : 0);
  for (uint32_t i = 0; s && i < n + 1; i += 4) {
    char four[4] = {0};
    memcpy(four, s + i, n + 1 - i < 4 ? n + 1 - i : 4);
    sb_putn(out, four, 4);
  }
}
