/* Sums, sum(i in a..b, f) and sum(i in a..b, ... sum(j in c..d, f) ...), as nodes (sym/sum_nest.h) that do not know how
 * many terms there are.
 *
 * The text is evaluated at two representative turns. Each family in f is read at indices affine in i and j, so that a
 * symbol of f is an element of a family for all turns alike; what the second turn gives must be what the first gives
 * with its symbols in their places. Terms beside an inner sum are written out; all is, where there is no such form
 * (quantified_text.c), and a note says why. */
#include "model/quantified_sum.h"

#include <math.h>

#include "sym/diff.h"
#include "sym/sum_nest.h"

/* --- representatives --- */

static int64_t at_pair(Affine x, const int64_t *pair) { return x.first + x.by_i * pair[0] + x.by_j * pair[1]; }

/* Whether families read at different indices are read at different members for this pair. */
int quantified_tells_apart(const struct Quantified *q, const int64_t *pair) {
  for (uint32_t x = 0; x < q->reads.n; x++)
    for (uint32_t y = 0; y < x; y++) {
      const Read *r = &q->reads.at[x], *s = &q->reads.at[y];
      int same_text = 1, same_member = r->e->index == s->e->index && r->e->kind == s->e->kind && r->rate == s->rate;
      for (uint32_t k = 0; k < r->e->ndims && same_member; k++) {
        same_text &= memcmp(&r->at[k], &s->at[k], sizeof r->at[k]) == 0;
        same_member &= at_pair(r->at[k], pair) == at_pair(s->at[k], pair);
      }
      if (same_member && !same_text) return 0;
    }
  return 1;
}

