/* Declarations of parameters and constants, whose values are evaluated at once; declared signs; -D definitions. */
#include "model/resolve_impl.h"
#include "sym/expr_eval.h"

static ExprSign sign_of(AstSign s) {
  switch (s) {
    case SIGN_GT: return SIGN_POSITIVE;
    case SIGN_GE: return SIGN_NONNEGATIVE;
    case SIGN_LT: return SIGN_NEGATIVE;
    case SIGN_LE: return SIGN_NONPOSITIVE;
    case SIGN_ANY: break;
  }
  return SIGN_UNKNOWN;
}

static const char *const sign_texts[] = {"", "> 0", ">= 0", "< 0", "<= 0"};

static int has_sign(AstSign sign, long double x) {
  return sign == SIGN_GT ? x > 0 : sign == SIGN_GE ? x >= 0 : sign == SIGN_LT ? x < 0 : sign != SIGN_LE || x <= 0;
}

void warn_signs(Builder *b) {
  const Model *m = b->m;
  long double *x = model_constants(m);
  vec_each(const Param, p, m->params) {
    if (!p->value) continue;
    expr_eval(b->g, &p->value, 1, x, &x[p->sym]);
    if (expr_is_num(b->g, p->value) || has_sign(p->sign, x[p->sym])) continue;
    diag_warning(b->diags, p->span, "`%s` is declared %s, but its value is %s", p->name, sign_texts[p->sign],
                 arena_printf(b->arena, "%.6Lg", x[p->sym]));
    diag_help(b->diags, "a run refuses this value: change it, or the parameters it depends on");
  }
  arena_release(b->arena, x, (expr_symbol_count(b->g) + 1) * sizeof *x);
}

/* The value must have the declared sign: the simplifier relies on it. */
void check_sign(Builder *b, const Param *p, Span span) {
  if (p->sign == SIGN_ANY || !p->value) return;
  ExprSign s = expr_sign(b->g, p->value);
  int zero = expr_is_zero(b->g, p->value), above = s == SIGN_POSITIVE, below = s == SIGN_NEGATIVE;
  int wrong = p->sign == SIGN_GT   ? below || zero
              : p->sign == SIGN_GE ? below
              : p->sign == SIGN_LT ? above || zero
                                   : above;
  if (wrong) diag_error(b->diags, span, "`%s` is declared %s, but this value is not", p->name, sign_texts[p->sign]);
}

/* The parameter declaration in progress. */
typedef struct {
  Builder *b;
  const AstStmt *st;
  Entity e;
  Unit unit;
  Name stem; /* name with its effect: drag.c */
} Declared;

static void add_param(const Declared *d, Name name, Value v, Span span) {
  Builder *b = d->b;
  AstSign sign = d->e.parts ? SIGN_ANY : d->st->sign;
  Param p = {.name = name, .stem = d->stem, .span = d->st->name_span, .sign = sign, .unit = d->unit};
  p.value = value_in(b, v, span, &p.unit);
  p.sym = declare_symbol(b, SYM_PARAM, b->m->params.n, name, sign_of(sign), d->unit.dim);
  check_sign(b, &p, span);
  vec_push(b->arena, &b->m->params, p);
}

/* Adds all components of one member. v.e = 0: error, already reported. */
static void add_member(const Declared *d, const int64_t *at, Value v, Span span) {
  Builder *b = d->b;
  if (v.e && v.n != d->e.parts) {
    diag_error(b->diags, span, "`%s` is %s, and %s is given here", d->st->name, shape_text(b, d->e.parts),
               shape_text(b, v.n));
    v = (Value){0};
  }
  if (v.e && v.n == ROTATION) v = refuse_rotation(b, span, source_text(b, span), TURN_VALUE);
  for (uint32_t k = 0; k < (d->e.parts ? d->e.parts : 1u); k++) {
    Value one = v;
    one.e = v.at[k];
    one.n = 0;
    add_param(d, scalar_name(b, &d->e, d->stem, at, k), one, span);
  }
}

/* Values of a parameter's members, row by row; a single one is for all members. */
typedef struct {
  VEC(Value) at;
  VEC(Span) spans;
} ParamValues;

/* Evaluates the right side of `param m[i in 1..N] = ...` for each member, up to one that is wrong, and reported. */
static void read_formula(const Declared *d, Name effect, ParamValues *values) {
  Builder *b = d->b;
  uint32_t outer = b->index.n;
  int64_t at[2];
  Value v = {.e = 1};
  for (int more = first_member(&d->e, at); more && v.e; more = next_member(&d->e, at)) {
    AstId dim = d->st->dims;
    for (int k = 0; dim; dim = ast_expr(b->ast, dim)->next, k++)
      if (ast_expr(b->ast, dim)->kind == AST_BIND)
        vec_push(b->arena, &b->index, ((IndexVar){ast_expr(b->ast, dim)->name, at[k]}));
    v = element_value(b, &(Element){d->st->rhs, NULL}, IN_PARAM, effect);
    vec_push(b->arena, &values->at, v);
    vec_push(b->arena, &values->spans, ast_expr(b->ast, d->st->rhs)->span);
    b->index.n = outer;
  }
}

