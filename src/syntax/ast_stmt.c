/* Statements: each builder makes one; a list of declarations becomes one statement each.
 *
 * In: the parts of a statement, in the order of its text. Out: an AstStmt that says what was written.
 * Must hold: type is vec2, vec3, rotation or NULL; `t` and `pi` are never declared silently. */
#include "syntax/ast_build.h"

#include "base/words.h"

StmtList stmts_one(AstStmt *s) { return (StmtList){s, s}; }

StmtList stmts_join(StmtList a, StmtList b) {
  if (!a.first) return b;
  if (!b.first) return a;
  a.last->next = b.first;
  return (StmtList){a.first, b.last};
}

StmtList stmts_add(StmtList list, AstStmt *s) { return stmts_join(list, stmts_one(s)); }

AstStmt *stmt_plain(Ast *ast, AstStmtKind kind, Span span) {
  AstStmt *s = ARENA_NEW(ast->arena, AstStmt);
  s->kind = kind;
  s->span = s->name_span = span;
  return s;
}

AstStmt *stmt_name(Ast *ast, AstStmtKind kind, Span span, Ident name) {
  AstStmt *s = stmt_plain(ast, kind, span);
  s->name = name.name;
  if (name.name) s->name_span = name.span;
  return s;
}

StmtList stmts_each(Ast *ast, AstId first, AstId last, StmtList list) {
  for (AstId id = last; last && id >= ast_expr(ast, first)->first; id--) {
    AstExpr *e = &ast->exprs.at[id];
    if (e->kind != AST_BIND) continue;
    AstStmt *each = stmt_name(ast, STMT_FOR, list.first->span, (Ident){e->name, e->op_span});
    each->lhs = e->a;
    each->rhs = e->b;
    each->body = list.first;
    each->last = list.last;
    each->alone = 1;
    e->kind = AST_NAME;
    e->span = e->op_span;
    e->a = e->b = 0;
    list = stmts_one(each);
  }
  return list;
}

StmtList stmts_set_kind(Ast *ast, StmtList list, AstStmtKind kind, int exactly) {
  StmtList all = {0};
  for (AstStmt *s = list.first, *next; s; s = next) {
    next = s->next;
    s->next = NULL;
    s->kind = kind;
    s->exactly = exactly;
    all = stmts_join(all, kind == STMT_FLOW ? stmts_each(ast, s->lhs, s->lhs, stmts_one(s)) : stmts_one(s));
  }
  return all;
}

/* A statement that declares a name. */
static AstStmt *declare(Ast *ast, AstStmtKind kind, Span span, Ident name) {
  check_declared(ast, name);
  return stmt_name(ast, kind, span, name);
}

AstStmt *stmt_include(Ast *ast, Span span, AstText path) {
  AstStmt *s = stmt_plain(ast, STMT_INCLUDE, span);
  s->doc = path.text;
  s->name_span = path.span;
  return s;
}

AstStmt *stmt_titled(Ast *ast, AstStmtKind kind, Span span, Ident name, AstText doc, StmtList body) {
  AstStmt *s = stmt_name(ast, kind, span, name);
  s->doc = doc.text;
  s->body = body.first;
  s->last = body.last;
  return s;
}

static void check_type(Ast *ast, Ident type) {
  static const Name known[] = {"vec2", "vec3", "rotation"};
  for (size_t i = 0; i < 3; i++)
    if (strcmp(type.name, known[i]) == 0) return;
  Name near = suggest(type.name, known, 3);
  diag_error(ast->diags, type.span, "unknown type `%s`", type.name);
  if (near) diag_help(ast->diags, "did you mean `%s`?", near);
  else diag_help(ast->diags, "the types are `vec2`, `vec3` and, of coordinates, `rotation`; a number has none");
}

