/* Sines, cosines, exponentials and powers of sums in normal form: the addition theorems over base angles.
 * Enters: an argument as a fraction. Leaves: a fraction in the generators sin, cos and exp of base angles. */
#include <stdlib.h>

#include "sym/normal_form_impl.h"

enum { MAX_MULTIPLE = 64 }; /* largest multiple of a base angle: cos 64u has 33 terms */

/* --- atoms --- */

/* The atom of base^(part/den), made if absent; GEN_NONE as base_num marks an angle. Atoms are few: linear search. */
static uint32_t find_atom(Normal *n, PolyId base_num, DenId base_den, PolyId part, DenId den) {
  for (uint32_t i = 0; i < n->atoms.n; i++) {
    const Atom *a = &n->atoms.at[i];
    if (a->part == part && a->den == den && a->base_num == base_num && a->base_den == base_den) return i;
  }
  Atom fresh = {.base_num = base_num, .base_den = base_den, .part = part, .den = den, .unit = num_int(0)};
  vec_push(n->arena, &n->atoms, fresh);
  return n->atoms.n - 1;
}

/* Whether part is a product of symbols. Exponentials of linearly independent products of symbols are algebraically
 * independent of each other and of the symbols (Ax, On Schanuel's conjectures, 1971, DOI 10.2307/1970774). */
static int is_plain(const Normal *n, PolyId part) {
  Poly p = poly_at(n->ring, part);
  const Mono *mono = p.n == 1 ? mono_at(n->ring, p.at[0].mono) : NULL; /* p.n 0: the ring has failed */
  if (!mono || mono->n == 0) return 0;
  for (uint32_t i = 0; i < mono->n; i++)
    if (n->gens.at[mono->at[i].gen].kind != GEN_SYMBOL) return 0;
  return 1;
}

static PolyId mono_part(Normal *n, MonoId m) { return poly_intern(n->ring, poly_mono(n->ring, num_int(1), m)); }

/* The expression unit * part / den. */
static Expr atom_expr(Normal *n, const Atom *a) {
  Poly part = poly_scale(n->ring, a->unit, poly_at(n->ring, a->part));
  return normal_expr(n, (Frac){.num = part, .den = a->den});
}

static void make_angle(Normal *n, uint32_t at, Expr u) {
  Atom *a = &n->atoms.at[at];
  PolyRing *r = n->ring;
  Expr cos_u = expr_fn(n->g, EX_COS, u), sin_u = expr_fn(n->g, EX_SIN, u);
  a->u = u;
  a->cos = poly_new_gen(r);
  Poly c = poly_gen(r, a->cos), one = poly_num(r, num_int(1));
  Poly cc = poly_mul(r, c, c);
  a->sin = poly_new_root(r, 2, poly_sub(r, one, cc));
  frac_register_root(n->field, a->sin);
  normal_set_gen_info(n, a->cos, (GenInfo){.kind = GEN_COS, .expr = cos_u, .atom = at});
  normal_set_gen_info(n, a->sin, (GenInfo){.kind = GEN_SIN, .expr = sin_u, .atom = at});
}

static void make_power(Normal *n, uint32_t at) {
  Atom *a = &n->atoms.at[at];
  Expr u = atom_expr(n, a), e;
  if (a->base_num == 0) {
    e = expr_fn(n->g, EX_EXP, u);
  } else {
    Frac base = {.num = poly_at(n->ring, a->base_num), .den = a->base_den};
    Expr b = normal_expr(n, base);
    e = expr_pow(n->g, b, u);
  }
  a->cos = poly_new_gen(n->ring);
  normal_set_gen_info(n, a->cos, (GenInfo){.kind = GEN_POWER, .expr = e, .atom = at});
}

/* c as a multiple of its atom's unit. A coefficient that needs a finer unit makes new generators and restarts the
 * normal form. */
