/* Antiderivatives term by term, from the normal form of the integrand; potentials from their gradients. */
#include "sym/integrate.h"

#include "sym/diff.h"
#include "sym/normal_form.h"
#include "sym/prove.h"
#include "sym/sides.h"
#include "sym/simplify.h"

enum { MAX_TERMS = 4000, MAX_WORK = 400000, MAX_HARMONICS = 256, MAX_POWER = 64 };

/* c*sin(u) or c*cos(u) */
typedef struct {
  Num c;
  Expr angle;
  int is_sin;
} Harmonic;

typedef VEC(Harmonic) Harmonics;

/* factor * x^power * exp(growth) * (sum of harmonics) */
typedef struct {
  Expr factor, growth;
  int32_t power;
  Harmonics harmonics;
} IntegrandTerm;

typedef struct {
  ExprGraph *g;
  Expr e;
  SymId x;
  unsigned without;
  Expr result;
  SymId s;         /* scratch symbol of substitutions */
  const SymId *q;  /* [n] coordinates that factors of a substitution do not contain */
  uint32_t n;
} Task;

static int has_x(const Task *t, Expr e) { return expr_contains_sym(t->g, e, t->x); }

/* --- a term into a product --- */

/* Multiplies the sum of harmonics by sin(u) or cos(u), products to sums; returns 0 if there are too many. */
static int times_circular(Normal *n, Harmonics *h, Expr u, int is_sin) {
  Harmonics out = {0};
  for (uint32_t i = 0; i < h->n; i++) {
    Harmonic a = h->at[i];
    Expr minus = expr_sub(n->g, a.angle, u), plus = expr_add(n->g, a.angle, u);
    Num half = num_div(a.c, num_int(2)), other = num_neg(half);
    int sine = a.is_sin != is_sin; /* sin a cos u, cos a sin u: sines; the others cosines */
    vec_push(n->arena, &out, ((Harmonic){!a.is_sin && is_sin ? other : half, minus, sine}));
    vec_push(n->arena, &out, ((Harmonic){a.is_sin && is_sin ? other : half, plus, sine}));
  }
  *h = out;
  return out.n <= MAX_HARMONICS;
}

/* Whether du/dx is free of x and of the excluded kinds of symbols. */
static int is_linear(const Task *t, Expr u) {
  Expr slope = expr_diff(t->g, u, t->x);
  return !has_x(t, slope) && !(expr_kinds(t->g, slope) & t->without);
}

static int times_power(const Task *t, IntegrandTerm *p, const GenInfo *gen, int32_t exp) {
  if (expr_op(t->g, gen->expr) != EX_EXP) return 0;
  Expr u = expr_arg(t->g, gen->expr, 0), grown = expr_scale(t->g, num_int(exp), u);
  p->growth = expr_add(t->g, p->growth, grown);
  return is_linear(t, u);
}

/* Multiplies p by a power of a generator that contains x; returns 0 if the form has no place for it. */
static int times_gen(Normal *n, const Task *t, IntegrandTerm *p, GenId x, int32_t exp) {
  const GenInfo gen = n->gens.at[x];
  switch (gen.kind) {
    case GEN_SYMBOL: p->power += exp; return exp <= MAX_POWER && exp >= -MAX_POWER;
    case GEN_POWER: return times_power(t, p, &gen, exp);
    case GEN_SIN: case GEN_COS: {
      Expr u = n->atoms.at[gen.atom].u;
      int good = exp > 0 && is_linear(t, u);
      for (int32_t i = 0; i < exp && good; i++) good = times_circular(n, &p->harmonics, u, gen.kind == GEN_SIN);
      return good;
    }
    case GEN_ROOT: case GEN_OPAQUE: return 0;
  }
  return 0;
}

