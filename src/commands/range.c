/* Ranges of `lagc sweep` (range.h): only cut into numbers here, so that units and formulas are converted as those of
 * name=value. */
#include "commands/range.h"

#include <stdlib.h>
#include <string.h>

#include "base/num.h"
#include "base/strbuf.h"

/* The first separator of a list or range outside parentheses; NULL: none. Names of folders may have dots,
 * "../wind.csv", of files commas. */
static const char *find_separator(const char *s) {
  size_t n = strlen(s);
  int depth = 0;
  if (n > 4 && strcmp(s + n - 4, ".csv") == 0) return NULL;
  for (; *s; s++) {
    depth += (*s == '(') - (*s == ')');
    if (depth == 0 && (*s == ',' || strncmp(s, "..", 2) == 0)) return s;
  }
  return NULL;
}

/* Length of the text up to the next separator of numbers: "..", a comma, a colon, or the end of brackets. */
static size_t number_length(const char *s) {
  int depth = 0;
  size_t n = 0;
  for (; s[n]; n++)
    if (s[n] == '(') depth++;
    else if (s[n] == ')' && depth-- == 0) break;
    else if (depth == 0 && (s[n] == ',' || s[n] == ':' || strncmp(s + n, "..", 2) == 0)) break;
  return n;
}

/* Takes the unit at the end of the numbers away: "-180..180[deg]:512". */
static const char *without_unit(Arena *a, const char *text, Range *r) {
  const char *open = strchr(text, '['), *close = open ? strchr(open, ']') : NULL;
  r->unit = "";
  if (!close || open == text || (close[1] && close[1] != ':')) return text;
  r->unit = arena_strndup(a, open, (size_t)(close + 1 - open));
  return arena_printf(a, "%.*s%s", (int)(open - text), text, close + 1);
}

Range *range_split(Arena *a, const char *word) {
  size_t mark = strcspn(word, "=~"), head = 0;
  const char *text = word + mark + (word[mark] != '\0');
  const char *open = strchr(text, '(');
  int distributed = word[mark] == '~';
  if (!word[mark] || (!distributed && !find_separator(text))) return NULL;
  Range *r = ARENA_NEW(a, Range);
  *r = (Range){.name = arena_strndup(a, word, mark)};
  text = without_unit(a, text, r);
  if (distributed) head = open ? strcspn(text, "(") + 1 : strlen(text);
  const char *from = text, *at = text + head;
  while (*at && *at != ')') {
    size_t n = number_length(at);
    if (n == 0 || *at == '[') { /* a wrong form */
      *r = (Range){.name = r->name};
      vec_push(a, &r->between, word);
      return r;
    }
    vec_push(a, &r->between,
             arena_printf(a, "%s%.*s", from == text ? arena_strndup(a, word, mark + 1) : "", (int)(at - from), from));
    vec_push(a, &r->numbers, arena_printf(a, "%s=%.*s%s", r->name, (int)n, at, r->unit));
    from = at += n;
    if (*at == ':') break; /* the number of values follows */
    at += strncmp(at, "..", 2) == 0 ? 2 : *at == ',';
    at += strspn(at, " ");
  }
  int normal = distributed && strncmp(text, "normal", 6) == 0 && r->numbers.n == 2;
  const char *unit = normal ? strchr(strchr(r->numbers.at[1], '='), '[') : NULL; /* a member's name has brackets, too */
  if (unit) r->zero = arena_printf(a, "%s=0%s", r->name, unit);
  vec_push(a, &r->between, from == text ? arena_printf(a, "%s%s", arena_strndup(a, word, mark + 1), text) : from);
  return r;
}

const char *range_joined(Arena *a, const Range *r) {
  StrBuf b = strbuf(a);
  for (uint32_t i = 0; i < r->numbers.n; i++) {
    const char *number = strchr(r->numbers.at[i], '=') + 1;
    double zero = r->zero && i == 1 ? strtod(strchr(r->zero, '=') + 1, NULL) : 0;
    char text[32];
    if (zero != 0.0) num_format_double(text, strtod(number, NULL) - zero);
    sb_printf(&b, "%s%s", r->between.at[i], zero != 0.0 ? text : number);
  }
  sb_puts(&b, r->between.at[r->numbers.n]);
  return sb_text(&b);
}