static int32_t multiple_of(Normal *n, uint32_t at, Num c) {
  Atom *a = &n->atoms.at[at];
  Num unit = num_gcd(a->unit, c);
  if (!num_is_exact(unit) || num_is_zero(unit)) {
    poly_fail(n->ring, POLY_INEXACT);
    return 0;
  }
  if (!num_equal(unit, a->unit)) {
    n->restart |= a->made;
    a->made = 0;
    a->unit = unit;
  }
  if (!a->made) {
    a->made = 1;
    if (a->base_num == GEN_NONE) make_angle(n, at, atom_expr(n, a));
    else make_power(n, at);
    a = &n->atoms.at[at];
  }
  if (a->den || !is_plain(n, a->part)) n->canonical = 0;
  Num k = num_div(c, a->unit);
  if (num_cmp(num_abs(k), num_int(1 << 20)) > 0) poly_fail(n->ring, POLY_TOO_LARGE);
  return (int32_t)k.num;
}

/* --- circular functions --- */

static Circular add_angles(Normal *n, Circular a, Circular b) {
  FracField *f = n->field;
  Frac cc = frac_mul(f, a.cos, b.cos), ss = frac_mul(f, a.sin, b.sin);
  Frac sc = frac_mul(f, a.sin, b.cos), cs = frac_mul(f, a.cos, b.sin);
  Frac cos = frac_sub(f, cc, ss), sin = frac_add(f, sc, cs);
  return (Circular){.cos = cos, .sin = sin};
}

static Circular zero_angle(Normal *n) {
  return (Circular){.cos = frac_num(n->field, num_int(1)), .sin = frac_poly(poly_zero())};
}

Circular normal_multiple(Normal *n, uint32_t at, int32_t k) {
  Atom a = n->atoms.at[at];
  Circular one = {.cos = frac_poly(poly_gen(n->ring, a.cos)), .sin = frac_poly(poly_gen(n->ring, a.sin))};
  Circular sum = zero_angle(n);
  if (abs(k) > MAX_MULTIPLE) poly_fail(n->ring, POLY_TOO_LARGE);
  for (int32_t i = 0; i < abs(k) && n->ring->status == POLY_OK; i++) sum = add_angles(n, sum, one);
  if (k < 0) sum.sin = frac_neg(n->field, sum.sin);
  return sum;
}

uint32_t normal_new_angle(Normal *n, Expr u) {
  Atom fresh = {.base_num = GEN_NONE, .part = GEN_NONE, .unit = num_int(1), .made = 1};
  vec_push(n->arena, &n->atoms, fresh);
  make_angle(n, n->atoms.n - 1, u);
  return n->atoms.n - 1;
}

static int is_pi(const Normal *n, MonoId m, DenId den) {
  const Mono *mono = mono_at(n->ring, m);
  if (den || mono->n != 1 || mono->at[0].exp != 1) return 0;
  GenInfo info = n->gens.at[mono->at[0].gen];
  return info.kind == GEN_SYMBOL && strcmp(expr_sym_of(n->g, info.expr)->name, "pi") == 0;
}

/* cos(j pi/12) = +-sqrt(m)/2, m = 0 .. 4, for j = 0, 2, 3, 4, 6 and their reflections; other j do not occur. */
static Frac cos_twelfths(Normal *n, int64_t j) {
  j = ((j % 24) + 24) % 24;
  if (j > 12) j = 24 - j;
  int negative = j > 6;
  if (negative) j = 12 - j;
  int64_t four_cos2 = j == 0 ? 4 : j == 2 ? 3 : j == 3 ? 2 : j == 4 ? 1 : 0;
  Frac square = frac_num(n->field, num_ratio(four_cos2, 4));
  Frac c = normal_pow_num(n, square, num_ratio(1, 2));
  return negative ? frac_neg(n->field, c) : c;
}

