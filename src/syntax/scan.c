/* Actions of the scanner's patterns (lag.l): names with dots, numbers, brackets, and mistakes.
 *
 * In: the bytes that a pattern matched. Out: a token, or a BAD token with a message and advice.
 * Must hold: a token's span lies in the source, and every call consumes at least one byte. */
#include "syntax/scan.h"

Scan *scan_new(Arena *a, Interner *names, const Source *source) {
  Scan *s = ARENA_NEW(a, Scan);
  *s = (Scan){.arena = a, .names = names, .source = source, .begin = source->base, .end = source->base};
  scan_open(s);
  return s;
}

Token scan_next(Scan *s) {
  Token t = {.kind = TOK_FINISH};
  scan_lex(s, &t);
  if (t.kind == TOK_FINISH) t.span = (Span){s->end, s->end};
  if (!t.span.end) t.span = (Span){s->begin, s->end};
  int indexable = t.kind == TOK_IDENT || t.kind == TOK_RPAREN || t.kind == TOK_RBRACKET || t.kind == TOK_PRIME;
  s->touch = indexable ? t.span.end : 0;
  return t;
}

static int bad(Scan *s, Token *t, uint32_t from, uint32_t n, const char *message, const char *help) {
  t->kind = TOK_BAD;
  t->span = (Span){s->begin + from, s->begin + from + n};
  t->text = message;
  t->help = help;
  return (int)(from + n);
}

int scan_sign(Scan *s, Token *t, TokKind kind, int n) {
  t->kind = kind;
  t->span = (Span){s->begin, s->begin + (kind == TOK_NEWLINE ? 1 : (uint32_t)n)};
  return n;
}

int scan_advice(Scan *s, Token *t, const char *text, int n, const char *write) {
  const char *message = arena_printf(s->arena, "`%.*s` is not a sign of this language", n, text);
  return bad(s, t, 0, (uint32_t)n, message, write);
}

/* ---- UTF-8 ---- */

uint32_t utf8_decode(const char *text, uint32_t *len) {
  const unsigned char *c = (const unsigned char *)text;
  if (c[0] < 0x80) return *len = 1, c[0];
  if (c[0] < 0xE0) return *len = 2, (c[0] & 0x1Fu) << 6 | (c[1] & 0x3Fu);
  if (c[0] < 0xF0) return *len = 3, (c[0] & 0x0Fu) << 12 | (c[1] & 0x3Fu) << 6 | (c[2] & 0x3Fu);
  return *len = 4, (c[0] & 0x07u) << 18 | (c[1] & 0x3Fu) << 12 | (c[2] & 0x3Fu) << 6 | (c[3] & 0x3Fu);
}

/* Mathematical signs outside the language, and their spelling in it. */
static const struct {
  uint32_t code;
  const char *write;
} lookalikes[] = {
    {0x00B7, "write `*`"}, {0x22C5, "write `*`"}, {0x00D7, "write `*`, or `cross(a, b)`"},
    {0x2217, "write `*`"}, {0x2022, "write `*`"}, {0x2212, "write `-`"}, {0x2013, "write `-`"},
    {0x2014, "write `-`"}, {0x2010, "write `-`"}, {0x2011, "write `-`"}, {0x00F7, "write `/`"},
    {0x2215, "write `/`"}, {0x2044, "write `/`"}, {0x2032, "write `'`"}, {0x2033, "write `''`"},
    {0x2018, "write `'`"}, {0x2019, "write `'`"}, {0x00B4, "write `'`"}, {0x201C, "write `\"`"},
    {0x201D, "write `\"`"}, {0x00B2, "write `^2`"}, {0x00B3, "write `^3`"}, {0x00B9, "write `^1`"},
    {0x00BD, "write `1/2`"}, {0x00BC, "write `1/4`"}, {0x00BE, "write `3/4`"}, {0x2264, "write `<=`"},
    {0x2265, "write `>=`"}, {0x2260, "write `!=`"}, {0x2192, "write `->`"}, {0x21A6, "write `->`"},
    {0x2026, "a range is written with two dots: `1..N`"}, {0x2202, "write `d(expr, name)`"},
    {0x2211, "write `sum(i in 1..N, …)`"}, {0x220F, "write `product(i in 1..N, …)`"},
    {0x221A, "write `sqrt(x)`"}, {0x2206, "write the Greek letter `Δ`"}, {0x2227, "write `and`"},
    {0x2228, "write `or`"}, {0x00B0, "write `30 [deg]`"}, {0x00AC, "write `not`"}, {0x2208, "write `in`"},
};

