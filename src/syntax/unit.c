/* The text of a unit -> its factors.
 *
 *   unit   = factor { [ "*" | middle dot | "/" ] factor } a space multiplies
 *   factor = ( name | "1" | "(" unit ")" ) [ "^" exponent ]
 *   exponent = integer | "(" integer [ "/" integer ] ")", each with an optional sign
 *
 * `/` divides by the next factor only: J/kg*K is (J/kg)*K. Names of units are checked later (model/). */
#include <string.h>

#include "base/strbuf.h"
#include "syntax/scan.h"

enum { UNIT_DEPTH = 16, UNIT_EXPONENT = 1000 };

typedef struct {
  Scan *scan;
  Token *token;
  const char *text;
  uint32_t n, at, begin;
  VEC(AstUnitFactor) factors;
  uint32_t depth;
} Unit;

/* Makes the token BAD with this message; returns 0. */
static int unit_bad(Unit *u, uint32_t from, uint32_t n, const char *message, const char *help) {
  *u->token = (Token){.kind = TOK_BAD, .span = {u->begin + from, u->begin + from + n}, .text = message,
                      .help = help};
  return 0;
}

static void skip_spaces(Unit *u) {
  while (u->at < u->n && (u->text[u->at] == ' ' || u->text[u->at] == '\t')) u->at++;
}

static int accept_sign(Unit *u, const char *sign) {
  size_t n = strlen(sign);
  skip_spaces(u);
  if (u->n - u->at < n || memcmp(u->text + u->at, sign, n) != 0) return 0;
  u->at += (uint32_t)n;
  return 1;
}

