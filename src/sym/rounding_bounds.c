/* Random sample states, and values with a bound of their rounding error: the running error analysis of Wilkinson
 * (Higham, Accuracy and Stability of Numerical Algorithms, 2002, section 3.3), with first-order bounds for the
 * functions. */
#include <float.h>
#include <math.h>

#include "sym/expr_eval.h"
#include "sym/prove.h"
#include "sym/sum_nest.h"

typedef long double Real;

/* --- states --- */

/* Uniform number in [0, 1) by SplitMix64 (Steele, Lea, Flood 2014, DOI 10.1145/2714064.2660195). */
static Real uniform_number(uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  x ^= x >> 31;
  return (Real)(x >> 11) / (Real)(1ull << 53);
}

static Real state_value(const Symbol *s, uint32_t id, uint32_t seed) {
  if (strcmp(s->name, "pi") == 0) return acosl(-1);
  uint64_t place = ((uint64_t)seed << 32) + id;
  Real x = uniform_number(2 * place), size = 0.3L + 1.7L * x;
  switch (s->sign) {
    case SIGN_POSITIVE: case SIGN_NONNEGATIVE: return size;
    case SIGN_NEGATIVE: case SIGN_NONPOSITIVE: return -size;
    case SIGN_UNKNOWN: break;
  }
  return uniform_number(2 * place + 1) < 0.5L ? size : -size;
}

long double sample_symbol(const ExprGraph *g, SymId s, uint32_t seed) {
  return state_value(expr_symbol(g, s), s, seed);
}

void sample_state(const ExprGraph *g, uint32_t seed, long double *symbols) {
  for (SymId s = 1; s <= expr_symbol_count(g); s++) symbols[s] = sample_symbol(g, s, seed);
}

void sample_state_wide(const ExprGraph *g, uint32_t seed, long double *symbols) {
  sample_state(g, seed, symbols);
  for (SymId s = 1; s <= expr_symbol_count(g); s++) {
    SymKind kind = expr_symbol(g, s)->kind;
    if (kind == SYM_COORD || kind == SYM_STATE || kind == SYM_TIME) symbols[s] *= 4;
  }
}

/* --- bounds --- */

/* Values and bounds of the nodes of a tape, by position in its list. */
typedef struct {
  ExprGraph *g;
  const Real *value;
  Real *bound;
  const ExprMap *place; /* node -> position + 1 */
} Bounds;

static Real value_of(const Bounds *b, Expr e) { return b->value[expr_map_get(b->place, e) - 1]; }
static Real bound_of(const Bounds *b, Expr e) { return b->bound[expr_map_get(b->place, e) - 1]; }

/* Whether x is a multiple of 2^-16 of magnitude <= 1e9: sums of such numbers are exact. */
static int is_short_binary(Real x) { return fabsl(x) <= 1e9L && x * 65536 == floorl(x * 65536); }

static Real sum_bound(const Bounds *b, Expr e) {
  Real bound = 0, size = 0;
  int exact = 1;
  uint32_t n = expr_pairs(b->g, e, EX_SUM);
  for (uint32_t i = 0; i < n; i++) {
    Num c;
    Expr t = expr_pair(b->g, e, EX_SUM, i, &c);
    bound += fabsl((Real)num_value(c)) * bound_of(b, t) +
             (num_error(c) > 0 ? (Real)num_error(c) * (fabsl(value_of(b, t)) + bound_of(b, t)) : 0);
    size += fabsl((Real)num_value(c) * value_of(b, t));
    exact &= num_is_int(c) && is_short_binary(value_of(b, t)) && is_short_binary((Real)num_value(c) * value_of(b, t));
  }
  if (exact && bound == 0 && is_short_binary(size)) return 0;
  return bound + (Real)(n + 2) * LDBL_EPSILON * size;
}

/* Whether the value of a product of at most four small multiples of 1/4, or their inverses, is exact. */
static int is_exact_product(const Bounds *b, Expr e, Real value) {
  Real above = 1, below = 1;
  int64_t factors = 0;
  for (ExprPair x = {0}; expr_next_pair(b->g, e, EX_PROD, &x);) {
    Real v = value_of(b, x.of);
    if (!num_is_int(x.num) || bound_of(b, x.of) != 0 || !(fabsl(v) <= 4096) || 4 * v != floorl(4 * v)) return 0;
    factors += x.num.num < 0 ? -x.num.num : x.num.num;
    if (factors > 4) return 0;
    for (int64_t j = 0; j < x.num.num; j++) above *= v;
    for (int64_t j = 0; j < -x.num.num; j++) below *= v;
  }
  return below != 0 && value * below == above && is_short_binary(value);
}

