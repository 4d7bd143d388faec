/* Families that the text of a sum reads, at indices affine in i and j, through lets by index, too. */
#include "model/quantified_sum.h"

#include <stdlib.h>
#include <string.h>

enum { MOST_DEPTH = 24 };

/* --- indices --- */

/* Names of indices, of the sums or of a let, and what they are in i and j. */
typedef struct {
  Name name[2];
  Affine is[2];
  int64_t lo, hi; /* of i */
  int in_sum;     /* the text is the sum's own: it may name indices of what the sum stands in */
} Indices;

static int has(Name name, Name other) { return name && name == other; }

/* Value of a plain whole number: an index around the sum, or a constant. */
static int plain_whole(Eval *ev, Name name, int in_sum, int64_t *out) {
  const Builder *b = ev->b;
  int ambiguous;
  for (uint32_t k = in_sum ? ev->index.n : 0; k-- > 0;)
    if (ev->index.at[k].name == name) {
      *out = ev->index.at[k].at;
      return 1;
    }
  for (uint32_t k = in_sum && ev->in_statement ? b->index.n : 0; k-- > 0;)
    if (b->index.at[k].name == name) {
      *out = b->index.at[k].at;
      return 1;
    }
  const Entity *e = scope_find(&b->scope, name, ev->effect, &ambiguous);
  if (!e || e->kind != ENT_CONST || e->ndims || ambiguous) return 0;
  Expr v = b->constant_values.at[e->index].e;
  Num n = v && expr_is_num(b->g, v) ? expr_number(b->g, v) : num_ratio(1, 2);
  *out = n.num;
  return num_is_exact(n) && n.den == 1;
}

static int affine_product(AstKind kind, Affine x, Affine y, Affine *out) {
  int plain_x = !x.by_i && !x.by_j, plain_y = !y.by_i && !y.by_j;
  if (kind == AST_DIV) {
    if (!plain_x || !plain_y || !y.first || x.first % y.first) return 0;
    *out = (Affine){x.first / y.first, 0, 0};
    return 1;
  }
  if (!plain_x && !plain_y) return 0;
  Affine of = plain_x ? y : x;
  int64_t by = plain_x ? x.first : y.first;
  *out = (Affine){of.first * by, of.by_i * by, of.by_j * by};
  return 1;
}

static AstId taken_branch(Eval *ev, AstId id, const Indices *of, int depth);
static int is_affine(Eval *ev, AstId id, const Indices *of, int depth, Affine *out);

static int64_t floored(int64_t x, int64_t by) { return (x - (x % by + by) % by) / by; }

/* Whether it is mod(x, m) of an x affine in i that passes few multiples of m, as in a ring; it is *rest from of->lo up
 * to *last. */
static int is_turn(Eval *ev, AstId id, const Indices *of, int depth, Affine *rest, int64_t *last) {
  enum { LARGEST = 1 << 30 };
  const AstExpr *call = ast_expr(ev->b->ast, id);
  AstId second = call->kind == AST_CALL && call->args ? ast_expr(ev->b->ast, call->args)->next : 0;
  Affine x, m;
  if (!second || strcmp(call->name, "mod") != 0 || !is_affine(ev, call->args, of, depth, &x) ||
      !is_affine(ev, second, of, depth, &m))
    return 0;
  if (x.by_j || m.by_i || m.by_j || m.first <= 0 || llabs(x.first) > LARGEST || llabs(x.by_i) > LARGEST) return 0;
  int64_t below = floored(x.first + x.by_i * of->lo, m.first) * m.first;
  *rest = (Affine){x.first - below, x.by_i, 0};
  *last = x.by_i > 0   ? floored(m.first - 1 - rest->first, x.by_i)
          : x.by_i < 0 ? floored(rest->first, -x.by_i)
                       : of->hi;
  return llabs(x.by_i) * (of->hi - of->lo) <= m.first;
}

