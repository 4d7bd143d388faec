/* Polynomial arithmetic. Sums and products go through an accumulator indexed by monomial id, so a term costs one
 * array access. Relations are applied to the accumulated sum, one step for every term at a time, so that equal terms
 * merge before they are rewritten further. */
#include "sym/poly.h"

#include <stdlib.h>

PolyRing *poly_ring(Arena *a, uint32_t max_terms, uint64_t max_work) {
  PolyRing *r = ARENA_NEW(a, PolyRing);
  r->arena = a;
  r->max_terms = max_terms;
  r->work = max_work;
  r->mono_table.arena = a;
  r->poly_table.arena = a;
  mono_of(r, NULL, 0);
  poly_intern(r, poly_zero());
  return r;
}

void poly_fail(PolyRing *r, PolyStatus why) {
  if (r->status == POLY_OK) r->status = why;
}

/* Takes n units from the work budget; returns 0 if it is used up or the ring has failed. */
static int spend(PolyRing *r, uint64_t n) {
  if (r->status != POLY_OK) return 0;
  if (r->work < n) {
    poly_fail(r, POLY_TOO_LARGE);
    return 0;
  }
  r->work -= n;
  return 1;
}

/* --- coefficients --- */

static void demand_exact(PolyRing *r, Num c) {
  if (!r->residues && !num_is_exact(c)) poly_fail(r, POLY_INEXACT);
}

static Num add(PolyRing *r, Num a, Num b) {
  Num s = {.den = 1};
  if (a.den == 1 && b.den == 1 && !__builtin_add_overflow(a.num, b.num, &s.num) && s.num != INT64_MIN) return s;
  s = num_add(a, b);
  demand_exact(r, s);
  return s;
}

static Num mul(PolyRing *r, Num a, Num b) {
  Num p = {.den = 1};
  if (a.den == 1 && b.den == 1 && !__builtin_mul_overflow(a.num, b.num, &p.num) && p.num != INT64_MIN) return p;
  p = num_mul(a, b);
  demand_exact(r, p);
  return p;
}

/* --- generators and monomials --- */

GenId poly_new_gen(PolyRing *r) {
  vec_push(r->arena, &r->gens, ((PolyGen){0}));
  return r->gens.n - 1;
}

GenId poly_new_root(PolyRing *r, int32_t degree, Poly relation) {
  vec_push(r->arena, &r->gens, ((PolyGen){.degree = degree, .relation = relation}));
  return r->gens.n - 1;
}

static GenId find_reducible(const PolyRing *r, const MonoPow *at, uint32_t n) {
  for (uint32_t i = n; i-- > 0;) {
    int32_t k = r->gens.at[at[i].gen].degree;
    if (k && at[i].exp >= k) return at[i].gen;
  }
  return GEN_NONE;
}

/* The id of a monomial without zero exponents. */
static MonoId mono_intern(PolyRing *r, const MonoPow *at, uint32_t n) {
  uint32_t hash = n;
  for (uint32_t i = 0; i < n; i++) hash += hash_mix(at[i].gen, (uint32_t)at[i].exp); /* a sum: no factor waits */
  uint32_t slot = idtable_start(&r->mono_table, hash), id;
  while (idtable_next(&r->mono_table, hash, &slot, &id)) {
    const Mono *m = &r->monos.at[id];
    if (m->n == n && (n == 0 || memcmp(m->at, at, n * sizeof *at) == 0)) return id;
  }
  Mono m = {.n = n, .hash = hash, .reducible = find_reducible(r, at, n)};
  if (n) {
    MonoPow *copy = ARENA_ARRAY(r->arena, MonoPow, n);
    memcpy(copy, at, n * sizeof *at);
    m.at = copy;
  }
  vec_push(r->arena, &r->monos, m);
  idtable_add(&r->mono_table, hash, r->monos.n - 1);
  return r->monos.n - 1;
}