static const char *lookalike(uint32_t code) {
  for (size_t i = 0; i < sizeof lookalikes / sizeof *lookalikes; i++)
    if (lookalikes[i].code == code) return lookalikes[i].write;
  return code == 0x2070 || (code >= 0x2074 && code <= 0x207F) ? "write `^` for a power" : NULL;
}

static int is_space(uint32_t code) {
  return code == 0x00A0 || (code >= 0x2000 && code <= 0x200B) || code == 0x202F || code == 0x3000 || code == 0xFEFF;
}

/* Code points beyond ASCII that may stand in a name: everything but spaces, signs, arrows, operators, box drawings,
 * pictures and private use. */
static int is_letter(uint32_t code) {
  if (code < 0x00AA) return 0;
  if (code < 0x00C0) return code == 0x00AA || code == 0x00B5 || code == 0x00BA;
  if (code == 0x00D7 || code == 0x00F7) return 0;
  if (code >= 0x2000 && code < 0x2071) return 0;
  if (code >= 0x2074 && code < 0x2080) return 0;
  if (code >= 0x208A && code < 0x2090) return 0;
  if (code >= 0x2190 && code < 0x2C00) return 0;
  if (code >= 0x3000 && code < 0x3005) return 0;
  if (code >= 0xD800 && code < 0xF900) return 0;
  if (code >= 0xFE00 && code < 0xFE10) return 0;
  return code < 0xFFF0 || (code >= 0x10000 && code < 0x1F000) || (code >= 0x20000 && code < 0x40000);
}

/* Letters precomposed with a dot above (and two), and the letter without it. */
static const struct {
  uint16_t code;
  char letter;
  uint8_t dots;
} dotted[] = {
    {0x0226, 'A', 1}, {0x0227, 'a', 1}, {0x1E02, 'B', 1}, {0x1E03, 'b', 1}, {0x010A, 'C', 1}, {0x010B, 'c', 1},
    {0x1E0A, 'D', 1}, {0x1E0B, 'd', 1}, {0x0116, 'E', 1}, {0x0117, 'e', 1}, {0x1E1E, 'F', 1}, {0x1E1F, 'f', 1},
    {0x0120, 'G', 1}, {0x0121, 'g', 1}, {0x1E22, 'H', 1}, {0x1E23, 'h', 1}, {0x0130, 'I', 1}, {0x1E40, 'M', 1},
    {0x1E41, 'm', 1}, {0x1E44, 'N', 1}, {0x1E45, 'n', 1}, {0x022E, 'O', 1}, {0x022F, 'o', 1}, {0x1E56, 'P', 1},
    {0x1E57, 'p', 1}, {0x1E58, 'R', 1}, {0x1E59, 'r', 1}, {0x1E60, 'S', 1}, {0x1E61, 's', 1}, {0x1E6A, 'T', 1},
    {0x1E6B, 't', 1}, {0x1E86, 'W', 1}, {0x1E87, 'w', 1}, {0x1E8A, 'X', 1}, {0x1E8B, 'x', 1}, {0x1E8E, 'Y', 1},
    {0x1E8F, 'y', 1}, {0x017B, 'Z', 1}, {0x017C, 'z', 1}, {0x1E8C, 'X', 2}, {0x1E8D, 'x', 2},
};

/* Number of dots that a code point puts above a letter; *letter: the letter under them, 0 for a combining dot. */
static uint32_t dots_of(uint32_t code, char *letter) {
  *letter = 0;
  if (code == 0x0307) return 1;
  if (code == 0x0308) return 2;
  for (size_t i = 0; i < sizeof dotted / sizeof *dotted; i++)
    if (dotted[i].code == code) return *letter = dotted[i].letter, dotted[i].dots;
  return 0;
}

/* ---- names ---- */

/* Handles a first code point that no name may contain: skips a space, reports all others. */
static int scan_refused(Scan *s, Token *t, const char *text, uint32_t code, uint32_t len) {
  if (is_space(code)) return (int)len;
  const char *write = lookalike(code);
  const char *message = code == 0x0307 || code == 0x0308
      ? "this dot has no letter under it"
      : arena_printf(s->arena, "`%.*s` is not a sign of this language", (int)len, text);
  return bad(s, t, 0, len, message, write);
}