/* Whether the expression is affine in the indices. */
static int is_affine(Eval *ev, AstId id, const Indices *of, int depth, Affine *out) {
  const AstExpr *x = ast_expr(ev->b->ast, id);
  Affine a, b;
  *out = (Affine){0};
  if (depth == 0) return 0;
  switch (x->kind) {
    case AST_NUM: out->first = x->number.num; return num_is_exact(x->number) && x->number.den == 1;
    case AST_NAME:
      for (int k = 0; k < 2; k++)
        if (has(of->name[k], x->name)) {
          *out = of->is[k];
          return 1;
        }
      return plain_whole(ev, x->name, of->in_sum, &out->first);
    case AST_NEG:
      if (!is_affine(ev, x->a, of, depth - 1, &a)) return 0;
      *out = (Affine){-a.first, -a.by_i, -a.by_j};
      return 1;
    case AST_ADD: case AST_SUB: {
      if (!is_affine(ev, x->a, of, depth - 1, &a) || !is_affine(ev, x->b, of, depth - 1, &b)) return 0;
      int64_t s = x->kind == AST_ADD ? 1 : -1;
      *out = (Affine){a.first + s * b.first, a.by_i + s * b.by_i, a.by_j + s * b.by_j};
      return 1;
    }
    case AST_MUL: case AST_DIV:
      return is_affine(ev, x->a, of, depth - 1, &a) && is_affine(ev, x->b, of, depth - 1, &b) &&
             affine_product(x->kind, a, b, out);
    case AST_CALL: {
      AstId taken = taken_branch(ev, id, of, depth - 1);
      int64_t last;
      if (is_turn(ev, id, of, depth - 1, out, &last)) return last >= of->hi;
      return taken && is_affine(ev, taken, of, depth - 1, out);
    }
    default: return 0;
  }
}

/* --- conditions on the index --- */

static int is_comparison(AstKind kind) {
  return kind == AST_LT || kind == AST_LE || kind == AST_GT || kind == AST_GE || kind == AST_EQ || kind == AST_NE;
}

/* Whether both sides are affine in i alone; *d: left less right. */
static int compares_index(Eval *ev, const AstExpr *x, const Indices *of, int depth, Affine *d) {
  enum { LARGEST = 1 << 30 };
  Affine a, b;
  if (!is_comparison(x->kind) || !is_affine(ev, x->a, of, depth, &a) || !is_affine(ev, x->b, of, depth, &b)) return 0;
  *d = (Affine){a.first - b.first, a.by_i - b.by_i, a.by_j - b.by_j};
  return !d->by_j && llabs(d->first) < LARGEST && llabs(d->by_i) < LARGEST;
}

static int holds(AstKind kind, int64_t d) {
  return kind == AST_LT ? d < 0 : kind == AST_LE ? d <= 0 : kind == AST_GT ? d > 0 : kind == AST_GE ? d >= 0
         : kind == AST_EQ ? d == 0 : d != 0;
}

/* Whether the condition, comparisons of i with numbers and what joins them, holds for i = at; -1: it is none. */
static int truth_at(Eval *ev, AstId id, const Indices *of, int depth, int64_t at) {
  const AstExpr *x = ast_expr(ev->b->ast, id);
  Affine d;
  if (depth <= 0) return -1;
  if (compares_index(ev, x, of, depth - 1, &d)) return holds(x->kind, d.first + d.by_i * at);
  if (x->kind != AST_NOT && x->kind != AST_AND && x->kind != AST_OR) return -1;
  int l = truth_at(ev, x->a, of, depth - 1, at), r = x->kind == AST_NOT ? 0 : truth_at(ev, x->b, of, depth - 1, at);
  if (l < 0 || r < 0) return -1;
  return x->kind == AST_NOT ? !l : x->kind == AST_AND ? l && r : l || r;
}

/* The last index from lo on for which the comparisons in `id` hold, or do not hold, as for lo. */
static int64_t same_from(Eval *ev, AstId id, const Indices *of, int depth, int64_t lo, int64_t hi) {
  const Ast *ast = ev->b->ast;
  for (AstId k = ast_expr(ast, id)->first; k <= id; k++) {
    const AstExpr *x = ast_expr(ast, k);
    Affine d;
    if (!compares_index(ev, x, of, depth, &d) || !d.by_i) continue;
    for (int64_t root = -d.first / d.by_i, i = root - 1; i <= root + 1; i++)
      if (i >= lo && i < hi && holds(x->kind, d.first + d.by_i * i) != holds(x->kind, d.first + d.by_i * (i + 1)))
        hi = i;
  }
  return hi;
}

