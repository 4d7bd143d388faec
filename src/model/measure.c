/* `measure` statements: numbers that one keeps of a run. Enters: `measure top = max(y) - h`; leaves: its text for the runtime, with names, and its unit.
 * Holds: names, events, shapes and units are checked here. What stands inside max( ), and each operand that is no arithmetic, is any expression
 * of the language; where the runtime has no name for it, it becomes an output. The rest is one loop over the nodes. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "base/words.h"
#include "model/builder.h"

/* Binding of the text of a part: what stands around it may need parentheses. */
typedef enum { BINDS_SUM, BINDS_PRODUCT, BINDS_SIGN, BINDS_POWER, BINDS_PRIMARY } Binding;

typedef struct {
  const char *text; /* NULL: not read yet, or wrong */
  Binding binding;
  Value value;      /* of the result: dimension, and whether it is a plain number */
  int measured;     /* 1: a value of the whole run */
  int literal;      /* 1: made of pure numbers and pi */
} Part;

typedef struct {
  Builder *b;
  AstId first;
  Part *part;      /* by node */
  uint8_t *inside; /* 1: the node belongs to an operand that is read as a whole */
} MeasureReader;

typedef enum { CALL_TRACK, CALL_HIT, CALL_COUNT, CALL_FUNCTION, CALL_AT, CALL_ELSE } CallKind;

static int is_word(const char *words, const char *name) {
  size_t n = strlen(name);
  for (const char *at = words; (at = strstr(at, name)); at += n)
    if ((at == words || at[-1] == ' ') && (!at[n] || at[n] == ' ')) return 1;
  return 0;
}

static const Entity *entity_named(Builder *b, Name name) {
  int ambiguous;
  return scope_find(&b->scope, name, NULL, &ambiguous);
}

static CallKind call_kind(MeasureReader *r, const AstExpr *x) {
  const Entity *e = entity_named(r->b, x->name);
  AstId second = x->args ? ast_expr(r->b->ast, x->args)->next : 0;
  if (is_word("max min mean rms drift period", x->name) && x->args &&
      (!second || ast_expr(r->b->ast, second)->kind == AST_BIND))
    return CALL_TRACK;
  if (strcmp(x->name, "hit") == 0) return CALL_HIT;
  if (strcmp(x->name, "count") == 0) return CALL_COUNT;
  if (e && e->kind != ENT_FUNCTION && e->kind != ENT_NONE) return CALL_AT;
  return is_word("sin cos tan asin acos atan atan2 sqrt exp log abs", x->name) ? CALL_FUNCTION : CALL_ELSE;
}

static int is_arithmetic(AstKind kind) { return kind == AST_NEG || (kind >= AST_ADD && kind <= AST_POW); }

static void mark_list(MeasureReader *r, AstId id) {
  for (; id; id = ast_expr(r->b->ast, id)->next) r->inside[id - r->first] = 1;
}

/* Marks the nodes that are read as parts of others: from parents to arguments, whose numbers are lower. */
static void mark_operands(MeasureReader *r, AstId root) {
  for (AstId id = root; id >= r->first; id--) {
    const AstExpr *x = ast_expr(r->b->ast, id);
    CallKind call = x->kind == AST_CALL ? call_kind(r, x) : CALL_ELSE;
    int whole = r->inside[id - r->first] || (!is_arithmetic(x->kind) && x->kind != AST_AT && (x->kind != AST_CALL || call == CALL_ELSE || call == CALL_TRACK));
    const AstId parts[] = {whole || x->kind == AST_AT ? x->a : 0, whole ? x->b : 0, whole ? x->c : 0};
    for (int k = 0; k < 3; k++)
      if (parts[k]) r->inside[parts[k] - r->first] = 1;
    if (whole) mark_list(r, x->args);
    else if (x->kind == AST_CALL && (call == CALL_HIT || call == CALL_COUNT) && x->args) r->inside[x->args - r->first] = 1;
  }
}

