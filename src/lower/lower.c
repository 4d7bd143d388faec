/* Expressions of the graph as instructions, and the programs that are not about charges or constraints.
 *
 * Nodes come after their arguments, so that lowering is one loop over them. Rewrites here save operations and keep the
 * rounding of the text: products of parameters first, one factor for coefficients of equal size, the addition theorem. */
#include "lower/lower.h"

#include <stdlib.h>

#include "lower/lower_impl.h"
#include "ir/passes.h"
#include "ir/roll.h"

/* --- numbers and powers --- */

static Slot number(Lower *l, Num n) { return prog_num(l->p, n); }
static Slot op(Lower *l, IrOp o, Slot a, Slot b) { return prog_op(l->p, o, a, b); }

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
  Factor *top = ARENA_ARRAY(l->p->arena, Factor, n), *bottom = ARENA_ARRAY(l->p->arena, Factor, n);
  for (uint32_t i = 0; i < n; i++) {
    Num k;
    Expr base = expr_pair(l->g, e, EX_PROD, i, &k);
    Factor f = {lower_slot(l, base), num_abs(k), rank_of(l->g, base)};
    if (num_sign(k) > 0) top[above++] = f;
    else bottom[below++] = f;
  }
  Slot num = above ? multiply(l, top, above) : number(l, num_int(1));
  if (!below) return num;
  Slot den = multiply(l, bottom, below);
  return op(l, IR_DIV, num, den);
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

/* The common absolute value of all coefficients of a sum, else 1: k*(a - b) costs one multiplication less than k*a - k*b. */
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

static Slot call1(Lower *l, const char *name, Slot x) { return prog_ins(l->p, (Ins){.op = IR_FN1, .a = x, .text = name}); }

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

static Slot load(Lower *l, IrArray array, const Symbol *s) {
  return prog_ins(l->p, (Ins){.op = IR_LOAD, .array = array, .index = s->index, .name = s->name});
}

static Slot load_param(Lower *l, const Symbol *s) {
  const Param *p = &l->e->m->params.at[s->index];
  if (p->fixed) return prog_num(l->p, p->number);
  return prog_ins(l->p, (Ins){.op = IR_LOAD, .array = ARR_P, .index = p->place, .name = s->name});
}

static Slot lower_symbol(Lower *l, Expr e) {
  const Symbol *s = expr_sym_of(l->g, e);
  switch (s->kind) {
    case SYM_TIME: return load(l, ARR_T, s);
    case SYM_COORD: return load(l, ARR_Q, s);
    case SYM_VEL: return load(l, ARR_V, s);
    case SYM_STATE: return load(l, ARR_Z, s);
    case SYM_PARAM: return load_param(l, s);
    case SYM_INPUT: return load(l, ARR_U, s);
    case SYM_CONST: return l->p->folds_constants ? prog_num(l->p, num_double(3.14159265358979323846)) : prog_ins(l->p, (Ins){.op = IR_PI});
    case SYM_ACC: case SYM_RATE: case SYM_MULTIPLIER: case SYM_LOCAL: break; /* slots are set before: see lower_with_accelerations */
  }
  return 0;
}

static Slot lower_node(Lower *l, Expr e) {
  ExprGraph *g = l->g;
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
    case EX_POW: return call2(l, "pow", e);
    case EX_SIN: case EX_COS: return lower_circular(l, o, a);
    case EX_TAN: case EX_ASIN: case EX_ACOS: case EX_ATAN: case EX_SINH: case EX_COSH: case EX_TANH: case EX_EXP:
    case EX_LOG: case EX_CBRT: return call1(l, expr_op_text(o), lower_slot(l, a));
    case EX_ABS: return call1(l, "fabs", lower_slot(l, a));
    case EX_SIGN: return op(l, IR_SIGN, lower_slot(l, a), 0);
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
    if (expr_map_get(&l->slots, list.at[i])) continue;
    Slot s = lower_node(l, list.at[i]);
    expr_map_set(&l->slots, list.at[i], s + 1);
  }
}

/* --- the functions of a model --- */

Lower lower_new(const Eqns *e) {
  Arena *a = e->m->arena;
  Prog *p = prog_new(a);
  p->folds_constants = e->m->nfixed > 0;
  return (Lower){.e = e, .g = e->g, .p = p, .slots = expr_map(a), .circular = expr_map(a)};
}

