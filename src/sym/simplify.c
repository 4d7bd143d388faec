/* simplify: the normal form of an expression, written as briefly as possible.
 *
 * A numerator is a sum of terms number * parameters * dynamic part * circular functions. For each monomial of the
 * first three, the polynomial in circular functions takes its shortest form; then terms with the same functions of
 * the state are collected, which gives each a polynomial of parameters; then functions of the state with the same
 * parameter factor are collected. */
#include "sym/simplify.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>

#include "sym/expr_eval.h"
#include "sym/prove.h"
#include "sym/sum_nest.h"
#include "sym/trig_simplify.h"

enum { MAX_TERMS = 2000, MAX_WORK = 200000 };

/* number * parameters * e, where e is a function of the state */
typedef struct {
  Num c;
  MonoId params;
  Expr e;
} Piece;

typedef VEC(Piece) Pieces;

/* --- parameters --- */

/* Whether generator x is made of parameters only. */
static int gen_is_param(const Normal *n, GenId x) {
  GenInfo info = n->gens.at[x];
  return (info.kind == GEN_SYMBOL || info.kind == GEN_ROOT) && expr_is_constant(n->g, info.expr);
}

static int gen_is_circular(const Normal *n, GenId x) {
  return n->gens.at[x].kind == GEN_SIN || n->gens.at[x].kind == GEN_COS;
}

/* Part of a monomial whose generators are circular functions, or (circular 0) parameters or not. */
static MonoId mono_part(Normal *n, MonoId m, int circular, int param) {
  Mono mono = *mono_at(n->ring, m);
  MonoPow *part = ARENA_ARRAY(n->arena, MonoPow, mono.n + 1);
  uint32_t count = 0;
  for (uint32_t i = 0; i < mono.n; i++) {
    GenId x = mono.at[i].gen;
    if (gen_is_circular(n, x) != circular) continue;
    if (!circular && gen_is_param(n, x) != param) continue;
    part[count++] = mono.at[i];
  }
  return mono_of(n->ring, part, count);
}

/* --- factoring a polynomial of parameters --- */

/* A term seen as generator * cofactor. */
typedef struct {
  MonoId cofactor;
  uint32_t term;
} Split;

static int by_cofactor(const void *a, const void *b) {
  const Split *x = a, *y = b;
  if (x->cofactor != y->cofactor) return x->cofactor < y->cofactor ? -1 : 1;
  return (x->term > y->term) - (x->term < y->term);
}

/* Size of the largest group of terms with a common cofactor (not 1), a run of splits from *from; 0 if no two terms
 * share one. */
static uint32_t largest_group(Normal *n, const Term *t, uint32_t count, Split *splits, uint32_t *from) {
  uint32_t total = 0, best = 1;
  for (uint32_t i = 0; i < count; i++) {
    Mono m = *mono_at(n->ring, t[i].mono);
    for (uint32_t k = 0; k < m.n; k++) {
      MonoId rest = mono_without(n->ring, t[i].mono, m.at[k].gen);
      if (m.at[k].exp == 1 && rest != 0) splits[total++] = (Split){.cofactor = rest, .term = i};
    }
  }
  if (total > 1) qsort(splits, total, sizeof *splits, by_cofactor);
  for (uint32_t i = 0, end; i < total; i = end) {
    for (end = i; end < total && splits[end].cofactor == splits[i].cofactor;) end++;
    if (end - i <= best) continue;
    best = end - i;
    *from = i;
  }
  return best > 1 ? best : 0;
}

/* FactorRecord form of a polynomial of parameters: m1*l1^2 + m2*l1^2 + m2*l2^2 becomes (m1 + m2)*l1^2 + m2*l2^2. */
static Expr params_expr(Normal *n, Poly p) {
  enum { MAX_FACTORED = 64 };
  ExprGraph *g = n->g;
  Term *left = ARENA_ARRAY(n->arena, Term, p.n + 1), *group = ARENA_ARRAY(n->arena, Term, p.n + 1);
  uint32_t count = p.n, parts = 0, from = 0, pairs = 0;
  for (uint32_t i = 0; i < p.n; i++) pairs += mono_at(n->ring, p.at[i].mono)->n;
  Split *splits = ARENA_ARRAY(n->arena, Split, pairs + 1);
  Expr *part = ARENA_ARRAY(n->arena, Expr, p.n + 1);
  if (count) memcpy(left, p.at, count * sizeof *left);
  for (uint32_t size; count <= MAX_FACTORED && (size = largest_group(n, left, count, splits, &from)) > 0;) {
    MonoId m = splits[from].cofactor, inverse = mono_pow(n->ring, m, -1);
    for (uint32_t i = 0; i < size; i++) {
      Term *t = &left[splits[from + i].term];
      group[i] = (Term){.mono = mono_mul(n->ring, t->mono, inverse), .c = t->c};
      t->c = num_int(0);
    }
    Poly inner = poly_collect(n->ring, group, size);
    Expr sum = normal_poly_expr(n, inner), outer = normal_mono_expr(n, m);
    part[parts++] = expr_mul(g, outer, sum);
    uint32_t kept = 0;
    for (uint32_t i = 0; i < count; i++)
      if (!num_is_zero(left[i].c)) left[kept++] = left[i];
    count = kept;
  }
  part[parts++] = normal_poly_expr(n, (Poly){.at = left, .n = count});
  return expr_add_n(g, part, parts);
}