MonoId mono_of(PolyRing *r, const MonoPow *at, uint32_t n) {
  r->scratch.n = 0;
  for (uint32_t i = 0; i < n; i++)
    if (at[i].exp) vec_push(r->arena, &r->scratch, at[i]);
  return mono_intern(r, r->scratch.at, r->scratch.n);
}

/* Exponents stay far from overflow: a polynomial of degree 2^20 is too large. */
static int32_t sane_exp(PolyRing *r, int64_t e) {
  const int64_t limit = 1 << 20;
  if (e > limit || e < -limit) {
    poly_fail(r, POLY_TOO_LARGE);
    return 0;
  }
  return (int32_t)e;
}

MonoId mono_mul(PolyRing *r, MonoId a, MonoId b) {
  if (a == 0) return b;
  if (b == 0) return a;
  const Mono *x = &r->monos.at[a], *y = &r->monos.at[b];
  uint32_t i = 0, k = 0;
  r->scratch.n = 0;
  while (i < x->n || k < y->n) {
    MonoPow p;
    if (k == y->n || (i < x->n && x->at[i].gen < y->at[k].gen)) {
      p = x->at[i++];
    } else if (i == x->n || y->at[k].gen < x->at[i].gen) {
      p = y->at[k++];
    } else {
      p.gen = x->at[i].gen;
      p.exp = sane_exp(r, (int64_t)x->at[i++].exp + y->at[k++].exp);
      if (!p.exp) continue;
    }
    vec_push(r->arena, &r->scratch, p);
  }
  return mono_intern(r, r->scratch.at, r->scratch.n);
}

MonoId mono_pow(PolyRing *r, MonoId a, int32_t n) {
  if (n == 1) return a;
  const Mono *x = &r->monos.at[a];
  r->scratch.n = 0;
  for (uint32_t i = 0; i < x->n && n; i++) {
    MonoPow p = {.gen = x->at[i].gen, .exp = sane_exp(r, (int64_t)x->at[i].exp * n)};
    if (p.exp) vec_push(r->arena, &r->scratch, p);
  }
  return mono_intern(r, r->scratch.at, r->scratch.n);
}

int32_t mono_exp(const PolyRing *r, MonoId m, GenId x) {
  const Mono *mono = &r->monos.at[m];
  for (uint32_t i = 0; i < mono->n; i++)
    if (mono->at[i].gen == x) return mono->at[i].exp;
  return 0;
}

MonoId mono_without(PolyRing *r, MonoId m, GenId x) {
  const Mono *mono = &r->monos.at[m];
  r->scratch.n = 0;
  for (uint32_t i = 0; i < mono->n; i++)
    if (mono->at[i].gen != x) vec_push(r->arena, &r->scratch, mono->at[i]);
  return mono_intern(r, r->scratch.at, r->scratch.n);
}

/* --- the accumulator --- */

static void accumulate(PolyRing *r, MonoId m, Num c) {
  if (m >= r->slot_cap) {
    uint32_t cap = r->slot_cap ? r->slot_cap : 256;
    while (cap <= m) cap *= 2;
    uint32_t *bigger = ARENA_ARRAY(r->arena, uint32_t, cap);
    if (r->slot_cap) memcpy(bigger, r->slot, r->slot_cap * sizeof *bigger);
    r->slot = bigger;
    r->slot_cap = cap;
  }
  uint32_t s = r->slot[m];
  if (s) {
    r->sum.at[s - 1].c = add(r, r->sum.at[s - 1].c, c);
  } else {
    vec_push(r->arena, &r->sum, ((Term){.mono = m, .c = c}));
    r->slot[m] = r->sum.n;
  }
}

static int by_mono(const void *a, const void *b) {
  MonoId x = ((const Term *)a)->mono, y = ((const Term *)b)->mono;
  return (x > y) - (x < y);
}

