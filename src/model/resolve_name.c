/* Names in expressions: indices, arguments, built-in quantities (energy, T, V, p_x), declared names, members of
 * families, components. */
#include "model/resolve_impl.h"
#include "sym/diff.h"
#include "sym/sum_nest.h"

const Entity *resolve_name(Builder *b, Name name, Span span, Name effect, const char *declare) {
  int ambiguous;
  const Entity *e = scope_find(&b->scope, name, effect, &ambiguous);
  if (!e) {
    diag_error(b->diags, span, "unknown name `%s`", name);
    advise_unknown_name(b, name, span, effect, declare);
  } else if (ambiguous) {
    diag_error(b->diags, span, "`%s` is declared by more than one effect in use" HELP "say which: `%s.%s`", name,
               e->effect, name);
    return NULL;
  }
  return e;
}

void suspend_for(Eval *ev, EntKind kind, uint32_t index, Progress progress, Name name, Span span) {
  Builder *b = ev->b;
  if (progress == DOING) {
    diag_error(b->diags, span, "the definition of `%s` is circular", name);
    diag_help(b->diags, "%s may not depend on itself, directly or through others", ent_kind_text(kind));
    return;
  }
  b->needed_kind = kind;
  b->needed = index;
  ev->waiting = 1;
}

static Value defined_value(Eval *ev, const Entity *e, Span span) {
  const Evaluated *d = &ev->b->state[e->kind].at[e->index];
  if (d->progress == DONE) return d->value;
  suspend_for(ev, e->kind, e->index, d->progress, e->name, span);
  return FAILED;
}

/* --- values of names --- */

static const char *place_text(Context where) {
  switch (where) {
    case IN_CONST: return "only numbers and constants are known here";
    case IN_PARAM: return "a parameter's value may contain numbers and parameters declared before it";
    case IN_START:
      return "a start or a value in a scene may contain numbers, parameters, and lets and functions of them";
    case IN_INPUT: return "an input may contain numbers, parameters and t";
    case IN_DYNAMICS: return "declare a name that equations contain by `let`; observables are for outputs";
    case IN_EXACT: case IN_OBSERVE: case IN_OUTPUT: break;
  }
  return "";
}

static Context least_context(EntKind kind) {
  switch (kind) {
    case ENT_CONST: return IN_CONST;
    case ENT_PARAM: return IN_PARAM;
    case ENT_OBSERVE: case ENT_SYMMETRY: return IN_OBSERVE;
    case ENT_LET: case ENT_FUNCTION: return IN_START;
    case ENT_NONE: case ENT_COORD: case ENT_STATE: case ENT_INPUT: case ENT_BUILTIN: break;
  }
  return IN_DYNAMICS;
}

static int moves(const Symbol *s, const void *found) {
  if (s->kind == SYM_PARAM || s->kind == SYM_CONST) return 0;
  **(Name *const *)found = s->name;
  return 1;
}

Value known_at_start(Eval *ev, Value v, Name name, Span span) {
  Name moving = NULL, *found = &moving;
  for (uint32_t k = 0; ev->where == IN_START && v.e && k < component_count(&v); k++)
    if (expr_contains(ev->b->g, v.at[k], moves, &found))
      return refuse(ev->b, span, "`%s` contains `%s` and may not be used here" HELP "%s", name, moving,
                    place_text(IN_START));
  return v;
}

/* Value of a plain name, or of member `at` of a family. */
static Value entity_value(Eval *ev, const Entity *e, const int64_t *at, Span span) {
  Builder *b = ev->b;
  if (e->kind == ENT_NONE) return FAILED;
  if (least_context(e->kind) > ev->where)
    return refuse(b, span, "`%s` is %s and may not be used here" HELP "%s", e->name, ent_kind_text(e->kind),
                  place_text(ev->where));
  switch (e->kind) {
    case ENT_COORD: case ENT_STATE: case ENT_PARAM: case ENT_INPUT: {
      Value v = {.n = e->parts};
      uint32_t i = e->index + member_offset(e, at);
      for (uint32_t k = 0; k < component_count(&v); k++)
        v.at[k] = expr_symbol(b->g, entity_symbol(b->m, e->kind, 0, i + k))->node;
      v.dim = b->dim_of.at[entity_symbol(b->m, e->kind, 0, i)];
      v.unit = entity_unit(b, e)->text;
      return v;
    }
    case ENT_CONST: return b->constant_values.at[e->index];
    case ENT_SYMMETRY: {
      const Symmetry *y = &b->m->symmetries.at[e->index];
      Value v = a_value(expr_symbol(b->g, y->charge)->node, y->unit.dim, 0);
      v.unit = y->unit.text;
      return v;
    }
    case ENT_LET: case ENT_OBSERVE: return known_at_start(ev, defined_value(ev, e, span), e->name, span);
    case ENT_FUNCTION:
      return refuse(b, span, "`%s` is a function" HELP "give it its arguments: `%s(...)`", e->name, e->name);
    case ENT_NONE: case ENT_BUILTIN: break;
  }
  return FAILED;
}