/* The second and the third argument of an `if`; 0: it is none. */
static int is_choice(const Ast *ast, AstId id, AstId *yes, AstId *no) {
  const AstExpr *x = ast_expr(ast, id);
  if (x->kind != AST_CALL || strcmp(x->name, "if") != 0 || !x->args) return 0;
  *yes = ast_expr(ast, x->args)->next;
  *no = *yes ? ast_expr(ast, *yes)->next : 0;
  return *no && !ast_expr(ast, *no)->next;
}

/* The branch of an `if` that is taken for all i; 0: it is no `if`, or takes several. */
static AstId taken_branch(Eval *ev, AstId id, const Indices *of, int depth) {
  AstId yes, no;
  if (!is_choice(ev->b->ast, id, &yes, &no)) return 0;
  AstId condition = ast_expr(ev->b->ast, id)->args;
  int is = truth_at(ev, condition, of, depth, of->lo);
  if (is < 0 || same_from(ev, condition, of, depth, of->lo, of->hi) < of->hi) return 0;
  return is ? yes : no;
}

/* In rows and turns: i = lo + row, j = from(lo) + turn. */
Subscript quantified_turns(const struct Quantified *q, Affine x) {
  int64_t j0 = q->from.first + q->from.by_i * q->lo;
  return (Subscript){x.first + x.by_i * q->lo + x.by_j * j0, x.by_i, x.by_j};
}

/* --- the text --- */

/* Records why there is no such form; 0. */
static int refused(struct Quantified *q, AstId where, const char *why) {
  if (!q->why) q->why = why, q->where = where;
  return 0;
}

/* The only statement that defines a family of lets; NULL: several do, or a `for` around it. */
static const AstStmt *only_definition(const Builder *b, const Entity *e) {
  const AstStmt *st = NULL;
  vec_each(const Definition, d, b->lets) {
    if (d->stmt->name != e->name || d->effect != e->effect) continue;
    if ((st && d->stmt != st) || d->naround) return NULL;
    st = d->stmt;
  }
  return st;
}

static int note_reads(Eval *ev, struct Quantified *q, AstId first, AstId last, const Indices *of,
                      unsigned char *skip, int depth);

/* Names of the indices of a let whose member is read at `at`, and what they are in i and j; 0: q->why. */
static int indices_of_let(const Ast *ast, const AstStmt *let, const Affine *at, Indices *of) {
  uint32_t n = 0;
  for (AstId k = let->dims; k; k = ast_expr(ast, k)->next, n++) {
    if (ast_expr(ast, k)->kind != AST_BIND || n == 2) return 0;
    of->name[n] = ast_expr(ast, k)->name;
    of->is[n] = at[n];
  }
  return 1;
}

/* Notes what the members of a family of lets read. */
static int note_let(Eval *ev, struct Quantified *q, AstId id, const Read *r, int depth) {
  const Ast *ast = ev->b->ast;
  const AstStmt *st = only_definition(ev->b, r->e);
  Indices of = {.lo = q->lo, .hi = q->hi};
  if (!st || depth == 0) return refused(q, id, "these lets depend on each other, or on several statements");
  if (!indices_of_let(ast, st, r->at, &of)) return refused(q, id, "these lets are defined one by one");
  q->has_lets = 1;
  return note_reads(ev, q, ast_expr(ast, st->rhs)->first, st->rhs, &of, NULL, depth - 1);
}

