/* Expansion of logarithms and powers of products, for proofs: log(a*b) = log(a) + log(b) and (a*b)^u = a^u*b^u for
 * factors that are known to be positive. */
#include "sym/normal_form_impl.h"

enum { MAX_FACTORS = 200 };

typedef struct {
  Poly base;
  int32_t e;
} Odd;

typedef struct {
  Normal *n;
  VEC(Odd) odd;  /* factors of unknown sign, to odd powers */
  Frac exponent; /* exponent of the product being split */
  PowerParts *out;
  PowerParts todo;
} Splitter;

static Frac whole(Normal *n, Num c) { return frac_num(n->field, c); }

static void queue_power(Splitter *s, Frac base, Num power) {
  Normal *n = s->n;
  if (num_is_zero(power)) return;
  Frac exponent = frac_mul(n->field, s->exponent, whole(n, power));
  vec_push(n->arena, &s->todo, ((PowerPart){base, exponent, 0}));
}

/* Splits m^sign into primes by trial division up to 1000; the cofactor counts as a prime. */
static void split_number(Splitter *s, int64_t m, int sign) {
  Normal *n = s->n;
  for (int64_t p = 2; m > 1; p++) {
    int64_t e = 0;
    if (p > 1000) p = m;
    for (; m % p == 0; m /= p) e++;
    if (e)
      vec_push(n->arena, s->out,
               ((PowerPart){whole(n, num_int(p)), frac_mul(n->field, s->exponent, whole(n, num_int(sign * e))), 0}));
  }
}

static void add_power(Splitter *s, Poly base, int32_t e) {
  Normal *n = s->n;
  vec_push(n->arena, s->out, ((PowerPart){frac_poly(base), frac_mul(n->field, s->exponent, whole(n, num_int(e))), 0}));
}

/* A factor x of unknown sign to the power e: for even e a power of x^2, which is positive; odd powers are collected
 * in s->odd. */
static void add_unknown_sign(Splitter *s, Poly x, int32_t e) {
  if (e % 2 != 0) vec_push(s->n->arena, &s->odd, ((Odd){x, e}));
  else add_power(s, poly_mul(s->n->ring, x, x), e / 2);
}

/* Adds the odd powers. Their product has the sign `sign`, or the exponent is an integer: a single factor thus has a
 * known sign; of several, the product and the squares of the factors are parts. */
static void add_odd_powers(Splitter *s, int sign) {
  PolyRing *r = s->n->ring;
  Poly rest = poly_num(r, num_int(sign));
  for (uint32_t i = 0; i < s->odd.n; i++) rest = poly_mul(r, rest, s->odd.at[i].base);
  if (s->odd.n == 1) add_power(s, rest, s->odd.at[0].e);
  else if (s->odd.n || sign < 0) add_power(s, rest, 1);
  for (uint32_t i = 0; i < s->odd.n && s->odd.n > 1; i++)
    if (s->odd.at[i].e != 1) add_power(s, poly_mul(r, s->odd.at[i].base, s->odd.at[i].base), (s->odd.at[i].e - 1) / 2);
  s->odd.n = 0;
}

/* Splits a positive generator: e^u, b^u, a root; any other generator is a part itself. */
static void split_generator(Splitter *s, GenId x, int32_t e) {
  Normal *n = s->n;
  GenInfo info = n->gens.at[x];
  if (info.kind == GEN_POWER) {
    Atom a = n->atoms.at[info.atom];
    Frac u = {.num = poly_scale(n->ring, num_mul(a.unit, num_int(e)), poly_at(n->ring, a.part)), .den = a.den};
    Frac exponent = frac_mul(n->field, s->exponent, u), base = {.num = poly_at(n->ring, a.base_num), .den = a.base_den};
    vec_push(n->arena, a.base_num ? &s->todo : s->out, ((PowerPart){base, exponent, a.base_num == 0}));
  } else if (info.kind == GEN_ROOT) {
    PolyGen root = n->ring->gens.at[x];
    queue_power(s, frac_poly(root.relation), num_ratio(e, root.degree));
  } else {
    Frac exponent = frac_mul(n->field, s->exponent, whole(n, num_int(e)));
    vec_push(n->arena, s->out, ((PowerPart){frac_poly(poly_gen(n->ring, x)), exponent, 0}));
  }
}

static void split(Splitter *s, Frac u) {
  Normal *n = s->n;
  PolyRing *r = n->ring;
  Num content;
  MonoId common;
  Poly rest = poly_primitive(r, u.num, &content, &common);
  if (r->status != POLY_OK) return;
  if (!num_is_exact(content)) {
    vec_push(n->arena, s->out, ((PowerPart){u, s->exponent, 0}));
    return;
  }
  split_number(s, num_abs(content).num, 1);
  split_number(s, content.den, -1);
  Mono mono = *mono_at(r, common);
  for (uint32_t i = 0; i < mono.n; i++) {
    GenId x = mono.at[i].gen;
    if (normal_gen_positive(n, x)) split_generator(s, x, mono.at[i].exp);
    else add_unknown_sign(s, poly_gen(r, x), mono.at[i].exp);
  }
  Den d = frac_den(n->field, u.den);
  for (uint32_t i = 0; i < d.n; i++) {
    Poly factor = poly_at(r, d.at[i].factor);
    if (normal_poly_positive(n, factor)) add_power(s, factor, -(int32_t)d.at[i].exp);
    else add_unknown_sign(s, factor, -(int32_t)d.at[i].exp);
  }
  if (!poly_is_one(rest) && normal_poly_positive(n, rest)) add_power(s, rest, 1);
  else if (!poly_is_one(rest)) add_unknown_sign(s, rest, 1);
  add_odd_powers(s, num_sign(content));
}

PowerParts normal_power_parts(Normal *n, Frac base, Frac exponent) {
  PowerParts out = {0};
  Splitter s = {.n = n, .out = &out};
  vec_push(n->arena, &s.todo, ((PowerPart){base, exponent, 0}));
  while (s.todo.n && n->ring->status == POLY_OK) {
    PowerPart one = s.todo.at[--s.todo.n];
    s.exponent = one.exponent;
    if (one.base.num.n == 0) poly_fail(n->ring, POLY_DIVIDED_BY_ZERO);
    else split(&s, one.base);
    if (out.n > MAX_FACTORS) poly_fail(n->ring, POLY_TOO_LARGE);
  }
  return out;
}

Frac normal_log(Normal *n, Frac u) {
  PowerParts parts = normal_power_parts(n, u, whole(n, num_int(1)));
  Frac sum = frac_poly(poly_zero());
  for (uint32_t i = 0; i < parts.n && n->ring->status == POLY_OK; i++) {
    PowerPart part = parts.at[i];
    Frac term = part.exponent;
    if (!part.is_e) term = frac_mul(n->field, term, normal_opaque_log(n, part.base));
    sum = frac_add(n->field, sum, term);
  }
  return sum;
}
