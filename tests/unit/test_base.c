/* Unit tests of src/base: exact numbers, memory, names, text, messages, suggestions, the list of methods. */
#include <float.h>
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "base/diag.h"
#include "base/intern.h"
#include "base/method_table.h"
#include "base/num.h"
#include "base/words.h"
#include "base/vec.h"

__extension__ typedef __int128 Wide;

/* The same numbers in every run (Knuth's MMIX generator). */
static uint64_t rng = 7;
static uint64_t next(void) {
  rng = rng * 6364136223846793005u + 1442695040888963407u;
  return rng >> 16;
}
static int64_t between(int64_t lo, int64_t hi) { return lo + (int64_t)(next() % (uint64_t)(hi - lo + 1)); }
static Num ratio(int64_t size) { return num_ratio(between(-size, size), between(1, size)); }

/* ---- numbers ---- */

static void assert_num(Num a, int64_t n, int64_t d) {
  assert_int_equal(a.num, n);
  assert_int_equal(a.den, d);
}

static Num parse(const char *s) { return num_parse(s, strlen(s)); }

static void test_lowest_terms(void **state) {
  (void)state;
  assert_num(num_ratio(6, -4), -3, 2);
  assert_num(num_ratio(0, -7), 0, 1);
  assert_num(num_ratio(INT64_MAX, INT64_MAX), 1, 1);
  assert_num(num_add(num_ratio(1, 6), num_ratio(1, 10)), 4, 15);
  assert_num(num_sub(num_ratio(1, 6), num_ratio(1, 6)), 0, 1);
  assert_num(num_div(num_ratio(-3, 7), num_ratio(-9, 14)), 2, 3);
  assert_num(num_double(0.375), 3, 8);
  assert_num(num_double(-12), -12, 1);
  assert_false(num_is_exact(num_double(0.1)));
}

/* The laws of a field, on fractions small enough to stay exact. */
static void test_field(void **state) {
  (void)state;
  for (int i = 0; i < 5000; i++) {
    Num a = ratio(2000), b = ratio(2000), c = ratio(2000);
    assert_true(num_equal(num_add(a, b), num_add(b, a)));
    assert_true(num_equal(num_mul(a, b), num_mul(b, a)));
    assert_true(num_equal(num_add(num_add(a, b), c), num_add(a, num_add(b, c))));
    assert_true(num_equal(num_mul(a, num_add(b, c)), num_add(num_mul(a, b), num_mul(a, c))));
    assert_true(num_equal(num_add(num_sub(a, b), b), a));
    if (!num_is_zero(b)) assert_true(num_equal(num_mul(num_div(a, b), b), a));
    assert_int_equal(num_cmp(a, b), num_sign(num_sub(a, b)));
    assert_int_equal(num_cmp(a, num_sub(num_add(a, b), b)), 0);
    /* cross-multiplied by hand, without the library's gcd */
    Num s = num_add(a, b);
    assert_true((Wide)s.num * a.den * b.den == ((Wide)a.num * b.den + (Wide)b.num * a.den) * s.den);
  }
}

static void test_overflow(void **state) {
  (void)state;
  Num big = num_int(INT64_MAX), sum = num_add(big, num_int(1)), product = num_mul(big, big);
  assert_false(num_is_exact(sum));
  assert_true(num_value(sum) == 9223372036854775808.0);
  assert_true(num_value(product) == 9223372036854775808.0 * 9223372036854775808.0);
  assert_false(num_is_exact(num_int(INT64_MIN))); /* its negative would not fit */
  assert_num(num_neg(big), -INT64_MAX, 1);
  Num tiny = num_ratio(1, INT64_MAX), less = num_mul(tiny, tiny);
  assert_false(num_is_exact(less));
  assert_true(fabs(num_value(less) / (1.0 / 9223372036854775808.0 / 9223372036854775808.0) - 1) < 1e-15);
  for (int i = 0; i < 3000; i++) { /* near the edge: exact, or the nearest double */
    Num a = ratio(4000000000), b = ratio(4000000000);
    long double want = (long double)a.num / a.den * ((long double)b.num / b.den);
    Num r = num_mul(a, b);
    if (num_is_exact(r)) assert_true((Wide)r.num * a.den * b.den == (Wide)a.num * b.num * r.den);
    assert_true(fabsl(num_value(r) - want) <= 4 * DBL_EPSILON * fabsl(want));
  }
  assert_true(num_is_zero(num_mul(num_int(0), num_double(1e300))));
  /* what becomes a whole number again is one; what is close to one is not */
  Num large = num_int(1000000000000), square = num_mul(large, large), more = num_add(square, num_int(1));
  assert_false(num_is_exact(square));
  assert_num(num_div(square, large), 1000000000000, 1);
  assert_num(num_div(num_neg(square), large), -1000000000000, 1);
  assert_false(num_is_exact(num_div(more, large)));
}

