/* Derivatives of graph nodes: partial derivatives by argument, a forward sweep (tangents) and a reverse sweep
 * (adjoints). */
#include "sym/diff.h"

#include <stdlib.h>

#include "sym/expr_impl.h"
#include "sym/sum_diff.h"
#include "sym/sum_nest.h"

/* The partial derivative of node e with respect to its argument i (pairs: the i-th term or base). */
static Expr partial_pair(ExprGraph *g, Expr e, uint32_t i) {
  Num k;
  ExprOp op = expr_op(g, e);
  Expr x = expr_pair(g, e, op, i, &k);
  if (op == EX_SUM) return expr_num(g, k);
  Expr inverse = expr_pow_num(g, x, num_int(-1));
  Expr p = expr_mul(g, e, inverse); /* the whole product over x */
  return expr_scale(g, k, p);
}

static Expr square(ExprGraph *g, Expr a) { return expr_pow_num(g, a, num_int(2)); }

/* The words of the column `derivative` of functions.def: one argument is a call at most, so that C orders the nodes. */
#define FN(op) expr_fn(g, EX_##op, x)
#define NEG(a) expr_neg(g, a)
#define SQUARE(a) square(g, a)
#define ONE_PLUS(a) expr_add(g, g->one, a)
#define ONE_LESS(a) expr_sub(g, g->one, a)
#define POWER(a, n, d) expr_pow_num(g, a, num_ratio(n, d))
#define THIRD(a) expr_scale(g, num_ratio(1, 3), a)
#define DERIVATIVE(OP, name, latex, symmetry, at_0, sign, proof, slope, derivative) case EX_##OP: return derivative;

/* df/dx of f = f(x). */
static Expr partial_unary(ExprGraph *g, Expr f, Expr x) {
  switch (expr_op(g, f)) {
    FUNCTIONS(DERIVATIVE)
    case EX_DEF: return g->one;
    case EX_ABS: return expr_fn(g, EX_SIGN, x);
    case EX_SIGN: case EX_FLOOR: case EX_NOT: return g->zero;
    case EX_NUM: case EX_SYM: case EX_SUM: case EX_PROD: case EX_NEST: case EX_CELL: case EX_POW: case EX_ATAN2:
    case EX_HYPOT: case EX_MIN: case EX_MAX: case EX_LT: case EX_LE: case EX_EQ: case EX_AND: case EX_OR:
    case EX_SELECT: case EX_COUNT: break;
  }
  return g->zero;
}

/* d(b^x)/db = x b^(x - 1), which has a value at b = 0; d(b^x)/dx = b^x log b. */
static Expr partial_pow(ExprGraph *g, Expr e, Expr b, Expr x, uint32_t i) {
  if (i == 0) {
    Expr less = expr_sub(g, x, g->one), power = expr_pow(g, b, less);
    return expr_mul(g, x, power);
  }
  Expr log = expr_fn(g, EX_LOG, b);
  return expr_mul(g, e, log);
}

/* atan2(y, x): dy -> x/(x^2 + y^2), dx -> -y/(x^2 + y^2). */
static Expr partial_atan2(ExprGraph *g, Expr y, Expr x, uint32_t i) {
  Expr xx = square(g, x), yy = square(g, y);
  Expr rr = expr_add(g, xx, yy);
  Expr top = i == 0 ? x : expr_neg(g, y);
  return expr_div(g, top, rr);
}

/* --- quantified sums --- */

/* Derivatives of the shares of a nest by its reads: SumNest.slopes. */
static void make_slopes(ExprGraph *g, Expr cell) {
  uint32_t number = expr_nest_number(g, expr_cell_nest(g, cell));
  SumNest s = g->nests.at[number - 1];
  if (s.slopes) return;
  SymId *syms = ARENA_ARRAY(g->arena, SymId, s.nreads + 1);
  Expr *d = ARENA_ARRAY(g->arena, Expr, (size_t)s.nreads * s.nshares + 1);
  for (uint32_t k = 0; k < s.nreads; k++) syms[k] = s.reads[k].symbol;
  for (uint32_t n = 0; n < s.nshares; n++)
    expr_gradient(g, s.shares[n].value, syms, s.nreads, d + (size_t)n * s.nreads);
  g->nests.at[number - 1].slopes = d;
}