/* Error bound of a product; a factor that may be 0 within its bound leaves twice the largest magnitude of the
 * product. */
static Real prod_bound(const Bounds *b, Expr e, Real value) {
  Real relative = 0, most = 1;
  int vanishes = 0;
  for (ExprPair x = {0}; expr_next_pair(b->g, e, EX_PROD, &x);) {
    Real power = (Real)num_value(x.num), size = fabsl(power), v = fabsl(value_of(b, x.of)), off = bound_of(b, x.of);
    vanishes |= power > 0 && !(v > off);
    most *= power > 0 ? powl(v + off, power) : v > off ? powl(v - off, power) : INFINITY;
    relative += size * off / v + (size + 4) * LDBL_EPSILON;
    if (num_error(x.num) > 0) relative += (Real)num_error(x.num) * fabsl(logl(v));
  }
  if (is_exact_product(b, e, value)) return 0;
  if (vanishes) return isnan(most) ? INFINITY : 2 * most;
  return isnan(relative) ? INFINITY : relative * fabsl(value);
}

/* |f'(x)|, or a bound of it, for functions of one argument. */
static Real slope(ExprOp op, Real x, Real f) {
  switch (op) {
#define SLOPE(OP, name, latex, symmetry, at_0, sign, proof, slope, ...) case EX_##OP: return slope;
    FUNCTIONS(SLOPE)
    case EX_ABS: case EX_DEF: return 1;
    case EX_SIGN: case EX_FLOOR: case EX_NOT: case EX_NUM: case EX_SYM: case EX_SUM: case EX_PROD: case EX_POW:
    case EX_NEST: case EX_CELL:
    case EX_ATAN2: case EX_HYPOT: case EX_MIN: case EX_MAX: case EX_LT: case EX_LE: case EX_EQ:
    case EX_AND: case EX_OR: case EX_SELECT: case EX_COUNT: break;
  }
  return INFINITY;
}

/* Bound of a comparison: 0 if the error bounds leave it certain, infinite otherwise. */
static Real compare_bound(const Bounds *b, Expr e) {
  Expr x = expr_arg(b->g, e, 0), y = expr_arg(b->g, e, 1);
  Real gap = fabsl(value_of(b, x) - value_of(b, y)), off = bound_of(b, x) + bound_of(b, y);
  return gap > off || off == 0 ? 0 : INFINITY;
}

static Real binary_bound(const Bounds *b, Expr e, Real f) {
  Expr first = expr_arg(b->g, e, 0), second = expr_arg(b->g, e, 1);
  Real x = value_of(b, first), y = value_of(b, second), dx = bound_of(b, first), dy = bound_of(b, second);
  Real rounding = 8 * LDBL_EPSILON * fabsl(f);
  switch (expr_op(b->g, e)) {
    case EX_POW: return fabsl(f) * (fabsl(y / x) * dx + fabsl(logl(fabsl(x))) * dy) + rounding * (1 + fabsl(y));
    case EX_ATAN2: return (fabsl(y) * dx + fabsl(x) * dy) / (x * x + y * y) + rounding;
    case EX_MIN: case EX_MAX: return fmaxl(dx, dy);
    case EX_HYPOT: return dx + dy + rounding;
    case EX_LT: case EX_LE: case EX_EQ: return compare_bound(b, e);
    case EX_AND: case EX_OR: return dx + dy;
    case EX_SELECT: return dx > 0 ? INFINITY : x != 0 ? dy : bound_of(b, expr_arg(b->g, e, 2));
    case EX_NUM: case EX_SYM: case EX_DEF: case EX_SUM: case EX_PROD: case EX_NEST: case EX_CELL: EX_FUNCTION_CASES
    case EX_ABS: case EX_SIGN: case EX_FLOOR: case EX_NOT: case EX_COUNT: break;
  }
  return INFINITY;
}

