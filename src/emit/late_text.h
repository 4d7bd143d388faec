/* Parts of emitted C that depend on how many members a family has otherwise than by the numbers in their text: they
 * stand as marks until the size is known (commands/small_sizes.h), and are written by late_text_write. */
#pragma once

#include <stdint.h>

#include "base/strbuf.h"

/* LAG_EACH(first) ... LAG_EACH(end - 1), by the macros of table_macros, of which LAG_10(f, 12) is f(120) ... f(129). */
enum { LATE_RUNS_BLOCK = 10000 }; /* the largest */
void late_runs(StrBuf *out, uint32_t first, uint32_t end);
/* Lines one after another. Runs of groups that differ in nothing but numbers, which grow evenly, are marks. */
enum { MOST_IN_GROUP = 16, FEWEST_GROUPS = 32 };
void late_lines(StrBuf *out, const char *const *line, uint32_t n);
/* The number, or INT32_MAX where it is larger. */
void late_int(StrBuf *out, uint64_t number);
/* A line that declares an array REAL name[n]; where it is long, it lies in `own` of each thread. */
void late_array(StrBuf *out, const char *real, const char *name, const char *own, uint64_t n);
/* The digest of the text from late_digest_from to late_digest_to. */
void late_digest_from(StrBuf *out);
void late_digest_to(StrBuf *out);
void late_digest(StrBuf *out);

/* The text with the parts in the places of their marks. */
StrBuf late_text_write(const StrBuf *text);

/* Digest of a C text (FNV-1a, 64 bits, in hexadecimal), by which a saved state is tied to its equations. */
const char *late_text_digest(Arena *a, const char *text, size_t n);