/* Bytes of the name at `at`: ASCII letters, `_`, `%` and letters beyond ASCII. */
static uint32_t name_length(const Unit *u) {
  uint32_t k = u->at, len;
  while (k < u->n) {
    unsigned char c = (unsigned char)u->text[k];
    if ((c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_' || c == '%') {
      k++;
      continue;
    }
    if (c < 0xC2 || k + 1 >= u->n) break;
    uint32_t code = c < 0xE0 || k + 2 < u->n ? utf8_decode(u->text + k, &len) : 0;
    if (code < 0xB0 || (code > 0xB0 && code < 0xB5) || (code > 0xB5 && code < 0xC0) || code == 0xD7) break;
    if (code > 0x2000 && (code < 0x2100 || code > 0x214F)) break;
    k += len;
  }
  return k - u->at;
}

static uint32_t digits_length(const Unit *u) {
  uint32_t k = u->at;
  while (k < u->n && u->text[k] >= '0' && u->text[k] <= '9') k++;
  return k - u->at;
}

static int parse_integer(Unit *u, Num *out) {
  int negative = accept_sign(u, "-");
  if (!negative) accept_sign(u, "+");
  skip_spaces(u);
  uint32_t n = digits_length(u);
  if (!n)
    return unit_bad(u, u->at, 1, "an exponent is an integer, or a fraction in parentheses",
                    "write `m^2`, `s^-1`, `Hz^(1/2)`");
  Num value = num_parse(u->text + u->at, n);
  if (!num_is_int(value) || num_cmp(value, num_int(UNIT_EXPONENT)) > 0)
    return unit_bad(u, u->at, n, "this exponent is too large for a unit", NULL);
  u->at += n;
  *out = negative ? num_neg(value) : value;
  return 1;
}

static int parse_exponent(Unit *u, Num *out) {
  *out = num_int(1);
  if (!accept_sign(u, "^") && !accept_sign(u, "**")) return 1;
  if (!accept_sign(u, "(")) return parse_integer(u, out);
  if (!parse_integer(u, out)) return 0;
  if (accept_sign(u, "/")) {
    Num den;
    uint32_t at = u->at;
    if (!parse_integer(u, &den)) return 0;
    if (num_is_zero(den)) return unit_bad(u, at, 1, "an exponent cannot be divided by 0", NULL);
    *out = num_div(*out, den);
  }
  if (!accept_sign(u, ")")) return unit_bad(u, u->at, 1, "the `)` of this exponent is missing", NULL);
  return 1;
}

/* Parses an exponent and raises the factors from `first` on to that power (divide: to its negative). */
static int raise(Unit *u, uint32_t first, int divide) {
  Num power;
  if (!parse_exponent(u, &power)) return 0;
  if (divide) power = num_neg(power);
  for (uint32_t i = first; i < u->factors.n; i++) {
    Num e = num_mul(u->factors.at[i].exponent, power);
    if (!num_is_exact(e) || num_cmp(num_abs(e), num_int(UNIT_EXPONENT)) > 0)
      return unit_bad(u, 0, u->n, "an exponent of this unit is too large", NULL);
    u->factors.at[i].exponent = e;
  }
  return 1;
}

static int bad_factor(Unit *u) {
  if (u->at >= u->n) return unit_bad(u, u->at, 1, "a unit is missing here", "the dimensionless unit is `[1]`");
  uint32_t len = 1;
  if ((unsigned char)u->text[u->at] >= 0x80)
    while (u->at + len < u->n && ((unsigned char)u->text[u->at + len] & 0xC0) == 0x80) len++;
  const char *message = arena_printf(u->scan->arena, "`%.*s` cannot stand in a unit", (int)len, u->text + u->at);
  const char *help = u->text[u->at] == '.'   ? "factors are joined by `*`: `[N*m]`"
                     : u->text[u->at] == ',' ? LIST_IS_WRITTEN
                                             : "a unit is written `[kg*m^2/s]`; an index touches its name: `x[i]`";
  return unit_bad(u, u->at, len, message, help);
}

/* Replaces the degree sign by `deg`: [deg], [degC]. */
static const char *without_degree_sign(const Unit *u, const char *text, uint32_t n) {
  StrBuf b = strbuf(u->scan->arena);
  for (uint32_t k = 0; k < n; k++) {
    int sign = k + 1 < n && memcmp(text + k, "\xC2\xB0", 2) == 0;
    if (sign) sb_puts(&b, "deg");
    else sb_putc(&b, text[k]);
    k += (uint32_t)sign;
  }
  return sb_text(&b);
}

/* A name or 1, with its exponent. */
static int parse_factor(Unit *u, int divide) {
  uint32_t at = u->at, first = u->factors.n, n = name_length(u);
  if (!n) {
    n = digits_length(u);
    if (!n) return bad_factor(u);
    if (n > 1 || u->text[at] != '1')
      return unit_bad(u, at, n, "a unit holds no number but 1",
                      memchr(u->text, ',', u->n) ? LIST_IS_WRITTEN
                                                 : "write the number before the unit: `2 [m]`; a power is `m^2`");
  }
  AstUnitFactor f = {.name = intern(u->scan->names, without_degree_sign(u, u->text + at, n)), .exponent = num_int(1),
                     .span = {u->begin + at, u->begin + at + n}};
  u->at += n;
  vec_push(u->scan->arena, &u->factors, f);
  return raise(u, first, divide);
}

/* Factors up to the end of the unit, or of its group. Recursion is bounded by UNIT_DEPTH. */
static int parse_factors(Unit *u) {
  for (uint32_t first = u->factors.n;;) {
    uint32_t from = u->factors.n;
    int divide = from > first && accept_sign(u, "/");
    if (from > first && !divide && !accept_sign(u, "*") && !accept_sign(u, "\xC2\xB7")) accept_sign(u, "\xE2\x8B\x85");
    if (accept_sign(u, "(")) {
      if (u->depth++ == UNIT_DEPTH)
        return unit_bad(u, u->at, 1, "the parentheses of this unit are nested too deep (16)", NULL);
      if (!parse_factors(u)) return 0;
      if (!accept_sign(u, ")")) return unit_bad(u, u->n, 1, "a `)` is missing in this unit", NULL);
      u->depth--;
      if (!raise(u, from, divide)) return 0;
    } else {
      skip_spaces(u);
      if (!parse_factor(u, divide)) return 0;
    }
    skip_spaces(u);
    if (u->at >= u->n || (u->depth && u->text[u->at] == ')')) return 1;
    if (accept_sign(u, ")")) return unit_bad(u, u->at - 1, 1, "this `)` closes nothing", NULL);
  }
}

int unit_parse(Scan *s, Token *t, const char *text, uint32_t n, uint32_t begin) {
  Unit u = {.scan = s, .token = t, .text = text, .n = n, .begin = begin};
  if (!parse_factors(&u)) return 0;
  t->unit = (AstUnit){.at = u.factors.at, .n = u.factors.n, .span = {begin - 1, begin + n + 1},
                      .text = without_degree_sign(&u, text, n)};
  return 1;
}
