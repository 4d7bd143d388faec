/* Arithmetic of fractions with factored denominators; numerators are cancelled by exact division on request
 * (frac_cancel). */
#include "sym/frac.h"

#include <stdlib.h>

FracField *frac_field(PolyRing *r) {
  FracField *f = ARENA_NEW(r->arena, FracField);
  f->ring = r;
  f->den_table.arena = r->arena;
  frac_den_of(f, NULL, 0);
  return f;
}

void frac_register_root(FracField *f, GenId x) {
  PolyRing *r = f->ring;
  PolyId id = poly_intern(r, r->gens.at[x].relation);
  while (f->root_of.n <= id) vec_push(r->arena, &f->root_of, 0);
  if (!f->root_of.at[id]) f->root_of.at[id] = x + 1;
}

Frac frac_poly(Poly p) { return (Frac){.num = p}; }
Frac frac_num(FracField *f, Num c) { return frac_poly(poly_num(f->ring, c)); }

/* --- denominators --- */

static int by_factor(const void *a, const void *b) {
  PolyId x = ((const DenFactor *)a)->factor, y = ((const DenFactor *)b)->factor;
  return (x > y) - (x < y);
}

DenId frac_den_of(FracField *f, const DenFactor *at, uint32_t n) {
  Arena *arena = f->ring->arena;
  DenFactor *list = ARENA_ARRAY(arena, DenFactor, n + 1);
  if (n) memcpy(list, at, n * sizeof *at);
  if (n > 1) qsort(list, n, sizeof *list, by_factor);
  uint32_t out = 0, hash = 1;
  for (uint32_t i = 0; i < n;) {
    DenFactor one = list[i++];
    while (i < n && list[i].factor == one.factor) one.exp += list[i++].exp;
    if (one.exp == 0) continue;
    hash = hash_mix(hash_mix(hash, one.factor), one.exp);
    list[out++] = one;
  }
  uint32_t slot = idtable_start(&f->den_table, hash), id;
  while (idtable_next(&f->den_table, hash, &slot, &id)) {
    Den d = f->dens.at[id];
    if (d.n == out && (out == 0 || memcmp(d.at, list, out * sizeof *list) == 0)) return id;
  }
  vec_push(arena, &f->dens, ((Den){.at = list, .n = out}));
  idtable_add(&f->den_table, hash, f->dens.n - 1);
  return f->dens.n - 1;
}

static DenId den_mul(FracField *f, DenId a, DenId b) {
  if (a == 0 || b == 0) return a + b;
  Den x = frac_den(f, a), y = frac_den(f, b);
  DenFactor *list = ARENA_ARRAY(f->ring->arena, DenFactor, x.n + y.n);
  memcpy(list, x.at, x.n * sizeof *list);
  memcpy(list + x.n, y.at, y.n * sizeof *list);
  return frac_den_of(f, list, x.n + y.n);
}

DenId frac_lcm(FracField *f, DenId a, DenId b) {
  if (a == b || b == 0) return a;
  if (a == 0) return b;
  Den x = frac_den(f, a), y = frac_den(f, b);
  DenFactor *list = ARENA_ARRAY(f->ring->arena, DenFactor, x.n + y.n);
  uint32_t n = 0, i = 0, k = 0;
  while (i < x.n || k < y.n) {
    if (k == y.n || (i < x.n && x.at[i].factor < y.at[k].factor)) {
      list[n++] = x.at[i++];
    } else if (i == x.n || y.at[k].factor < x.at[i].factor) {
      list[n++] = y.at[k++];
    } else {
      list[n++] = x.at[i].exp > y.at[k].exp ? x.at[i] : y.at[k];
      i++;
      k++;
    }
  }
  return frac_den_of(f, list, n);
}

Poly frac_cofactor(FracField *f, DenId from, DenId to) {
  PolyRing *r = f->ring;
  Poly p = poly_num(r, num_int(1));
  Den x = frac_den(f, from), y = frac_den(f, to);
  for (uint32_t k = 0, i = 0; k < y.n; k++) {
    while (i < x.n && x.at[i].factor < y.at[k].factor) i++;
    uint32_t have = i < x.n && x.at[i].factor == y.at[k].factor ? x.at[i].exp : 0;
    if (have >= y.at[k].exp) continue;
    Poly power = poly_pow(r, poly_at(r, y.at[k].factor), y.at[k].exp - have);
    p = poly_mul(r, p, power);
  }
  return p;
}

Poly frac_den_poly(FracField *f, DenId den) { return frac_cofactor(f, 0, den); }

/* --- arithmetic --- */

static Frac normal_zero(Frac a) {
  if (a.num.n == 0) a.den = 0;
  return a;
}