/* Empties the accumulator into fresh memory, without zeros, in no order. */
static Poly drain(PolyRing *r) {
  uint32_t n = 0;
  for (uint32_t i = 0; i < r->sum.n; i++) {
    r->slot[r->sum.at[i].mono] = 0;
    if (!num_is_zero(r->sum.at[i].c)) r->sum.at[n++] = r->sum.at[i];
  }
  r->sum.n = 0;
  if (n > r->max_terms) poly_fail(r, POLY_TOO_LARGE);
  if (r->status != POLY_OK || n == 0) return poly_zero();
  Term *at = ARENA_ARRAY(r->arena, Term, n);
  memcpy(at, r->sum.at, n * sizeof *at);
  return (Poly){.at = at, .n = n};
}

/* Applies x^k -> R once to a term whose monomial is reducible. */
static void reduce_term(PolyRing *r, Term t) {
  GenId x = mono_at(r, t.mono)->reducible;
  PolyGen gen = r->gens.at[x];
  MonoPow lower = {.gen = x, .exp = -gen.degree};
  MonoId inverse = mono_of(r, &lower, 1);
  MonoId rest = mono_mul(r, t.mono, inverse);
  if (!spend(r, gen.relation.n)) return;
  for (uint32_t i = 0; i < gen.relation.n; i++) {
    MonoId m = mono_mul(r, rest, gen.relation.at[i].mono);
    accumulate(r, m, mul(r, t.c, gen.relation.at[i].c));
  }
}

static int any_reducible(const PolyRing *r) {
  for (uint32_t i = 0; i < r->sum.n; i++)
    if (mono_at(r, r->sum.at[i].mono)->reducible != GEN_NONE && !num_is_zero(r->sum.at[i].c)) return 1;
  return 0;
}

/* The accumulated sum in normal form. */
static Poly finish(PolyRing *r) {
  while (r->status == POLY_OK && any_reducible(r)) {
    Poly before = drain(r);
    for (uint32_t i = 0; i < before.n; i++) {
      Term t = before.at[i];
      if (mono_at(r, t.mono)->reducible == GEN_NONE) accumulate(r, t.mono, t.c);
      else reduce_term(r, t);
    }
    if (before.n) arena_recycle(r->arena, (void *)(uintptr_t)before.at, before.n * sizeof *before.at);
  }
  Poly p = drain(r);
  if (p.n > 1) qsort((void *)(uintptr_t)p.at, p.n, sizeof *p.at, by_mono);
  return p;
}

/* --- polynomials --- */

Poly poly_zero(void) { return (Poly){0}; }

Poly poly_mono(PolyRing *r, Num c, MonoId m) {
  accumulate(r, m, c);
  demand_exact(r, c);
  return finish(r);
}

Poly poly_num(PolyRing *r, Num c) { return poly_mono(r, c, 0); }

Poly poly_gen(PolyRing *r, GenId x) {
  MonoPow p = {.gen = x, .exp = 1};
  MonoId m = mono_of(r, &p, 1);
  return poly_mono(r, num_int(1), m);
}

Poly poly_sum(PolyRing *r, const Poly *p, const Num *c, uint32_t n) {
  for (uint32_t i = 0; i < n; i++) {
    if (!spend(r, p[i].n)) break;
    for (uint32_t k = 0; k < p[i].n; k++)
      accumulate(r, p[i].at[k].mono, c ? mul(r, p[i].at[k].c, c[i]) : p[i].at[k].c);
  }
  return finish(r);
}

Poly poly_add(PolyRing *r, Poly a, Poly b) {
  if (a.n == 0) return b;
  if (b.n == 0) return a;
  Poly both[2] = {a, b};
  return poly_sum(r, both, NULL, 2);
}

Poly poly_sub(PolyRing *r, Poly a, Poly b) {
  Poly both[2] = {a, b};
  Num signs[2] = {num_int(1), num_int(-1)};
  return poly_sum(r, both, signs, 2);
}

Poly poly_scale(PolyRing *r, Num c, Poly a) { return poly_sum(r, &a, &c, 1); }

