/* Operators: sums, products, powers, comparisons, logic, tuples; and sum(...), product(...) over an index. */
#include "model/resolve_impl.h"

/* --- shapes --- */

void report_condition(Builder *b, AstId id) {
  diag_error(b->diags, ast_expr(b->ast, id)->span, "`%s` is a condition, not a number", ast_short(b, id));
  diag_help(b->diags, "`if(condition, a, b)` chooses between two numbers");
}

int same_shape(Eval *ev, Span span, AstId x, AstId y) {
  Builder *b = ev->b;
  const Value *v = value_of(ev, x), *w = value_of(ev, y);
  if (v->n == w->n) return 1;
  return diag_error(b->diags, span, "shapes do not match: `%s` is %s, `%s` is %s", ast_short(b, x), shape_text(b, v->n),
                    ast_short(b, y), shape_text(b, w->n));
}

/* --- chains of two operators --- */

/* Collects the operands of a left-leaning chain (+ and -, or * and /) into ev->operands, left to right. */
static void chain(Eval *ev, AstId id, AstKind inverse) {
  Builder *b = ev->b;
  AstId at = id;
  ev->operands.n = 0;
  for (;;) {
    const AstExpr *x = ast_expr(b->ast, at);
    vec_push(b->arena, &ev->operands, ((Operand){x->b, x->kind == inverse}));
    at = x->a;
    if (!ev->by_parent[at - ev->first]) break;
  }
  vec_push(b->arena, &ev->operands, ((Operand){at, 0}));
  Operand *o = ev->operands.at;
  for (uint32_t i = 0, k = ev->operands.n - 1; i < k; i++, k--) {
    Operand kept = o[i];
    o[i] = o[k];
    o[k] = kept;
  }
}

/* Sum of b->scratch, which is emptied. */
static Expr add_scratch(Builder *b) {
  Expr e = expr_add_n(b->g, b->scratch.at, b->scratch.n);
  b->scratch.n = 0;
  return e;
}

/* 1 if operand i, in degC, is first in the sum, 20 [degC] + 5 [K], or the one subtracted, T - 20 [degC]; 0,
 * reported. */
static int point_in_sum(Eval *ev, uint32_t i) {
  uint32_t subtracted = 0;
  for (uint32_t k = 0; k <= i; k++)
    subtracted += ev->operands.at[k].inverted && value_of(ev, ev->operands.at[k].at)->point;
  if (ev->operands.at[i].inverted ? subtracted == 1 : i == 0) return 1;
  return refuse_point(ev, ev->operands.at[i].at, "cannot be added to a temperature");
}

/* Shape and dimension of a sum, and whether it is bare; 0, reported, when operands differ. */
static int type_of_sum(Eval *ev, const AstExpr *x, Value *r) {
  Builder *b = ev->b;
  AstId measure = 0; /* the operand that determines the dimension */
  *r = (Value){.dim = DIM_ANY, .bare = 1};
  for (uint32_t i = 0; i < ev->operands.n; i++)
    if (!operand_fits(ev, x, ev->operands.at[i].at) || !value_of(ev, ev->operands.at[i].at)->e) return 0;
  r->n = value_of(ev, ev->operands.at[0].at)->n;
  if (r->n == ROTATION) {
    AstId first = ev->operands.at[0].at;
    refuse_rotation(b, ast_expr(b->ast, first)->span, ast_short(b, first), TURN_SUM);
    return 0;
  }
  for (uint32_t i = 0; i < ev->operands.n; i++) {
    AstId at = ev->operands.at[i].at;
    const Value *v = value_of(ev, at);
    if (!same_shape(ev, ast_expr(b->ast, at)->span, ev->operands.at[0].at, at)) return 0;
    r->bare &= v->bare;
    if (v->point && !point_in_sum(ev, i)) return 0;
    if (is_zero(b, v)) continue;
    if (measure && !operands_agree(ev, ast_expr(b->ast, at)->span, measure, at)) return 0;
    if (!measure && v->dim != DIM_ANY) {
      measure = at;
      r->dim = v->dim;
    }
  }
  return 1;
}

