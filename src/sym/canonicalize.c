/* Canonical construction of sums, products, powers and functions; the guarantees are listed in expr.h.
 * Sums and products are collected in arrays of pairs, sorted by node, then hash-consed. */
#include <math.h>
#include <stdlib.h>

#include "sym/expr.h"
#include "sym/expr_impl.h"
#include "sym/sum_nest.h"

static int by_node(const void *a, const void *b) {
  Expr x = ((const Pair *)a)->node, y = ((const Pair *)b)->node;
  return (x > y) - (x < y);
}

/* Sorts by node, adds the numbers of equal nodes, drops zeros. */
static void collect(Pairs *p) {
  if (p->n > 1) qsort(p->at, p->n, sizeof *p->at, by_node);
  uint32_t out = 0;
  for (uint32_t i = 0; i < p->n;) {
    Pair one = p->at[i++];
    while (i < p->n && p->at[i].node == one.node) one.number = num_add(one.number, p->at[i++].number);
    if (!num_is_zero(one.number)) p->at[out++] = one;
  }
  p->n = out;
}

static Expr make_pairs(ExprGraph *g, ExprOp op, const Pairs *p) {
  Expr room[2 * ROOM], *args = p->n <= ROOM ? room : ARENA_ARRAY(g->arena, Expr, 2 * p->n);
  for (uint32_t i = 0; i < p->n; i++) {
    args[2 * i] = p->at[i].node;
    args[2 * i + 1] = expr_num(g, p->at[i].number);
  }
  Expr e = expr_make(g, op, args, 2 * p->n);
  if (args != room) arena_recycle(g->arena, args, 2 * p->n * sizeof *args);
  return e;
}

/* --- sums --- */

/* Room for n more pairs. */
static void reserve_pairs(ExprGraph *g, Pairs *p, uint32_t n) {
  Pairs old = *p;
  if (old.cap - old.n >= n) return;
  while (p->cap - p->n < n) p->cap = p->cap ? 2 * p->cap : ROOM;
  p->at = ARENA_ARRAY(g->arena, Pair, p->cap);
  memcpy(p->at, old.at, old.n * sizeof *old.at);
  if (old.cap > ROOM) arena_recycle(g->arena, old.at, old.cap * sizeof *old.at);
}

static void push_terms(ExprGraph *g, Pairs *p, Expr e, Num c) {
  if (expr_is_num(g, e)) {
    Pair one = {g->one, num_mul(c, expr_number(g, e))};
    vec_push(g->arena, p, one);
    return;
  }
  uint32_t n = expr_pairs(g, e, EX_SUM);
  reserve_pairs(g, p, n + 1);
  for (uint32_t i = 0; i < n; i++) {
    Num k;
    Expr t = expr_pair(g, e, EX_SUM, i, &k);
    Pair one = {t, num_mul(c, k)};
    vec_push(g->arena, p, one);
  }
}

/* The pair of a term, by binary search; NULL if absent. */
static Pair *find_term(const Pairs *p, Expr term) {
  uint32_t lo = 0, hi = p->n;
  while (lo < hi) {
    uint32_t mid = lo + (hi - lo) / 2;
    if (p->at[mid].node < term) lo = mid + 1;
    else hi = mid;
  }
  return lo < p->n && p->at[lo].node == term ? &p->at[lo] : NULL;
}

/* Finds a factor sin u, cos u, sinh u or cosh u to a power >= 2 in term, from pair `from` on: its function *op,
 * argument *u, pair *at. */
static int squared_function(const ExprGraph *g, Expr term, Expr *u, ExprOp *op, uint32_t from, uint32_t *at) {
  if (expr_op(g, term) != EX_PROD) return 0;
  for (uint32_t i = from; i < expr_pairs(g, term, EX_PROD); i++) {
    Num e;
    Expr base = expr_pair(g, term, EX_PROD, i, &e);
    ExprOp o = expr_op(g, base);
    if ((o == EX_SIN || o == EX_COS || o == EX_SINH || o == EX_COSH) && num_cmp(e, num_int(2)) >= 0) {
      *u = expr_arg(g, base, 0);
      *op = o;
      *at = i;
      return 1;
    }
  }
  return 0;
}

