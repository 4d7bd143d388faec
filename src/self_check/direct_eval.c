/* Evaluation of expressions of the text. Ast nodes of an expression are contiguous, children first, so evaluation is
 * one loop over them; the body of a sum is repeated per term, the branch of an `if` that is not taken is skipped. An
 * evaluation that needs a definition or a call waits on an explicit stack of frames: neither nesting nor chains of
 * definitions use the C stack. */
#include "self_check/direct_eval.h"

#include <stdlib.h>

#include "base/loop_nest.h"
#include "self_check/direct_eval_impl.h"

static TextValue number_of(DirectEval *t, Num n) { return (TextValue){.at = {tape_number(t->tape, n)}, .bare = 1}; }

/* --- frames --- */

/* Marks the first nodes of sums' bodies and of branches of `if`. */
static void mark(const DirectEval *t, Frame *f) {
  const Ast *ast = t->b->ast;
  for (AstId i = f->first; i <= f->root; i++) {
    const AstExpr *x = ast_expr(ast, i);
    if (x->kind == AST_SUM || x->kind == AST_PRODUCT) f->guard[ast_expr(ast, x->c)->first - f->first] = i;
    if (x->kind != AST_CALL || strcmp(x->name, "if") != 0 || !x->args) continue;
    AstId yes = ast_expr(ast, x->args)->next, no = yes ? ast_expr(ast, yes)->next : 0;
    if (!no) continue;
    f->guard[ast_expr(ast, yes)->first - f->first] = i;
    f->guard[ast_expr(ast, no)->first - f->first] = i;
  }
}

static Frame *begin(DirectEval *t, AstId id, Name effect, PendingDefinition what) {
  Frame *f = t->idle.n ? t->idle.at[--t->idle.n] : ARENA_NEW(t->arena, Frame);
  uint32_t n = id - ast_expr(t->b->ast, id)->first + 1;
  if (n > f->cap) {
    f->cap = n < 8 ? 8 : n;
    f->value = ARENA_ARRAY(t->arena, TextValue, f->cap);
    f->guard = ARENA_ARRAY(t->arena, AstId, f->cap);
  }
  memset(f->value, 0, n * sizeof *f->value);
  memset(f->guard, 0, n * sizeof *f->guard);
  f->first = f->pc = id - n + 1;
  f->root = id;
  f->effect = effect;
  f->what = what;
  f->index.n = f->loops.n = 0;
  f->returned = f->waits = 0;
  f->function = NULL;
  mark(t, f);
  return f;
}

static void push_indices(DirectEval *t, Frame *f, const IndexVar *at, uint32_t n) {
  for (uint32_t k = 0; k < n; k++)
    if (at[k].name) vec_push(t->arena, &f->index, at[k]);
}

/* Frame for the definition that f waits for. */
static Frame *begin_awaited(DirectEval *t, Frame *f) {
  PendingDefinition w = f->needs;
  if (w.kind == ENT_CONST) {
    const Constant *c = &t->b->constants.at[w.index];
    return begin(t, c->given, c->effect, w);
  }
  const Definition *d = w.kind == ENT_LET       ? &t->b->lets.at[w.index]
                        : w.kind == ENT_OBSERVE ? &t->b->observes.at[w.index]
                                                : &t->b->functions.at[w.index];
  Frame *g = begin(t, d->stmt->rhs, d->effect, w);
  push_indices(t, g, d->index, 2);
  push_indices(t, g, d->around, d->naround);
  if (w.kind != ENT_FUNCTION) return g;
  g->function = d;
  g->nargs = 0;
  g->args = ARENA_ARRAY(t->arena, TextValue, ast_list_length(t->b->ast, ast_expr(t->b->ast, f->pc)->args) + 1);
  for (AstId i = ast_expr(t->b->ast, f->pc)->args; i; i = ast_expr(t->b->ast, i)->next)
    g->args[g->nargs++] = f->value[i - f->first];
  return g;
}