/* The program after its passes, with sums over pairs as nests when it has `from` instructions. */
static Prog *finished(const Lower *l, uint32_t from) { return passes_run(l->p, &(PassPlan){.nests_from = from}, NULL); }

static const char *text_of_symbol(const Lower *l, SymId s) { return expr_symbol(l->g, s)->name; }

/* Whether M is diagonal and there are neither definitions nor constraints: accelerations are not coupled. */
static int is_diagonal(const Eqns *e) {
  uint32_t off = e->system.ndefs + e->constraints.n;
  for (uint32_t k = 0; k < e->system.H.n; k++) off += e->system.H.at[k].row != e->system.H.at[k].col;
  return off == 0;
}

Prog *lower_accel_traced(const Eqns *e, int libm, StrBuf *trace) {
  Lower l = lower_new(e);
  const Model *m = e->m;
  Slot *acc = ARENA_ARRAY(m->arena, Slot, e->n + 1);
  lower_solution(&l, acc);
  if (m->states.n) lower_roots(&l, e->flow, m->states.n);
  if (e->first.ndivisors) lower_roots(&l, e->first.divisors, e->first.ndivisors);
  for (uint32_t i = 0; i < e->first.ndivisors; i++) lower_pivot(&l, lower_slot(&l, e->first.divisors[i]), 0);
  for (uint32_t i = 0; i < e->n; i++) prog_store(l.p, 0, i, acc[i], text_of_symbol(&l, m->coords.at[i].a));
  for (uint32_t i = 0; i < m->states.n; i++)
    prog_store(l.p, 1, i, lower_slot(&l, e->flow[i]), text_of_symbol(&l, m->states.at[i].rate));
  return passes_run(l.p, &(PassPlan){.nests_from = ROLL_FROM, .every_step = 1, .uncoupled = is_diagonal(e), .libm = libm}, trace);
}

Prog *lower_accel(const Eqns *e, int libm) { return lower_accel_traced(e, libm, NULL); }

/* Selects, by the flag ARR_FREE of each input, its formula or the constant at which it is held. */
static void lower_inputs_along(Lower *l) {
  const Model *m = l->e->m;
  for (uint32_t i = 0; i < m->inputs.n; i++) {
    const Input *in = &m->inputs.at[i];
    Expr symbol = expr_symbol(l->g, in->sym)->node;
    lower_roots(l, &in->value, 1);
    lower_roots(l, &symbol, 1);
    Slot is_free = prog_ins(l->p, (Ins){.op = IR_LOAD, .array = ARR_FREE, .index = i, .name = in->name});
    Slot holds = op(l, IR_LT, 0, is_free), formula = lower_slot(l, in->value), constant = lower_slot(l, symbol);
    Slot s = prog_ins(l->p, (Ins){.op = IR_SELECT, .a = holds, .b = formula, .c = constant});
    expr_map_set(&l->slots, symbol, s + 1);
  }
}

static void slot_entries(const Lower *l, const Entries *from, IrEntries *to) {
  for (uint32_t k = 0; k < from->n; k++)
    vec_push(l->p->arena, to, ((IrSlotEntry){from->at[k].row, from->at[k].col, lower_slot(l, from->at[k].e)}));
}

IrSystem lower_system(const Eqns *e) {
  Lower l = lower_new(e);
  const Model *m = e->m;
  Arena *a = m->arena;
  Slot *acc = ARENA_ARRAY(a, Slot, e->n + 1), *f = ARENA_ARRAY(a, Slot, e->n + 1), *flow = ARENA_ARRAY(a, Slot, m->states.n + 1);
  Name *rates = ARENA_ARRAY(a, Name, e->n + m->states.n + 1), *velocities = ARENA_ARRAY(a, Name, e->n + 1);
  FactorRecord *factored = ARENA_NEW(a, FactorRecord);
  IrSystem sys = {.p = l.p, .nq = e->n, .ndefs = e->n ? e->system.ndefs : 0, .nz = m->states.n, .f = f, .flow = flow, .rates = rates,
                  .velocities = velocities, .factored = factored};
  l.direct = 1;
  l.factored = factored;
  lower_inputs_along(&l);
  lower_solution(&l, acc);
  lower_roots(&l, e->flow, m->states.n);
  for (uint32_t i = 0; i < e->n; i++) {
    f[i] = lower_slot(&l, e->system.f[i]);
    rates[i] = text_of_symbol(&l, m->coords.at[i].a);
    velocities[i] = text_of_symbol(&l, m->coords.at[i].v);
  }
  for (uint32_t i = 0; i < m->states.n; i++) {
    flow[i] = lower_slot(&l, e->flow[i]);
    rates[e->n + i] = text_of_symbol(&l, m->states.at[i].rate);
  }
  if (e->n) {
    slot_entries(&l, &e->system.H, &sys.H);
    slot_entries(&l, &e->system.C, &sys.C);
  }
  sys.x = l.x;
  return sys;
}

