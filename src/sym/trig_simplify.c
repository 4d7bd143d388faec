/* Candidate forms of a trigonometric polynomial: powers of sines and cosines, or its Fourier spectrum by directions;
 * the shortest wins. */
#include "sym/trig_simplify.h"

#include <stdlib.h>

typedef VEC(uint32_t) Angles;

static void push_term(Normal *n, TrigForm *f, uint32_t *cap, Num c, Expr e) {
  f->at = vec_grow(n->arena, f->at, f->n, cap, sizeof *f->at);
  f->at[f->n++] = (TrigTerm){.c = c, .e = e};
}

/* The angles whose generators occur in p, ascending. */
static Angles angles_of(Normal *n, Poly p) {
  Angles list = {0};
  uint8_t *seen = ARENA_ARRAY(n->arena, uint8_t, n->atoms.n + 1);
  for (uint32_t i = 0; i < p.n; i++) {
    const Mono *m = mono_at(n->ring, p.at[i].mono);
    for (uint32_t k = 0; k < m->n; k++) seen[n->gens.at[m->at[k].gen].atom] = 1;
  }
  for (uint32_t a = 0; a < n->atoms.n; a++)
    if (seen[a]) vec_push(n->arena, &list, a);
  return list;
}

/* --- powers of sines and cosines --- */

/* Splits p = A + s*B by the sine s of an angle. */
static void split_sine(Normal *n, Poly p, GenId s, Poly *A, Poly *B) {
  Term *even = ARENA_ARRAY(n->arena, Term, p.n + 1), *odd = ARENA_ARRAY(n->arena, Term, p.n + 1);
  uint32_t evens = 0, odds = 0;
  for (uint32_t i = 0; i < p.n; i++) {
    Term t = p.at[i];
    if (!mono_exp(n->ring, t.mono, s)) {
      even[evens++] = t;
      continue;
    }
    t.mono = mono_without(n->ring, t.mono, s);
    odd[odds++] = t;
  }
  *A = poly_collect(n->ring, even, evens);
  *B = poly_collect(n->ring, odd, odds);
}

/* Exact quotient *q = p/s for s = sin u; returns 0 unless A of p = A + s*B is a multiple of s^2 = 1 - c^2. */
static int divide_by_sine(Normal *n, Poly p, uint32_t angle, Poly *q) {
  PolyRing *r = n->ring;
  GenId s = n->atoms.at[angle].sin;
  Poly A, B, over;
  split_sine(n, p, s, &A, &B);
  if (!poly_div_exact(r, A, r->gens.at[s].relation, &over)) return 0;
  Poly sine = poly_gen(r, s);
  Poly rest = poly_mul(r, sine, over);
  *q = poly_add(r, B, rest);
  return r->status == POLY_OK;
}

/* Takes common factors c^i s^j of all angles out of *p; returns their product. */
static Expr take_common(Normal *n, Poly *p) {
  Num content;
  MonoId common;
  Poly plain = poly_primitive(n->ring, *p, &content, &common);
  *p = poly_scale(n->ring, content, plain);
  Expr factor = normal_mono_expr(n, common);
  Angles angles = angles_of(n, *p);
  for (uint32_t i = 0; i < angles.n; i++) {
    Expr sine = n->gens.at[n->atoms.at[angles.at[i]].sin].expr;
    Poly q;
    while (p->n > 1 && divide_by_sine(n, *p, angles.at[i], &q)) {
      *p = q;
      factor = expr_mul(n->g, factor, sine);
    }
  }
  return factor;
}

/* Second pair of generators for the sine and cosine of an angle, with cos^2 eliminated instead of sin^2. */
typedef struct {
  GenId cos, sin;
} Swapped;

static Swapped swap_angle(Normal *n, uint32_t angle) {
  PolyRing *r = n->ring;
  Atom a = n->atoms.at[angle];
  Swapped w = {.sin = poly_new_gen(r)};
  Poly s = poly_gen(r, w.sin), one = poly_num(r, num_int(1));
  Poly ss = poly_mul(r, s, s);
  w.cos = poly_new_root(r, 2, poly_sub(r, one, ss));
  GenInfo sin = n->gens.at[a.sin], cos = n->gens.at[a.cos];
  normal_set_gen_info(n, w.sin, sin);
  normal_set_gen_info(n, w.cos, cos);
  return w;
}

