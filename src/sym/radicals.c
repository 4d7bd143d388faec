/* Rational powers in normal form: generators x with x^k = u, where u is split into primes, generators and primitive
 * polynomials so that equal roots become equal generators. */
#include "sym/normal_form_impl.h"

enum { MAX_DEGREE = 64, MAX_POWER = 4096 };

static Frac one(Normal *n) { return frac_num(n->field, num_int(1)); }

/* Generator x with x^k = base, made if absent; expr: its expression (0: base^(1/k)). */
static GenId root_gen(Normal *n, Poly base, int32_t k, Expr expr) {
  uint32_t key[2] = {(uint32_t)k, poly_intern(n->ring, base)};
  GenId x = normal_find_key(n, &n->root_table, key, 2);
  n->canonical = 0;
  if (x != GEN_NONE) return x;
  if (!expr) {
    Expr b = normal_poly_expr(n, base);
    expr = expr_pow_num(n->g, b, num_ratio(1, k));
  }
  x = poly_new_root(n->ring, k, base);
  frac_register_root(n->field, x);
  normal_set_gen_info(n, x, (GenInfo){.kind = GEN_ROOT, .expr = expr});
  normal_add_key(n, &n->root_table, key, 2, x);
  return x;
}

/* x^e for a generator x, also with negative e. */
static Frac gen_power(Normal *n, GenId x, int32_t e) {
  Frac f = frac_poly(poly_gen(n->ring, x));
  return frac_pow(n->field, f, e);
}

/* Whether generator x is known to be positive wherever the expression is defined. */
int normal_gen_positive(const Normal *n, GenId x) {
  const GenInfo *info = &n->gens.at[x];
  if (info->kind == GEN_ROOT && n->ring->gens.at[x].degree % 2 == 0) return 1;
  return expr_sign(n->g, info->expr) == SIGN_POSITIVE;
}

/* Whether all terms of p are positive by coefficients, even powers and positive generators. */
int normal_poly_positive(const Normal *n, Poly p) {
  for (uint32_t i = 0; i < p.n; i++) {
    if (num_sign(p.at[i].c) < 0) return 0;
    const Mono *m = mono_at(n->ring, p.at[i].mono);
    for (uint32_t k = 0; k < m->n; k++)
      if (m->at[k].exp % 2 && !normal_gen_positive(n, m->at[k].gen)) return 0;
  }
  return 1;
}

/* |p|: p itself if known to be positive, else the square root of p^2. */
static Frac abs_of(Normal *n, Poly p) {
  if (normal_poly_positive(n, p)) return frac_poly(p);
  Poly square = poly_mul(n->ring, p, p);
  Expr plain = normal_poly_expr(n, p);
  Expr size = expr_fn(n->g, EX_ABS, plain);
  if (n->ring->status != POLY_OK) return frac_poly(p);
  GenId x = root_gen(n, square, 2, size);
  return gen_power(n, x, 1);
}

/* Floor division of e by k: e = k*q + rest with 0 <= rest < k. */
static int32_t floor_div(int32_t e, int32_t k, int32_t *rest) {
  *rest = (e % k + k) % k;
  return (e - *rest) / k;
}

/* --- numbers --- */

/* prime^(e/k) */
static Frac prime_root(Normal *n, int64_t prime, int32_t e, int32_t k) {
  int32_t rest, whole = floor_div(e, k, &rest), exact;
  Num c = num_pow(num_int(prime), num_int(whole), &exact);
  if (!exact) poly_fail(n->ring, POLY_INEXACT);
  Frac f = frac_num(n->field, c);
  if (!rest) return f;
  int32_t common = rest;
  for (int32_t a = k; a;) {
    int32_t b = common % a;
    common = a;
    a = b;
  }
  Poly base = poly_num(n->ring, num_int(prime));
  GenId x = root_gen(n, base, k / common, 0);
  Frac root = gen_power(n, x, rest / common);
  return frac_mul(n->field, f, root);
}

/* m^(sign/k) by trial division up to 2^16; the cofactor counts as a prime. */
static Frac integer_root(Normal *n, int64_t m, int32_t sign, int32_t k) {
  Frac f = one(n);
  for (int64_t p = 2; m > 1 && n->ring->status == POLY_OK; p++) {
    if (p > 65536 || p * p > m) p = m;
    int32_t e = 0;
    for (; m % p == 0; m /= p) e++;
    if (!e) continue;
    Frac root = prime_root(n, p, sign * e, k);
    f = frac_mul(n->field, f, root);
  }
  return f;
}

static Frac number_root(Normal *n, Num c, int32_t k) {
  if (!num_is_exact(c)) {
    poly_fail(n->ring, POLY_INEXACT);
    return one(n);
  }
  Frac top = integer_root(n, c.num, 1, k), bottom = integer_root(n, c.den, -1, k);
  return frac_mul(n->field, top, bottom);
}

