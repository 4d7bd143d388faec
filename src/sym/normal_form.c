/* Conversion of expressions to the normal form and back: one pass over the nodes in ascending order, repeated when the
 * unit of a base angle became finer. */
#include "sym/normal_form.h"

#include "sym/expr_impl.h"
#include "sym/normal_form_impl.h"

Normal *normal_new(ExprGraph *g, Arena *a, NormalLimits limits) {
  Normal *n = ARENA_NEW(a, Normal);
  n->g = g;
  n->arena = a;
  n->ring = poly_ring(a, limits.max_terms, limits.max_work);
  n->ring->residues = limits.residues;
  n->shallow = limits.shallow;
  n->proof = limits.proof;
  n->keep_range = limits.keep_range;
  n->field = frac_field(n->ring);
  n->canonical = 1;
  n->index = expr_map(a);
  n->of_symbol = expr_map(a);
  n->circular_index = expr_map(a);
  n->opaque_table.arena = a;
  n->root_table.arena = a;
  vec_push(a, &n->value, ((Frac){0}));
  vec_push(a, &n->circular, ((Circular){0}));
  return n;
}

/* --- generators --- */

void normal_set_gen_info(Normal *n, GenId x, GenInfo info) {
  while (n->gens.n <= x) vec_push(n->arena, &n->gens, ((GenInfo){0}));
  n->gens.at[x] = info;
}

static uint32_t hash_key(const uint32_t *key, uint32_t len) {
  uint32_t h = len;
  for (uint32_t i = 0; i < len; i++) h = hash_mix(h, key[i]);
  return h;
}

GenId normal_find_key(const Normal *n, const IdTable *t, const uint32_t *key, uint32_t len) {
  uint32_t hash = hash_key(key, len), slot = idtable_start(t, hash), id;
  while (idtable_next(t, hash, &slot, &id)) {
    const uint32_t *known = n->keys.at + n->key_at.at[id];
    if (known[0] == len && memcmp(known + 1, key, len * sizeof *key) == 0) return n->key_gen.at[id];
  }
  return GEN_NONE;
}

void normal_add_key(Normal *n, IdTable *t, const uint32_t *key, uint32_t len, GenId x) {
  uint32_t start = n->keys.n;
  vec_push(n->arena, &n->keys, len);
  for (uint32_t i = 0; i < len; i++) vec_push(n->arena, &n->keys, key[i]);
  vec_push(n->arena, &n->key_at, start);
  vec_push(n->arena, &n->key_gen, x);
  idtable_add(t, hash_key(key, len), n->key_at.n - 1);
}

static Frac gen_frac(Normal *n, GenId x) { return frac_poly(poly_gen(n->ring, x)); }

static Frac symbol_frac(Normal *n, Expr e) {
  if (!expr_map_get(&n->of_symbol, e)) {
    GenId x = poly_new_gen(n->ring);
    normal_set_gen_info(n, x, (GenInfo){.kind = GEN_SYMBOL, .expr = e});
    expr_map_set(&n->of_symbol, e, x + 1);
  }
  return gen_frac(n, expr_map_get(&n->of_symbol, e) - 1);
}

enum { MAX_ARGS = 3 };

static Frac opaque_by_key(Normal *n, const uint32_t *key, uint32_t len, GenInfo info) {
  GenId x = normal_find_key(n, &n->opaque_table, key, len);
  if (x == GEN_NONE) {
    x = poly_new_gen(n->ring);
    normal_set_gen_info(n, x, info);
    normal_add_key(n, &n->opaque_table, key, len, x);
  }
  n->canonical = 0;
  return gen_frac(n, x);
}

/* Generator of an opaque operation on arguments in normal form. */
static Frac opaque(Normal *n, ExprOp op, const Frac *arg, uint32_t nargs, Expr expr) {
  uint32_t key[1 + 2 * MAX_ARGS] = {(uint32_t)op}, len = 1;
  for (uint32_t i = 0; i < nargs; i++) {
    key[len++] = poly_intern(n->ring, arg[i].num);
    key[len++] = arg[i].den;
  }
  return opaque_by_key(n, key, len, (GenInfo){.kind = GEN_OPAQUE, .expr = expr, .op = op, .arg = arg[0]});
}

static int is_coefficient(const Normal *n, Num v) { return n->ring->residues || num_is_exact(v); }

/* A number as a coefficient, or, if inexact, as a generator identified by its node. */
static Frac number_frac(Normal *n, Num v) {
  if (is_coefficient(n, v)) return frac_num(n->field, v);
  Expr size = expr_num(n->g, num_abs(v));
  uint32_t key[2] = {EX_NUM, size};
  Frac f = opaque_by_key(n, key, 2, (GenInfo){.kind = GEN_OPAQUE, .expr = size, .op = EX_NUM});
  return num_sign(v) < 0 ? frac_neg(n->field, f) : f;
}

/* A definition or a quantified sum as a generator of its own. */
static Frac whole_frac(Normal *n, Expr e) {
  ExprOp op = expr_op(n->g, e);
  uint32_t key[2] = {(uint32_t)op, e};
  return opaque_by_key(n, key, 2, (GenInfo){.kind = GEN_OPAQUE, .expr = e, .op = op});
}