/* Notes what an index node reads. */
static int note_read(Eval *ev, struct Quantified *q, AstId id, const Indices *of, int depth) {
  const Ast *ast = ev->b->ast;
  const AstExpr *x = ast_expr(ast, id), *name = ast_expr(ast, x->a);
  int ambiguous;
  Read r = {0};
  uint32_t n = 0, moves = 0;
  for (AstId k = x->args; k; k = ast_expr(ast, k)->next, n++) {
    if (n == 2 || !is_affine(ev, k, of, MOST_DEPTH, &r.at[n]))
      return refused(q, k, "this index is not a sum of multiples of the indices and a number");
    moves |= r.at[n].by_i || r.at[n].by_j;
  }
  if (name->kind != AST_NAME) return refused(q, id, "this is a family of an effect");
  r.e = scope_find(&ev->b->scope, name->name, ev->effect, &ambiguous);
  if (!r.e || ambiguous || r.e->ndims != n) return refused(q, id, "this is no member of a family");
  for (uint32_t k = 0; k < n; k++) {
    Subscript at = quantified_turns(q, r.at[k]);
    int64_t least, most;
    if (!loop_extent(&q->range, &at, &least, &most) || least < r.e->lo[k] || most > r.e->hi[k])
      return refused(q, id, arena_printf(ev->b->arena, "this index reaches %lld, and the members are `%s[%lld..%lld]`",
                                         (long long)(least < r.e->lo[k] ? least : most), r.e->name,
                                         (long long)r.e->lo[k], (long long)r.e->hi[k]));
  }
  if (r.e->kind == ENT_LET) return moves ? note_let(ev, q, id, &r, depth) : 1;
  if (r.e->kind != ENT_COORD && r.e->kind != ENT_STATE && r.e->kind != ENT_PARAM && r.e->kind != ENT_INPUT)
    return moves ? refused(q, id, "this is no family of coordinates, states, parameters, inputs or lets") : 1;
  for (r.rate = 0; r.rate < (r.e->kind == ENT_COORD || r.e->kind == ENT_STATE ? 2 : 1); r.rate++)
    vec_push(ev->b->arena, &q->reads, r);
  return 1;
}

/* Marks the nodes of an expression. */
static void mark_nodes(const Eval *ev, AstId id, AstId first, unsigned char *inside) {
  for (AstId k = ast_expr(ev->b->ast, id)->first; k <= id; k++) inside[k - first] = 1;
}

/* Whether an index stands in the exponent of a power, where dimensions need a number. */
static int is_in_power(const Eval *ev, AstId at, AstId first, AstId last) {
  const Ast *ast = ev->b->ast;
  for (AstId k = first; k <= last; k++) {
    const AstExpr *x = ast_expr(ast, k);
    if (x->kind == AST_POW && at >= ast_expr(ast, x->b)->first && at <= x->b) return 1;
  }
  return 0;
}

/* Skips the condition of an `if` that takes one branch for all i, and the other branch. */
static void skip_branch(Eval *ev, AstId id, AstId first, const Indices *of, unsigned char *skip) {
  AstId taken = taken_branch(ev, id, of, MOST_DEPTH), yes, no;
  if (!taken || !is_choice(ev->b->ast, id, &yes, &no)) return;
  mark_nodes(ev, ast_expr(ev->b->ast, id)->args, first, skip);
  mark_nodes(ev, taken == yes ? no : yes, first, skip);
}

/* Notes what nodes first .. last read, but for those to skip (NULL: none yet); where the sums' own indices are numbers
 * of the terms, they are marked as such. */
static int note_reads(Eval *ev, struct Quantified *q, AstId first, AstId last, const Indices *of,
                      unsigned char *skip, int depth) {
  const Ast *ast = ev->b->ast;
  unsigned char *inside = ARENA_ARRAY(ev->b->arena, unsigned char, last - first + 1);
  int own = depth == MOST_DEPTH;
  if (!skip) skip = ARENA_ARRAY(ev->b->arena, unsigned char, last - first + 1);
  for (AstId k = last + 1; k-- > first;) {
    const AstExpr *x = ast_expr(ast, k);
    if (skip[k - first]) continue;
    skip_branch(ev, k, first, of, skip);
    for (AstId at = x->kind == AST_INDEX ? x->args : 0; at; at = ast_expr(ast, at)->next)
      mark_nodes(ev, at, first, inside);
    if (x->kind == AST_INDEX && !note_read(ev, q, k, of, depth)) return 0;
    if (x->kind == AST_CALL && strcmp(x->name, "d") == 0) return refused(q, k, "it has partial derivatives");
    if (!own && (x->kind == AST_SUM || x->kind == AST_PRODUCT))
      return refused(q, k, "lets with an index have sums inside");
    int index = x->kind == AST_NAME && (has(of->name[0], x->name) || has(of->name[1], x->name)) && !inside[k - first];
    if (!index) continue;
    if (!own) return refused(q, k, "a let has its index as a number");
    if (is_in_power(ev, k, first, last)) return refused(q, k, "an index stands in an exponent");
    q->counts[k - first] = 1;
  }
  return 1;
}