/* Refuses a family without an index in a map, as of a symmetry. */
static Value map_of_members(Builder *b, const Entity *e, Span span) {
  const char *second = e->ndims > 1 ? ",j" : "", *other = "";
  if (e->ndims > 1) other = arena_printf(b->arena, ", j in %lld..%lld", (long long)e->lo[1], (long long)e->hi[1]);
  return refuse(b, span,
                "`%s` is a family: say which member" HELP "a map of all is `%s[i in %lld..%lld%s] -> %s[i%s] + ...`",
                e->name, e->name, (long long)e->lo[0], (long long)e->hi[0], other, e->name, second);
}

Value whole_value(Eval *ev, const Entity *e, Span span) {
  if (!e->ndims || e->kind == ENT_NONE) return entity_value(ev, e, NULL, span);
  Name one = member_name(ev->b->ast, e->name, e->lo, e->ndims);
  if (ev->b->nbound && ev->where == IN_DYNAMICS && is_coordinate(ev->b, e)) return map_of_members(ev->b, e, span);
  return refuse(ev->b, span,
                "`%s` is a family: say which member" HELP "the first is `%s`; `sum(i in ..., ...)` adds over all",
                e->name, one);
}

/* Whether the name is of a Lagrangian that is wrong itself, which is told already. */
static int of_wrong_lagrangian(const Builder *b, Name name) {
  int quantity = strcmp(name, "energy") == 0 || strcmp(name, "lagrangian") == 0 || strcmp(name, "T") == 0 ||
                 strcmp(name, "V") == 0 || strncmp(name, "p_", 2) == 0;
  return quantity && !b->m->lagrangian && b->diags->errors;
}

/* lagrangian, energy, T, V in outputs and claims, unless the model declares the name; 0: not one of them. */
static int builtin_quantity(Eval *ev, Name name, Value *out) {
  Builder *b = ev->b;
  Model *m = b->m;
  if (ev->where < IN_OBSERVE) return 0;
  if (of_wrong_lagrangian(b, name)) {
    *out = FAILED;
    return 1;
  }
  Expr e = 0;
  if (strcmp(name, "lagrangian") == 0) e = m->lagrangian;
  else if (strcmp(name, "energy") == 0 && m->lagrangian) e = expr_symbol(b->g, m->energy_sym)->node;
  else if (strcmp(name, "T") == 0) e = m->kinetic;
  else if (strcmp(name, "V") == 0) e = m->potential;
  if (!e) return 0;
  *out = a_value(e, b->energy, 0);
  return 1;
}

/* The coordinate x of a momentum name `p_x`; NULL if there is none, or a declaration takes the name. */
static const Entity *momentum_of(const Eval *ev, Name name) {
  int ambiguous;
  Builder *b = ev->b;
  if (ev->where < IN_OBSERVE || strncmp(name, "p_", 2) != 0 || !b->m->lagrangian ||
      scope_find(&b->scope, name, ev->effect, &ambiguous))
    return NULL;
  const Entity *e = scope_find(&b->scope, intern(b->ast->names, name + 2), ev->effect, &ambiguous);
  return e && is_coordinate(b, e) && !ambiguous ? e : NULL;
}

/* dL/dq' of a coordinate, or of member `at` of a family. */
static Value momentum_value(const Eval *ev, const Entity *e, const int64_t *at) {
  Builder *b = ev->b;
  uint32_t i = e->index + member_offset(e, at);
  Value r = {.n = e->parts, .domain = domain_of_derivative(b, &(Value){.e = b->m->lagrangian})};
  for (uint32_t k = 0; k < component_count(&r); k++) {
    SymId v = entity_symbol(b->m, e->kind, 1, i + k);
    r.at[k] = expr_diff(b->g, b->m->lagrangian, v);
    r.dim = dim_div(b->dims, b->energy, b->dim_of.at[v]);
  }
  return r;
}