static Value sum_value(Eval *ev, AstId id) {
  Builder *b = ev->b;
  chain(ev, id, AST_SUB);
  Value r;
  if (!type_of_sum(ev, ast_expr(b->ast, id), &r)) return FAILED;
  for (uint32_t k = 0; k < component_count(&r); k++) {
    for (uint32_t i = 0; i < ev->operands.n; i++) {
      Expr e = value_of(ev, ev->operands.at[i].at)->at[k];
      if (ev->operands.at[i].inverted) e = expr_neg(b->g, e);
      vec_push(b->arena, &b->scratch, e);
    }
    r.at[k] = add_scratch(b);
  }
  return r;
}

/* Kinds of a product's factors. */
typedef struct {
  uint32_t vector;         /* index of the vector factor, or UINT32_MAX */
  uint32_t turns, numbers; /* number of rotations, and of numbers */
} Factors;

/* A rotation must stand before the vector it turns, and never in a divisor. */
static int rotation_fits(Eval *ev, uint32_t i, const Factors *f) {
  Builder *b = ev->b;
  Operand o = ev->operands.at[i];
  if (!o.inverted && f->vector == UINT32_MAX) return 1;
  refuse_rotation(b, ast_expr(b->ast, o.at)->span, ast_short(b, o.at), o.inverted ? TURN_INVERSE : TURN_BEHIND);
  return 0;
}

/* A product has at most one vector, and no divisor is a vector or zero. */
static int factor_fits(Eval *ev, uint32_t i, const Value *r) {
  Builder *b = ev->b;
  Operand o = ev->operands.at[i];
  const Value *v = value_of(ev, o.at);
  Span span = ast_expr(b->ast, o.at)->span;
  if (v->n && (o.inverted || r->n)) {
    diag_error(b->diags, span,
               o.inverted ? "`%s` is %s, and division by a vector is not defined"
                          : "`%s` is %s, and so is a factor before it",
               ast_short(b, o.at), shape_text(b, v->n));
    diag_help(b->diags, "write `dot(a, b)`, `cross(a, b)` or `norm(a)`");
    return 0;
  }
  if (o.inverted && expr_is_zero(b->g, v->e)) return diag_error(b->diags, span, "division by zero");
  return 1;
}

/* Warns of 2*pi/86164 [rad/s]: the unit binds to the divisor, but the quotient's was probably meant. r: the product
 * so far. */
static void warn_unit_of_divisor(Eval *ev, const Operand *o, const Value *r) {
  Builder *b = ev->b;
  const AstExpr *u = ast_expr(b->ast, o->at), *quotient = u + 1; /* a parent follows its last child */
  if (!o->inverted || u->kind != AST_UNIT || ast_expr(b->ast, u->a)->kind != AST_NUM || o->at + 1 >= b->ast->exprs.n)
    return;
  if (quotient->kind != AST_DIV || quotient->b != o->at || !r->bare) return;
  if (*source_text(b, (Span){quotient->op_span.end, u->span.begin}) == '(') return;
  if (value_of(ev, o->at)->e == value_of(ev, u->a)->e && value_of(ev, o->at)->dim == DIM_NONE) return; /* [rad], [1] */
  const char *above = source_text(b, (Span){quotient->span.begin, quotient->op_span.begin}),
             *number = ast_text(b, u->a), *unit = u->unit.text;
  Dim d = dim_div(b->dims, r->dim, value_of(ev, o->at)->dim);
  diag_warning(b->diags, u->span, "the unit [%s] belongs to the divisor `%s` alone, so that the quotient is %s", unit,
               number, in_dim(b, d));
  diag_help(b->diags, "a unit of the quotient: `(%s/%s) [%s]`; of the divisor: `%s/(%s [%s])`", above, number, unit,
            above, number, unit);
}

static int type_of_product(Eval *ev, const AstExpr *x, Value *r, Factors *f) {
  Builder *b = ev->b;
  int ok = 1;
  AstId turn = 0;
  *r = (Value){.dim = DIM_NONE, .bare = 1};
  *f = (Factors){UINT32_MAX, 0, 0};
  for (uint32_t i = 0; i < ev->operands.n; i++) {
    Operand o = ev->operands.at[i];
    const Value *v = value_of(ev, o.at);
    int fits =
        operand_fits(ev, x, o.at) && v->e && (v->n == ROTATION ? rotation_fits(ev, i, f) : factor_fits(ev, i, r));
    ok &= fits;
    if (!fits) continue;
    warn_unit_of_divisor(ev, &o, r);
    if (v->n == ROTATION) turn = o.at;
    else if (v->n) f->vector = i;
    f->turns += v->n == ROTATION;
    f->numbers += !v->n;
    if (v->n && v->n != ROTATION) r->n = v->n;
    r->dim = o.inverted ? dim_div(b->dims, r->dim, v->dim) : dim_mul(b->dims, r->dim, v->dim);
    r->bare &= v->bare;
  }
  if (!ok || !turn || r->n == 3 || (!r->n && !f->numbers)) return ok;
  refuse_rotation(b, ast_expr(b->ast, turn)->span, ast_short(b, turn), r->n ? TURN_NUMBER : TURN_SCALED);
  return 0;
}