/* --- numerators into pieces --- */

/* Appends the piece c * params * e; a number in e is moved into c. */
static void push_piece(Normal *n, Pieces *out, Num c, MonoId params, Expr e) {
  if (expr_is_num(n->g, e)) {
    c = num_mul(c, expr_number(n->g, e));
    e = expr_int(n->g, 1);
  } else if (expr_pairs(n->g, e, EX_SUM) == 1) {
    Num k;
    e = expr_pair(n->g, e, EX_SUM, 0, &k);
    c = num_mul(c, k);
  }
  if (!num_is_exact(c)) poly_fail(n->ring, POLY_INEXACT);
  vec_push(n->arena, out, ((Piece){.c = c, .params = params, .e = e}));
}

typedef struct {
  MonoId rest; /* the monomial without circular functions */
  Term circular;
} Sorted;

static int by_rest(const void *a, const void *b) {
  const Sorted *x = a, *y = b;
  if (x->rest != y->rest) return x->rest < y->rest ? -1 : 1;
  return (x->circular.mono > y->circular.mono) - (x->circular.mono < y->circular.mono);
}

static Sorted *sort_terms(Normal *n, Poly p) {
  Sorted *s = ARENA_ARRAY(n->arena, Sorted, p.n + 1);
  for (uint32_t i = 0; i < p.n; i++) {
    MonoId params = mono_part(n, p.at[i].mono, 0, 1), state = mono_part(n, p.at[i].mono, 0, 0);
    MonoId circular = mono_part(n, p.at[i].mono, 1, 0);
    s[i].rest = mono_mul(n->ring, params, state);
    s[i].circular = (Term){.mono = circular, .c = p.at[i].c};
  }
  if (p.n > 1) qsort(s, p.n, sizeof *s, by_rest);
  return s;
}

static Pieces pieces_of(Normal *n, Poly p) {
  Pieces out = {0};
  Sorted *s = sort_terms(n, p);
  Term *group = ARENA_ARRAY(n->arena, Term, p.n + 1);
  for (uint32_t i = 0; i < p.n && n->ring->status == POLY_OK;) {
    MonoId rest = s[i].rest;
    uint32_t size = 0;
    while (i < p.n && s[i].rest == rest) group[size++] = s[i++].circular;
    Poly circular = poly_collect(n->ring, group, size);
    if (circular.n == 0) continue;
    TrigForm f = trig_simplify(n, circular);
    MonoId params = mono_part(n, rest, 0, 1), state = mono_part(n, rest, 0, 0);
    Expr factor = normal_mono_expr(n, state);
    for (uint32_t k = 0; k < f.n; k++) push_piece(n, &out, f.at[k].c, params, expr_mul(n->g, factor, f.at[k].e));
  }
  return out;
}

/* --- collecting --- */

/* content * mono * prim * e: the sum of all pieces with the function e. */
typedef struct {
  PolyId prim;
  MonoId mono;
  Num content;
  Expr e;
} Group;

static int by_function(const void *a, const void *b) {
  const Piece *x = a, *y = b;
  if (x->e != y->e) return x->e < y->e ? -1 : 1;
  return (x->params > y->params) - (x->params < y->params);
}

static int by_params(const void *a, const void *b) {
  const Group *x = a, *y = b;
  if (x->prim != y->prim) return x->prim < y->prim ? -1 : 1;
  if (x->mono != y->mono) return x->mono < y->mono ? -1 : 1;
  return (x->e > y->e) - (x->e < y->e);
}

