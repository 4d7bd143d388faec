/* Spelling of names as C identifiers, and scopes as hash tables of taken names. */
#include "emit/cnames.h"

#include <stdio.h>
#include <string.h>

#include "base/hash.h"
#include "base/words.h"
#include "numeric/functions.def"

#define NAME(OP, name, ...) #name " "

/* Reserved words: keywords and names of C and C++, and names that emitted text uses. */
static const char reserved[] =
    "auto break case char const continue default do double else enum extern float for goto if inline int long "
    "register restrict return short signed sizeof static struct switch typedef union unsigned void volatile while "
    "asm bool catch class delete explicit export false friend mutable namespace new operator private protected "
    "public template this throw true try typeid typename using virtual and or not xor compl bitand bitor and_eq "
    "or_eq not_eq xor_eq alignas alignof nullptr noexcept constexpr consteval constinit decltype static_assert "
    "thread_local typeof const_cast static_cast dynamic_cast reinterpret_cast concept requires co_await co_return "
    "co_yield wchar_t char8_t char16_t char32_t size_t ptrdiff_t float_t double_t offsetof main errno signgam "
    FUNCTIONS(NAME)
    "atan2 fabs sqrt pow hypot NULL INFINITY NAN EOF OVERFLOW UNDERFLOW DOMAIN SING PLOSS TLOSS I HUGE HUGE_VAL "
    "HUGE_VALF HUGE_VALL MAXFLOAT M_E M_LOG2E M_LOG10E M_LN2 M_LN10 M_PI M_PI_2 M_PI_4 M_1_PI M_2_PI M_2_SQRTPI "
    "M_SQRT2 M_SQRT1_2 FP_NAN FP_INFINITE FP_ZERO FP_SUBNORMAL FP_NORMAL FP_ILOGB0 FP_ILOGBNAN FP_FAST_FMA "
    "FP_FAST_FMAF FP_FAST_FMAL MATH_ERRNO MATH_ERREXCEPT math_errhandling near far unix linux";

/* Functions of the C library that a compiler or <math.h> declares: allowed as names of locals, not of objects with
 * external linkage. */
static const char library[] =
    "abort abs acosh alloca asinh atanh bcmp bcopy bzero calloc ceil clog conj copysign cexp cpow drem erf erfc exit "
    "exp2 exp10 expm1 fdim ffs floor fma fmax fmin fmod fork free frexp gamma ilogb index isinf isnan j0 j1 jn labs "
    "ldexp lgamma log10 log1p log2 logb lrint lround malloc modf nan nearbyint nextafter pow10 printf puts realloc "
    "remainder rindex rint round scalb scalbn signbit significand sincos strlen tgamma trunc y0 y1 yn";

/* Names of the Greek letters U+0391..U+03C9, by position from alpha. */
static const char *const greek[] = {
  "alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu", "nu", "xi",
  "omicron", "pi", "rho", "sigma_final", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega",
};

static unsigned decode(const unsigned char **s) {
  unsigned c = *(*s)++;
  int more = c >= 0xF0 ? 3 : c >= 0xE0 ? 2 : c >= 0xC0 ? 1 : 0;
  if (more) c &= 0x3Fu >> more;
  while (more-- && (**s & 0xC0) == 0x80) c = c << 6 | (*(*s)++ & 0x3Fu);
  return c;
}

static void put_letter(StrBuf *b, unsigned c) {
  if (c >= 0x3B1 && c <= 0x3C9) sb_puts(b, greek[c - 0x3B1]);
  else if (c >= 0x391 && c <= 0x3A9) {
    const char *name = greek[c - 0x391];
    sb_putc(b, (char)(name[0] - 'a' + 'A'));
    sb_puts(b, name + 1);
  } else sb_printf(b, "u%04x", c);
}

const char *cname_letters(Arena *a, const char *name) {
  StrBuf b = strbuf(a);
  static const char *const dots[] = {"", "_dot", "_ddot", "_dddot"};
  for (const unsigned char *s = (const unsigned char *)name; *s;) {
    if (*s == '\'') {
      int n = 0;
      while (*s == '\'') s++, n++;
      sb_puts(&b, dots[n < 3 ? n : 3]);
    } else if (*s >= 0x80) {
      unsigned c = decode(&s);
      put_letter(&b, c);
    } else if (*s == ']') {
      s++; /* r[2].x is r_2_x */
    } else {
      char c = (char)*s++;
      int plain = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
      if (plain || !b.n || sb_text(&b)[b.n - 1] != '_') sb_putc(&b, plain ? c : '_'); /* C++ reserves names with __ */
    }
  }
  return sb_text(&b);
}

const char *cname(Arena *a, const char *name) {
  const char *text = cname_letters(a, name);
  if (text[0] >= '0' && text[0] <= '9') text = arena_printf(a, "n%s", text);
  /* the C library's, the runtime's */
  int taken = text[0] == '_' || strncmp(text, "lag_", 4) == 0 || strncmp(text, "LAG_", 4) == 0;
  if (taken) text = arena_printf(a, "x%s", text);
  return has_word(reserved, text) ? arena_printf(a, "%s_", text) : text;
}

int cname_is_library(const char *id) { return has_word(library, id); }

CNames cnames_new(Arena *a) { return (CNames){.arena = a, .table = idtable(a, 0)}; }

static uint32_t hash_of(const char *name) { return (uint32_t)lag_fnv1a(LAG_FNV1A_START, name, strlen(name)); }

/* The entry of a taken name, or NULL. */
static CName *find(const CNames *c, const char *name) {
  uint32_t hash = hash_of(name), slot = idtable_start(&c->table, hash), id;
  while (idtable_next(&c->table, hash, &slot, &id))
    if (strcmp(c->taken.at[id].name, name) == 0) return &c->taken.at[id];
  return NULL;
}

void cnames_reserve(CNames *c, const char *name) {
  if (find(c, name)) return;
  vec_push(c->arena, &c->taken, ((CName){name, 2}));
  idtable_add(&c->table, hash_of(name), c->taken.n - 1);
}

void cnames_reserve_words(CNames *c, const char *head, const char *words) {
  const char *word;
  for (size_t i = 0; (word = word_at(c->arena, words, i)) != NULL; i++)
    cnames_reserve(c, arena_printf(c->arena, "%s%s", head, word));
}

const char *const *cnames_list(const CNames *c) {
  const char **all = ARENA_ARRAY(c->arena, const char *, c->taken.n + 1);
  for (uint32_t i = 0; i < c->taken.n; i++) all[i] = c->taken.at[i].name;
  return all;
}

const char *cnames_take(CNames *c, const char *name) {
  const char *stem = cname(c->arena, name), *full = stem;
  size_t n = strlen(stem);
  const char *join = n && stem[n - 1] == '_' ? "" : "_";
  while (find(c, full)) full = arena_printf(c->arena, "%s%s%d", stem, join, find(c, stem)->next++);
  cnames_reserve(c, full);
  return full;
}

const char *const *cnames_of_events(const ProgramSet *u) {
  CNames ids = cnames_new(u->arena);
  const char **id = ARENA_ARRAY(u->arena, const char *, u->events.n + 1);
  for (uint32_t k = 0; k < u->events.n; k++) id[k] = cnames_take(&ids, u->events.at[k].name);
  return id;
}
