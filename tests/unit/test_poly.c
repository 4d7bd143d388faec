/* Polynomials and fractions of them: values are checked modulo a prime with arithmetic of the
 * test's own, forms against textbook identities. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>

#include <cmocka.h>

#include "sym/frac.h"

typedef struct {
  Arena *arena;
  PolyRing *r;
  FracField *f;
  GenId x, y, c, s; /* c, s: cosine and sine, s^2 = 1 - c^2 */
} Fixture;

static int setup(void **state) {
  Arena *a = arena_new(NULL);
  Fixture *t = ARENA_NEW(a, Fixture);
  t->arena = a;
  t->r = poly_ring(a, 5000, 1000000);
  t->f = frac_field(t->r);
  t->x = poly_new_gen(t->r);
  t->y = poly_new_gen(t->r);
  t->c = poly_new_gen(t->r);
  Poly one = poly_num(t->r, num_int(1)), c = poly_gen(t->r, t->c);
  Poly cc = poly_mul(t->r, c, c);
  t->s = poly_new_root(t->r, 2, poly_sub(t->r, one, cc));
  frac_register_root(t->f, t->s);
  *state = t;
  return 0;
}

static int teardown(void **state) {
  arena_free(((Fixture *)*state)->arena);
  return 0;
}

/* --- values modulo a prime --- */

static const uint64_t PRIME = 2147483647u; /* 2^31 - 1 */

static uint64_t power_mod(uint64_t b, uint64_t e) {
  uint64_t r = 1;
  for (b %= PRIME; e; e >>= 1, b = b * b % PRIME)
    if (e & 1) r = r * b % PRIME;
  return r;
}

static uint64_t num_mod(Num v) {
  uint64_t top = (uint64_t)((v.num % (int64_t)PRIME + (int64_t)PRIME) % (int64_t)PRIME);
  return top * power_mod((uint64_t)v.den, PRIME - 2) % PRIME;
}

/* p with generator g at at[g]. */
static uint64_t value(const PolyRing *r, Poly p, const uint64_t *at) {
  uint64_t sum = 0;
  for (uint32_t i = 0; i < p.n; i++) {
    uint64_t term = num_mod(p.at[i].c);
    const Mono *m = mono_at(r, p.at[i].mono);
    for (uint32_t k = 0; k < m->n; k++) {
      int32_t e = m->at[k].exp;
      uint64_t b = e < 0 ? power_mod(at[m->at[k].gen], PRIME - 2) : at[m->at[k].gen];
      term = term * power_mod(b, (uint64_t)(e < 0 ? -e : e)) % PRIME;
    }
    sum = (sum + term) % PRIME;
  }
  return sum;
}

static Poly random_poly(Fixture *t, uint32_t *seed) {
  Term terms[6];
  for (int i = 0; i < 6; i++) {
    MonoPow m[3];
    for (uint32_t k = 0; k < 3; k++) {
      *seed = *seed * 1664525u + 1013904223u;
      m[k] = (MonoPow){.gen = k, .exp = (int32_t)(*seed >> 28) % 4};
    }
    terms[i] = (Term){.mono = mono_of(t->r, m, 3), .c = num_ratio((int64_t)(*seed >> 20) - 2000, 1 + (*seed >> 30))};
  }
  return poly_collect(t->r, terms, 6);
}

static void sums_and_products_have_the_right_values(void **state) {
  Fixture *t = *state;
  uint32_t seed = 7;
  const uint64_t at[4] = {12345, 777, 424242, 0};
  for (int round = 0; round < 50; round++) {
    Poly a = random_poly(t, &seed), b = random_poly(t, &seed);
    uint64_t u = value(t->r, a, at), v = value(t->r, b, at);
    assert_int_equal(value(t->r, poly_add(t->r, a, b), at), (u + v) % PRIME);
    assert_int_equal(value(t->r, poly_sub(t->r, a, b), at), (u + PRIME - v) % PRIME);
    assert_int_equal(value(t->r, poly_mul(t->r, a, b), at), u * v % PRIME);
    assert_int_equal(value(t->r, poly_pow(t->r, a, 3), at), u * u % PRIME * u % PRIME);
    assert_int_equal(t->r->status, POLY_OK);
  }
}