void lower_with_accelerations(Lower *l, const Expr *roots, uint32_t n) {
  const Model *m = l->e->m;
  int needed = 0;
  for (uint32_t i = 0; i < n; i++) needed |= roots[i] && expr_kinds(l->g, roots[i]) & (1u << SYM_ACC | 1u << SYM_RATE | 1u << SYM_MULTIPLIER);
  if (needed) {
    Slot *acc = ARENA_ARRAY(m->arena, Slot, l->e->n + 1);
    l->coarse = 1;
    lower_solution(l, acc);
    for (uint32_t i = 0; i < l->e->n; i++) expr_map_set(&l->slots, expr_symbol(l->g, m->coords.at[i].a)->node, acc[i] + 1);
    for (uint32_t i = 0; i < l->e->constraints.n; i++)
      expr_map_set(&l->slots, expr_symbol(l->g, l->e->constraints.of[i]->multiplier)->node, l->multipliers[i] + 1);
    lower_roots(l, l->e->flow, m->states.n);
    for (uint32_t i = 0; i < m->states.n; i++)
      expr_map_set(&l->slots, expr_symbol(l->g, m->states.at[i].rate)->node, lower_slot(l, l->e->flow[i]) + 1);
  }
  lower_roots(l, roots, n);
}

Prog *lower_finish_seldom(const Lower *l) { return finished(l, ROLL_SELDOM_FROM); }

/* q'' is an argument of the function: its symbols become loads. */
static void load_accelerations(Lower *l) {
  const Model *m = l->e->m;
  for (uint32_t i = 0; i < l->e->n; i++) {
    const Symbol *s = expr_symbol(l->g, m->coords.at[i].a);
    Slot a = load(l, ARR_A, s);
    expr_map_set(&l->slots, s->node, a + 1);
  }
}

/* Name of component i of y = (q, q', z). */
static const char *component(const Lower *l, uint32_t i) {
  const Model *m = l->e->m;
  uint32_t n = l->e->n;
  return i < n ? m->coords.at[i].name : i < 2 * n ? text_of_symbol(l, m->coords.at[i - n].v) : m->states.at[i - 2 * n].name;
}

Prog *lower_linear(const Eqns *e, Partials dr) {
  Lower l = lower_new(e);
  Arena *a = e->m->arena;
  Expr *roots = ARENA_ARRAY(a, Expr, dr.n + e->mass.n + 1);
  for (uint32_t k = 0; k < dr.n; k++) roots[k] = dr.at[k].e;
  for (uint32_t k = 0; k < e->mass.n; k++) roots[dr.n + k] = e->mass.at[k].e;
  load_accelerations(&l);
  lower_roots(&l, roots, dr.n + e->mass.n);
  for (uint32_t k = 0; k < dr.n; k++) {
    uint32_t row = dr.at[k].row;
    const char *of = row < e->n ? component(&l, row) : text_of_symbol(&l, e->m->states.at[row - e->n].rate);
    prog_store(l.p, 0, k, lower_slot(&l, roots[k]), arena_printf(a, "%s by %s", of, component(&l, dr.at[k].col)));
  }
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *M = &e->mass.at[k];
    prog_store(l.p, 1, k, lower_slot(&l, M->e), arena_printf(a, "%s, %s", component(&l, M->row), component(&l, M->col)));
  }
  return finished(&l, ROLL_FROM);
}

