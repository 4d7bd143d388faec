/* The size of large families (family_size.h): which numbers of a text depend on it, and how. */
#include "model/family_size.h"

/* Facts about an expression. FIXED: the compiler knows its value, which depends on the size or on an index. PLACE: it
 * says where a member stands, or is a small number: an index or an end, or twice or half of it (SCALED), and at most
 * FAMILY_END to a side. FALLS: it may be negative. UNSURE: far from the ends its sign may be another than near them.
 * RUN: only a run knows its value. */
enum { FIXED = 1, PLACE = 2, SCALED = 4, FALLS = 8, UNSURE = 16, RUN = 32 };

typedef struct {
  unsigned char is, reach; /* of a PLACE: the sum of its small numbers */
} Fact;

typedef struct {
  Name name;
  AstId value;
  Fact fact;
} Named; /* a constant or a let */

typedef struct {
  const Ast *ast;
  VEC(Name) indices;
  VEC(Named) named;
  Fact *facts;  /* by AstId */
  int even;     /* nothing was found against the text */
  int has_size; /* the size of some family, or the end of some range, depends on the constant */
} Facts;

static Fact fact_of_name(const Facts *f, Name name) {
  for (uint32_t i = 0; i < f->indices.n; i++)
    if (f->indices.at[i] == name) return (Fact){FIXED | PLACE, 0};
  for (uint32_t i = 0; i < f->named.n; i++)
    if (f->named.at[i].name == name) return f->named.at[i].fact;
  return (Fact){strcmp(name, "pi") == 0 ? 0 : RUN, 0};
}

static Fact no_place(Fact x) { return (Fact){x.is & (unsigned char)~(PLACE | SCALED), 0}; }

/* The fact about a value that two others determine smoothly. */
static Fact both(Fact x, Fact y) {
  const unsigned any = x.is | y.is;
  const int reach = x.reach + y.reach, place = x.is & y.is & PLACE && reach <= FAMILY_END;
  if (any & RUN) return (Fact){(unsigned char)(RUN | (any & UNSURE)), 0};
  Fact r = {(unsigned char)(any & ~(unsigned)PLACE), (unsigned char)(place ? reach : 0)};
  return place ? (Fact){r.is | PLACE, r.reach} : no_place(r);
}

static int is_fixed(Fact x) { return (x.is & (FIXED | RUN)) == FIXED; }

/* The number n if the expression is one of 2, 4, 8, 16: what is divided by it has the same remainder in all sizes. */
static int part_of_step(const Ast *ast, AstId id) {
  const AstExpr *x = ast_expr(ast, id);
  for (int n = 2; n <= FAMILY_STEP && x->kind == AST_NUM; n *= 2)
    if (num_equal(x->number, num_int(n))) return n;
  return 0;
}

/* Of numbers that are fixed, only places may be compared, and have the smaller or the remainder taken. */
static Fact compared(Facts *f, Fact x, Fact y) {
  Fact r = both(x, y);
  if (is_fixed(r) && !(r.is & PLACE)) f->even = 0;
  return r;
}

static Fact fact_of_sum(const AstExpr *x, Fact a, Fact b) {
  Fact r = both(a, b);
  const int falls = x->kind == AST_SUB;
  if (is_fixed(r) && falls) r.is |= FALLS;
  if (is_fixed(r) && !(r.is & PLACE) && r.is & FALLS) r.is |= UNSURE;
  return r;
}

/* x times or over y: a place where y is 2, and x none that was scaled. */
static Fact scaled(const Facts *f, AstId x, AstId y) {
  const Fact a = f->facts[x], r = both(a, f->facts[y]);
  if (part_of_step(f->ast, y) != 2 || !is_fixed(a) || !(a.is & PLACE) || a.is & SCALED || 2*a.reach > FAMILY_END)
    return no_place(r);
  return (Fact){a.is | SCALED, (unsigned char)(2*a.reach)};
}

static Fact fact_of_product(const Facts *f, const AstExpr *x) {
  const Fact r = scaled(f, x->a, x->b);
  return r.is & PLACE ? r : scaled(f, x->b, x->a);
}

static Fact fact_of_quotient(Facts *f, const AstExpr *x) {
  const Fact b = f->facts[x->b];
  if (is_fixed(b) && !(b.is & PLACE)) f->even = 0; /* it may be 0 at some member far from the ends */
  return scaled(f, x->a, x->b);
}

