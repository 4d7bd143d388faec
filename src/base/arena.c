/* Arena: a list of chunks, the newest first; requests larger than a chunk get one of their own. */
#include "base/arena.h"

#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "numeric/poison.h"

typedef struct Chunk Chunk;
struct Chunk {
  Chunk *next;
  size_t serial; /* from 1, in order of allocation */
  size_t size, used;
  size_t touched; /* bytes that may differ from 0 */
  max_align_t data[];
};

/* Blocks given up, by size: four classes between powers of two, from 16 bytes on. */
typedef struct FreeBlock {
  struct FreeBlock *next;
} FreeBlock;
enum { FREE_LEAST = 16, FREE_CLASSES = 52 };

struct Arena {
  ArenaConfig config;
  FreeBlock *given_up[FREE_CLASSES];
  Chunk *chunks;
  jmp_buf *handler;
  size_t used, serial;
  int hit_limit;
};

/* Zeroed, since the system hands out new pages so: large tables cost memory only where they are written. */
static void *system_alloc(void *user, size_t n) {
  (void)user;
  return calloc(1, n);
}

static void system_dealloc(void *user, void *p) {
  (void)user;
  free(p);
}

Arena *arena_new(const ArenaConfig *config) {
  ArenaConfig c = config ? *config : (ArenaConfig){0};
  if (!c.alloc) {
    c.alloc = system_alloc;
    c.dealloc = system_dealloc;
  }
  if (!c.chunk) c.chunk = 64 * 1024;
  Arena *a = c.alloc(c.user, sizeof *a);
  if (!a) return NULL;
  *a = (Arena){.config = c};
  return a;
}

/* n bytes, rounded up to the alignment of any type. */
static size_t whole_units(size_t n) {
  const size_t align = sizeof(max_align_t);
  return (n + align - 1) / align * align;
}

/* Frees the chunk to which *at points. */
static void free_chunk(Arena *a, Chunk **at) {
  Chunk *c = *at;
  *at = c->next;
  a->used -= c->used;
  UNPOISON(c->data, c->size);
  a->config.dealloc(a->config.user, c);
}

/* Frees the chunks that are newer than number `last`. */
static void free_chunks(Arena *a, size_t last) {
  while (a->chunks && a->chunks->serial > last) free_chunk(a, &a->chunks);
}

void arena_free(Arena *a) {
  if (!a) return;
  free_chunks(a, 0);
  a->config.dealloc(a->config.user, a);
}

/* The class of blocks of at least n bytes, where n is not at its begin less one; FREE_CLASSES: none. */
static uint32_t free_class(size_t n, size_t *begin) {
  uint32_t k = 0;
  size_t power = FREE_LEAST;
  for (; power <= n / 2; power *= 2) k += 4;
  k += (uint32_t)((n - power) / (power / 4));
  *begin = power + k % 4 * (power / 4);
  return k < FREE_CLASSES ? k : FREE_CLASSES;
}

/* A block of n bytes that was given up; NULL: there is none. */
static void *take_given_up(Arena *a, size_t n) {
  size_t begin;
  n = whole_units(n);
  uint32_t k = n ? free_class(n, &begin) : FREE_CLASSES;
  if (k < FREE_CLASSES && begin < n) k++;
  FreeBlock *b = k < FREE_CLASSES ? a->given_up[k] : NULL;
  if (b) a->given_up[k] = b->next;
  return b;
}

ArenaMark arena_mark(const Arena *a) {
  const Chunk *c = a->chunks;
  return c ? (ArenaMark){c->serial, c->used} : (ArenaMark){0};
}

void arena_forget(Arena *a, ArenaMark since) {
  memset(a->given_up, 0, sizeof a->given_up);
  free_chunks(a, since.serial);
  Chunk *c = a->chunks;
  if (!c || c->serial != since.serial) return;
  POISON((char *)c->data + since.in_chunk, c->size - since.in_chunk);
  a->used -= c->used - since.in_chunk;
  c->used = since.in_chunk;
}

void arena_release(Arena *a, void *block, size_t n) {
  Chunk *c = a->chunks;
  if (n > a->config.chunk) {
    Chunk **at = &a->chunks;
    while (*at && (void *)(*at)->data != block) at = &(*at)->next;
    if (*at) free_chunk(a, at);
  } else if (c && (char *)block >= (char *)c->data && (char *)block < (char *)c->data + c->used) {
    size_t whole = whole_units(n) + POISON_GAP;
    POISON(block, n);
    if ((char *)block + whole != (char *)c->data + c->used) return;
    c->used -= whole;
    a->used -= whole;
  }
}

