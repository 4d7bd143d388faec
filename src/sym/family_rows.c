/* Equations of a family's members, written as one with an index, and terms of a sum likewise: texts that differ in
 * numbers only, each of which is the same in the next, or moves by one step that all share. Enters: lines as printed;
 * leaves: fewer. */
#include "sym/family_rows.h"

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
 * r[12], \sum_{i=2}^{2000}. */
static int is_index(const char *line, const char *s, const char *end, PrintStyle style) {
  char before = s > line ? s[-1] : ' ';
  if (style == PRINT_LATEX)
    return before == '[' || before == ',' || (before == '{' && s - line >= 2 && s[-2] == '_') ||
           (before == '=' && *end == '}') ||
           (before == '{' && s - line >= 3 && s[-2] == '^' && s[-3] == '}' && strstr(line, "\\sum_{") != NULL);
  return before == '[' || before == ',' || *end == ']' || (before == '.' && s - line >= 2 && s[-2] == '.') ||
         strncmp(end, "..", 2) == 0;
}

static Row row_of(Arena *a, const char *line, PrintStyle style) {
  size_t most = 1;
  for (const char *s = line; *s; s++) most += isdigit((unsigned char)s[0]) && !isdigit((unsigned char)s[1]);
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

/* step[x.n] := by what numbers grow from x to y: 0, or one number up or down. 0: they do otherwise, or none does. */
static int follows(const Row *x, const Row *y, long *step) {
  long moves = 0;
  if (x->n != y->n || strcmp(x->text[x->n], y->text[y->n]) != 0) return 0;
  for (uint32_t k = 0; k < x->n; k++) {
    step[k] = y->number[k] - x->number[k];
    if (strcmp(x->text[k], y->text[k]) != 0 || (step[k] && moves && labs(step[k]) != moves)) return 0;
    moves = step[k] ? labs(step[k]) : moves;
  }
  return moves > 0;
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

/* Rows that become one with an index: `from` with step of each number. */
typedef struct {
  const Row *from, *last; /* where the index is the least; the last row as printed */
  const long *step;
  long up, begin,
      end; /* the first number that moves is `up` times the index, and a rest; the index from begin to end */
  char letter;
  PrintStyle style;
} Family;

/* The family of `count` rows of which r is the first, step those of its numbers. */
static Family family_of(const Row *r, const Row *last, uint32_t count, char letter, const long *step,
                        PrintStyle style) {
  uint32_t first = 0;
  while (step[first] == 0) first++;
  const Row *from = step[first] > 0 ? r : last;
  long up = step[first], begin = from->number[first] / labs(up);
  return (Family){from, last, step, up, begin, begin + (long)count - 1, letter, style};
}

static const char *family_text(Arena *a, const Family *f) {
  const Row *r = f->from;
  const long up = labs(f->up);
  StrBuf out = strbuf(a), index = strbuf(a);
  if (up > 1) sb_printf(&index, f->style == PRINT_LATEX ? "%ld " : "%ld*", up);
  sb_putc(&index, f->letter);
  for (uint32_t k = 0; k < r->n; k++) {
    long here = r->number[k], more = here - up * f->begin;
    sb_puts(&out, r->text[k]);
    if (f->step[k] == 0) sb_printf(&out, "%ld", here);
    else if (f->step[k] != f->up) sb_printf(&out, "%ld - %s", here + up * f->begin, sb_text(&index));
    else if (more == 0) sb_puts(&out, sb_text(&index));
    else sb_printf(&out, "%s %c %ld", sb_text(&index), more < 0 ? '-' : '+', labs(more));
  }
  sb_puts(&out, r->text[r->n]);
  return sb_text(&out);
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

typedef VEC(const char *) Texts;

/* The texts of `from`, with those of a family as one, which `put` writes. */
static Texts fold(Arena *a, Texts from, PrintStyle style, void (*put)(StrBuf *, const Family *)) {
  Texts to = {0};
  Row *row = ARENA_ARRAY(a, Row, from.n + 1);
  uint32_t longest = 0;
  for (uint32_t k = 0; k < from.n; k++) {
    row[k] = row_of(a, from.at[k], style);
    longest = row[k].n > longest ? row[k].n : longest;
  }
  long *step = ARENA_ARRAY(a, long, 2 * (size_t)longest + 1);
  for (uint32_t k = 0; k < from.n;) {
    uint32_t count = 0, period = period_at(row + k, from.n - k, step, &count);
    for (uint32_t q = 0; q < period; q++) {
      StrBuf out = strbuf(a);
      const Row *r = row + k + q;
      follows(r, r + period, step);
      Family f = family_of(r, r + (count - 1) * period, count, letter_for(from.at[k + q]), step, style);
      put(&out, &f);
      vec_push(a, &to, sb_text(&out));
    }
    if (!period) vec_push(a, &to, from.at[k]);
    k += period ? period * count : 1;
  }
  return to;
}

/* ---- Terms of one line */

/* The end of the term at s: before " + " or " - " outside of brackets, or the line's. */
static const char *end_of_term(const char *s, PrintStyle style) {
  int depth = 0;
  for (; *s; s++) {
    if (strchr("([{", *s)) depth++;
    if (strchr(")]}", *s)) depth--;
    if (depth == 0 && s[0] == ' ' && (s[1] == '+' || s[1] == '-') && s[2] == ' ') return s;
    if (style == PRINT_LATEX && strncmp(s, " \\\\", 3) == 0) return s;
  }
  return s;
}

/* A sum over the index, with its sign. */
static void put_sum(StrBuf *out, const Family *f) {
  const char *body = family_text(out->arena, f);
  sb_printf(out, f->style == PRINT_LATEX ? "%.2s\\sum_{%c=%ld}^{%ld} %s" : "%.2ssum(%c in %ld..%ld, %s)", body,
            f->letter, f->begin, f->end, body + 2);
}

/* "b - a" is printed for "-a + b", and the last term of a family may come first: a first term goes before or behind the
 * family that it belongs to. */
static void put_first_term_back(Arena *a, Texts *terms, PrintStyle style) {
  if (terms->n < FEWEST) return;
  const char *text = terms->at[0];
  Row first = row_of(a, text, style), here = row_of(a, terms->at[1], style), before;
  long *step = ARENA_ARRAY(a, long, 2 * (size_t)first.n + 1), *next = step + first.n;
  for (uint32_t k = 2; k < terms->n; k++) {
    before = here;
    here = row_of(a, terms->at[k], style);
    if (before.n != first.n || !follows(&before, &here, next) || !follows(&first, &before, step) ||
        memcmp(step, next, first.n * sizeof *step) != 0)
      continue;
    memmove(terms->at, terms->at + 1, (k - 2) * sizeof text);
    terms->at[k - 2] = text;
    return;
  }
  if (before.n != first.n || !follows(&before, &here, next) || !follows(&here, &first, step) ||
      memcmp(step, next, first.n * sizeof *step) != 0)
    return;
  memmove(terms->at, terms->at + 1, (terms->n - 1) * sizeof text);
  terms->at[terms->n - 1] = text;
}

/* Whether the text is sum(...) and nothing else, which needs no brackets. */
static int is_one_sum(const char *text) {
  int depth = 0;
  if (strncmp(text, "sum(", 4) != 0) return 0;
  for (text += 3; *text; text++) {
    depth += *text == '(' ? 1 : *text == ')' ? -1 : 0;
    if (depth == 0) return text[1] == '\0';
  }
  return 0;
}

/* The term with sums in its brackets likewise. */
static const char *family_brackets(Arena *a, const char *term, PrintStyle style) {
  StrBuf out = strbuf(a);
  for (const char *s = term; *s;) {
    sb_putc(&out, *s);
    if (*s++ != '(' && (style != PRINT_LATEX || s[-1] != '{')) continue;
    const char *end = s;
    for (int depth = 1; *end; end++) {
      depth += strchr("([{", *end) ? 1 : strchr(")]}", *end) ? -1 : 0;
      if (depth == 0) break;
    }
    if (style == PRINT_LATEX && end - s >= 6 && strncmp(end - 6, "\\right", 6) == 0) end -= 6;
    const char *inner = family_sum(a, arena_strndup(a, s, (size_t)(end - s)), style);
    int bare = is_one_sum(inner) && *end == ')' && (s - term < 2 || !isalnum((unsigned char)s[-2]));
    if (bare) out.n--;
    sb_puts(&out, inner);
    s = end + bare;
  }
  return sb_text(&out);
}

/* Whether the text is a sum: outside of brackets nothing binds less than + does, as commas and comparisons do. */
static int is_sum(const char *text) {
  static const char *const loose[] = {",", "<", "=", " and ", " or ", "\\le ", "\\wedge ", "\\vee "};
  int depth = 0;
  for (; *text; text++) {
    depth += strchr("([{", *text) ? 1 : strchr(")]}", *text) ? -1 : 0;
    for (size_t k = 0; depth == 0 && k < sizeof loose / sizeof *loose; k++)
      if (strncmp(text, loose[k], strlen(loose[k])) == 0) return 0;
  }
  return 1;
}

const char *family_sum(Arena *a, const char *text, PrintStyle style) {
  enum { NESTS = 3 };
  if (!is_sum(text)) return family_brackets(a, text, style);
  Texts terms = {0};
  const char *s = text;
  for (int first = 1; first || *s == ' '; first = 0) {
    int minus = first ? *s == '-' : s[1] == '-';
    s += first ? minus : 3;
    const char *end = end_of_term(s, style), *term = family_brackets(a, arena_strndup(a, s, (size_t)(end - s)), style);
    vec_push(a, &terms, arena_printf(a, "%c %s", minus ? '-' : '+', term));
    s = end;
    if (style == PRINT_LATEX && strncmp(s, " \\\\", 3) == 0) break;
  }
  put_first_term_back(a, &terms, style);
  uint32_t before = terms.n + 1;
  for (int pass = 0; pass < NESTS && terms.n < before; pass++) {
    before = terms.n;
    terms = fold(a, terms, style, put_sum);
  }
  StrBuf out = strbuf(a);
  for (uint32_t k = 0; k < terms.n; k++) {
    const char *term = terms.at[k];
    sb_printf(&out, "%s%s", k ? (*term == '-' ? " - " : " + ") : *term == '-' ? "-" : "", term + 2);
  }
  sb_puts(&out, s);
  return sb_text(&out);
}

/* The line "  left = right" with both sides so. */
static const char *family_sides(Arena *a, const char *line, PrintStyle style) {
  const char *sign = style == PRINT_LATEX ? " &= " : " = ", *right = strstr(line, sign);
  if (!right) return line;
  size_t lead = strspn(line, " ");
  const char *left = arena_strndup(a, line + lead, (size_t)(right - line) - lead);
  return arena_printf(a, "%.*s%s%s%s", (int)lead, line, family_sum(a, left, style), sign,
                      family_sum(a, right + strlen(sign), style));
}

/* ---- Lines of a block */

static void put_line(StrBuf *out, const Family *f) {
  sb_printf(out, f->style == PRINT_LATEX ? "%s \\quad (%c = %ld, \\dots, %ld)%s" : "%s  for %c in %ld..%ld%s",
            family_text(out->arena, f), f->letter, f->begin, f->end, f->last->line_break);
}

typedef struct {
  const FamilyLines *lines;
  PrintStyle style;
  StrBuf *out;
  Texts wait, done; /* lines that have not been compared yet; those that have */
} Block;

static const char *line_at(Arena *a, const Block *b, uint32_t k) {
  return family_sides(a, b->lines->line(a, b->lines->data, k), b->style);
}

static void put_waiting(Arena *a, Block *b) {
  Texts line = fold(a, b->wait, b->style, put_line);
  for (uint32_t k = 0; k < line.n; k++) vec_push(a, &b->done, line.at[k]);
  b->wait.n = 0;
}

/* Whether the shapes x, y, z are those of a family's members that follow one another. */
static int shapes_follow(const ExprShape *x, const ExprShape *y, const ExprShape *z) {
  int same = x->structure == y->structure && y->structure == z->structure && x->index.n == y->index.n &&
             y->index.n == z->index.n && expr_shape_is_known(x);
  for (uint32_t k = 0; same && k < x->index.n; k++)
    same = y->index.at[k] - x->index.at[k] == z->index.at[k] - y->index.at[k];
  return same;
}

/* How often the `period` lines at k repeat, by their shapes. */
static uint32_t shapes_repeat(const FamilyLines *l, uint32_t k, uint32_t period) {
  const ExprShape *s = l->shape + k;
  uint32_t x = 0, n = l->n - k;
  while (x + 2 * period < n && shapes_follow(s + x, s + x + period, s + x + 2 * period)) x++;
  return x < period ? 0 : x / period + 2;
}

/* The period and count of a family of many lines that begins at k; 0: none does. */
static uint32_t shaped_period(const FamilyLines *l, uint32_t k, uint32_t *count) {
  enum { LONGEST = 8, MANY = 24 };
  uint32_t best = 0;
  *count = 0;
  for (uint32_t period = 1; l->shape && period <= LONGEST; period++) {
    uint32_t found = shapes_repeat(l, k, period);
    if (found >= MANY && found * period > *count * best) best = period, *count = found;
  }
  return best;
}

/* The line of the family whose first member is line k; NULL: its last is not as the first ones foretell. */
static const char *family_line(Arena *a, const Block *b, uint32_t k, uint32_t period, uint32_t count) {
  const char *line[3] = {line_at(a, b, k), line_at(a, b, k + period), line_at(a, b, k + (count - 1) * period)};
  Row r[3] = {row_of(a, line[0], b->style), row_of(a, line[1], b->style), row_of(a, line[2], b->style)};
  long *step = ARENA_ARRAY(a, long, r[0].n + 1);
  if (r[2].n != r[0].n || !follows(&r[0], &r[1], step)) return NULL;
  for (uint32_t x = 0; x <= r[0].n; x++) {
    if (strcmp(r[0].text[x], r[2].text[x]) != 0) return NULL;
    if (x < r[0].n && r[2].number[x] - r[0].number[x] != step[x] * (long)(count - 1)) return NULL;
  }
  StrBuf out = strbuf(a);
  Family f = family_of(&r[0], &r[2], count, letter_for(line[0]), step, b->style);
  put_line(&out, &f);
  return sb_text(&out);
}

/* Puts the families of many lines that begin at k; 0: their texts are none. */
static int put_families(Arena *a, Block *b, uint32_t k, uint32_t period, uint32_t count) {
  enum { LONGEST = 8 };
  const char *line[LONGEST];
  for (uint32_t q = 0; q < period; q++)
    if (!(line[q] = family_line(a, b, k + q, period, count))) return 0;
  put_waiting(a, b);
  for (uint32_t q = 0; q < period; q++) vec_push(a, &b->done, line[q]);
  return 1;
}

static void put_block(Arena *a, void *data) {
  Block *b = data;
  for (uint32_t k = 0, past = 0, count; k < b->lines->n;) {
    uint32_t period = k >= past ? shaped_period(b->lines, k, &count) : 0;
    if (period && put_families(a, b, k, period, count)) {
      k += period * count;
      continue;
    }
    if (period) past = k + period * count;
    vec_push(a, &b->wait, line_at(a, b, k));
    k++;
  }
  put_waiting(a, b);
  for (uint32_t before = b->lines->n; b->done.n < before;) { /* lines with an index are members of families, too */
    before = b->done.n;
    b->done = fold(a, b->done, b->style, put_line);
  }
  for (uint32_t k = 0; k < b->done.n; k++) sb_printf(b->out, "%s\n", b->done.at[k]);
}

const char *family_lines(Arena *a, const FamilyLines *lines, PrintStyle style) {
  StrBuf out = strbuf(a);
  Block b = {lines, style, &out, {0}, {0}};
  arena_with_scratch(a, put_block, &b);
  return sb_text(&out);
}

static const char *line_of(Arena *a, void *data, uint32_t k) {
  (void)a;
  return ((const Texts *)data)->at[k];
}

const char *family_rows(Arena *a, const char *lines, PrintStyle style) {
  Texts all = {0};
  for (const char *s = lines, *end; *s; s = *end ? end + 1 : end) {
    end = s + strcspn(s, "\n");
    vec_push(a, &all, arena_strndup(a, s, (size_t)(end - s)));
  }
  return family_lines(a, &(FamilyLines){all.n, NULL, line_of, &all}, style);
}
