/* Rotations: a coordinate is a unit quaternion q = (w, x, y, z), which turns vectors of the body frame into space.
 * Coordinates, `turn(axis, angle)`, products and `transpose` have length 1 on the constraint q.q = 1; the formulas
 * assume it: polynomials without poles, never divided by the length.
 *
 * Sources: W.R. Hamilton (1843); the rotation of a vector, v + 2 u x (u x v + w v) with q = (w, u), O. Rodrigues, J.
 * Math. Pures Appl. 5 (1840) 380; the rates of q and the angular velocity in the body's frame, A. Cayley, Camb.
 * Math. J. 3 (1843) 224: q' = q (0, omega)/2. */
#include "model/resolve_impl.h"
#include "sym/diff.h"
#include "sym/simplify.h"

/* --- quaternions --- */

/* a1 b1 + s (a2 b2 + a3 b3 + a4 b4) for pairs = (a1, b1, ..., a4, b4). */
static Expr four(ExprGraph *g, const Expr *pairs, int s) {
  Expr term[4];
  for (int k = 0; k < 4; k++) {
    Expr product = expr_mul(g, pairs[2 * k], pairs[2 * k + 1]);
    term[k] = k && s < 0 ? expr_neg(g, product) : product;
  }
  return expr_add_n(g, term, 4);
}

static Value conjugate(Builder *b, const Value *q) {
  Value r = *q;
  for (int k = 1; k < ROTATION; k++) r.at[k] = expr_neg(b->g, q->at[k]);
  return r;
}

Value rotation_product(Builder *b, const Value *p, const Value *q) {
  ExprGraph *g = b->g;
  const Expr *a = p->at, *c = q->at;
  Value r = {.n = ROTATION, .dim = p->dim};
  Expr scalar[] = {a[0], c[0], a[1], c[1], a[2], c[2], a[3], c[3]};
  r.at[0] = four(g, scalar, -1);
  for (int k = 1; k < ROTATION; k++) {
    int i = k % 3 + 1, j = i % 3 + 1; /* the other two, in their order */
    Expr minus = expr_neg(g, a[j]), vector[] = {a[0], c[k], a[k], c[0], a[i], c[j], minus, c[i]};
    r.at[k] = four(g, vector, 1);
  }
  return r;
}

Expr cross_component(ExprGraph *g, const Expr *u, const Expr *v, int k) {
  int i = (k + 1) % 3, j = (k + 2) % 3;
  Expr plus = expr_mul(g, u[i], v[j]), minus = expr_mul(g, u[j], v[i]);
  return expr_sub(g, plus, minus);
}

static void cross3(ExprGraph *g, const Expr *u, const Expr *v, Expr *out) {
  for (int k = 0; k < 3; k++) out[k] = cross_component(g, u, v, k);
}

Value rotation_turn(Builder *b, const Value *q, const Value *v) {
  ExprGraph *g = b->g;
  Value r = *v;
  Expr across[3], inner[3];
  cross3(g, q->at + 1, v->at, across);
  for (int k = 0; k < 3; k++) {
    Expr along = expr_mul(g, q->at[0], v->at[k]);
    inner[k] = expr_add(g, across[k], along);
  }
  Expr turned[3];
  cross3(g, q->at + 1, inner, turned);
  for (int k = 0; k < 3; k++) {
    Expr twice = expr_scale(g, num_int(2), turned[k]);
    r.at[k] = expr_add(g, v->at[k], twice);
  }
  r.bare = 0;
  return r;
}

/* Angular velocity in the body frame: vector part of 2 conj(q) q'. */
void rotation_spin(Builder *b, const Value *q, const Value *rates, Expr *w) {
  Value back = conjugate(b, q), product = rotation_product(b, &back, rates);
  for (int k = 0; k < 3; k++) w[k] = expr_scale(b->g, num_int(2), product.at[k + 1]);
}

/* scale q (0, w): product with a pure quaternion. */
static Value times_vector(Builder *b, Num scale, const Value *q, const Expr *w) {
  Value pure = {.n = ROTATION, .at = {expr_int(b->g, 0), w[0], w[1], w[2]}}, r = rotation_product(b, q, &pure);
  for (int k = 0; k < ROTATION; k++) r.at[k] = expr_scale(b->g, scale, r.at[k]);
  return r;
}

Value rotation_rates(Builder *b, const Value *q, const Expr *w) { return times_vector(b, num_ratio(1, 2), q, w); }

/* Generalised force 2 q (0, torque): its product with q' is the power torque.omega. */
Value torque_force(Builder *b, const Value *q, const Value *torque) {
  Value r = times_vector(b, num_int(2), q, torque->at);
  r.dim = torque->dim;
  return r;
}

/* --- functions of the language --- */

/* The only argument, which must be a rotation; NULL, reported, if not. */
static const Value *rotation_argument(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const Value *v = value_of(ev, x->args);
  if (!v->e) return NULL;
  if (v->n == ROTATION) return v;
  diag_error(b->diags, ast_expr(b->ast, x->args)->span, "`%s` is %s, but `%s` takes a rotation", ast_short(b, x->args),
             shape_text(b, v->n), x->name);
  if (strcmp(x->name, "omega") == 0 && !v->n)
    diag_help(b->diags,
              "the rate of an angle is written with a prime: `th'`; a rotation is declared `coord R: rotation`");
  else diag_help(b->diags, "a rotation is declared `coord R: rotation`, or made by `turn(axis, angle)`");
  return NULL;
}

Value omega_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const Value *q = rotation_argument(ev, x);
  if (!q) return FAILED;
  if (ev->kind == ENT_FUNCTION) need_rates(b, b->instances.at[ev->definition]);
  Value rates = time_derivative(b, *q, x->span, ev->where), w = {.n = 3, .unit = "rad/s"};
  if (!rates.e) return FAILED;
  rotation_spin(b, q, &rates, w.at);
  w.dim = rates.dim;
  return w;
}