/* --- monomials --- */

/* The part of the k-th root of x^e that comes out of the radical; *left: the exponent of x that stays under it. */
static Frac gen_root(Normal *n, GenId x, int32_t e, int32_t k, int32_t *left) {
  int32_t whole = floor_div(e, k, left);
  Frac base = frac_poly(poly_gen(n->ring, x));
  if (k % 2 == 1 || normal_gen_positive(n, x)) {
    Frac f = frac_pow(n->field, base, whole);
    if (!*left) return f;
    GenId root = root_gen(n, base.num, k, 0);
    Frac rest = gen_power(n, root, *left);
    *left = 0;
    return frac_mul(n->field, f, rest);
  }
  if (!whole) return one(n);
  Frac size = abs_of(n, base.num);
  return frac_pow(n->field, size, whole);
}

/* Factor of the k-th root of a monomial that leaves the radical; *left is the monomial that stays below it. */
static Frac mono_root(Normal *n, MonoId m, int32_t k, MonoId *left) {
  Frac f = one(n);
  Mono mono = *mono_at(n->ring, m);
  MonoPow *stays = ARENA_ARRAY(n->arena, MonoPow, mono.n + 1);
  for (uint32_t i = 0; i < mono.n; i++) {
    stays[i].gen = mono.at[i].gen;
    Frac root = gen_root(n, mono.at[i].gen, mono.at[i].exp, k, &stays[i].exp);
    f = frac_mul(n->field, f, root);
  }
  *left = mono_of(n->ring, stays, mono.n);
  return f;
}

/* --- polynomials and fractions --- */

static Frac poly_root(Normal *n, Poly p, int32_t k) {
  PolyRing *r = n->ring;
  Num content;
  MonoId common, left;
  Poly rest = poly_primitive(r, p, &content, &common);
  if (r->status != POLY_OK) return one(n);
  int negative = num_sign(content) < 0;
  Frac f = number_root(n, num_abs(content), k);
  Frac out = mono_root(n, common, k, &left);
  f = frac_mul(n->field, f, out);
  if (negative && k % 2 == 1) f = frac_neg(n->field, f);
  rest = poly_mul_mono(r, rest, num_int(negative && k % 2 == 0 ? -1 : 1), left);
  if (poly_is_one(rest) || r->status != POLY_OK) return f;
  GenId x = root_gen(n, rest, k, 0);
  Frac root = gen_power(n, x, 1);
  return frac_mul(n->field, f, root);
}

/* (num / prod F^e)^(1/k) = (num * prod F^r)^(1/k) / prod |F|^((e + r)/k) with e + r = 0 mod k. */
static Frac frac_root(Normal *n, Frac a, int32_t k) {
  PolyRing *r = n->ring;
  Den d = frac_den(n->field, a.den);
  Frac below = one(n);
  Poly num = a.num;
  for (uint32_t i = 0; i < d.n && r->status == POLY_OK; i++) {
    Poly factor = poly_at(r, d.at[i].factor);
    uint32_t fill = ((uint32_t)k - d.at[i].exp % (uint32_t)k) % (uint32_t)k;
    Poly power = poly_pow(r, factor, fill);
    num = poly_mul(r, num, power);
    Frac size = k % 2 == 0 ? abs_of(n, factor) : frac_poly(factor);
    Frac part = frac_pow(n->field, size, (int32_t)((d.at[i].exp + fill) / (uint32_t)k));
    below = frac_mul(n->field, below, part);
  }
  if (num.n == 0 || r->status != POLY_OK) return frac_poly(poly_zero());
  Frac above = poly_root(n, num, k), inverse = frac_inv(n->field, below);
  return frac_mul(n->field, above, inverse);
}

Frac normal_pow_num(Normal *n, Frac a, Num e) {
  if (e.den > MAX_DEGREE || e.num > MAX_POWER || e.num < -MAX_POWER) {
    poly_fail(n->ring, POLY_TOO_LARGE);
    return a;
  }
  if (e.den != 1) a = frac_root(n, a, (int32_t)e.den);
  return frac_pow(n->field, a, (int32_t)e.num);
}

Frac normal_hypot(Normal *n, Frac a, Frac b, Expr e) {
  Frac aa = frac_mul(n->field, a, a), bb = frac_mul(n->field, b, b);
  Frac sum = frac_add(n->field, aa, bb);
  if (!n->keep_range || sum.den || sum.num.n < 2 || n->ring->status != POLY_OK)
    return normal_pow_num(n, sum, num_ratio(1, 2));
  return gen_power(n, root_gen(n, sum.num, 2, e), 1);
}