Poly poly_mul_mono(PolyRing *r, Poly a, Num c, MonoId m) {
  if (!spend(r, a.n)) return poly_zero();
  for (uint32_t i = 0; i < a.n; i++) {
    MonoId product = mono_mul(r, a.at[i].mono, m);
    accumulate(r, product, mul(r, a.at[i].c, c));
  }
  return finish(r);
}

Poly poly_mul(PolyRing *r, Poly a, Poly b) {
  if (poly_is_one(a)) return b;
  if (poly_is_one(b)) return a;
  for (uint32_t i = 0; i < a.n; i++) {
    if (!spend(r, b.n) || r->sum.n > 4 * r->max_terms) break;
    for (uint32_t k = 0; k < b.n; k++) {
      MonoId m = mono_mul(r, a.at[i].mono, b.at[k].mono);
      accumulate(r, m, mul(r, a.at[i].c, b.at[k].c));
    }
  }
  if (r->sum.n > 4 * r->max_terms) poly_fail(r, POLY_TOO_LARGE);
  return finish(r);
}

Poly poly_pow(PolyRing *r, Poly a, uint32_t n) {
  Poly power = poly_num(r, num_int(1));
  while (n && r->status == POLY_OK) {
    if (n & 1) power = poly_mul(r, power, a);
    n >>= 1;
    if (n) a = poly_mul(r, a, a);
  }
  return power;
}

int poly_equal(Poly a, Poly b) {
  if (a.n != b.n) return 0;
  for (uint32_t i = 0; i < a.n; i++)
    if (a.at[i].mono != b.at[i].mono || !num_equal(a.at[i].c, b.at[i].c)) return 0;
  return 1;
}

int poly_is_one(Poly a) { return a.n == 1 && a.at[0].mono == 0 && num_is_one(a.at[0].c); }

/* --- parts --- */

Num poly_content(PolyRing *r, Poly a) {
  Num c = num_abs(a.at[0].c);
  for (uint32_t i = 1; i < a.n && !num_is_one(c); i++) c = num_gcd(c, a.at[i].c);
  demand_exact(r, c);
  return num_sign(a.at[0].c) < 0 ? num_neg(c) : c;
}

/* Monomial with the smaller exponent of each generator; a generator absent from one has exponent 0 there. */
static MonoId mono_min(PolyRing *r, MonoId a, MonoId b) {
  const Mono *x = mono_at(r, a), *y = mono_at(r, b);
  uint32_t i = 0, k = 0;
  r->scratch.n = 0;
  while (i < x->n || k < y->n) {
    MonoPow p;
    if (k == y->n || (i < x->n && x->at[i].gen < y->at[k].gen)) {
      p = x->at[i++];
      if (p.exp > 0) continue;
    } else if (i == x->n || y->at[k].gen < x->at[i].gen) {
      p = y->at[k++];
      if (p.exp > 0) continue;
    } else {
      p = x->at[i].exp < y->at[k].exp ? x->at[i] : y->at[k];
      i++;
      k++;
    }
    vec_push(r->arena, &r->scratch, p);
  }
  return mono_intern(r, r->scratch.at, r->scratch.n);
}

MonoId poly_common_monomial(PolyRing *r, Poly a) {
  MonoId m = a.at[0].mono;
  for (uint32_t i = 1; i < a.n; i++) m = mono_min(r, m, a.at[i].mono);
  return m;
}

Poly poly_primitive(PolyRing *r, Poly a, Num *content, MonoId *common) {
  *content = poly_content(r, a);
  *common = poly_common_monomial(r, a);
  if (r->status != POLY_OK) return poly_zero();
  if (num_is_one(*content) && *common == 0) return a;
  MonoId inverse = mono_pow(r, *common, -1);
  Num unit = num_div(num_int(1), *content);
  Poly p = poly_mul_mono(r, a, unit, inverse);
  if (p.n == 0 || num_sign(p.at[0].c) > 0) return p;
  *content = num_neg(*content); /* dividing has changed which term is the first */
  return poly_scale(r, num_int(-1), p);
}

