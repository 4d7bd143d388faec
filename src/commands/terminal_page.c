/* Fills paragraphs and renders the Markdown subset of grammar/LANGUAGE.md; columns are counted in UTF-8 characters. */
#include "commands/terminal_page.h"

#include <string.h>

#include "base/words.h"

/* Columns of text[n]: bytes that begin a character. */
static size_t width(const char *text, size_t n) {
  size_t w = 0;
  for (size_t i = 0; i < n; i++) w += ((unsigned char)text[i] & 0xC0) != 0x80;
  return w;
}

size_t page_columns(const char *text) { return width(text, strlen(text)); }

static void put_spaces(StrBuf *out, size_t n) {
  while (n--) sb_putc(out, ' ');
}

/* inside: between backticks; whole: this code is short enough not to be broken over lines. */
typedef struct {
  int inside, whole;
} Code;

/* The end of the word at i. */
static size_t word_end(const char *text, size_t n, size_t i, Code *code) {
  enum { SHORT = 36 };
  for (; i < n && (code->whole || !is_space(text[i])); i++) {
    if (text[i] != '`') continue;
    code->inside = !code->inside;
    const char *close = code->inside ? memchr(text + i + 1, '`', n - i - 1) : NULL;
    code->whole = close && close - (text + i) < SHORT;
  }
  return i;
}

void page_words(StrBuf *out, const char *text, size_t n, size_t column, size_t indent) {
  int fresh = 1; /* the line is still empty */
  Code code = {0};
  for (size_t i = 0; i < n;) {
    if (is_space(text[i])) {
      i++;
      continue;
    }
    size_t end = word_end(text, n, i, &code), w = width(text + i, end - i);
    if (!fresh && column + 1 + w > PAGE_WIDTH) {
      sb_putc(out, '\n');
      put_spaces(out, indent);
      column = indent;
      fresh = 1;
    }
    if (!fresh) sb_putc(out, ' ');
    for (size_t k = i; k < end; k++) sb_putc(out, text[k] == '\n' ? ' ' : text[k]);
    column += w + !fresh;
    fresh = 0;
    i = end;
  }
  sb_putc(out, '\n');
}

void page_term(StrBuf *out, const char *term, const char *meaning, size_t column) {
  size_t w = width(term, strlen(term));
  sb_printf(out, "  %s", term);
  if (w + 4 > column) {
    sb_putc(out, '\n');
    w = 0;
    put_spaces(out, 2);
  }
  put_spaces(out, column - w - 2);
  page_words(out, meaning, strlen(meaning), column, column);
}

void page_paragraphs(StrBuf *out, const char *text) {
  for (const char *s = text; *s;) {
    size_t line = strcspn(s, "\n");
    if (line == 0 || is_space(*s)) {
      sb_putn(out, s, line);
      sb_putc(out, '\n');
      s += line + (s[line] == '\n');
      continue;
    }
    const char *end = strstr(s, "\n\n");
    size_t n = end ? (size_t)(end - s) : strlen(s);
    page_words(out, s, n, 0, 0);
    s += n + (s[n] == '\n');
  }
}

/* ---- Markdown ---- */

typedef enum { LINE_EMPTY, LINE_HEADING, LINE_FENCE, LINE_TABLE, LINE_ITEM, LINE_COMMENT, LINE_TEXT } LineKind;

static LineKind line_kind(const char *s) {
  if (*s == '\n' || !*s) return LINE_EMPTY;
  if (*s == '#') return LINE_HEADING;
  if (strncmp(s, "```", 3) == 0) return LINE_FENCE;
  if (*s == '|') return LINE_TABLE;
  if (strncmp(s, "- ", 2) == 0) return LINE_ITEM;
  if (strncmp(s, "<!--", 4) == 0) return LINE_COMMENT;
  return LINE_TEXT;
}

/* Appends text[n] without markup: [text](link) as text, *word* as word, \| as |; code keeps its backticks. */
static void put_plain(StrBuf *out, const char *text, size_t n) {
  int code = 0;
  for (size_t i = 0; i < n; i++) {
    const char *link = !code && text[i] == '[' ? memchr(text + i, ']', n - i) : NULL;
    if (text[i] == '`') code = !code;
    if (text[i] == '\\' && i + 1 < n && text[i + 1] == '|') continue;
    if (!code && text[i] == '*') continue;
    if (!link || link[1] != '(') {
      sb_putc(out, text[i]);
      continue;
    }
    sb_putn(out, text + i + 1, (size_t)(link - text) - i - 1);
    const char *close = memchr(link, ')', n - (size_t)(link - text));
    i = close ? (size_t)(close - text) : n;
  }
}

