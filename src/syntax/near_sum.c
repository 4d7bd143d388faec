/* sum(j in near(i, r_cut), f): each pair of neighbours once.
 *
 * In: the nodes of near(...) and of f. Out: the sum over j in 1..i-1 of if(d2 < r_cut^2, f, 0), where d2 is the squared
 * distance, by the nearest image in a periodic box; a note of its parts, by which `lower` makes lists of neighbours.
 * Of a family of contacts, `j in near(i, r_cut)` becomes `j in 1..i-1`, and the note.
 * Must hold: whoever reads the sum needs no more than these nodes. */
#include "syntax/ast_build.h"

#define USE \
  "`sum(j in near(i, r_cut), ...)`, in a periodic box `near(i, r_cut, L)`, of other coordinates `near(i, r_cut, x, y)`"

static AstExpr *at(Ast *ast, AstId id) { return &ast->exprs.at[id]; }

static AstId error(Ast *ast, Span span, const char *what) {
  diag_error(ast->diags, span, "%s" HELP "write " USE, what);
  return ast_collect(ast, AST_ERROR, span, (AstList){0, 0});
}

/* Arguments of near(...). */
typedef struct {
  Span span;
  Ident i, j;
  AstId cut, box;          /* box 0: an open space */
  const AstPlace *of[3];   /* families of coordinates */
  uint32_t n, components;
} Request;

static const AstPlace *place_named(const Ast *ast, const AstExpr *x) {
  for (uint32_t k = 0; x->kind == AST_NAME && k < ast->places.n; k++)
    if (ast->places.at[k].name == x->name) return &ast->places.at[k];
  return NULL;
}

static void add_place(Request *r, const AstPlace *p) {
  if (r->n < 3) r->of[r->n] = p;
  r->n++;
  r->components += p->components ? p->components : 1;
}

/* The only family of vectors. */
static void add_usual_place(const Ast *ast, Request *r) {
  const AstPlace *only = NULL;
  uint32_t vectors = 0;
  for (uint32_t k = 0; k < ast->places.n; k++)
    if (ast->places.at[k].components) only = &ast->places.at[k], vectors++;
  if (vectors == 1) add_place(r, only);
}

/* Reads the arguments of near(...); a message, or NULL. */
static const char *read_request(Ast *ast, AstId call, Request *r) {
  const AstExpr *x = ast_expr(ast, call);
  AstId i = x->kind == AST_CALL && strcmp(x->name, "near") == 0 ? x->args : 0, cut = i ? ast_expr(ast, i)->next : 0;
  if (!i) return "a sum runs over a range, `i in 1..N`, or over neighbours";
  if (ast_expr(ast, i)->kind != AST_NAME || !cut) return "`near` takes the index of the sum around, and a distance";
  r->i = (Ident){ast_expr(ast, i)->name, ast_expr(ast, i)->span};
  r->cut = cut;
  for (AstId k = ast_expr(ast, cut)->next; k; k = ast_expr(ast, k)->next) {
    const AstPlace *p = place_named(ast, ast_expr(ast, k));
    if (!p && r->box) return "`near` takes one box, and names of families of coordinates that stand above";
    if (p) add_place(r, p);
    else r->box = k;
  }
  if (!r->n) add_usual_place(ast, r);
  if (!r->n) return "which coordinates are places? there is not one family of vectors above";
  return r->n > 3 || r->components > 3 ? "a place has at most three coordinates" : NULL;
}

static AstId member(Ast *ast, const Request *r, const AstPlace *p, Ident index, uint32_t c) {
  static const char *const letter[] = {"x", "y", "z"};
  AstId of = ast_name(ast, (Ident){p->name, r->span}), by = ast_name(ast, (Ident){index.name, r->span});
  AstId id = ast_index(ast, r->span, of, ast_list(by));
  return p->components ? ast_member(ast, r->span, id, (Ident){intern(ast->names, letter[c]), r->span}) : id;
}

/* Side c of the box: of `(a, b, c)` its own, else the only one. */
static AstId side_of(Ast *ast, const Request *r, uint32_t c) {
  AstId side = r->box;
  if (ast_expr(ast, side)->kind == AST_TUPLE)
    for (side = ast_expr(ast, side)->args; c && ast_expr(ast, side)->next; c--) side = ast_expr(ast, side)->next;
  return ast_copy(ast, side);
}