static Group *groups_of(Normal *n, Pieces pieces, uint32_t *count) {
  Group *groups = ARENA_ARRAY(n->arena, Group, pieces.n + 1);
  Term *params = ARENA_ARRAY(n->arena, Term, pieces.n + 1);
  if (pieces.n > 1) qsort(pieces.at, pieces.n, sizeof *pieces.at, by_function);
  *count = 0;
  for (uint32_t i = 0; i < pieces.n && n->ring->status == POLY_OK;) {
    Group one = {.e = pieces.at[i].e};
    uint32_t size = 0;
    for (; i < pieces.n && pieces.at[i].e == one.e; i++)
      params[size++] = (Term){.mono = pieces.at[i].params, .c = pieces.at[i].c};
    Poly p = poly_collect(n->ring, params, size);
    if (p.n == 0) continue;
    Poly prim = poly_primitive(n->ring, p, &one.content, &one.mono);
    one.prim = poly_intern(n->ring, prim);
    groups[(*count)++] = one;
  }
  if (*count > 1) qsort(groups, *count, sizeof *groups, by_params);
  return groups;
}

/* Exponent of base in the product e; 0 if absent. */
static Num exponent_in(const ExprGraph *g, Expr e, Expr base) {
  for (uint32_t i = 0; i < expr_pairs(g, e, EX_PROD); i++) {
    Num k;
    if (expr_pair(g, e, EX_PROD, i, &k) == base) return k;
  }
  return num_int(0);
}

/* Common factor of the groups' functions of the state: each base with the exponent nearest to 0. */
static Expr common_factor(ExprGraph *g, const Group *at, uint32_t count) {
  Expr common = expr_int(g, 1);
  for (uint32_t i = 0; i < expr_pairs(g, at[0].e, EX_PROD); i++) {
    Num e;
    Expr base = expr_pair(g, at[0].e, EX_PROD, i, &e);
    if (expr_is_num(g, base)) continue;
    for (uint32_t k = 1; k < count; k++) {
      Num other = exponent_in(g, at[k].e, base);
      if (num_sign(other) != num_sign(e)) e = num_int(0);
      else if (num_cmp(num_abs(other), num_abs(e)) < 0) e = other;
    }
    Expr power = expr_pow_num(g, base, e);
    common = expr_mul(g, common, power);
  }
  return common;
}

/* Sum of the groups with one parameter factor: factor * common * (sum of the remaining functions). */
static Expr run_expr(Normal *n, const Group *at, uint32_t count) {
  ExprGraph *g = n->g;
  Expr mono = normal_mono_expr(n, at->mono), prim = params_expr(n, poly_at(n->ring, at->prim));
  Expr common = common_factor(g, at, count), inverse = expr_pow_num(g, common, num_int(-1));
  Expr *rest = ARENA_ARRAY(n->arena, Expr, count);
  for (uint32_t i = 0; i < count; i++) {
    Expr e = expr_mul(g, at[i].e, inverse);
    rest[i] = expr_scale(g, at[i].content, e);
  }
  Expr sum = expr_add_n(g, rest, count);
  Expr factors[4] = {mono, prim, common, sum};
  return expr_mul_n(g, factors, 4);
}

static Expr poly_expr(Normal *n, Poly p) {
  if (p.n == 0) return expr_int(n->g, 0);
  uint32_t count;
  Pieces pieces = pieces_of(n, p);
  Group *groups = groups_of(n, pieces, &count);
  Expr *part = ARENA_ARRAY(n->arena, Expr, count + 1);
  uint32_t parts = 0;
  for (uint32_t i = 0, end; i < count; i = end) {
    for (end = i; end < count && groups[end].prim == groups[i].prim && groups[end].mono == groups[i].mono;) end++;
    part[parts++] = run_expr(n, groups + i, end - i);
  }
  return expr_add_n(n->g, part, parts);
}

/* --- fractions --- */

typedef struct {
  ExprGraph *g;
  Expr e, result;
  int shallow;
} Task;

static void work(Arena *scratch, void *data) {
  Task *t = data;
  Normal *n =
      normal_new(t->g, scratch,
                 (NormalLimits){.max_terms = MAX_TERMS, .max_work = MAX_WORK, .shallow = t->shallow, .keep_range = 1});
  Frac f;
  if (normal_run(n, &t->e, 1, &f) != POLY_OK) return;
  Frac smaller = frac_cancel(n->field, f);
  Expr e = normal_expr_by(n, smaller, poly_expr);
  if (n->ring->status == POLY_OK) t->result = e;
}

/* --- range --- */

typedef struct {
  const ExprGraph *g;
  uint32_t seed;
  long double scale;
} FarState;