static Real unary_bound(const Bounds *b, Expr e, Real f) {
  ExprOp op = expr_op(b->g, e);
  Expr arg = expr_arg(b->g, e, 0);
  Real x = value_of(b, arg), dx = bound_of(b, arg);
  if (op == EX_NOT) return dx;
  if (op == EX_SIGN) return fabsl(x) > dx || dx == 0 ? 0 : INFINITY;
  if (op == EX_FLOOR) return fabsl(x - roundl(x)) > dx || dx == 0 ? 0 : INFINITY;
  if (op == EX_DEF) return dx;
  return (dx > 0 ? slope(op, x, f) * dx : 0) + 8 * LDBL_EPSILON * fabsl(f);
}

static Real node_bound(const Bounds *b, Expr e, Real value, const Real *errors) {
  switch (expr_op(b->g, e)) {
  case EX_NUM:
    return num_is_int(expr_number(b->g, e)) ? 0 : LDBL_EPSILON * fabsl(value) + (Real)num_error(expr_number(b->g, e));
  case EX_SYM:
    if (expr_sym_of(b->g, e)->kind == SYM_CONST) return LDBL_EPSILON * fabsl(value);
    return errors ? errors[expr_sym_id(b->g, e)] : 0;
  case EX_SUM: return sum_bound(b, e);
  case EX_PROD: return prod_bound(b, e, value);
  case EX_POW:
  case EX_ATAN2:
  case EX_HYPOT:
  case EX_MIN:
  case EX_MAX:
  case EX_LT:
  case EX_LE:
  case EX_EQ:
  case EX_AND:
  case EX_OR:
  case EX_SELECT: return binary_bound(b, e, value); EX_FUNCTION_CASES
  case EX_DEF:
  case EX_ABS:
  case EX_SIGN:
  case EX_FLOOR:
  case EX_NOT: return unary_bound(b, e, value);
  case EX_NEST: return 0;
  case EX_CELL: /* cell_bound */
  case EX_COUNT: break;
  }
  return INFINITY;
}

/* Underflow error: LDBL_MIN for an inexact operation whose value is subnormal, else 0. */
static Real underflow(const ExprGraph *g, Expr e, Real value) {
  ExprOp op = expr_op(g, e);
  int exact = op == EX_NUM || op == EX_SYM || op == EX_SUM || op == EX_DEF || op == EX_ABS || op == EX_SIGN ||
              op == EX_FLOOR || op == EX_MIN || op == EX_MAX || op == EX_SELECT || expr_is_bool(g, e);
  return exact || fabsl(value) >= LDBL_MIN ? 0 : LDBL_MIN;
}

struct BoundTape {
  ExprGraph *g;
  ExprList nodes;
  EvalTape *tape; /* its roots are all nodes */
  struct NestBounds **nests; /* by place, of quantified sums; NULL: none */
  ExprMap place;  /* node -> position + 1 */
  Real *value, *bound;
};

/* Bounds of the sums of a nest. */
typedef struct NestBounds {
  const SumNest *sums;
  BoundTape *body;
  Real *symbols, *errors, *value, *bound; /* by symbol; by cell */
} NestBounds;

/* Longer sums have no bound: nothing is decided by their values. */
enum { MOST_TURNS = 50000 };

static NestBounds *nest_bounds(ExprGraph *g, Expr nest) {
  Arena *a = expr_arena(g);
  const SumNest *s = expr_sum_nest(g, nest);
  if (expr_sum_turns(g, nest) > MOST_TURNS) return NULL;
  Expr *values = ARENA_ARRAY(a, Expr, s->nshares + 1);
  for (uint32_t k = 0; k < s->nshares; k++) values[k] = s->shares[k].value;
  NestBounds *n = ARENA_NEW(a, NestBounds);
  uint32_t symbols = expr_symbol_count(g) + 1;
  *n = (NestBounds){s, bound_tape(g, values, s->nshares), ARENA_ARRAY(a, Real, symbols), ARENA_ARRAY(a, Real, symbols),
                    ARENA_ARRAY(a, Real, s->ncells), ARENA_ARRAY(a, Real, s->ncells)};
  return n;
}

static void add_shares(NestBounds *n, int64_t i, int64_t j) {
  for (uint32_t k = 0; k < n->sums->nshares; k++) {
    const NestShare *x = &n->sums->shares[k];
    int64_t c = subscript_at(&x->at, i, j);
    Real bound, value = bound_value(n->body, x->value, &bound);
    n->value[c] += fabsl(value);
    n->bound[c] += bound + LDBL_EPSILON * n->value[c];
  }
}