static void test_parse(void **state) {
  (void)state;
  assert_num(parse("0.1"), 1, 10);
  assert_num(parse("9.81"), 981, 100);
  assert_num(parse("1.5000"), 3, 2);
  assert_num(parse("12e3"), 12000, 1);
  assert_num(parse("25e-2"), 1, 4);
  assert_num(parse("0e999999999999"), 0, 1);
  assert_num(parse("9223372036854775807"), INT64_MAX, 1);
  assert_false(num_is_exact(parse("9223372036854775808")));
  assert_true(num_value(parse("9223372036854775808")) == 9223372036854775808.0);
  assert_true(num_value(parse("6.67430e-11")) == 6.67430e-11);
  assert_true(num_value(parse("1e-300")) == 1e-300);
  assert_true(num_value(parse("1e308")) == 1e308);
  assert_true(isinf(num_value(parse("1e999"))));
  assert_true(num_value(parse("1e-999")) == 0);
  assert_num(parse("0.000000000000000001"), 1, 1000000000000000000);
}

/* Numbers beyond 64 bits: differences are 0 where they are, and nowhere else; errors are bounded. */
static void test_num_inexact(void **state) {
  (void)state;
  Num one = num_int(1), tiny = parse("1e-20"), large = parse("1e20"), near = num_add(one, tiny);
  assert_false(num_is_exact(near));
  assert_false(num_is_one(near));
  assert_false(num_equal(near, num_add(one, parse("2e-20"))));
  assert_true(num_equal(near, num_add(tiny, one)));
  assert_true(num_is_zero(num_sub(near, near)));
  Num gap = num_sub(near, one);
  assert_false(num_is_zero(gap));
  assert_false(num_sign_is_sure(gap));
  assert_true(num_is_imprecise(gap));
  assert_true(num_is_zero(num_sub(num_sub(near, one), tiny))); /* as it is, however it was computed */
  assert_false(num_is_zero(num_mul(parse("1e-200"), parse("1e-200"))));
  assert_true(num_is_imprecise(num_mul(parse("1e-200"), parse("1e-200"))));
  assert_true(num_is_imprecise(num_sub(num_add(large, one), large)));
  assert_false(num_equal(parse("123456789012345678901"), parse("123456789012345678902")));
  assert_true(num_equal(parse("1.50e-30"), parse("0.15e-29")));
  assert_true(num_is_zero(num_sub(num_mul(large, num_ratio(1, 3)), num_div(large, num_int(3)))));
  int exact;
  Num third = num_pow(num_ratio(1, 3), num_int(60), &exact), back = num_pow(num_int(3), num_int(60), &exact);
  assert_false(exact);
  assert_true(num_is_zero(num_sub(num_mul(third, back), one)));
  assert_true(num_is_zero(num_sub(num_neg(near), num_neg(near))));
  assert_true(num_is_zero(num_add(near, num_neg(near))));
  assert_int_equal(num_sign(num_neg(large)), -1);
  assert_true(num_sign_is_sure(large));
  Num eV = parse("1.602176634e-19"), same = num_div(num_int(1602176634), num_pow(num_int(10), num_int(28), &exact));
  assert_true(num_is_zero(num_sub(eV, same)));
  /* against long double, which has eleven bits more: the value is within its bound, and the bound is a few roundings */
  for (int i = 0; i < 2000; i++) {
    int64_t p = between(INT64_MAX / 2, INT64_MAX), q = between(INT64_MAX / 2, INT64_MAX);
    Num sum = num_add(num_ratio(p, 7), num_ratio(q, 11)), product = num_mul(num_int(p), num_ratio(q, 3));
    long double s = (long double)p / 7 + (long double)q / 11, m = (long double)p * ((long double)q / 3);
    if (!num_is_exact(sum)) assert_true(fabsl(num_value(sum) - s) <= num_error(sum) + 1e-18L * s);
    if (!num_is_exact(product)) assert_true(fabsl(num_value(product) - m) <= num_error(product) + 1e-18L * m);
    if (!num_is_exact(product)) assert_true(num_error(product) <= 1e-14 * num_value(product));
  }
}

