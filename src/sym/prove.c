/* Proofs by normal form, by value at random states, and by Cramer's rule for linear systems. */
#include "sym/prove.h"

#include <float.h>
#include <math.h>

#include "sym/sum_nest.h"

NormalLimits prove_limits(void) { return (NormalLimits){.max_terms = 20000, .max_work = 2000000, .proof = 1}; }

enum { STATES = 8, MOST_STATES = 2000, MOST_WORK = 4000000 };

static Verdict zero_by_form(ExprGraph *g, Expr e, const NormalLimits *limits);

/* --- quantified sums --- */

/* e without the cells of nests whose contribution vanishes in each turn, as the normal form proves. */
static Expr drop_vanishing_sums(ExprGraph *g, Expr e, const NormalLimits *limits) {
  Expr rest, body = expr_gather_sum(g, e, &rest);
  return body && zero_by_form(g, body, limits) == PROVED_ZERO ? rest : e;
}

/* --- by value --- */

/* Whether e has a sum of so many turns that its values have no bounds. */
static int has_long_sums(ExprGraph *g, Expr e) {
  enum { MOST_TURNS = 50000 }; /* as in rounding_bounds.c */
  ExprList l = expr_topo_to_sums(g, &e, 1);
  int yes = 0;
  for (uint32_t k = 0; k < l.n && !yes; k++)
    yes = expr_op(g, l.at[k]) == EX_NEST && expr_sum_turns(g, l.at[k]) > MOST_TURNS;
  expr_list_free(g, l);
  return yes;
}

/* One of 16 states in the domain decides; few states may lie there, as of roots of several differences. */
int prove_nonzero(ExprGraph *g, Expr e) {
  if (has_long_sums(g, e)) return 0;
  long double *symbols = ARENA_ARRAY(expr_arena(g), long double, expr_symbol_count(g) + 1);
  BoundTape *tape = bound_tape(g, &e, 1);
  uint32_t most = 2 * STATES + MOST_WORK / (e + 1);
  int yes = 0;
  if (most > MOST_STATES) most = MOST_STATES;
  for (uint32_t seed = 1, inside = 0; seed <= most && inside < 2 * STATES && !yes; seed++) {
    long double bound, value;
    if (seed % (2 * STATES) <= STATES) sample_state(g, seed, symbols);
    else sample_state_wide(g, seed, symbols);
    bound_run(tape, symbols, NULL);
    value = bound_value(tape, e, &bound);
    if (!isfinite(value) || !isfinite(bound)) continue;
    inside++;
    yes = fabsl(value) > 1000 * bound + LDBL_MIN;
  }
  bound_tape_free(tape);
  arena_recycle(expr_arena(g), symbols, (expr_symbol_count(g) + 1) * sizeof *symbols);
  return yes;
}

/* --- zero --- */

typedef struct {
  ExprGraph *g;
  Expr e;
  NormalLimits limits;
  int overflowed; /* numbers did not fit 64 bits */
  Verdict verdict;
} ZeroTask;

static void zero_work(Arena *scratch, void *data) {
  ZeroTask *t = data;
  Normal *n = normal_new(t->g, scratch, t->limits);
  Frac f;
  PolyStatus status = normal_run(n, &t->e, 1, &f);
  t->overflowed = status == POLY_INEXACT;
  if (status != POLY_OK) return;
  if (f.num.n == 0) t->verdict = PROVED_ZERO;
  else if (n->canonical && !t->limits.residues) t->verdict = PROVED_NONZERO;
}

static Verdict zero_by_form(ExprGraph *g, Expr e, const NormalLimits *limits) {
  if (e == 0 || expr_is_zero(g, e)) return PROVED_ZERO;
  for (Expr last = 0; last != e;) {
    last = e;
    e = drop_vanishing_sums(g, e, limits);
  }
  if (!expr_open_sums(g, &e)) return NOT_DECIDED;
  if (expr_is_zero(g, e)) return PROVED_ZERO;
  ZeroTask t = {.g = g, .e = e, .limits = limits ? *limits : prove_limits()};
  arena_with_scratch(expr_arena(g), zero_work, &t);
  if (t.overflowed) {
    t.limits.residues = 1;
    arena_with_scratch(expr_arena(g), zero_work, &t);
  }
  return t.verdict;
}