/* One term of the integrand, times divisor, in that product form; returns 0 if it does not fit. */
static int product_of(Normal *n, const Task *t, Term term, Expr divisor, IntegrandTerm *p) {
  ExprGraph *g = t->g;
  Mono mono = *mono_at(n->ring, term.mono);
  *p = (IntegrandTerm){.factor = expr_num(g, term.c), .growth = expr_int(g, 0)};
  vec_push(n->arena, &p->harmonics, ((Harmonic){num_int(1), expr_int(g, 0), 0}));
  p->factor = expr_mul(g, p->factor, divisor);
  for (uint32_t i = 0; i < mono.n; i++) {
    Expr gen = n->gens.at[mono.at[i].gen].expr;
    if (has_x(t, gen)) {
      if (!times_gen(n, t, p, mono.at[i].gen, mono.at[i].exp)) return 0;
      continue;
    }
    if (expr_kinds(g, gen) & t->without) return 0;
    Expr power = expr_pow_num(g, gen, num_int(mono.at[i].exp));
    p->factor = expr_mul(g, p->factor, power);
  }
  return 1;
}

/* --- antiderivatives --- */

typedef struct {
  Expr sin, cos;
} HarmonicPair;

/* Integral of x^k: x^(k + 1)/(k + 1), or log|x| for k = -1. */
static Expr power_integral(const Task *t, int32_t k) {
  ExprGraph *g = t->g;
  Expr x = expr_symbol(g, t->x)->node;
  if (k == -1) {
    Expr size = expr_fn(g, EX_ABS, x);
    return expr_fn(g, EX_LOG, size);
  }
  Expr power = expr_pow_num(g, x, num_int(k + 1));
  return expr_scale(g, num_ratio(1, k + 1), power);
}

static Expr combine(ExprGraph *g, Expr a, Expr x, Expr b, Expr y) {
  Expr ax = expr_mul(g, a, x), by = expr_mul(g, b, y);
  return expr_add(g, ax, by);
}

/* The integrals of x^k exp(u) sin(w) and x^k exp(u) cos(w), u' = a, w' = b, by parts from k = 0 on:
 *   int x^k exp(u) sin(w) = (x^k exp(u) (a sin w - b cos w) - k (a S - b C))/(a^2 + b^2), S and C the integrals for
 *   k - 1. */
static HarmonicPair harmonic_integrals(const Task *t, int32_t k, Expr u, Expr w) {
  ExprGraph *g = t->g;
  Expr a = expr_diff(g, u, t->x), b = expr_diff(g, w, t->x), minus_b = expr_neg(g, b), x = expr_symbol(g, t->x)->node;
  Expr size = combine(g, a, a, b, b), inverse = expr_pow_num(g, size, num_int(-1));
  Expr grown = expr_fn(g, EX_EXP, u), s = expr_fn(g, EX_SIN, w), c = expr_fn(g, EX_COS, w);
  HarmonicPair done = {expr_int(g, 0), expr_int(g, 0)};
  for (int32_t i = 0; i <= k; i++) {
    Expr power = expr_pow_num(g, x, num_int(i)), front = expr_mul(g, power, grown);
    Expr sine = combine(g, a, s, minus_b, c), cosine = combine(g, a, c, b, s);
    Expr old_sine = combine(g, a, done.sin, minus_b, done.cos), old_cosine = combine(g, a, done.cos, b, done.sin);
    old_sine = expr_scale(g, num_int(-i), old_sine);
    old_cosine = expr_scale(g, num_int(-i), old_cosine);
    Expr one = expr_int(g, 1), new_sine = combine(g, front, sine, one, old_sine),
         new_cosine = combine(g, front, cosine, one, old_cosine);
    done.sin = expr_mul(g, new_sine, inverse);
    done.cos = expr_mul(g, new_cosine, inverse);
  }
  return done;
}

