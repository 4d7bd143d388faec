/* Families of contacts, `contact NAME[i in a..b, j in c..d]: gap >= 0, ...`: one text for all members, evaluated for
 * one of them. Each family of coordinates is read at indices affine in i and j, as by the sums of quantified_text.c;
 * so a symbol of the text stands for a member of any turn. moreau follows such contacts, and asks which are near. */
#include <math.h>
#include <string.h>

#include "model/quantified_sum.h"

#define USE \
  "a family of contacts is `contact touch[i in 1..N, j in near(i, 2*R)]: norm(r[i] - r[j]) >= 2*R, restitution = 0`, " \
  "with indices such as `i`, `j`, `i+1`"

int is_contact_family(const Builder *b, const AstStmt *st) {
  return st->kind == STMT_CONTACT && st->dims && ast_expr(b->ast, st->dims)->kind == AST_BIND;
}

static const AstNear *near_of(const Ast *ast, AstId bind) {
  for (uint32_t k = 0; k < ast->nears.n; k++)
    if (bind && ast->nears.at[k].sum == bind) return &ast->nears.at[k];
  return NULL;
}

typedef struct {
  Builder *b;
  const AstStmt *st;
  Name effect;
  AstId first, second; /* the ranges of i and j */
  const AstNear *near;
  struct Quantified q;
  int64_t pair[2];     /* i and j of the member that is evaluated */
} Work;

static int refuse_family(const Work *w, AstId where, const char *why) {
  return diag_error(w->b->diags, where ? ast_expr(w->b->ast, where)->span : w->st->span, "%s" HELP USE, why);
}

/* --- ranges, and what the text reads --- */

static int read_ranges(Work *w) {
  Builder *b = w->b;
  const AstExpr *x = ast_expr(b->ast, w->first), *y = w->second ? ast_expr(b->ast, w->second) : NULL;
  Eval ev = {.b = b, .effect = w->effect, .in_statement = 1};
  if (w->second && y->next) return refuse_family(w, y->next, "contacts have at most two indices");
  if (near_of(b->ast, w->first)) return refuse_family(w, w->first, "the first index runs over a range");
  if (w->near && w->near->i != x->name)
    return refuse_family(w, w->second, "`near` takes the first index, and a distance");
  w->q.i = x->name;
  if (!resolve_whole(b, x->a, w->effect, &w->q.lo) || !resolve_whole(b, x->b, w->effect, &w->q.hi) ||
      !range_fits(b, w->q.lo, w->q.hi, x->span))
    return 0;
  w->q.range = (LoopRange){.rows = w->q.hi < w->q.lo ? 0 : (uint32_t)(w->q.hi - w->q.lo + 1), .turns = 1};
  if (!w->second) return 1;
  w->q.j = y->name;
  w->q.inner = w->second;
  return quantified_range(&ev, &w->q, y->a, y->b) || refuse_family(w, w->second, w->q.why);
}

/* Notes what an expression reads. */
static int note(Work *w, AstId id) {
  Eval ev = {.b = w->b, .effect = w->effect, .in_statement = 1};
  return !id || quantified_reads(&ev, &w->q, id) || refuse_family(w, w->q.where, w->q.why);
}

static int note_all(Work *w) {
  int ok = note(w, w->st->lhs) && note(w, w->st->rhs);
  for (AstId i = w->st->args; i && ok; i = ast_expr(w->b->ast, i)->next)
    ok = strcmp(ast_expr(w->b->ast, i)->name, "law") == 0 || note(w, ast_expr(w->b->ast, i)->args);
  for (uint32_t k = 0; w->near && k < w->near->n && ok; k++)
    ok = note(w, w->near->at_i[k]) && note(w, w->near->at_j[k]);
  return ok;
}

/* A member whose reads differ; 0: there is none, or no member at all. */
static int find_representative(Work *w) {
  enum { TRIED = 12 };
  const LoopRange *range = &w->q.range;
  for (int64_t row = (int64_t)range->rows - 1; row >= 0 && row + TRIED >= range->rows; row--)
    for (int64_t k = loop_turns(range, row); k-- > 0;) {
      int64_t i = w->q.lo + row, from = w->q.from.first + w->q.from.by_i * i;
      w->pair[0] = i;
      w->pair[1] = from + k;
      if (quantified_tells_apart(&w->q, w->pair)) {
        memcpy(w->q.pair[0], w->pair, sizeof w->pair);
        return 1;
      }
      if (loop_turns(range, row) - k > TRIED) break;
    }
  return 0;
}

/* --- the text of one member --- */

