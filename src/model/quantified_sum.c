/* Sums over pairs, sum(i in a..b, ... sum(j in c..d, f) ...), as nodes (sym/sum_nest.h) that do not know how many pairs
 * there are.
 *
 * The text is evaluated at two representative pairs. Each family in f is read at indices affine in i and j, so that a
 * symbol of f is an element of a family for all pairs alike; what the second pair gives must be what the first gives
 * with its symbols in their places. What has no such form (velocities, if, abs, lets by index, i as a number) is
 * written out, pair by pair; terms beside the inner sum are, too. */
#include "model/resolve_impl.h"
#include "sym/diff.h"
#include "sym/sum_nest.h"

enum { MOST_DEPTH = 24, REPRESENTATIVES = 2, COMPONENTS = 3 };

/* Whole number that is affine in i and j. */
typedef struct {
  int64_t first, by_i, by_j;
} Affine;

/* Family e read at indices affine in i and j. */
typedef struct {
  const Entity *e;
  Affine at[2];
} Read;

struct Quantified {
  AstId outer, inner;
  Name i, j;
  int64_t lo, hi;     /* of i */
  Affine from, to;    /* of j, in i */
  LoopRange range;    /* row 0 is i = lo; turn j of row 0 is j - from */
  VEC(Read) reads;
  int64_t pair[REPRESENTATIVES][2]; /* i and j */
  int pass;
  Value body[REPRESENTATIVES], whole[REPRESENTATIVES];
  int beside;         /* the outer terms have more than the inner sum: they are written out, with `pairs` at the end */
  Expr pairs;
  SymId inside[COMPONENTS]; /* stand for the inner sum in the whole */
};

/* --- indices --- */

static int has(Name name, Name other) { return name && name == other; }

