/* simplify_stable: half-angle forms and differences of squares against cancellation, bottom-up, one sum at a time. */
#include "sym/simplify.h"

#include "sym/expr_impl.h"

typedef struct {
  Expr e;
  Num c;
} SumTerm;

typedef struct {
  ExprGraph *g;
  SumTerm *at;
  uint32_t n;
} SumTerms;

enum { MAX_TERMS = 4096 }; /* the search for partners is quadratic */

static SumTerms terms_of(ExprGraph *g, Expr sum) {
  SumTerms t = {.g = g, .n = expr_pairs(g, sum, EX_SUM)};
  t.at = ARENA_ARRAY(expr_arena(g), SumTerm, t.n + 1);
  for (uint32_t i = 0; i < t.n; i++) t.at[i].e = expr_pair(g, sum, EX_SUM, i, &t.at[i].c);
  return t;
}

static Expr sum_of(const SumTerms *t) {
  Expr *list = ARENA_ARRAY(expr_arena(t->g), Expr, t->n + 1);
  for (uint32_t i = 0; i < t->n; i++) list[i] = expr_scale(t->g, t->at[i].c, t->at[i].e);
  return expr_add_n(t->g, list, t->n);
}

/* --- half angles --- */

/* Factor i of a term if it is cos u or cosh u to the first power; 0 otherwise. */
static Expr cosine_at(const ExprGraph *g, Expr term, uint32_t i) {
  Num k;
  Expr base = expr_pair(g, term, EX_PROD, i, &k);
  return num_is_one(k) && (expr_op(g, base) == EX_COS || expr_op(g, base) == EX_COSH) ? base : 0;
}

static SumTerm *find(const SumTerms *t, Expr e) {
  for (uint32_t i = 0; i < t->n; i++)
    if (t->at[i].e == e && !num_is_zero(t->at[i].c)) return &t->at[i];
  return NULL;
}

/* Removes the terms of c*R from the sum; returns 0 and changes nothing if one is missing. */
static int remove_multiple(SumTerms *t, Expr R, Num c) {
  uint32_t n = expr_is_num(t->g, R) ? 1 : expr_pairs(t->g, R, EX_SUM);
  for (int remove = 0; remove < 2; remove++)
    for (uint32_t i = 0; i < n; i++) {
      Num k;
      Expr e = expr_pair(t->g, R, EX_SUM, i, &k);
      SumTerm *one = find(t, e);
      if (!one || !num_equal(one->c, num_mul(c, k))) return 0;
      if (remove) one->c = num_int(0);
    }
  return 1;
}

/* 2*c*R*f(u/2)^2 */
static Expr half_angle(ExprGraph *g, Num c, Expr R, ExprOp f, Expr u) {
  Expr half = expr_scale(g, num_ratio(1, 2), u);
  Expr fu = expr_fn(g, f, half);
  Expr square = expr_pow_num(g, fu, num_int(2));
  Expr product = expr_mul(g, R, square);
  return expr_scale(g, num_mul(num_int(2), c), product);
}

/* Rewrites c*R*cos u + d*R, term i with its factor `cosine`: for d = -c into the form with sin(u/2)^2, for d = c
 * with cos(u/2)^2. */
static int use_half_angle(SumTerms *t, uint32_t i, Expr cosine) {
  ExprGraph *g = t->g;
  Num c = t->at[i].c;
  Expr inverse = expr_pow_num(g, cosine, num_int(-1)), u = expr_arg(g, cosine, 0);
  Expr R = expr_mul(g, t->at[i].e, inverse);
  int circular = expr_op(g, cosine) == EX_COS;
  ExprOp f;
  if (remove_multiple(t, R, num_neg(c))) f = circular ? EX_SIN : EX_SINH;
  else if (circular && remove_multiple(t, R, c)) f = EX_COS;
  else return 0;
  if (f == EX_SIN) c = num_neg(c);
  t->at[i] = (SumTerm){.e = half_angle(g, c, R, f, u), .c = num_int(1)};
  return 1;
}

static int use_half_angles(SumTerms *t, uint32_t i) {
  Expr term = t->at[i].e;
  if (num_is_zero(t->at[i].c)) return 0;
  for (uint32_t k = 0; k < expr_pairs(t->g, term, EX_PROD); k++) {
    Expr cosine = cosine_at(t->g, term, k);
    if (cosine && use_half_angle(t, i, cosine)) return 1;
  }
  return 0;
}

/* --- differences of squares --- */

/* Square root of e: z for z^2 where z is a symbol or definition, 1 for 1; 0 otherwise. */
static Expr square_root(ExprGraph *g, Expr e) {
  if (expr_is_num(g, e)) return e;
  if (expr_op(g, e) != EX_PROD || expr_pairs(g, e, EX_PROD) != 1) return 0;
  Num k;
  Expr base = expr_pair(g, e, EX_PROD, 0, &k);
  ExprOp op = expr_op(g, base);
  return num_equal(k, num_int(2)) && (op == EX_SYM || op == EX_DEF) ? base : 0;
}