static Value evaluate(const Work *w, AstId id) {
  Builder *b = w->b;
  uint32_t n = b->index.n;
  vec_push(b->arena, &b->index, ((IndexVar){w->q.i, w->pair[0]}));
  if (w->q.inner) vec_push(b->arena, &b->index, ((IndexVar){w->q.j, w->pair[1]}));
  Value v = resolve(b, id, IN_DYNAMICS, w->effect);
  b->index.n = n;
  for (uint32_t k = 0; v.e && w->q.has_lets && k < component_count(&v); k++) v.at[k] = expr_expand_defs(b->g, v.at[k]);
  return v;
}

static Expr option(Work *w, const char *word, Expr other) {
  AstId id = ast_option_value(w->b->ast, w->st, word);
  Value v = id ? evaluate(w, id) : (Value){.e = other};
  const char *what = word[0] == 't'   ? "a tangential restitution"
                     : word[0] == 's' ? "a coefficient of static friction"
                                      : "a coefficient of friction";
  int fits = !id || !v.e || check_pure_number(w->b, w->st, id, &v, word[0] == 't' ? 1 : HUGE_VAL, what);
  return fits ? v.e : 0;
}

static int read_friction(Work *w, ContactFamily *to, const Value *gap) {
  Builder *b = w->b;
  const Constraint of_gap = {.c = gap->e, .dim = gap->dim};
  Expr zero = expr_int(b->g, 0);
  to->friction = to->tangential = to->hold = zero;
  if (!w->st->args) return 1;
  if (!check_contact_options(b, w->st)) return 0;
  for (AstId i = w->st->args; i; i = ast_expr(b->ast, i)->next)
    if (strcmp(ast_expr(b->ast, i)->name, "law") == 0)
      return diag_error(b->diags, ast_expr(b->ast, i)->span,
                        "`law` of a family of contacts is not supported: moreau, which follows it, has a law of its own"
                        HELP "leave it out, or write single contacts, `for i in 1..N { contact ... }`, for dop853");
  AstId id = ast_option_value(b->ast, w->st, "slip"), most = ast_option_value(b->ast, w->st, "static");
  Value slip = evaluate(w, id);
  to->friction = option(w, "friction", zero);
  to->tangential = option(w, "tangential", zero);
  to->hold = to->friction ? option(w, "static", to->friction) : 0;
  if (most && to->hold) add_static_limit(b, to->hold, to->friction, ast_expr(b->ast, most)->span);
  if (!slip.e || !to->hold || !to->tangential || !check_slip(b, w->st, id, &slip, &of_gap)) return 0;
  to->tangents = component_count(&slip);
  for (uint32_t k = 0; k < to->tangents; k++) to->slip[k] = slip.at[k];
  if (!b->m->dissipation_span.end) b->m->dissipation_span = w->st->span;
  return 1;
}

/* --- reads --- */

/* Whether a symbol is the same for all members: a plain name, or one member of a family that is not read at i or j. */
static int is_same_for_all(const Work *w, const Symbol *s, int is_coord) {
  int same = 1;
  for (uint32_t k = 0; k < w->q.reads.n; k++) {
    const Entity *e = w->q.reads.at[k].e;
    same &= (e->kind == ENT_COORD) != is_coord || s->index < e->index || s->index >= e->index + entity_size(e);
  }
  return same || quantified_is_plain(s);
}

static int add_read(Work *w, ContactFamily *to, const Symbol *s) {
  Builder *b = w->b;
  int64_t part = 0;
  const Read *r = quantified_read_of(&w->q, s, &part);
  int is_coord = s->kind == SYM_COORD || s->kind == SYM_VEL;
  if (s->kind == SYM_TIME || s->kind == SYM_CONST) return 1;
  if (s->kind == SYM_PARAM && !r && is_same_for_all(w, s, 0)) return 1;
  if (!is_coord && s->kind != SYM_PARAM)
    return refuse_family(w, w->st->lhs, "contacts of a family contain coordinates, velocities, parameters and time");
  if (!r && !(is_coord && is_same_for_all(w, s, 1)))
    return refuse_family(w, w->st->lhs, arena_printf(b->arena, "`%s` is no member at indices of this family", s->name));
  Affine at = {.first = s->index};
  if (r) {
    at = quantified_element(r);
    at.first += r->e->index + part;
  }
  SymId symbol = is_coord ? b->m->coords.at[s->index].q : b->m->params.at[s->index].sym;
  FamilyRead one = {symbol, quantified_turns(&w->q, at)};
  for (uint32_t k = 0; k < to->coords.n; k++)
    if (to->coords.at[k].symbol == one.symbol) return 1;
  if (is_coord) vec_push(b->arena, &to->coords, one);
  else vec_push(b->arena, &to->params, one);
  return 1;
}