/* Stores the value of a finished definition, and passes it to the waiting frame. */
static void finish(DirectEval *t, Frame *f, Frame *caller) {
  TextValue v = f->value[f->root - f->first];
  const AstStmt *observe = f->what.kind == ENT_OBSERVE ? t->b->observes.at[f->what.index].stmt : NULL;
  const Unit *unit = f->what.kind == ENT_CONST ? &t->b->constants.at[f->what.index].unit : NULL;
  Unit own;
  if (observe && observe->unit.n) {
    own = unit_resolve(&observe->unit, t->b->dims, t->b->diags, t->m->arena);
    unit = &own;
  }
  for (uint32_t k = 0; unit && v.at[0] && k < text_components(&v); k++) v.at[k] = text_component(t, &v, k, unit);
  if (f->what.kind != ENT_CONST || unit->text[0]) v.bare = 0;
  if (f->what.kind == ENT_LET) t->lets[f->what.index] = v;
  if (f->what.kind == ENT_OBSERVE) t->observes[f->what.index] = v;
  if (f->what.kind == ENT_CONST) t->constants[f->what.index] = v;
  caller->result = v;
  caller->returned = 1;
}

/* --- sums and products --- */

/* The part of the sum around index `at` of which only some terms take part; NULL: all do. */
static const QuantifiedSum *sampled_part(const DirectEval *t, AstId id, int64_t at) {
  for (uint32_t k = 0; t->samples && k < t->m->sums.n; k++) {
    const QuantifiedSum *s = &t->m->sums.at[k];
    if (s->outer == id && s->sampled && !s->family && at >= s->lo && at <= s->hi) return s;
  }
  return NULL;
}

static int takes_row(const QuantifiedSum *s, int64_t at) {
  return !s || loop_samples(at - s->lo, s->hi - s->lo + 1);
}

/* The sum that each member of a family has, of which only some terms of some members take part, and the member in
 * progress; NULL: it is none. */
static const QuantifiedSum *sampled_rows(const DirectEval *t, const Frame *f, AstId id, int64_t *at) {
  for (uint32_t k = 0; t->samples && k < t->m->sums.n; k++) {
    const QuantifiedSum *s = &t->m->sums.at[k];
    if (s->outer != id || !s->sampled || !s->family) continue;
    for (uint32_t i = f->index.n; i-- > 0;)
      if (f->index.at[i].name == s->family) return *at = f->index.at[i].at, s;
  }
  return NULL;
}

/* Next index of the loop; past its end: none. */
static int64_t next_index(const DirectEval *t, const TextLoop *l) {
  for (int64_t at = l->at + 1; at <= l->hi; at++) {
    const QuantifiedSum *s = l->inner ? NULL : sampled_part(t, l->construct, at);
    if (l->inner ? loop_samples(at - l->lo, l->hi - l->lo + 1) : takes_row(s, at) || s->beside) return at;
  }
  return l->hi + 1;
}

/* Starts a loop; 0: empty or unknown range, the value is set. */
static int loop_enter(DirectEval *t, Frame *f, AstId id) {
  const AstExpr *x = ast_expr(t->b->ast, id);
  int64_t lo, hi;
  TextValue *r = &f->value[id - f->first];
  if (!whole(t, &f->value[x->a - f->first], &lo) || !whole(t, &f->value[x->b - f->first], &hi)) {
    *r = unknown(t, "a range");
    return 0;
  }
  *r = number_of(t, num_int(x->kind == AST_PRODUCT));
  if (lo > hi) return 0;
  const TextLoop *around = f->loops.n ? &f->loops.at[f->loops.n - 1] : NULL;
  int64_t row = around ? around->at : 0;
  const QuantifiedSum *s = around ? sampled_part(t, around->construct, row) : sampled_rows(t, f, id, &row);
  if (!takes_row(s, row)) return 0; /* of a member, or with terms beside its inner sum */
  TextLoop l = {.construct = id, .lo = lo, .at = lo, .hi = hi, .inner = s != NULL};
  vec_push(t->arena, &f->loops, l);
  vec_push(t->arena, &f->index, ((IndexVar){x->name, lo}));
  return 1;
}

/* Adds the body's value as a term; 1: next index; 0: end, the value is set. */
static int loop_again(DirectEval *t, Frame *f) {
  TextLoop *l = &f->loops.at[f->loops.n - 1];
  const AstExpr *x = ast_expr(t->b->ast, l->construct);
  const TextValue *term = &f->value[x->c - f->first];
  l->sum = l->terms++ == 0 ? *term : text_pair(t, x->kind == AST_SUM ? AST_ADD : AST_MUL, &l->sum, term);
  l->at = next_index(t, l);
  if (l->at <= l->hi && l->sum.at[0]) {
    f->index.at[f->index.n - 1].at = l->at;
    return 1;
  }
  f->value[l->construct - f->first] = l->sum;
  f->loops.n--;
  f->index.n--;
  return 0;
}