/* c*((r*a)^2 - b^2) as c*(r*a - b)*(r*a + b); 0 if the sum is not of this form. */
static Expr difference_of_squares(const SumTerms *t) {
  ExprGraph *g = t->g;
  if (t->n != 2 || num_sign(t->at[0].c) * num_sign(t->at[1].c) >= 0) return 0;
  Expr a = square_root(g, t->at[0].e), b = square_root(g, t->at[1].e);
  Num c = num_neg(t->at[1].c), ratio = num_div(t->at[0].c, c);
  int exact = 0;
  Num r = num_is_exact(ratio) ? num_pow(ratio, num_ratio(1, 2), &exact) : ratio;
  if (!a || !b || !exact) return 0;
  Expr ra = expr_scale(g, r, a);
  Expr minus = expr_sub(g, ra, b), plus = expr_add(g, ra, b);
  Expr product = expr_mul(g, minus, plus);
  return expr_scale(g, c, product);
}

static Expr with_half_angles(ExprGraph *g, Expr e) {
  if (expr_op(g, e) != EX_SUM || expr_pairs(g, e, EX_SUM) > MAX_TERMS) return e;
  SumTerms t = terms_of(g, e);
  int changed = 0;
  for (uint32_t i = 0; i < t.n; i++) changed |= use_half_angles(&t, i);
  return changed ? sum_of(&t) : e;
}

static Expr stable_sum(ExprGraph *g, Expr e) {
  Expr half = with_half_angles(g, e);
  if (half != e || expr_op(g, e) != EX_SUM || expr_pairs(g, e, EX_SUM) != 2) return half;
  SumTerms t = terms_of(g, e);
  Expr product = difference_of_squares(&t);
  return product ? product : e;
}

static Expr rewrite_sums(ExprGraph *g, Expr e, Expr (*rule)(ExprGraph *, Expr)) {
  ExprList nodes = expr_topo(g, &e, 1);
  ExprMap map = expr_map(expr_arena(g));
  for (uint32_t i = 0; i < nodes.n; i++) {
    Expr x = expr_with_mapped_args(g, &map, nodes.at[i]), y = rule(g, x);
    if (y != nodes.at[i]) expr_map_set(&map, nodes.at[i], y);
  }
  Expr r = expr_map_get(&map, e);
  expr_list_free(g, nodes);
  expr_map_free(&map);
  return r ? r : e;
}

Expr simplify_stable(ExprGraph *g, Expr e) { return e ? rewrite_sums(g, e, stable_sum) : 0; }

/* Whether a variable of the motion among these nodes is in the map `in`; adds all to the map `to`. */
static int has_variable(const ExprGraph *g, ExprList nodes, const ExprMap *in, ExprMap *to) {
  int found = 0;
  for (uint32_t i = 0; i < nodes.n; i++) {
    if (expr_op(g, nodes.at[i]) != EX_SYM) continue;
    SymKind kind = expr_sym_of(g, nodes.at[i])->kind;
    if (kind != SYM_COORD && kind != SYM_STATE && kind != SYM_TIME) continue;
    if (to) expr_map_set(to, nodes.at[i], 1);
    found |= in && expr_map_get(in, nodes.at[i]) != 0;
  }
  return found;
}

/* Adds the variables that e divides by. */
static void add_divisors(ExprGraph *g, Expr e, ExprMap *divisors) {
  ExprList nodes = expr_topo_to_sums(g, &e, 1);
  for (uint32_t i = 0; i < nodes.n && nodes.n <= MAX_TERMS; i++)
    for (uint32_t k = 0; expr_op(g, nodes.at[i]) == EX_PROD && k < expr_pairs(g, nodes.at[i], EX_PROD); k++) {
      Num power;
      Expr base = expr_pair(g, nodes.at[i], EX_PROD, k, &power);
      if (num_sign(power) < 0) has_variable(g, expr_topo_to_sums(g, &base, 1), NULL, divisors);
    }
  expr_list_free(g, nodes);
}

Expr simplify_stable_quotients(ExprGraph *g, Expr e, Expr text) {
  if (!((expr_traits(g, e) | expr_traits(g, text)) & HAS_QUOTIENT)) return e;
  ExprList nodes = expr_topo_to_sums(g, &e, 1);
  ExprMap divisors = expr_map(expr_arena(g));
  int divided = 0;
  add_divisors(g, e, &divisors);
  add_divisors(g, text, &divisors);
  for (uint32_t i = 0; i < nodes.n && nodes.n <= MAX_TERMS && !divided; i++) {
    Expr x = nodes.at[i], u = expr_op(g, x) == EX_COS || expr_op(g, x) == EX_COSH ? expr_arg(g, x, 0) : 0;
    divided = u && has_variable(g, expr_topo_to_sums(g, &u, 1), &divisors, NULL);
  }
  expr_list_free(g, nodes);
  expr_map_free(&divisors);
  return divided ? rewrite_sums(g, e, with_half_angles) : e;
}