/* Makes the derivatives of sums; those that would have too many cells are written out in the roots. */
static void prepare_sums(ExprGraph *g, const Expr *cells, uint32_t ncells, int forward, Expr *roots, uint32_t n) {
  VEC(Expr) several = {0};
  for (uint32_t k = 0; k < ncells; k++) {
    make_slopes(g, cells[k]);
    if (!expr_prepare_sum(g, cells[k], forward)) vec_push(g->arena, &several, cells[k]);
  }
  for (uint32_t k = 0; k < several.n; k++)
    g->writes_sums_out |= expr_sum_nest(g, expr_cell_nest(g, several.at[k]))->sampled;
  expr_write_out(g, roots, n, several.at, several.n, roots);
}

/* The roots, all sums below them prepared for rates. */
static Expr *with_rates(ExprGraph *g, const Expr *of, uint32_t n) {
  VEC(Expr) cells = {0};
  Expr *roots = ARENA_ARRAY(g->arena, Expr, n + 1);
  if (n) memcpy(roots, of, n * sizeof *of);
  ExprList l = g->nests.n ? expr_topo(g, roots, n) : (ExprList){0};
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(g, l.at[k]) == EX_CELL) vec_push(g->arena, &cells, l.at[k]);
  if (l.at) expr_list_free(g, l);
  prepare_sums(g, cells.at, cells.n, 1, roots, n);
  return roots;
}

static Expr partial_binary(ExprGraph *g, Expr e, uint32_t i) {
  Expr a = expr_arg(g, e, 0), b = expr_arg(g, e, 1);
  switch (expr_op(g, e)) {
    case EX_POW: return partial_pow(g, e, a, b, i);
    case EX_ATAN2: return partial_atan2(g, a, b, i);
    case EX_HYPOT: return expr_div(g, i == 0 ? a : b, e);
    case EX_NUM:
    case EX_MIN:
    case EX_MAX:
    case EX_SELECT: /* choices, see below */
    case EX_SYM:
    case EX_DEF:
    case EX_SUM:
    case EX_NEST:
    case EX_CELL: /* expr_sum_partials */
    case EX_PROD: EX_FUNCTION_CASES
    case EX_ABS: case EX_SIGN: case EX_FLOOR: case EX_LT: case EX_LE:
    case EX_EQ: case EX_NOT: case EX_AND: case EX_OR: case EX_COUNT: break;
  }
  return g->zero;
}

/* Whether e is log|u|: a function of u, whose slope is 1/u. */
static int is_log_of_size(ExprGraph *g, Expr e) {
  return expr_op(g, e) == EX_LOG && expr_op(g, expr_arg(g, e, 0)) == EX_ABS;
}

/* Number of arguments of e that are nodes to differentiate; coefficients and exponents do not count. */
static uint32_t inputs(ExprGraph *g, Expr e) {
  ExprOp op = expr_op(g, e);
  if (op == EX_NEST || op == EX_CELL) return 0; /* cells differentiate by the arguments of their nest */
  return op == EX_SUM || op == EX_PROD ? expr_pairs(g, e, op) : expr_nargs(g, e);
}

static Expr input(ExprGraph *g, Expr e, uint32_t i) {
  ExprOp op = expr_op(g, e);
  if (is_log_of_size(g, e)) return expr_arg(g, expr_arg(g, e, 0), 0);
  return expr_arg(g, e, op == EX_SUM || op == EX_PROD ? 2 * i : i);
}

static Expr partial(ExprGraph *g, Expr e, uint32_t i) {
  ExprOp op = expr_op(g, e);
  if (op == EX_SUM || op == EX_PROD) return partial_pair(g, e, i);
  return expr_nargs(g, e) == 1 ? partial_unary(g, e, input(g, e, 0)) : partial_binary(g, e, i);
}

/* --- choices: if, min, max. Their derivative is that of the side that holds; a factor of 0 would not do, as the
 * other side's may have no value there. --- */

/* A choice of two sides among the inputs of e. */
typedef struct {
  Expr condition;
  uint32_t yes, no;
} Choice;

/* Whether e is one; then *c. */
static int is_choice(ExprGraph *g, Expr e, Choice *c) {
  ExprOp op = expr_op(g, e);
  if (op == EX_SELECT) *c = (Choice){expr_arg(g, e, 0), 1, 2};
  else if (op == EX_MIN) *c = (Choice){expr_fn2(g, EX_LT, expr_arg(g, e, 0), expr_arg(g, e, 1)), 0, 1};
  else if (op == EX_MAX) *c = (Choice){expr_fn2(g, EX_LT, expr_arg(g, e, 0), expr_arg(g, e, 1)), 1, 0};
  else return 0;
  return 1;
}