Verdict prove_zero(ExprGraph *g, Expr e, const NormalLimits *limits) {
  Verdict v = zero_by_form(g, e, limits);
  return v == NOT_DECIDED && prove_nonzero(g, e) ? PROVED_NONZERO : v;
}

/* --- the block of a linear system that an expression needs --- */

typedef struct {
  ExprGraph *g;
  uint32_t n;        /* size of the block */
  uint32_t *index;   /* row of the whole system, by row of the block */
  const Expr *M, *f; /* the block, row by row */
  const SymId *acc;
  Expr e;
  NormalLimits limits;
  Verdict verdict;
} System;

/* Marks the unknowns of e, then every unknown coupled to a marked one by an entry of M; returns their number. */
static uint32_t mark_block(ExprGraph *g, uint32_t n, const Expr *M, const SymId *acc, Expr e, uint8_t *in) {
  uint32_t count = 0;
  for (uint32_t i = 0; i < n; i++) {
    in[i] = (uint8_t)expr_contains_sym(g, e, acc[i]);
    count += in[i];
  }
  for (uint32_t before = 0; before != count;) {
    before = count;
    for (uint32_t i = 0; i < n; i++)
      for (uint32_t k = 0; k < n; k++) {
        if (in[i] == in[k] || !M[i * n + k] || expr_is_zero(g, M[i * n + k])) continue;
        in[i] = in[k] = 1;
        count++;
      }
  }
  return count;
}

static System take_block(ExprGraph *g, uint32_t n, const Expr *M, const Expr *f, const SymId *acc, Expr e) {
  Arena *a = expr_arena(g);
  uint8_t *in = ARENA_ARRAY(a, uint8_t, n + 1);
  System s = {.g = g, .e = e, .n = mark_block(g, n, M, acc, e, in)};
  Expr *block = ARENA_ARRAY(a, Expr, s.n * s.n + 1), *rhs = ARENA_ARRAY(a, Expr, s.n + 1);
  SymId *unknown = ARENA_ARRAY(a, SymId, s.n + 1);
  uint32_t row = 0;
  for (uint32_t i = 0; i < n; i++) {
    if (!in[i]) continue;
    uint32_t column = 0;
    for (uint32_t k = 0; k < n; k++)
      if (in[k]) block[row * s.n + column++] = M[i * n + k];
    rhs[row] = f[i];
    unknown[row++] = acc[i];
  }
  s.M = block;
  s.f = rhs;
  s.acc = unknown;
  return s;
}

/* --- a diagonal block --- */

static int is_diagonal(const System *s) {
  for (uint32_t i = 0; i < s->n * s->n; i++)
    if ((i % (s->n + 1) == 0) != (s->M[i] && !expr_is_zero(s->g, s->M[i]))) return 0;
  return 1;
}

static int has_unknown(const ExprGraph *g, Expr e) {
  return (expr_kinds(g, e) & (1u << SYM_ACC | 1u << SYM_MULTIPLIER)) != 0;
}

/* Whether e is a polynomial in the unknowns, so that substituting their values is valid for all states. */
static int is_polynomial(const System *s) {
  ExprGraph *g = s->g;
  ExprList all = expr_topo(g, &s->e, 1);
  for (uint32_t i = 0; i < all.n; i++) {
    Expr e = all.at[i];
    ExprOp op = expr_op(g, e);
    if (!has_unknown(g, e) || op == EX_SYM || op == EX_SUM || op == EX_DEF) continue;
    if (op != EX_PROD) return 0;
    for (ExprPair base = {0}; expr_next_pair(g, e, EX_PROD, &base);)
      if (has_unknown(g, base.of) && !(num_is_int(base.num) && num_sign(base.num) > 0)) return 0;
  }
  return 1;
}

/* f/M as a sum of quotients, term by term of f. */
static Expr split_quotient(ExprGraph *g, Expr f, Expr M) {
  uint32_t n = expr_pairs(g, f, EX_SUM);
  Expr *part = ARENA_ARRAY(expr_arena(g), Expr, n + 1);
  for (uint32_t i = 0; i < n; i++) {
    Num number;
    Expr term = expr_pair(g, f, EX_SUM, i, &number);
    part[i] = expr_scale(g, number, expr_div(g, term, M));
  }
  return expr_add_n(g, part, n);
}