static ExprOp cofunction(ExprOp op) {
  return op == EX_SIN ? EX_COS : op == EX_COS ? EX_SIN : op == EX_SINH ? EX_COSH : EX_SINH;
}

/* Applies sin^2 + cos^2 = 1 or cosh^2 - sinh^2 = 1 once to the collected pairs: R sin^2 + R cos^2 -> R, and
 * R - R sin^2 -> R cos^2. Returns 1 when a pair changed. */
static int use_pythagoras(ExprGraph *g, Pairs *p) {
  for (uint32_t i = 0; i < p->n; i++) {
    Expr u;
    ExprOp op;
    uint32_t at = 0;
    for (uint32_t from = 0; squared_function(g, p->at[i].node, &u, &op, from, &at); from = at + 1) {
      Expr self = expr_fn(g, op, u), other = expr_fn(g, cofunction(op), u);
      Expr self_inv2 = expr_pow_num(g, self, num_int(-2)), other2 = expr_pow_num(g, other, num_int(2));
      Expr rest = expr_mul(g, p->at[i].node, self_inv2);
      Expr partner = expr_mul(g, rest, other2);
      Num c = p->at[i].number, minus = num_neg(c);
      Pair *q = find_term(p, partner);
      if (q && q != &p->at[i] && num_equal(q->number, op == EX_SINH || op == EX_COSH ? minus : c)) {
        q->number = num_int(0);
        p->at[i] = (Pair){rest, op == EX_SINH ? minus : c};
        return 1;
      }
      q = find_term(p, rest);
      if (q && num_equal(q->number, op == EX_SINH ? c : minus)) {
        p->at[i].number = num_int(0);
        *q = (Pair){partner, op == EX_COSH ? c : q->number};
        return 1;
      }
    }
  }
  return 0;
}

/* Splits and collects the pairs again: a rewritten pair may have a number, or a sum of one pair, as its node. */
static void renormalise(ExprGraph *g, Pairs *p) {
  Pair room[ROOM];
  Pairs fresh = ROOM_FOR(room);
  for (uint32_t i = 0; i < p->n; i++)
    if (!num_is_zero(p->at[i].number)) push_terms(g, &fresh, p->at[i].node, p->at[i].number);
  p->n = 0;
  for (uint32_t i = 0; i < fresh.n; i++) vec_push(g->arena, p, fresh.at[i]);
  collect(p);
}

static Expr collected_sum(ExprGraph *g, Pairs *p) {
  collect(p);
  while (p->n > 1 && p->n <= 4096 && use_pythagoras(g, p)) renormalise(g, p);
  if (p->n == 0) return g->zero;
  if (p->n == 1) {
    if (p->at[0].node == g->one) return expr_num(g, p->at[0].number);
    if (num_is_one(p->at[0].number)) return p->at[0].node;
  }
  return make_pairs(g, EX_SUM, p);
}

/* The sum of the pairs, which are given up. */
static Expr finish_sum(ExprGraph *g, Pairs *p) {
  Expr sum = collected_sum(g, p);
  if (p->cap > ROOM) arena_recycle(g->arena, p->at, p->cap * sizeof *p->at);
  return sum;
}

Expr expr_add_n(ExprGraph *g, const Expr *terms, uint32_t n) {
  Pair room[ROOM];
  Pairs p = ROOM_FOR(room);
  for (uint32_t i = 0; i < n; i++) push_terms(g, &p, terms[i], num_int(1));
  return finish_sum(g, &p);
}

Expr expr_add(ExprGraph *g, Expr a, Expr b) {
  if (a == g->zero) return b;
  if (b == g->zero) return a;
  Expr both[2] = {a, b};
  return expr_add_n(g, both, 2);
}

Expr expr_scale(ExprGraph *g, Num c, Expr a) {
  if (num_is_one(c)) return a;
  Pair room[ROOM];
  Pairs p = ROOM_FOR(room);
  push_terms(g, &p, a, c);
  return finish_sum(g, &p);
}

Expr expr_neg(ExprGraph *g, Expr a) { return expr_scale(g, num_int(-1), a); }

Expr expr_sub(ExprGraph *g, Expr a, Expr b) {
  Pair room[ROOM];
  Pairs p = ROOM_FOR(room);
  push_terms(g, &p, a, num_int(1));
  push_terms(g, &p, b, num_int(-1));
  return finish_sum(g, &p);
}