static Fact fact_of_power(Facts *f, const AstExpr *x) {
  const Fact a = f->facts[x->a], b = f->facts[x->b];
  const AstExpr *n = ast_expr(f->ast, x->b), *base = ast_expr(f->ast, x->a),
                *one = ast_expr(f->ast, base->kind == AST_NEG ? base->a : 0);
  if (base->kind == AST_NEG && one->kind == AST_NUM && num_is_one(one->number) && b.is & PLACE) /* (-1)^i */
    return (Fact){FIXED | PLACE | FALLS, 1};
  int small = n->kind == AST_NUM && (num_equal(n->number, num_int(2)) || num_equal(n->number, num_int(3)));
  if (is_fixed(b) || (is_fixed(a) && !small)) f->even = 0;
  return no_place(both(a, b));
}

static int is_one_of(const char *name, const char *const *of) {
  while (*of && strcmp(name, *of) != 0) of++;
  return *of != NULL;
}

static Fact fact_of_call(Facts *f, const AstExpr *x) {
  static const char *const waves[] = {"sin", "cos", NULL}, *const places[] = {"min", "max", "mod", NULL};
  const int is_if = strcmp(x->name, "if") == 0, wave = is_one_of(x->name, waves), place = is_one_of(x->name, places);
  Fact r = {PLACE, 0};
  for (AstId a = x->args; a; a = ast_expr(f->ast, a)->next) {
    if (is_fixed(f->facts[a]) && !is_if && !wave && !place) f->even = 0;
    r = place && a != x->args ? compared(f, r, f->facts[a]) : both(r, f->facts[a]);
  }
  AstId second = x->args ? ast_expr(f->ast, x->args)->next : 0;
  if (strcmp(x->name, "mod") == 0 && is_fixed(r) && !is_fixed(f->facts[second]) && !part_of_step(f->ast, second))
    f->even = 0;
  if (place || is_if) return r;
  if (r.is & RUN) return r;
  if (wave && is_fixed(r)) return (Fact){FIXED | FALLS | UNSURE, 0};
  /* a function of the text may bring in the size */
  return (Fact){(r.is & FIXED) || function_index(x->name) < 0 ? FIXED | FALLS | UNSURE : 0, 0};
}

/* Of a range, or the index of a member. */
static void take_place(Facts *f, AstId id) {
  if (!(f->facts[id].is & PLACE)) f->even = 0;
}

static Fact fact_of_member(Facts *f, const AstExpr *x) {
  for (AstId i = x->args; i; i = ast_expr(f->ast, i)->next)
    if (ast_expr(f->ast, i)->kind != AST_BIND) take_place(f, i);
  return f->facts[x->a];
}

static Fact fact_of_range(Facts *f, const AstExpr *x) {
  take_place(f, x->a);
  take_place(f, x->b);
  f->has_size |= is_fixed(f->facts[x->b]);
  if (x->kind == AST_BIND) return (Fact){0};
  Fact r = no_place(f->facts[x->c]);
  return r.is & RUN ? r : (Fact){r.is | FIXED, 0};
}

static Fact fact_of_list(const Facts *f, const AstExpr *x) {
  Fact r = {0};
  for (AstId i = x->args; i; i = ast_expr(f->ast, i)->next) r = both(r, f->facts[i]);
  return r;
}

/* A whole number, or a half; numbers of the text have no sign. */
static Fact fact_of_number(const AstExpr *x) {
  const double v = num_value(x->number);
  if (!(v <= FAMILY_END) || !num_is_int(num_mul(x->number, num_int(2)))) return (Fact){0};
  return (Fact){PLACE, (unsigned char)(v + 0.5)};
}

static Fact fact_of(Facts *f, const AstExpr *x) {
  Fact r;
  switch (x->kind) {
    case AST_NUM: return fact_of_number(x);
    case AST_NAME: return fact_of_name(f, x->name);
    case AST_INDEX: return fact_of_member(f, x);
    case AST_NEG:
      r = f->facts[x->a];
      if (is_fixed(r)) r.is |= FALLS;
      return r;
    case AST_NOT: return f->facts[x->a];
    case AST_ADD: case AST_SUB: return fact_of_sum(x, f->facts[x->a], f->facts[x->b]);
    case AST_AND: case AST_OR: return both(f->facts[x->a], f->facts[x->b]);
    case AST_MUL: return fact_of_product(f, x);
    case AST_DIV: return fact_of_quotient(f, x);
    case AST_POW: return fact_of_power(f, x);
    case AST_LT: case AST_LE: case AST_GT: case AST_GE: case AST_EQ: case AST_NE:
      return compared(f, f->facts[x->a], f->facts[x->b]);
    case AST_CALL: return fact_of_call(f, x);
    case AST_SUM: case AST_PRODUCT: case AST_BIND: return fact_of_range(f, x);
    case AST_TUPLE: case AST_LIST: return fact_of_list(f, x);
    case AST_MEMBER: case AST_PRIME: case AST_UNIT: return no_place(f->facts[x->a]);
    case AST_AT: return (Fact){RUN, 0};
    case AST_STRING: return (Fact){0};
    case AST_ERROR: break;
  }
  f->even = 0;
  return (Fact){0};
}