static int add_reads(Work *w, ContactFamily *to) {
  ExprGraph *g = w->b->g;
  const Expr roots[] = {to->gap, to->restitution, to->friction, to->tangential, to->hold,
                        to->tangents ? to->slip[0] : to->gap, to->tangents > 1 ? to->slip[1] : to->gap};
  ExprList l = expr_topo(g, roots, sizeof roots / sizeof *roots);
  for (uint32_t k = 0; k < l.n; k++) {
    if (expr_op(g, l.at[k]) == EX_CELL) return refuse_family(w, w->st->lhs, "a contact contains a sum over many terms");
    if (expr_op(g, l.at[k]) == EX_SYM && !add_read(w, to, expr_sym_of(g, l.at[k]))) return 0;
  }
  return 1;
}

/* --- neighbours --- */

static int read_near(Work *w, ContactFamily *to) {
  Builder *b = w->b;
  const AstNear *x = w->near;
  if (!x) return 1;
  to->cut = evaluate(w, x->cut).e;
  int still = to->cut && expr_is_constant(b->g, to->cut);
  for (uint32_t k = 0; k < x->n && still; k++) {
    int64_t part;
    Expr side = x->box[k] ? evaluate(w, x->box[k]).e : 0, at = evaluate(w, x->at_j[k]).e;
    still = !x->box[k] || (side && expr_is_constant(b->g, side));
    if (!at || !still) break;
    const Symbol *s = expr_sym_of(b->g, at);
    Affine of = quantified_element(quantified_read_of(&w->q, s, &part));
    of.first += quantified_read_of(&w->q, s, &part)->e->index + part;
    to->place[k] = quantified_turns(&w->q, of);
    to->side[k] = side;
    to->nplaces = k + 1;
    if (side) add_near_box(b, side, to->cut, x->span);
  }
  if (still) add_near_cut(b, to->cut, x->span);
  else refuse(b, x->span, "the cut-off and the box of `near` move" HELP "they may contain numbers and parameters");
  return still;
}

void add_contact_family(Builder *b, const AstStmt *st, Name effect) {
  const Ast *ast = b->ast;
  Work w = {.b = b, .st = st, .effect = effect, .first = st->dims, .second = ast_expr(ast, st->dims)->next};
  w.near = near_of(ast, w.second);
  check_name_is_new(b, "constraint", st->name, effect, st->name_span);
  if (!read_ranges(&w)) return;
  uint64_t members = 0;
  for (int64_t k = 0; k < w.q.range.rows; k++) members += loop_turns(&w.q.range, k) > 0;
  if (!members || !note_all(&w)) return;
  if (!find_representative(&w)) {
    refuse_family(&w, st->lhs, "no member reads different coordinates at its indices");
    return;
  }
  Value gap = evaluate(&w, st->lhs), e = evaluate(&w, st->rhs);
  ContactFamily to = {.name = st->name, .name_i = w.q.i, .name_j = w.q.inner ? w.q.j : NULL, .span = st->span,
                      .stmt = st, .effect = effect, .range = w.q.range, .i0 = w.q.lo,
                      .j0 = w.q.from.first + w.q.from.by_i * w.q.lo, .gap = gap.e, .restitution = e.e};
  if (gap.e && e.e && check_contact(b, st, st->name, &gap, &e) && read_friction(&w, &to, &gap) && read_near(&w, &to) &&
      add_reads(&w, &to))
    vec_push(b->arena, &b->m->families, to);
}

int read_by_contact_family(const Builder *b, const Entity *e) {
  for (uint32_t k = 0; k < b->m->families.n; k++) {
    const ContactFamily *f = &b->m->families.at[k];
    for (uint32_t i = 0; i < f->params.n; i++) {
      uint32_t read = expr_symbol(b->g, f->params.at[i].symbol)->index;
      if (read >= e->index && read < e->index + entity_size(e)) return 1;
    }
  }
  return 0;
}

void check_contact_families(Builder *b) {
  const Model *m = b->m;
  if (!m->families.n || b->diags->errors) return;
  if (b->force_span.end)
    diag_error(b->diags, b->force_span, "forces beside a family of contacts are not supported: its impulses would be "
               "missing from them" HELP "write single contacts, `for i in 1..N { contact ... }`");
  for (uint32_t k = 0; k < m->families.n; k++)
    for (uint32_t i = 0; i < m->families.at[k].params.n; i++) {
      const Param *p = &m->params.at[expr_symbol(b->g, m->families.at[k].params.at[i].symbol)->index];
      if (p->fixed)
        diag_error(b->diags, m->families.at[k].span, "`%s` of a family of contacts as a number is not supported" HELP
                   "leave it out of --fix", p->name);
    }
  if (m->scene.method && strcmp(m->scene.method, "moreau") != 0)
    diag_error(b->diags, m->scene.method_span, "`%s` does not follow the family of contacts `%s`" HELP
               "`method moreau(step = 1e-3 [s])` does; single contacts, `for i in 1..N { contact ... }`, have other "
               "methods, too", m->scene.method, m->families.at[0].name);
}