/* --- products --- */

/* Content of a sum: the gcd of its coefficients with the sign of the first; +-1 if one is inexact. */
static Num content(const ExprGraph *g, Expr sum) {
  Num k, c;
  expr_pair(g, sum, EX_SUM, 0, &c);
  if (!num_is_exact(c)) return num_int(num_sign(c));
  int sign = num_sign(c);
  for (uint32_t i = 0; i < expr_pairs(g, sum, EX_SUM); i++) {
    expr_pair(g, sum, EX_SUM, i, &k);
    if (!num_is_exact(k)) return num_int(sign);
    c = num_gcd(c, k);
  }
  return sign < 0 ? num_neg(c) : c;
}

static void push_factor(ExprGraph *g, Product *r, Expr base, Num e) {
  if (!num_is_zero(e)) {
    Pair one = {base, e};
    vec_push(g->arena, &r->p, one);
  }
}

static void push_number_power(ExprGraph *g, Product *r, Num base, Num e) {
  int exact;
  Num v = num_pow(base, e, &exact);
  int whole = num_is_exact(base) && num_is_int(e); /* folded although it overflows 64 bits: 10^30 is a double */
  if (exact || whole || !num_is_exact(base) || !num_is_exact(e)) r->c = num_mul(r->c, v);
  else push_factor(g, r, expr_num(g, base), e);
}

/* Power of a product; for powers that are not whole, of its positive factors one by one. */
static void push_product_power(ExprGraph *g, Product *r, Expr base, Num e) {
  int whole = num_is_int(e);
  Pair room[ROOM];
  Product kept = {.c = num_int(1), .p = ROOM_FOR(room)};
  for (ExprPair b = {0}; expr_next_pair(g, base, EX_PROD, &b);) {
    if (whole || expr_sign(g, b.of) == SIGN_POSITIVE) push_factor(g, r, b.of, num_mul(b.num, e));
    else push_factor(g, &kept, b.of, b.num);
  }
  if (kept.p.n == 0) return;
  if (kept.p.n == 1 && num_is_one(kept.p.at[0].number)) push_factor(g, r, kept.p.at[0].node, e);
  else if (kept.p.n == 1 && num_is_exact(kept.p.at[0].number) && kept.p.at[0].number.num % 2 == 0 &&
           kept.p.at[0].number.den == 1) {
    Expr size = expr_fn(g, EX_ABS, kept.p.at[0].node); /* (x^2)^(1/2) = |x| */
    push_factor(g, r, size, num_mul(kept.p.at[0].number, e));
  } else push_factor(g, r, make_pairs(g, EX_PROD, &kept.p), e);
}

/* (b^k)^e is b^(k e) where e is an integer or b is known to be positive. */
void expr_push_power(ExprGraph *g, Product *r, Expr base, Num e) {
  int whole = num_is_int(e);
  switch (expr_op(g, base)) {
    case EX_NUM: push_number_power(g, r, expr_number(g, base), e); return;
    case EX_PROD: push_product_power(g, r, base, e); return;
    case EX_SUM: {
      Expr cosh = whole && num_sign(e) > 0 ? 0 : expr_cosh_of_tanh(g, base);
      if (cosh) {
        push_factor(g, r, cosh, num_mul(num_int(-2), e));
        return;
      }
      Num c = content(g, base);
      if (num_is_one(c) || (!whole && expr_pairs(g, base, EX_SUM) > 1) || (!whole && num_sign(c) < 0)) {
        push_factor(g, r, base, e);
        return;
      }
      push_number_power(g, r, c, e);
      Expr primitive = expr_scale(g, num_div(num_int(1), c), base);
      if (expr_op(g, primitive) == EX_SUM) push_factor(g, r, primitive, e);
      else expr_push_power(g, r, primitive, e);
      return;
    }
    case EX_ABS:
      if (whole && num_is_int(e) && e.num % 2 == 0) { /* |x|^2 = x^2 */
        expr_push_power(g, r, expr_arg(g, base, 0), e);
        return;
      }
      push_factor(g, r, base, e);
      return;
    case EX_SYM: case EX_DEF: case EX_NEST: case EX_CELL: case EX_POW: EX_FUNCTION_CASES
    case EX_SIGN: case EX_FLOOR: case EX_ATAN2: case EX_HYPOT: case EX_MIN: case EX_MAX: case EX_LT:
    case EX_LE: case EX_EQ: case EX_NOT: case EX_AND: case EX_OR: case EX_SELECT: case EX_COUNT: break;
  }
  push_factor(g, r, base, e);
}