/* Innermost index variable of that name, or NULL. */
static const IndexVar *find_index(const Eval *ev, Name name) {
  for (uint32_t i = ev->index.n; i-- > 0;)
    if (ev->index.at[i].name == name) return &ev->index.at[i];
  const IndexVars *outer = &ev->b->index;
  for (uint32_t i = ev->in_statement ? outer->n : 0; i-- > 0;)
    if (outer->at[i].name == name) return &outer->at[i];
  return NULL;
}

Value name_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const IndexVar *index = find_index(ev, x->name);
  int is_symbol = index && b->index_symbols && index >= b->index.at && index < b->index.at + b->index.n;
  if (is_symbol || (index && quantified_counts(ev, x))) return a_value(expr_named_symbol(b->g, x->name), DIM_NONE, 1);
  if (index) return a_value(expr_int(b->g, index->at), DIM_NONE, 1);
  for (uint32_t i = 0; i < b->nbound && ev->in_statement; i++)
    if (b->bound[i].name == x->name)
      return a_value(expr_symbol(b->g, b->bound[i].sym)->node, b->dim_of.at[b->bound[i].sym], 0);
  const Value *argument = function_argument(b, ev->function, x->name);
  if (argument) return *argument;
  if (strcmp(x->name, "pi") == 0) return a_value(expr_symbol(b->g, b->m->pi)->node, DIM_NONE, 1);
  if (strcmp(x->name, "t") == 0) {
    if (ev->where >= IN_INPUT) return a_value(expr_symbol(b->g, b->m->time)->node, b->dim_of.at[b->m->time], 0);
    return refuse(b, x->span, "the time `t` may not be used here" HELP "%s", place_text(ev->where));
  }
  Value v;
  if (!scope_find(&b->scope, x->name, ev->effect, NULL) && builtin_quantity(ev, x->name, &v)) return v;
  const Entity *q = momentum_of(ev, x->name);
  if (q && !q->ndims) return momentum_value(ev, q, NULL);
  const Entity *e = q ? q : resolve_name(b, x->name, x->span, ev->effect, NULL);
  return e ? whole_value(ev, e, x->span) : FAILED;
}

/* --- members of families --- */

/* " where i = 1, j = 3": values of the enclosing indices. */
static const char *indices_text(Eval *ev) {
  StrBuf s = strbuf(ev->b->arena);
  const IndexVars *sets[2] = {&ev->b->index, &ev->index};
  for (int k = ev->in_statement ? 0 : 1; k < 2; k++)
    for (uint32_t i = 0; i < sets[k]->n; i++)
      sb_printf(&s, "%s%s = %lld", s.n ? ", " : "", sets[k]->at[i].name, (long long)sets[k]->at[i].at);
  return s.n ? arena_printf(ev->b->arena, " where %s", sb_text(&s)) : "";
}

static int in_range(const Entity *e, const int64_t *at) {
  for (int k = 0; k < e->ndims; k++)
    if (at[k] < e->lo[k] || at[k] > e->hi[k]) return 0;
  return 1;
}

/* Reports an index out of range, with the range. */
static void report_range(Builder *b, const Entity *e, const int64_t *at, Span span, const char *where) {
  StrBuf s = strbuf(b->arena);
  for (int k = 0; k < e->ndims; k++)
    sb_printf(&s, "%s%lld..%lld", k ? ", " : "", (long long)e->lo[k], (long long)e->hi[k]);
  diag_drop_notes(b->diags, span); /* that a sum is written out, since an index leaves the range */
  diag_error(b->diags, span, "`%s` is out of range%s", member_name(b->ast, e->name, at, e->ndims), where);
  if (in_range(e, at)) diag_help(b->diags, "`%s` is defined in %s, but not for this member", e->name, sb_text(&s));
  else if (!entity_size(e)) diag_help(b->diags, "`%s` has no members", e->name);
  else diag_help(b->diags, "the members are `%s[%s]`", e->name, sb_text(&s));
}

int index_in_range(Builder *b, const Entity *e, const int64_t *at, Span span) {
  if (in_range(e, at)) return 1;
  report_range(b, e, at, span, "");
  return 0;
}

