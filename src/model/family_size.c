/* The size of large families (family_size.h): which numbers of a text depend on it, and how. */
#include "model/family_size.h"

/* Facts about an expression. FIXED: its value depends on the size or on an index. PLACE: it says where a member stands,
 * or is a small number: a sum of few indices and ends, or of halves of them, and at most FAMILY_END to a side.
 * FALLS: it may be negative. UNSURE: far from the ends its sign may be another than near them. RUN: the compiler does
 * not know its value. MOVES: nor do the parameters determine it. MIXED: as UNSURE, of what is multiplied by values that
 * move. */
enum { FIXED = 1, PLACE = 2, FALLS = 4, UNSURE = 8, RUN = 16, MOVES = 32, MIXED = 64 };

enum { MOST_WEIGHT = 4 };

typedef struct {
  unsigned char is, reach, weight; /* of a PLACE: the sum of its small numbers; how many indices and ends */
} Fact;

typedef struct {
  Name name;
  AstId value; /* 0: the fact is given */
  unsigned char also;
  Fact fact;
} Named; /* a constant, a let, an index, a parameter or its setting, a coordinate, a function */

typedef struct {
  const Ast *ast;
  VEC(Named) named;
  Fact *facts;  /* by AstId */
  int even;     /* nothing was found against the text */
  int has_size; /* the size of some family, or the end of some range, depends on the constant */
} Facts;

/* Without what tells a place. */
static Fact no_place(unsigned is) { return (Fact){.is = (unsigned char)(is & ~(unsigned)PLACE)}; }

/* Of all that have the name, as where an index has that of a constant. */
static Fact fact_of_name(const Facts *f, Name name) {
  Fact r = {0};
  unsigned any = 0, all = PLACE, known = 0;
  for (uint32_t i = 0; i < f->named.n; i++) {
    const Fact x = f->named.at[i].fact;
    if (f->named.at[i].name != name) continue;
    any |= x.is, all &= x.is, known = 1;
    r.reach = x.reach > r.reach ? x.reach : r.reach;
    r.weight = x.weight > r.weight ? x.weight : r.weight;
  }
  if (!known) return (Fact){.is = strcmp(name, "pi") == 0 ? 0 : RUN};
  r.is = (unsigned char)any;
  return all ? r : no_place(r.is);
}

/* The fact about a value that two others determine smoothly. */
static Fact both(Fact x, Fact y) {
  const int reach = x.reach + y.reach, weight = x.weight + y.weight;
  if (!(x.is & y.is & PLACE) || reach > FAMILY_END || weight > MOST_WEIGHT) return no_place(x.is | y.is);
  return (Fact){x.is | y.is, (unsigned char)reach, (unsigned char)weight};
}

/* Whether it depends on the size or on an index, and is determined before a run. */
static int is_known(Fact x) { return (x.is & (FIXED | MOVES)) == FIXED; }

/* The same, where the sign is not that of all members. */
static Fact unsure(Fact x) {
  if (x.is & FIXED) x.is |= x.is & MOVES ? MIXED : UNSURE;
  x.is |= FALLS;
  return x;
}

static int is_fixed(Fact x) { return (x.is & (FIXED | RUN)) == FIXED; }

/* The number n if the expression is one of 2, 4, 8, 16: what is divided by it has the same remainder in all sizes. */
static int part_of_step(const Ast *ast, AstId id) {
  const AstExpr *x = ast_expr(ast, id);
  for (int n = 2; n <= FAMILY_STEP && x->kind == AST_NUM; n *= 2)
    if (num_equal(x->number, num_int(n))) return n;
  return 0;
}

/* Of numbers that are known, only places may be compared, and have the smaller or the remainder taken. */
static Fact compared(Facts *f, Fact x, Fact y) {
  Fact r = both(x, y);
  if (is_known(r) && !(r.is & PLACE)) f->even = 0;
  return r;
}

static Fact fact_of_sum(const AstExpr *x, Fact a, Fact b) {
  Fact r = both(a, b);
  if (x->kind == AST_SUB) r.is |= FALLS;
  return r.is & FALLS && !(r.is & PLACE) ? unsure(r) : r;
}

/* x times or over y: a place where y is 2. */
static Fact scaled(const Facts *f, AstId x, AstId y) {
  const Fact a = f->facts[x];
  if (part_of_step(f->ast, y) != 2 || !is_fixed(a) || !(a.is & PLACE)) return no_place(a.is | f->facts[y].is);
  return both(a, a);
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
    return (Fact){FIXED | PLACE | FALLS, 1, 1};
  int small = n->kind == AST_NUM && (num_equal(n->number, num_int(2)) || num_equal(n->number, num_int(3)));
  if (is_known(b) || (is_known(a) && !small)) f->even = 0;
  Fact r = no_place(a.is | b.is);
  if (small && num_equal(n->number, num_int(2))) r.is &= (unsigned char)~FALLS;
  return r;
}

static int is_one_of(const char *name, const char *const *of) {
  while (*of && strcmp(name, *of) != 0) of++;
  return *of != NULL;
}

