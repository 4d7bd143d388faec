/* Arena: the memory of one compilation.
 *
 * Everything a compilation allocates lives in one arena and is freed at once by arena_free. No caller checks for
 * NULL: when memory runs out, or the arena's limit is reached, arena_alloc jumps to the handler that arena_guard
 * installed. Only main, the parser (which must free the parser's own stack first) and tests install handlers. */
#pragma once

#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>

typedef struct Arena Arena;

/* Where an arena gets its chunks; a test passes an allocator that fails at the n-th call.
 * alloc returns NULL on failure. max_bytes 0 means no limit. chunk 0 means 64 KiB. */
typedef struct {
  void *(*alloc)(void *user, size_t n);
  void (*dealloc)(void *user, void *p);
  void *user;
  size_t chunk;
  size_t max_bytes;
} ArenaConfig;

/* A new arena; config NULL means malloc without limit. NULL when there is no memory. */
Arena *arena_new(const ArenaConfig *config);
void arena_free(Arena *a);

/* Mark: arena_forget frees all that was allocated since, to which nothing may point any more. For trials that are
 * not kept. */
typedef struct {
  size_t serial, in_chunk;
} ArenaMark;
ArenaMark arena_mark(const Arena *a);
void arena_forget(Arena *a, ArenaMark since);

/* Gives up a block of n bytes, to which nothing may point any more. A block larger than a chunk, and the latest
 * block, are free at once; others with the arena (the address sanitizer reports their use from now on). A block that
 * is not of this arena is left alone. */
void arena_release(Arena *a, void *block, size_t n);

/* The same of a block that is of this arena; later blocks of its size may have its memory. */
void arena_recycle(Arena *a, void *block, size_t n);

/* n zeroed bytes aligned for any type; never NULL (see above). */
void *arena_alloc(Arena *a, size_t n);

/* Copies of a string, and of its first n bytes, with a final NUL. */
char *arena_strdup(Arena *a, const char *s);
char *arena_strndup(Arena *a, const char *s, size_t n);

/* A formatted string. */
char *arena_printf(Arena *a, const char *fmt, ...) __attribute__((format(printf, 2, 3)));
char *arena_vprintf(Arena *a, const char *fmt, va_list ap) __attribute__((format(printf, 2, 0)));

/* Runs work with an arena of its own for values that are not kept, freed at the end; where either arena runs out of
 * memory, or both reach the limit of `outer`, `outer` fails. */
void arena_with_scratch(Arena *outer, void (*work)(Arena *scratch, void *data), void *data);

/* Gives the reason of a failure; returns 0. */
static inline int fail_with(const char **error, const char *why) {
  *error = why;
  return 0;
}

/* Installs the handler that allocation failure jumps to (with value 1); returns the one before. */
jmp_buf *arena_guard(Arena *a, jmp_buf *handler);

/* Jumps to the handler as if memory had run out: how a guard passes a failure on to the next. */
_Noreturn void arena_fail(Arena *a);

/* Bytes handed out and not freed, and whether it was the limit (not the system) that refused. */
size_t arena_used(const Arena *a);
int arena_hit_limit(const Arena *a);

/* The limit, 0: none; raises it, for a last message. */
size_t arena_limit(const Arena *a);
void arena_raise_limit(Arena *a, size_t by);

#define ARENA_NEW(a, T) ((T *)arena_alloc((a), sizeof(T)))
#define ARENA_ARRAY(a, T, n) ((T *)arena_alloc((a), sizeof(T) * (size_t)(n)))