AstStmt *stmt_coord(Ast *ast, AstStmtKind kind, Span span, AstDeclared of, int periodic) {
  AstStmt *s = declare(ast, kind, span, of.name);
  Name type = of.type.name;
  if (type) check_type(ast, of.type);
  s->dims = of.dims.first;
  s->type = type;
  s->unit = of.unit;
  s->periodic = periodic;
  int rotates = type && strcmp(type, "rotation") == 0, one = of.dims.first && of.dims.first == of.dims.last;
  AstPlace place = {of.name.name, !type ? 0 : strcmp(type, "vec2") == 0 ? 2 : 3};
  if (kind == STMT_COORD && one && !rotates) vec_push(ast->arena, &ast->places, place);
  return s;
}

/* Index k of a momentum's family. */
static Ident index_of(Ast *ast, Span span, int k) { return (Ident){intern(ast->names, k ? "_j" : "_i"), span}; }

/* A name, or its member [_i], [_i,_j]. */
static AstId member_of(Ast *ast, Ident name, int n) {
  AstId id = ast_name(ast, name);
  AstList at = {0};
  for (int k = 0; k < n; k++) {
    AstId one = ast_name(ast, index_of(ast, name.span, k));
    at = k ? ast_list_add(ast, at, one) : ast_list(one);
  }
  return n ? ast_index(ast, name.span, id, at) : id;
}

/* p*q', dot(p, q') of vectors, summed over the members of a family with n sizes. */
static AstId action_term(Ast *ast, Span span, const Ident of[2], AstId size, int n, int is_vector) {
  Ident dot = {intern(ast->names, "dot"), span};
  AstTurns over[2];
  for (int k = 0; k < n; k++, size = ast_expr(ast, size)->next) { /* as in a text: nodes follow one another */
    AstId lo = ast_number(ast, span, num_int(1));
    over[k] = (AstTurns){index_of(ast, span, k), lo, ast_copy(ast, size)};
  }
  AstId momentum = member_of(ast, of[0], n), coord = member_of(ast, of[1], n),
        rate = ast_prime(ast, of[1].span, of[1].span, coord), term;
  if (is_vector) term = ast_call(ast, span, dot, ast_list_add(ast, ast_list(momentum), rate));
  else term = ast_binary(ast, AST_MUL, span, span, momentum, rate);
  while (n-- > 0) term = ast_reduce(ast, AST_SUM, span, span, over[n], term);
  return term;
}

AstStmt *stmt_momentum(Ast *ast, Span span, Ident name, AstList dims, Ident type, Ident coord, AstUnit unit) {
  AstStmt *s = stmt_coord(ast, STMT_MOMENTUM, span, (AstDeclared){name, type, dims, unit}, 0);
  const Ident pair[] = {name, coord},
              own = {intern(ast->names, arena_printf(ast->arena, "p_%s", coord.name)), coord.span};
  int n = !dims.first ? 0 : dims.first == dims.last ? 1 : 2; /* a third index is reported elsewhere */
  s->args = action_term(ast, span, pair, dims.first, n, type.name != NULL);
  s->lhs = ast_name(ast, coord);
  s->rhs = member_of(ast, own, n);
  return s;
}

AstStmt *stmt_hamiltonian(Ast *ast, Span span, AstId rhs) {
  AstStmt *s = stmt_value(ast, STMT_HAMILTONIAN, span, rhs);
  span.end = span.begin + (uint32_t)strlen("hamiltonian");
  s->lhs = ast_name(ast, (Ident){intern(ast->names, "energy"), span});
  return s;
}

AstStmt *stmt_define(Ast *ast, AstStmtKind kind, Span span, Ident name, AstList dims, AstUnit unit, AstId rhs) {
  AstStmt *s = declare(ast, kind, span, name);
  s->dims = dims.first;
  s->unit = unit;
  s->rhs = rhs;
  return s;
}