static Part part_of(const char *text, Binding binding, Dim dim, int measured) {
  return (Part){.text = text, .binding = binding, .value = {.dim = dim}, .measured = measured};
}

static const char *number_text(Builder *b, double x) {
  char text[32];
  num_format_double(text, x);
  return arena_strdup(b->arena, text);
}

/* An operand of the language by its name in the runtime; it becomes an output where it has none. */
static Part operand(MeasureReader *r, AstId id) {
  Builder *b = r->b;
  Value v = resolve(b, id, IN_OUTPUT, NULL);
  Part p = part_of(NULL, BINDS_PRIMARY, v.dim, 0);
  Span span = ast_expr(b->ast, id)->span;
  p.value.bare = v.bare;
  p.value.e = v.e;
  if (!v.e) return p;
  if (v.n || v.condition) {
    diag_error(b->diags, span, "a measure is made of numbers, and `%s` is %s", ast_short(b, id), v.n ? "a vector" : "a condition");
    if (v.n) diag_help(b->diags, "take a component: `%s.x`", ast_short(b, id));
    return p;
  }
  const Symbol *s = expr_op(b->g, v.e) == EX_SYM ? expr_sym_of(b->g, v.e) : NULL;
  int same = s && (b->dim_of.at[expr_sym_id(b->g, v.e)] == v.dim || expr_sym_id(b->g, v.e) == b->m->energy_sym); /* y/1 [m] is the symbol y, too, but a pure number */
  int named = same && (s->kind == SYM_TIME || s->kind == SYM_COORD || s->kind == SYM_VEL || s->kind == SYM_STATE || s->kind == SYM_INPUT ||
                    (s->kind == SYM_PARAM && !b->m->params.at[s->index].fixed) || expr_sym_id(b->g, v.e) == b->m->energy_sym);
  if (named) p.text = s->name;
  else if (s && s->kind == SYM_CONST) p.text = "pi", p.literal = 1;
  else if (expr_is_num(b->g, v.e)) {
    p.literal = v.bare || v.dim == DIM_NONE;
    p.text = arena_printf(b->arena, p.literal ? "%s" : "%s[SI]", number_text(b, num_value(expr_number(b->g, v.e))));
  }
  if (p.text && *p.text == '-') p.text = arena_printf(b->arena, "(%s)", p.text);
  if (p.text) return p;
  int output = add_outputs(b, id);
  if (output >= 0) p.text = arena_printf(b->arena, "\"%s\"", b->m->scene.outputs.at[output].name);
  return p;
}

static Dim seconds(Builder *b) { return b->unitless ? DIM_ANY : dim_base(b->dims, DIM_TIME); }

/* ---- Calls */

static Part wrong_call(MeasureReader *r, const AstExpr *x, const char *form) {
  diag_error(r->b->diags, x->span, "a measure `%s` is written `%s`", x->name, form);
  return (Part){0};
}

/* " 10" of a window of time, in s; NULL, reported, if it is none. */
static const char *window_end(Builder *b, AstId id) {
  Value v = resolve(b, id, IN_CONST, NULL);
  if (!v.e) return NULL;
  if (expr_is_num(b->g, v.e) && (v.bare || dim_equate(b->dims, v.dim, seconds(b), ast_expr(b->ast, id)->span)))
    return number_text(b, num_value(expr_number(b->g, v.e)));
  diag_error(b->diags, ast_expr(b->ast, id)->span,
             "`%s` is no end of a window of time" HELP "write numbers: `max(x, 10..20)`, `max(x, 1 [min]..2 [min])`",
             ast_short(b, id));
  return NULL;
}

/* ", 10..20", "" */
static const char *window_text(Builder *b, AstId id) {
  if (!id) return "";
  const AstExpr *x = ast_expr(b->ast, id);
  const char *from = window_end(b, x->a), *to = from ? window_end(b, x->b) : NULL;
  if (to && !(strtod(from, NULL) < strtod(to, NULL))) {
    diag_error(b->diags, x->span, "this window of time is empty");
    return NULL;
  }
  return to ? arena_printf(b->arena, ", %s..%s", from, to) : NULL;
}