static int moves(const ExprGraph *g, SymId s) {
  return (1u << expr_symbol(g, s)->kind &
          (1u << SYM_COORD | 1u << SYM_STATE | 1u << SYM_TIME | 1u << SYM_VEL | 1u << SYM_LOCAL)) != 0;
}

/* Puts a symbol for each long sum: a rewritten node has the sums it had, and their terms are many. */
static void close_sums(ExprGraph *g, Expr *e, uint32_t n) {
  VEC(Expr) cells = {0}, symbols = {0};
  ExprList l = expr_topo_to_sums(g, e, n);
  for (uint32_t k = 0; k < l.n; k++) {
    if (expr_op(g, l.at[k]) != EX_CELL) continue;
    Expr symbol = expr_named_symbol(g, arena_printf(expr_arena(g), "sum %u", cells.n + 1));
    vec_push(expr_arena(g), &cells, l.at[k]);
    vec_push(expr_arena(g), &symbols, symbol);
  }
  expr_list_free(g, l);
  if (cells.n) expr_replace_nodes(g, e, n, cells.at, symbols.at, cells.n, e);
}

static long double far_symbol(SymId s, const void *data) {
  const FarState *at = data;
  return sample_symbol(at->g, s, at->seed) * (moves(at->g, s) ? at->scale : 1);
}

/* Whether `after` is finite wherever `before` is, in doubles; tested at random states near and far from the origin. */
static int keeps_range(ExprGraph *g, Expr before, Expr after) {
  static const long double scales[] = {1, 20, 60, 180, 400, 700, 2000, 20000};
  enum { SCALES = sizeof scales / sizeof *scales, SEEDS = 3 };
  Expr both[2] = {before, after};
  int risky = ((expr_traits(g, before) | expr_traits(g, after)) & HAS_GROWTH) != 0, keeps = 1;
  if (risky) close_sums(g, both, 2);
  EvalTape *t = risky ? eval_tape(g, both, 2) : NULL;
  for (uint32_t k = 0; risky && keeps && k < SCALES * SEEDS; k++) {
    FarState at = {.g = g, .seed = 1 + k, .scale = scales[k / SEEDS]};
    long double value[2];
    eval_run_double(t, far_symbol, &at, value);
    keeps = !isfinite(value[0]) || isfinite(value[1]);
  }
  if (t) eval_tape_free(g, t);
  return keeps;
}

static Expr rewritten(ExprGraph *g, Expr e, int shallow) {
  if (!e || expr_nargs(g, e) == 0) return e;
  Task t = {.g = g, .e = e, .result = e, .shallow = shallow};
  arena_with_scratch(expr_arena(g), work, &t);
  return t.result;
}

static int has_definitions(ExprGraph *g, Expr e) {
  ExprList nodes = expr_topo(g, &e, 1);
  uint32_t i = 0;
  while (i < nodes.n && expr_op(g, nodes.at[i]) != EX_DEF) i++;
  expr_list_free(g, nodes);
  return i < nodes.n;
}

/* --- digits --- */

/* Roots of a tape: the form before, the form after, and divisors of both. */
enum { BEFORE, AFTER, ROOTS_MOST = 5 };

/* Doubles between two random states, or between the origin and one. */
typedef struct {
  const ExprGraph *g;
  uint32_t seed;
  int from_origin;
  long double part;
} Between;

static long double symbol_between(SymId s, const void *data) {
  const Between *at = data;
  long double one = sample_symbol(at->g, s, at->seed), from = at->from_origin ? 0 : one;
  return (double)(moves(at->g, s) ? from + at->part * (sample_symbol(at->g, s, at->seed + 7) - from) : one);
}

/* Value of a root of the tape at a part of the way. */
static long double value_between(EvalTape *t, Between at, int root, long double part) {
  long double out[ROOTS_MOST];
  at.part = part;
  eval_run_double(t, symbol_between, &at, out);
  return out[root];
}

/* Whether the form after is much less precise in doubles than that before at this place. */
static int loses_digits(EvalTape *t, const Between *at, long double *symbols) {
  long double exact[ROOTS_MOST], is[ROOTS_MOST];
  for (SymId s = 1; s <= expr_symbol_count(at->g); s++) symbols[s] = symbol_between(s, at);
  eval_run(t, symbols, exact);
  eval_run_double(t, symbol_between, at, is);
  long double before = fabsl(is[BEFORE] - exact[BEFORE]), after = fabsl(is[AFTER] - exact[AFTER]),
              rounding = 64 * DBL_EPSILON * fabsl(exact[BEFORE]);
  return after > rounding && after > 1000 * before;
}

