/* The choice of copies is the cheapest path over a block of places, at fixed prices; then the range coder. */
#include "base/lzma.h"

#include <stdint.h>
#include <string.h>

enum {
  STATES = 12,
  POSITIONS = 4, /* 1 << pb */
  REPS = 4,      /* distances that are remembered */
  LEAST = 2,
  MOST = 273, /* lengths of copies */
  HALF = 1024 /* the probability 1/2 */
};

/* --- the range coder --- */

typedef uint16_t Prob;
typedef struct {
  Prob far, very_far, low[POSITIONS][8], middle[POSITIONS][8], high[256];
} Lengths;

typedef struct {
  const unsigned char *s;
  StrBuf *out;
  uint64_t low;
  uint32_t range, held, nheld, state, rep[REPS];
  struct {
    Prob is_copy[STATES][POSITIONS], is_rep[STATES], not_rep0[STATES], not_rep1[STATES], not_rep2[STATES];
    Prob is_long[STATES][POSITIONS], literal[3][256], slot[4][64], low_bits[128], align[16];
    Lengths of_copy, of_rep;
  } p;
} Lzma;

static void put_low(Lzma *z) {
  if (z->low < 0xff000000u || z->low >> 32) {
    int carry = (int)(z->low >> 32);
    for (uint32_t k = 0; k < z->nheld; k++) sb_putc(z->out, (char)((k ? 255 : z->held) + (uint32_t)carry));
    z->nheld = 0;
    z->held = (uint32_t)(z->low >> 24 & 255);
  }
  z->nheld++;
  z->low = (z->low & 0x00ffffff) << 8;
}

static void put_bit(Lzma *z, Prob *p, uint32_t bit) {
  uint32_t bound = (z->range >> 11) * *p;
  if (bit) {
    z->low += bound;
    z->range -= bound;
    *p = (Prob)(*p - (*p >> 5));
  } else {
    z->range = bound;
    *p = (Prob)(*p + ((2 * HALF - *p) >> 5));
  }
  for (; z->range < 1u << 24; z->range <<= 8) put_low(z);
}

static void put_tree(Lzma *z, Prob *p, uint32_t bits, uint32_t x) {
  for (uint32_t node = 1; bits--; node = 2 * node + (x >> bits & 1)) put_bit(z, &p[node], x >> bits & 1);
}

/* The low bits first. */
static void put_reverse(Lzma *z, Prob *p, uint32_t bits, uint32_t x) {
  for (uint32_t node = 1; bits--; node = 2 * node + (x & 1), x >>= 1) put_bit(z, &p[node], x & 1);
}

static void put_length(Lzma *z, Lengths *p, uint32_t length, uint32_t position) {
  uint32_t x = length - LEAST;
  put_bit(z, &p->far, x >= 8);
  if (x < 8) {
    put_tree(z, p->low[position], 3, x);
    return;
  }
  put_bit(z, &p->very_far, x >= 16);
  if (x < 16) put_tree(z, p->middle[position], 3, x - 8);
  else put_tree(z, p->high, 8, x - 16);
}

static uint32_t bits_of(uint32_t x) {
  uint32_t n = 0;
  for (; x; x >>= 1) n++;
  return n;
}

static void put_distance(Lzma *z, uint32_t d, uint32_t length) {
  uint32_t n = bits_of(d), slot = d < 4 ? d : 2 * (n - 1) + (d >> (n - 2) & 1), bits = slot < 4 ? 0 : (slot >> 1) - 1;
  uint32_t more = slot < 4 ? 0 : d - ((2 | (slot & 1)) << bits);
  put_tree(z, z->p.slot[length - LEAST < 3 ? length - LEAST : 3], 6, slot);
  if (slot < 4) return;
  if (slot < 14) {
    put_reverse(z, z->p.low_bits + ((2 | (slot & 1)) << bits) - slot, bits, more);
    return;
  }
  for (uint32_t k = bits; k-- > 4;) { /* even chances */
    z->range >>= 1;
    if (more >> k & 1) z->low += z->range;
    for (; z->range < 1u << 24; z->range <<= 8) put_low(z);
  }
  put_reverse(z, z->p.align, 4, more & 15);
}