/* What is printed reads back as the same number. */
static void test_print(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  for (int i = 0; i < 3000; i++) {
    union { uint64_t bits; double x; } u = {.bits = next() << 24 ^ next()};
    if (!isfinite(u.x)) continue;
    char text[32];
    num_format_double(text, u.x);
    assert_true(strtod(text, NULL) == u.x);
  }
  char text[32];
  num_format_double(text, 0.1);
  assert_string_equal(text, "0.1");
  num_format_double(text, 1.0 / 3);
  assert_string_equal(text, "0.3333333333333333");
  StrBuf b = strbuf(a);
  num_print(&b, num_ratio(-1, 2));
  sb_putc(&b, ' ');
  num_print(&b, num_int(3));
  sb_putc(&b, ' ');
  num_print(&b, parse("6.674e-30"));
  assert_string_equal(sb_text(&b), "-1/2 3 6.674e-30");
  arena_free(a);
}

static void test_pow(void **state) {
  (void)state;
  int exact;
  assert_num(num_pow(num_ratio(2, 3), num_int(3), &exact), 8, 27);
  assert_true(exact);
  assert_num(num_pow(num_ratio(2, 3), num_int(-2), &exact), 9, 4);
  assert_num(num_pow(num_ratio(4, 9), num_ratio(1, 2), &exact), 2, 3);
  assert_num(num_pow(num_ratio(4, 9), num_ratio(-3, 2), &exact), 27, 8);
  assert_num(num_pow(num_int(1000000007LL * 1000000007LL), num_ratio(1, 2), &exact), 1000000007, 1);
  assert_true(exact);
  assert_num(num_pow(num_int(1152921504606846976), num_ratio(1, 60), &exact), 2, 1);
  assert_true(exact);
  assert_num(num_pow(num_int(0), num_int(0), &exact), 1, 1);
  Num r = num_pow(num_int(2), num_ratio(1, 2), &exact);
  assert_false(exact);
  assert_true(num_value(r) == sqrt(2));
  num_pow(num_int(-8), num_ratio(1, 3), &exact); /* no real power of a negative base */
  assert_false(exact);
  r = num_pow(num_int(10), num_int(30), &exact);
  assert_false(exact);
  assert_true(fabs(num_value(r) / 1e30 - 1) < 1e-15);
  r = num_pow(num_int(3), num_int(1000000000), &exact);
  assert_false(exact);
  assert_true(isinf(num_value(r)));
  num_pow(num_int(0), num_int(-1), &exact);
  assert_false(exact);
}

static void test_gcd(void **state) {
  (void)state;
  assert_num(num_gcd(num_int(12), num_int(-18)), 6, 1);
  assert_num(num_gcd(num_ratio(1, 2), num_ratio(1, 3)), 1, 6);
  assert_num(num_gcd(num_int(0), num_ratio(-3, 4)), 3, 4);
  assert_num(num_gcd(num_double(0.1), num_int(4)), 1, 1);
  for (int i = 0; i < 2000; i++) {
    Num a = ratio(10000), b = ratio(10000);
    if (num_is_zero(a) || num_is_zero(b)) continue;
    Num g = num_gcd(a, b), x = num_div(a, g), y = num_div(b, g);
    assert_true(num_is_int(x) && num_is_int(y) && num_sign(g) > 0);
    assert_num(num_gcd(x, y), 1, 1);
  }
}

/* ---- memory, names, text ---- */

static void test_arena(void **state) {
  (void)state;
  ArenaConfig config = {.chunk = 64, .max_bytes = 1 << 20};
  Arena *a = arena_new(&config);
  unsigned char *blocks[200];
  for (size_t i = 0; i < 200; i++) {
    blocks[i] = arena_alloc(a, i);
    assert_true((uintptr_t)blocks[i] % _Alignof(max_align_t) == 0);
    for (size_t k = 0; k < i; k++) assert_int_equal(blocks[i][k], 0);
    memset(blocks[i], (int)i, i);
  }
  for (size_t i = 0; i < 200; i++)
    for (size_t k = 0; k < i; k++) assert_int_equal(blocks[i][k], i & 0xFF);
  assert_string_equal(arena_printf(a, "%s-%d", "x", 12), "x-12");
  assert_string_equal(arena_strndup(a, "hello", 3), "hel");
  jmp_buf failed;
  volatile int reached = 0;
  if (!setjmp(failed)) {
    arena_guard(a, &failed);
    arena_alloc(a, 1 << 20);
    reached = 1;
  }
  assert_false(reached);
  assert_true(arena_hit_limit(a));
  arena_free(a);
  arena_free(NULL);
}