/* The end of a cell: a | without \ before it. */
static const char *cell_end(const char *s) {
  for (; *s && *s != '\n'; s++)
    if (*s == '|' && s[-1] != '\\') return s;
  return s;
}

/* Cell k of a row, without markup. */
static StrBuf cell(Arena *a, const char *line, int k) {
  const char *begin = line + 1;
  for (; k; k--) begin = cell_end(begin) + (*cell_end(begin) == '|');
  const char *end = cell_end(begin);
  while (begin < end && *begin == ' ') begin++;
  while (begin < end && end[-1] == ' ') end--;
  StrBuf b = strbuf(a);
  put_plain(&b, begin, (size_t)(end - begin));
  return b;
}

/* Prints a row as a term and its meaning; column 0: the meaning below the term. */
static void put_row(StrBuf *out, const char *line, size_t column) {
  StrBuf term = cell(out->arena, line, 0), meaning = cell(out->arena, line, 1);
  if (column) {
    page_term(out, sb_text(&term), sb_text(&meaning), column);
    return;
  }
  put_spaces(out, 2);
  page_words(out, sb_text(&term), term.n, 2, 4);
  put_spaces(out, 6);
  page_words(out, sb_text(&meaning), meaning.n, 6, 6);
}

void page_row(StrBuf *out, const char *line) { put_row(out, line, 0); }

/* Prints the rows of a table without its heading and rule, and returns their number. */
static size_t put_table(StrBuf *out, const char *const *lines, size_t n) {
  enum { NARROW = 32 };
  size_t rows = 0, widest = 0;
  for (; rows < n && line_kind(lines[rows]) == LINE_TABLE; rows++) {
    StrBuf term = cell(out->arena, lines[rows], 0);
    size_t w = width(sb_text(&term), term.n);
    if (w > widest) widest = w;
  }
  for (size_t i = 2; i < rows; i++) put_row(out, lines[i], widest <= NARROW ? widest + 4 : 0);
  return rows;
}

size_t page_code(StrBuf *out, const char *const *lines, size_t n) {
  size_t i = 1;
  for (; i < n && line_kind(lines[i]) != LINE_FENCE; i++)
    sb_printf(out, "%s%s", *lines[i] == '\n' ? "" : "    ", lines[i]);
  return i + 1;
}

/* A paragraph or an item of a list: its first line and the text lines that follow. */
static size_t plain_text(StrBuf *plain, const char *const *lines, size_t n) {
  StrBuf text = strbuf(plain->arena);
  size_t i = 0;
  do sb_puts(&text, lines[i++]);
  while (i < n && line_kind(lines[i]) == LINE_TEXT);
  put_plain(plain, sb_text(&text), text.n);
  return i;
}

static size_t put_text(StrBuf *out, const char *const *lines, size_t n) {
  StrBuf plain = strbuf(out->arena);
  size_t used = plain_text(&plain, lines, n);
  page_words(out, sb_text(&plain), plain.n, 0, line_kind(lines[0]) == LINE_ITEM ? 2 : 0);
  return used;
}

static size_t put_heading(StrBuf *out, const char *line) {
  line += strspn(line, "# ");
  size_t n = strcspn(line, "\n");
  sb_printf(out, "%.*s\n", (int)n, line);
  for (size_t w = width(line, n); w; w--) sb_putc(out, '-');
  sb_puts(out, "\n");
  return 1;
}

size_t page_block(StrBuf *out, const char *const *lines, size_t n, int *code) {
  LineKind kind = line_kind(lines[0]);
  *code = kind == LINE_FENCE;
  if (kind == LINE_ITEM || kind == LINE_TEXT) return plain_text(out, lines, n);
  if (kind == LINE_TABLE && !strstr(lines[0], "| ---")) {
    StrBuf term = cell(out->arena, lines[0], 0), meaning = cell(out->arena, lines[0], 1);
    sb_printf(out, "%s: %s", sb_text(&term), sb_text(&meaning));
  }
  size_t i = 1;
  while (*code && i < n && line_kind(lines[i]) != LINE_FENCE) i++;
  return i + (size_t)*code < n ? i + (size_t)*code : n;
}

void page_markdown(StrBuf *out, const char *const *lines, size_t n) {
  for (size_t i = 0; i < n;) {
    switch (line_kind(lines[i])) {
      case LINE_EMPTY: sb_putc(out, '\n'); i++; break;
      case LINE_COMMENT: i++; break;
      case LINE_HEADING: i += put_heading(out, lines[i]); break;
      case LINE_FENCE: i += page_code(out, lines + i, n - i); break;
      case LINE_TABLE: i += put_table(out, lines + i, n - i); break;
      case LINE_ITEM: case LINE_TEXT: i += put_text(out, lines + i, n - i); break;
    }
  }
}