/* Pushes again the factors whose collected exponent allows a simplification (2^(1/2) squared). Returns 1 when r
 * changed. */
static int simplify_factors(ExprGraph *g, Product *r) {
  Pair room[ROOM];
  Product again = {.c = r->c, .p = ROOM_FOR(room)};
  int changed = 0;
  for (uint32_t i = 0; i < r->p.n; i++) {
    Pair f = r->p.at[i];
    ExprOp op = expr_op(g, f.node);
    if (op == EX_NUM || (op == EX_PROD && num_is_int(f.number)) || (op == EX_SUM && num_is_int(f.number)) ||
        (op == EX_ABS && num_is_int(f.number))) {
      uint32_t before = again.p.n;
      Num c = again.c;
      expr_push_power(g, &again, f.node, f.number);
      changed |= again.p.n != before + 1 || again.p.at[before].node != f.node || !num_equal(c, again.c);
    } else push_factor(g, &again, f.node, f.number);
  }
  if (changed) {
    r->c = again.c;
    r->p.n = 0;
    for (uint32_t i = 0; i < again.p.n; i++) vec_push(g->arena, &r->p, again.p.at[i]);
    collect(&r->p);
  }
  return changed;
}

/* The product r multiplied out over its factor `at`, a sum. */
static Expr distribute_factor(ExprGraph *g, Product *r, uint32_t at) {
  Expr T = r->p.at[at].node;
  uint32_t n = expr_pairs(g, T, EX_SUM);
  Expr *terms = ARENA_ARRAY(g->arena, Expr, n);
  r->p.at[at].number = num_int(0);
  collect(&r->p);
  Expr rest = r->p.n == 1 && num_is_one(r->p.at[0].number) ? r->p.at[0].node : make_pairs(g, EX_PROD, &r->p);
  for (uint32_t i = 0; i < n; i++) {
    Num c;
    Expr term = expr_pair(g, T, EX_SUM, i, &c), product = expr_mul(g, rest, term);
    terms[i] = expr_scale(g, num_mul(c, r->c), product);
  }
  return expr_add_n(g, terms, n);
}

static Expr finish_product(ExprGraph *g, Product *r) {
  do {
    collect(&r->p);
    while (simplify_factors(g, r)) continue;
  } while (expr_rewrite_quotient(g, r));
  if (num_is_zero(r->c)) return g->zero;
  if (r->p.n == 0) return expr_num(g, r->c);
  uint32_t mixed = expr_sum_to_distribute(g, r);
  if (mixed < r->p.n) return distribute_factor(g, r, mixed);
  Expr e = r->p.n == 1 && num_is_one(r->p.at[0].number) ? r->p.at[0].node : make_pairs(g, EX_PROD, &r->p);
  return expr_scale(g, r->c, e);
}

Expr expr_mul_n(ExprGraph *g, const Expr *factors, uint32_t n) {
  Pair room[ROOM];
  Product r = {.c = num_int(1), .p = ROOM_FOR(room)};
  for (uint32_t i = 0; i < n; i++) {
    if (factors[i] == g->zero) return g->zero;
    Expr f = factors[i];
    if (expr_op(g, f) == EX_PROD) {
      for (ExprPair b = {0}; expr_next_pair(g, f, EX_PROD, &b);)
        push_factor(g, &r, b.of, b.num);
    } else expr_push_power(g, &r, f, num_int(1));
  }
  return finish_product(g, &r);
}

Expr expr_mul(ExprGraph *g, Expr a, Expr b) {
  if (a == g->one) return b;
  if (b == g->one) return a;
  if (expr_is_num(g, a)) return expr_scale(g, expr_number(g, a), b);
  if (expr_is_num(g, b)) return expr_scale(g, expr_number(g, b), a);
  Expr both[2] = {a, b};
  return expr_mul_n(g, both, 2);
}