/* Integral of p; 0 for a negative power of x times a function of x. */
static Expr product_integral(const Task *t, const IntegrandTerm *p) {
  ExprGraph *g = t->g;
  Expr sum = expr_int(g, 0);
  for (uint32_t i = 0; i < p->harmonics.n; i++) {
    Harmonic h = p->harmonics.at[i];
    Expr part;
    if (!has_x(t, h.angle) && !has_x(t, p->growth)) {
      Expr value = expr_fn(g, h.is_sin ? EX_SIN : EX_COS, h.angle), grown = expr_fn(g, EX_EXP, p->growth);
      value = expr_mul(g, value, grown);
      part = power_integral(t, p->power);
      part = expr_mul(g, value, part);
    } else if (p->power < 0) {
      return 0;
    } else {
      HarmonicPair both = harmonic_integrals(t, p->power, p->growth, h.angle);
      part = h.is_sin ? both.sin : both.cos;
    }
    part = expr_scale(g, h.c, part);
    sum = expr_add(g, sum, part);
  }
  return expr_mul(g, p->factor, sum);
}

static Expr divisor_expr(Normal *n, DenId den) {
  Poly p = frac_den_poly(n->field, den);
  Expr e = normal_poly_expr(n, p);
  return expr_pow_num(n->g, e, num_int(-1));
}

static void integrate_work(Arena *scratch, void *data) {
  Task *t = data;
  Normal *n = normal_new(t->g, scratch, (NormalLimits){.max_terms = MAX_TERMS, .max_work = MAX_WORK});
  Frac f;
  if (normal_run(n, &t->e, 1, &f) != POLY_OK) return;
  f = frac_cancel(n->field, f);
  Expr divisor = divisor_expr(n, f.den);
  if (n->ring->status != POLY_OK || has_x(t, divisor)) return;
  VEC(Expr) parts = {0};
  for (uint32_t i = 0; i < f.num.n; i++) {
    IntegrandTerm p;
    if (!product_of(n, t, f.num.at[i], divisor, &p)) continue;
    Expr part = product_integral(t, &p);
    if (part) vec_push(scratch, &parts, part);
  }
  t->result = expr_add_n(t->g, parts.at, parts.n);
}

Expr expr_integrate(ExprGraph *g, Expr e, SymId x, unsigned without) {
  Task t = {.g = g, .e = e, .x = x, .without = without, .result = expr_int(g, 0)};
  arena_with_scratch(expr_arena(g), integrate_work, &t);
  return t.result;
}

/* --- potentials --- */

static int contains_any(ExprGraph *g, Expr e, const SymId *q, uint32_t n) {
  for (uint32_t i = 0; i < n; i++)
    if (expr_contains_sym(g, e, q[i])) return 1;
  return 0;
}

/* Integral of u^power; log|u| for power -1. */
static Expr integral_of_power(ExprGraph *g, Expr u, Num power) {
  Num next = num_add(power, num_int(1));
  if (num_is_zero(next)) return expr_fn(g, EX_LOG, expr_fn(g, EX_ABS, u));
  return expr_scale(g, num_div(num_int(1), next), expr_pow_num(g, u, next));
}

/* c of e = .. + c f(u), where `of` is u or f(u) and `slope` = dx/d(of) replaces it by s: c/slope if free of q, else
 * 0. */
static Expr constant_factor(const Task *t, Expr c, Expr slope) {
  Expr factor = expr_is_zero(t->g, slope) ? slope : simplify(t->g, expr_div(t->g, c, slope));
  int constant = !expr_contains_sym(t->g, factor, t->s) && !contains_any(t->g, factor, t->q, t->n);
  return constant && !expr_is_zero(t->g, factor) ? factor : 0;
}

/* d/ds of e with s in the place of a node. */
static Expr slope_in(const Task *t, Expr node) {
  Expr s = expr_symbol(t->g, t->s)->node, in_s;
  expr_replace_nodes(t->g, &t->e, 1, &node, &s, 1, &in_s);
  return expr_diff(t->g, in_s, t->s);
}