static Poly plus(Fixture *t, GenId a, GenId b, int sign) {
  Poly x = poly_gen(t->r, a), y = poly_gen(t->r, b);
  return sign > 0 ? poly_add(t->r, x, y) : poly_sub(t->r, x, y);
}

static void binomial_theorem(void **state) {
  Fixture *t = *state;
  Poly p = poly_pow(t->r, plus(t, t->x, t->y, 1), 5);
  const int64_t row[6] = {1, 5, 10, 10, 5, 1};
  assert_int_equal(p.n, 6);
  for (uint32_t i = 0; i < p.n; i++) {
    int32_t e = mono_exp(t->r, p.at[i].mono, t->x);
    assert_int_equal(e + mono_exp(t->r, p.at[i].mono, t->y), 5);
    assert_true(num_equal(p.at[i].c, num_int(row[e])));
  }
}

static void relations_are_applied(void **state) {
  Fixture *t = *state;
  PolyRing *r = t->r;
  Poly s = poly_gen(r, t->s), c = poly_gen(r, t->c), one = poly_num(r, num_int(1));
  /* s^4 = 1 - 2c^2 + c^4, s^5 = s - 2sc^2 + sc^4 */
  Poly c2 = poly_pow(r, c, 2), c4 = poly_pow(r, c, 4);
  Poly want = poly_add(r, poly_sub(r, one, poly_scale(r, num_int(2), c2)), c4);
  assert_true(poly_equal(poly_pow(r, s, 4), want));
  assert_true(poly_equal(poly_pow(r, s, 5), poly_mul(r, s, want)));
  /* (s + c)^2 + (s - c)^2 = 2 */
  Poly sum = poly_pow(r, plus(t, t->s, t->c, 1), 2), difference = poly_pow(r, plus(t, t->s, t->c, -1), 2);
  assert_true(poly_equal(poly_add(r, sum, difference), poly_num(r, num_int(2))));
}

static void exact_division(void **state) {
  Fixture *t = *state;
  PolyRing *r = t->r;
  Poly x3 = poly_pow(r, poly_gen(r, t->x), 3), y3 = poly_pow(r, poly_gen(r, t->y), 3), q;
  Poly difference = poly_sub(r, x3, y3), d = plus(t, t->x, t->y, -1);
  assert_true(poly_div_exact(r, difference, d, &q));
  assert_true(poly_equal(poly_mul(r, q, d), difference));
  assert_int_equal(q.n, 3);
  assert_false(poly_div_exact(r, poly_add(r, x3, y3), d, &q));
  /* modulo s^2 = 1 - c^2 factors are not unique: refused */
  assert_false(poly_div_exact(r, difference, plus(t, t->x, t->s, 1), &q));
  uint32_t seed = 99;
  for (int round = 0; round < 20; round++) {
    Poly a = random_poly(t, &seed), b = random_poly(t, &seed);
    assert_true(poly_div_exact(r, poly_mul(r, a, b), b, &q));
    assert_true(poly_equal(q, a));
  }
  assert_int_equal(r->status, POLY_OK);
}

static void laurent_monomials_cancel(void **state) {
  Fixture *t = *state;
  MonoPow up = {t->x, 3}, down = {t->x, -3};
  MonoId a = mono_of(t->r, &up, 1), b = mono_of(t->r, &down, 1);
  assert_int_equal(mono_mul(t->r, a, b), 0);
  assert_int_equal(mono_pow(t->r, a, -1), b);
}

static void primitive_parts(void **state) {
  Fixture *t = *state;
  PolyRing *r = t->r;
  /* -6x^2y/5 + 4x/5: content is the gcd of the numbers with the sign of the first term */
  MonoPow x2y[2] = {{t->x, 2}, {t->y, 1}}, x1 = {t->x, 1};
  Term terms[2];
  terms[0] = (Term){mono_of(r, x2y, 2), num_ratio(-6, 5)};
  terms[1] = (Term){mono_of(r, &x1, 1), num_ratio(4, 5)};
  Poly p = poly_collect(r, terms, 2), prim;
  Num content;
  MonoId common;
  prim = poly_primitive(r, p, &content, &common);
  assert_true(num_equal(num_abs(content), num_ratio(2, 5)));
  assert_int_equal(common, mono_of(r, &x1, 1));
  assert_true(num_sign(prim.at[0].c) > 0);
  assert_true(poly_equal(poly_mul_mono(r, prim, content, common), p));
}