#ifdef __SANITIZE_ADDRESS__
int __asan_address_is_poisoned(void const volatile *p);
/* The byte behind each block is out of bounds, also behind one that comes where a block was forgotten. */
static void test_gaps(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  ArenaMark none = arena_mark(a);
  for (int again = 0; again < 2; again++) {
    for (size_t n = 1; n < 100; n++) {
      char *block = arena_alloc(a, n);
      assert_false(__asan_address_is_poisoned(block + n - 1));
      assert_true(__asan_address_is_poisoned(block + n));
    }
    char *last = arena_alloc(a, 7);
    arena_forget(a, none);
    assert_true(__asan_address_is_poisoned(last));
  }
  arena_free(a);
}
#endif

/* What is forgotten is given back, in chunks of its own and in one that goes on; what was there before stays, and
 * what comes after is zero. */
static void test_forget(void **state) {
  (void)state;
  ArenaConfig config = {.chunk = 64};
  Arena *a = arena_new(&config);
  ArenaMark none = arena_mark(a);
  char *kept = arena_strdup(a, "kept");
  size_t used = arena_used(a);
  for (size_t size = 1; size < 1000; size *= 3) {
    ArenaMark before = arena_mark(a);
    memset(arena_alloc(a, 16), 1, 16);
    memset(arena_alloc(a, size), 1, size);
    arena_forget(a, before);
    assert_int_equal(arena_used(a), used);
    char *fresh = arena_alloc(a, 16);
    for (int i = 0; i < 16; i++) assert_int_equal(fresh[i], 0);
    arena_forget(a, before);
    assert_string_equal(kept, "kept");
  }
  arena_forget(a, none);
  assert_int_equal(arena_used(a), 0);
  arena_free(a);
}

/* Chunks that are in use. */
static void *counted_alloc(void *user, size_t n) {
  ++*(int *)user;
  return malloc(n);
}

static void counted_dealloc(void *user, void *p) {
  --*(int *)user;
  free(p);
}

/* A block larger than a chunk, wherever it stands among the chunks, and the latest block are free at once; others
 * stay. A block that is not of the arena changes nothing, and a mark stays good when the chunk that it names is
 * gone. */
static void test_release(void **state) {
  (void)state;
  int chunks = 0;
  char outside[16], far_outside[256];
  Arena *a =
      arena_new(&(ArenaConfig){.alloc = counted_alloc, .dealloc = counted_dealloc, .user = &chunks, .chunk = 128});
  char *kept = arena_strdup(a, "kept"), *large = arena_alloc(a, 1000);
  size_t used = arena_used(a);
  ArenaMark after_large = arena_mark(a);
  char *later = arena_strdup(a, "later"), *latest = arena_alloc(a, 16);
  assert_int_equal(chunks, 4); /* the arena itself, and three */
  size_t all = arena_used(a);
  arena_release(a, latest, 16);
  assert_true(all - arena_used(a) >= 16);
  assert_ptr_equal(arena_alloc(a, 16), latest);
  arena_release(a, later, 6); /* not the latest */
  arena_release(a, outside, sizeof outside);
  arena_release(a, far_outside, sizeof far_outside);
  assert_int_equal(arena_used(a), all);
  arena_release(a, large, 1000);
  assert_int_equal(chunks, 3);
  assert_true(arena_used(a) + 1000 <= all);
  arena_forget(a, after_large); /* all that came after the large block, which is gone */
  assert_int_equal(chunks, 2);
  assert_true(arena_used(a) + 1000 <= used);
  assert_string_equal(kept, "kept");
  arena_free(a);
  assert_int_equal(chunks, 0);
}

/* A vector that grows holds one block, not those before it, and keeps its elements. */
static void test_vec_gives_up(void **state) {
  (void)state;
  enum { MANY = 100000 };
  Arena *a = arena_new(&(ArenaConfig){.chunk = 1024});
  VEC(uint32_t) v = {0};
  for (uint32_t i = 0; i < MANY; i++) vec_push(a, &v, i);
  for (uint32_t i = 0; i < MANY; i++) assert_int_equal(v.at[i], i);
  /* blocks of less than a chunk stay: together less than two chunks, and their gaps */
  assert_true(arena_used(a) < v.cap * sizeof *v.at + 4 * 1024);
  arena_free(a);
}