Prog *lower_event_derivatives(const Eqns *e, EventPartials jumps) {
  Lower l = lower_new(e);
  Arena *a = e->m->arena;
  for (uint32_t k = 0; k < jumps.n; k++) lower_roots(&l, &jumps.at[k].e, 1);
  for (uint32_t k = 0; k < jumps.n; k++) {
    const EventPartial *j = &jumps.at[k];
    const char *event = e->m->events.at[j->event].name, *of = j->row < 0 ? "its function" : component(&l, (uint32_t)j->row);
    const char *by = j->col < 2 * e->n + e->m->states.n ? component(&l, j->col) : "t";
    prog_store(l.p, 0, k, lower_slot(&l, j->e), arena_printf(a, "event %s: %s by %s", event, of, by));
  }
  return prog_tidy(l.p);
}

Prog *lower_energy(const Eqns *e) {
  Lower l = lower_new(e);
  if (!e->energy) return l.p;
  Expr roots[2] = {e->energy_stable, e->energy_scale};
  lower_with_accelerations(&l, roots, 2); /* in first-order models velocities are rates */
  prog_store(l.p, 0, 0, lower_slot(&l, roots[0]), "energy p q' - L");
  prog_store(l.p, 0, 1, lower_slot(&l, roots[1]), "its scale |p q'| + |L|");
  return lower_finish_seldom(&l);
}

Prog *lower_variation(const Eqns *e, const Variation *x) {
  Lower l = lower_new(e);
  const Expr *const parts[] = {x->dLdq, x->momenta, x->forces};
  static const char *const words[] = {"dL/d%s", "p_%s", "Q_%s"};
  for (uint32_t k = 0; k < 3; k++) lower_roots(&l, parts[k], e->n);
  for (uint32_t k = 0; k < 3; k++)
    for (uint32_t i = 0; i < e->n; i++)
      prog_store(l.p, k, i, lower_slot(&l, parts[k][i]), arena_printf(l.p->arena, words[k], e->m->coords.at[i].name));
  return finished(&l, ROLL_FROM);
}

/* Comment of an entry of the second derivatives: d2L/dx' dx, or dQ_x/dx'. */
static const char *second_text(const Lower *l, const SecondEntry *s) {
  const Model *m = l->e->m;
  int force = s->part == SECOND_FQ || s->part == SECOND_FV;
  int of_v = s->part == SECOND_VQ || s->part == SECOND_VV, by_v = s->part == SECOND_VV || s->part == SECOND_FV;
  const char *by = by_v ? text_of_symbol(l, m->coords.at[s->col].v) : m->coords.at[s->col].name;
  const char *of = of_v ? text_of_symbol(l, m->coords.at[s->row].v) : m->coords.at[s->row].name;
  return arena_printf(l->p->arena, force ? "dQ_%s/d%s" : "d2L/d%s d%s", of, by);
}

Prog *lower_second_derivatives(const Eqns *e, const Variation *x) {
  Lower l = lower_new(e);
  Expr *roots = ARENA_ARRAY(e->m->arena, Expr, x->second.n + 1);
  for (uint32_t k = 0; k < x->second.n; k++) roots[k] = x->second.at[k].e;
  lower_roots(&l, roots, x->second.n);
  for (uint32_t k = 0; k < x->second.n; k++) prog_store(l.p, 0, k, lower_slot(&l, roots[k]), second_text(&l, &x->second.at[k]));
  return finished(&l, ROLL_FROM);
}

Prog *lower_events(const Eqns *e) {
  Lower l = lower_new(e);
  const Model *m = e->m;
  Expr *roots = ARENA_ARRAY(m->arena, Expr, m->events.n + 1);
  for (uint32_t i = 0; i < m->events.n; i++) roots[i] = m->events.at[i].g;
  lower_with_accelerations(&l, roots, m->events.n);
  for (uint32_t i = 0; i < m->events.n; i++) prog_store(l.p, 0, i, lower_slot(&l, m->events.at[i].g), m->events.at[i].name);
  return finished(&l, ROLL_FROM);
}

Prog *lower_switches(const Eqns *e, SwitchingSurfaces all) {
  Lower l = lower_new(e);
  Expr *roots = ARENA_ARRAY(e->m->arena, Expr, all.n + 1);
  for (uint32_t i = 0; i < all.n; i++) roots[i] = all.at[i].side;
  lower_with_accelerations(&l, roots, all.n);
  for (uint32_t i = 0; i < all.n; i++) prog_store(l.p, 0, i, lower_slot(&l, roots[i]), all.at[i].text);
  return lower_finish_seldom(&l);
}

static uint32_t array_of_target(SymKind k) { return k == SYM_COORD ? 0 : k == SYM_VEL ? 1 : 2; }