/* cos and sin of c*pi as square roots of rationals; returns 0 where they are not. */
static int pi_angle(Normal *n, Num c, Circular *cs) {
  if (c.den > 6 || c.den == 5) return 0;
  int64_t twelfths = c.num % (2 * c.den) * (12 / c.den);
  cs->cos = cos_twelfths(n, twelfths);
  cs->sin = cos_twelfths(n, 6 - twelfths);
  return 1;
}

/* cos and sin of asin(u), acos(u) or atan(u). */
static Circular circular_of_inverse(Normal *n, ExprOp op, Frac u) {
  Num half = num_ratio(1, 2);
  Frac one = frac_num(n->field, num_int(1)), square = frac_mul(n->field, u, u);
  if (op == EX_ATAN) {
    Frac size = normal_pow_num(n, frac_add(n->field, one, square), num_neg(half));
    return (Circular){.cos = size, .sin = frac_mul(n->field, u, size)};
  }
  Frac other = normal_pow_num(n, frac_sub(n->field, one, square), half);
  return op == EX_ASIN ? (Circular){.cos = other, .sin = u} : (Circular){.cos = u, .sin = other};
}

/* *cs := cos and sin of a multiple of an inverse function; 0: t/den is none. For proofs, as inverses have domains. */
static int inverse_angle(Normal *n, Term t, DenId den, Circular *cs) {
  enum { MOST = 12 };
  const Mono *mono = mono_at(n->ring, t.mono);
  if (!n->proof || den || mono->n != 1 || mono->at[0].exp != 1 || t.c.den != 1 || t.c.num > MOST || t.c.num < -MOST)
    return 0;
  GenInfo info = n->gens.at[mono->at[0].gen];
  if (info.kind != GEN_OPAQUE || (info.op != EX_ASIN && info.op != EX_ACOS && info.op != EX_ATAN)) return 0;
  Circular one = circular_of_inverse(n, info.op, info.arg);
  if (t.c.num < 0) one.sin = frac_neg(n->field, one.sin);
  *cs = zero_angle(n);
  for (int64_t k = t.c.num; k != 0; k += k < 0 ? 1 : -1) *cs = add_angles(n, *cs, one);
  return 1;
}

static Circular circular_of(Normal *n, Frac u) {
  Circular sum = zero_angle(n);
  for (uint32_t i = 0; i < u.num.n && n->ring->status == POLY_OK; i++) {
    Term t = u.num.at[i];
    Circular one;
    int pi = is_pi(n, t.mono, u.den);
    if ((!pi || !pi_angle(n, t.c, &one)) && !inverse_angle(n, t, u.den, &one)) {
      uint32_t at = find_atom(n, GEN_NONE, 0, mono_part(n, t.mono), u.den);
      int32_t k = multiple_of(n, at, t.c);
      if (pi) n->canonical = 0;
      one = normal_multiple(n, at, k);
    }
    sum = add_angles(n, sum, one);
  }
  return sum;
}

Circular normal_circular(Normal *n, Expr arg, Frac u) {
  uint32_t known = expr_map_get(&n->circular_index, arg);
  if (known) return n->circular.at[known];
  Circular cs = circular_of(n, u);
  vec_push(n->arena, &n->circular, cs);
  expr_map_set(&n->circular_index, arg, n->circular.n - 1);
  return cs;
}

/* --- powers --- */

/* The generator log(b) in a monomial to the first power, or GEN_NONE. */
static GenId find_log(const Normal *n, MonoId m) {
  const Mono *mono = mono_at(n->ring, m);
  for (uint32_t i = 0; i < mono->n; i++) {
    GenInfo info = n->gens.at[mono->at[i].gen];
    if (info.kind == GEN_OPAQUE && info.op == EX_LOG && mono->at[i].exp == 1) return mono->at[i].gen;
  }
  return GEN_NONE;
}

static int contains_log(const Normal *n, Poly p) {
  for (uint32_t i = 0; i < p.n; i++)
    if (find_log(n, p.at[i].mono) != GEN_NONE) return 1;
  return 0;
}