enum { NESTED_CHOICES = 16 };

/* p*x, inside the sides of a choice x that is 0 on the other side, or of such terms of a sum; deeper than `depth`
 * choices in one another, a product. */
static Expr times_chosen(ExprGraph *g, Expr p, Expr x, int depth) {
  Num k;
  if (depth == 0) return expr_mul(g, p, x);
  if (expr_op(g, x) == EX_SELECT && (expr_arg(g, x, 1) == g->zero || expr_arg(g, x, 2) == g->zero)) {
    Expr condition = expr_arg(g, x, 0), yes = times_chosen(g, p, expr_arg(g, x, 1), depth - 1);
    Expr no = times_chosen(g, p, expr_arg(g, x, 2), depth - 1);
    return expr_select(g, condition, yes, no);
  }
  uint32_t n = expr_pairs(g, x, EX_SUM);
  int chosen = 0;
  for (uint32_t i = 0; i < n; i++) chosen |= expr_op(g, expr_pair(g, x, EX_SUM, i, &k)) == EX_SELECT;
  if (!chosen || (n == 1 && expr_op(g, x) == EX_SELECT)) return expr_mul(g, p, x);
  Expr sum = g->zero;
  for (uint32_t i = 0; i < n; i++) {
    Expr term = expr_pair(g, x, EX_SUM, i, &k), product = times_chosen(g, p, term, depth - 1),
         scaled = expr_scale(g, k, product);
    sum = expr_add(g, sum, scaled);
  }
  return sum;
}

/* Makes a sum or a long product a definition named after the definition it belongs to, so that the derivative of a
 * chain of lets stays as long as the chain. */
static Expr name_long_expr(ExprGraph *g, Name name, Expr body) {
  enum { LONG_PRODUCT = 8 };
  Num c;
  int sum = expr_pairs(g, body, EX_SUM) > 1;
  if (!sum && expr_pairs(g, expr_pair(g, body, EX_SUM, 0, &c), EX_PROD) < LONG_PRODUCT) return body;
  Name full = intern(g->names, arena_printf(g->arena, "d_%s", name));
  return expr_def_unique(g, full, body);
}

/* --- forward --- */

typedef VEC(Expr) Terms;

/* Adds a term; to the choice before it, if both have one condition: if(c, a, 0) + if(c, 0, b) is if(c, a, b). */
static void push_term(ExprGraph *g, Terms *t, Expr term) {
  Expr last = t->n ? t->at[t->n - 1] : g->zero;
  if (expr_op(g, last) != EX_SELECT || expr_op(g, term) != EX_SELECT || expr_arg(g, last, 0) != expr_arg(g, term, 0)) {
    vec_push(g->arena, t, term);
    return;
  }
  Expr yes = expr_add(g, expr_arg(g, last, 1), expr_arg(g, term, 1)),
       no = expr_add(g, expr_arg(g, last, 2), expr_arg(g, term, 2));
  t->at[t->n - 1] = expr_select(g, expr_arg(g, term, 0), yes, no);
}

static Expr add_terms(ExprGraph *g, const Terms *t) { return t->n ? expr_add_n(g, t->at, t->n) : g->zero; }

/* Terms of the tangent of a cell: of the only sum, its partial derivatives times rates; of several, a cell again.
 * rates: NEST -> the nest of its tangents, or itself where these are 0. */
static void cell_terms(ExprGraph *g, Expr cell, const ExprMap *dot, ExprMap *rates, Terms *terms) {
  Expr nest = expr_cell_nest(g, cell), rate = expr_map_get(rates, nest);
  if (expr_sum_nest(g, nest)->ncells > 1) {
    if (!rate) rate = expr_sum_rates(g, nest, dot);
    expr_map_set(rates, nest, rate ? rate : nest);
    if (rate && rate != nest) vec_push(g->arena, terms, expr_cell_of(g, rate, expr_cell_number(g, cell)));
    return;
  }
  SumPartials p = expr_sum_partials(g, cell, dot);
  for (uint32_t i = 0; i < p.n; i++) {
    Expr d = expr_map_get(dot, expr_sum_arg(g, nest, p.at[i].arg));
    if (!d || d == g->zero) continue;
    Expr term = times_chosen(g, p.at[i].value, d, NESTED_CHOICES);
    push_term(g, terms, term);
  }
}