/* Integral of a term c u^power of t->e in which c is du/dx times a constant, as of x/(x^2 + y^2)^(3/2), or 0. */
static Expr integral_of_factor(const Task *t, Expr u, Num power) {
  ExprGraph *g = t->g;
  ExprOp op = expr_op(g, u);
  if (op == EX_SYM || op == EX_NUM) return 0;
  Expr flat = expr_pow_num(g, expr_symbol(g, t->s)->node, num_sub(num_int(1), power));
  Expr c = expr_mul(g, slope_in(t, u), flat), once = expr_scale(g, num_div(num_int(1), power), c);
  Expr factor = constant_factor(t, once, expr_diff(g, u, t->x));
  if (factor) return expr_mul(g, factor, integral_of_power(g, u, power));
  int squared = num_is_int(power) && num_value(power) == -2 && (op == EX_COS || op == EX_COSH);
  factor = squared ? constant_factor(t, once, expr_diff(g, expr_arg(g, u, 0), t->x)) : 0;
  return factor ? expr_mul(g, factor, expr_fn(g, op == EX_COS ? EX_TAN : EX_TANH, expr_arg(g, u, 0))) : 0;
}

/* u f(u) - integral of u f'(u), for f whose second term is `rest`. */
static Expr by_parts(ExprGraph *g, ExprOp f, Expr u, Expr rest) {
  return expr_sub(g, expr_mul(g, u, expr_fn(g, f, u)), rest);
}

/* Integral of f(u) by u; 0: it is not in this list. */
static Expr integral_of_function(ExprGraph *g, ExprOp f, Expr u) {
  Expr one = expr_int(g, 1), uu = expr_pow_num(g, u, num_int(2)), root = expr_sqrt(g, expr_sub(g, one, uu));
  Num half = num_ratio(1, 2);
  switch (f) {
    case EX_EXP: return expr_fn(g, EX_EXP, u);
    case EX_SIN: return expr_neg(g, expr_fn(g, EX_COS, u));
    case EX_COS: return expr_fn(g, EX_SIN, u);
    case EX_SINH: return expr_fn(g, EX_COSH, u);
    case EX_COSH: return expr_fn(g, EX_SINH, u);
    case EX_TAN: return expr_neg(g, expr_fn(g, EX_LOG, expr_fn(g, EX_ABS, expr_fn(g, EX_COS, u))));
    case EX_TANH: return expr_fn(g, EX_LOG, expr_fn(g, EX_COSH, u));
    case EX_LOG: return by_parts(g, f, u, u);
    case EX_ATAN: return by_parts(g, f, u, expr_scale(g, half, expr_fn(g, EX_LOG, expr_add(g, one, uu))));
    case EX_ASIN: return by_parts(g, f, u, expr_neg(g, root));
    case EX_ACOS: return by_parts(g, f, u, root);
    case EX_CBRT: return expr_scale(g, num_ratio(3, 4), by_parts(g, f, u, expr_int(g, 0)));
    case EX_FLOOR: {
      Expr floor = expr_fn(g, f, u), next = expr_add(g, floor, one), twice = expr_scale(g, num_int(2), u);
      return expr_scale(g, half, expr_mul(g, floor, expr_sub(g, twice, next)));
    }
    default: return 0;
  }
}

/* Integral of a term c f(u) of t->e in which c is du/dx times a constant, or 0. */
static Expr integral_of_call(const Task *t, Expr call) {
  ExprOp op = expr_op(t->g, call);
  if (op == EX_SYM || op == EX_NUM || expr_nargs(t->g, call) != 1) return 0;
  Expr u = expr_arg(t->g, call, 0), whole = integral_of_function(t->g, op, u);
  Expr factor = whole ? constant_factor(t, slope_in(t, call), expr_diff(t->g, u, t->x)) : 0;
  return factor ? expr_mul(t->g, factor, whole) : 0;
}

