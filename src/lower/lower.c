/* Expressions of the graph as instructions.
 *
 * Nodes come after their arguments, so that lowering is one loop over them. Rewrites here save operations and keep
 * the rounding of the text: products of parameters first, one factor for coefficients of equal size, the addition
 * theorem. */
#include "lower/lower.h"

#include <stdlib.h>

#include "lower/lower_impl.h"

/* --- numbers and powers --- */

static Slot number(Lower *l, Num n) { return prog_num(l->p, n); }
Slot lower_slot(const Lower *l, Expr e) { return expr_map_get(&l->slots, e) - 1; }

static Slot power_int(Lower *l, Slot x, int64_t n) {
  Slot r = 0, square = x;
  for (; n; n >>= 1) {
    if (n & 1) r = r ? op(l, IR_MUL, r, square) : square;
    if (n > 1) square = op(l, IR_MUL, square, square);
  }
  return r;
}

/* x^e for e > 0: integers by multiplication, halves with a square root, thirds with a cubic root. */
static Slot power(Lower *l, Slot x, Num e) {
  if (num_is_exact(e) && e.den == 1) return power_int(l, x, e.num);
  if (num_is_exact(e) && e.den == 2) {
    Slot root = op(l, IR_SQRT, x, 0);
    if (e.num == 1) return root;
    Slot whole = power_int(l, x, e.num / 2);
    return op(l, IR_MUL, whole, root);
  }
  if (num_is_exact(e) && e.den == 3) { /* the real root, also of negative numbers */
    Slot root = prog_ins(l->p, (Ins){.op = IR_FN1, .a = x, .text = "cbrt"});
    return power_int(l, root, e.num);
  }
  Slot k = number(l, e);
  return prog_ins(l->p, (Ins){.op = IR_FN2, .a = x, .b = k, .text = "pow"});
}

/* --- products --- */

typedef struct {
  Slot slot;
  Num exponent;
  int rank;
} Factor;

/* Order of factors. Parameters come first: their products recur, and value numbering finds them again. */
static int rank_of(const ExprGraph *g, Expr e) {
  switch (expr_op(g, e)) {
    case EX_NUM: return 0;
    case EX_SYM: {
      SymKind k = expr_sym_of(g, e)->kind;
      return k == SYM_PARAM || k == SYM_CONST ? 1 : k == SYM_VEL || k == SYM_ACC ? 5 : 4;
    }
    case EX_SUM: return 2;
    case EX_DEF: return 4;
    default: return 3;
  }
}

static int by_rank(const void *a, const void *b) {
  const Factor *x = a, *y = b;
  if (x->rank != y->rank) return x->rank - y->rank;
  return (x->slot > y->slot) - (x->slot < y->slot);
}

static Slot multiply(Lower *l, Factor *f, uint32_t n) {
  if (!n) return 0;
  for (uint32_t i = 0; i < n; i++)
    if (l->p->folds_constants && prog_is_number(l->p, f[i].slot)) f[i].rank = 0;
  qsort(f, n, sizeof *f, by_rank);
  Slot r = 0;
  for (uint32_t i = 0; i < n; i++) {
    Slot x = power(l, f[i].slot, f[i].exponent);
    r = i ? op(l, IR_MUL, r, x) : x;
  }
  return r;
}

static Slot lower_prod(Lower *l, Expr e) {
  uint32_t n = expr_pairs(l->g, e, EX_PROD), above = 0, below = 0;
  Factor *top = ARENA_ARRAY(l->p->arena, Factor, 2 * (size_t)n), *bottom = top + n;
  for (uint32_t i = 0; i < n; i++) {
    Num k;
    Expr base = expr_pair(l->g, e, EX_PROD, i, &k);
    Factor f = {lower_slot(l, base), num_abs(k), rank_of(l->g, base)};
    if (num_sign(k) > 0) top[above++] = f;
    else bottom[below++] = f;
  }
  Slot num = above ? multiply(l, top, above) : number(l, num_int(1)), den = below ? multiply(l, bottom, below) : 0;
  arena_recycle(l->p->arena, top, 2 * n * sizeof *top);
  return den ? op(l, IR_DIV, num, den) : num;
}

/* --- sums --- */

/* |c| * t. A coefficient p/q with q no power of two is p*t/q, so that q is exact; p/(q*x) when t is 1/x. */
static Slot scaled(Lower *l, Slot t, Num c) {
  c = num_abs(c);
  if (num_is_one(c)) return t;
  int dyadic = l->p->folds_constants || !num_is_exact(c) || (c.den & (c.den - 1)) == 0;
  Slot up = number(l, dyadic ? c : num_int(c.num)), down = dyadic ? 0 : number(l, num_int(c.den));
  const Ins *i = &l->p->ins.at[t];
  const Ins *top = &l->p->ins.at[i->a];
  if (i->op == IR_DIV && top->op == IR_CONST && num_is_one(top->number)) {
    Slot x = i->b, bottom = down ? op(l, IR_MUL, down, x) : x;
    return op(l, IR_DIV, up, bottom);
  }
  Slot product = op(l, IR_MUL, up, t);
  return down ? op(l, IR_DIV, product, down) : product;
}

