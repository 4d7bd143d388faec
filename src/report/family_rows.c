/* Equations of a family's members, written as one with an index: lines that differ in numbers only, each of which is
 * the same, or one more or less, in the next line. Enters: lines as printed; leaves: fewer. */
#include "report/family_rows.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "base/vec.h"

enum { FEWEST = 5 };

/* A line in parts: text, number, text, ..., number, text; and, in LaTeX, a line break. */
typedef struct {
  const char **text;
  long *number;
  uint32_t n; /* of numbers */
  const char *line_break;
} Row;

/* Whether a number at s, within `line`, is an index or a bound of a sum: u[12], u[3,4], 2..N, 1..12; in LaTeX u_{12},
 * \sum_{i=2}^{2000}. */
static int is_index(const char *line, const char *s, const char *end, PrintStyle style) {
  char before = s > line ? s[-1] : ' ';
  if (style == PRINT_LATEX)
    return (before == '{' && s - line >= 2 && s[-2] == '_') || (before == '=' && *end == '}') ||
           (before == '{' && s - line >= 3 && s[-2] == '^' && s[-3] == '}' && strstr(line, "\\sum_{") != NULL);
  return before == '[' || before == ',' || *end == ']' || (before == '.' && s - line >= 2 && s[-2] == '.') ||
         strncmp(end, "..", 2) == 0;
}

static Row row_of(Arena *a, const char *line, PrintStyle style) {
  size_t most = strlen(line) / 2 + 2;
  Row r = {ARENA_ARRAY(a, const char *, most), ARENA_ARRAY(a, long, most), 0, ""};
  const char *from = line, *tail = style == PRINT_LATEX ? strstr(line, " \\\\") : NULL;
  if (tail) r.line_break = " \\\\";
  for (const char *s = line; *s;) {
    if (!isdigit((unsigned char)*s)) {
      s++;
      continue;
    }
    char *end;
    long x = strtol(s, &end, 10);
    if (end - s < 9 && is_index(line, s, end, style)) {
      r.text[r.n] = arena_strndup(a, from, (size_t)(s - from));
      r.number[r.n++] = x;
      from = end;
    }
    s = end;
  }
  r.text[r.n] = tail ? arena_strndup(a, from, (size_t)(tail - from)) : from;
  return r;
}

/* step[x.n] := by what numbers grow from x to y, -1, 0 or 1. 0: they do otherwise, or none does. */
static int follows(const Row *x, const Row *y, long *step) {
  int moves = 0;
  if (x->n != y->n || strcmp(x->text[x->n], y->text[y->n]) != 0) return 0;
  for (uint32_t k = 0; k < x->n; k++) {
    step[k] = y->number[k] - x->number[k];
    if (strcmp(x->text[k], y->text[k]) != 0 || labs(step[k]) > 1) return 0;
    moves |= step[k] != 0;
  }
  return moves;
}

/* How many of the rows at 0, period, 2 period, ... are members of one family; step: of their numbers. */
static uint32_t members(const Row *row, uint32_t n, uint32_t period, long *step, long *next) {
  uint32_t k = period;
  if (period >= n || !follows(row, row + period, step)) return 1;
  while (k < n && follows(row + k - period, row + k, next) && memcmp(step, next, row->n * sizeof *step) == 0)
    k += period;
  return k / period;
}

/* How often the first `period` rows repeat; step: scratch for the numbers of two rows. */
static uint32_t repeats(const Row *row, uint32_t n, uint32_t period, long *step) {
  uint32_t least = UINT32_MAX;
  for (uint32_t k = 0; k < period && k < n && least >= FEWEST; k++) {
    uint32_t count = members(row + k, n - k, period, step, step + row[k].n);
    least = count < least ? count : least;
  }
  return least;
}

static int has_word(const char *line, char c) {
  for (const char *s = line; (s = strchr(s, c)) != NULL; s++)
    if ((s == line || !isalnum((unsigned char)s[-1])) && !isalnum((unsigned char)s[1]) && s[1] != '_') return 1;
  return 0;
}

/* A letter that is no name in the line; `_` where each is. */
static char letter_for(const char *line) {
  const char *letters = "ijknmabcdefghlopqrsuvwxyz";
  while (*letters && has_word(line, *letters)) letters++;
  return *letters ? *letters : '_';
}

/* The rows at 0, period, ... as one, over the first number that moves, upwards. */
static void put_rows(StrBuf *out, const Row *r, uint32_t count, uint32_t period, char letter, long *step,
                     PrintStyle style) {
  const Row *end = r + (count - 1) * period;
  uint32_t first = 0;
  follows(r, r + period, step);
  while (step[first] == 0) first++;
  const Row *from = step[first] > 0 ? r : end;
  long begin = from->number[first];
  for (uint32_t k = 0; k < r->n; k++) {
    long here = from->number[k], more = here - begin;
    sb_puts(out, r->text[k]);
    if (step[k] == 0) sb_printf(out, "%ld", here);
    else if (step[k] != step[first]) sb_printf(out, "%ld - %c", here + begin, letter);
    else if (more == 0) sb_putc(out, letter);
    else sb_printf(out, "%c %c %ld", letter, more < 0 ? '-' : '+', labs(more));
  }
  sb_printf(out, style == PRINT_LATEX ? "%s \\quad (%c = %ld, \\dots, %ld)%s\n" : "%s  for %c in %ld..%ld%s\n",
            r->text[r->n], letter, begin, begin + (long)count - 1, end->line_break);
}

/* The period whose rows become the fewest; *count := its repeats; 0: none. */
static uint32_t period_at(const Row *row, uint32_t n, long *step, uint32_t *count) {
  enum { LONGEST = 8 };
  uint32_t best = 0, most = 0;
  for (uint32_t period = 1; period <= LONGEST && period * FEWEST <= n; period++) {
    if (repeats(row, period * FEWEST, period, step) < FEWEST) continue; /* the others are not looked at */
    uint32_t found = repeats(row, n, period, step);
    if (found * period > most) most = found * period, best = period, *count = found;
  }
  return best;
}

const char *family_rows(Arena *a, const char *lines, PrintStyle style) {
  StrBuf out = strbuf(a);
  VEC(const char *) line = {0};
  for (const char *s = lines, *end; *s; s = *end ? end + 1 : end) {
    end = s + strcspn(s, "\n");
    vec_push(a, &line, arena_strndup(a, s, (size_t)(end - s)));
  }
  Row *row = ARENA_ARRAY(a, Row, line.n + 1);
  uint32_t longest = 0;
  for (uint32_t k = 0; k < line.n; k++) {
    row[k] = row_of(a, line.at[k], style);
    longest = row[k].n > longest ? row[k].n : longest;
  }
  long *step = ARENA_ARRAY(a, long, 2 * (size_t)longest + 1);
  for (uint32_t k = 0; k < line.n;) {
    uint32_t count = 0, period = period_at(row + k, line.n - k, step, &count);
    for (uint32_t q = 0; q < period; q++) {
      char letter = letter_for(line.at[k + q]);
      put_rows(&out, row + k + q, count, period, letter, step, style);
    }
    if (!period) sb_printf(&out, "%s\n", line.at[k]);
    k += period ? period * count : 1;
  }
  return sb_text(&out);
}