static Value indexed_value(Eval *ev, const Entity *e, const AstExpr *x, int momentum) {
  Builder *b = ev->b;
  int64_t at[2] = {0};
  uint32_t n = 0;
  for (AstId i = x->args; i; i = ast_expr(b->ast, i)->next, n++)
    if (n < 2 && !whole_number(b, value_of(ev, i), i, &at[n])) return FAILED;
  if (e->kind == ENT_NONE) return FAILED;
  if (!e->ndims) {
    diag_error(b->diags, x->span, "`%s` is %s without index", e->name, ent_kind_text(e->kind));
    if (e->parts == ROTATION)
      diag_help(b->diags, "the components of a rotation are `%s.w`, `%s.x`, `%s.y`, `%s.z`", e->name, e->name, e->name,
                e->name);
    else if (e->parts) diag_help(b->diags, "the components of a vector are `%s.x`, `%s.y`", e->name, e->name);
    else
      diag_help(b->diags, "a family is declared with its size: `%s[3]`; a unit stands apart: `%s [%s]`", e->name,
                e->name, ast_text(b, x->args));
    return FAILED;
  }
  if (n != e->ndims)
    return refuse(b, x->span, "`%s` has %s, here it has %u", e->name, e->ndims == 1 ? "one index" : "two indices", n);
  const Entity *member = e;
  int listed = e->kind == ENT_LET || e->kind == ENT_OBSERVE;
  if (in_range(e, at) && listed) member = find_member(b->ast, &b->members, e, at);
  if (!in_range(e, at) || !member) {
    report_range(b, e, at, x->span, indices_text(ev));
    return FAILED;
  }
  return momentum ? momentum_value(ev, e, at) : entity_value(ev, member, at, x->span);
}

Value index_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const AstExpr *of = ast_expr(b->ast, x->a);
  const Entity *e = NULL;
  if (of->kind == AST_NAME && (e = momentum_of(ev, of->name))) return indexed_value(ev, e, x, 1);
  if (of->kind == AST_NAME) {
    e = resolve_name(b, of->name, of->span, ev->effect, NULL);
  } else if (of->kind == AST_MEMBER && ast_expr(b->ast, of->a)->kind == AST_NAME) {
    Name owner = ast_expr(b->ast, of->a)->name;
    e = scope_own(&b->scope, of->name, owner);
    if (!e) report_no_member(b, of->span, owner, of->name);
  } else if (of->kind != AST_ERROR)
    diag_error(b->diags, x->span, "an index stands directly behind the name of a family");
  return e ? indexed_value(ev, e, x, 0) : FAILED;
}

/* --- components --- */

static Value component(Eval *ev, const AstExpr *x, Value v) {
  Builder *b = ev->b;
  if (!v.e) return FAILED;
  uint32_t k = 0;
  while (k < v.n && !(x->name[0] == component_letter(v.n, k) && !x->name[1])) k++;
  if (k < v.n) {
    Value one = a_value(v.at[k], v.dim, v.bare);
    one.unit = v.unit;
    one.domain = v.domain;
    return one;
  }
  diag_error(b->diags, x->span, "`%s` has no component `%s`", ast_short(b, x->a), x->name);
  if (v.n)
    diag_help(b->diags, "it is %s: %s", shape_text(b, v.n),
              v.n == 2   ? "`.x`, `.y`"
              : v.n == 3 ? "`.x`, `.y`, `.z`"
                         : "`.w`, `.x`, `.y`, `.z`");
  else diag_help(b->diags, "it is a number; vectors are declared `coord r: vec3 [m]`, or written `(a, b, c)`");
  return FAILED;
}

/* drag.c, a name of an effect, or r.x, a component. */
Value member_value(Eval *ev, const AstExpr *x) {
  Builder *b = ev->b;
  const AstExpr *left = ast_expr(b->ast, x->a);
  if (left->kind != AST_NAME) return component(ev, x, *value_of(ev, x->a));
  const Entity *e = scope_own(&b->scope, x->name, left->name);
  if (e) return whole_value(ev, e, x->span);
  if (scope_find(&b->scope, left->name, ev->effect, NULL) || momentum_of(ev, left->name) ||
      find_index(ev, left->name) || function_argument(b, ev->function, left->name)) {
    Value v = name_value(ev, left);
    return ev->waiting ? FAILED : component(ev, x, v);
  }
  report_no_member(b, x->span, left->name, x->name);
  return FAILED;
}

Value resolve_member(Builder *b, const Entity *e, const int64_t *at, uint32_t primes, Span span, Context where) {
  Eval ev = {.b = b, .where = where, .in_statement = 1};
  int defined = e->kind == ENT_LET || e->kind == ENT_OBSERVE;
  const Entity *member = e->ndims && defined ? find_member(b->ast, &b->members, e, at) : e;
  if (!member) return FAILED;
  if (defined) resolve_definition(b, member->kind, member->index);
  Value v = entity_value(&ev, member, at, span);
  if (v.n == ROTATION && primes) return refuse_rotation(b, span, e->name, TURN_PRIME);
  for (; v.e && primes; primes--) v = time_derivative(b, v, span, where);
  return v;
}
