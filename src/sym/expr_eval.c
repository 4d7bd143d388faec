/* Evaluation tapes: the nodes below the roots as a list of steps in ascending order, run in long double. */
#include "sym/expr_eval.h"

#include <math.h>

#include "sym/sum_nest.h"

static long double power(long double base, Num e) {
  if (e.den == 1 && e.num == 1) return base;
  if (e.den == 1 && e.num == -1) return 1 / base;
  if (!num_is_exact(e)) return powl(base, num_value(e));
  if (e.den == 1) {
    long double r = 1, b = base;
    for (int64_t n = e.num < 0 ? -e.num : e.num; n; n >>= 1, b *= b)
      if (n & 1) r *= b;
    return e.num < 0 ? 1 / r : r;
  }
  if (e.den == 3) return power(cbrtl(base), num_int(e.num)); /* the real root, negative for a negative base */
  if (e.den == 2) return power(sqrtl(base), num_int(e.num));
  return powl(base, (long double)e.num / (long double)e.den);
}

static long double number(Num n) { return num_is_exact(n) ? (long double)n.num / (long double)n.den : n.approx; }

/* The sums of a nest: its body as a tape, where its arguments stand among the steps, and its sums so far. */
typedef struct {
  const SumNest *sums;
  EvalTape *body;
  const SymId *outside; /* [noutside] symbols of the body that are no arguments: t, pi */
  uint32_t noutside, ncells;
  long double *symbols, *share, *cell;
  uint32_t nsymbols;
} NestStep;

/* TapeStep of a tape, for one node: its arguments are t->arg[first ..], indices of earlier steps; coefficients or
 * exponents of a sum or product are t->number[first ..]. */
typedef struct {
  ExprOp op;
  uint32_t first, n;
  SymId symbol;
  long double constant;
  NestStep *nest; /* of a NEST; of a CELL that of its nest, */
  uint32_t cell;  /* and its number */
} TapeStep;

struct EvalTape {
  uint32_t n, nroots;
  TapeStep *step;
  long double *value;
  VEC(uint32_t) arg;
  VEC(Num) number;           /* exponents of products */
  VEC(long double) factor;   /* coefficients of sums; 1 elsewhere */
  int round_to_double;     /* factors and partial products are rounded to double */
  uint32_t *root; /* step of each root; UINT32_MAX for root 0 */
};

static long double pairs_value(const EvalTape *t, const TapeStep *o) {
  long double r = o->op == EX_SUM ? 0 : 1;
  for (uint32_t i = o->first; i < o->first + o->n; i++) {
    long double x = t->value[t->arg.at[i]];
    if (o->op == EX_SUM) r += t->factor.at[i] * x;
    else if (t->round_to_double) r = (double)(r * (double)power(x, t->number.at[i]));
    else r *= power(x, t->number.at[i]);
  }
  return r;
}

/* Runs all turns; the arguments of the nest have their values. outside: of its other symbols. */
static void run_nest(const EvalTape *t, const TapeStep *o, const long double *outside) {
  NestStep *n = o->nest;
  const SumNest *s = n->sums;
  const uint32_t *arg = t->arg.at + o->first + 1; /* behind the nest's number */
  for (uint32_t k = 0; k < n->noutside; k++) n->symbols[n->outside[k]] = outside[n->outside[k]];
  for (uint32_t k = 0; k < n->ncells; k++) n->cell[k] = 0;
  for (int64_t i = 0; i < s->range.rows; i++)
    for (int64_t j = loop_from(&s->range, i); j < loop_to(&s->range, i); j++) {
      for (uint32_t k = 0; k < s->nreads; k++)
        n->symbols[s->reads[k].symbol] = t->value[arg[subscript_at(&s->reads[k].at, i, j)]];
      eval_run(n->body, n->symbols, n->share);
      for (uint32_t k = 0; k < s->nshares; k++) n->cell[subscript_at(&s->shares[k].at, i, j)] += n->share[k];
    }
}