/* `param k = 1 [N/m]`: the name without a unit of its own takes the value's. */
AstStmt *stmt_valued(Ast *ast, AstStmtKind kind, Span span, Ident name, AstUnit unit, AstId value) {
  if (!unit.n && ast_expr(ast, value)->kind == AST_UNIT) unit = ast_expr(ast, value)->unit;
  return stmt_define(ast, kind, span, name, (AstList){0, 0}, unit, value);
}

AstStmt *stmt_param(Ast *ast, Span span, AstDeclared of, AstId value, AstSign sign) {
  AstStmt *s = stmt_valued(ast, STMT_PARAM, span, of.name, of.unit, value);
  if (of.type.name) check_type(ast, of.type);
  s->dims = of.dims.first;
  s->type = of.type.name;
  s->sign = sign;
  return s;
}

AstStmt *stmt_function(Ast *ast, Span span, Ident name, AstList args, AstId rhs) {
  AstStmt *s = declare(ast, STMT_FUNCTION, span, name);
  s->args = args.first;
  s->rhs = rhs;
  return s;
}

AstStmt *stmt_value(Ast *ast, AstStmtKind kind, Span span, AstId rhs) {
  AstStmt *s = stmt_plain(ast, kind, span);
  s->rhs = rhs;
  return s;
}

AstStmt *stmt_pair(Ast *ast, AstStmtKind kind, Span span, AstId lhs, AstId rhs) {
  AstStmt *s = stmt_value(ast, kind, span, rhs);
  s->lhs = lhs;
  return s;
}

AstStmt *stmt_equation(Ast *ast, AstStmtKind kind, Span span, Ident name, AstList dims, AstId lhs, AstId rhs,
                       AstId args) {
  AstStmt *s = stmt_name(ast, kind, span, name);
  s->dims = dims.first;
  s->lhs = lhs;
  s->rhs = rhs;
  s->args = args;
  return s;
}

/* Whether the options are those of a guide on a surface: friction, and a slip of two components. */
static int slips_on_surface(const Ast *ast, const AstStmt *s) {
  AstId v = ast_option_value(ast, s, "slip");
  AstId first = v && ast_expr(ast, v)->kind == AST_TUPLE ? ast_expr(ast, v)->args : 0;
  AstId second = first ? ast_expr(ast, first)->next : 0;
  return second && !ast_expr(ast, second)->next && ast_option_value(ast, s, "friction") &&
         !ast_option_value(ast, s, "law") && !ast_option_value(ast, s, "tangential");
}

AstId ast_sides(Ast *ast, Span span, Span op, AstId lhs, AstId rhs) {
  ast_number(ast, span, num_int(0));
  return ast_unary(ast, AST_NEG, span, op, ast_binary(ast, AST_SUB, span, op, lhs, rhs));
}

StmtList stmts_guide(Ast *ast, Span span, Ident name, AstList dims, AstId sides, AstList rubbing) {
  AstId gap = ast_expr(ast, sides)->a, none = gap - 1;
  AstStmt *s =
      stmt_equation(ast, STMT_GUIDE, span, name, dims, ast_expr(ast, gap)->a, ast_expr(ast, gap)->b, rubbing.first);
  if (!slips_on_surface(ast, s)) return stmts_one(s);
  Ident back = {intern(ast->names, arena_printf(ast->arena, "%s.back", name.name)), name.span};
  AstStmt *front = stmt_equation(ast, STMT_CONTACT, span, name, dims, gap, none, rubbing.first);
  return stmts_add(stmts_one(front), stmt_equation(ast, STMT_CONTACT, span, back, dims, sides, none, rubbing.first));
}

static int has_multiplier(const Ast *ast, AstId root) {
  for (AstId i = ast_expr(ast, root)->first; i <= root; i++)
    if (ast_expr(ast, i)->kind == AST_CALL && strcmp(ast_expr(ast, i)->name, "lambda") == 0) return 1;
  return 0;
}

/* The friction that follows the force of a constraint, and its value lambda(NAME.slip), whose nodes stand before those
 * of options, as an expression holds all nodes between its first and itself. */
