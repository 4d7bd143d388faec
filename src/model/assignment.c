/* Targets of assignments (`start`, `exact`, `param`, maps of symmetries): left sides, lists, and values for whole
 * families. */
#include <math.h>

#include "base/words.h"
#include "model/builder.h"
#include "sym/expr_eval.h"
#include "sym/sum_nest.h"

Target read_target(const Builder *b, AstId id) {
  static const char letters[] = "xyzw";
  Target p = {.stem = id, .part = -1};
  const AstExpr *x = ast_expr(b->ast, id);
  for (; x->kind == AST_PRIME; x = ast_expr(b->ast, p.stem)) {
    p.primes++;
    p.stem = x->a;
  }
  if (x->kind == AST_MEMBER) {
    const AstExpr *left = ast_expr(b->ast, x->a);
    const AstExpr *owner = left->kind == AST_MEMBER ? ast_expr(b->ast, left->a) : NULL; /* wind.v.x */
    int of_effect = owner && owner->kind == AST_NAME &&
                    (scope_own(&b->scope, left->name, owner->name) || !entity_named(b, owner->name));
    int component =
        left->kind == AST_INDEX || of_effect ||
        (left->kind == AST_NAME && !scope_own(&b->scope, x->name, left->name) && entity_named(b, left->name));
    if (component) {
      p.part = strlen(x->name) == 1 && strchr(letters, x->name[0]) ? (int)(strchr(letters, x->name[0]) - letters) : 4;
      p.stem = x->a;
      x = left;
    }
  }
  if (x->kind == AST_INDEX) {
    p.indices = x->args;
    p.stem = x->a;
    x = ast_expr(b->ast, p.stem);
  }
  p.wrong = x->kind != AST_NAME && !(x->kind == AST_MEMBER && ast_expr(b->ast, x->a)->kind == AST_NAME);
  return p;
}

const AstExpr *list_behind(const Builder *b, AstId id, const AstUnit **unit) {
  const AstExpr *x = ast_expr(b->ast, id);
  *unit = NULL;
  if (x->kind == AST_UNIT && ast_expr(b->ast, x->a)->kind == AST_LIST) {
    *unit = &x->unit;
    x = ast_expr(b->ast, x->a);
  }
  return x->kind == AST_LIST ? x : NULL;
}

static uint64_t count_along(const IndexRange *r, uint32_t k) {
  return r->hi[k] < r->lo[k] ? 0 : (uint64_t)(r->hi[k] - r->lo[k] + 1);
}

uint64_t range_count(const IndexRange *r) {
  uint64_t n = 1;
  for (uint32_t k = 0; k < r->n; k++) n *= count_along(r, k);
  return n;
}

static int report_count(Builder *b, const AstExpr *list, const char *what, const char *wanted) {
  uint32_t n = ast_list_length(b->ast, list->args);
  return diag_error(b->diags, list->span, "%s has %u element%s, and %s", what, n, plural(n), wanted);
}

/* Elements of a list of rows; each row is a list, with or without a unit of its own. */
static int row_elements(Builder *b, const AstExpr *list, const AstUnit *behind, const IndexRange *r, Name name,
                        Elements *out) {
  uint64_t rows = count_along(r, 0), columns = count_along(r, 1);
  if (ast_list_length(b->ast, list->args) != rows)
    return report_count(b, list, "the list",
                        arena_printf(b->arena, "`%s` has %llu rows", name, (unsigned long long)rows));
  for (AstId i = list->args; i; i = ast_expr(b->ast, i)->next) {
    const AstUnit *own;
    const AstExpr *row = list_behind(b, i, &own);
    if (!row || ast_list_length(b->ast, row->args) != columns)
      return row ? report_count(b, row, "this row",
                                arena_printf(b->arena, "those of `%s` have %llu", name, (unsigned long long)columns))
                 : report_count(b, list, "the list", "some are rows and some are not");
    for (AstId k = row->args; k; k = ast_expr(b->ast, k)->next)
      vec_push(b->arena, out, ((Element){k, own ? own : behind}));
  }
  return 1;
}

int list_elements(Builder *b, const AstExpr *list, const AstUnit *behind, const IndexRange *r, Name name,
                  Elements *out) {
  const AstUnit *own;
  const AstExpr *row = list_behind(b, list->args, &own);
  if (row && r->n == 2) return row_elements(b, list, behind, r, name, out);
  if (row)
    return diag_error(b->diags, row->span, "a list in a list gives a row of a family with two indices, and `%s` has %s",
                      name, r->n ? "one" : "none");
  if (!r->n) {
    report_count(b, list, "the list", arena_printf(b->arena, "`%s` is no family", name));
    diag_help(b->diags, "a list gives a family its members; a vector is written `(a, b)`");
    return 0;
  }
  if (ast_list_length(b->ast, list->args) != range_count(r))
    return report_count(b, list, "the list",
                        arena_printf(b->arena, "`%s` has %llu members", name, (unsigned long long)range_count(r)));
  for (AstId i = list->args; i; i = ast_expr(b->ast, i)->next) vec_push(b->arena, out, ((Element){i, behind}));
  return 1;
}