/* The common absolute value of all coefficients of a sum, else 1: k*(a - b) costs one multiplication less than k*a -
 * k*b. */
static Num shared_size(const ExprGraph *g, Expr e) {
  Num c, k;
  expr_pair(g, e, EX_SUM, 0, &c);
  c = num_abs(c);
  uint32_t n = expr_pairs(g, e, EX_SUM);
  for (uint32_t i = 0; i < n; i++) {
    Expr t = expr_pair(g, e, EX_SUM, i, &k);
    if (!num_equal(num_abs(k), c) || expr_is_num(g, t)) return num_int(1);
  }
  return c;
}

/* Term i of the sum e without its sign; inner: 1 over the factor in front of the sum. */
static Slot term(Lower *l, Expr e, uint32_t i, Num inner) {
  Num c;
  Expr t = expr_pair(l->g, e, EX_SUM, i, &c);
  if (expr_is_num(l->g, t)) return number(l, num_mul(num_abs(c), expr_number(l->g, t)));
  return scaled(l, lower_slot(l, t), num_mul(c, inner));
}

/* Positive terms first, then negative ones; -(a + b) when all are negative. */
static Slot lower_sum(Lower *l, Expr e) {
  uint32_t n = expr_pairs(l->g, e, EX_SUM);
  Num outer = shared_size(l->g, e), inner = num_div(num_int(1), outer);
  Slot sum = 0;
  int negative = 0; /* of the whole sum */
  for (int wanted = 1; wanted >= -1; wanted -= 2) {
    if (wanted < 0) negative = !sum;
    for (uint32_t i = 0; i < n; i++) {
      Num c;
      expr_pair(l->g, e, EX_SUM, i, &c);
      if (num_sign(c) != wanted) continue;
      Slot x = term(l, e, i, inner);
      sum = op(l, wanted > 0 || negative ? IR_ADD : IR_SUB, sum, x);
    }
  }
  sum = scaled(l, sum, outer);
  return negative ? op(l, IR_NEG, sum, 0) : sum;
}

/* --- functions --- */

static Slot call1(Lower *l, const char *name, Slot x) {
  return prog_ins(l->p, (Ins){.op = IR_FN1, .a = x, .text = name});
}

/* sin and cos of u. For u = a + b or a - b where sines or cosines of both a and b are needed
 * anyway, the addition theorem costs three operations instead of a function. */
static Slot lower_circular(Lower *l, ExprOp fn, Expr u) {
  ExprGraph *g = l->g;
  Num ca, cb;
  if (expr_op(g, u) == EX_SUM && expr_pairs(g, u, EX_SUM) == 2) {
    Expr a = expr_pair(g, u, EX_SUM, 0, &ca), b = expr_pair(g, u, EX_SUM, 1, &cb);
    if (num_is_one(ca) && num_is_one(num_abs(cb)) && expr_map_get(&l->circular, a) && expr_map_get(&l->circular, b)) {
      Slot sa = call1(l, "sin", lower_slot(l, a)), cos_a = call1(l, "cos", lower_slot(l, a));
      Slot sb = call1(l, "sin", lower_slot(l, b)), cos_b = call1(l, "cos", lower_slot(l, b));
      int plus = num_sign(cb) > 0;
      Slot first = fn == EX_SIN ? op(l, IR_MUL, sa, cos_b) : op(l, IR_MUL, cos_a, cos_b);
      Slot second = fn == EX_SIN ? op(l, IR_MUL, cos_a, sb) : op(l, IR_MUL, sa, sb);
      return op(l, (fn == EX_SIN) == plus ? IR_ADD : IR_SUB, first, second);
    }
  }
  return call1(l, expr_op_text(fn), lower_slot(l, u));
}

static Slot binary(Lower *l, IrOp o, Expr e) {
  Slot a = lower_slot(l, expr_arg(l->g, e, 0)), b = lower_slot(l, expr_arg(l->g, e, 1));
  return op(l, o, a, b);
}

static Slot call2(Lower *l, const char *name, Expr e) {
  Slot a = lower_slot(l, expr_arg(l->g, e, 0)), b = lower_slot(l, expr_arg(l->g, e, 1));
  return prog_ins(l->p, (Ins){.op = IR_FN2, .a = a, .b = b, .text = name});
}

Slot lower_load(Lower *l, IrArray array, const Symbol *s) {
  return prog_ins(l->p, (Ins){.op = IR_LOAD, .array = array, .index = s->index, .name = s->name});
}

static Slot load_param(Lower *l, const Symbol *s) {
  const Param *p = &l->e->m->params.at[s->index];
  if (p->fixed) return prog_num(l->p, p->number);
  return prog_ins(l->p, (Ins){.op = IR_LOAD, .array = ARR_P, .index = p->place, .name = s->name});
}

/* Closed forms, numbered behind the inputs, stand behind the modes of switches. */
static Slot lower_input(Lower *l, const Symbol *s) {
  uint32_t index = s->index + (s->index < l->e->m->inputs.n ? 0 : l->e->switches.nmodes);
  return prog_ins(l->p, (Ins){.op = IR_LOAD, .array = ARR_U, .index = index, .name = s->name});
}