static void overflow_is_inexact(void **state) {
  Fixture *t = *state;
  Poly p = poly_scale(t->r, num_int(3037000500), poly_gen(t->r, t->x)); /* the square is 2^63 and a bit */
  assert_int_equal(poly_mul(t->r, p, p).n, 0);
  assert_int_equal(t->r->status, POLY_INEXACT);
}

static void budgets_are_kept(void **state) {
  Fixture *t = *state;
  Poly sum = poly_add(t->r, plus(t, t->x, t->y, 1), plus(t, t->c, t->s, 1));
  poly_pow(t->r, sum, 200);
  assert_int_equal(t->r->status, POLY_TOO_LARGE);
  assert_true(arena_used(t->arena) < 64u << 20);
}

/* --- fractions --- */

static Frac over(Fixture *t, Poly a, Poly b) {
  Frac below = frac_inv(t->f, frac_poly(b));
  return frac_mul(t->f, frac_poly(a), below);
}

static void fractions_add_over_their_common_denominator(void **state) {
  Fixture *t = *state;
  Poly one = poly_num(t->r, num_int(1)), p = plus(t, t->x, t->y, 1), m = plus(t, t->x, t->y, -1);
  Frac a = over(t, one, p), b = over(t, one, m);
  Frac sum = frac_add(t->f, a, b); /* 2x/((x+y)(x-y)) */
  assert_true(poly_equal(sum.num, poly_scale(t->r, num_int(2), poly_gen(t->r, t->x))) ||
              poly_equal(sum.num, poly_scale(t->r, num_int(-2), poly_gen(t->r, t->x))));
  assert_int_equal(frac_den(t->f, sum.den).n, 2);
  /* a term over an equal denominator leaves it as it is */
  assert_int_equal(frac_add(t->f, sum, sum).den, sum.den);
  Frac zero = frac_sub(t->f, sum, frac_add(t->f, b, a));
  assert_int_equal(zero.num.n, 0);
}

static void equal_factors_cancel(void **state) {
  Fixture *t = *state;
  Poly p = plus(t, t->x, t->y, 1), m = plus(t, t->y, t->x, -1);
  Frac one = over(t, p, p), minus = over(t, m, plus(t, t->x, t->y, -1));
  assert_true(poly_is_one(one.num) && one.den == 0);
  assert_true(poly_equal(minus.num, poly_num(t->r, num_int(-1))) && minus.den == 0);
  Frac squares = over(t, poly_mul(t->r, p, m), p);
  Frac less = frac_cancel(t->f, squares);
  assert_int_equal(less.den, 0);
  assert_true(poly_equal(less.num, m));
}

static void one_minus_cosine_squared_is_a_power_of_the_sine(void **state) {
  Fixture *t = *state;
  PolyRing *r = t->r;
  Poly s = poly_gen(r, t->s), s2 = poly_mul(r, s, s), one = poly_num(r, num_int(1));
  Frac a = over(t, one, s2), b = over(t, one, s);
  Frac b2 = frac_mul(t->f, b, b);
  assert_int_equal(a.den, b2.den);
  Frac back = frac_cancel(t->f, frac_mul(t->f, a, frac_poly(s2)));
  assert_true(poly_is_one(back.num) && back.den == 0);
}

static void division_by_zero_is_reported(void **state) {
  Fixture *t = *state;
  frac_inv(t->f, frac_poly(poly_zero()));
  assert_int_equal(t->r->status, POLY_DIVIDED_BY_ZERO);
}

#define TEST(f) cmocka_unit_test_setup_teardown(f, setup, teardown)

int main(void) {
  const struct CMUnitTest tests[] = {
      TEST(sums_and_products_have_the_right_values),
      TEST(binomial_theorem),
      TEST(relations_are_applied),
      TEST(exact_division),
      TEST(laurent_monomials_cancel),
      TEST(primitive_parts),
      TEST(overflow_is_inexact),
      TEST(budgets_are_kept),
      TEST(fractions_add_over_their_common_denominator),
      TEST(equal_factors_cancel),
      TEST(one_minus_cosine_squared_is_a_power_of_the_sine),
      TEST(division_by_zero_is_reported),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
