/* Reading of bytes that may be wrong. */
#include "evaluator/bytes.h"

#include <stdlib.h>
#include <string.h>

int lag_bytes_need(Bytes *b, int ok, const char *why) {
  if (!ok && !b->why) b->why = why;
  return !b->why;
}

void *lag_bytes_room(Bytes *b, size_t n, size_t size) {
  size_t head = sizeof(double) > sizeof(Memory) ? sizeof(double) : sizeof(Memory);
  if (b->why) return NULL;
  char *block = n < (SIZE_MAX - 2 * head) / size ? calloc(1, head + n * size + 1) : NULL;
  if (!lag_bytes_need(b, block != NULL, "out of memory")) return NULL;
  ((Memory *)(void *)block)->before = *b->memory;
  *b->memory = (Memory *)(void *)block;
  return block + head;
}

uint32_t lag_bytes_word(Bytes *b) {
  if (!lag_bytes_need(b, b->end - b->at >= 4, "it ends too early")) return 0;
  const unsigned char *x = b->at;
  b->at += 4;
  return (uint32_t)x[0] | (uint32_t)x[1] << 8 | (uint32_t)x[2] << 16 | (uint32_t)x[3] << 24;
}

int64_t lag_bytes_signed(Bytes *b) {
  uint64_t low = lag_bytes_word(b), bits = low | (uint64_t)lag_bytes_word(b) << 32;
  int64_t x;
  memcpy(&x, &bits, sizeof x);
  return x;
}

double lag_bytes_number(Bytes *b) {
  int64_t bits = lag_bytes_signed(b);
  double x;
  memcpy(&x, &bits, sizeof x);
  return x;
}

const char *lag_bytes_text(Bytes *b) {
  uint32_t n = lag_bytes_word(b), room = n / 4 * 4 + (n % 4 ? 4 : 0);
  if (!n || b->why || !lag_bytes_need(b, room >= n && (size_t)(b->end - b->at) >= room, "a text ends too late"))
    return NULL;
  const char *from = (const char *)b->at;
  if (!lag_bytes_need(b, memchr(from, 0, n) == from + n - 1, "a text has no end")) return NULL;
  char *text = lag_bytes_room(b, n, 1);
  if (text) memcpy(text, from, n);
  b->at += room;
  return text;
}

uint32_t lag_bytes_below(Bytes *b, uint32_t end) {
  uint32_t x = lag_bytes_word(b);
  return lag_bytes_need(b, x < end, "an index is out of range") ? x : 0;
}

int lag_bytes_int(Bytes *b, int least, int most) {
  int64_t x = (int32_t)lag_bytes_word(b);
  return lag_bytes_need(b, x >= least && x <= most, "a number is out of range") ? (int)x : least > 0 ? least : 0;
}

uint32_t lag_bytes_count(Bytes *b, size_t size) {
  uint32_t n = lag_bytes_word(b);
  return lag_bytes_need(b, n <= (size_t)(b->end - b->at) / size && n < INT32_MAX, "a list is too long") ? n : 0;
}

const uint32_t *lag_bytes_words(Bytes *b, uint32_t n) {
  uint32_t *x = lag_bytes_room(b, n, sizeof *x);
  for (uint32_t i = 0; x && i < n; i++) x[i] = lag_bytes_word(b);
  return x;
}

const double *lag_bytes_numbers(Bytes *b, size_t n) {
  double *x = lag_bytes_room(b, n, sizeof *x);
  for (size_t i = 0; x && i < n; i++) x[i] = lag_bytes_number(b);
  return x;
}