/* Integral of c/u, c free of q and u = a x^2 + b x + d without zeros, or 0. */
static Expr integral_of_quadratic(const Task *t, Expr u, Num power) {
  ExprGraph *g = t->g;
  Expr slope = expr_diff(g, u, t->x), twice = expr_diff(g, slope, t->x), zero = expr_int(g, 0);
  if (num_value(power) != -1 || expr_op(g, u) != EX_SUM || contains_any(g, twice, t->q, t->n) || expr_is_zero(g, twice))
    return 0;
  Expr ss = expr_pow_num(g, expr_symbol(g, t->s)->node, num_int(2));
  Expr c = constant_factor(t, expr_neg(g, expr_mul(g, slope_in(t, u), ss)), expr_int(g, 1));
  Expr b = expr_replace(g, slope, &t->x, &zero, 1), d = expr_replace(g, u, &t->x, &zero, 1);
  Expr size = expr_sub(g, expr_scale(g, num_int(2), expr_mul(g, twice, d)), expr_pow_num(g, b, num_int(2)));
  if (!c || expr_sign(g, size) != SIGN_POSITIVE) return 0;
  Expr root = expr_sqrt(g, size), angle = expr_fn(g, EX_ATAN, expr_div(g, slope, root));
  return expr_mul(g, expr_scale(g, num_int(2), c), expr_div(g, angle, root));
}

/* Whether u^power is a power of a sum that is better not multiplied out: near u = 0 its terms cancel. */
static int is_whole_power(const Task *t, Expr u, Num power) {
  return expr_op(t->g, u) == EX_SUM && num_is_int(power) && num_value(power) > 1;
}

/* Integral of one term of t->e by substitution of a function in it, or of a whole power of a sum, or 0. */
static Expr integral_by_substitution(const Task *t, int whole_powers) {
  ExprList nodes = expr_topo(t->g, &t->e, 1);
  for (uint32_t i = 0; i < nodes.n; i++) {
    ExprOp op = expr_op(t->g, nodes.at[i]);
    if (op == EX_NEST) continue; /* no value */
    Expr whole = whole_powers ? 0 : integral_of_call(t, nodes.at[i]);
    for (uint32_t k = 0; !whole && op != EX_SUM && k < expr_pairs(t->g, nodes.at[i], EX_PROD); k++) {
      Num power;
      Expr u = expr_pair(t->g, nodes.at[i], EX_PROD, k, &power);
      if (whole_powers && !is_whole_power(t, u, power)) continue;
      whole = integral_of_factor(t, u, power);
      if (!whole) whole = integral_of_quadratic(t, u, power);
    }
    if (whole) return whole;
  }
  return 0;
}

static Expr antiderivative(ExprGraph *g, Expr e, Task with, int depth, Expr *rest);

/* An antiderivative of all of e, or 0. */
static Expr whole_antiderivative(ExprGraph *g, Expr e, Task with, int depth) {
  Expr rest, sum = antiderivative(g, e, with, depth, &rest);
  return expr_is_zero(g, rest) ? sum : 0;
}

/* Degree u de/du/e of e, a number >= 0 where e is homogeneous in u; else 0. */
static Expr degree_in(const Task *t, Expr e, Expr u, Expr slope) {
  ExprGraph *g = t->g;
  Expr times = expr_mul(g, u, expr_diff(g, e, t->x)), degree = simplify(g, expr_div(g, times, expr_mul(g, slope, e)));
  return expr_is_num(g, degree) && num_sign(expr_number(g, degree)) >= 0 ? degree : 0;
}

/* Integral of a term with a switch at a zero of u, linear in x: u term/(degree + 1) where that holds, else if(0 < u,
 * F, G) from antiderivatives of the branches that are 0 at the switch. 0: none. */
