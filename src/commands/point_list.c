/* Splits a list of points at commas, semicolons, and spaces between two expressions, outside brackets. */
#include "commands/point_list.h"

#include <string.h>

static int is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

const char *text_trimmed(Arena *a, const char *text, size_t n) {
  char *out = arena_alloc(a, n + 1);
  size_t k = 0;
  for (size_t i = 0; i < n; i++) {
    if (!is_space(text[i])) out[k++] = text[i];
    else if (k && out[k - 1] != ' ') out[k++] = ' ';
  }
  out[k - (k && out[k - 1] == ' ')] = '\0';
  return out;
}

/* Whether the white space at s, after the character `before`, separates two expressions. */
static int separates(char before, const char *s) {
  s += strspn(s, " \t\r\n");
  if (*s == '\0' || *s == ';' || strchr("+-*/^(,<>=", before)) return 0;
  if (*s == '+' || *s == '-') return !is_space(s[1]); /* "a -b" is two, "a - b" one */
  return !strchr("*/^),<>=[", *s);
}

/* The end of the point that begins at s; *comma is its first comma outside of brackets, or NULL. */
static const char *point_end(const char *s, const char **comma) {
  int depth = 0;
  char before = ',';
  *comma = NULL;
  for (; *s && (*s != ';' || depth); s++) {
    if (*s == '(' || *s == '[' || *s == '{') depth++;
    if (*s == ')' || *s == ']' || *s == '}') depth--;
    if (*s == ',' && depth == 0) {
      if (*comma) return s;
      *comma = s;
    }
    if (is_space(*s) && depth == 0 && *comma && separates(before, s)) return s;
    if (!is_space(*s)) before = *s;
  }
  return s;
}

int points_split(Arena *a, const char *text, PointTexts *points, const char **error) {
  for (const char *s = text;;) {
    s += strspn(s, "; \t\r\n");
    if (!*s) break;
    const char *comma, *end = point_end(s, &comma);
    if (!comma || *end == ',') {
      *error = arena_printf(a, "\"%s\": each point is x,y, for example 'x1,y1 x2,y2'", text);
      return 0;
    }
    PointText p = {text_trimmed(a, s, (size_t)(comma - s)), text_trimmed(a, comma + 1, (size_t)(end - comma - 1))};
    if (!p.x[0] || !p.y[0]) {
      *error = arena_printf(a, "\"%s\": a point lacks x or y", text);
      return 0;
    }
    vec_push(a, points, p);
    s = end;
  }
  if (points->n) return 1;
  *error = "no point is given; write for example 'x1,y1 x2,y2'";
  return 0;
}