static Fact fact_of_call(Facts *f, const AstExpr *x) {
  static const char *const waves[] = {"sin", "cos", NULL}, *const places[] = {"min", "max", "mod", NULL};
  const int is_if = strcmp(x->name, "if") == 0, wave = is_one_of(x->name, waves), place = is_one_of(x->name, places);
  Fact r = {.is = PLACE};
  for (AstId a = x->args; a; a = ast_expr(f->ast, a)->next) {
    if (is_fixed(f->facts[a]) && !is_if && !wave && !place) f->even = 0;
    r = place && a != x->args ? compared(f, r, f->facts[a]) : both(r, f->facts[a]);
  }
  AstId second = x->args ? ast_expr(f->ast, x->args)->next : 0;
  if (strcmp(x->name, "mod") == 0 && is_fixed(r) && !is_fixed(f->facts[second]) && !part_of_step(f->ast, second))
    f->even = 0;
  if (place || is_if) return r;
  if (function_index(x->name) < 0) r.is |= fact_of_name(f, x->name).is; /* the function may bring in the size */
  return unsure(no_place(r.is));
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

/* Whether the expressions between two read the name. */
static int is_read(const Ast *ast, AstId from, AstId to, Name name) {
  while (++from <= to)
    if (ast_expr(ast, from)->kind == AST_NAME && ast_expr(ast, from)->name == name) return 1;
  return 0;
}

static Fact fact_of_range(Facts *f, const AstExpr *x) {
  take_place(f, x->a);
  take_place(f, x->b);
  f->has_size |= is_fixed(f->facts[x->b]);
  if (x->kind == AST_BIND) return (Fact){0};
  Fact r = no_place(f->facts[x->c].is);
  if (!(r.is & MOVES) || !is_read(f->ast, x->b, x->c, x->name)) r.is |= FIXED; /* so often */
  return r;
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
  return (Fact){.is = PLACE, .reach = (unsigned char)(v + 0.5)};
}

static Fact fact_of(Facts *f, const AstExpr *x) {
  Fact r;
  switch (x->kind) {
    case AST_NUM: return fact_of_number(x);
    case AST_NAME: return fact_of_name(f, x->name);
    case AST_INDEX: return fact_of_member(f, x);
    case AST_NEG:
      r = f->facts[x->a];
      r.is |= FALLS;
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
    case AST_MEMBER: case AST_PRIME: case AST_UNIT: return no_place(f->facts[x->a].is);
    case AST_AT: return (Fact){.is = RUN | FIXED};
    case AST_STRING: return (Fact){0};
    case AST_ERROR: break;
  }
  f->even = 0;
  return (Fact){0};
}

static void name_it(Facts *f, Name name, AstId value, unsigned also) {
  vec_push(f->ast->arena, &f->named, ((Named){.name = name, .value = value, .also = (unsigned char)also}));
}

static void name_index(Facts *f, Name name) {
  name_it(f, name, 0, 0);
  f->named.at[f->named.n - 1].fact = (Fact){FIXED | PLACE, 0, 1};
}

/* Takes the names of statements, and those of the indices of `for`. */
static void collect_names(Facts *f, const AstStmt *first, const Define *defines, uint32_t n) {
  for (const AstStmt *s = first; s; s = s->next) {
    AstId value = s->rhs, set = s->lhs;
    for (uint32_t k = 0; k < n && s->kind == STMT_CONST; k++)
      if (strcmp(defines[k].name, s->name) == 0) value = defines[k].expr;
    switch (s->kind) {
      case STMT_CONST: case STMT_LET: case STMT_FUNCTION: name_it(f, s->name, value, 0); break;
      case STMT_PARAM: name_it(f, s->name, value, RUN); break;
      case STMT_SET:
        if (ast_expr(f->ast, set)->kind == AST_INDEX) set = ast_expr(f->ast, set)->a;
        if (ast_expr(f->ast, set)->kind == AST_NAME) name_it(f, ast_expr(f->ast, set)->name, value, RUN);
        break;
      case STMT_COORD: case STMT_STATE: case STMT_INPUT: name_it(f, s->name, 0, RUN | MOVES); break;
      case STMT_MOMENTUM: name_it(f, ast_expr(f->ast, s->rhs)->name, 0, RUN | MOVES); break;
      case STMT_FOR: name_index(f, s->name); break;
      default: break;
    }
    collect_names(f, s->body, defines, n);
  }
}

static void collect_indices(Facts *f) {
  for (AstId id = 1; id < f->ast->exprs.n; id++) {
    const AstExpr *x = ast_expr(f->ast, id);
    if (x->kind == AST_SUM || x->kind == AST_PRODUCT || x->kind == AST_BIND) name_index(f, x->name);
  }
}

/* Of all but starts, which are only stored, signs must be sure; of inertias and damping also those of each term. */
static void check_signs(Facts *f, const AstStmt *s) {
  if (s->kind == STMT_START || s->kind == STMT_CONST || s->kind == STMT_LET || s->kind == STMT_FUNCTION) return;
  const int terms = s->kind >= STMT_HAMILTONIAN && s->kind <= STMT_FLOW && s->kind != STMT_POTENTIAL;
  unsigned any = f->facts[s->lhs].is | f->facts[s->rhs].is;
  for (AstId a = s->args; a; a = ast_expr(f->ast, a)->next) any |= f->facts[a].is;
  if (any & UNSURE || (terms && any & MIXED)) f->even = 0;
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
  for (uint32_t k = 0; k < f->named.n; k++)
    if (f->named.at[k].value) f->named.at[k].fact = k == size ? (Fact){FIXED | PLACE, 0, 1} : (Fact){0};
    else f->named.at[k].fact.is |= f->named.at[k].also;
  uint32_t turns = 0;
  for (int changed = 1; changed && turns++ <= f->named.n + 1;) { /* names may stand before their definitions */
    changed = f->has_size = 0;
    f->even = 1;
    for (AstId id = 1; id < f->ast->exprs.n; id++) f->facts[id] = fact_of(f, ast_expr(f->ast, id));
    for (uint32_t k = 0; k < f->named.n; k++) {
      const Named *x = &f->named.at[k];
      Fact *old = &f->named.at[k].fact, now = f->facts[x->value];
      if (x->also) now = no_place(now.is | x->also);
      now.is |= old->is & (unsigned char)~PLACE;
      if (k == size || !x->value || memcmp(&now, old, sizeof now) == 0) continue;
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