Expr expr_pow_num(ExprGraph *g, Expr base, Num e) {
  if (num_is_zero(e)) return g->one;
  if (num_is_one(e)) return base;
  if (base == g->zero && num_sign(e) > 0) return g->zero;
  Pair room[ROOM];
  Product r = {.c = num_int(1), .p = ROOM_FOR(room)};
  expr_push_power(g, &r, base, e);
  return finish_product(g, &r);
}

Expr expr_div(ExprGraph *g, Expr a, Expr b) {
  Expr inverse = expr_pow_num(g, b, num_int(-1));
  return expr_mul(g, a, inverse);
}

Expr expr_sqrt(ExprGraph *g, Expr a) { return expr_pow_num(g, a, num_ratio(1, 2)); }

Expr expr_pow(ExprGraph *g, Expr base, Expr exponent) {
  if (expr_is_num(g, exponent)) return expr_pow_num(g, base, expr_number(g, exponent));
  if (base == g->one) return base;
  Expr both[2] = {base, exponent};
  return expr_make(g, EX_POW, both, 2);
}

/* --- functions --- */

/* Whether the first coefficient of an argument is negative; odd and even functions then take -a. */
static int has_negative_lead(const ExprGraph *g, Expr a) {
  if (expr_is_num(g, a)) return num_sign(expr_number(g, a)) < 0;
  Num c;
  expr_pair(g, a, EX_SUM, 0, &c);
  return num_sign(c) < 0;
}

enum { NONE, ZERO, ONE };

#define KNOWN(OP, name, latex, symmetry, at_0, ...) [EX_##OP] = {symmetry, at_0},
static const struct {
  uint8_t symmetry, at_0; /* exact value at 0 */
} known[EX_COUNT] = {FUNCTIONS(KNOWN) [EX_SIGN] = {ODD, ZERO}, [EX_ABS] = {EVEN, ZERO}};

Symmetry expr_symmetry(ExprOp op) { return known[op].symmetry; }

/* Exact value of f(a), such as f(0), |a| of known sign, log(exp u); 0 if there is none. */
static Expr fold_fn(ExprGraph *g, ExprOp op, Expr a) {
  if (a == g->zero && known[op].at_0 != NONE) return known[op].at_0 == ONE ? g->one : g->zero;
  if (a == g->one && op == EX_LOG) return g->zero;
  if (op == EX_ABS || op == EX_SIGN) {
    ExprSign s = expr_sign(g, a);
    if (s == SIGN_POSITIVE) return op == EX_ABS ? a : g->one;
    if (s == SIGN_NEGATIVE) return op == EX_ABS ? expr_neg(g, a) : g->minus_one;
    if (op == EX_ABS && s == SIGN_NONNEGATIVE) return a;
    if (op == EX_ABS && s == SIGN_NONPOSITIVE) return expr_neg(g, a);
  }
  if (op == EX_FLOOR && expr_is_num(g, a) && num_is_exact(expr_number(g, a))) {
    Num x = expr_number(g, a);
    return expr_num(g, num_int(x.num / x.den - (x.num < 0 && x.num % x.den)));
  }
  if (op == EX_LOG && expr_op(g, a) == EX_EXP) return expr_arg(g, a, 0);
  if (op == EX_EXP && expr_op(g, a) == EX_LOG) return expr_arg(g, a, 0);
  if (op == EX_NOT && expr_op(g, a) == EX_NOT) return expr_arg(g, a, 0);
  if (op == EX_NOT && expr_is_num(g, a)) return expr_is_zero(g, a) ? g->one : g->zero;
  return 0;
}

Expr expr_fn(ExprGraph *g, ExprOp op, Expr a) {
  Expr folded = fold_fn(g, op, a);
  if (folded) return folded;
  if (expr_symmetry(op) != NEITHER && has_negative_lead(g, a)) {
    Expr turned = expr_neg(g, a);
    Expr f = expr_fn(g, op, turned);
    return expr_symmetry(op) == ODD ? expr_neg(g, f) : f;
  }
  return expr_make(g, op, &a, 1);
}

static Expr truth(ExprGraph *g, int yes) { return yes ? g->one : g->zero; }