static Slot lower_symbol(Lower *l, Expr e) {
  const Symbol *s = expr_sym_of(l->g, e);
  switch (s->kind) {
    case SYM_TIME: return lower_load(l, ARR_T, s);
    case SYM_COORD: return lower_load(l, ARR_Q, s);
    case SYM_VEL: return lower_load(l, ARR_V, s);
    case SYM_STATE: return lower_load(l, ARR_Z, s);
    case SYM_PARAM: return load_param(l, s);
    case SYM_INPUT: return lower_input(l, s);
    case SYM_CONST:
      return l->p->folds_constants ? prog_num(l->p, num_double(3.14159265358979323846))
                                   : prog_ins(l->p, (Ins){.op = IR_PI});
    /* slots are set before: see lower_with_accelerations */
    case SYM_ACC: case SYM_RATE: case SYM_MULTIPLIER: case SYM_LOCAL: break;
  }
  return 0;
}

/* floor(a), of a sum with denominators by one division: (i - 1)/10 is whole where i/10 - 1/10 has lost a bit. */
static Slot lower_floor(Lower *l, Expr a) {
  enum { MOST = 1 << 20 };
  Num part = num_int(0);
  int exact = expr_op(l->g, a) == EX_SUM;
  for (uint32_t i = 0; exact && i < expr_pairs(l->g, a, EX_SUM); i++) {
    Num c;
    expr_pair(l->g, a, EX_SUM, i, &c);
    exact = num_is_exact(c);
    if (exact) part = num_gcd(part, c);
  }
  if (!exact || part.den > MOST || (part.den & (part.den - 1)) == 0) return call1(l, "floor", lower_slot(l, a));
  Expr up = expr_scale(l->g, num_int(part.den), a);
  lower_roots(l, &up, 1);
  return call1(l, "floor", op(l, IR_DIV, lower_slot(l, up), number(l, num_int(part.den))));
}

static Slot lower_node(Lower *l, Expr e) {
  ExprGraph *g = l->g;
  Slot held = lower_held_branch(l, e);
  if (held != NOT_A_SLOT) return held;
  ExprOp o = expr_op(g, e);
  Expr a = expr_nargs(g, e) ? expr_arg(g, e, 0) : 0;
  switch (o) {
    case EX_NUM: return number(l, expr_number(g, e));
    case EX_SYM: return lower_symbol(l, e);
    case EX_DEF: {
      Slot s = lower_slot(l, a);
      prog_name(l->p, s, expr_def_name(g, e));
      return s;
    }
    case EX_SUM: return lower_sum(l, e);
    case EX_PROD: return lower_prod(l, e);
    case EX_NEST: case EX_CELL: return 0; /* lower_nest */
    case EX_POW: return call2(l, "pow", e);
    EX_FUNCTION_CASES
      return o == EX_SIN || o == EX_COS ? lower_circular(l, o, a) : call1(l, expr_op_text(o), lower_slot(l, a));
    case EX_ABS: return call1(l, "fabs", lower_slot(l, a));
    case EX_SIGN: return op(l, IR_SIGN, lower_slot(l, a), 0);
    case EX_FLOOR: return lower_floor(l, a);
    case EX_ATAN2: return call2(l, "atan2", e);
    case EX_HYPOT: return call2(l, "hypot", e);
    case EX_MIN: return binary(l, IR_MIN, e);
    case EX_MAX: return binary(l, IR_MAX, e);
    case EX_LT: return binary(l, IR_LT, e);
    case EX_LE: return binary(l, IR_LE, e);
    case EX_EQ: return binary(l, IR_EQ, e);
    case EX_NOT: return op(l, IR_NOT, lower_slot(l, a), 0);
    case EX_AND: return binary(l, IR_AND, e);
    case EX_OR: return binary(l, IR_OR, e);
    case EX_SELECT: {
      Slot c = lower_slot(l, a), x = lower_slot(l, expr_arg(g, e, 1)), y = lower_slot(l, expr_arg(g, e, 2));
      return prog_ins(l->p, (Ins){.op = IR_SELECT, .a = c, .b = x, .c = y});
    }
    case EX_COUNT: break;
  }
  return 0;
}

void lower_roots(Lower *l, const Expr *roots, uint32_t n) {
  ExprList list = expr_topo(l->g, roots, n);
  for (uint32_t i = 0; i < list.n && !l->direct; i++) {
    ExprOp o = expr_op(l->g, list.at[i]);
    if (o == EX_SIN || o == EX_COS) expr_map_set(&l->circular, expr_arg(l->g, list.at[i], 0), 1);
  }
  for (uint32_t i = 0; i < list.n; i++) {
    if (expr_op(l->g, list.at[i]) == EX_NEST) lower_nest(l, list.at[i], &list);
    if (expr_map_get(&l->slots, list.at[i])) continue;
    Slot s = lower_node(l, list.at[i]);
    expr_map_set(&l->slots, list.at[i], s + 1);
  }
}
