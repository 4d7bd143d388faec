/* Cuts the built-in reference into chapters and finds the rows, items and chapters about a word. */
#include "commands/language_reference.h"

#include <ctype.h>
#include <string.h>

#include "base/words.h"
#include "commands/terminal_page.h"

#include "commands/language.h" /* static const char *const language[]: generated from grammar/LANGUAGE.md */

enum { N_LINES = sizeof language / sizeof *language };

static int is_heading(const char *line) { return strncmp(line, "## ", 3) == 0 || strncmp(line, "### ", 4) == 0; }

static const char *words_of(Arena *a, const char *line) {
  static const char head[] = "<!-- help: ";
  size_t n = sizeof head - 1;
  if (strncmp(line, head, n) != 0) return "";
  const char *end = strstr(line, " -->");
  return end ? arena_strndup(a, line + n, (size_t)(end - line) - n) : "";
}

void reference_chapters(Arena *a, Chapters *out) {
  int code = 0;
  for (size_t i = 0; i < N_LINES; i++) {
    code ^= strncmp(language[i], "```", 3) == 0;
    if (!code && is_heading(language[i])) {
      const char *words = i + 1 < N_LINES ? words_of(a, language[i + 1]) : "";
      vec_push(a, out, ((Chapter){&language[i], 0, words}));
    }
    if (out->n) out->at[out->n - 1].n++;
  }
}

const char *chapter_title(Arena *a, const Chapter *c) {
  const char *title = c->lines[0] + strspn(c->lines[0], "# ");
  return arena_strndup(a, title, strcspn(title, "\n"));
}

/* Whether the line has, before `end` (a | or a colon), code in backticks that begins with the word. */
static int says_first(const char *line, char end, const char *word) {
  size_t n = strlen(word);
  int code = 0;
  for (const char *s = line; *s && (code || *s != end); s++) {
    if (*s != '`') continue;
    code = !code;
    if (code && strncmp(s + 1, word, n) == 0 && !isalnum((unsigned char)s[n + 1])) return 1;
  }
  return 0;
}

/* Prints line i if it is a row of a table about the word, or, in a chapter that lists the word, an item of a list about
 * it. Returns 1 when it did. */
static int print_entry(StrBuf *out, const Chapter *c, size_t i, const char *word) {
  const char *line = c->lines[i];
  if (line[0] == '|' && says_first(line + 1, '|', word)) {
    page_row(out, line);
    return 1;
  }
  if (strncmp(line, "- ", 2) != 0 || !has_word(c->words, word) || !says_first(line, ':', word)) return 0;
  size_t n = 1;
  while (i + n < c->n && strncmp(c->lines[i + n], "  ", 2) == 0) n++;
  page_markdown(out, c->lines + i, n);
  return 1;
}

static int names_chapter(const Chapter *c, const char *word) {
  size_t n = strlen(word);
  return strncmp(c->words, word, n) == 0 && (c->words[n] == ' ' || c->words[n] == '\0');
}

int chapter_print(StrBuf *out, const Chapter *c, const char *word) {
  int rows = 0;
  for (size_t i = 0; i < c->n && !names_chapter(c, word); i++) rows += print_entry(out, c, i, word);
  if (rows) {
    const char *chapter = word_at(out->arena, c->words, 0);
    if (chapter) sb_printf(out, "\n`lagc help %s` says more.\n", chapter);
    return 1;
  }
  if (!has_word(c->words, word)) return 0;
  page_markdown(out, c->lines, c->n);
  return 1;
}