static void put_literal(Lzma *z, size_t at) {
  uint32_t x = z->s[at], node = 1, same = z->state >= 7;
  for (uint32_t k = 8; k--;) {
    uint32_t bit = x >> k & 1, there = same ? z->s[at - z->rep[0] - 1] >> k & 1u : 0;
    put_bit(z, &z->p.literal[same ? 1 + there : 0][node], bit);
    node = 2 * node + bit;
    same &= bit == there;
  }
  z->state = z->state < 4 ? 0 : z->state < 10 ? z->state - 3 : z->state - 6;
}

/* One step: a literal (length 1, distance none), or a copy from `distance` + 1 back. */
static void put_step(Lzma *z, size_t at, uint32_t length, uint32_t distance) {
  uint32_t s = z->state, position = at & (POSITIONS - 1), k = 0;
  int copies = length >= LEAST;
  put_bit(z, &z->p.is_copy[s][position], (uint32_t)copies);
  if (!copies) {
    put_literal(z, at);
    return;
  }
  while (k < REPS && z->rep[k] != distance) k++;
  put_bit(z, &z->p.is_rep[s], k < REPS);
  if (k < REPS) {
    put_bit(z, &z->p.not_rep0[s], k > 0);
    if (!k) put_bit(z, &z->p.is_long[s][position], 1);
    if (k) put_bit(z, &z->p.not_rep1[s], k > 1);
    if (k > 1) put_bit(z, &z->p.not_rep2[s], k > 2);
  }
  put_length(z, k < REPS ? &z->p.of_rep : &z->p.of_copy, length, position);
  if (k == REPS) put_distance(z, distance, length);
  memmove(z->rep + 1, z->rep, (k < REPS ? k : REPS - 1) * sizeof *z->rep);
  z->rep[0] = distance;
  z->state = k < REPS ? (s < 7 ? 8 : 11) : (s < 7 ? 7 : 10);
}

/* --- the choice of steps --- */

enum { BLOCK = 1 << 15, SLOTS = 1 << 16, DEPTH = 48, LONG = 128, NONE = UINT16_MAX };

/* The cheapest way to a place: its last step, and the distances that are remembered then. */
typedef struct {
  uint32_t price, length, distance, rep[REPS];
} Way;

typedef struct {
  const unsigned char *s;
  size_t n;
  uint32_t *head, *before; /* places + 1 with the same four bytes, the last first */
  size_t known;
} Finder;

static uint32_t four_hash(const unsigned char *s) {
  uint32_t x;
  memcpy(&x, s, sizeof x);
  return (x * 0x9e3779b1u) >> 16;
}

static void know(Finder *f, size_t end) {
  for (; f->known < end && f->known + 4 <= f->n; f->known++) {
    uint32_t *head = &f->head[four_hash(f->s + f->known)];
    f->before[f->known] = *head;
    *head = (uint32_t)f->known + 1;
  }
}

static uint32_t common(const Finder *f, size_t from, size_t at, uint32_t most) {
  uint32_t k = 0;
  while (k < most && f->s[from + k] == f->s[at + k]) k++;
  return k;
}

/* Prices in sixteenths of a bit, about what programs cost. */
static uint32_t price_of_length(uint32_t length) { return length < 10 ? 52 : length < 18 ? 72 : 120; }
static uint32_t price_of_distance(uint32_t d) { return 64 + (d < 4 ? 0 : 16 * (bits_of(d) - 2) - (d >= 128 ? 16 : 0)); }