/* --- the loop over nodes --- */

/* Called at the first node of a sum's body or of a branch: the node to jump to; 0: continue at pc. */
static AstId enter(DirectEval *t, Frame *f, AstId construct) {
  const Ast *ast = t->b->ast;
  const AstExpr *x = ast_expr(ast, construct);
  if (x->kind != AST_CALL) {
    int inside = f->loops.n && f->loops.at[f->loops.n - 1].construct == construct;
    return inside || loop_enter(t, f, construct) ? 0 : construct;
  }
  Num c;
  if (!tape_is_number(t->tape, f->value[x->args - f->first].at[0], &c)) return 0;
  AstId yes = ast_expr(ast, x->args)->next, no = ast_expr(ast, yes)->next;
  int second = ast_expr(ast, no)->first == f->pc, taken = !num_is_zero(c);
  if (second) return taken ? construct : 0;
  return taken ? 0 : ast_expr(ast, no)->first;
}

/* Evaluates from pc on. 1: the root has its value; 0: f->needs must be evaluated first. */
static int run(DirectEval *t, Frame *f) {
  const Ast *ast = t->b->ast;
  while (f->pc <= f->root && !t->tape->too_long) {
    AstId construct = f->guard[f->pc - f->first], to = construct && !f->returned ? enter(t, f, construct) : 0;
    if (to) f->pc = to;
    const AstExpr *x = ast_expr(ast, f->pc);
    int is_loop = x->kind == AST_SUM || x->kind == AST_PRODUCT;
    if (!is_loop) { /* a loop's value was set by loop_enter or loop_again */
      t->tape->node = f->pc;
      TextValue v = text_node(t, f, f->pc);
      if (f->waits) return 0;
      f->value[f->pc - f->first] = v;
    }
    f->returned = 0;
    if (f->loops.n && ast_expr(ast, f->loops.at[f->loops.n - 1].construct)->c == f->pc && loop_again(t, f)) {
      f->pc = ast_expr(ast, f->pc)->first;
      continue;
    }
    f->pc++;
  }
  return 1;
}

TextValue text_value(DirectEval *t, AstId id, Name effect, const IndexVars *around) {
  VEC(Frame *) stack = {0};
  Frame *root = begin(t, id, effect, (PendingDefinition){ENT_NONE, 0});
  push_indices(t, root, around->at, around->n);
  vec_push(t->arena, &stack, root);
  for (;;) {
    Frame *f = stack.at[stack.n - 1];
    if (!run(t, f)) {
      f->waits = 0;
      t->tape->too_long |= stack.n >= FRAMES_MAX;
      if (t->tape->too_long) return unknown(t, "an expression that is too long");
      Frame *g = begin_awaited(t, f);
      vec_push(t->arena, &stack, g);
      continue;
    }
    if (t->tape->too_long) return unknown(t, "an expression that is too long");
    vec_push(t->arena, &t->idle, f);
    if (--stack.n == 0) return f->value[f->root - f->first];
    finish(t, f, stack.at[stack.n - 1]);
  }
}

int text_range(DirectEval *t, AstId lo, AstId hi, Name effect, const IndexVars *around, int64_t *from, int64_t *to) {
  TextValue a = text_value(t, lo, effect, around), b = text_value(t, hi, effect, around);
  return whole(t, &a, from) && whole(t, &b, to);
}

DirectEval *text_new(const Model *m, int samples, Arena *a) {
  DirectEval *t = ARENA_NEW(a, DirectEval);
  const Declarations *b = m->declared;
  *t = (DirectEval){.m = m, .b = b, .arena = a, .tape = tape_new(a), .samples = samples};
  t->lets = ARENA_ARRAY(a, TextValue, b->lets.n + 1);
  t->observes = ARENA_ARRAY(a, TextValue, b->observes.n + 1);
  t->constants = ARENA_ARRAY(a, TextValue, b->constants.n + 1);
  return t;
}
