/* Parts of emitted C that are written last (late_text.h): a mark is a letter and its words between two characters that
 * no text has. */
#include "emit/late_text.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/hash.h"

enum { LONG_ARRAY = 100000, WORD = 200 };
#define OPEN "\001"
#define SHUT "\002"
#define NUMBER "\003" /* its first value, its step */
#define DIGITS "0123456789"

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

/* Length of the digits at x, which those at y and z go on from evenly; 0: they do not. */
static size_t counts_on(const char *x, const char *y, const char *z, size_t n[3]) {
  n[0] = strspn(x, DIGITS), n[1] = strspn(y, DIGITS), n[2] = strspn(z, DIGITS);
  if (n[0] == n[1] && n[0] == n[2] && memcmp(x, y, n[0]) == 0 && memcmp(x, z, n[0]) == 0) return n[0];
  for (int k = 0; k < 3; k++)
    if (n[k] == 0 || n[k] > 9 || (n[k] > 1 && *(k == 0 ? x : k == 1 ? y : z) == '0')) return 0;
  long a = strtol(x, NULL, 10), b = strtol(y, NULL, 10), c = strtol(z, NULL, 10);
  return b > a && c - b == b - a ? n[0] : 0;
}

static int is_digit(char c) { return c >= '0' && c <= '9'; }

static int go_on(const char *x, const char *y, const char *z) {
  for (size_t n[3]; *x; x += n[0], y += n[1], z += n[2]) {
    if (is_digit(*x) ? !counts_on(x, y, z, n) : *x != *y || *x != *z) return 0;
    if (!is_digit(*x)) n[0] = n[1] = n[2] = 1;
  }
  return !*y && !*z;
}

/* Number of groups of `size` lines that go on from the first two. */
static uint32_t groups_at(const char *const *line, uint32_t n, uint32_t size) {
  uint32_t i = 2 * size;
  while (i < n && go_on(line[i - 2 * size], line[i - size], line[i])) i++;
  return i / size;
}

static void mark_line(StrBuf *out, const char *x, const char *y) {
  for (size_t n; *x; x += n, y += n) {
    n = strcspn(x, DIGITS);
    sb_putn(out, x, n), x += n, y += n;
    n = strspn(x, DIGITS);
    if (strspn(y, DIGITS) == n && memcmp(x, y, n) == 0) sb_putn(out, x, n);
    else {
      char *end;
      long first = strtol(x, NULL, 10), step = strtol(y, &end, 10) - first;
      sb_printf(out, NUMBER "%ld %ld ", first, step);
      y = end - n;
    }
  }
}

void late_lines(StrBuf *out, const char *const *line, uint32_t n) {
  for (uint32_t i = 0, size, groups; i < n;) {
    for (size = 1, groups = 0; size <= MOST_IN_GROUP && size * FEWEST_GROUPS <= n - i; size++)
      if ((groups = groups_at(line + i, n - i, size)) >= FEWEST_GROUPS) break;
    if (groups < FEWEST_GROUPS) sb_puts(out, line[i++]);
    else {
      sb_printf(out, OPEN "L %u ", groups);
      for (uint32_t k = 0; k < size; k++) mark_line(out, line[i + k], line[i + size + k]);
      sb_puts(out, SHUT);
      i += size * groups;
    }
  }
}

static void write_lines(const char *words, StrBuf *out) {
  char *text;
  long groups = strtol(words, &text, 10);
  for (long g = 0; g < groups; g++)
    for (const char *s = text + 1; *s != *SHUT;) {
      size_t n = strcspn(s, NUMBER SHUT);
      sb_putn(out, s, n);
      if (*(s += n) != *NUMBER) continue;
      char *next;
      long first = strtol(s + 1, &next, 10), step = strtol(next, &next, 10);
      sb_printf(out, "%ld", first + g * step);
      s = next + 1;
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
      case 'L': write_lines(mark + 2, &out); break;
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