static void store_target(Lower *l, SymId target, Expr value) {
  const Symbol *s = expr_symbol(l->g, target);
  prog_store(l->p, array_of_target(s->kind), s->index, lower_slot(l, value), s->name);
}

Prog *lower_action(const Eqns *e, uint32_t event) {
  Lower l = lower_new(e);
  const Event *ev = &e->m->events.at[event];
  for (uint32_t i = 0; i < ev->actions.n; i++) lower_roots(&l, &ev->actions.at[i].value, 1);
  for (uint32_t i = 0; i < ev->actions.n; i++) store_target(&l, ev->actions.at[i].target, ev->actions.at[i].value);
  return prog_tidy(l.p);
}

static Slot lower_table(Lower *l, const Input *in) {
  Slot t = load(l, ARR_T, expr_symbol(l->g, l->e->m->time));
  vec_push(l->p->arena, &l->p->tables, ((IrTable){in->name, in->file, in->table}));
  return prog_ins(l->p, (Ins){.op = IR_TABLE, .a = t, .index = l->p->tables.n - 1});
}

Prog *lower_inputs(const Eqns *e) {
  Lower l = lower_new(e);
  const Model *m = e->m;
  for (uint32_t i = 0; i < m->inputs.n; i++)
    if (m->inputs.at[i].value) lower_roots(&l, &m->inputs.at[i].value, 1);
  for (uint32_t i = 0; i < m->inputs.n; i++) {
    const Input *in = &m->inputs.at[i];
    Slot s = in->table ? lower_table(&l, in) : lower_slot(&l, in->value);
    prog_store(l.p, 0, i, s, in->name);
  }
  return prog_tidy(l.p);
}

/* Closed forms are input symbols numbered behind the model's inputs. */
static int is_closed_form(const Symbol *s, const void *data) { return s->kind == SYM_INPUT && s->index >= *(const uint32_t *)data; }

int output_is_plain(const Eqns *e, uint32_t i) {
  return !e->m->scene.exacts.n || !expr_contains(e->g, e->outputs[i].value, is_closed_form, &e->m->inputs.n);
}

static Prog *outputs(const Eqns *e, int plain_only) {
  Lower l = lower_new(e);
  Expr *roots = ARENA_ARRAY(e->m->arena, Expr, e->noutputs + 1);
  const Output **of = ARENA_ARRAY(e->m->arena, const Output *, e->noutputs + 1);
  uint32_t n = 0;
  for (uint32_t i = 0; i < e->noutputs; i++) {
    if (plain_only && !output_is_plain(e, i)) continue;
    of[n] = &e->outputs[i];
    roots[n++] = e->outputs[i].value;
  }
  lower_with_accelerations(&l, roots, n);
  for (uint32_t i = 0; i < n; i++) prog_store(l.p, 0, i, lower_slot(&l, roots[i]), of[i]->name);
  return lower_finish_seldom(&l);
}

Prog *lower_outputs(const Eqns *e) { return outputs(e, 0); }
Prog *lower_plain_outputs(const Eqns *e) { return outputs(e, 1); }

Prog *lower_closed_forms(const Eqns *e) {
  Lower l = lower_new(e);
  const Scene *sc = &e->m->scene;
  for (uint32_t i = 0; i < sc->exacts.n; i++) lower_roots(&l, &sc->exacts.at[i].value, 1);
  for (uint32_t i = 0; i < sc->exacts.n; i++) prog_store(l.p, 0, i, lower_slot(&l, sc->exacts.at[i].value), sc->exacts.at[i].name);
  return prog_tidy(l.p);
}

Prog *lower_param(const Eqns *e, uint32_t i) {
  Lower l = lower_new(e);
  const Param *p = &e->m->params.at[i];
  lower_roots(&l, &p->value, 1);
  prog_store(l.p, 0, p->place, lower_slot(&l, p->value), p->name);
  return prog_tidy(l.p);
}

Prog *lower_start(const Eqns *e) {
  Lower l = lower_new(e);
  const Scene *sc = &e->m->scene;
  for (uint32_t i = 0; i < sc->starts.n; i++) lower_roots(&l, &sc->starts.at[i].value, 1);
  for (uint32_t i = 0; i < sc->starts.n; i++) store_target(&l, sc->starts.at[i].target, sc->starts.at[i].value);
  return prog_tidy(l.p);
}