static void test_intern(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  Interner *in = interner_new(a);
  Name first = intern(in, "theta"), names[5000];
  for (int i = 0; i < 5000; i++) names[i] = intern(in, arena_printf(a, "n%d", i));
  for (int i = 0; i < 5000; i++) assert_ptr_equal(names[i], intern(in, arena_printf(a, "n%d", i)));
  assert_ptr_equal(first, intern_n(in, "thetas", 5));
  assert_ptr_not_equal(first, intern(in, "Theta"));
  assert_string_equal(first, "theta");
  arena_free(a);
}

static void test_strbuf(void **state) {
  (void)state;
  Arena *a = arena_new(NULL);
  StrBuf b = strbuf(a);
  assert_string_equal(sb_text(&b), "");
  for (int i = 0; i < 1000; i++) sb_printf(&b, "%d,", i);
  sb_putc(&b, '!');
  sb_putn(&b, "end-of-it", 3);
  const char *s = sb_text(&b);
  assert_int_equal(strlen(s), b.n);
  for (int i = 0; i < 1000; i++) {
    char *end;
    assert_int_equal(strtol(s, &end, 10), i);
    s = end + 1;
  }
  assert_string_equal(s, "!end");
  VEC(int) v = {0};
  for (int i = 0; i < 1000; i++) vec_push(a, &v, i * i);
  for (int i = 0; i < 1000; i++) assert_int_equal(v.at[i], i * i);
  arena_free(a);
}

/* ---- messages ---- */

typedef struct {
  Arena *a;
  Diags *d;
  const Source *s;
} Page;

static Page page(const char *text) {
  Page p = {.a = arena_new(NULL)};
  Sources *sources = sources_new(p.a);
  source_add(sources, "other.lag", "x\n", 2);
  p.s = source_add(sources, "m.lag", text, strlen(text));
  p.d = diags_new(p.a, sources);
  return p;
}

/* The span of the first occurrence of a word. */
static Span span_of(const Page *p, const char *word) {
  uint32_t at = (uint32_t)(strstr(p->s->text, word) - p->s->text) + p->s->base;
  return (Span){at, at + (uint32_t)strlen(word)};
}

static const char *printed(const Page *p) {
  StrBuf b = strbuf(p->a);
  diags_print(p->d, &b);
  return sb_text(&b);
}

static void test_diag_layout(void **state) {
  (void)state;
  Page p = page("model m\nlet a = thh + 1\n");
  diag_error(p.d, span_of(&p, "thh"), "unknown name `%s`", "thh");
  diag_help(p.d, "did you mean `%s`?", "th");
  diag_warning(p.d, span_of(&p, "model"), "first");
  diag_also(p.d, span_of(&p, "m\n"), "see");
  assert_string_equal(printed(&p), "m.lag:1:1: warning: first\n    1 | model m\n      | ^~~~~\n"
                                   "m.lag:1:7: note: see\n    1 | model m\n      |       ^\n"
                                   "m.lag:2:9: error: unknown name `thh`\n    2 | let a = thh + 1\n      |         "
                                   "^~~\n      = did you mean `th`?\n");
  assert_int_equal(p.d->errors, 1);
  arena_free(p.a);
}

/* Columns count characters, and the caret stands under its text, after tabs and letters of two bytes. */
static void test_diag_utf8(void **state) {
  (void)state;
  Page p = page("\tθ1 = \xF0\x9D\x9C\x83 + ωω\n");
  diag_error(p.d, span_of(&p, "ωω"), "e");
  diag_error(p.d, (Span){0}, "no place");
  assert_string_equal(printed(&p), "lagc: error: no place\nm.lag:1:11: error: e\n"
                                   "    1 | \tθ1 = \xF0\x9D\x9C\x83 + ωω\n      | \t         ^~\n");
  arena_free(p.a);
}

static void test_diag_long_line(void **state) {
  (void)state;
  char text[2100];
  memset(text, 'a', sizeof text);
  memcpy(text + 1000, "BAD", 3);
  memcpy(text + 2097, "\nx", 3);
  Page p = page(text);
  diag_error(p.d, span_of(&p, "BAD"), "e");
  const char *s = printed(&p), *line = strchr(s, '\n') + 1, *under = strchr(line, '\n') + 1;
  assert_non_null(strstr(s, "m.lag:1:1001: error: e\n"));
  assert_true(under - line < 200);
  assert_int_equal(strstr(line, "BAD") - line, strchr(under, '^') - under);
  assert_true(strncmp(strchr(under, '^'), "^~~\n", 4) == 0);
  arena_free(p.a);
}