static Expr fold_fn2(ExprGraph *g, ExprOp op, Expr a, Expr b) {
  int numbers = expr_is_num(g, a) && expr_is_num(g, b);
  Num gap = numbers ? num_sub(expr_number(g, a), expr_number(g, b)) : num_int(0);
  int cmp = num_sign(gap);
  numbers &= num_sign_is_sure(gap);
  switch (op) {
    case EX_LT: return numbers ? truth(g, cmp < 0) : a == b ? g->zero : 0;
    case EX_LE: return numbers ? truth(g, cmp <= 0) : a == b ? g->one : 0;
    case EX_EQ: return numbers ? truth(g, cmp == 0) : a == b ? g->one : 0;
    case EX_MIN: return a == b ? a : numbers ? (cmp < 0 ? a : b) : 0;
    case EX_MAX: return a == b ? a : numbers ? (cmp > 0 ? a : b) : 0;
    case EX_AND:
      if (a == g->zero || b == g->zero) return g->zero;
      return a == g->one ? b : b == g->one ? a : 0;
    case EX_OR:
      if (a == g->one || b == g->one) return g->one;
      return a == g->zero ? b : b == g->zero ? a : 0;
    case EX_HYPOT:
      if (a == g->zero) return expr_fn(g, EX_ABS, b);
      return b == g->zero ? expr_fn(g, EX_ABS, a) : 0;
    case EX_ATAN2: return a == g->zero && expr_sign(g, b) == SIGN_POSITIVE ? g->zero : 0;
    case EX_NUM: case EX_SYM: case EX_DEF: case EX_SUM: case EX_PROD: case EX_NEST: case EX_CELL: case EX_POW:
    EX_FUNCTION_CASES
    case EX_ABS: case EX_SIGN: case EX_FLOOR: case EX_NOT:
    case EX_SELECT: case EX_COUNT: break;
  }
  return 0;
}

static int commutes(ExprOp op) {
  return op == EX_MIN || op == EX_MAX || op == EX_EQ || op == EX_AND || op == EX_OR || op == EX_HYPOT;
}

Expr expr_fn2(ExprGraph *g, ExprOp op, Expr a, Expr b) {
  Expr folded = fold_fn2(g, op, a, b);
  if (folded) return folded;
  Expr both[2] = {a, b};
  if (commutes(op) && a > b) {
    both[0] = b;
    both[1] = a;
  }
  return expr_make(g, op, both, 2);
}

Expr expr_select(ExprGraph *g, Expr condition, Expr a, Expr b) {
  if (condition == g->one || a == b) return a;
  if (condition == g->zero) return b;
  Expr three[3] = {condition, a, b};
  return expr_make(g, EX_SELECT, three, 3);
}

Expr expr_rebuild(ExprGraph *g, Expr e, const Expr *args) {
  uint32_t n = expr_nargs(g, e);
  switch (expr_op(g, e)) {
    case EX_NUM: case EX_SYM: case EX_COUNT: return e;
    case EX_DEF: return expr_def(g, expr_def_name(g, e), args[0]);
    case EX_SUM: {
      Pair room[ROOM];
      Pairs p = ROOM_FOR(room);
      for (uint32_t i = 0; i < n; i += 2) push_terms(g, &p, args[i], expr_number(g, args[i + 1]));
      return finish_sum(g, &p);
    }
    case EX_PROD: {
      Pair room[ROOM];
      Product r = {.c = num_int(1), .p = ROOM_FOR(room)};
      for (uint32_t i = 0; i < n; i += 2) {
        if (args[i] == g->zero && num_sign(expr_number(g, args[i + 1])) > 0) return g->zero;
        expr_push_power(g, &r, args[i], expr_number(g, args[i + 1]));
      }
      return finish_product(g, &r);
    }
    case EX_NEST: return expr_nest_rebuilt(g, args, n);
    case EX_CELL: return expr_cell_rebuilt(g, args);
    case EX_POW: return expr_pow(g, args[0], args[1]);
    case EX_SELECT: return expr_select(g, args[0], args[1], args[2]);
    EX_FUNCTION_CASES
    case EX_ABS: case EX_SIGN: case EX_FLOOR: case EX_NOT: return expr_fn(g, expr_op(g, e), args[0]);
    case EX_ATAN2: case EX_HYPOT: case EX_MIN: case EX_MAX: case EX_LT: case EX_LE: case EX_EQ:
    case EX_AND: case EX_OR: return expr_fn2(g, expr_op(g, e), args[0], args[1]);
  }
  return e;
}
