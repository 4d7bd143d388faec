/* Source text of expressions for messages, and interned names made by the compiler. */
#include <stdarg.h>
#include <string.h>

#include "model/resolve_impl.h"

Name intern_printf(Builder *b, const char *fmt, ...) {
  va_list ap;
  va_start(ap, fmt);
  char *s = arena_vprintf(b->arena, fmt, ap);
  va_end(ap);
  Name name = intern(b->ast->names, s);
  arena_recycle(b->arena, s, strlen(s) + 1);
  return name;
}

Value refuse(Builder *b, Span span, const char *fmt, ...) {
  va_list ap;
  va_start(ap, fmt);
  diag_verror(b->diags, span, fmt, ap);
  va_end(ap);
  return FAILED;
}

/* Text of a span on one line, without comments. */
static const char *one_line(const Ast *ast, Span s) {
  const Source *file = source_of(ast->sources, s.begin);
  if (!file || s.end <= s.begin) return "";
  StrBuf out = strbuf(ast->arena);
  const char *from = file->text + (s.begin - file->base), *end = from + (s.end - s.begin);
  int quoted = 0;
  for (const char *c = from; c < end; c++) {
    if (*c == '"') quoted = !quoted;
    if (*c == '#' && !quoted)
      while (c + 1 < end && *c != '\n') c++;
    int space = *c == ' ' || *c == '\t' || *c == '\n' || *c == '\r';
    if (!space) sb_putc(&out, *c);
    else if (out.n && out.at[out.n - 1] != ' ') sb_putc(&out, ' ');
  }
  return sb_text(&out);
}

const char *short_text(const Ast *ast, Span s) {
  enum { LONGEST = 48 };
  const char *text = one_line(ast, s);
  size_t n = strlen(text);
  if (n <= LONGEST) return text;
  size_t head = LONGEST - 13, tail = n - 10;
  while (head && ((unsigned char)text[head] & 0xC0) == 0x80) head--;
  while (tail < n && ((unsigned char)text[tail] & 0xC0) == 0x80) tail++;
  return arena_printf(ast->arena, "%.*s...%s", (int)head, text, text + tail);
}

const char *source_text(const Builder *b, Span s) { return one_line(b->ast, s); }
const char *ast_text(const Builder *b, AstId id) { return one_line(b->ast, ast_expr(b->ast, id)->span); }
const char *ast_short(const Builder *b, AstId id) { return short_text(b->ast, ast_expr(b->ast, id)->span); }