Value transpose_value(Eval *ev, const AstExpr *x) {
  const Value *q = rotation_argument(ev, x);
  return q ? conjugate(ev->b, q) : FAILED;
}

/* turn(n, a) = (cos a/2, sin a/2 n/|n|) */
Value turn_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  ExprGraph *g = b->g;
  AstId angle = ast_expr(b->ast, x->args)->next;
  const Value *n = value_of(ev, x->args), *a = value_of(ev, angle);
  if (!n->e || !a->e) return FAILED;
  if (n->n != 3 || a->n) {
    AstId wrong = n->n != 3 ? x->args : angle;
    return refuse(b, ast_expr(b->ast, wrong)->span,
                  "`%s` is %s, and `turn` takes an axis and an angle" HELP
                  "`turn((0, 0, 1), 90 [deg])` turns about the third axis",
                  ast_short(b, wrong), shape_text(b, n->n != 3 ? n->n : a->n));
  }
  if (is_zero(b, n))
    return refuse(b, ast_expr(b->ast, x->args)->span,
                  "`%s` has no direction to turn about" HELP
                  "the identity is `turn((0, 0, 1), 0)`, the start of a rotation without a `start`",
                  ast_short(b, x->args));
  if (!need_pure(ev, angle, "`turn`")) return FAILED;
  Expr half = expr_scale(g, num_ratio(1, 2), a->e), s = expr_fn(g, EX_SIN, half), square[3];
  for (int k = 0; k < 3; k++) square[k] = expr_pow_num(g, n->at[k], num_int(2));
  Expr length2 = expr_add_n(g, square, 3), scale = expr_pow_num(g, length2, num_ratio(-1, 2));
  Value r = {.n = ROTATION, .dim = DIM_NONE};
  r.at[0] = expr_fn(g, EX_COS, half);
  for (int k = 0; k < 3; k++) {
    Expr part[] = {s, scale, n->at[k]};
    r.at[k + 1] = expr_mul_n(g, part, 3);
  }
  return r;
}

/* --- misuse of rotations --- */

/* --- the coordinate --- */

Value rotation_at(const Builder *b, uint32_t coord, int rates) {
  Value q = {.n = ROTATION, .dim = DIM_NONE};
  for (uint32_t k = 0; k < ROTATION; k++) {
    const Coord *c = &b->m->coords.at[coord + k];
    q.at[k] = expr_symbol(b->g, rates ? c->v : c->q)->node;
  }
  return q;
}

static Expr dot4(ExprGraph *g, const Value *p, const Value *q) {
  Expr pairs[8];
  for (int k = 0; k < 4; k++) {
    pairs[2 * k] = p->at[k];
    pairs[2 * k + 1] = q->at[k];
  }
  return four(g, pairs, 1);
}

void constrain_rotation(Builder *b, Name name, uint32_t coord, Span span) {
  Value q = rotation_at(b, coord, 0);
  Expr square = dot4(b->g, &q, &q);
  vec_push(b->arena, &b->rotations, coord);
  check_name_is_new(b, "constraint", name, NULL, span);
  add_scalar_constraint(b, name, expr_sub(b->g, square, expr_int(b->g, 1)), DIM_NONE, span);
  b->m->constraints.at[b->m->constraints.n - 1].inside = 1;
}

/* Trace of the 4x4 mass matrix of the quaternion's rates at the identity, all other coordinates and rates 0: four
 * times the trace of the inertia tensor. 0 unless it is a constant known to be positive. */
static Expr traced_inertia(Builder *b, uint32_t coord) {
  const Model *m = b->m;
  ExprGraph *g = b->g;
  Expr term[ROTATION], *at = ARENA_ARRAY(b->arena, Expr, expr_symbol_count(g) + 1);
  for (uint32_t k = 0; k < ROTATION; k++) {
    Expr p = expr_diff(g, m->lagrangian, m->coords.at[coord + k].v);
    term[k] = expr_diff(g, p, m->coords.at[coord + k].v);
  }
  for (uint32_t i = 0; i < m->coords.n; i++) at[m->coords.at[i].q] = at[m->coords.at[i].v] = expr_int(g, 0);
  for (uint32_t i = 0; i < b->rotations.n; i++) at[m->coords.at[b->rotations.at[i]].q] = expr_int(g, 1);
  Expr sum = expr_expand_defs(g, expr_add_n(g, term, ROTATION));
  Expr trace = simplify(g, expr_substitute(g, sum, at, expr_symbol_count(g) + 1, ""));
  unsigned fixed = 1u << SYM_PARAM | 1u << SYM_CONST;
  return expr_kinds(g, trace) & ~fixed || expr_sign(g, trace) != SIGN_POSITIVE ? 0 : trace;
}

/* Adds (trace/6) (q.q')^2 per rotation: the inertia trace/3 of a spherical top in the direction of q. */
void add_rotation_inertia(Builder *b) {
  Model *m = b->m;
  ExprGraph *g = b->g;
  for (uint32_t i = 0; m->lagrangian && i < b->rotations.n; i++) {
    uint32_t coord = b->rotations.at[i];
    Value q = rotation_at(b, coord, 0), v = rotation_at(b, coord, 1);
    Expr trace = traced_inertia(b, coord), along = dot4(g, &q, &v);
    if (!trace) trace = expr_int(g, 1);
    Expr square = expr_pow_num(g, along, num_int(2)), product = expr_mul(g, trace, square);
    Expr term = expr_scale(g, num_ratio(1, 6), product);
    m->regularising = m->regularising ? expr_add(g, m->regularising, term) : term;
  }
}
