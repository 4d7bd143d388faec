/* Numbers, strings and comments as C. */
#include <string.h>

#include "emit/cwriter.h"

/* num/den as a finite decimal; NULL if there is none. */
static const char *finite_decimal(Arena *a, Num n) {
  int64_t den = n.den;
  int digits = 0;
  while (den % 10 == 0) den /= 10, digits++;
  int twos = 0, fives = 0;
  while (den % 2 == 0) den /= 2, twos++;
  while (den % 5 == 0) den /= 5, fives++;
  if (den != 1) return NULL;
  digits += twos > fives ? twos : fives;
  StrBuf b = strbuf(a);
  uint64_t rest = (uint64_t)(n.num < 0 ? -n.num : n.num), d = (uint64_t)n.den;
  sb_printf(&b, "%s%llu.", n.num < 0 ? "-" : "", (unsigned long long)(rest / d));
  rest %= d;
  for (int i = 0; i < digits || i == 0; i++) {
    __extension__ unsigned __int128 wide = (unsigned __int128)rest * 10;
    sb_putc(&b, (char)('0' + (int)(wide / d)));
    rest = (uint64_t)(wide % d);
  }
  return sb_text(&b);
}

/* The decimal with an exponent (1.6e-19) if it begins or ends with many zeros. */
static const char *without_zeros(Arena *a, const char *decimal) {
  enum { SMALL = 4, LARGE = 6 };
  const char *point = strchr(decimal, '.'), *first = decimal + strspn(decimal, "0.");
  size_t whole = (size_t)(point - decimal), zeros = 0;
  if (first > point && (size_t)(first - point) > SMALL)
    return arena_printf(a, "%c%s%se-%d", *first, first[1] ? "." : "", first + 1, (int)(first - point));
  while (zeros < whole && point[-1 - (int)zeros] == '0') zeros++;
  if (strcmp(point, ".0") != 0 || zeros < LARGE || zeros == whole) return decimal;
  return arena_printf(a, "%.*se%d", (int)(whole - zeros), decimal, (int)zeros);
}

static const char *float_text(Arena *a, double x) {
  char text[40];
  num_format_double(text, x);
  if (!strpbrk(text, ".en")) strcat(text, ".0");
  return arena_strdup(a, text);
}

const char *c_number_by(Arena *a, const char *macro, Num n) {
  const char *minus = num_sign(n) < 0 ? "-" : "";
  n = num_abs(n);
  if (!num_is_exact(n)) return arena_printf(a, "%s%s(%s)", minus, macro, float_text(a, n.approx));
  const char *decimal = finite_decimal(a, n);
  if (decimal) return arena_printf(a, "%s%s(%s)", minus, macro, without_zeros(a, decimal));
  return arena_printf(a, "%s%s(%lld.0)/%s(%lld.0)", minus, macro, (long long)n.num, macro, (long long)n.den);
}

const char *c_number(Arena *a, const char *prefix, Num n) {
  return c_number_by(a, arena_printf(a, "%s_C", prefix), n);
}

const char *c_string(Arena *a, const char *s) {
  StrBuf b = strbuf(a);
  sb_putc(&b, '"');
  for (; *s; s++)
    if (*s == '"' || *s == '\\') sb_printf(&b, "\\%c", *s);
    else if (*s == '\n') sb_puts(&b, "\\n");
    else if (*s == '?' && b.n > 1 && s[-1] == '?') sb_puts(&b, "\\?"); /* no trigraphs */
    else sb_putc(&b, *s);
  sb_putc(&b, '"');
  return sb_text(&b);
}

const char *comment_text(Arena *a, const char *s) {
  StrBuf b = strbuf(a);
  for (; *s; s++) {
    sb_putc(&b, *s);
    int pair = (s[0] == '*' && s[1] == '/') || (s[0] == '/' && s[1] == '*') || (s[0] == '?' && s[1] == '?');
    if (pair) sb_putc(&b, ' ');
  }
  return sb_text(&b);
}