static void relax(Way *w, uint32_t length, uint32_t price, uint32_t distance) {
  Way *to = w + length;
  if (w->price + price >= to->price) return;
  *to = *w;
  to->price = w->price + price, to->length = length, to->distance = distance;
  if (length == 1) return;
  uint32_t k = 0;
  while (k < REPS - 1 && w->rep[k] != distance) k++;
  memmove(to->rep + 1, w->rep, k * sizeof *w->rep);
  to->rep[0] = distance;
}

/* The steps from a place; returns the length of one that is long enough to be taken, else 0. */
static uint32_t relax_all(Finder *f, Way *w, size_t at, uint32_t most) {
  uint32_t best = LEAST + 1, longest = 0, same = w->rep[0] < at && f->s[at] == f->s[at - w->rep[0] - 1];
  relax(w, 1, w->length > 1 && same ? 100 : w->length > 1 ? 110 : 90, 0);
  if (most < LEAST) return 0;
  for (uint32_t k = 0; k < REPS; k++) {
    uint32_t length = w->rep[k] < at ? common(f, at - w->rep[k] - 1, at, most) : 0;
    if (length >= LONG && length > longest) relax(w, longest = length, 40 + 16 * k, w->rep[k]);
    for (uint32_t m = LEAST; m <= length && length < LONG; m++)
      relax(w, m, 30 + 12 * k + price_of_length(m), w->rep[k]);
  }
  if (longest || at + 4 > f->n) return longest;
  know(f, at);
  uint32_t next = f->head[four_hash(f->s + at)];
  for (int turn = 0; next && turn < DEPTH && best < most; turn++, next = f->before[next - 1]) {
    uint32_t length = common(f, next - 1, at, most), d = (uint32_t)at - next;
    if (length <= best) continue;
    if (length >= LONG) {
      relax(w, length, 100 + price_of_distance(d), d);
      return length;
    }
    for (uint32_t m = best + 1; m <= length; m++) relax(w, m, 30 + price_of_length(m) + price_of_distance(d), d);
    best = length;
  }
  return 0;
}

/* Writes the steps of one block of n places. */
static void put_block(Lzma *z, Finder *f, Way *way, size_t at, uint32_t n) {
  for (uint32_t i = 0; i <= n; i++) way[i].price = UINT32_MAX;
  way[0] = (Way){.price = 0};
  memcpy(way[0].rep, z->rep, sizeof z->rep);
  for (uint32_t i = 0; i < n;) {
    uint32_t jump = relax_all(f, &way[i], at + i, n - i < MOST ? n - i : MOST);
    for (i += jump ? jump : 1; i < n && way[i].price == UINT32_MAX;) i++;
  }
  uint32_t count = 0;
  for (uint32_t i = n; i; i -= way[i].length, count++) way[i - way[i].length].price = way[i].length;
  for (uint32_t i = 0; i < n;) {
    const Way *to = &way[i + way[i].price];
    put_step(z, at + i, to->length, to->distance);
    i += way[i].price;
  }
}

void lzma_append(const StrBuf *bytes, StrBuf *out) {
  Arena *a = out->arena;
  Lzma *z = ARENA_ARRAY(a, Lzma, 1);
  Way *way = ARENA_ARRAY(a, Way, BLOCK + 1);
  Finder f = {.s = (const unsigned char *)bytes->at, .n = bytes->n};
  f.head = ARENA_ARRAY(a, uint32_t, SLOTS);
  f.before = ARENA_ARRAY(a, uint32_t, bytes->n + 1);
  z->s = f.s, z->out = out, z->range = UINT32_MAX, z->nheld = 1;
  Prob *p = (Prob *)&z->p;
  for (size_t k = 0; k < sizeof z->p / sizeof *p; k++) p[k] = HALF;
  for (int k = 0; k < 4; k++) sb_putc(out, (char)(bytes->n >> 8 * k & 255));
  for (size_t at = 0; at < f.n; at += BLOCK) put_block(z, &f, way, at, (uint32_t)(f.n - at < BLOCK ? f.n - at : BLOCK));
  for (int k = 0; k < 5; k++) put_low(z);
}