/* max(x), max(x, 10..20), ... */
static Part track(MeasureReader *r, const AstExpr *x) {
  Builder *b = r->b;
  Name name = x->name;
  Span span = x->span;
  AstId window = ast_expr(b->ast, x->args)->next;
  Part of = operand(r, x->args);
  if (!of.text) return of;
  const char *within = window_text(b, window);
  if (!within) return (Part){0};
  if (!(expr_kinds(b->g, of.value.e) & ~(1u << SYM_PARAM | 1u << SYM_CONST))) {
    diag_error(b->diags, span, "`%s` does not change along the run", of.text);
    return (Part){0};
  }
  Dim dim = strcmp(name, "period") == 0 ? seconds(b) : of.value.dim;
  return part_of(arena_printf(b->arena, "%s(%s%s)", name, of.text, within), BINDS_PRIMARY, dim, 1);
}

/* hit(EVENT, n), count(EVENT) */
static Part event_time(MeasureReader *r, const AstExpr *x, int hit) {
  Builder *b = r->b;
  uint32_t n = ast_list_length(b->ast, x->args);
  if (n < 1 || n > (hit ? 2u : 1u)) return wrong_call(r, x, hit ? "hit(EVENT) or hit(EVENT, 3)" : "count(EVENT)");
  const char *event = ast_text(b, x->args);
  uint32_t k = 0, events = b->m->events.n;
  Name *names = ARENA_ARRAY(b->arena, Name, events + 1);
  for (uint32_t i = 0; i < events; i++) names[i] = b->m->events.at[i].name;
  while (k < events && strcmp(names[k], event) != 0) k++;
  if (k == events) {
    Name near = suggest(event, names, events);
    diag_error(b->diags, ast_expr(b->ast, x->args)->span, "no event is called `%s`", event);
    if (near) diag_help(b->diags, "did you mean `%s`?", near);
    else if (!events) diag_help(b->diags, "declare it: `event %s: x - 1 rising { }`", event);
    return (Part){0};
  }
  AstId second = ast_expr(b->ast, x->args)->next;
  const Part *nth = second ? &r->part[second - r->first] : NULL;
  if (nth && !nth->text) return (Part){0};
  double number = nth && ast_expr(b->ast, second)->kind == AST_NUM ? strtod(nth->text, NULL) : 1;
  if (number < 1 || number != floor(number)) {
    diag_error(b->diags, ast_expr(b->ast, second)->span, "no event happens for the `%s`th time", nth->text);
    diag_help(b->diags, "`hit(%s)` is its first time, `hit(%s, 2)` its second", event, event);
    return (Part){0};
  }
  const char *text = nth ? arena_printf(b->arena, "hit(%s, %s)", event, nth->text) : arena_printf(b->arena, "%s(%s)", x->name, event);
  return part_of(text, BINDS_PRIMARY, hit ? seconds(b) : DIM_NONE, 1);
}

/* x(10), th'(10): `what` at the time of part `time`. */
static Part at_time(MeasureReader *r, AstId what, AstId time) {
  Builder *b = r->b;
  const Part *t = &r->part[time - r->first];
  Part of = operand(r, what);
  if (!of.text || !t->text) return (Part){0};
  if (!t->value.bare && !dim_equate(b->dims, t->value.dim, seconds(b), ast_expr(b->ast, time)->span)) {
    diag_error(b->diags, ast_expr(b->ast, time)->span, "a time is in [s], and this is %s", in_dim(b, t->value.dim));
    return (Part){0};
  }
  return part_of(arena_printf(b->arena, "%s(%s)", of.text, t->text), BINDS_PRIMARY, of.value.dim, 1);
}

