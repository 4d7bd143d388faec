/* Parts of emitted C that are written last (late_text.h): a mark is a letter and its words between two characters that
 * no text has. */
#include "emit/late_text.h"

#include <stdio.h>
#include <string.h>

#include "base/hash.h"

enum { LONG_ARRAY = 100000, WORD = 200 };
#define OPEN "\001"
#define SHUT "\002"

void late_runs(StrBuf *out, uint32_t first, uint32_t end) { sb_printf(out, OPEN "R %u %u" SHUT, first, end); }

void late_int(StrBuf *out, uint64_t number) { sb_printf(out, OPEN "I %llu" SHUT, (unsigned long long)number); }

void late_array(StrBuf *out, const char *real, const char *name, const char *own, uint64_t n) {
  sb_printf(out, OPEN "A %llu %s %s %s" SHUT, (unsigned long long)n, real, name, own);
}

void late_digest_from(StrBuf *out) { sb_puts(out, OPEN "F" SHUT); }
void late_digest_to(StrBuf *out) { sb_puts(out, OPEN "T" SHUT); }
void late_digest(StrBuf *out) { sb_puts(out, OPEN "D" SHUT); }

const char *late_text_digest(Arena *a, const char *text, size_t n) {
  return arena_printf(a, "%016llx", (unsigned long long)lag_fnv1a(LAG_FNV1A_START, text, n));
}

static void write_runs(const char *words, StrBuf *out) {
  enum { A_LINE = 6 };
  unsigned first = 0, end = 0, column = 0;
  sscanf(words, "%u %u", &first, &end);
  for (unsigned i = first, block; i < end; i += block) {
    for (block = 1; block < LATE_RUNS_BLOCK && i % (block * 10) == 0 && i + block * 10 <= end;) block *= 10;
    const char *lead = column++ % A_LINE ? " " : "\n  ";
    if (block == 1) sb_printf(out, "%sLAG_EACH(%u)", lead, i);
    else sb_printf(out, "%sLAG_%u(LAG_EACH, %u)", lead, block, i / block);
  }
}

static void write_array(const char *words, StrBuf *out) {
  unsigned long long n = 0;
  char real[WORD], name[WORD], own[WORD];
  size_t indent = 0;
  sscanf(words, "%llu %199s %199s %199[^" SHUT "]", &n, real, name, own);
  while (indent < out->n && out->at[out->n - 1 - indent] == ' ') indent++;
  if (n <= LONG_ARRAY) sb_printf(out, "%s %s[%llu];", real, name, n);
  else
    sb_printf(out, "static _Thread_local %s %s[%llu];\n%*s%s *const %s = %s;", real, own, n, (int)indent, "", real,
              name, own);
}

static void write_int(const char *words, StrBuf *out) {
  unsigned long long n = 0;
  sscanf(words, "%llu", &n);
  sb_printf(out, "%d", n < INT32_MAX ? (int)n : INT32_MAX);
}

StrBuf late_text_write(const StrBuf *text) {
  StrBuf out = strbuf(text->arena);
  size_t from = 0;
  const char *digest = "", *s = sb_text(text);
  for (const char *mark; (mark = strchr(s, *OPEN)); s = mark + strcspn(mark, SHUT) + 1) {
    sb_putn(&out, s, (size_t)(mark - s));
    switch (mark[1]) {
      case 'R': write_runs(mark + 2, &out); break;
      case 'I': write_int(mark + 2, &out); break;
      case 'A': write_array(mark + 2, &out); break;
      case 'F': from = out.n; break;
      case 'T': digest = late_text_digest(out.arena, out.at + from, out.n - from); break;
      case 'D': sb_puts(&out, digest); break;
    }
  }
  sb_puts(&out, s);
  return out;
}