int scan_name(Scan *s, Token *t, const char *text, int n) {
  char *name = NULL; /* a copy without dots, once there is one */
  uint32_t at = 0, kept = 0, dots = 0;
  for (uint32_t len = 1; at < (uint32_t)n; at += len) {
    if (!((unsigned char)text[at] & 0x80)) {
      len = 1;
      if (name) name[kept] = text[at];
      kept++;
      continue;
    }
    char letter;
    uint32_t code = utf8_decode(text + at, &len), more = dots_of(code, &letter);
    if (!is_letter(code) || (more && !letter && !at)) {
      if (at == 0) return scan_refused(s, t, text, code, len);
      break;
    }
    if (more && !name) name = arena_strndup(s->arena, text, (size_t)n);
    dots += more;
    if (more && letter) name[kept++] = letter;
    else if (!more && name) memmove(name + kept, text + at, len), kept += len;
    else if (!more) kept += len;
  }
  t->kind = TOK_IDENT;
  t->span = (Span){s->begin, s->begin + at};
  t->name = intern_n(s->names, name ? name : text, kept);
  t->dots = dots;
  return (int)at;
}

/* ---- numbers, texts, brackets ---- */

/* Bytes of the longest number that text, NUL-terminated, begins with. */
static uint32_t number_length(const char *text) {
  static const char digits[] = "0123456789";
  size_t k = strspn(text, digits);
  k += text[k] == '.';
  k += strspn(text + k, digits);
  if (text[k] != 'e' && text[k] != 'E') return (uint32_t)k;
  size_t e = k + 1;
  e += text[e] == '+' || text[e] == '-';
  size_t more = strspn(text + e, digits);
  return (uint32_t)(more ? e + more : k);
}

int scan_number(Scan *s, Token *t, const char *text, int n) {
  uint32_t digits = number_length(text), len = 1;
  if (digits < (uint32_t)n) {
    uint32_t code = utf8_decode(text + digits, &len);
    if (code < 0x80 || is_letter(code)) {
      const char *name = text + digits;
      int letters = n - (int)digits;
      const char *help =
          arena_printf(s->arena, "`%.*s*%.*s` is a product, `%.*s [%.*s]` has a unit; a name begins with a letter",
                       (int)digits, text, letters, name, (int)digits, text, letters, name);
      return bad(s, t, 0, (uint32_t)n, "an operator is missing between a number and a name", help);
    }
  }
  t->kind = TOK_NUMBER;
  t->span = (Span){s->begin, s->begin + digits};
  t->number = num_parse(text, digits);
  return (int)digits;
}

int scan_string(Scan *s, Token *t, const char *text, int n) {
  if (n < 2 || text[n - 1] != '"') {
    uint32_t shown = (uint32_t)n;
    while (shown > 1 && text[shown - 1] == '\r') shown--;
    bad(s, t, 0, shown, "this quoted text is not closed on its line",
        s->touch == s->begin ? "a second derivative has two primes, `x''`; a text is closed by another `\"`"
                             : "put a `\"` at its end");
    return n;
  }
  for (int k = 1; k < n - 1; k++)
    if ((unsigned char)text[k] < 0x20 && text[k] != '\t')
      return bad(s, t, 0, (uint32_t)n, "this text contains a control character", NULL);
  t->kind = TOK_STRING;
  t->text = arena_strndup(s->arena, text + 1, (size_t)n - 2);
  return n;
}

int scan_bracket(Scan *s, Token *t, const char *text, int n) {
  if (s->touch == s->begin) {
    t->kind = TOK_INDEX;
    t->span = (Span){s->begin, s->begin + 1};
    return 1;
  }
  if (text[n - 1] != ']') {
    if (s->source->text[s->begin - s->source->base + (uint32_t)n] == '[')
      bad(s, t, 0, 1, "a `[` that touches no name begins a unit, and a unit contains no `[`", LIST_IS_WRITTEN);
    else bad(s, t, 0, 1, "the `]` of this unit is missing",
        "a unit stands on one line: `[m/s^2]`; an index touches its name: `x[i]`");
    return n;
  }
  t->kind = TOK_UNIT;
  t->span = (Span){s->begin, s->begin + (uint32_t)n};
  unit_parse(s, t, text + 1, (uint32_t)n - 2, s->begin + 1);
  return n;
}

int scan_unknown(Scan *s, Token *t, const char *text, int n) {
  unsigned char c = (unsigned char)text[0];
  (void)n;
  if (c >= 0x80)
    return bad(s, t, 0, 1, arena_printf(s->arena, "byte 0x%02X: the text is not UTF-8 here", c),
               "save the file as UTF-8");
  if (c < 0x20 || c == 0x7F)
    return bad(s, t, 0, 1, arena_printf(s->arena, "a control character (0x%02X)", c), NULL);
  return bad(s, t, 0, 1, arena_printf(s->arena, "`%c` is not a sign of this language", c),
             c == '\\' ? "this is not LaTeX: write `x'` for \\dot{x}, `x''` for \\ddot{x}, `a/b` for \\frac{a}{b}, "
                         "`theta` or `θ` for \\theta"
             : c == '%' ? "a remainder is `mod(a, b)`; a comment begins with `#`"
                        : NULL);
}