static void run_nest_bounds(const BoundTape *t, NestBounds *n, Expr nest, const Real *symbols, const Real *errors) {
  const SumNest *s = n->sums;
  for (SymId k = 1; k <= expr_symbol_count(t->g); k++) {
    n->symbols[k] = symbols[k];
    n->errors[k] = errors ? errors[k] : 0;
  }
  for (uint32_t c = 0; c < s->ncells; c++) n->value[c] = n->bound[c] = 0;
  for (int64_t i = 0; i < s->range.rows; i++)
    for (int64_t j = loop_from(&s->range, i); j < loop_to(&s->range, i); j++) {
      for (uint32_t k = 0; k < s->nreads; k++) {
        Expr arg = expr_sum_arg(t->g, nest, (uint32_t)subscript_at(&s->reads[k].at, i, j));
        uint32_t place = expr_map_get(&t->place, arg) - 1;
        n->symbols[s->reads[k].symbol] = t->value[place];
        n->errors[s->reads[k].symbol] = t->bound[place];
      }
      bound_run(n->body, n->symbols, n->errors);
      add_shares(n, i, j);
    }
}

/* Bound of a quantified sum, which its nest has computed. */
static Real cell_bound(const BoundTape *t, Expr cell) {
  const NestBounds *n = t->nests[expr_map_get(&t->place, expr_cell_nest(t->g, cell)) - 1];
  return n ? n->bound[expr_cell_number(t->g, cell)] : INFINITY;
}

BoundTape *bound_tape(ExprGraph *g, const Expr *roots, uint32_t n) {
  Arena *a = expr_arena(g);
  BoundTape *t = ARENA_NEW(a, BoundTape);
  *t = (BoundTape){.g = g, .nodes = expr_topo(g, roots, n), .place = expr_map(a)};
  t->tape = eval_tape(g, t->nodes.at, t->nodes.n);
  t->value = ARENA_ARRAY(a, Real, t->nodes.n + 1);
  t->bound = ARENA_ARRAY(a, Real, t->nodes.n + 1);
  t->nests = ARENA_ARRAY(a, NestBounds *, t->nodes.n + 1);
  for (uint32_t i = 0; i < t->nodes.n; i++) {
    expr_map_set(&t->place, t->nodes.at[i], i + 1);
    if (expr_op(g, t->nodes.at[i]) == EX_NEST) t->nests[i] = nest_bounds(g, t->nodes.at[i]);
  }
  return t;
}

void bound_tape_free(BoundTape *t) {
  Arena *a = expr_arena(t->g);
  size_t n = t->nodes.n + 1;
  eval_tape_free(t->g, t->tape);
  arena_recycle(a, t->value, n * sizeof *t->value);
  arena_recycle(a, t->bound, n * sizeof *t->bound);
  arena_recycle(a, t->nests, n * sizeof *t->nests);
  expr_map_free(&t->place);
  expr_list_free(t->g, t->nodes);
}

void bound_run(BoundTape *t, const long double *symbols, const long double *errors) {
  eval_run(t->tape, symbols, t->value);
  Bounds b = {.g = t->g, .value = t->value, .bound = t->bound, .place = &t->place};
  for (uint32_t i = 0; i < t->nodes.n; i++) {
    Expr e = t->nodes.at[i];
    if (t->nests[i]) run_nest_bounds(t, t->nests[i], e, symbols, errors);
    Real bound = expr_op(t->g, e) == EX_CELL ? cell_bound(t, e) : node_bound(&b, e, t->value[i], errors);
    t->bound[i] = expr_op(t->g, e) == EX_PROD && bound == 0 ? 0 : bound + underflow(t->g, e, t->value[i]);
  }
}

long double bound_value(const BoundTape *t, Expr root, long double *bound) {
  uint32_t place = root ? expr_map_get(&t->place, root) : 0;
  *bound = place ? t->bound[place - 1] : 0;
  return place ? t->value[place - 1] : 0;
}

long double value_with_bound(ExprGraph *g, Expr e, const long double *symbols, const long double *errors,
                             long double *bound) {
  BoundTape *t = bound_tape(g, &e, 1);
  bound_run(t, symbols, errors);
  return bound_value(t, e, bound);
}