/* Two pairs of the last rows that differ in both indices, or in the only one that has two values. */
int quantified_find_pairs(struct Quantified *q, Arena *arena) {
  enum { TRIED = 12 };
  VEC(int64_t) at = {0};
  int64_t rows = (int64_t)q->range.rows;
  for (int64_t row = rows - 1; row >= 0 && row + TRIED >= rows; row--) {
    int64_t i = q->lo + row, from = q->from.first + q->from.by_i * i, n = loop_turns(&q->range, row);
    for (int64_t k = 0; k < n && k < TRIED; k++) {
      int64_t pair[2] = {i, from + k};
      if (!quantified_tells_apart(q, pair)) continue;
      vec_push(arena, &at, pair[0]);
      vec_push(arena, &at, pair[1]);
    }
  }
  for (uint32_t x = 0; x < at.n; x += 2)
    for (uint32_t y = 0; y < x; y += 2) {
      if ((at.at[x] == at.at[y] && (rows > 1 || !q->inner)) || (q->inner && at.at[x + 1] == at.at[y + 1])) continue;
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
  const char *why;         /* reason why the sum is written out */
  VEC(Expr) first, second; /* symbols of the two representatives in the same places */
} Arguments;

/* Position of the first argument of a family, whose members become arguments once. */
static uint32_t block_of(Arguments *a, const Read *r) {
  const Entity *e = r->e;
  for (uint32_t k = 0; k < a->blocks.n; k++) {
    const Read *known = &a->blocks.at[k];
    if (known->e->kind == e->kind && known->e->index == e->index && known->rate == r->rate) return a->base.at[k];
  }
  uint32_t base = a->args.n;
  vec_push(a->arena, &a->blocks, *r);
  vec_push(a->arena, &a->base, base);
  for (uint32_t k = 0; k < entity_size(e); k++)
    vec_push(a->arena, &a->args, expr_symbol(a->g, entity_symbol(a->m, e->kind, r->rate, e->index + k))->node);
  return base;
}

/* Element of the family's array as an affine function: (at[0] - lo[0])*size + at[1] - lo[1], times components. */
Affine quantified_element(const Read *r) {
  Affine x = {0};
  for (uint32_t k = 0; k < r->e->ndims; k++) {
    int64_t size = r->e->hi[k] - r->e->lo[k] + 1;
    x = (Affine){x.first * size + r->at[k].first - r->e->lo[k], x.by_i * size + r->at[k].by_i,
                 x.by_j * size + r->at[k].by_j};
  }
  int64_t parts = r->e->parts ? r->e->parts : 1;
  return (Affine){x.first * parts, x.by_i * parts, x.by_j * parts};
}

static SymKind kind_of(const Read *r) {
  switch (r->e->kind) {
    case ENT_COORD: return r->rate ? SYM_VEL : SYM_COORD;
    case ENT_STATE: return r->rate ? SYM_RATE : SYM_STATE;
    case ENT_PARAM: return SYM_PARAM;
    default: return SYM_INPUT;
  }
}

const Read *quantified_read_of(const struct Quantified *q, const Symbol *s, int64_t *part) {
  vec_each(const Read, r, q->reads) {
    *part = (int64_t)s->index - r->e->index - at_pair(quantified_element(r), q->pair[0]);
    if (kind_of(r) == s->kind && *part >= 0 && *part < (r->e->parts ? r->e->parts : 1)) return r;
  }
  return NULL;
}

SymId quantified_symbol(const Model *m, const struct Quantified *q, const Read *r, int64_t part) {
  return entity_symbol(m, r->e->kind, r->rate,
                       r->e->index + (uint32_t)(at_pair(quantified_element(r), q->pair[0]) + part));
}

/* Symbols that hold one number for all pairs: of names without an index. */
int quantified_is_plain(const Symbol *s) {
  return (s->kind == SYM_COORD || s->kind == SYM_STATE || s->kind == SYM_PARAM || s->kind == SYM_INPUT ||
          s->kind == SYM_VEL || s->kind == SYM_RATE || s->kind == SYM_TIME) &&
         !strchr(s->name, '[');
}

/* The parts of the name r[5].x around its indices, and these as functions of the turn. */
static void name_read(const Arguments *a, const Read *r, Name name, NestRead *to) {
  Interner *names = a->names;
  const char *open = strchr(name, '['), *close = strchr(name, ']');
  to->stem = intern(names, arena_strndup(a->arena, name, (size_t)(open - name)));
  to->tail = intern(names, close + 1);
  to->nindices = r->e->ndims;
  for (uint32_t k = 0; k < r->e->ndims; k++) to->index[k] = quantified_turns(a->q, r->at[k]);
}

static int has_name(const Symbol *s, Name name) { return name && s->name == name; }

/* Reads an index as a number: the arguments are its values. */
static int add_counter(Arguments *a, Expr node, Affine of) {
  Subscript at = quantified_turns(a->q, of), from = at;
  int64_t least, most;
  if (!loop_extent(&a->q->range, &at, &least, &most)) return 0;
  at.first += (int64_t)a->args.n - least;
  for (int64_t k = least; k <= most; k++) {
    Expr number = expr_int(a->g, k);
    vec_push(a->arena, &a->args, number);
  }
  NestRead read = {.symbol = expr_sym_id(a->g, node), .at = at, .stem = "", .tail = "", .nindices = 1, .index = {from}};
  vec_push(a->arena, &a->reads, read);
  return 1;
}

/* Makes the symbol an argument; 0: it is none. */
static int add_symbol(Arguments *a, Expr node) {
  const Symbol *s = expr_sym_of(a->g, node);
  SymId id = expr_sym_id(a->g, node);
  int64_t part;
  if (s->kind == SYM_CONST) return 1;
  if (s->kind == SYM_LOCAL && has_name(s, a->q->i)) return add_counter(a, node, (Affine){.by_i = 1});
  if (s->kind == SYM_LOCAL && has_name(s, a->q->j)) return add_counter(a, node, (Affine){.by_j = 1});
  const Read *r = quantified_read_of(a->q, s, &part);
  if (!r && !quantified_is_plain(s)) return 0;
  Subscript at = {.first = a->args.n};
  if (r) {
    Affine x = quantified_element(r);
    x.first += part + block_of(a, r);
    at = quantified_turns(a->q, x);
    uint32_t there = r->e->index + (uint32_t)(at_pair(quantified_element(r), a->q->pair[1]) + part);
    vec_push(a->arena, &a->first, node);
    vec_push(a->arena, &a->second, expr_symbol(a->g, entity_symbol(a->m, r->e->kind, r->rate, there))->node);
  } else {
    vec_push(a->arena, &a->args, node);
  }
  NestRead read = {.symbol = id, .at = at};
  if (r) name_read(a, r, s->name, &read);
  vec_push(a->arena, &a->reads, read);
  return 1;
}

/* Whether a choice depends on velocities or states: a run locates each such switch on its own, so that it may stick. */
static int switches_suddenly(ExprGraph *g, Expr e) {
  ExprOp op = expr_op(g, e);
  return (op == EX_ABS || op == EX_SIGN || op == EX_FLOOR || op == EX_MIN || op == EX_MAX || op == EX_LT ||
          op == EX_LE || op == EX_EQ) &&
         expr_kinds(g, e) & (1u << SYM_VEL | 1u << SYM_STATE | 1u << SYM_RATE);
}

/* Whether an expression that has the symbol is among those before. */
static int is_read(const Arguments *a, SymId symbol) {
  vec_each(const NestRead, r, a->reads)
    if (r->symbol == symbol) return 1;
  return 0;
}

/* The arguments of an expression in the symbols of the first pair; 0: it has others, or sums. */
static int find_arguments(Arguments *a, Expr e) {
  ExprList l = expr_topo(a->g, &e, 1);
  for (uint32_t k = 0; k < l.n; k++) {
    if (expr_op(a->g, l.at[k]) == EX_CELL) a->why = "it contains another sum over many terms";
    if (switches_suddenly(a->g, l.at[k])) a->why = "runs locate each of its switches by velocities";
    if (expr_op(a->g, l.at[k]) == EX_SYM && !is_read(a, expr_sym_id(a->g, l.at[k])) && !add_symbol(a, l.at[k]))
      a->why = arena_printf(a->arena, "`%s` is no member at indices of this sum", expr_sym_of(a->g, l.at[k])->name);
    if (a->why) return 0;
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

/* The sums over all turns, value c in cell c; of a family, in cell c of each row. The nest of cell 0 is that of all.
 * Where turns are as many as members, the self-check takes all. */
static Expr sums_over(const Arguments *a, const Expr *values, uint32_t n, const FarForm *far, int sampled) {
  const struct Quantified *q = a->q;
  const int of_family = quantified_of_family(q);
  NestShare *shares = ARENA_ARRAY(a->arena, NestShare, n + 1);
  for (uint32_t c = 0; c < n; c++) shares[c] = (NestShare){values[c], {c, of_family ? (int64_t)n : 0, 0}};
  NearTest *near = q->near ? ARENA_NEW(a->arena, NearTest) : NULL;
  if (near) *near = q->test;
  SumNest s = {.range = q->range, .near = near, .far = far, .reads = a->reads.at, .nreads = a->reads.n,
               .shares = shares, .nshares = n, .nargs = a->args.n, .ncells = of_family ? n * q->range.rows : n,
               .sampled = sampled, .i = q->i, .j = q->j, .i0 = q->lo,
               .j0 = q->from.first + q->from.by_i * q->lo, .row = q->pair[0][0] - q->lo,
               .turn = q->inner ? q->pair[0][1] - q->from.first - q->from.by_i * q->lo : 0};
  return expr_sum_cell(a->g, &s, a->args.at, 0);
}

/* The components of a family's sum, as those of the first member; 0: it has no such form. */
static int family_components(const Eval *ev, struct Quantified *q, Value *r) {
  Builder *b = ev->b;
  Arguments a = {.g = b->g, .m = b->m, .q = q, .arena = b->arena, .names = b->ast->names};
  const uint32_t n = component_count(&q->body[0]);
  Expr turned[REPRESENTATIVES][COMPONENTS];
  q->why = "its terms differ by more than the members that they read";
  if (n > COMPONENTS || n != component_count(&q->body[1])) return 0;
  for (uint32_t c = 0; c < n; c++) {
    for (int k = 0; k < REPRESENTATIVES; k++)
      turned[k][c] = q->has_lets ? expr_expand_defs(b->g, q->body[k].at[c]) : q->body[k].at[c];
    Expr both[] = {turned[0][c], turned[1][c]};
    quantified_guard_diagonal(ev, q, q->body[REPRESENTATIVES].at[c], both);
    turned[0][c] = both[0], turned[1][c] = both[1];
    if (!find_arguments(&a, both[0])) return q->why = a.why, 0;
  }
  for (uint32_t c = 0; c < n; c++)
    if (!same_for_both(&a, turned[0][c], turned[1][c])) return 0;
  Expr first = sums_over(&a, turned[0], n, NULL, q->sampled);
  for (uint32_t c = 0; c < n; c++)
    r->at[c] = expr_is_zero(b->g, turned[0][c]) ? turned[0][c] : expr_cell_of(b->g, expr_cell_nest(b->g, first), c);
  return 1;
}

/* Component c of the sum over pairs: the factor of the inner sum, which must be linear in the whole, times the inner
 * terms. 0: it has no such form. */
static Expr component_sum(Eval *ev, struct Quantified *q, uint32_t c) {
  Builder *b = ev->b;
  ExprGraph *g = b->g;
  Arguments a = {.g = g, .m = b->m, .q = q, .arena = b->arena, .names = b->ast->names};
  const Value *body = q->body, *whole = q->whole;
  uint32_t n = component_count(q->inner ? &body[0] : &whole[0]);
  if (n != component_count(&whole[0])) return 0; /* the vector inside became a number */
  Expr turned[PASSES] = {0};
  for (int k = 0; k < REPRESENTATIVES && !q->inner; k++) turned[k] = whole[k].at[c];
  for (int k = 0; k < q->passes && q->inner; k++) {
    Expr factor = expr_diff(g, whole[k].at[c], q->inside[c]);
    if (expr_contains_sym(g, factor, q->inside[c])) {
      q->why = "it is not linear in the sum inside";
      return 0;
    }
    turned[k] = expr_mul(g, factor, body[k].at[c]);
    Expr zero = expr_int(g, 0), rest = expr_replace(g, whole[k].at[c], &q->inside[c], &zero, 1);
    q->beside |= !expr_is_zero(g, rest);
  }
  for (int k = 0; k < q->passes && q->has_lets; k++) turned[k] = expr_expand_defs(g, turned[k]);
  quantified_guard_diagonal(ev, q, turned[REPRESENTATIVES], turned);
  q->why = "its terms differ by more than the members that they read";
  if ((q->beside && n > 1) || !find_arguments(&a, turned[0]) || !same_for_both(&a, turned[0], turned[1])) {
    if (a.why) q->why = a.why;
    return 0;
  }
  if (expr_is_zero(g, turned[0])) return turned[0];
  const FarForm *far = q->far ? quantified_far(ev, q, turned[0]) : NULL;
  q->failed = q->far && !far;
  return q->failed ? 0 : sums_over(&a, turned, 1, far, q->sampled);
}

/* --- the loops --- */

int quantified_counts(const Eval *ev, const AstExpr *name) {
  const struct Quantified *q = ev->sums;
  AstId id = (AstId)(name - ev->b->ast->exprs.at);
  return q && !q->pairs && q->pass < REPRESENTATIVES && id >= q->first && id <= ast_expr(ev->b->ast, q->outer)->c &&
         q->counts[id - q->first];
}

/* Whether a read is of the family of an earlier one. */
static int repeats(const struct Quantified *q, uint32_t k) {
  const Read *r = &q->reads.at[k];
  uint32_t first = 0;
  while (q->reads.at[first].e != r->e || q->reads.at[first].rate != r->rate) first++;
  return first < k;
}

/* Whether there are many more turns than members of what they read. */
static int has_many_turns(const struct Quantified *q, uint64_t turns) {
  enum { MANY = 8 };
  uint64_t members = 0;
  for (uint32_t k = 0; k < q->reads.n; k++)
    if (!repeats(q, k)) members += entity_size(q->reads.at[k].e);
  return turns > MANY * members;
}

/* Says that a long sum is written out, and why; refuses it where no expansion takes so many terms. */
int quantified_write_out(const Eval *ev, const struct Quantified *q, uint64_t turns) {
  enum { TERM_KB = 4 }; /* of a short term: potential of a pair, in a plane */
  static const char help[] = "a sum whose terms read families at indices such as `i`, `j`, `i+1` stays a sum, "
                             "whatever N is: `lagc help families`";
  Builder *b = ev->b;
  const char *sum = ast_short(b, q->outer), *why = q->why ? q->why : "its terms have no common form";
  Span span = ast_expr(b->ast, q->where ? q->where : q->outer)->span;
  if (b->diags->errors) return 1;
  if (turns > RANGE_MAX && !quantified_of_family(q)) {
    refuse(b, span, "`%s` would be written out, %llu terms, and lagc takes %d: %s" HELP "%s", sum,
           (unsigned long long)turns, RANGE_MAX, why, help);
    return 0;
  }
  diag_note(b->diags, span, "`%s` is written out, %llu terms, some %llu MB: %s" HELP "%s", sum,
            (unsigned long long)turns, (unsigned long long)(turns * TERM_KB / 1024), why, help);
  return 1;
}

const AstNear *quantified_near(const Ast *ast, AstId sum) {
  for (uint32_t k = 0; k < ast->nears.n; k++)
    if (sum && ast->nears.at[k].sum == sum) return &ast->nears.at[k];
  return NULL;
}

const AstFar *quantified_far_sum(const Ast *ast, AstId sum) {
  for (uint32_t k = 0; k < ast->fars.n; k++)
    if (sum && ast->fars.at[k].sum == sum) return &ast->fars.at[k];
  return NULL;
}

int quantified_fits(Eval *ev, AstId id) {
  const AstFar *far = quantified_far_sum(ev->b->ast, id);
  if (far && !ev->index.n) {
    refuse(ev->b, far->span, "a tree takes sums over pairs, and there is no sum around this one" HELP
           "write `sum(i in 1..N, sum(j in 1..i-1, ..., by tree(0.5)))`; in a potential it gives all forces");
    return 0;
  }
  const AstNear *near = quantified_near(ev->b->ast, id);
  for (uint32_t k = 0; near && k < ev->index.n; k++)
    if (ev->index.at[k].name == near->i) return 1;
  if (!near) return 1;
  refuse(ev->b, near->span, "`near` takes each pair once, and there is no sum over `%s` around it" HELP
         "a sum over pairs is `sum(%s in 1..N, sum(j in near(%s, r_cut), ...))`; in a potential it gives all forces",
         near->i, near->i, near->i);
  return 0;
}

/* Whether the sum names an index of the `for` around the statement. */
static int names_index(const Eval *ev, AstId id) {
  const Builder *b = ev->b;
  for (uint32_t k = ev->in_statement ? b->index.n : 0; k-- > 0;)
    if (quantified_names(b->ast, id, b->index.at[k].name)) return 1;
  return 0;
}

/* Whether the sum is tried as one: in no other sum or product; the index of a definition is a number in it. */
static int may_stay(const Eval *ev, AstId id) {
  return ast_expr(ev->b->ast, id)->kind == AST_SUM && !ev->sums && !ev->loops.n && !ev->function &&
         ev->written_out != id && ev->b->sums_from && !names_index(ev, id);
}

int64_t quantified_part(Eval *ev, AstId id, int64_t lo, int64_t hi) {
  return may_stay(ev, id) ? quantified_same_branches(ev, id, lo, hi) : hi;
}

/* Of turns in the size asked for, of which the model's are some halves and a few. */
int quantified_is_long(const Builder *b, uint64_t turns) {
  const double n = (double)turns, more = (double)b->more;
  return (more > 0 ? n + round(2*n*(b->m->times - 1)/more)/2*more : n) >= b->sums_from;
}

/* Takes the pair q->pass. */
static void take_pair(Eval *ev, const struct Quantified *q) {
  const int of_family = quantified_of_family(q);
  Loop *l = &ev->loops.at[ev->loops.n - 1];
  IndexVar *last = &ev->index.at[ev->index.n - 1];
  l->at = l->hi = last->at = q->pair[q->pass][of_family];
  if (of_family) last[-1].at = q->pair[q->pass][0];
}

/* A turn in which i and j are one, where there is any: 1/(x[i] - x[j]) is a mistake there. */
static int has_diagonal(const struct Quantified *q, int64_t *pair) {
  for (int64_t row = 0; q->inner && row < q->range.rows; row++) {
    const int64_t i = q->lo + row, from = q->from.first + q->from.by_i * i;
    pair[0] = pair[1] = i;
    if (i >= from && i < from + loop_turns(&q->range, row)) return 1;
  }
  return 0;
}

void quantified_start(Eval *ev, struct Quantified *q) {
  Builder *b = ev->b;
  Name name = ast_expr(b->ast, q->outer)->name;
  q->sampled = has_many_turns(q, q->turns);
  q->passes = REPRESENTATIVES + has_diagonal(q, q->pair[REPRESENTATIVES]);
  for (int k = 0; k < COMPONENTS; k++) q->inside[k] = expr_declare(b->g, SYM_LOCAL, 0, name, SIGN_UNKNOWN);
  ev->sums = q;
  vec_push(b->arena, &ev->loops, ((Loop){q->outer, 0, 0, ev->terms.n, 0, 0}));
  if (quantified_of_family(q)) vec_push(b->arena, &ev->index, ((IndexVar){q->i, 0}));
  vec_push(b->arena, &ev->index, ((IndexVar){name, 0}));
  take_pair(ev, q);
}

int quantified_begin(Eval *ev, AstId id, int64_t lo, int64_t hi) {
  Builder *b = ev->b;
  const AstExpr *x = ast_expr(b->ast, id);
  if (ev->sums && id == ev->sums->inner && ev->sums->pairs) {
    *value_of(ev, id) = a_value(expr_int(b->g, 0), ev->sums->body[0].dim, 0);
    return -1;
  }
  if (ev->sums && id == ev->sums->inner) {
    int64_t j = ev->sums->pair[ev->sums->pass][1];
    vec_push(b->arena, &ev->loops, ((Loop){id, j, j, ev->terms.n, 0, 0}));
    vec_push(b->arena, &ev->index, ((IndexVar){x->name, j}));
    return 1;
  }
  if (!may_stay(ev, id)) return 0;
  struct Quantified *q = ARENA_NEW(b->arena, struct Quantified);
  *q = (struct Quantified){.outer = id, .lo = lo, .hi = hi};
  int read = quantified_text(ev, q);
  uint64_t turns = 0;
  for (uint32_t row = 0; row < q->range.rows; row++) turns += (uint64_t)loop_turns(&q->range, row);
  uint64_t guessed = !read && q->inner ? (uint64_t)q->range.rows * q->range.rows / 2 : 0; /* unknown range inside */
  q->near = quantified_near(b->ast, q->inner);
  q->far = quantified_far_sum(b->ast, q->inner);
  int is_listed = (b->ast->nears.n || q->far) && b->sums_from < UINT32_MAX; /* such a model is meant for any N */
  if (!quantified_is_long(b, turns > guessed ? turns : guessed) && !is_listed) return 0;
  if (q->far && !read && (turns || hi > lo)) { /* one body has no pairs */
    refuse(b, q->far->span, "a tree takes a sum over pairs that stays one, and this one does not: %s" HELP
           "what a tree takes is in `lagc help tree`", q->why ? q->why : "its terms have no common form");
    *value_of(ev, id) = FAILED;
    return -1;
  }
  if (!read || !quantified_find_pairs(q, b->arena)) {
    if (!quantified_is_long(b, turns) || quantified_write_out(ev, q, turns)) return 0;
    *value_of(ev, id) = FAILED;
    return -1;
  }
  q->turns = turns;
  quantified_start(ev, q);
  return 1;
}

int quantified_judge(Eval *ev, AstId id) {
  Builder *b = ev->b;
  const AstNear *x = quantified_near(b->ast, id);
  if (!x) return 1;
  Expr cut = value_of(ev, x->cut)->e;
  int still = cut && expr_is_constant(b->g, cut);
  for (uint32_t k = 0; k < x->n && still; k++) {
    Expr side = x->box[k] ? value_of(ev, x->box[k])->e : 0;
    still = !x->box[k] || (side && expr_is_constant(b->g, side));
    if (side && still) add_near_box(b, side, cut, x->span);
  }
  if (still) add_near_cut(b, cut, x->span);
  else refuse(b, x->span, "the cut-off and the box of `near` move" HELP "they may contain numbers and parameters");
  return still;
}

/* Keeps the condition of near(...) in the symbols of the first pair. */
static void keep_test(const Eval *ev, struct Quantified *q) {
  const AstNear *x = q->near;
  q->test = (NearTest){.test = value_of(ev, x->test)->e, .cut = value_of(ev, x->cut)->e, .n = x->n};
  for (uint32_t k = 0; k < x->n; k++) {
    q->test.at_i[k] = value_of(ev, x->at_i[k])->e;
    q->test.at_j[k] = value_of(ev, x->at_j[k])->e;
    q->test.side[k] = x->box[k] ? value_of(ev, x->box[k])->e : 0;
  }
}

/* v, the value of the inner sum for one pair, is kept, and stood for by symbols. */
static void keep_inner(Eval *ev, Value *v) {
  struct Quantified *q = ev->sums;
  q->body[q->pass] = *v;
  if (v->n == ROTATION) return;
  if (q->near && v->e && q->pass == 0) keep_test(ev, q);
  for (uint32_t k = 0; v->e && k < component_count(v); k++) v->at[k] = expr_symbol(ev->b->g, q->inside[k])->node;
}

/* Takes the opening angle of the tree; 0 after a mistake. */
static int far_angle(Eval *ev, struct Quantified *q) {
  Builder *b = ev->b;
  const Value *v = value_of(ev, q->far->theta);
  q->theta = v->e;
  if (!v->e || !need_pure(ev, q->far->theta, "the opening angle of a tree")) return 0;
  if (v->n || !expr_is_constant(b->g, v->e)) {
    refuse(b, q->far->span, "the opening angle of a tree moves" HELP "it may contain numbers and parameters");
    return 0;
  }
  add_opening_angle(b, v->e, q->far->span);
  return 1;
}

/* The value of the sum, of both representatives, and whether it stays one: e is 0 where it does not. */
static Value value_of_sum(Eval *ev, struct Quantified *q) {
  Builder *b = ev->b;
  const Value *v = &q->whole[REPRESENTATIVES - 1];
  Value r = *v;
  const int of_family = quantified_of_family(q);
  if (q->far && !far_angle(ev, q)) q->failed = 1, r.e = 0;
  if (of_family && !family_components(ev, q, &r)) r.e = 0;
  for (uint32_t c = 0; c < component_count(v) && r.e && !of_family; c++)
    if (!(r.at[c] = component_sum(ev, q, c))) r.e = 0;
  if (q->failed) return r;
  const QuantifiedSum sum = {q->outer, q->beside, q->sampled, q->lo, q->hi, of_family ? q->i : NULL};
  if (r.e) vec_push(b->arena, &b->m->sums, sum);
  if (of_family) family_sum_end(ev, q, &r);
  return r;
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
  if (!q->inner) q->body[q->pass] = *v;
  int failed = !v->e || !q->body[q->pass].e;
  if (!failed && ++q->pass < q->passes) {
    take_pair(ev, q);
    return 1;
  }
  ev->sums = NULL;
  const int of_family = quantified_of_family(q);
  if (of_family) ev->index.at[ev->index.n - 2] = ev->index.at[ev->index.n - 1], ev->index.n--;
  if (failed) return 0;
  Value r = value_of_sum(ev, q);
  if (q->failed) return *v = FAILED, 0;
  if (r.e && !q->beside) {
    *v = r;
    return 0;
  }
  if (r.e) {
    q->pairs = r.e;
    ev->sums = q;
  } else {
    ev->written_out = q->outer;
    if (!quantified_write_out(ev, q, q->turns)) return *v = FAILED, 0;
  }
  l->at = ev->index.at[ev->index.n - 1].at = of_family ? q->own[0] : q->lo;
  l->hi = of_family ? q->own[1] : q->hi;
  return 1;
}