/* The square of a difference of coordinates, by the nearest image. */
static AstId square(Ast *ast, const Request *r, const AstPlace *p, uint32_t c, AstNear *near) {
  uint32_t n = near->n++;
  near->at_i[n] = member(ast, r, p, r->i, c);
  near->at_j[n] = member(ast, r, p, r->j, c);
  AstId d = ast_binary(ast, AST_SUB, r->span, r->span, near->at_i[n], near->at_j[n]);
  if (r->box) {
    near->box[n] = side_of(ast, r, n);
    AstList list = ast_list_add(ast, ast_list(d), near->box[n]);
    d = ast_call(ast, r->span, (Ident){intern(ast->names, "image"), r->span}, list);
  }
  return ast_binary(ast, AST_POW, r->span, r->span, d, ast_number(ast, r->span, num_int(2)));
}

static AstId distance(Ast *ast, const Request *r, AstNear *near) {
  AstId sum = 0;
  for (uint32_t k = 0; k < r->n; k++)
    for (uint32_t c = 0; c < (r->of[k]->components ? r->of[k]->components : 1); c++) {
      AstId one = square(ast, r, r->of[k], c, near);
      sum = sum ? ast_binary(ast, AST_ADD, r->span, r->span, sum, one) : one;
    }
  return sum;
}

/* The nodes first ... last, which nothing uses any more, become numbers. */
static void clear(Ast *ast, AstId first, AstId last) {
  for (AstId k = first; k <= last; k++)
    *at(ast, k) = (AstExpr){.kind = AST_NUM, .span = at(ast, k)->span, .first = k, .number = num_int(1)};
}

/* near(i, r_cut, ...) becomes i - 1, of which the 1 is returned. */
static AstId make_range(Ast *ast, AstId call) {
  AstId i = ast_expr(ast, call)->args;
  at(ast, i)->next = 0;
  clear(ast, i + 1, call - 1);
  AstExpr *x = at(ast, call);
  *x = (AstExpr){.kind = AST_SUB, .span = x->span, .op_span = x->span, .a = i, .b = i + 1, .first = i};
  return i + 1;
}

AstId ast_near(Ast *ast, Span span, Ident j, AstId call, AstId body, Span op) {
  Request r = {.span = ast_expr(ast, call)->span, .j = j};
  const char *wrong = read_request(ast, call, &r);
  if (wrong) return error(ast, r.span, wrong);
  AstNear near = {.span = r.span, .i = r.i.name};
  AstId d2 = distance(ast, &r, &near);
  near.cut = ast_copy(ast, r.cut);
  AstId cut2 = ast_binary(ast, AST_POW, r.span, r.span, near.cut, ast_number(ast, r.span, num_int(2)));
  near.test = ast_binary(ast, AST_LT, r.span, r.span, d2, cut2);
  AstList list = ast_list_add(ast, ast_list(near.test), ast_copy(ast, body));
  list = ast_list_add(ast, list, ast_number(ast, r.span, num_int(0)));
  AstId term = ast_call(ast, ast_expr(ast, body)->span, (Ident){intern(ast->names, "if"), r.span}, list);
  clear(ast, ast_expr(ast, body)->first, body);
  AstId from = make_range(ast, call);
  near.sum = ast_reduce(ast, AST_SUM, span, op, (AstTurns){j, from, call}, term);
  vec_push(ast->arena, &ast->nears, near);
  return near.sum;
}

AstId ast_near_bind(Ast *ast, Span span, Ident j, AstId call) {
  Request r = {.span = ast_expr(ast, call)->span, .j = j};
  const char *wrong = read_request(ast, call, &r);
  if (wrong) return error(ast, r.span, wrong);
  AstNear near = {.span = r.span, .i = r.i.name};
  distance(ast, &r, &near);
  near.cut = ast_copy(ast, r.cut);
  AstId from = make_range(ast, call);
  near.sum = ast_bind(ast, span, j, from, call);
  vec_push(ast->arena, &ast->nears, near);
  return near.sum;
}
