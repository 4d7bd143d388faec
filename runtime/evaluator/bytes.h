/* Reading of bytes that may be wrong: after the first fault all reads give 0, and `why` says what is wrong. */
#ifndef EVALUATOR_BYTES_H
#define EVALUATOR_BYTES_H

#include <stddef.h>
#include <stdint.h>

/* Memory that is freed together. */
typedef struct Memory {
  struct Memory *before;
} Memory;

typedef struct {
  const unsigned char *at, *end;
  Memory **memory;
  const char *why; /* NULL: no fault so far */
} Bytes;

/* Room for n elements, zeroed; NULL after a fault or without memory. */
void *lag_bytes_room(Bytes *b, size_t n, size_t size);

uint32_t lag_bytes_word(Bytes *b);
int64_t lag_bytes_signed(Bytes *b);
double lag_bytes_number(Bytes *b);
const char *lag_bytes_text(Bytes *b); /* NULL, or a text */

/* A word below `end`; as an int. */
uint32_t lag_bytes_below(Bytes *b, uint32_t end);
int lag_bytes_int(Bytes *b, int least, int most);

/* A number of elements that take at least `size` bytes each. */
uint32_t lag_bytes_count(Bytes *b, size_t size);
const uint32_t *lag_bytes_words(Bytes *b, uint32_t n);
const double *lag_bytes_numbers(Bytes *b, size_t n);

/* Records a fault unless ok. Returns whether there is none so far. */
int lag_bytes_need(Bytes *b, int ok, const char *why);

/* A list whose elements take at least `least` bytes: zeroed room for *n elements of `size`. */
static inline void *list(Bytes *b, int *n, size_t least, size_t size) {
  *n = (int)lag_bytes_count(b, least);
  return lag_bytes_room(b, (size_t)*n, size);
}

/* An index below `end`. */
static inline int below(Bytes *b, int end) { return (int)lag_bytes_below(b, (uint32_t)end); }

static inline int *ints_of(Bytes *b, int n, int end) {
  int *x = lag_bytes_room(b, (size_t)n, sizeof *x);
  for (int i = 0; x && i < n; i++) x[i] = below(b, end);
  return x;
}

static inline int flag(Bytes *b) { return lag_bytes_int(b, 0, 1); }

#endif