Value element_value(Builder *b, const Element *x, Context where, Name effect) {
  Value v = resolve(b, x->id, where, effect);
  if (!x->behind || !v.e) return v;
  Unit own = unit_resolve(x->behind, b->dims, b->diags, b->arena);
  v = values_in(b, v, ast_expr(b->ast, x->id)->span, &own);
  v.bare = 0;
  v.dim = own.dim;
  return v;
}

/* --- assignment --- */

typedef struct {
  Builder *b;
  const Target *p;
  const Entity *e;
  const Assigner *assigner;
  uint32_t parts;       /* components of the required value; 0: a number */
} Assign;

/* Assigns a value to member `at`; 0 after an error. */
static int give_member(const Assign *s, const int64_t *at, AstId id, Value v) {
  Builder *b = s->b;
  Span span = ast_expr(b->ast, id)->span;
  if (!v.e) return 0;
  if (v.n != s->parts)
    return diag_error(b->diags, span, "`%s` is %s, and %s is given here",
                      member_name(b->ast, s->e->name, at, s->e->ndims), shape_text(b, s->parts), shape_text(b, v.n));
  uint32_t first =
      s->e->index + member_offset(s->e, at) + (s->p->part < 0 ? 0 : (uint32_t)component_index(s->e->parts, s->p->part));
  v = values_in(b, v, span, s->assigner->unit(b, first, s->assigner->data));
  for (uint32_t k = 0; v.e && k < (v.n ? v.n : 1); k++)
    s->assigner->give(b, first + k, v.at[k], span, s->assigner->data);
  return v.e != 0;
}

/* Ranges of the target's indices (none: the whole family); 0, reported, when they do not fit the entity. */
static int read_ranges(Builder *b, const Target *p, const Entity *e, AstId lhs, IndexRange *r) {
  Span span = ast_expr(b->ast, lhs)->span;
  *r = entity_range(e);
  if (!p->indices) return 1;
  if (!e->ndims)
    return diag_error(b->diags, span, "`%s` is %s without index" HELP "a family is declared with its size: `%s[3]`",
                      e->name, ent_kind_text(e->kind), e->name);
  if (!resolve_indices(b, p->indices, NULL, r)) return 0;
  if (r->n != e->ndims)
    return diag_error(b->diags, span, "`%s` has %s, here it has %u", e->name,
                      e->ndims == 1 ? "one index" : "two indices", r->n);
  int empty = 0;
  for (uint32_t k = 0; k < r->n; k++) empty |= r->hi[k] < r->lo[k];
  return empty || (index_in_range(b, e, r->lo, span) && index_in_range(b, e, r->hi, span));
}

/* Assigns the elements of a list, one to each member. */
static void give_list(const Assign *s, const IndexRange *r, const AstExpr *list, const AstUnit *behind) {
  Elements elements = {0};
  if (!list_elements(s->b, list, behind, r, s->e->name, &elements)) return;
  int64_t at[2] = {r->lo[0], r->lo[1]};
  for (uint32_t i = 0; i < elements.n; i++) {
    give_member(s, at, elements.at[i].id,
                element_value(s->b, &elements.at[i], s->assigner->where, s->assigner->effect));
    range_next(r, at);
  }
}

/* Whether the text between `after` and `rhs` only computes with indices: no text depends on which member it is of. */
static int computes_with_indices(const Builder *b, AstId after, AstId rhs) {
  static const AstKind kinds[] = {AST_NUM, AST_NAME, AST_UNIT, AST_NEG, AST_ADD, AST_SUB,
                                  AST_MUL, AST_DIV,  AST_POW,  AST_TUPLE, AST_CALL};
  for (AstId id = after + 1; id <= rhs; id++) {
    const AstExpr *x = ast_expr(b->ast, id);
    size_t k = 0;
    while (k < sizeof kinds / sizeof *kinds && kinds[k] != x->kind) k++;
    if (k == sizeof kinds / sizeof *kinds) return 0;
    if (x->kind == AST_POW && ast_expr(b->ast, x->b)->kind != AST_NUM) return 0;
    if (x->kind == AST_CALL && (function_index(x->name) < 0 || entity_named(b, x->name))) return 0;
  }
  return after < rhs;
}