/* Value of a plain whole number: an index around the sum, or a constant. */
static int plain_whole(Eval *ev, Name name, int64_t *out) {
  const Builder *b = ev->b;
  int ambiguous;
  for (uint32_t k = ev->index.n; k-- > 0;)
    if (ev->index.at[k].name == name) {
      *out = ev->index.at[k].at;
      return 1;
    }
  for (uint32_t k = ev->in_statement ? b->index.n : 0; k-- > 0;)
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

/* Whether the expression is affine in the names i and j. */
static int is_affine(Eval *ev, AstId id, Name i, Name j, int depth, Affine *out) {
  const AstExpr *x = ast_expr(ev->b->ast, id);
  Affine a, b;
  *out = (Affine){0};
  if (depth == 0) return 0;
  switch (x->kind) {
    case AST_NUM: out->first = x->number.num; return num_is_exact(x->number) && x->number.den == 1;
    case AST_NAME:
      if (has(j, x->name)) out->by_j = 1;
      else if (has(i, x->name)) out->by_i = 1;
      if (out->by_i || out->by_j) return 1;
      return plain_whole(ev, x->name, &out->first);
    case AST_NEG:
      if (!is_affine(ev, x->a, i, j, depth - 1, &a)) return 0;
      *out = (Affine){-a.first, -a.by_i, -a.by_j};
      return 1;
    case AST_ADD: case AST_SUB: {
      if (!is_affine(ev, x->a, i, j, depth - 1, &a) || !is_affine(ev, x->b, i, j, depth - 1, &b)) return 0;
      int64_t s = x->kind == AST_ADD ? 1 : -1;
      *out = (Affine){a.first + s * b.first, a.by_i + s * b.by_i, a.by_j + s * b.by_j};
      return 1;
    }
    case AST_MUL: case AST_DIV:
      return is_affine(ev, x->a, i, j, depth - 1, &a) && is_affine(ev, x->b, i, j, depth - 1, &b) &&
             affine_product(x->kind, a, b, out);
    default: return 0;
  }
}

/* In rows and turns: i = lo + row, j = from(lo) + turn. */
static Subscript in_turns(const struct Quantified *q, Affine x) {
  int64_t j0 = q->from.first + q->from.by_i * q->lo;
  return (Subscript){x.first + x.by_i * q->lo + x.by_j * j0, x.by_i, x.by_j};
}

static int64_t at_pair(Affine x, const int64_t *pair) { return x.first + x.by_i * pair[0] + x.by_j * pair[1]; }

/* --- the text --- */

/* Marks the nodes of an expression that an index or a range has: there i and j are numbers. */
static void mark_index(const Eval *ev, AstId id, AstId first, unsigned char *inside) {
  for (AstId k = ast_expr(ev->b->ast, id)->first; k <= id; k++) inside[k - first] = 1;
}

/* Notes what an index node reads; 0: not affine, or no family of symbols. */
static int note_read(Eval *ev, struct Quantified *q, const AstExpr *x) {
  const Ast *ast = ev->b->ast;
  const AstExpr *of = ast_expr(ast, x->a);
  int ambiguous;
  Read r = {0};
  uint32_t n = 0, moves = 0;
  for (AstId k = x->args; k; k = ast_expr(ast, k)->next, n++) {
    if (n == 2 || !is_affine(ev, k, q->i, q->j, MOST_DEPTH, &r.at[n])) return 0;
    moves |= r.at[n].by_i || r.at[n].by_j;
  }
  if (of->kind != AST_NAME) return 0;
  r.e = scope_find(&ev->b->scope, of->name, ev->effect, &ambiguous);
  if (!r.e || ambiguous || r.e->ndims != n) return 0;
  if (r.e->kind != ENT_COORD && r.e->kind != ENT_STATE && r.e->kind != ENT_PARAM && r.e->kind != ENT_INPUT)
    return !moves;
  for (uint32_t k = 0; k < n; k++) {
    Subscript at = in_turns(q, r.at[k]);
    int64_t least, most;
    if (!loop_extent(&q->range, &at, &least, &most) || least < r.e->lo[k] || most > r.e->hi[k]) return 0;
  }
  vec_push(ev->b->arena, &q->reads, r);
  return 1;
}

/* Marks the terms beside the one with the inner sum: they are written out, whatever they contain. */
static void mark_beside(const Eval *ev, const struct Quantified *q, unsigned char *beside) {
  const Ast *ast = ev->b->ast;
  AstId at = ast_expr(ast, q->outer)->c, first = ast_expr(ast, at)->first;
  while (ast_expr(ast, at)->kind == AST_ADD || ast_expr(ast, at)->kind == AST_SUB) {
    AstId a = ast_expr(ast, at)->a, b = ast_expr(ast, at)->b;
    int in_b = q->inner >= ast_expr(ast, b)->first && q->inner <= b;
    mark_index(ev, in_b ? a : b, first, beside);
    at = in_b ? b : a;
  }
}

/* Finds the inner sum, and all that the terms read; 0: the text has no such form. */
static int read_text(Eval *ev, struct Quantified *q) {
  const Ast *ast = ev->b->ast;
  const AstExpr *x = ast_expr(ast, q->outer);
  AstId first = ast_expr(ast, x->c)->first, last = x->c;
  unsigned char *inside = ARENA_ARRAY(ev->b->arena, unsigned char, last - first + 1),
                *beside = ARENA_ARRAY(ev->b->arena, unsigned char, last - first + 1);
  for (AstId k = first; k <= last; k++) {
    AstKind kind = ast_expr(ast, k)->kind;
    if (kind == AST_SUM && q->inner) return 0;
    if (kind == AST_SUM) q->inner = k;
    if (kind == AST_PRODUCT || kind == AST_AT || kind == AST_LIST || kind == AST_BIND || kind == AST_STRING) return 0;
  }
  if (!q->inner) return 0;
  mark_beside(ev, q, beside);
  const AstExpr *y = ast_expr(ast, q->inner);
  q->i = x->name;
  q->j = y->name;
  if (q->i == q->j || !is_affine(ev, y->a, q->i, NULL, MOST_DEPTH, &q->from) ||
      !is_affine(ev, y->b, q->i, NULL, MOST_DEPTH, &q->to))
    return 0;
  mark_index(ev, y->a, first, inside);
  mark_index(ev, y->b, first, inside);
  q->range =
      (LoopRange){.rows = (uint32_t)(q->hi - q->lo + 1), .skew = q->from.by_i, .more = q->to.by_i - q->from.by_i};
  q->range.turns = q->to.first - q->from.first + q->range.more * q->lo + 1;
  for (AstId k = last + 1; k-- > first;) {
    const AstExpr *n = ast_expr(ast, k);
    if (beside[k - first]) continue;
    for (AstId at = n->kind == AST_INDEX ? n->args : 0; at; at = ast_expr(ast, at)->next)
      mark_index(ev, at, first, inside);
    if (n->kind == AST_INDEX && !note_read(ev, q, n)) return 0;
    if (n->kind == AST_CALL && strcmp(n->name, "d") == 0) return 0;
    if (n->kind == AST_NAME && (n->name == q->i || n->name == q->j) && !inside[k - first]) return 0;
  }
  return 1;
}

/* --- representatives --- */

/* Whether families read at different indices are read at different members for this pair. */
static int tells_apart(const struct Quantified *q, const int64_t *pair) {
  for (uint32_t x = 0; x < q->reads.n; x++)
    for (uint32_t y = 0; y < x; y++) {
      const Read *r = &q->reads.at[x], *s = &q->reads.at[y];
      int same_text = 1, same_member = r->e->index == s->e->index && r->e->kind == s->e->kind;
      for (uint32_t k = 0; k < r->e->ndims && same_member; k++) {
        same_text &= memcmp(&r->at[k], &s->at[k], sizeof r->at[k]) == 0;
        same_member &= at_pair(r->at[k], pair) == at_pair(s->at[k], pair);
      }
      if (same_member && !same_text) return 0;
    }
  return 1;
}

/* Two pairs of the last rows that differ in both indices. */
static int find_pairs(struct Quantified *q, Arena *arena) {
  enum { TRIED = 12 };
  VEC(int64_t) at = {0};
  int64_t rows = (int64_t)q->range.rows;
  for (int64_t row = rows - 1; row >= 0 && row + TRIED >= rows; row--) {
    int64_t i = q->lo + row, from = q->from.first + q->from.by_i * i, n = loop_turns(&q->range, row);
    for (int64_t k = 0; k < n && k < TRIED; k++) {
      int64_t pair[2] = {i, from + k};
      if (!tells_apart(q, pair)) continue;
      vec_push(arena, &at, pair[0]);
      vec_push(arena, &at, pair[1]);
    }
  }
  for (uint32_t x = 0; x < at.n; x += 2)
    for (uint32_t y = 0; y < x; y += 2) {
      if (at.at[x] == at.at[y] || at.at[x + 1] == at.at[y + 1]) continue;
      memcpy(q->pair[0], at.at + y, sizeof q->pair[0]);
      memcpy(q->pair[1], at.at + x, sizeof q->pair[1]);
      return 1;
    }
  return 0;
}

/* --- arguments --- */

typedef struct {
  ExprGraph *g;
  const Model *m;
  const struct Quantified *q;
  Arena *arena;
  Interner *names;
  VEC(Expr) args;
  VEC(NestRead) reads;
  VEC(Read) blocks; /* families whose members are arguments: all with one index */
  VEC(uint32_t) base;
  VEC(Expr) first, second; /* symbols of the two representatives in the same places */
} Arguments;

static SymId member_symbol(const Model *m, EntKind kind, uint32_t i) {
  return kind == ENT_COORD   ? m->coords.at[i].q
         : kind == ENT_STATE ? m->states.at[i].z
         : kind == ENT_PARAM ? m->params.at[i].sym
                             : m->inputs.at[i].sym;
}

/* Position of the first argument of a family, whose members become arguments once. */
static uint32_t block_of(Arguments *a, const Entity *e) {
  for (uint32_t k = 0; k < a->blocks.n; k++)
    if (a->blocks.at[k].e->kind == e->kind && a->blocks.at[k].e->index == e->index) return a->base.at[k];
  uint32_t base = a->args.n;
  vec_push(a->arena, &a->blocks, ((Read){.e = e}));
  vec_push(a->arena, &a->base, base);
  for (uint32_t k = 0; k < entity_size(e); k++)
    vec_push(a->arena, &a->args, expr_symbol(a->g, member_symbol(a->m, e->kind, e->index + k))->node);
  return base;
}

/* Element of the family's array as an affine function: (at[0] - lo[0])*size + at[1] - lo[1], times components. */
static Affine element_of(const Read *r) {
  Affine x = {0};
  for (uint32_t k = 0; k < r->e->ndims; k++) {
    int64_t size = r->e->hi[k] - r->e->lo[k] + 1;
    x = (Affine){x.first * size + r->at[k].first - r->e->lo[k], x.by_i * size + r->at[k].by_i,
                 x.by_j * size + r->at[k].by_j};
  }
  int64_t parts = r->e->parts ? r->e->parts : 1;
  return (Affine){x.first * parts, x.by_i * parts, x.by_j * parts};
}

static SymKind kind_of(EntKind kind) {
  return kind == ENT_COORD ? SYM_COORD : kind == ENT_STATE ? SYM_STATE : kind == ENT_PARAM ? SYM_PARAM : SYM_INPUT;
}

/* The read that gave the symbol for the first pair, and its component; NULL: none. */
static const Read *read_of(const struct Quantified *q, const Symbol *s, int64_t *part) {
  for (uint32_t k = 0; k < q->reads.n; k++) {
    const Read *r = &q->reads.at[k];
    *part = (int64_t)s->index - r->e->index - at_pair(element_of(r), q->pair[0]);
    if (kind_of(r->e->kind) == s->kind && *part >= 0 && *part < (r->e->parts ? r->e->parts : 1)) return r;
  }
  return NULL;
}

/* Symbols that hold one number for all pairs: of names without an index. */
static int is_plain(const Symbol *s) {
  return (s->kind == SYM_COORD || s->kind == SYM_STATE || s->kind == SYM_PARAM || s->kind == SYM_INPUT) &&
         !strchr(s->name, '[');
}

/* The parts of the name r[5].x around its indices, and these as functions of the turn. */
static void name_read(const Arguments *a, const Read *r, Name name, NestRead *to) {
  Interner *names = a->names;
  const char *open = strchr(name, '['), *close = strchr(name, ']');
  to->stem = intern(names, arena_strndup(a->arena, name, (size_t)(open - name)));
  to->tail = intern(names, close + 1);
  to->nindices = r->e->ndims;
  for (uint32_t k = 0; k < r->e->ndims; k++) to->index[k] = in_turns(a->q, r->at[k]);
}

/* Makes the symbol an argument; 0: it is none. */
static int add_symbol(Arguments *a, Expr node) {
  const Symbol *s = expr_sym_of(a->g, node);
  SymId id = expr_sym_id(a->g, node);
  int64_t part;
  if (s->kind == SYM_TIME || s->kind == SYM_CONST) return 1;
  const Read *r = read_of(a->q, s, &part);
  if (!r && !is_plain(s)) return 0;
  Subscript at = {.first = a->args.n};
  if (r) {
    Affine x = element_of(r);
    x.first += part + block_of(a, r->e);
    at = in_turns(a->q, x);
    uint32_t there = r->e->index + (uint32_t)(at_pair(element_of(r), a->q->pair[1]) + part);
    vec_push(a->arena, &a->first, node);
    vec_push(a->arena, &a->second, expr_symbol(a->g, member_symbol(a->m, r->e->kind, there))->node);
  } else {
    vec_push(a->arena, &a->args, node);
  }
  NestRead read = {.symbol = id, .at = at};
  if (r) name_read(a, r, s->name, &read);
  vec_push(a->arena, &a->reads, read);
  return 1;
}

static int is_smooth(ExprOp op) {
  return op != EX_SELECT && op != EX_ABS && op != EX_SIGN && op != EX_FLOOR && op != EX_MIN && op != EX_MAX &&
         op != EX_LT && op != EX_LE && op != EX_EQ && op != EX_ATAN2 && op != EX_TAN && op != EX_CELL;
}

/* The arguments of an expression in the symbols of the first pair; 0: it has others, or a choice. */
static int find_arguments(Arguments *a, Expr e) {
  ExprList l = expr_topo(a->g, &e, 1);
  for (uint32_t k = 0; k < l.n; k++) {
    if (!is_smooth(expr_op(a->g, l.at[k]))) return 0;
    if (expr_op(a->g, l.at[k]) == EX_SYM && !add_symbol(a, l.at[k])) return 0;
  }
  return 1;
}

/* Whether `second` is `first` with the symbols of the second pair in the places of the first's; members read by number
 * inside functions and lets are in neither place. */
static int same_for_both(const Arguments *a, Expr first, Expr second) {
  Expr back;
  ExprList l = expr_topo(a->g, &second, 1);
  for (uint32_t k = 0; k < l.n; k++) {
    uint32_t place = 0;
    if (expr_op(a->g, l.at[k]) != EX_SYM || !strchr(expr_sym_of(a->g, l.at[k])->name, '[')) continue;
    while (place < a->second.n && a->second.at[place] != l.at[k]) place++;
    if (place == a->second.n) return 0;
  }
  expr_replace_nodes(a->g, &second, 1, a->second.at, a->first.at, a->first.n, &back);
  return back == first;
}

/* --- the sum --- */

/* Sum of `body` over all turns of `range`, one cell. */
static Expr sum_over(const Arguments *a, LoopRange range, Expr body) {
  NestShare *share = ARENA_NEW(a->arena, NestShare);
  share->value = body;
  SumNest s = {.range = range, .reads = a->reads.at, .nreads = a->reads.n, .shares = share, .nshares = 1,
               .nargs = a->args.n, .i = a->q->i, .j = a->q->j, .i0 = a->q->lo,
               .j0 = a->q->from.first + a->q->from.by_i*a->q->lo, .row = a->q->pair[0][0] - a->q->lo,
               .turn = a->q->pair[0][1] - a->q->from.first - a->q->from.by_i*a->q->lo};
  return expr_sum_cell(a->g, &s, a->args.at, 0);
}

/* Component c of the sum over pairs: the factor of the inner sum, which must be linear in the whole, times the inner
 * terms. 0: it has no such form. */
static Expr component_sum(Eval *ev, struct Quantified *q, uint32_t c) {
  Builder *b = ev->b;
  ExprGraph *g = b->g;
  Arguments a = {.g = g, .m = b->m, .q = q, .arena = b->arena, .names = b->ast->names};
  const Value *body = q->body, *whole = q->whole;
  uint32_t n = component_count(&body[0]);
  if (n != component_count(&whole[0])) return 0; /* the vector inside became a number */
  Expr turned[REPRESENTATIVES];
  for (int k = 0; k < REPRESENTATIVES; k++) {
    Expr factor = expr_diff(g, whole[k].at[c], q->inside[c]);
    if (expr_contains_sym(g, factor, q->inside[c])) return 0;
    turned[k] = expr_mul(g, factor, body[k].at[c]);
    Expr zero = expr_int(g, 0), rest = expr_replace(g, whole[k].at[c], &q->inside[c], &zero, 1);
    q->beside |= !expr_is_zero(g, rest);
  }
  if ((q->beside && n > 1) || !find_arguments(&a, turned[0]) || !same_for_both(&a, turned[0], turned[1])) return 0;
  return expr_is_zero(g, turned[0]) ? turned[0] : sum_over(&a, q->range, turned[0]);
}

/* --- the loops --- */

int quantified_begin(Eval *ev, AstId id, int64_t lo, int64_t hi) {
  Builder *b = ev->b;
  const AstExpr *x = ast_expr(b->ast, id);
  if (ev->sums && id == ev->sums->inner && ev->sums->pairs) {
    *value_of(ev, id) = a_value(expr_int(b->g, 0), ev->sums->body[0].dim, 0);
    return -1;
  }
  if (ev->sums && id == ev->sums->inner) {
    int64_t j = ev->sums->pair[ev->sums->pass][1];
    vec_push(b->arena, &ev->loops, ((Loop){id, j, j, ev->terms.n}));
    vec_push(b->arena, &ev->index, ((IndexVar){x->name, j}));
    return 1;
  }
  if (x->kind != AST_SUM || ev->sums || ev->index.n || (ev->in_statement && b->index.n) || ev->function ||
      ev->written_out == id || !b->sums_from)
    return 0;
  struct Quantified *q = ARENA_NEW(b->arena, struct Quantified);
  *q = (struct Quantified){.outer = id, .lo = lo, .hi = hi};
  if (!read_text(ev, q)) return 0;
  uint64_t pairs = 0;
  for (uint32_t row = 0; row < q->range.rows; row++) pairs += (uint64_t)loop_turns(&q->range, row);
  if (pairs < b->sums_from || !find_pairs(q, b->arena)) return 0;
  for (int k = 0; k < COMPONENTS; k++) q->inside[k] = expr_declare(b->g, SYM_LOCAL, 0, x->name, SIGN_UNKNOWN);
  ev->sums = q;
  vec_push(b->arena, &ev->loops, ((Loop){id, q->pair[0][0], q->pair[0][0], ev->terms.n}));
  vec_push(b->arena, &ev->index, ((IndexVar){x->name, q->pair[0][0]}));
  return 1;
}

/* v, the value of the inner sum for one pair, is kept, and stood for by symbols. */
static void keep_inner(Eval *ev, Value *v) {
  struct Quantified *q = ev->sums;
  q->body[q->pass] = *v;
  if (v->n == ROTATION) return;
  for (uint32_t k = 0; v->e && k < component_count(v); k++) v->at[k] = expr_symbol(ev->b->g, q->inside[k])->node;
}

int quantified_next(Eval *ev, Value *v) {
  struct Quantified *q = ev->sums;
  Builder *b = ev->b;
  Loop *l = &ev->loops.at[ev->loops.n - 1];
  if (l->construct == q->inner) keep_inner(ev, v);
  if (l->construct != q->outer) return 0;
  if (q->pairs) {
    if (l->at < l->hi || !v->e) return 0;
    ev->sums = NULL;
    v->e = expr_add(b->g, v->e, q->pairs);
    return 0;
  }
  q->whole[q->pass] = *v;
  int failed = !v->e || !q->body[q->pass].e;
  if (!failed && ++q->pass < REPRESENTATIVES) {
    l->at = l->hi = ev->index.at[ev->index.n - 1].at = q->pair[q->pass][0];
    return 1;
  }
  ev->sums = NULL;
  if (failed) return 0;
  Value r = *v;
  for (uint32_t c = 0; c < component_count(v) && r.e; c++)
    if (!(r.at[c] = component_sum(ev, q, c))) r.e = 0;
  if (r.e) vec_push(b->arena, &b->m->sums, ((PairSum){q->outer, q->beside}));
  if (r.e && !q->beside) {
    *v = r;
    return 0;
  }
  if (r.e) {
    q->pairs = r.e;
    ev->sums = q;
  } else {
    ev->written_out = q->outer;
  }
  ev->terms.n = l->base;
  l->at = ev->index.at[ev->index.n - 1].at = q->lo;
  l->hi = q->hi;
  return 1;
}