static Expr integral_by_sides(const Task *t, int depth) {
  ExprGraph *g = t->g;
  Expr u = depth > 0 ? switch_in(g, t->e, t->x) : 0, slope = u ? expr_diff(g, u, t->x) : 0, F[2];
  if (!u || expr_contains_sym(g, slope, t->x) || expr_is_zero(g, slope) || switch_in(g, u, t->x)) return 0;
  Expr root = expr_sub(g, expr_symbol(g, t->x)->node, expr_div(g, u, slope));
  Expr above = simplify(g, on_side(g, t->e, u, 1)), below = simplify(g, on_side(g, t->e, u, -1));
  if (expr_is_zero(g, above) && expr_is_zero(g, below)) return above;
  Expr degree = degree_in(t, expr_is_zero(g, above) ? below : above, u, slope);
  if (degree && (expr_is_zero(g, below) || degree == degree_in(t, below, u, slope))) {
    Num once = num_div(num_int(1), num_add(num_int(1), expr_number(g, degree)));
    return expr_scale(g, once, expr_div(g, expr_mul(g, u, t->e), slope));
  }
  for (int k = 0; k < 2; k++) {
    F[k] = whole_antiderivative(g, k ? below : above, *t, depth - 1);
    if (!F[k]) return 0;
    Expr there = expr_replace(g, F[k], &t->x, &root, 1), inner = switch_in(g, there, 0);
    int sign = !inner                                     ? 0
               : sign_is_nonnegative(expr_sign(g, inner)) ? 1
               : sign_is_nonpositive(expr_sign(g, inner)) ? -1
                                                          : 0;
    F[k] = expr_sub(g, F[k], sign ? on_side(g, there, inner, sign) : there);
  }
  return expr_select(g, expr_fn2(g, EX_LT, expr_int(g, 0), u), F[0], F[1]);
}

/* Integral of a term with a denominator that is linear in x, as polynomial and powers of the denominator, or 0. */
static Expr integral_by_division(const Task *t) {
  ExprGraph *g = t->g;
  ExprList nodes = expr_topo(g, &t->e, 1);
  for (uint32_t i = 0; i < nodes.n; i++) {
    Expr slope = expr_op(g, nodes.at[i]) == EX_SUM ? expr_diff(g, nodes.at[i], t->x) : 0,
         s = expr_symbol(g, t->s)->node;
    if (!slope || expr_is_zero(g, slope) || contains_any(g, slope, t->q, t->n)) continue;
    Expr there = expr_add(g, expr_symbol(g, t->x)->node, expr_div(g, expr_sub(g, s, nodes.at[i]), slope));
    Expr in_s = expr_replace(g, t->e, &t->x, &there, 1), whole = expr_integrate(g, in_s, t->s, 0);
    if (prove_zero(g, expr_sub(g, in_s, expr_diff(g, whole, t->s)), NULL) == PROVED_ZERO)
      return expr_div(g, expr_replace(g, whole, &t->s, &nodes.at[i], 1), slope);
  }
  return 0;
}

/* Integral of the terms of e that have switches or denominators, taken from e. */
static Expr integral_of_terms(ExprGraph *g, Task with, int depth, Expr *e) {
  Expr sum = expr_int(g, 0), all = *e;
  for (ExprPair term = {0}; expr_next_pair(g, all, EX_SUM, &term);) {
    with.e = expr_scale(g, term.num, term.of);
    Expr part = switch_in(g, with.e, with.x) ? integral_by_sides(&with, depth) : integral_by_division(&with);
    if (!part) continue;
    sum = expr_add(g, sum, part);
    *e = expr_sub(g, *e, with.e);
  }
  return sum;
}

/* e without definitions, and with roots in the place of hypot. */
static Expr in_powers(ExprGraph *g, Expr e) {
  VEC(Expr) node = {0}, root = {0};
  e = expr_expand_defs(g, e);
  ExprList l = expr_topo(g, &e, 1);
  for (uint32_t i = 0; i < l.n; i++) {
    if (expr_op(g, l.at[i]) != EX_HYPOT) continue;
    Expr xx = expr_pow_num(g, expr_arg(g, l.at[i], 0), num_int(2)),
         yy = expr_pow_num(g, expr_arg(g, l.at[i], 1), num_int(2));
    vec_push(expr_arena(g), &node, l.at[i]);
    vec_push(expr_arena(g), &root, expr_sqrt(g, expr_add(g, xx, yy)));
  }
  if (node.n) expr_replace_nodes(g, &e, 1, node.at, root.at, node.n, &e);
  return e;
}

