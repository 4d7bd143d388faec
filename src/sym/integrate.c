/* Antiderivatives term by term, from the normal form of the integrand; potentials from their gradients. */
#include "sym/integrate.h"

#include "sym/diff.h"
#include "sym/normal_form.h"
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
 *   int x^k exp(u) sin(w) = (x^k exp(u) (a sin w - b cos w) - k (a S - b C))/(a^2 + b^2), S and C the integrals for k - 1. */
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
    Expr one = expr_int(g, 1), new_sine = combine(g, front, sine, one, old_sine), new_cosine = combine(g, front, cosine, one, old_cosine);
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

/* factor of c = factor du/dx, where e has the term c u^power: free of q, or 0. s: a symbol that stands for u. */
static Expr factor_of_power(const Task *t, Expr u, Num power, SymId s, const SymId *q, uint32_t n) {
  ExprGraph *g = t->g;
  Expr slope = expr_diff(g, u, t->x), node = expr_symbol(g, s)->node, in_s;
  if (expr_op(g, u) != EX_SUM || expr_is_zero(g, slope)) return 0;
  expr_replace_nodes(g, &t->e, 1, &u, &node, 1, &in_s);
  Expr flat = expr_pow_num(g, node, num_sub(num_int(1), power)), c = expr_mul(g, expr_diff(g, in_s, s), flat);
  Expr factor = simplify(g, expr_div(g, expr_scale(g, num_div(num_int(1), power), c), slope));
  return expr_contains_sym(g, factor, s) || contains_any(g, factor, q, n) ? 0 : factor;
}

/* Integral of f(u) by u; 0: it is not in this list. */
static Expr integral_of_function(ExprGraph *g, ExprOp f, Expr u) {
  static const ExprOp integral[][2] = {{EX_EXP, EX_EXP}, {EX_COS, EX_SIN}, {EX_SINH, EX_COSH}, {EX_COSH, EX_SINH}};
  for (size_t i = 0; i < sizeof integral / sizeof *integral; i++)
    if (f == integral[i][0]) return expr_fn(g, integral[i][1], u);
  return f == EX_SIN ? expr_neg(g, expr_fn(g, EX_COS, u)) : 0;
}

/* Integral by t->x of one term c f(u) of t->e in which c is du/dx times a constant, or 0. */
static Expr integral_of_call(const Task *t, Expr call, SymId s, const SymId *q, uint32_t n) {
  ExprGraph *g = t->g;
  Expr whole = integral_of_function(g, expr_op(g, call), expr_arg(g, call, 0)), node = expr_symbol(g, s)->node, in_s;
  Expr slope = whole ? expr_diff(g, expr_arg(g, call, 0), t->x) : 0;
  if (!whole || expr_is_zero(g, slope)) return 0;
  expr_replace_nodes(g, &t->e, 1, &call, &node, 1, &in_s);
  Expr factor = simplify(g, expr_div(g, expr_diff(g, in_s, s), slope));
  int constant = !expr_is_zero(g, factor) && !expr_contains_sym(g, factor, s) && !contains_any(g, factor, q, n);
  return constant ? expr_mul(g, factor, whole) : 0;
}

/* Integral by t->x of one term c u^power of t->e in which c is du/dx times a constant, as of x/(x^2 + y^2)^(3/2), or 0. */
static Expr integral_by_substitution(const Task *t, SymId s, const SymId *q, uint32_t n) {
  ExprList nodes = expr_topo(t->g, &t->e, 1);
  for (uint32_t i = 0; i < nodes.n; i++) {
    ExprOp op = expr_op(t->g, nodes.at[i]);
    int call = op != EX_SYM && op != EX_NUM && op != EX_PROD && op != EX_SUM && expr_nargs(t->g, nodes.at[i]) == 1;
    Expr whole = call ? integral_of_call(t, nodes.at[i], s, q, n) : 0;
    if (whole) return whole;
    for (uint32_t k = 0; op == EX_PROD && k < expr_pairs(t->g, nodes.at[i], op); k++) {
      Num power;
      Expr u = expr_pair(t->g, nodes.at[i], op, k, &power), factor = factor_of_power(t, u, power, s, q, n);
      if (factor && !expr_is_zero(t->g, factor)) return expr_mul(t->g, factor, integral_of_power(t->g, u, power));
    }
  }
  return 0;
}

/* Antiderivative of e by x by the forms above, then by substitution. */
static Expr antiderivative(ExprGraph *g, Expr e, SymId x, const SymId *q, uint32_t n) {
  enum { MOST = 64, LONGEST = 2000 };
  uint32_t distinct;
  Expr sum = expr_integrate(g, e, x, 0);
  if (expr_tree_size(g, e, &distinct) > LONGEST) return sum;
  Expr rest = expr_sub(g, e, expr_diff(g, sum, x));
  SymId s = expr_is_zero(g, simplify(g, rest)) ? 0 : expr_declare(g, SYM_LOCAL, 0, "?", SIGN_UNKNOWN);
  for (uint32_t k = 0; k < MOST && s; k++) {
    Task t = {.g = g, .e = expr_expand_defs(g, rest), .x = x};
    Expr part = integral_by_substitution(&t, s, q, n);
    if (!part) break;
    sum = expr_add(g, sum, part);
    rest = expr_sub(g, t.e, expr_diff(g, part, x));
  }
  return sum;
}

/* Takes the derivatives of a part of F from those that are left. */
static void take_part(ExprGraph *g, Expr part, const ExprMap *place, const SymId *q, Expr *left) {
  ExprList nodes = expr_topo(g, &part, 1);
  for (uint32_t k = 0; k < nodes.n; k++) {
    uint32_t i = expr_op(g, nodes.at[k]) == EX_SYM ? expr_map_get(place, nodes.at[k]) : 0;
    if (i) left[i - 1] = expr_sub(g, left[i - 1], expr_diff(g, part, q[i - 1]));
  }
}

Expr expr_potential(ExprGraph *g, const Expr *a, const SymId *q, uint32_t n, int by_substitution) {
  Expr *left = ARENA_ARRAY(expr_arena(g), Expr, 2 * (size_t)n + 1), *part = left + n;
  ExprMap place = expr_map(expr_arena(g));
  for (uint32_t i = 0; i < n; i++) left[i] = a[i], expr_map_set(&place, expr_symbol(g, q[i])->node, i + 1);
  for (uint32_t i = 0; i < n; i++) {
    part[i] = expr_is_zero(g, left[i]) ? left[i] : by_substitution ? antiderivative(g, left[i], q[i], q, n) : expr_integrate(g, left[i], q[i], 0);
    if (!expr_is_zero(g, part[i])) take_part(g, part[i], &place, q, left);
  }
  return expr_add_n(g, part, n);
}