/* p with the generators of one angle replaced by its swapped pair. Powers of the cosine are >= 0. */
static Poly with_swapped(Normal *n, Poly p, uint32_t angle, Swapped w) {
  PolyRing *r = n->ring;
  Atom a = n->atoms.at[angle];
  Poly *part = ARENA_ARRAY(n->arena, Poly, p.n + 1);
  for (uint32_t i = 0; i < p.n; i++) {
    MonoPow both[2] = {{w.sin, mono_exp(r, p.at[i].mono, a.sin)}, {w.cos, mono_exp(r, p.at[i].mono, a.cos)}};
    MonoId rest = mono_without(r, p.at[i].mono, a.sin);
    rest = mono_without(r, rest, a.cos);
    MonoId fresh = mono_of(r, both, 2);
    Poly one = poly_mono(r, p.at[i].c, fresh);
    part[i] = poly_mul_mono(r, one, num_int(1), rest);
  }
  return poly_sum(r, part, NULL, p.n);
}

/* p with sin^2 or cos^2 eliminated angle by angle, whichever leaves fewer terms. */
static Poly shortest_powers(Normal *n, Poly p) {
  Angles angles = angles_of(n, p);
  for (uint32_t i = 0; i < angles.n && p.n > 1; i++) {
    Swapped w = swap_angle(n, angles.at[i]);
    Poly q = with_swapped(n, p, angles.at[i], w);
    if (n->ring->status == POLY_OK && q.n < p.n) p = q;
  }
  return p;
}

static TrigForm form_of_poly(Normal *n, Poly p, Expr factor) {
  TrigForm f = {0};
  uint32_t cap = 0;
  for (uint32_t i = 0; i < p.n; i++) {
    Expr m = normal_mono_expr(n, p.at[i].mono);
    push_term(n, &f, &cap, p.at[i].c, expr_mul(n->g, factor, m));
  }
  return f;
}

static TrigForm powers_form(Normal *n, Poly p) {
  Expr factor = take_common(n, &p);
  Poly q = shortest_powers(n, p);
  return form_of_poly(n, q, factor);
}

/* --- sums of combined angles --- */

/* One line of the spectrum: c*cos(k*direction) or c*sin(k*direction). direction is a primitive monomial in the
 * generators z of the angles, its first exponent positive. */
typedef struct {
  MonoId direction;
  int32_t k;
  int is_sine;
  Num c;
} Line;

typedef struct {
  Num constant;
  VEC(Line) lines; /* by direction, then k */
  Angles angles;
  GenId first_z; /* angle i has the generator first_z + i */
} Spectrum;

enum { MAX_FOURIER_POWER = 16, MAX_FOURIER_ANGLES = 8 };

/* Whether products to sums can be applied to p at reasonable cost. */
static int has_spectrum(Normal *n, Poly p) {
  for (uint32_t i = 0; i < p.n; i++) {
    const Mono *m = mono_at(n->ring, p.at[i].mono);
    int32_t total = 0;
    for (uint32_t k = 0; k < m->n; k++) {
      if (m->at[k].exp < 0) return 0;
      total += m->at[k].exp;
    }
    if (total > MAX_FOURIER_POWER) return 0;
  }
  return 1;
}

/* Euler's formula (z + sign/z)/2: the cosine, or i times the sine, for z = exp(iu). */
static Poly euler(PolyRing *r, GenId z, int sign) {
  MonoPow up = {.gen = z, .exp = 1}, down = {.gen = z, .exp = -1};
  Term t[2];
  t[0] = (Term){.mono = mono_of(r, &up, 1), .c = num_ratio(1, 2)};
  t[1] = (Term){.mono = mono_of(r, &down, 1), .c = num_ratio(sign, 2)};
  return poly_collect(r, t, 2);
}