/* e with each unknown replaced by quotient(f_i, M_ii). */
static Expr with_quotients(const System *s, Expr (*quotient)(ExprGraph *g, Expr f, Expr M)) {
  Expr *with = ARENA_ARRAY(expr_arena(s->g), Expr, s->n + 1);
  for (uint32_t i = 0; i < s->n; i++) with[i] = quotient(s->g, s->f[i], s->M[i * (s->n + 1)]);
  return expr_replace(s->g, s->e, s->acc, with, s->n);
}

/* Verdict for a diagonal block of any size, without the normal form of the block. Long sums of fractions may cancel
 * term by term where a common denominator would be too large: hence both f/M whole and f/M term by term are tried.
 * */
static Verdict diagonal_verdict(const System *s) {
  if (!is_diagonal(s) || !is_polynomial(s)) return NOT_DECIDED;
  if (expr_is_zero(s->g, with_quotients(s, expr_div))) return PROVED_ZERO;
  return zero_by_form(s->g, with_quotients(s, split_quotient), &s->limits);
}

/* --- Cramer's rule --- */

enum { MAX_BLOCK = 8 };

/* Augmented block [M f] as polynomials: every row is multiplied by its common denominator. */
static void clear_denominators(Normal *n, uint32_t size, const Frac *M, const Frac *f, Poly *rows) {
  for (uint32_t i = 0; i < size; i++) {
    DenId den = f[i].den;
    for (uint32_t k = 0; k < size; k++) den = frac_lcm(n->field, den, M[i * size + k].den);
    for (uint32_t k = 0; k <= size; k++) {
      Frac entry = k < size ? M[i * size + k] : f[i];
      Poly cofactor = frac_cofactor(n->field, entry.den, den);
      rows[i * (size + 1) + k] = poly_mul(n->ring, entry.num, cofactor);
    }
  }
}

/* Minor of the first rows over the columns in the bit set `set`, by expansion along its last row. Expansion by
 * minors, each computed once, beats elimination on sparse polynomials (Gentleman and Johnson 1976, DOI
 * 10.1145/355694.355696), and needs no division modulo relations. */
static Poly minor_of(PolyRing *r, uint32_t columns, const Poly *rows, uint32_t set, const Poly *minors) {
  uint32_t row = (uint32_t)__builtin_popcount(set) - 1;
  Poly parts[MAX_BLOCK + 1];
  Num signs[MAX_BLOCK + 1];
  uint32_t n = 0;
  int sign = row % 2 == 0 ? 1 : -1;
  for (uint32_t k = 0; k < columns; k++) {
    if (!(set >> k & 1)) continue;
    parts[n] = poly_mul(r, rows[row * columns + k], minors[set & ~(1u << k)]);
    signs[n++] = num_int(sign);
    sign = -sign;
  }
  return poly_sum(r, parts, signs, n);
}

/* Cramer's rule: returns det M; solution[k] is the determinant of M with column k replaced by f. */
static Poly cramer(Normal *n, uint32_t size, const Poly *rows, Poly *solution) {
  uint32_t columns = size + 1, all = (1u << columns) - 1;
  Poly *minors = ARENA_ARRAY(n->arena, Poly, all + 1);
  minors[0] = poly_num(n->ring, num_int(1));
  for (uint32_t set = 1; set < all; set++) minors[set] = minor_of(n->ring, columns, rows, set, minors);
  for (uint32_t k = 0; k < size; k++) {
    /* f stands last instead of at k: size - 1 - k swaps of neighbours. */
    int sign = (size - 1 - k) % 2 == 0 ? 1 : -1;
    solution[k] = poly_scale(n->ring, num_int(sign), minors[all & ~(1u << k)]);
  }
  return minors[all & ~(1u << size)];
}

/* Generator of each unknown; returns 0 if an unknown occurs inside another generator, where it cannot be
 * substituted. */
static int unknown_gens(Normal *n, const System *s, GenId *gen) {
  for (uint32_t k = 0; k < s->n; k++) {
    gen[k] = GEN_NONE;
    uint32_t known = expr_map_get(&n->of_symbol, expr_symbol(n->g, s->acc[k])->node);
    if (!known) continue;
    gen[k] = known - 1;
    for (GenId x = 0; x < n->gens.n; x++)
      if (x != gen[k] && expr_contains_sym(n->g, n->gens.at[x].expr, s->acc[k])) return 0;
  }
  return 1;
}