/* --- operations --- */

static Frac value_of(const Normal *n, Expr e) { return n->value.at[expr_map_get(&n->index, e)]; }

static Frac sum_frac(Normal *n, Expr e) {
  uint32_t count = expr_pairs(n->g, e, EX_SUM);
  Frac *term = ARENA_ARRAY(n->arena, Frac, count);
  Num *c = ARENA_ARRAY(n->arena, Num, count);
  for (uint32_t i = 0; i < count; i++) {
    Expr t = expr_pair(n->g, e, EX_SUM, i, &c[i]);
    term[i] = value_of(n, t);
    if (is_coefficient(n, c[i])) continue;
    Frac scale = number_frac(n, c[i]);
    term[i] = frac_mul(n->field, term[i], scale);
    c[i] = num_int(1);
  }
  return frac_sum(n->field, term, c, count);
}

static Frac pow_frac(Normal *n, Frac base, Num e) {
  if (num_is_exact(e)) return normal_pow_num(n, base, e);
  Frac exponent = number_frac(n, e);
  return normal_power(n, base, exponent);
}

static Frac prod_frac(Normal *n, Expr e) {
  Frac p = frac_num(n->field, num_int(1));
  for (ExprPair b = {0}; expr_next_pair(n->g, e, EX_PROD, &b);) {
    Frac power = pow_frac(n, value_of(n, b.of), b.num);
    p = frac_mul(n->field, p, power);
  }
  return p;
}

static Frac half_sum(Normal *n, Frac a, Frac b) {
  Frac both[2] = {a, b};
  Num half[2] = {num_ratio(1, 2), num_ratio(1, 2)};
  return frac_sum(n->field, both, half, 2);
}

static Frac hyperbolic(Normal *n, ExprOp op, Frac u) {
  Frac minus_u = frac_neg(n->field, u);
  Frac up = normal_exp(n, u), down = normal_exp(n, minus_u);
  Frac minus_down = frac_neg(n->field, down);
  if (op == EX_COSH) return half_sum(n, up, down);
  Frac sinh = half_sum(n, up, minus_down);
  if (op == EX_SINH) return sinh;
  Frac cosh = half_sum(n, up, down);
  Frac inverse = frac_inv(n->field, cosh);
  return frac_mul(n->field, sinh, inverse);
}

static Frac circular_fn(Normal *n, Expr e, Frac u) {
  Circular cs = normal_circular(n, expr_arg(n->g, e, 0), u);
  if (expr_op(n->g, e) == EX_SIN) return cs.sin;
  if (expr_op(n->g, e) == EX_COS) return cs.cos;
  Frac inverse = frac_inv(n->field, cs.cos);
  return frac_mul(n->field, cs.sin, inverse);
}

/* For proofs: min and max by (a + b -+ |a - b|)/2. */
static Frac min_max_frac(Normal *n, ExprOp op, Frac a, Frac b) {
  Frac sum = frac_add(n->field, a, b), gap = frac_sub(n->field, a, b),
       size = normal_hypot(n, gap, frac_poly(poly_zero()), 0);
  return half_sum(n, sum, op == EX_MIN ? frac_neg(n->field, size) : size);
}

/* Opaque odd or even function: f(-u) = -f(u) or f(u), chosen so that the first coefficient of the argument is
 * positive. */
static Frac signed_opaque(Normal *n, Expr e, Frac u, int odd) {
  ExprOp op = expr_op(n->g, e);
  if (u.num.n == 0 && odd) return u;
  if (u.num.n == 0 || num_sign(u.num.at[0].c) > 0) return opaque(n, op, &u, 1, e);
  Frac turned = frac_neg(n->field, u);
  Frac f = opaque(n, op, &turned, 1, odd ? expr_neg(n->g, e) : e);
  return odd ? frac_neg(n->field, f) : f;
}

Frac normal_opaque_log(Normal *n, Frac u) {
  Expr of = normal_expr(n, u), e = expr_fn(n->g, EX_LOG, of);
  return opaque(n, EX_LOG, &u, 1, e);
}

static Frac log_frac(Normal *n, Expr e, Frac u) {
  if (n->proof) return normal_log(n, u);
  if (u.den == 0 && u.num.n == 1 && u.num.at[0].mono == 0 && num_is_one(u.num.at[0].c)) return frac_poly(poly_zero());
  return opaque(n, EX_LOG, &u, 1, e);
}

static Frac opaque_fn(Normal *n, Expr e) {
  Frac arg[MAX_ARGS];
  uint32_t nargs = expr_nargs(n->g, e);
  for (uint32_t i = 0; i < nargs; i++) arg[i] = value_of(n, expr_arg(n->g, e, i));
  return opaque(n, expr_op(n->g, e), arg, nargs, e);
}

/* f(u), opaque but for the sign of u where f is odd or even. */
static Frac opaque_call(Normal *n, Expr e, Frac u) {
  Symmetry symmetry = expr_symmetry(expr_op(n->g, e));
  return symmetry == NEITHER ? opaque_fn(n, e) : signed_opaque(n, e, u, symmetry == ODD);
}