/* The vector factor turned by the product of the rotations, or that product itself if there is no vector. */
static Value turned_value(Eval *ev, const Factors *f) {
  Builder *b = ev->b;
  Value q = {0};
  for (uint32_t i = 0; i < ev->operands.n; i++) {
    const Value *v = value_of(ev, ev->operands.at[i].at);
    if (v->n == ROTATION) q = q.e ? rotation_product(b, &q, v) : *v;
  }
  return f->vector == UINT32_MAX ? q : rotation_turn(b, &q, value_of(ev, ev->operands.at[f->vector].at));
}

static Value product_value(Eval *ev, AstId id) {
  Builder *b = ev->b;
  chain(ev, id, AST_DIV);
  Value r, turned = {0};
  Factors f;
  if (!type_of_product(ev, ast_expr(b->ast, id), &r, &f)) return FAILED;
  if (f.turns) turned = turned_value(ev, &f);
  if (f.turns && f.vector == UINT32_MAX) return turned;
  for (uint32_t k = 0; k < component_count(&r); k++) {
    for (uint32_t i = 0; i < ev->operands.n; i++) {
      const Value *v = value_of(ev, ev->operands.at[i].at);
      if (v->n == ROTATION) continue;
      Expr e = i == f.vector && f.turns ? turned.at[k] : v->at[i == f.vector ? k : 0];
      if (ev->operands.at[i].inverted) e = expr_pow_num(b->g, e, num_int(-1));
      vec_push(b->arena, &b->scratch, e);
    }
    r.at[k] = expr_mul_n(b->g, b->scratch.at, b->scratch.n);
    b->scratch.n = 0;
  }
  r.bare &= !f.turns;
  return r;
}

Value power_value(Eval *ev, const AstExpr *x, AstId base_id, AstId exp_id) {
  Builder *b = ev->b;
  const Value *base = value_of(ev, base_id), *e = value_of(ev, exp_id);
  if (!base->e || !e->e || !need_pure(ev, exp_id, "an exponent")) return FAILED;
  if (expr_is_num(b->g, e->e)) {
    Num n = expr_number(b->g, e->e);
    if (num_sign(n) < 0 && expr_is_zero(b->g, base->e)) return refuse(b, x->span, "division by zero");
    return a_value(expr_pow_num(b->g, base->e, n), dim_pow(b->dims, base->dim, n), base->bare && e->bare);
  }
  if (!need_pure(ev, base_id, "the base of a power whose exponent is not a number")) return FAILED;
  return a_value(expr_pow(b->g, base->e, e->e), DIM_NONE, 0);
}

Expr record_jump(Eval *ev, const AstExpr *x, Expr e) {
  const Builder *b = ev->b;
  ExprOp op = expr_op(b->g, e);
  int may_jump = op == EX_LT || op == EX_LE || op == EX_SIGN || op == EX_FLOOR || op == EX_TAN || op == EX_ATAN2;
  if (may_jump && !expr_map_get(&b->m->written, e)) expr_map_set(&b->m->written, e, (AstId)(x - b->ast->exprs.at));
  return e;
}

static Value compare_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const Value *l = value_of(ev, x->a), *r = value_of(ev, x->b);
  if (!l->e || !r->e) return FAILED;
  if (!operands_agree(ev, x->span, x->a, x->b)) return FAILED;
  int swapped = x->kind == AST_GT || x->kind == AST_GE;
  ExprOp op = x->kind == AST_LT || x->kind == AST_GT ? EX_LT : x->kind == AST_LE || x->kind == AST_GE ? EX_LE : EX_EQ;
  Expr e = expr_fn2(b->g, op, swapped ? r->e : l->e, swapped ? l->e : r->e);
  record_jump(ev, x, e);
  if (x->kind == AST_NE) e = expr_fn(b->g, EX_NOT, e);
  return (Value){.e = e, .dim = DIM_NONE, .condition = 1};
}