Frac frac_add(FracField *f, Frac a, Frac b) {
  if (a.num.n == 0) return b;
  if (b.num.n == 0) return a;
  PolyRing *r = f->ring;
  DenId den = frac_lcm(f, a.den, b.den);
  Poly over_a = frac_cofactor(f, a.den, den), over_b = frac_cofactor(f, b.den, den);
  Poly x = poly_mul(r, a.num, over_a), y = poly_mul(r, b.num, over_b);
  return normal_zero((Frac){.num = poly_add(r, x, y), .den = den});
}

Frac frac_neg(FracField *f, Frac a) { return (Frac){.num = poly_scale(f->ring, num_int(-1), a.num), .den = a.den}; }

Frac frac_sub(FracField *f, Frac a, Frac b) {
  Frac minus_b = frac_neg(f, b);
  return frac_add(f, a, minus_b);
}

typedef struct {
  DenId den;
  uint32_t index;
} Keyed;

static int by_den(const void *a, const void *b) {
  const Keyed *x = a, *y = b;
  if (x->den != y->den) return x->den < y->den ? -1 : 1;
  return (x->index > y->index) - (x->index < y->index);
}

Frac frac_sum(FracField *f, const Frac *a, const Num *c, uint32_t n) {
  Arena *arena = f->ring->arena;
  Keyed *order = ARENA_ARRAY(arena, Keyed, n + 1);
  Poly *part = ARENA_ARRAY(arena, Poly, n + 1);
  Num *scale = ARENA_ARRAY(arena, Num, n + 1);
  for (uint32_t i = 0; i < n; i++) order[i] = (Keyed){.den = a[i].den, .index = i};
  if (n > 1) qsort(order, n, sizeof *order, by_den);
  Frac sum = frac_poly(poly_zero());
  for (uint32_t i = 0; i < n && f->ring->status == POLY_OK;) {
    uint32_t m = 0, first = i;
    for (; i < n && order[i].den == order[first].den; i++, m++) {
      part[m] = a[order[i].index].num;
      scale[m] = c ? c[order[i].index] : num_int(1);
    }
    Frac equal = {.num = poly_sum(f->ring, part, scale, m), .den = order[first].den};
    sum = frac_add(f, sum, normal_zero(equal));
  }
  return sum;
}

/* Cancels a denominator factor that equals the numerator up to a number. Returns 1 if one did. */
static int cancel_equal(FracField *f, Frac *a) {
  PolyRing *r = f->ring;
  Den d = frac_den(f, a->den);
  for (uint32_t i = 0; i < d.n; i++) {
    Poly p = poly_at(r, d.at[i].factor);
    if (p.n != a->num.n || p.at[0].mono != a->num.at[0].mono) continue;
    Num c = num_div(a->num.at[0].c, p.at[0].c);
    Poly scaled = poly_scale(r, c, p);
    if (!poly_equal(scaled, a->num)) continue;
    DenFactor *list = ARENA_ARRAY(r->arena, DenFactor, d.n);
    memcpy(list, d.at, d.n * sizeof *list);
    list[i].exp--;
    *a = (Frac){.num = poly_num(r, c), .den = frac_den_of(f, list, d.n)};
    return 1;
  }
  return 0;
}

/* Cancels a numerator against a factor of the other fraction's denominator. */
static void cancel_across(FracField *f, Poly *num, DenId *den) {
  Frac over = {.num = *num, .den = *den};
  if (!*den || num->n < 2 || !cancel_equal(f, &over)) return;
  *num = over.num;
  *den = over.den;
}

Frac frac_mul(FracField *f, Frac a, Frac b) {
  cancel_across(f, &b.num, &a.den);
  cancel_across(f, &a.num, &b.den);
  Poly num = poly_mul(f->ring, a.num, b.num);
  DenId den = den_mul(f, a.den, b.den);
  return normal_zero((Frac){.num = num, .den = den});
}

/* Splits a monomial for inversion: generators without a relation are returned, roots become denominator factors. */
static MonoId split_roots(FracField *f, MonoId m, DenFactor *list, uint32_t *n) {
  PolyRing *r = f->ring;
  MonoId units = m;
  Mono mono = *mono_at(r, m);
  for (uint32_t i = 0; i < mono.n; i++) {
    GenId x = mono.at[i].gen;
    if (!r->gens.at[x].degree) continue;
    units = mono_without(r, units, x);
    PolyId factor = poly_intern(r, poly_gen(r, x));
    list[(*n)++] = (DenFactor){.factor = factor, .exp = (uint32_t)mono.at[i].exp};
  }
  return units;
}