/* Whether digits are lost beside a zero of a root, between random states. */
static int loses_beside_zeros(EvalTape *t, Between at, int root, long double *symbols) {
  enum { PARTS = 4, HALVINGS = 30 };
  const long double beside = 1e-6L;
  for (int k = 0; k < PARTS; k++) {
    long double lo = (long double)k / PARTS, hi = (long double)(k + 1) / PARTS, first = value_between(t, at, root, lo);
    if (!(first * value_between(t, at, root, hi) < 0)) continue;
    for (int i = 0; i < HALVINGS; i++) {
      long double half = (lo + hi) / 2;
      *(first * value_between(t, at, root, half) > 0 ? &lo : &hi) = half;
    }
    at.part = lo - beside;
    if (loses_digits(t, &at, symbols)) return 1;
  }
  return 0;
}

/* Whether digits are lost beside the origin, where distances are 0. */
static int loses_beside_origin(EvalTape *t, ExprGraph *g, long double *symbols) {
  enum { FEW = 4 };
  Between at = {.g = g, .from_origin = 1};
  for (at.part = 1e-3L; at.part > 1e-7L; at.part /= 1000)
    for (at.seed = 1; at.seed <= FEW; at.seed++)
      if (loses_digits(t, &at, symbols)) return 1;
  return 0;
}

/* root[n..] := divisors among these nodes that vary. Returns the number of roots. */
static int add_divisors(ExprGraph *g, ExprList nodes, Expr *root, int n) {
  for (uint32_t i = 0; i < nodes.n; i++)
    for (uint32_t k = 0; expr_op(g, nodes.at[i]) == EX_PROD && k < expr_pairs(g, nodes.at[i], EX_PROD); k++) {
      Num power;
      Expr base = expr_pair(g, nodes.at[i], EX_PROD, k, &power);
      int known = num_sign(power) >= 0 || n == ROOTS_MOST;
      for (int r = 2; r < n; r++) known |= root[r] == base;
      if (!known) root[n++] = base;
    }
  return n;
}

/* Whether `after` has the digits of `before`: of a product beside its zeros, 2*cos(1 + u/2)*sin(u/2) has more than
 * sin(1 + u) - sin(1); beside zeros of divisors, sin(u/2)^2/u more than (1 - cos(u))/(2*u). */
static int keeps_digits(ExprGraph *g, Expr before, Expr after) {
  enum { LINES = 12, LINES_DIVISOR = 4, NODES_MOST = 120 };
  Expr root[ROOTS_MOST] = {before, after};
  ExprList nodes = expr_topo_few(g, root, 2, NODES_MOST);
  int few = nodes.n <= NODES_MOST, n = few ? add_divisors(g, nodes, root, 2) : 2,
      product = expr_pairs(g, before, EX_SUM) <= 1, loses = 0;
  expr_list_free(g, nodes);
  if (!few || (!product && n == 2)) return 1;
  EvalTape *t = eval_tape(g, root, (uint32_t)n);
  uint32_t nsymbols = expr_symbol_count(g) + 1;
  long double *symbols = ARENA_ARRAY(expr_arena(g), long double, nsymbols);
  for (int r = product ? AFTER : AFTER + 1; r < n && !loses; r++)
    for (Between at = {.g = g, .seed = 1}; at.seed <= (r == AFTER ? LINES : LINES_DIVISOR) && !loses; at.seed++)
      loses = loses_beside_zeros(t, at, r, symbols);
  loses = loses || (n > 2 && loses_beside_origin(t, g, symbols));
  arena_release(expr_arena(g), symbols, nsymbols * sizeof *symbols);
  eval_tape_free(g, t);
  return !loses;
}

/* The new form s if it keeps the range and, with its half angles, the digits of e; else e. */
static Expr if_good(ExprGraph *g, Expr e, Expr s) {
  return s == e || (keeps_range(g, e, s) && keeps_digits(g, e, simplify_stable_quotients(g, s, e))) ? s : e;
}

Expr simplify(ExprGraph *g, Expr e) {
  Expr s = rewritten(g, e, 0);
  uint32_t before = expr_ops(g, &e, 1), after = expr_ops(g, &s, 1);
  if (after > before || (after == before && !has_definitions(g, e))) return e;
  return if_good(g, e, s);
}

Expr simplify_shallow(ExprGraph *g, Expr e) {
  Expr s = rewritten(g, e, 1);
  uint32_t before = expr_ops_shallow(g, e), after = expr_ops_shallow(g, s);
  return after < before ? if_good(g, e, s) : e;
}