/* One term in exponentials times i^parity; the sign in i^-(number of sines) = +-i^-parity is included. */
static Poly term_in_exponentials(Normal *n, const Spectrum *s, Term t, int *parity) {
  PolyRing *r = n->ring;
  Poly p = poly_num(r, t.c);
  int32_t sines = 0;
  for (uint32_t i = 0; i < s->angles.n; i++) {
    Atom a = n->atoms.at[s->angles.at[i]];
    int32_t c = mono_exp(r, t.mono, a.cos), sine = mono_exp(r, t.mono, a.sin);
    Poly cos = euler(r, s->first_z + i, 1), sin = euler(r, s->first_z + i, -1);
    Poly cos_power = poly_pow(r, cos, (uint32_t)c), sin_power = poly_pow(r, sin, (uint32_t)sine);
    p = poly_mul(r, p, cos_power);
    p = poly_mul(r, p, sin_power);
    sines += sine;
  }
  *parity = sines % 2;
  return sines / 2 % 2 ? poly_scale(r, num_int(-1), p) : p;
}

/* Spectral line of a term: its frequency is split into k times a primitive direction. */
static Line line_of(PolyRing *r, Term t, int is_sine) {
  Mono m = *mono_at(r, t.mono);
  int32_t k = 0;
  MonoPow *direction = ARENA_ARRAY(r->arena, MonoPow, m.n + 1);
  for (uint32_t i = 0; i < m.n; i++)
    for (int32_t a = abs(m.at[i].exp), b; a; a = b) {
      b = k % a;
      k = a;
    }
  for (uint32_t i = 0; i < m.n; i++) direction[i] = (MonoPow){m.at[i].gen, m.at[i].exp / k};
  Line line = {.direction = mono_of(r, direction, m.n), .k = k, .is_sine = is_sine};
  line.c = num_mul(num_int(2), t.c); /* the term and its conjugate */
  return line;
}

/* Adds the lines of a polynomial in exponentials; of each pair of conjugates the one with positive first exponent
 * counts. */
static void push_lines(Normal *n, Spectrum *s, Poly p, int is_sine) {
  for (uint32_t i = 0; i < p.n; i++) {
    const Mono *m = mono_at(n->ring, p.at[i].mono);
    if (m->n == 0) s->constant = p.at[i].c;
    else if (m->at[0].exp > 0) vec_push(n->arena, &s->lines, line_of(n->ring, p.at[i], is_sine));
  }
}

static int by_direction(const void *a, const void *b) {
  const Line *x = a, *y = b;
  if (x->direction != y->direction) return x->direction < y->direction ? -1 : 1;
  if (x->k != y->k) return x->k < y->k ? -1 : 1;
  return x->is_sine - y->is_sine;
}

static Spectrum spectrum_of(Normal *n, Poly p) {
  PolyRing *r = n->ring;
  Spectrum s = {.constant = num_int(0), .angles = angles_of(n, p), .first_z = r->gens.n};
  for (uint32_t i = 0; i < s.angles.n; i++) {
    GenId z = poly_new_gen(r);
    normal_set_gen_info(n, z, (GenInfo){.kind = GEN_SYMBOL});
  }
  Poly *even = ARENA_ARRAY(n->arena, Poly, p.n + 1), *odd = ARENA_ARRAY(n->arena, Poly, p.n + 1);
  for (uint32_t i = 0; i < p.n; i++) {
    int parity;
    Poly one = term_in_exponentials(n, &s, p.at[i], &parity);
    *(parity ? &odd[i] : &even[i]) = one; /* the part of the other parity stays 0 */
  }
  Poly cosines = poly_sum(r, even, NULL, p.n), sines = poly_sum(r, odd, NULL, p.n);
  push_lines(n, &s, cosines, 0);
  push_lines(n, &s, sines, 1);
  if (s.lines.n > 1) qsort(s.lines.at, s.lines.n, sizeof *s.lines.at, by_direction);
  return s;
}

/* The combined angle of a direction. */
static Expr direction_expr(Normal *n, const Spectrum *s, MonoId direction) {
  Expr *term = ARENA_ARRAY(n->arena, Expr, s->angles.n);
  uint32_t count = 0;
  for (uint32_t i = 0; i < s->angles.n; i++) {
    int32_t k = mono_exp(n->ring, direction, s->first_z + i);
    if (!k) continue;
    term[count++] = expr_scale(n->g, num_int(k), n->atoms.at[s->angles.at[i]].u);
  }
  return expr_add_n(n->g, term, count);
}