static int need_condition(Eval *ev, AstId id) {
  if (value_of(ev, id)->condition) return 1;
  return diag_error(ev->b->diags, ast_expr(ev->b->ast, id)->span, "`%s` is not a condition" HELP
                    "`and`, `or` and `not` join comparisons, such as `x > 0`", ast_short(ev->b, id));
}

static Value logic_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  Expr l = value_of(ev, x->a)->e, r = x->b ? value_of(ev, x->b)->e : 0;
  if (!l || (x->b && !r)) return FAILED;
  if (!need_condition(ev, x->a) || (x->b && !need_condition(ev, x->b))) return FAILED;
  Expr e = x->kind == AST_NOT ? expr_fn(b->g, EX_NOT, l) : expr_fn2(b->g, x->kind == AST_AND ? EX_AND : EX_OR, l, r);
  return (Value){.e = e, .dim = DIM_NONE, .condition = 1};
}

/* --- tuples --- */

static Value tuple_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  Value r = {.dim = DIM_ANY, .bare = 1};
  AstId measure = 0;
  for (AstId i = x->args; i; i = ast_expr(b->ast, i)->next) {
    const Value *v = value_of(ev, i);
    if (!v->e) return FAILED;
    if (r.n == 3) return refuse(b, x->span, "a vector has two or three components");
    r.at[r.n++] = v->e;
    r.bare &= v->bare;
    if (measure && !operands_agree(ev, ast_expr(b->ast, i)->span, measure, i)) return FAILED;
    if (!measure && v->dim != DIM_ANY && !expr_is_zero(b->g, v->e)) {
      measure = i;
      r.dim = v->dim;
    }
  }
  return r;
}

Value operator_value(Eval *ev, AstId id) {
  Builder *b = ev->b;
  const AstExpr *x = ast_expr(b->ast, id);
  switch (x->kind) {
    case AST_NUM: return a_value(expr_num(b->g, x->number), num_is_zero(x->number) ? DIM_ANY : DIM_NONE, 1);
    case AST_NEG: {
      Value v = *value_of(ev, x->a);
      if (v.n == ROTATION) return refuse_rotation(b, x->span, ast_short(b, x->a), TURN_INVERSE);
      for (uint32_t k = 0; v.e && k < component_count(&v); k++) v.at[k] = expr_neg(b->g, v.at[k]);
      return v;
    }
    case AST_ADD: case AST_SUB: return sum_value(ev, id);
    case AST_MUL: case AST_DIV: return product_value(ev, id);
    case AST_POW: return power_value(ev, x, x->a, x->b);
    case AST_LT: case AST_LE: case AST_GT: case AST_GE: case AST_EQ: case AST_NE: return compare_value(ev, x);
    case AST_NOT: case AST_AND: case AST_OR: return logic_value(ev, x);
    case AST_TUPLE: return tuple_value(ev, x);
    default: return FAILED; /* the caller passes these */
  }
}

/* --- sums and products over an index --- */

int resolve_whole(Builder *b, AstId id, Name effect, int64_t *out) {
  Value v = resolve(b, id, IN_CONST, effect);
  return whole_number(b, &v, id, out);
}

/* Starts the next part of a sum over lo .. hi; 0: its value is set. */
static int begin_part(Eval *ev, AstId id, int64_t lo, int64_t hi) {
  Builder *b = ev->b;
  int64_t end = quantified_part(ev, id, lo, hi);
  int quantified = quantified_begin(ev, id, lo, end);
  if (quantified < 0) return 0;
  if (!quantified) {
    vec_push(b->arena, &ev->loops, ((Loop){id, lo, end, ev->terms.n, 0, 0}));
    vec_push(b->arena, &ev->index, ((IndexVar){ast_expr(b->ast, id)->name, lo}));
  }
  Loop *l = &ev->loops.at[ev->loops.n - 1];
  l->end = end;
  l->last = hi;
  return 1;
}

int loop_begin(Eval *ev, AstId id) {
  Builder *b = ev->b;
  const AstExpr *x = ast_expr(b->ast, id);
  int64_t lo, hi;
  Value *r = value_of(ev, id);
  *r = FAILED;
  if (!whole_number(b, value_of(ev, x->a), x->a, &lo) || !whole_number(b, value_of(ev, x->b), x->b, &hi)) return 0;
  if (lo > hi) {
    *r = a_value(expr_int(b->g, x->kind == AST_PRODUCT), x->kind == AST_PRODUCT ? DIM_NONE : DIM_ANY, 1);
    return 0;
  }
  if (!range_fits(b, lo, hi, x->span) || !quantified_fits(ev, id)) return 0;
  int of_family = family_sum_begin(ev, id, lo, hi);
  return of_family ? of_family > 0 : begin_part(ev, id, lo, hi);
}