/* Antiderivative of e by the forms above, by substitution, and on the sides of switches; *rest: the terms without
 * one. Of long expressions only the forms are tried, very long ones are given up, also those that grow so:
 * derivatives of what is found take minutes. */
static Expr antiderivative(ExprGraph *g, Expr e, Task with, int depth, Expr *rest) {
  enum { MOST = 64, LONGEST = 2000, NONE = 20000 };
  uint32_t distinct;
  const Expr whole = in_powers(g, e), none = expr_int(g, 0);
  double size = expr_tree_size(g, whole, &distinct);
  Expr sum = none;
  *rest = whole;
  for (uint32_t k = 0; k < MOST && size <= NONE && !expr_is_zero(g, *rest); k++) {
    with.e = *rest;
    Expr part = size > LONGEST ? 0 : integral_by_substitution(&with, 1);
    if (!part) part = expr_integrate(g, *rest, with.x, 0);
    if (expr_is_zero(g, part) && size <= LONGEST) part = integral_by_substitution(&with, 0);
    if (!part || expr_is_zero(g, part)) break;
    sum = expr_add(g, sum, part);
    *rest = expr_sub(g, *rest, expr_diff(g, part, with.x));
    size = expr_tree_size(g, *rest, &distinct) + expr_tree_size(g, sum, &distinct);
    if (size <= NONE) *rest = simplify(g, *rest);
    if (size <= LONGEST && prove_zero(g, *rest, NULL) == PROVED_ZERO) *rest = none;
  }
  if (size > NONE) return *rest = whole, none;
  Expr sides = expr_is_zero(g, *rest) ? *rest : integral_of_terms(g, with, depth, rest);
  return expr_add(g, sum, sides);
}

/* Takes the derivatives of a part of F from those that are left. */
static void take_part(ExprGraph *g, Expr part, const ExprMap *place, const SymId *q, Expr *left) {
  ExprList nodes = expr_topo(g, &part, 1);
  for (uint32_t k = 0; k < nodes.n; k++) {
    uint32_t i = expr_op(g, nodes.at[k]) == EX_SYM ? expr_map_get(place, nodes.at[k]) : 0;
    if (!i) continue;
    left[i - 1] = expr_sub(g, left[i - 1], expr_diff(g, part, q[i - 1]));
    if (switch_in(g, left[i - 1], 0) && zero_on_sides(g, left[i - 1])) left[i - 1] = expr_int(g, 0);
  }
}

Expr expr_potential(ExprGraph *g, const Expr *a, const SymId *q, uint32_t n, int by_substitution) {
  enum { SWITCHES_MOST = 4 };
  Expr *left = ARENA_ARRAY(expr_arena(g), Expr, 2 * (size_t)n + 1), *part = left + n, rest;
  ExprMap place = expr_map(expr_arena(g));
  Task with = {.g = g, .q = q, .n = n, .s = by_substitution ? expr_declare(g, SYM_LOCAL, 0, "?", SIGN_UNKNOWN) : 0};
  for (uint32_t i = 0; i < n; i++) left[i] = a[i], expr_map_set(&place, expr_symbol(g, q[i])->node, i + 1);
  for (uint32_t i = 0; i < n; i++) {
    with.x = q[i];
    part[i] = expr_is_zero(g, left[i]) ? left[i]
              : by_substitution        ? antiderivative(g, left[i], with, SWITCHES_MOST, &rest)
                                       : expr_integrate(g, left[i], q[i], 0);
    if (!expr_is_zero(g, part[i])) take_part(g, part[i], &place, q, left);
  }
  return expr_add_n(g, part, n);
}