static Frac atom_power(Normal *n, uint32_t at, Num c) {
  int32_t k = multiple_of(n, at, c);
  MonoPow p = {.gen = n->atoms.at[at].cos, .exp = k};
  MonoId m = mono_of(n->ring, &p, 1);
  return frac_poly(poly_mono(n->ring, num_int(1), m));
}

/* b^(c*mono/den), where b is e when base_num is 0. exp(u*log(b)) is b^u. */
static Frac power_term(Normal *n, PolyId base_num, DenId base_den, Term t, DenId den) {
  GenId log = base_num == 0 ? find_log(n, t.mono) : GEN_NONE;
  if (log != GEN_NONE) {
    Frac b = n->gens.at[log].arg;
    base_num = poly_intern(n->ring, b.num);
    base_den = b.den;
    t.mono = mono_without(n->ring, t.mono, log);
  }
  if (base_num != 0 && t.mono == 0 && den == 0) {
    Frac base = {.num = poly_at(n->ring, base_num), .den = base_den};
    return normal_pow_num(n, base, t.c);
  }
  return atom_power(n, find_atom(n, base_num, base_den, mono_part(n, t.mono), den), t.c);
}

static Frac power_of(Normal *n, PolyId base_num, DenId base_den, Frac u) {
  Frac product = frac_num(n->field, num_int(1));
  for (uint32_t i = 0; i < u.num.n && n->ring->status == POLY_OK; i++) {
    Frac one = power_term(n, base_num, base_den, u.num.at[i], u.den);
    product = frac_mul(n->field, product, one);
  }
  return product;
}

/* b^u as one power of b^(u/k) or b^(-u/k), whichever atom exists: exp(x - y) is 1 at x = y = 1000, where
 * exp(x)*exp(-y) is NaN. */
static Frac whole_power(Normal *n, PolyId base_num, DenId base_den, Frac u) {
  PolyRing *r = n->ring;
  Num content = num_abs(poly_content(r, u.num)), inverse = num_div(num_int(1), content);
  PolyId part = poly_intern(r, poly_scale(r, inverse, u.num)),
         turned = poly_intern(r, poly_scale(r, num_neg(inverse), u.num));
  int known = 0;
  for (uint32_t i = 0; i < n->atoms.n; i++) {
    const Atom *a = &n->atoms.at[i];
    known |= a->part == turned && a->den == u.den && a->base_num == base_num && a->base_den == base_den;
  }
  uint32_t at = find_atom(n, base_num, base_den, known ? turned : part, u.den);
  return atom_power(n, at, known ? num_neg(content) : content);
}

Frac normal_exp(Normal *n, Frac u) {
  int whole = n->keep_range && u.num.n && !contains_log(n, u.num);
  return whole ? whole_power(n, 0, 0, u) : power_of(n, 0, 0, u);
}

static int is_constant(Frac u) { return u.num.n == 0 || (u.num.n == 1 && u.num.at[0].mono == 0 && u.den == 0); }

Frac normal_power(Normal *n, Frac base, Frac u) {
  PolyId id = poly_intern(n->ring, base.num);
  if (id == 0) poly_fail(n->ring, POLY_DIVIDED_BY_ZERO); /* 0^u depends on the sign of u */
  n->canonical = 0; /* x^u and y^u and (x*y)^u are related */
  if (!n->proof)
    return n->keep_range && !is_constant(u) ? whole_power(n, id, base.den, u) : power_of(n, id, base.den, u);
  PowerParts parts = normal_power_parts(n, base, u);
  Frac product = frac_num(n->field, num_int(1));
  for (uint32_t i = 0; i < parts.n && n->ring->status == POLY_OK; i++) {
    PowerPart p = parts.at[i];
    Frac one = power_of(n, p.is_e ? 0 : poly_intern(n->ring, p.base.num), p.is_e ? 0 : p.base.den, p.exponent);
    product = frac_mul(n->field, product, one);
  }
  return product;
}