/* Whether the formula has values for all members. */
static int is_finite(const Builder *b, const FamilyValue *x) {
  const Model *m = b->m;
  long double *symbols = model_constants(m), y[4];
  unsigned kinds = 0;
  int finite = 1;
  for (uint32_t k = 0; k < x->n; k++) kinds |= expr_kinds(b->g, x->value[k]);
  for (uint32_t i = 0; i < m->params.n && kinds & 1u << SYM_PARAM; i++)
    if (m->params.at[i].value) expr_eval(b->g, &m->params.at[i].value, 1, symbols, &symbols[m->params.at[i].sym]);
  EvalTape *tape = eval_tape(b->g, x->value, x->n);
  for (int64_t t = 0; finite && t < x->range.rows * x->range.turns; t++) {
    symbols[x->index[0]] = (long double)(x->lo[0] + t / x->range.turns);
    symbols[x->index[1]] = (long double)(x->lo[1] + t % x->range.turns);
    eval_run(tape, symbols, y);
    for (uint32_t k = 0; k < x->n; k++) finite &= isfinite(y[k]) != 0;
  }
  eval_tape_free(b->g, tape);
  arena_release(b->arena, symbols, (expr_symbol_count(b->g) + 1) * sizeof *symbols);
  return finite;
}

/* Assigns one formula to many members at once; 0: each is to have its own. */
static int give_family(const Assign *s, const IndexRange *r, AstId lhs, AstId rhs) {
  enum { MANY = 64 };
  static const char *const unnamed[2] = {"row", "turn"};
  Builder *b = s->b;
  uint32_t outer = b->index.n;
  uint64_t members = range_count(r);
  if (!s->assigner->give_family || members < MANY || !computes_with_indices(b, lhs, rhs)) return 0;
  const int64_t next[2] = {r->lo[0] + (r->n == 2 || r->n == 1), r->lo[1]}, beside[2] = {r->lo[0], r->lo[1] + 1};
  FamilyValue x = {.range = {.rows = (uint32_t)count_along(r, 0), .turns = r->n == 2 ? (int64_t)count_along(r, 1) : 1}};
  uint32_t first = member_offset(s->e, r->lo);
  x.at = (Subscript){s->e->index + first + (s->p->part < 0 ? 0 : (uint32_t)component_index(s->e->parts, s->p->part)),
                     member_offset(s->e, next) - first, r->n == 2 ? member_offset(s->e, beside) - first : 0};
  for (uint32_t k = 0; k < 2; k++) {
    Name name = r->name[k] ? r->name[k] : intern(b->ast->names, unnamed[k]);
    x.index[k] = expr_sym_id(b->g, expr_named_symbol(b->g, name));
    x.lo[k] = r->lo[k];
    if (k < r->n && r->name[k]) vec_push(b->arena, &b->index, ((IndexVar){name, r->lo[k]}));
  }
  b->index_symbols = 1;
  Value v = resolve(b, rhs, s->assigner->where, s->assigner->effect);
  b->index_symbols = 0;
  b->index.n = outer;
  if (!v.e) return 1;
  if (v.n != s->parts) return 0;
  v = values_in(b, v, ast_expr(b->ast, rhs)->span, s->assigner->unit(b, (uint32_t)x.at.first, s->assigner->data));
  if (!v.e) return 1;
  x.n = v.n ? v.n : 1;
  for (uint32_t k = 0; k < x.n; k++) x.value[k] = v.at[k];
  return is_finite(b, &x) && s->assigner->give_family(b, &x, s->assigner->data);
}

/* Assigns a formula: evaluated for each member with its indices in scope, or once if no index is named. */
static void give_formula(const Assign *s, const IndexRange *r, AstId rhs) {
  Builder *b = s->b;
  uint32_t outer = b->index.n;
  int64_t at[2] = {r->lo[0], r->lo[1]};
  int named = r->name[0] || r->name[1];
  Value v = named || !range_count(r) ? (Value){0} : resolve(b, rhs, s->assigner->where, s->assigner->effect);
  if (!range_count(r)) return;
  do {
    b->index.n = outer;
    for (uint32_t k = 0; k < r->n; k++)
      if (r->name[k]) vec_push(b->arena, &b->index, ((IndexVar){r->name[k], at[k]}));
    if (named) v = resolve(b, rhs, s->assigner->where, s->assigner->effect);
    if (!give_member(s, at, rhs, v)) break;
  } while (range_next(r, at));
  b->index.n = outer;
}

void assign_values(Builder *b, const Target *p, const Entity *e, AstId lhs, AstId rhs, const Assigner *assigner) {
  Assign s = {.b = b, .p = p, .e = e, .assigner = assigner, .parts = p->part < 0 ? e->parts : 0};
  IndexRange r;
  if (p->part >= 0 && component_index(e->parts, p->part) < 0) {
    diag_error(b->diags, ast_expr(b->ast, lhs)->span, "`%s` is %s: it has no such component", e->name,
               shape_text(b, e->parts));
    return;
  }
  if (!read_ranges(b, p, e, lhs, &r)) return;
  check_members_kept(b, p, e, &r, lhs);
  const AstUnit *behind;
  const AstExpr *list = list_behind(b, rhs, &behind);
  if (list) give_list(&s, &r, list, behind);
  else if (!give_family(&s, &r, lhs, rhs)) give_formula(&s, &r, rhs);
}