Poly poly_collect(PolyRing *r, const Term *terms, uint32_t n) {
  for (uint32_t i = 0; i < n; i++) accumulate(r, terms[i].mono, terms[i].c);
  return finish(r);
}

/* --- exact division --- */

/* Lexicographic order of monomials with exponents >= 0: admissible, as division needs. */
static int mono_cmp(const PolyRing *r, MonoId a, MonoId b) {
  const Mono *x = mono_at(r, a), *y = mono_at(r, b);
  for (uint32_t i = 0;; i++) {
    if (i == x->n || i == y->n) return (x->n > i) - (y->n > i);
    if (x->at[i].gen != y->at[i].gen) return x->at[i].gen < y->at[i].gen ? 1 : -1;
    if (x->at[i].exp != y->at[i].exp) return x->at[i].exp > y->at[i].exp ? 1 : -1;
  }
}

static Term leading(const PolyRing *r, Poly a) {
  Term best = a.at[0];
  for (uint32_t i = 1; i < a.n; i++)
    if (mono_cmp(r, a.at[i].mono, best.mono) > 0) best = a.at[i];
  return best;
}

/* a/b when all exponents of the result are >= 0. */
static int mono_div(PolyRing *r, MonoId a, MonoId b, MonoId *q) {
  MonoId inverse = mono_pow(r, b, -1);
  *q = mono_mul(r, a, inverse);
  const Mono *m = mono_at(r, *q);
  for (uint32_t i = 0; i < m->n; i++)
    if (m->at[i].exp < 0) return 0;
  return 1;
}

static int has_relation(const PolyRing *r, Poly a) {
  for (uint32_t i = 0; i < a.n; i++) {
    const Mono *m = mono_at(r, a.at[i].mono);
    for (uint32_t k = 0; k < m->n; k++)
      if (r->gens.at[m->at[k].gen].degree) return 1;
  }
  return 0;
}

int poly_div_exact(PolyRing *r, Poly a, Poly b, Poly *q) {
  *q = poly_zero();
  if (r->status != POLY_OK || b.n == 0 || has_relation(r, b)) return 0;
  if (a.n == 0) return 1;
  Num ca, cb;
  MonoId ma, mb;
  Poly rest = poly_primitive(r, a, &ca, &ma), divisor = poly_primitive(r, b, &cb, &mb);
  if (r->status != POLY_OK) return 0; /* rest and divisor are empty */
  Poly quotient = poly_zero();
  Term lead = leading(r, divisor);
  while (rest.n && r->status == POLY_OK) {
    Term top = leading(r, rest);
    MonoId m;
    if (!mono_div(r, top.mono, lead.mono, &m) || !spend(r, rest.n)) return 0;
    Num c = num_div(top.c, lead.c);
    Poly term = poly_mono(r, c, m), part = poly_mul_mono(r, divisor, c, m);
    quotient = poly_add(r, quotient, term);
    rest = poly_sub(r, rest, part);
  }
  MonoId inverse = mono_pow(r, mb, -1);
  MonoId m = mono_mul(r, ma, inverse);
  *q = poly_mul_mono(r, quotient, num_div(ca, cb), m);
  return r->status == POLY_OK;
}

/* --- interning --- */

PolyId poly_intern(PolyRing *r, Poly a) {
  uint32_t hash = a.n;
  for (uint32_t i = 0; i < a.n; i++) {
    hash = hash_mix(hash, a.at[i].mono);
    hash = hash_mix(hash, (uint32_t)a.at[i].c.num);
    hash = hash_mix(hash, (uint32_t)a.at[i].c.den);
  }
  uint32_t slot = idtable_start(&r->poly_table, hash), id;
  while (idtable_next(&r->poly_table, hash, &slot, &id))
    if (poly_equal(r->polys.at[id], a)) return id;
  vec_push(r->arena, &r->polys, a);
  idtable_add(&r->poly_table, hash, r->polys.n - 1);
  return r->polys.n - 1;
}