static Part function(MeasureReader *r, const AstExpr *x) {
  Builder *b = r->b;
  Part p = part_of(x->name, BINDS_PRIMARY, DIM_NONE, 0);
  const char *between = "(";
  p.literal = 1;
  int two = strcmp(x->name, "atan2") == 0, root = strcmp(x->name, "sqrt") == 0, same = strcmp(x->name, "abs") == 0;
  if (ast_list_length(b->ast, x->args) != (two ? 2 : 1)) return wrong_call(r, x, two ? "atan2(y, x)" : arena_printf(b->arena, "%s(x)", x->name));
  for (AstId id = x->args; id; id = ast_expr(b->ast, id)->next, between = ", ") {
    const Part *a = &r->part[id - r->first];
    if (!a->text) return (Part){0};
    p.text = arena_printf(b->arena, "%s%s%s", p.text, between, a->text);
    p.measured |= a->measured;
    p.literal &= a->literal;
    if (root) p.value.dim = dim_pow(b->dims, a->value.dim, num_ratio(1, 2));
    else if (same || two) p.value.dim = same ? a->value.dim : DIM_NONE;
    else if (!dim_equate(b->dims, a->value.dim, DIM_NONE, x->span)) {
      diag_error(b->diags, ast_expr(b->ast, id)->span, "`%s` takes a pure number or an angle, and this is %s", x->name, in_dim(b, a->value.dim));
      return (Part){0};
    }
  }
  p.text = arena_printf(b->arena, "%s)", p.text);
  return p;
}

static Part call(MeasureReader *r, AstId id) {
  Builder *b = r->b;
  const AstExpr *x = ast_expr(b->ast, id);
  switch (call_kind(r, x)) {
    case CALL_TRACK: return track(r, x);
    case CALL_HIT: case CALL_COUNT: return event_time(r, x, strcmp(x->name, "hit") == 0);
    case CALL_FUNCTION: return function(r, x);
    case CALL_ELSE: return operand(r, id);
    case CALL_AT: break;
  }
  if (ast_list_length(b->ast, x->args) != 1) return wrong_call(r, x, arena_printf(b->arena, "%s(10 [s])", x->name));
  AstExpr name = {.kind = AST_NAME, .name = x->name, .span = x->op_span, .op_span = x->op_span, .first = b->ast->exprs.n};
  AstId time = x->args;
  vec_push(b->arena, &b->ast->exprs, name);
  return at_time(r, b->ast->exprs.n - 1, time);
}

/* ---- Arithmetic */

static const char *bound(Builder *b, const Part *p, Binding needs) { return arena_printf(b->arena, p->binding < needs ? "(%s)" : "%s", p->text); }

/* A term: the runtime reads plain numbers beside a quantity in its declared unit, the language in radians or as pure numbers. */
static const char *term(Builder *b, const Part *p, const Part *beside, Binding needs) {
  if (!p->literal || beside->literal) return bound(b, p, needs);
  return arena_printf(b->arena, "%s*1[SI]", bound(b, p, BINDS_PRODUCT));
}

static int units_fit(MeasureReader *r, const AstExpr *x, const Part *p, const Part *q) {
  Builder *b = r->b;
  const Part *number = p->value.bare ? p : q->value.bare ? q : NULL, *other = number == p ? q : p;
  if (number && dim_is_open(b->dims, dim_resolved(b->dims, other->value.dim))) return 1;
  if ((p->value.e && expr_is_zero(b->g, p->value.e)) || (q->value.e && expr_is_zero(b->g, q->value.e)) || dim_equate(b->dims, p->value.dim, q->value.dim, x->span)) return 1;
  diag_error(b->diags, x->span, "units do not match: `%s` is %s, `%s` %s", ast_short(b, x->a), in_dim(b, p->value.dim), ast_short(b, x->b), in_dim(b, q->value.dim));
  if (number) diag_help(b->diags, "give the number its unit: `%s [%s]`", number->text, dim_text(b->dims, other->value.dim));
  return 0;
}