/* Term t with unknown k replaced by solution[k]/det, times det^degree; degree is at least the term's degree in the
 * unknowns. */
static Poly substitute_term(Normal *n, const System *s, const GenId *gen, Term t, int32_t degree, Poly det,
                            const Poly *solution) {
  PolyRing *r = n->ring;
  MonoId rest = t.mono;
  Poly p = poly_num(r, num_int(1));
  for (uint32_t k = 0; k < s->n; k++) {
    int32_t e = mono_exp(r, t.mono, gen[k]);
    if (!e) continue;
    rest = mono_without(r, rest, gen[k]);
    degree -= e;
    Poly power = poly_pow(r, solution[k], (uint32_t)e);
    p = poly_mul(r, p, power);
  }
  Poly power = poly_pow(r, det, (uint32_t)degree);
  p = poly_mul(r, p, power);
  return poly_mul_mono(r, p, t.c, rest);
}

/* p with the solution substituted for the unknowns, times a power of det. Returns 0 on a negative power of an
 * unknown. */
static int substitute(Normal *n, const System *s, const GenId *gen, Poly p, Poly det, const Poly *solution,
                      Poly *result) {
  int32_t degree = 0;
  for (uint32_t i = 0; i < p.n; i++) {
    int32_t total = 0;
    for (uint32_t k = 0; k < s->n; k++) {
      int32_t e = mono_exp(n->ring, p.at[i].mono, gen[k]);
      if (e < 0) return 0;
      total += e;
    }
    if (total > degree) degree = total;
  }
  Poly *part = ARENA_ARRAY(n->arena, Poly, p.n + 1);
  for (uint32_t i = 0; i < p.n; i++) part[i] = substitute_term(n, s, gen, p.at[i], degree, det, solution);
  *result = poly_sum(n->ring, part, NULL, p.n);
  return n->ring->status == POLY_OK;
}

/* Whether all factors of the denominator are nonzero on the solution. */
static int den_survives(Normal *n, const System *s, const GenId *gen, DenId den, Poly det, const Poly *solution) {
  Den d = frac_den(n->field, den);
  for (uint32_t i = 0; i < d.n; i++) {
    Poly value;
    if (!substitute(n, s, gen, poly_at(n->ring, d.at[i].factor), det, solution, &value) || value.n == 0) return 0;
  }
  return 1;
}

static void solves_work(Arena *scratch, void *data) {
  System *s = data;
  Normal *n = normal_new(s->g, scratch, s->limits);
  uint32_t size = s->n, count = size * size + size + 1;
  Expr *roots = ARENA_ARRAY(scratch, Expr, count);
  memcpy(roots, s->M, size * size * sizeof *roots);
  memcpy(roots + size * size, s->f, size * sizeof *roots);
  roots[count - 1] = s->e;
  Frac *form = ARENA_ARRAY(scratch, Frac, count);
  if (normal_run(n, roots, count, form) != POLY_OK) return;
  GenId gen[MAX_BLOCK];
  if (!unknown_gens(n, s, gen)) return;
  Poly *rows = ARENA_ARRAY(scratch, Poly, size * (size + 1)), solution[MAX_BLOCK], result;
  clear_denominators(n, size, form, form + size * size, rows);
  Poly det = cramer(n, size, rows, solution);
  if (n->ring->status != POLY_OK || det.n == 0) return;
  Frac e = form[count - 1];
  if (!den_survives(n, s, gen, e.den, det, solution)) return;
  if (!substitute(n, s, gen, e.num, det, solution, &result)) return;
  if (result.n == 0) s->verdict = PROVED_ZERO;
  else if (n->canonical) s->verdict = PROVED_NONZERO;
}

Verdict prove_solves(ExprGraph *g, uint32_t n, const Expr *M, const Expr *f, const SymId *acc, Expr e,
                     const NormalLimits *limits) {
  System s = take_block(g, n, M, f, acc, e);
  if (s.n == 0) return zero_by_form(g, e, limits);
  s.limits = limits ? *limits : prove_limits();
  s.verdict = diagonal_verdict(&s);
  if (s.verdict == NOT_DECIDED && s.n <= MAX_BLOCK) arena_with_scratch(expr_arena(g), solves_work, &s);
  return s.verdict;
}