static long double step_value(const EvalTape *t, const TapeStep *o, const long double *symbols) {
  const uint32_t *arg = t->arg.at + o->first;
  long double x = 0, y = 0;
  if (o->op != EX_SUM && o->op != EX_PROD) {
    if (o->n > 0) x = t->value[arg[0]];
    if (o->n > 1) y = t->value[arg[1]];
  }
  switch (o->op) {
    case EX_NUM: return o->constant;
    case EX_SYM: return symbols[o->symbol];
    case EX_DEF: return x;
    case EX_SUM: case EX_PROD: return pairs_value(t, o);
    case EX_NEST: run_nest(t, o, symbols); return 0;
    case EX_CELL: return o->nest->cell[o->cell];
    case EX_POW: return powl(x, y);
#define VALUE(OP, name, ...) case EX_##OP: return name##l(x);
    FUNCTIONS(VALUE)
    case EX_ABS: return fabsl(x);
    case EX_SIGN: return (long double)((x > 0) - (x < 0));
    case EX_FLOOR: return floorl(x);
    case EX_ATAN2: return atan2l(x, y);
    case EX_HYPOT: return hypotl(x, y);
    case EX_MIN: return x < y ? x : y;
    case EX_MAX: return x > y ? x : y;
    case EX_LT: return x < y;
    case EX_LE: return x <= y;
    case EX_EQ: return x == y;
    case EX_NOT: return x == 0;
    case EX_AND: return x != 0 && y != 0;
    case EX_OR: return x != 0 || y != 0;
    case EX_SELECT: return x != 0 ? y : t->value[arg[2]];
    case EX_COUNT: break;
  }
  return NAN;
}

static NestStep *compile_nest(ExprGraph *g, Arena *a, Expr e) {
  NestStep *n = ARENA_NEW(a, NestStep);
  const SumNest *s = n->sums = expr_sum_nest(g, e);
  Expr *values = ARENA_ARRAY(a, Expr, s->nshares + 1);
  VEC(SymId) outside = {0};
  for (uint32_t k = 0; k < s->nshares; k++) values[k] = s->shares[k].value;
  n->body = eval_tape(g, values, s->nshares);
  n->nsymbols = expr_symbol_count(g) + 1;
  n->symbols = ARENA_ARRAY(a, long double, n->nsymbols);
  n->share = ARENA_ARRAY(a, long double, s->nshares + 1);
  n->ncells = s->ncells;
  n->cell = ARENA_ARRAY(a, long double, n->ncells);
  for (uint32_t i = 0; i < n->body->n; i++) {
    if (n->body->step[i].op != EX_SYM) continue;
    uint32_t k = 0;
    while (k < s->nreads && s->reads[k].symbol != n->body->step[i].symbol) k++;
    if (k == s->nreads) vec_push(a, &outside, n->body->step[i].symbol);
  }
  n->outside = outside.at;
  n->noutside = outside.n;
  return n;
}

static TapeStep compile_step(EvalTape *t, ExprGraph *g, Arena *a, Expr e, const ExprMap *place) {
  ExprOp op = expr_op(g, e);
  TapeStep o = {.op = op, .first = t->arg.n};
  int pairs = op == EX_SUM || op == EX_PROD;
  if (op == EX_NUM) o.constant = number(expr_number(g, e));
  if (op == EX_SYM) o.symbol = expr_sym_id(g, e);
  uint32_t n = pairs ? expr_pairs(g, e, op) : expr_nargs(g, e);
  for (uint32_t i = 0; i < n; i++) {
    Num k = num_int(1);
    Expr x = pairs ? expr_pair(g, e, op, i, &k) : expr_arg(g, e, i);
    vec_push(a, &t->arg, expr_map_get(place, x) - 1);
    vec_push(a, &t->number, k);
    vec_push(a, &t->factor, op == EX_SUM ? number(k) : 1);
  }
  o.n = n;
  if (op == EX_NEST) o.nest = compile_nest(g, a, e);
  if (op == EX_CELL) {
    o.nest = t->step[expr_map_get(place, expr_cell_nest(g, e)) - 1].nest;
    o.cell = expr_cell_number(g, e);
  }
  return o;
}