int quantified_names(const Ast *ast, AstId id, Name name) {
  for (AstId k = ast_expr(ast, id)->first; k <= id; k++)
    if (ast_expr(ast, k)->kind == AST_NAME && ast_expr(ast, k)->name == name) return 1;
  return 0;
}

/* The statement of the family of lets that the node reads at indices affine in i and j; NULL: it reads none. */
static const AstStmt *let_read(Eval *ev, AstId id, const Indices *of, Affine *at) {
  const Ast *ast = ev->b->ast;
  const AstExpr *x = ast_expr(ast, id);
  int ambiguous;
  uint32_t n = 0;
  if (x->kind != AST_INDEX || ast_expr(ast, x->a)->kind != AST_NAME) return NULL;
  for (AstId k = x->args; k; k = ast_expr(ast, k)->next, n++)
    if (n == 2 || !is_affine(ev, k, of, MOST_DEPTH, &at[n])) return NULL;
  const Entity *e = scope_find(&ev->b->scope, ast_expr(ast, x->a)->name, ev->effect, &ambiguous);
  return e && !ambiguous && e->kind == ENT_LET && e->ndims == n ? only_definition(ev->b, e) : NULL;
}

/* Lowers of->hi to the last index up to which each `if` of the text, through lets by index, takes the branch that it
 * takes for of->lo, and each `mod` of a ring takes away as much. 0: lets depend on each other. */
static int same_branches(Eval *ev, AstId id, Indices *of, int depth) {
  const Ast *ast = ev->b->ast;
  AstId first = ast_expr(ast, id)->first, yes, no;
  unsigned char *skip = ARENA_ARRAY(ev->b->arena, unsigned char, id - first + 1);
  for (AstId k = id + 1; k-- > first;) {
    Affine at[2];
    const AstStmt *let = skip[k - first] ? NULL : let_read(ev, k, of, at);
    Indices in = {.lo = of->lo, .hi = of->hi};
    if (let && indices_of_let(ast, let, at, &in) && (!depth || !same_branches(ev, let->rhs, &in, depth - 1))) return 0;
    of->hi = in.hi;
    int64_t last;
    if (!skip[k - first] && is_turn(ev, k, of, MOST_DEPTH, &at[0], &last) && last < of->hi) of->hi = last;
    if (skip[k - first] || !is_choice(ast, k, &yes, &no)) continue;
    AstId condition = ast_expr(ast, k)->args;
    int is = truth_at(ev, condition, of, MOST_DEPTH, of->lo);
    if (is < 0) continue;
    of->hi = same_from(ev, condition, of, MOST_DEPTH, of->lo, of->hi);
    mark_nodes(ev, is ? no : yes, first, skip);
  }
  return 1;
}

int64_t quantified_same_branches(Eval *ev, AstId id, int64_t lo, int64_t hi) {
  const Ast *ast = ev->b->ast;
  const AstExpr *x = ast_expr(ast, id);
  Indices own = {.name = {x->name}, .is = {{.by_i = 1}, {.by_j = 1}}, .lo = lo, .hi = hi, .in_sum = 1};
  for (AstId k = ast_expr(ast, x->c)->first; k <= x->c; k++)
    if (ast_expr(ast, k)->kind == AST_SUM) own.name[1] = ast_expr(ast, k)->name;
  for (int64_t before = hi + 1; own.hi < before;) {
    before = own.hi; /* in shorter ranges more indices are affine */
    if (!same_branches(ev, x->c, &own, MOST_DEPTH)) return hi;
  }
  return own.hi;
}