/* Terms of the tangent of node e by the tangents of its inputs. */
static void tangent_terms(ExprGraph *g, Expr e, ExprMap *dot, Terms *terms) {
  Choice c;
  if (is_choice(g, e, &c)) {
    Expr yes = expr_map_get(dot, input(g, e, c.yes)), no = expr_map_get(dot, input(g, e, c.no));
    if (yes || no) vec_push(g->arena, terms, expr_select(g, c.condition, yes ? yes : g->zero, no ? no : g->zero));
    return;
  }
  for (uint32_t i = 0; i < inputs(g, e); i++) {
    Expr d = expr_map_get(dot, input(g, e, i));
    if (!d || d == g->zero) continue;
    Expr p = partial(g, e, i);
    Expr term = times_chosen(g, p, d, NESTED_CHOICES);
    push_term(g, terms, term);
  }
}

void expr_tangent(ExprGraph *g, const Expr *of, uint32_t n, ExprSeeds seed, const char *suffix, ExprMap *known,
                  Expr *out) {
  Expr *roots = with_rates(g, of, n);
  ExprList l = expr_topo_until(g, roots, n, known);
  ExprMap *dot = &g->work; /* node -> its tangent; absent: zero */
  expr_map_clear(dot);
  ExprMap rates = expr_map(g->arena);
  Terms terms = {0};
  for (uint32_t k = 0; k < l.n; k++) {
    Expr e = l.at[k];
    if (expr_op(g, e) == EX_SYM) {
      uint32_t s = expr_sym_id(g, e) - seed.first; /* of a symbol before the first: large */
      if (s < seed.n && seed.at[s]) expr_map_set(dot, e, seed.at[s]);
      continue;
    }
    Expr before = known ? expr_map_get(known, e) : 0;
    if (before) {
      expr_map_set(dot, e, before);
      continue;
    }
    terms.n = 0;
    tangent_terms(g, e, dot, &terms);
    if (expr_op(g, e) == EX_CELL) cell_terms(g, e, dot, &rates, &terms);
    int definition = expr_op(g, e) == EX_DEF;
    if (!terms.n) {
      if (known && definition) expr_map_set(known, e, g->zero);
      continue;
    }
    Expr sum = add_terms(g, &terms);
    if (definition) {
      sum = expr_def_unique(g, expr_name_with_suffix(g, expr_def_name(g, e), suffix), sum);
      if (known) expr_map_set(known, e, sum);
    }
    expr_map_set(dot, e, sum);
  }
  for (uint32_t i = 0; i < n; i++) {
    Expr d = roots[i] ? expr_map_get(dot, roots[i]) : 0;
    out[i] = d ? d : g->zero;
  }
  expr_list_free(g, l);
  expr_map_free(&rates);
  if (terms.cap) arena_recycle(g->arena, terms.at, terms.cap * sizeof *terms.at);
  arena_recycle(g->arena, roots, (n + 1) * sizeof *roots);
}

Expr expr_diff(ExprGraph *g, Expr e, SymId sym) {
  Expr out;
  Name suffix = expr_name_with_suffix(g, "_", expr_symbol(g, sym)->name);
  expr_tangent(g, &e, 1, (ExprSeeds){&g->one, 1, sym}, suffix, NULL, &out);
  return out;
}

/* --- reverse --- */

typedef struct {
  ExprGraph *g;
  ExprMap *head; /* node -> its newest contribution in g->pool; pool[0] is unused */
  Terms terms; /* scratch */
} Adjoints;

static void contribute(Adjoints *a, Expr node, Expr value) {
  if (value == a->g->zero || expr_is_num(a->g, node)) return;
  Contribution c = {value, expr_map_get(a->head, node)};
  vec_push(a->g->arena, &a->g->pool, c);
  expr_map_set(a->head, node, a->g->pool.n - 1);
}

static Expr adjoint_of(Adjoints *a, Expr node) {
  a->terms.n = 0;
  for (uint32_t i = expr_map_get(a->head, node); i; i = a->g->pool.at[i].next)
    push_term(a->g, &a->terms, a->g->pool.at[i].value);
  return add_terms(a->g, &a->terms);
}

/* Symbols of differentiation: the set `targets`, or if NULL those of a kind with index < below. */
typedef struct {
  const ExprMap *targets;
  SymKind kind;
  uint32_t below;
} Wanted;