static Frac convert(Normal *n, Expr e) {
  ExprGraph *g = n->g;
  ExprOp op = expr_op(g, e);
  Frac u = {0};
  if (op == EX_DEF && n->shallow) return whole_frac(n, e);
  if (expr_nargs(g, e) > 0) u = value_of(n, expr_arg(g, e, 0));
  switch (op) {
    case EX_NUM: return number_frac(n, expr_number(g, e));
    case EX_SYM: return symbol_frac(n, e);
    case EX_DEF: return u;
    case EX_SUM: return sum_frac(n, e);
    case EX_PROD: return prod_frac(n, e);
    case EX_NEST: return frac_poly(poly_zero()); /* read by nobody: its cells are generators */
    case EX_CELL: return whole_frac(n, e);
    case EX_POW: return normal_power(n, u, value_of(n, expr_arg(g, e, 1)));
#define CIRCULAR circular_fn(n, e, u)
#define HYPERBOLIC n->keep_range ? opaque_call(n, e, u) : hyperbolic(n, op, u)
#define EXPONENTIAL normal_exp(n, u)
#define LOGARITHM log_frac(n, e, u)
#define CUBE_ROOT normal_pow_num(n, u, num_ratio(1, 3))
#define OPAQUE opaque_call(n, e, u)
#define PROOF(OP, name, latex, symmetry, at_0, sign, proof, ...) case EX_##OP: return proof;
    FUNCTIONS(PROOF)
    case EX_ABS: return normal_hypot(n, u, frac_poly(poly_zero()), e);
    case EX_HYPOT: return normal_hypot(n, u, value_of(n, expr_arg(g, e, 1)), e);
    case EX_SIGN: return OPAQUE;
    case EX_MIN:
    case EX_MAX: return n->proof ? min_max_frac(n, op, u, value_of(n, expr_arg(g, e, 1))) : opaque_fn(n, e);
    case EX_FLOOR: case EX_ATAN2: case EX_LT: case EX_LE: case EX_EQ:
    case EX_NOT: case EX_AND: case EX_OR: case EX_SELECT: return opaque_fn(n, e);
    case EX_COUNT: break;
  }
  poly_fail(n->ring, POLY_TOO_LARGE);
  return u;
}

/* --- the problem --- */

static void run_once(Normal *n, ExprList nodes) {
  expr_map_clear(&n->index);
  expr_map_clear(&n->circular_index);
  n->value.n = 1;
  n->circular.n = 1;
  n->restart = 0;
  for (uint32_t i = 0; i < nodes.n && n->ring->status == POLY_OK; i++) {
    Frac f = convert(n, nodes.at[i]);
    vec_push(n->arena, &n->value, f);
    expr_map_set(&n->index, nodes.at[i], n->value.n - 1);
  }
}

PolyStatus normal_run(Normal *n, const Expr *roots, uint32_t count, Frac *out) {
  enum { MAX_ROUNDS = 16 };
  ExprList nodes = n->shallow ? expr_topo_shallow(n->g, roots, count) : expr_topo_to_sums(n->g, roots, count);
  int rounds = 0;
  do {
    if (++rounds > MAX_ROUNDS) poly_fail(n->ring, POLY_TOO_LARGE);
    run_once(n, nodes);
  } while (n->restart && n->ring->status == POLY_OK);
  for (uint32_t i = 0; i < count; i++) out[i] = roots[i] ? value_of(n, roots[i]) : frac_poly(poly_zero());
  expr_list_free(n->g, nodes);
  return n->ring->status;
}

/* --- back to expressions --- */

Expr normal_mono_expr(Normal *n, MonoId m) {
  Mono mono = *mono_at(n->ring, m);
  Expr *factor = ARENA_ARRAY(n->arena, Expr, mono.n + 1);
  for (uint32_t i = 0; i < mono.n; i++)
    factor[i] = expr_pow_num(n->g, n->gens.at[mono.at[i].gen].expr, num_int(mono.at[i].exp));
  return expr_mul_n(n->g, factor, mono.n);
}

Expr normal_poly_expr(Normal *n, Poly p) {
  Expr *term = ARENA_ARRAY(n->arena, Expr, p.n + 1);
  for (uint32_t i = 0; i < p.n; i++) {
    Expr m = normal_mono_expr(n, p.at[i].mono);
    term[i] = expr_scale(n->g, p.at[i].c, m);
  }
  return expr_add_n(n->g, term, p.n);
}

Expr normal_expr_by(Normal *n, Frac a, Expr (*poly_expr)(Normal *n, Poly p)) {
  Expr e = poly_expr(n, a.num);
  Den d = frac_den(n->field, a.den);
  for (uint32_t i = 0; i < d.n; i++) {
    Expr factor = poly_expr(n, poly_at(n->ring, d.at[i].factor));
    Expr power = expr_pow_num(n->g, factor, num_int(-(int64_t)d.at[i].exp));
    e = expr_mul(n->g, e, power);
  }
  return e;
}

Expr normal_expr(Normal *n, Frac a) { return normal_expr_by(n, a, normal_poly_expr); }