/* Marks the terms beside the one with the inner sum: they are written out, whatever they contain. */
static void mark_beside(const Eval *ev, const struct Quantified *q, unsigned char *beside) {
  const Ast *ast = ev->b->ast;
  AstId at = ast_expr(ast, q->outer)->c, first = ast_expr(ast, at)->first;
  while (ast_expr(ast, at)->kind == AST_ADD || ast_expr(ast, at)->kind == AST_SUB) {
    AstId a = ast_expr(ast, at)->a, b = ast_expr(ast, at)->b;
    int in_b = q->inner >= ast_expr(ast, b)->first && q->inner <= b;
    mark_nodes(ev, in_b ? a : b, first, beside);
    at = in_b ? b : a;
  }
}

int quantified_range(Eval *ev, struct Quantified *q, AstId from, AstId to) {
  const Indices outer = {.name = {q->i}, .is = {{.by_i = 1}}, .lo = q->lo, .hi = q->hi, .in_sum = 1};
  if (q->i == q->j || !is_affine(ev, from, &outer, MOST_DEPTH, &q->from) ||
      !is_affine(ev, to, &outer, MOST_DEPTH, &q->to))
    return refused(q, to, "the range inside is not affine in the outer index");
  q->range.skew = q->from.by_i;
  q->range.more = q->to.by_i - q->from.by_i;
  q->range.turns = q->to.first - q->from.first + q->range.more * q->lo + 1;
  return 1;
}

/* Finds the range of the inner sum. */
static int read_inner(Eval *ev, struct Quantified *q, unsigned char *skip) {
  const AstExpr *y = ast_expr(ev->b->ast, q->inner);
  q->j = y->name;
  if (!quantified_range(ev, q, y->a, y->b)) {
    q->where = q->inner;
    return 0;
  }
  mark_beside(ev, q, skip);
  mark_nodes(ev, y->a, q->first, skip);
  mark_nodes(ev, y->b, q->first, skip);
  return 1;
}

int quantified_reads(Eval *ev, struct Quantified *q, AstId id) {
  const Indices own = {.name = {q->i, q->j}, .is = {{.by_i = 1}, {.by_j = 1}}, .lo = q->lo, .hi = q->hi, .in_sum = 1};
  q->first = ast_expr(ev->b->ast, id)->first;
  q->counts = ARENA_ARRAY(ev->b->arena, unsigned char, id - q->first + 1);
  if (!note_reads(ev, q, q->first, id, &own, NULL, MOST_DEPTH)) return 0;
  for (AstId k = q->first; k <= id; k++)
    if (q->counts[k - q->first]) return refused(q, k, "an index is a number here, and not an index");
  return 1;
}

int quantified_text(Eval *ev, struct Quantified *q) {
  const Ast *ast = ev->b->ast;
  const AstExpr *x = ast_expr(ast, q->outer);
  AstId last = x->c;
  const int of_family = quantified_of_family(q);
  q->first = ast_expr(ast, last)->first;
  if (!of_family) q->i = x->name;
  q->range = (LoopRange){.rows = (uint32_t)(q->hi - q->lo + 1), .turns = 1};
  unsigned char *skip = ARENA_ARRAY(ev->b->arena, unsigned char, last - q->first + 1);
  q->counts = ARENA_ARRAY(ev->b->arena, unsigned char, last - q->first + 1);
  for (AstId k = q->first; k <= last; k++) {
    AstKind kind = ast_expr(ast, k)->kind;
    if (kind == AST_SUM && q->inner) return refused(q, k, "there are several sums inside");
    if (kind == AST_SUM) q->inner = k;
    if (kind == AST_PRODUCT) return refused(q, k, "there is a product over an index inside");
    if (kind == AST_AT || kind == AST_LIST || kind == AST_BIND || kind == AST_STRING) return 0;
  }
  if (of_family ? !quantified_range(ev, q, x->a, x->b) : q->inner && !read_inner(ev, q, skip)) return 0;
  const Indices own = {.name = {q->i, q->j}, .is = {{.by_i = 1}, {.by_j = 1}}, .lo = q->lo, .hi = q->hi, .in_sum = 1};
  return note_reads(ev, q, q->first, last, &own, skip, MOST_DEPTH);
}