/* Shape and dimension of sum(...) or product(...) from its terms, and whether it is bare; 0, reported, when terms
 * differ. */
static int type_of_terms(Eval *ev, const Value *term, uint32_t n, const AstExpr *x, Value *r) {
  Builder *b = ev->b;
  int product = x->kind == AST_PRODUCT;
  *r = (Value){.dim = product ? DIM_NONE : DIM_ANY, .bare = 1, .n = term[0].n};
  Span span = ast_expr(b->ast, x->c)->span;
  if (r->n == ROTATION) {
    refuse_rotation(b, span, ast_short(b, x->c), TURN_SUM);
    return 0;
  }
  for (uint32_t i = 0; i < n; i++) {
    r->bare &= term[i].bare;
    if (term[i].n != r->n || (product && r->n)) {
      diag_error(b->diags, span,
                 product ? "the factors of a product are numbers"
                         : "the terms of a sum have one shape; here are %s and %s",
                 shape_text(b, r->n), shape_text(b, term[i].n));
      return 0;
    }
    if (product) {
      r->dim = dim_mul(b->dims, r->dim, term[i].dim);
    } else if (!is_zero(b, &term[i]) && term[i].dim != DIM_ANY) {
      if (!dim_equate(b->dims, r->dim, term[i].dim, span)) {
        diag_error(b->diags, span, "units do not match: terms of this sum are %s and %s", in_dim(b, r->dim),
                   in_dim(b, term[i].dim));
        explain_dims(b, r->dim, term[i].dim);
        return 0;
      }
      if (r->dim == DIM_ANY) r->dim = term[i].dim;
    }
  }
  return 1;
}

/* Value of a sum or product x from its terms. */
static Value terms_value(Eval *ev, const Value *term, uint32_t n, const AstExpr *x) {
  Builder *b = ev->b;
  Value r;
  if (!type_of_terms(ev, term, n, x, &r)) return FAILED;
  for (uint32_t i = 0; i < n; i++) r.domain = domain_and(b, r.domain, term[i].domain);
  for (uint32_t k = 0; k < component_count(&r); k++) {
    for (uint32_t i = 0; i < n; i++) vec_push(b->arena, &b->scratch, term[i].at[k]);
    r.at[k] = x->kind == AST_SUM ? expr_add_n(b->g, b->scratch.at, n) : expr_mul_n(b->g, b->scratch.at, n);
    b->scratch.n = 0;
  }
  return r;
}

int loop_next(Eval *ev) {
  Builder *b = ev->b;
  Loop *l = &ev->loops.at[ev->loops.n - 1];
  const AstExpr *x = ast_expr(b->ast, l->construct);
  Value v = *value_of(ev, x->c);
  if (v.e && v.condition) {
    report_condition(b, x->c);
    v = FAILED;
  }
  if (v.e && !quantified_judge(ev, l->construct)) v = FAILED;
  if (ev->sums && quantified_next(ev, &v)) return 1;
  if (v.e) vec_push(b->arena, &ev->terms, v);
  if (v.e && ++ev->rounds > RANGE_MAX) {
    diag_error(b->diags, x->span, "sums inside sums run through more than %d terms here", RANGE_MAX);
    diag_help(b->diags, "take a sum that does not depend on the outer index out of it: `let s = sum(...)`");
    v = FAILED;
  }
  if (v.e && l->at < l->hi) {
    ev->index.at[ev->index.n - 1].at = ++l->at;
    return 1;
  }
  Loop done = *l;
  ev->index.n--;
  ev->loops.n--;
  int more = v.e && done.end < done.last;
  if (more && begin_part(ev, done.construct, done.end + 1, done.last)) {
    ev->loops.at[ev->loops.n - 1].base = done.base;
    return 1;
  }
  int good = v.e && !more;
  *value_of(ev, done.construct) = good ? terms_value(ev, ev->terms.at + done.base, ev->terms.n - done.base, x) : FAILED;
  ev->terms.n = done.base;
  family_sum_keep(ev, done.construct, value_of(ev, done.construct));
  return 0;
}