/* The lines [from, to) of one direction, plus a constant, as powers of its sine and cosine. */
static TrigForm class_powers(Normal *n, const Spectrum *s, uint32_t from, uint32_t to, Num constant) {
  PolyRing *r = n->ring;
  Expr u = direction_expr(n, s, s->lines.at[from].direction);
  uint32_t angle = normal_new_angle(n, u);
  Poly *part = ARENA_ARRAY(n->arena, Poly, to - from + 1);
  Num *c = ARENA_ARRAY(n->arena, Num, to - from + 1);
  for (uint32_t i = from; i < to; i++) {
    Circular cs = normal_multiple(n, angle, s->lines.at[i].k);
    part[i - from] = s->lines.at[i].is_sine ? cs.sin.num : cs.cos.num;
    c[i - from] = s->lines.at[i].c;
  }
  part[to - from] = poly_num(r, num_int(1));
  c[to - from] = constant;
  Poly p = poly_sum(r, part, c, to - from + 1);
  if (r->status != POLY_OK || p.n == 0) return (TrigForm){0};
  return powers_form(n, p);
}

static TrigForm class_lines(Normal *n, const Spectrum *s, uint32_t from, uint32_t to, Num constant) {
  TrigForm f = {0};
  uint32_t cap = 0;
  Expr u = direction_expr(n, s, s->lines.at[from].direction);
  if (!num_is_zero(constant)) push_term(n, &f, &cap, constant, expr_int(n->g, 1));
  for (uint32_t i = from; i < to; i++) {
    Line line = s->lines.at[i];
    Expr arg = expr_scale(n->g, num_int(line.k), u);
    push_term(n, &f, &cap, line.c, expr_fn(n->g, line.is_sine ? EX_SIN : EX_COS, arg));
  }
  return f;
}

static TrigForm class_form(Normal *n, const Spectrum *s, uint32_t from, uint32_t to, Num constant) {
  TrigForm powers = class_powers(n, s, from, to, constant), lines = class_lines(n, s, from, to, constant);
  return powers.n && powers.n <= lines.n ? powers : lines;
}

static uint32_t class_end(const Spectrum *s, uint32_t from) {
  uint32_t to = from;
  while (to < s->lines.n && s->lines.at[to].direction == s->lines.at[from].direction) to++;
  return to;
}

/* Every direction in its shortest form; the constant goes where it saves most, or stands alone. */
static TrigForm spectrum_form(Normal *n, const Spectrum *s, Expr factor) {
  TrigForm all = {0}, best = {0};
  uint32_t cap = 0, best_from = UINT32_MAX, saved = 0;
  Num none = num_int(0);
  for (uint32_t i = 0; i < s->lines.n && !num_is_zero(s->constant); i = class_end(s, i)) {
    TrigForm with = class_form(n, s, i, class_end(s, i), s->constant);
    TrigForm without = class_form(n, s, i, class_end(s, i), none);
    if (without.n + 1 <= with.n + saved) continue;
    saved = without.n + 1 - with.n;
    best_from = i;
    best = with;
  }
  if (!num_is_zero(s->constant) && best_from == UINT32_MAX) push_term(n, &all, &cap, s->constant, factor);
  for (uint32_t i = 0; i < s->lines.n; i = class_end(s, i)) {
    TrigForm one = i == best_from ? best : class_form(n, s, i, class_end(s, i), none);
    for (uint32_t k = 0; k < one.n; k++) push_term(n, &all, &cap, one.at[k].c, expr_mul(n->g, factor, one.at[k].e));
  }
  return all;
}

/* --- the choice --- */

static void try_spectrum(Normal *n, TrigForm *best, Poly p, Expr factor) {
  if (best->n <= 1 || !has_spectrum(n, p) || n->ring->status != POLY_OK) return;
  if (angles_of(n, p).n > MAX_FOURIER_ANGLES) return;
  Spectrum s = spectrum_of(n, p);
  TrigForm f = spectrum_form(n, &s, factor);
  if (n->ring->status == POLY_OK && f.n && f.n < best->n) *best = f;
}

TrigForm trig_simplify(Normal *n, Poly p) {
  Expr one = expr_int(n->g, 1);
  if (p.n == 1) return form_of_poly(n, p, one);
  Poly rest = p;
  Expr factor = take_common(n, &rest);
  TrigForm best = form_of_poly(n, shortest_powers(n, rest), factor);
  try_spectrum(n, &best, rest, factor);
  if (!expr_is_num(n->g, factor)) try_spectrum(n, &best, p, one);
  return best;
}