/* A primitive polynomial as a denominator factor; the R of a relation x^k = R becomes the factor x^k. */
static DenFactor as_factor(FracField *f, Poly p) {
  PolyRing *r = f->ring;
  PolyId id = poly_intern(r, p);
  if (id >= f->root_of.n || !f->root_of.at[id]) return (DenFactor){.factor = id, .exp = 1};
  GenId x = f->root_of.at[id] - 1;
  uint32_t k = (uint32_t)r->gens.at[x].degree;
  return (DenFactor){.factor = poly_intern(r, poly_gen(r, x)), .exp = k};
}

Frac frac_inv(FracField *f, Frac a) {
  PolyRing *r = f->ring;
  if (a.num.n == 0) poly_fail(r, POLY_DIVIDED_BY_ZERO);
  if (r->status != POLY_OK) return frac_poly(poly_zero());
  Num content;
  MonoId common;
  Poly p = poly_primitive(r, a.num, &content, &common);
  if (r->status != POLY_OK) return frac_poly(poly_zero());
  DenFactor *list = ARENA_ARRAY(r->arena, DenFactor, mono_at(r, common)->n + 1);
  uint32_t n = 0;
  MonoId units = split_roots(f, common, list, &n);
  if (!poly_is_one(p)) list[n++] = as_factor(f, p);
  MonoId inverse = mono_pow(r, units, -1);
  Poly num = frac_den_poly(f, a.den);
  num = poly_mul_mono(r, num, num_div(num_int(1), content), inverse);
  return (Frac){.num = num, .den = frac_den_of(f, list, n)};
}

Frac frac_pow(FracField *f, Frac a, int32_t n) {
  if (n < 0) {
    a = frac_inv(f, a);
    n = -n;
  }
  Den d = frac_den(f, a.den);
  DenFactor *list = ARENA_ARRAY(f->ring->arena, DenFactor, d.n + 1);
  for (uint32_t i = 0; i < d.n; i++) list[i] = (DenFactor){d.at[i].factor, d.at[i].exp * (uint32_t)n};
  Poly num = poly_pow(f->ring, a.num, (uint32_t)n);
  return normal_zero((Frac){.num = num, .den = frac_den_of(f, list, d.n)});
}

/* --- cancelling --- */

/* Divisor of the numerator that lowers the exponent of factor d by *step: the factor itself, or R for a generator x
 * with x^k = R that occurs k times (step k). */
static Poly divisor_of(FracField *f, DenFactor d, uint32_t *step) {
  PolyRing *r = f->ring;
  Poly p = poly_at(r, d.factor);
  *step = 1;
  if (p.n != 1 || mono_at(r, p.at[0].mono)->n != 1) return p;
  PolyGen gen = r->gens.at[mono_at(r, p.at[0].mono)->at[0].gen];
  if (!gen.degree) return p;
  *step = (uint32_t)gen.degree;
  return d.exp >= *step ? gen.relation : poly_zero();
}

/* Cancels the power of a generator common to all terms of the numerator against factor *d. */
static Poly cancel_common(FracField *f, Poly num, DenFactor *d) {
  PolyRing *r = f->ring;
  Poly p = poly_at(r, d->factor);
  if (p.n != 1 || num.n == 0 || mono_at(r, p.at[0].mono)->n != 1) return num;
  GenId x = mono_at(r, p.at[0].mono)->at[0].gen;
  int32_t have = mono_exp(r, poly_common_monomial(r, num), x);
  if (have <= 0) return num;
  uint32_t take = (uint32_t)have < d->exp ? (uint32_t)have : d->exp;
  MonoPow lower = {.gen = x, .exp = -(int32_t)take};
  MonoId m = mono_of(r, &lower, 1);
  d->exp -= take;
  return poly_mul_mono(r, num, num_int(1), m);
}

Frac frac_cancel(FracField *f, Frac a) {
  PolyRing *r = f->ring;
  Den d = frac_den(f, a.den);
  DenFactor *list = ARENA_ARRAY(r->arena, DenFactor, d.n + 1);
  if (d.n) memcpy(list, d.at, d.n * sizeof *list);
  for (uint32_t i = 0; i < d.n; i++) {
    a.num = cancel_common(f, a.num, &list[i]);
    while (list[i].exp && a.num.n && r->status == POLY_OK) {
      uint32_t step;
      Poly q, p = divisor_of(f, list[i], &step);
      if (p.n == 0 || !poly_div_exact(r, a.num, p, &q)) break;
      a.num = q;
      list[i].exp -= step;
    }
  }
  a.den = frac_den_of(f, list, d.n);
  return normal_zero(a);
}