/* Whether an index of the declaration is a range with a name. */
static int has_range(const Builder *b, AstId dims) {
  for (; dims; dims = ast_expr(b->ast, dims)->next)
    if (ast_expr(b->ast, dims)->kind == AST_BIND) return 1;
  return 0;
}

/* Evaluates the right side; 0, reported, when a list does not fit the family. */
static int read_values(Declared *d, Name effect, ParamValues *values) {
  Builder *b = d->b;
  const AstUnit *behind;
  const AstExpr *list = list_behind(b, d->st->rhs, &behind);
  Elements elements = {0};
  if (!list && has_range(b, d->st->dims)) read_formula(d, effect, values);
  else if (!list) vec_push(b->arena, &elements, ((Element){d->st->rhs, NULL}));
  IndexRange r = entity_range(&d->e);
  if (list && !list_elements(b, list, behind, &r, d->st->name, &elements)) return 0;
  for (uint32_t i = 0; i < elements.n; i++) {
    Value v = element_value(b, &elements.at[i], IN_PARAM, effect);
    vec_push(b->arena, &values->at, v);
    vec_push(b->arena, &values->spans, ast_expr(b->ast, elements.at[i].id)->span);
  }
  return 1;
}

/* A parameter without a unit takes that of its value; a bare number leaves it to inference. */
static Unit param_unit(Builder *b, const AstStmt *st, Name effect, const ParamValues *values) {
  const Value *v = values->at.n ? &values->at.at[0] : NULL;
  if (!st->unit.n && v && v->e && !v->bare && v->dim != DIM_ANY) return unit_of_dim(b->dims, v->dim);
  return declared_unit(b, st, effect);
}

/* The name is declared after its value is evaluated, so the value cannot contain it. */
void declare_param(Builder *b, const AstStmt *st, Name effect) {
  Declared d = {.b = b, .st = st, .stem = effect ? intern_printf(b, "%s.%s", effect, st->name) : st->name};
  ParamValues values = {0};
  uint8_t parts;
  if (!read_type(b, st, effect, &parts)) return;
  int known = read_family(b, st, effect, ENT_PARAM, b->m->params.n, parts, &d.e);
  if (!known) return;
  int fits = read_values(&d, effect, &values);
  if (!st->type && fits && values.at.n) d.e.parts = (uint8_t)values.at.at[0].n;
  if (d.e.parts && st->sign != SIGN_ANY)
    diag_error(b->diags, st->name_span, "`%s` is %s, and has no sign", st->name, shape_text(b, d.e.parts));
  d.unit = param_unit(b, st, effect, &values);
  if (!declare_entity(b, st, d.e)) return;
  int64_t at[2];
  uint32_t i = 0;
  for (int more = first_member(&d.e, at); more; more = next_member(&d.e, at)) {
    int given = i < values.at.n;
    add_member(&d, at, given ? values.at.at[i] : (Value){0}, given ? values.spans.at[i] : st->span);
    i += values.at.n > 1;
  }
}

/* The last -D for a constant, or NULL. */
static const Define *defined(const Builder *b, Name name) {
  const Define *d = NULL;
  for (uint32_t i = 0; i < b->ndefines; i++)
    if (strcmp(b->defines[i].name, name) == 0) d = &b->defines[i];
  return d;
}

/* Value of -D for a constant, which must have the shape of the file's value v. */
static Value defined_value(Builder *b, const Define *d, const Value *v, Name effect) {
  Value given = resolve(b, d->expr, IN_CONST, effect);
  if (!given.e || !v->e || given.n == v->n) return given;
  return refuse(b, ast_expr(b->ast, d->expr)->span, "`%s` is %s, and %s is given here", d->name, shape_text(b, v->n),
                shape_text(b, given.n));
}

/* A bare number of -D is in the unit of the constant's value in the file. */
void declare_const(Builder *b, const AstStmt *st, Name effect) {
  Value v = resolve(b, st->rhs, IN_CONST, effect);
  Entity e = {.kind = ENT_CONST, .index = b->constants.n, .name = st->name, .effect = effect, .span = st->name_span};
  if (!declare_entity(b, st, e)) return;
  const Define *d = defined(b, st->name);
  Unit unit = unit_resolve(&st->unit, b->dims, b->diags, b->arena);
  if (d && !st->unit.n && v.e && !v.bare) unit = unit_of_dim(b->dims, v.dim);
  if (d) v = defined_value(b, d, &v, effect);
  v = values_in(b, v, ast_expr(b->ast, d ? d->expr : st->rhs)->span, &unit);
  if (st->unit.n) {
    v.bare = v.point = 0;
    v.dim = unit.dim;
    v.unit = unit.text;
  }
  if (!v.e) v = (Value){.e = expr_int(b->g, 1), .dim = DIM_ANY}; /* reported */
  vec_push(b->arena, &b->constants, ((Constant){st->name, effect, d ? d->expr : st->rhs, unit}));
  vec_push(b->arena, &b->constant_values, v);
}
