/* Long matches by a hash of blocks: each block that begins at a multiple of STRIDE is found from any later place. */
#include "base/far_copies.h"

#include <stdint.h>
#include <string.h>

enum { BLOCK = 32, STRIDE = 16, SLOTS = 1 << 16 };

static uint32_t block_hash(const char *at) {
  uint64_t h = 0, word;
  for (int k = 0; k < BLOCK; k += 8) {
    memcpy(&word, at + k, sizeof word);
    h = (h ^ word) * 0x9e3779b97f4a7c15u;
  }
  return (uint32_t)(h >> 48);
}

static void put_number(StrBuf *out, size_t x) {
  for (int k = 0; k < 4; k++) sb_putc(out, (char)(x >> 8 * k & 255));
}

void far_copies_append(const StrBuf *bytes, StrBuf *out) {
  const char *s = bytes->at;
  size_t n = bytes->n, done = 0, known = 0, *slot = ARENA_ARRAY(out->arena, size_t, SLOTS); /* places + 1; 0: none */
  memset(slot, 0, SLOTS * sizeof *slot);
  for (size_t i = 0; i + BLOCK <= n; i++) {
    for (; known + BLOCK <= i; known += STRIDE) slot[block_hash(s + known)] = known + 1;
    size_t from = slot[block_hash(s + i)], length = 0;
    if (!from || memcmp(s + --from, s + i, BLOCK) != 0) continue;
    while (i + length < n && s[from + length] == s[i + length]) length++;
    put_number(out, i - done);
    sb_putn(out, s + done, i - done);
    put_number(out, from);
    put_number(out, length);
    done = i + length;
    i = done - 1;
  }
  put_number(out, n - done);
  sb_putn(out, s + done, n - done);
  put_number(out, 0);
  put_number(out, 0);
}