static Part arithmetic(MeasureReader *r, const AstExpr *x) {
  static const struct { const char *text; Binding own, left, right; } ops[] = {
    [AST_ADD] = {" + ", BINDS_SUM, BINDS_SUM, BINDS_PRODUCT}, [AST_SUB] = {" - ", BINDS_SUM, BINDS_SUM, BINDS_PRODUCT},
    [AST_MUL] = {"*", BINDS_PRODUCT, BINDS_PRODUCT, BINDS_SIGN}, [AST_DIV] = {"/", BINDS_PRODUCT, BINDS_PRODUCT, BINDS_SIGN},
    [AST_POW] = {"^", BINDS_POWER, BINDS_PRIMARY, BINDS_SIGN}};
  Builder *b = r->b;
  const Part *p = &r->part[x->a - r->first], *q = x->kind == AST_NEG ? p : &r->part[x->b - r->first];
  if (!p->text || !q->text) return (Part){0};
  Part of = part_of(NULL, BINDS_SIGN, p->value.dim, p->measured || q->measured);
  of.value.bare = p->value.bare && q->value.bare;
  of.literal = p->literal && q->literal;
  if (x->kind == AST_NEG) {
    of.text = arena_printf(b->arena, "-%s", bound(b, p, BINDS_POWER));
    return of;
  }
  if ((x->kind == AST_ADD || x->kind == AST_SUB) && !b->unitless && !units_fit(r, x, p, q)) return (Part){0};
  if (x->kind == AST_MUL) of.value.dim = dim_mul(b->dims, p->value.dim, q->value.dim);
  if (x->kind == AST_DIV) of.value.dim = dim_div(b->dims, p->value.dim, q->value.dim);
  if (x->kind == AST_POW) of.value.dim = q->value.e && expr_is_num(b->g, q->value.e) ? dim_pow(b->dims, p->value.dim, expr_number(b->g, q->value.e)) : DIM_NONE;
  of.binding = ops[x->kind].own;
  if (x->kind == AST_ADD || x->kind == AST_SUB)
    of.text = arena_printf(b->arena, "%s%s%s", term(b, p, q, BINDS_SUM), ops[x->kind].text, term(b, q, p, BINDS_PRODUCT));
  else of.text = arena_printf(b->arena, "%s%s%s", bound(b, p, ops[x->kind].left), ops[x->kind].text, bound(b, q, ops[x->kind].right));
  return of;
}

void set_measure(Builder *b, const AstStmt *st) {
  AstId root = st->rhs;
  MeasureReader r = {.b = b, .first = ast_expr(b->ast, root)->first};
  uint32_t n = root - r.first + 1, errors = b->diags->errors;
  r.part = ARENA_ARRAY(b->arena, Part, n);
  r.inside = ARENA_ARRAY(b->arena, uint8_t, n);
  mark_operands(&r, root);
  for (AstId id = r.first; id <= root; id++) {
    if (r.inside[id - r.first]) continue;
    const AstExpr x = *ast_expr(b->ast, id);
    int free_name = x.kind == AST_NAME && !entity_named(b, x.name), end = free_name && strcmp(x.name, "end") == 0, exponent = free_name && strcmp(x.name, "lyapunov") == 0;
    Part *p = &r.part[id - r.first];
    if (end) *p = part_of("end", BINDS_PRIMARY, seconds(b), 1);
    else if (exponent) *p = part_of("lyapunov", BINDS_PRIMARY, dim_div(b->dims, DIM_NONE, seconds(b)), 1);
    else if (x.kind == AST_CALL) *p = call(&r, id);
    else if (x.kind == AST_AT) *p = at_time(&r, x.a, x.b);
    else if (is_arithmetic(x.kind)) *p = arithmetic(&r, &x);
    else *p = operand(&r, id);
  }
  const Part *whole = &r.part[root - r.first];
  if (!whole->text || b->diags->errors > errors) return;
  Measure m = {.name = st->name, .text = whole->text, .unit = unit_si(whole->value.dim, "")};
  for (uint32_t i = 0; i < b->m->scene.measures.n; i++)
    if (b->m->scene.measures.at[i].name == m.name) {
      b->m->scene.measures.at[i] = m;
      return;
    }
  vec_push(b->arena, &b->m->scene.measures, m);
}