/* A span over several lines is underlined to the end of its first; one past the end has its caret. */
static void test_diag_edges(void **state) {
  (void)state;
  Page p = page("let a = (1 +\n  2)\nend");
  diag_error(p.d, span_of(&p, "(1 +\n  2)"), "two lines");
  uint32_t end = p.s->base + p.s->len;
  diag_error(p.d, (Span){end, end}, "at the end");
  assert_string_equal(printed(&p), "m.lag:1:9: error: two lines\n    1 | let a = (1 +\n      |         ^~~~\n"
                                   "m.lag:3:4: error: at the end\n    3 | end\n      |    ^\n");
  arena_free(p.a);
}

static void test_diag_many(void **state) {
  (void)state;
  Page p = page("abcdefghijklmnopqrstuvwxyz");
  for (int round = 0; round < 3; round++)
    for (uint32_t i = 0; i < 26; i++) diag_error(p.d, (Span){p.s->base + i, p.s->base + i + 1}, "same");
  assert_int_equal(p.d->list.n, 26); /* a repetition is one message */
  for (int i = 0; i < 500; i++) {
    diag_error(p.d, span_of(&p, "c"), "number %d", i);
    diag_help(p.d, "help %d", i);
  }
  const char *s = printed(&p);
  assert_non_null(strstr(s, "lagc: note: 426 more messages not shown\n"));
  assert_null(strstr(s, "help 400"));
  arena_free(p.a);
}

/* ---- suggestions ---- */

static const char *near(const char *wrong) {
  static const char *const names[] = {"theta", "mass", "gravity", "sin", "sinh", "l1", "l2", "k", "omega_max", "th"};
  const char *found = suggest(wrong, names, sizeof names / sizeof *names);
  return found ? found : "-";
}

static void test_suggest(void **state) {
  (void)state;
  assert_string_equal(near("thetha"), "theta");
  assert_string_equal(near("Mass"), "mass");
  assert_string_equal(near("mas"), "mass");
  assert_string_equal(near("gravtiy"), "gravity");
  assert_string_equal(near("sine"), "sin");
  assert_string_equal(near("K"), "k");
  assert_string_equal(near("x"), "-");
  assert_string_equal(near("entirely_different"), "-");
  char lengthy[200];
  memset(lengthy, 'a', sizeof lengthy);
  lengthy[199] = '\0';
  assert_string_equal(near(lengthy), "-");
  assert_null(suggest("mass", NULL, 0));
}

/* ---- methods ---- */

/* Each method of the list is found by its name; the list ends with NULL, and beyond stays so. */
static void test_methods(void **state) {
  (void)state;
  size_t n = 0, known = 0;
  for (const MethodInfo *m; (m = method_at(n)) != NULL; n++) {
    assert_ptr_equal(method_find(m->name, strlen(m->name)), m);
    known += strcmp(m->name, "rk45") == 0 || strcmp(m->name, "taylor") == 0 || strcmp(m->name, "variational") == 0;
    for (const MethodOption *o = m->options; o->name; o++) assert_ptr_equal(method_option(m, o->name), o);
    assert_null(method_option(m, "no_such_option"));
  }
  assert_int_equal(known, 3);
  assert_null(method_at(n + 1));
  assert_null(method_find("rk4", 2));
  assert_true(method_may_be_gsl("gsl-rk9") == (method_find("gsl-rk8pd", 9) == NULL));
  assert_false(method_may_be_gsl("rk45"));
}

int main(void) {
  const struct CMUnitTest tests[] = {
    cmocka_unit_test(test_methods),
    cmocka_unit_test(test_lowest_terms), cmocka_unit_test(test_field),          cmocka_unit_test(test_overflow),
    cmocka_unit_test(test_parse),        cmocka_unit_test(test_print),          cmocka_unit_test(test_pow),
    cmocka_unit_test(test_gcd),          cmocka_unit_test(test_arena),
#ifdef __SANITIZE_ADDRESS__
    cmocka_unit_test(test_gaps),
#endif
    cmocka_unit_test(test_intern),
    cmocka_unit_test(test_strbuf),       cmocka_unit_test(test_diag_layout),    cmocka_unit_test(test_diag_utf8),
    cmocka_unit_test(test_diag_long_line), cmocka_unit_test(test_diag_edges),   cmocka_unit_test(test_diag_many),
    cmocka_unit_test(test_forget),
    cmocka_unit_test(test_release),
    cmocka_unit_test(test_vec_gives_up),       cmocka_unit_test(test_num_inexact),  cmocka_unit_test(test_suggest),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