EvalTape *eval_tape(ExprGraph *g, const Expr *roots, uint32_t n) {
  Arena *a = expr_arena(g);
  ExprList l = expr_topo(g, roots, n);
  ExprMap place = expr_map(a);
  EvalTape *t = ARENA_NEW(a, EvalTape);
  t->n = l.n;
  t->nroots = n;
  vec_push(a, &t->arg, 0); /* keeps the arrays non-NULL where no step has arguments */
  vec_push(a, &t->number, num_int(0));
  vec_push(a, &t->factor, 0);
  t->step = ARENA_ARRAY(a, TapeStep, l.n + 1);
  t->value = ARENA_ARRAY(a, long double, l.n + 1);
  t->root = ARENA_ARRAY(a, uint32_t, n + 1);
  for (uint32_t i = 0; i < l.n; i++) {
    t->step[i] = compile_step(t, g, a, l.at[i], &place);
    expr_map_set(&place, l.at[i], i + 1);
  }
  for (uint32_t i = 0; i < n; i++) t->root[i] = roots[i] ? expr_map_get(&place, roots[i]) - 1 : UINT32_MAX;
  expr_list_free(g, l);
  expr_map_free(&place);
  return t;
}

void eval_tape_free(ExprGraph *g, EvalTape *t) {
  Arena *a = expr_arena(g);
  for (uint32_t i = 0; i < t->n; i++) {
    NestStep *n = t->step[i].op == EX_NEST ? t->step[i].nest : NULL;
    if (!n) continue;
    eval_tape_free(g, n->body);
    arena_recycle(a, n->symbols, n->nsymbols * sizeof *n->symbols);
  }
  arena_recycle(a, t->step, (t->n + 1) * sizeof *t->step);
  arena_recycle(a, t->value, (t->n + 1) * sizeof *t->value);
  arena_recycle(a, t->root, (t->nroots + 1) * sizeof *t->root);
  arena_recycle(a, t->arg.at, t->arg.cap * sizeof *t->arg.at);
  arena_recycle(a, t->number.at, t->number.cap * sizeof *t->number.at);
  arena_recycle(a, t->factor.at, t->factor.cap * sizeof *t->factor.at);
}

static void read_roots(const EvalTape *t, long double *out) {
  for (uint32_t i = 0; i < t->nroots; i++) out[i] = t->root[i] == UINT32_MAX ? 0 : t->value[t->root[i]];
}

void eval_run(EvalTape *t, const long double *symbols, long double *out) {
  for (uint32_t i = 0; i < t->n; i++) t->value[i] = step_value(t, &t->step[i], symbols);
  read_roots(t, out);
}

/* Values of the symbols of a nest that are no arguments, by symbol. */
static const long double *symbols_outside(NestStep *n, long double (*symbol)(SymId s, const void *data),
                                          const void *data) {
  for (uint32_t k = 0; k < n->noutside; k++) n->symbols[n->outside[k]] = symbol(n->outside[k], data);
  return n->symbols;
}

void eval_run_double(EvalTape *t, long double (*symbol)(SymId s, const void *data), const void *data,
                     long double *out) {
  t->round_to_double = 1;
  for (uint32_t i = 0; i < t->n; i++) {
    const TapeStep *o = &t->step[i];
    const long double *outside = o->op == EX_NEST ? symbols_outside(o->nest, symbol, data) : NULL;
    t->value[i] = (double)(o->op == EX_SYM ? symbol(o->symbol, data) : step_value(t, o, outside));
  }
  t->round_to_double = 0;
  read_roots(t, out);
}

void expr_eval(ExprGraph *g, const Expr *roots, uint32_t n, const long double *symbols, long double *out) {
  EvalTape *t = eval_tape(g, roots, n);
  eval_run(t, symbols, out);
  eval_tape_free(g, t);
}