/* Takes the names of constants, lets and indices. */
static void collect_names(Facts *f, const AstStmt *first, const Define *defines, uint32_t n) {
  Arena *a = f->ast->arena;
  for (const AstStmt *s = first; s; s = s->next) {
    AstId value = s->rhs;
    for (uint32_t k = 0; k < n && s->kind == STMT_CONST; k++)
      if (strcmp(defines[k].name, s->name) == 0) value = defines[k].expr;
    if (s->kind == STMT_CONST || s->kind == STMT_LET) vec_push(a, &f->named, ((Named){s->name, value, {0}}));
    if (s->kind == STMT_FOR) vec_push(a, &f->indices, s->name);
    collect_names(f, s->body, defines, n);
  }
}

static void collect_indices(Facts *f) {
  for (AstId id = 1; id < f->ast->exprs.n; id++) {
    const AstExpr *x = ast_expr(f->ast, id);
    int binds = x->kind == AST_SUM || x->kind == AST_PRODUCT || x->kind == AST_BIND, known = 0;
    for (uint32_t k = 0; k < f->indices.n; k++) known |= f->indices.at[k] == x->name;
    if (binds && !known) vec_push(f->ast->arena, &f->indices, x->name);
  }
}

/* Of all but starts, which are only stored, signs must be sure. */
static void check_signs(Facts *f, const AstStmt *s) {
  if (s->kind == STMT_START || s->kind == STMT_CONST || s->kind == STMT_LET) return;
  unsigned any = f->facts[s->lhs].is | f->facts[s->rhs].is;
  for (AstId a = s->args; a; a = ast_expr(f->ast, a)->next) any |= f->facts[a].is;
  if (any & UNSURE) f->even = 0;
}

/* Sizes of families, ranges of statements, signs. */
static void check_statements(Facts *f, const AstStmt *first) {
  for (const AstStmt *s = first; s; s = s->next) {
    for (AstId d = s->kind == STMT_NETWORK ? 0 : s->dims; d; d = ast_expr(f->ast, d)->next) {
      if (ast_expr(f->ast, d)->kind != AST_BIND) take_place(f, d);
      f->has_size |= is_fixed(f->facts[d]);
    }
    if (s->kind == STMT_FOR) take_place(f, s->lhs), take_place(f, s->rhs);
    check_signs(f, s);
    check_statements(f, s->body);
  }
}

/* Whether the text is even where the constant number `size` of f->named is the size. */
static int is_even(Facts *f, uint32_t size) {
  for (uint32_t k = 0; k < f->named.n; k++) f->named.at[k].fact = (Fact){k == size ? FIXED | PLACE : 0, 0};
  uint32_t turns = 0;
  for (int changed = 1; changed && turns++ <= f->named.n + 1;) { /* names may stand before their definitions */
    changed = f->has_size = 0;
    f->even = 1;
    for (AstId id = 1; id < f->ast->exprs.n; id++) f->facts[id] = fact_of(f, ast_expr(f->ast, id));
    for (uint32_t k = 0; k < f->named.n; k++) {
      Fact *old = &f->named.at[k].fact, now = f->facts[f->named.at[k].value];
      now.is |= old->is & (unsigned char)~(PLACE | SCALED);
      if (k == size || (now.is == old->is && now.reach == old->reach)) continue;
      *old = now;
      changed = 1;
    }
  }
  check_statements(f, f->ast->first);
  return f->even && f->has_size && turns <= f->named.n + 1;
}

FamilySize family_size(const Ast *ast, const Define *defines, uint32_t n, int64_t from) {
  Facts f = {.ast = ast, .facts = ARENA_ARRAY(ast->arena, Fact, ast->exprs.n + 1)};
  collect_names(&f, ast->first, defines, n);
  collect_indices(&f);
  for (uint32_t k = 0; k < f.named.n; k++) {
    const AstExpr *x = ast_expr(ast, f.named.at[k].value);
    if (x->kind != AST_NUM || !num_is_int(x->number) || !(num_value(x->number) >= (double)from)) continue;
    if (num_value(x->number) < 1e9 && is_even(&f, k))
      return (FamilySize){f.named.at[k].name, (int64_t)num_value(x->number)};
  }
  return (FamilySize){0};
}