static StmtList guide_friction(Ast *ast, Span span, Ident name, AstList dims, AstId place, AstId f, AstId most) {
  AstId rate = ast_prime(ast, span, span, place), of = ast_name(ast, name);
  if (dims.first) of = ast_index(ast, span, of, dims);
  AstId slip = ast_member(ast, span, of, (Ident){intern(ast->names, "slip"), span}),
        value = ast_call(ast, span, (Ident){intern(ast->names, "lambda"), span}, ast_list(slip));
  AstStmt *shown = stmt_define(ast, STMT_OBSERVE, span, name, dims, (AstUnit){0}, value);
  AstId size = ast_option(ast, span, "friction", f);
  AstList options = ast_list_add(ast, ast_list(size), ast_option(ast, span, "slip", rate));
  if (most) options = ast_list_add(ast, options, ast_option(ast, span, "static", most));
  return stmts_add(stmts_one(stmt_equation(ast, STMT_GUIDE, span, name, dims, 0, 0, options.first)), shown);
}

StmtList stmts_friction(Ast *ast, Span span, Ident name, AstList dims, AstId place, AstId f, AstId most) {
  if (has_multiplier(ast, f)) return guide_friction(ast, span, name, dims, place, f, most);
  AstId rate = ast_prime(ast, span, span, place),
        side = ast_call(ast, span, (Ident){intern(ast->names, "sign"), span}, ast_list(rate));
  AstId product = ast_binary(ast, AST_MUL, span, span, f, side), value = ast_unary(ast, AST_NEG, span, span, product);
  AstStmt *force = stmt_pair(ast, STMT_FORCE, span, place, value);
  AstStmt *shown = stmt_define(ast, STMT_OBSERVE, span, name, dims, (AstUnit){0}, value);
  AstList grip = ast_list_add(ast, ast_list(ast_prime(ast, span, span, place)), f);
  force->args = (most ? ast_list_add(ast, grip, most) : grip).first;
  return stmts_add(stmts_one(force), shown);
}

AstStmt *stmt_maps(Ast *ast, AstStmtKind kind, Span span, Ident name, AstList args, AstText doc, StmtList maps) {
  AstStmt *s = stmt_titled(ast, kind, span, name, doc, maps);
  s->args = args.first;
  return s;
}

StmtList maps_add(StmtList maps, AstStmt *item) {
  AstStmt *each = maps.last;
  while (each && each->kind == STMT_FOR && each->last->kind == STMT_FOR && !each->last->alone) each = each->last;
  if (item->kind != STMT_MAP || !each || each->kind != STMT_FOR || each->alone) return stmts_add(maps, item);
  StmtList body = stmts_add((StmtList){each->body, each->last}, item);
  each->last = body.last;
  return maps;
}

AstStmt *stmt_event(Ast *ast, Span span, Ident name, AstList dims, AstId when, AstDirection way, StmtList body) {
  AstStmt *s = stmt_equation(ast, STMT_EVENT, span, name, dims, when, 0, 0);
  s->direction = way;
  s->body = body.first;
  s->last = body.last;
  return s;
}

AstStmt *stmt_for(Ast *ast, Span span, Ident index, AstId lo, AstId hi, StmtList body) {
  AstStmt *s = declare(ast, STMT_FOR, span, index);
  s->lhs = lo;
  s->rhs = hi;
  s->body = body.first;
  s->last = body.last;
  return s;
}

Ident ident_dashed(Ast *ast, Span span, Ident a, Ident b) {
  const char *text = arena_printf(ast->arena, "%s-%s", a.name, b.name);
  return (Ident){intern(ast->names, text), span};
}

AstSign sign_of(Ast *ast, Span span, AstSign sign, Num number) {
  if (num_is_zero(number)) return sign;
  diag_error(ast->diags, span, "only a sign can be declared here: `> 0`, `>= 0`, `< 0` or `<= 0`");
  return SIGN_ANY;
}