static int is_wanted(const Symbol *s, const void *data) {
  const Wanted *w = data;
  if (w->targets) return expr_map_get(w->targets, s->node) != 0;
  return s->kind == w->kind && s->index < w->below;
}

/* Prepares the sums in e that contain a wanted symbol. */
static void prepare_partials(ExprGraph *g, Expr *e, const Wanted *w) {
  VEC(Expr) cells = {0};
  if (!g->nests.n) return;
  ExprList l = expr_topo(g, e, 1);
  expr_mark_containing(g, l, is_wanted, w, &g->live);
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(g, l.at[k]) == EX_CELL && expr_map_get(&g->live, l.at[k])) vec_push(g->arena, &cells, l.at[k]);
  expr_list_free(g, l);
  prepare_sums(g, cells.at, cells.n, 0, e, 1);
}

/* Reverse sweep: adjoints of all nodes of e that contain a wanted symbol; *l: the nodes of e. */
static Adjoints sweep(ExprGraph *g, Expr e, const Wanted *w, ExprList *l) {
  prepare_partials(g, &e, w);
  *l = expr_topo(g, &e, 1);
  ExprMap *live = &g->live;
  expr_mark_containing(g, *l, is_wanted, w, live);
  Adjoints a = {.g = g, .head = &g->work};
  expr_map_clear(a.head);
  g->pool.n = 0;
  vec_push(g->arena, &g->pool, ((Contribution){0}));
  if (expr_map_get(live, e)) contribute(&a, e, g->one);
  for (uint32_t k = l->n; k-- > 0;) {
    Expr x = l->at[k];
    if (expr_op(g, x) == EX_SYM || !expr_map_get(live, x)) continue;
    Expr bar = adjoint_of(&a, x);
    if (bar == g->zero) continue;
    if (expr_op(g, x) == EX_DEF) bar = name_long_expr(g, expr_def_name(g, x), bar);
    SumPartials d = expr_op(g, x) == EX_CELL ? expr_sum_partials(g, x, live) : (SumPartials){0};
    for (uint32_t i = 0; i < d.n; i++) {
      Expr arg = expr_sum_arg(g, expr_cell_nest(g, x), d.at[i].arg);
      if (expr_map_get(live, arg)) contribute(&a, arg, times_chosen(g, d.at[i].value, bar, NESTED_CHOICES));
    }
    for (uint32_t i = 0; i < inputs(g, x); i++) {
      if (!expr_map_get(live, input(g, x, i))) continue;
      Choice c;
      Expr term = g->zero;
      if (!is_choice(g, x, &c)) term = times_chosen(g, partial(g, x, i), bar, NESTED_CHOICES);
      else if (i == c.yes) term = expr_select(g, c.condition, bar, g->zero);
      else if (i == c.no) term = expr_select(g, c.condition, g->zero, bar);
      contribute(&a, input(g, x, i), term);
    }
  }
  return a;
}

void expr_gradient(ExprGraph *g, Expr e, const SymId *syms, uint32_t n, Expr *out) {
  ExprMap targets = expr_map(g->arena);
  for (uint32_t i = 0; i < n; i++) expr_map_set(&targets, expr_symbol(g, syms[i])->node, 1);
  Wanted w = {.targets = &targets};
  ExprList l;
  Adjoints a = sweep(g, e, &w, &l);
  for (uint32_t i = 0; i < n; i++) out[i] = adjoint_of(&a, expr_symbol(g, syms[i])->node);
  expr_list_free(g, l);
  expr_map_free(&targets);
}

static int by_index(const void *a, const void *b) {
  const ExprPartial *x = a, *y = b;
  return (x->index > y->index) - (x->index < y->index);
}

ExprPartials expr_gradient_sparse(ExprGraph *g, Expr e, SymKind kind, uint32_t below) {
  Wanted w = {.kind = kind, .below = below};
  ExprList l;
  VEC(ExprPartial) found = {0};
  Adjoints a = sweep(g, e, &w, &l);
  for (uint32_t i = 0; i < l.n; i++) {
    if (expr_op(g, l.at[i]) != EX_SYM || !is_wanted(expr_sym_of(g, l.at[i]), &w)) continue;
    Expr d = adjoint_of(&a, l.at[i]);
    if (d != g->zero) vec_push(g->arena, &found, ((ExprPartial){expr_sym_of(g, l.at[i])->index, d}));
  }
  expr_list_free(g, l);
  if (found.n) qsort(found.at, found.n, sizeof *found.at, by_index);
  return (ExprPartials){found.at, found.n};
}