void arena_recycle(Arena *a, void *block, size_t n) {
  const Chunk *c = a->chunks;
  size_t begin;
  int latest = (char *)block + whole_units(n) + POISON_GAP == (char *)c->data + c->used;
  uint32_t k = n ? free_class(whole_units(n), &begin) : FREE_CLASSES;
  /* under the address sanitizer their use is reported from now on */
  if (latest || POISON_GAP || n > a->config.chunk || k == FREE_CLASSES) {
    arena_release(a, block, n);
    return;
  }
  FreeBlock *b = block;
  b->next = a->given_up[k];
  a->given_up[k] = b;
}

jmp_buf *arena_guard(Arena *a, jmp_buf *handler) {
  jmp_buf *before = a->handler;
  a->handler = handler;
  return before;
}

_Noreturn void arena_fail(Arena *a) {
  if (!a->handler) abort(); /* a bug: memory was asked for outside every guard */
  longjmp(*a->handler, 1);
}

/* Whether the work was done, and not ended by want of memory. */
static int run_guarded(Arena *outer, Arena *scratch, void (*work)(Arena *scratch, void *data), void *data) {
  jmp_buf here;
  arena_guard(outer, &here);
  arena_guard(scratch, &here);
  if (setjmp(here)) return 0;
  work(scratch, data);
  return 1;
}

void arena_with_scratch(Arena *outer, void (*work)(Arena *scratch, void *data), void *data) {
  size_t most = outer->config.max_bytes;
  Arena *scratch = arena_new(&(ArenaConfig){.max_bytes = most > outer->used ? most - outer->used : most != 0});
  if (!scratch) arena_fail(outer);
  jmp_buf *before = outer->handler;
  int ok = run_guarded(outer, scratch, work, data);
  outer->handler = before;
  outer->hit_limit |= scratch->hit_limit;
  arena_free(scratch);
  if (!ok) arena_fail(outer);
}

static Chunk *chunk_new(Arena *a, size_t n) {
  size_t size = n > a->config.chunk ? n : a->config.chunk;
  Chunk *c = a->config.alloc(a->config.user, sizeof *c + size);
  if (!c) arena_fail(a);
  c->size = size;
  c->used = 0;
  c->touched = a->config.alloc == system_alloc ? 0 : size;
  c->serial = ++a->serial;
  c->next = a->chunks;
  a->chunks = c;
  POISON(c->data, c->size);
  return c;
}

void *arena_alloc(Arena *a, size_t n) {
  if (n > SIZE_MAX / 4) arena_fail(a);
  void *again = take_given_up(a, n);
  if (again) return memset(again, 0, n);
  size_t asked = n;
  n = whole_units(n) + POISON_GAP;
  if (a->config.max_bytes && a->used + n > a->config.max_bytes) {
    a->hit_limit = 1;
    arena_fail(a);
  }
  Chunk *c = a->chunks;
  if (!c || c->size - c->used < n) c = chunk_new(a, n);
  char *p = (char *)c->data + c->used;
  size_t dirty = c->touched > c->used ? c->touched - c->used : 0;
  c->used += n;
  a->used += n;
  if (c->touched < c->used) c->touched = c->used;
  UNPOISON(p, asked);
  if (dirty) memset(p, 0, dirty < asked ? dirty : asked);
  return p;
}

char *arena_strndup(Arena *a, const char *s, size_t n) {
  char *copy = arena_alloc(a, n + 1);
  if (n) memcpy(copy, s, n);
  return copy;
}

char *arena_strdup(Arena *a, const char *s) { return arena_strndup(a, s, strlen(s)); }

char *arena_vprintf(Arena *a, const char *fmt, va_list ap) {
  va_list again;
  va_copy(again, ap);
  int n = vsnprintf(NULL, 0, fmt, again);
  va_end(again);
  if (n < 0) n = 0;
  char *s = arena_alloc(a, (size_t)n + 1);
  vsnprintf(s, (size_t)n + 1, fmt, ap);
  return s;
}

char *arena_printf(Arena *a, const char *fmt, ...) {
  va_list ap;
  va_start(ap, fmt);
  char *s = arena_vprintf(a, fmt, ap);
  va_end(ap);
  return s;
}

size_t arena_used(const Arena *a) { return a->used; }
int arena_hit_limit(const Arena *a) { return a->hit_limit; }
size_t arena_limit(const Arena *a) { return a->config.max_bytes; }
void arena_raise_limit(Arena *a, size_t by) { a->config.max_bytes += a->config.max_bytes ? by : 0; }
