/* Guesses at edits come from numbers at a few states; the cheapest guess that is proved exactly is the correction. */
#include "claims/suggest_correction_impl.h"

#include <math.h>
#include <stdlib.h>

#include "sym/print.h"

/* --- proving --- */

static Expr with_definitions(const Eqns *e, Expr x) {
  return e->definitions ? expr_substitute(e->g, x, e->definitions, expr_symbol_count(e->g) + 1, "") : x;
}

/* Proves that the difference is 0 by solving M q'' - A^T lambda = f, A q'' = demand for accelerations and multipliers. Redundant constraints leave
 * that undecided; so would contacts, whose rows are zero while they are open and are left out. */
static Verdict proof(const Eqns *e, Expr difference) {
  const Model *m = e->m;
  const Constraints *c = &e->constraints;
  ExprGraph *g = e->g;
  uint32_t n = e->n, w = n, *row = ARENA_ARRAY(m->arena, uint32_t, c->n + 1);
  for (uint32_t i = 0; i < c->n; i++) row[i] = UINT32_MAX;
  for (uint32_t k = 0; k < c->A.n; k++)
    if (row[c->A.at[k].row] == UINT32_MAX && !expr_is_zero(g, with_definitions(e, c->A.at[k].e))) row[c->A.at[k].row] = w++;
  Expr *M = ARENA_ARRAY(m->arena, Expr, (size_t)w * w + 1), *f = ARENA_ARRAY(m->arena, Expr, w + 1);
  SymId *acc = ARENA_ARRAY(m->arena, SymId, w + 1);
  for (size_t i = 0; i < (size_t)w * w; i++) M[i] = expr_int(g, 0);
  for (uint32_t i = 0; i < n; i++) {
    acc[i] = m->coords.at[i].a;
    f[i] = c->n ? with_definitions(e, e->system.f[i]) : e->f[i];
    for (uint32_t k = 0; k < n; k++) M[i * w + k] = eqns_mass(e, i, k);
  }
  for (uint32_t i = 0; i < c->n; i++) {
    if (row[i] == UINT32_MAX) continue;
    acc[row[i]] = c->of[i]->multiplier;
    f[row[i]] = with_definitions(e, c->demand[i]);
  }
  for (uint32_t k = 0; k < c->A.n; k++) {
    uint32_t i = row[c->A.at[k].row], j = c->A.at[k].col;
    if (i == UINT32_MAX) continue;
    Expr x = with_definitions(e, c->A.at[k].e);
    M[i * w + j] = x;
    M[j * w + i] = expr_neg(g, x);
  }
  return prove_solves(g, w, M, f, acc, difference, NULL);
}

Verdict prove_by_motion(const Eqns *e, Expr lhs, Expr rhs) {
  Expr difference = expr_sub(e->g, lhs, rhs);
  Expr closed = states_substitute(e, with_definitions(e, difference));
  return proof(e, closed);
}

/* --- states --- */

int edit_add_state(EditSearch *md) {
  enum { ATTEMPTS = 400 };
  Expr sides[2] = {md->x->lhs, md->x->rhs};
  uint32_t count = expr_symbol_count(md->g) + 1;
  long double *symbols = ARENA_ARRAY(md->arena, long double, count), out[2];
  EvalTape *tape = eval_tape(md->g, sides, 2);
  while (md->tried < ATTEMPTS) {
    sample_state(md->g, ++md->tried, symbols);
    if (!states_complete(md->solver, symbols)) continue;
    eval_run(tape, symbols, out);
    long double r = out[0] - out[1];
    if (!isfinite(r) || r == 0) continue;
    md->residual[md->nstates] = r;
    md->state[md->nstates++] = symbols;
    return 1;
  }
  return 0;
}

long double edit_residual(EditSearch *md, Spot *p, uint32_t state, long double value) {
  long double out[2], *symbols = md->state[state];
  symbols[md->stand_in] = value;
  if (p->at == (int)state) eval_rerun(p->tape, symbols, md->stand_in, out);
  else eval_run(p->tape, symbols, out);
  p->at = (int)state;
  return out[0] - out[1];
}

int edit_holds(EditSearch *md, Spot *p, const long double *values) {
  for (uint32_t i = 0; i < FEW; i++) {
    if (!isfinite(values[i])) return 0;
    long double r = edit_residual(md, p, i, values[i]);
    if (!(fabsl(r) <= 1e-8L * fabsl(md->residual[i]))) return 0;
  }
  return 1;
}

/* --- spots --- */

/* Site s with its value as written and its tape. */
static void prepare_spot(EditSearch *md, Spot *p, const Site *s) {
  *p = (Spot){.site = s, .ast = ast_expr(md->m->ast, s->node), .at = -1};
  if (s->role == SITE_PART) return;
  p->value = model_resolve_edited(md->m, md->x, s->node, 0, 0);
  AstId root = s->left ? md->x->lhs_ast : md->x->rhs_ast;
  Expr stand_in = expr_symbol(md->g, md->stand_in)->node;
  Expr changed = model_resolve_edited(md->m, md->x, root, s->node, stand_in);
  if (!p->value || !changed) return;
  Expr sides[2] = {s->left ? changed : md->x->lhs, s->left ? md->x->rhs : changed};
  p->tape = eval_tape(md->g, sides, 2);
}

/* Whether the formula is too long: with a tape for every place, the work grows with its square. */
static int is_too_large(const EditSearch *md) {
  enum { PLACES_MAX = 2000, STEPS_MAX = 1000000 };
  const Ast *ast = md->m->ast;
  AstId left = md->x->lhs_ast, right = md->x->rhs_ast;
  uint32_t places = left - ast_expr(ast, left)->first + right - ast_expr(ast, right)->first;
  Expr sides[2] = {md->x->lhs, md->x->rhs};
  return places > PLACES_MAX || (uint64_t)places * expr_topo(md->g, sides, 2).n > STEPS_MAX;
}

static void prepare_spots(EditSearch *md) {
  SiteList sites = edit_sites_of(md->m, md->x);
  md->spots = ARENA_ARRAY(md->arena, Spot, sites.n + 1);
  md->nspots = sites.n;
  Expr *values = ARENA_ARRAY(md->arena, Expr, sites.n + 1);
  long double *out = ARENA_ARRAY(md->arena, long double, sites.n + 1);
  for (uint32_t i = 0; i < sites.n; i++) {
    prepare_spot(md, &md->spots[i], &sites.at[i]);
    values[i] = md->spots[i].value;
  }
  EvalTape *tape = eval_tape(md->g, values, sites.n);
  for (uint32_t k = 0; k < FEW; k++) {
    eval_run(tape, md->state[k], out);
    for (uint32_t i = 0; i < sites.n; i++) md->spots[i].written[k] = out[i];
  }
}

/* --- guesses --- */

void edit_guess(EditSearch *md, const Spot *p, Expr with, double cost, Span caret, const char *edit) {
  /* Mistakes are likelier on the right side, where formulas stand. */
  Guess one = {p, with, cost + (p->site->left ? 0.05L : 0), caret, edit};
  vec_push(md->arena, &md->guesses, one);
}

double edit_product_cost(const EditSearch *md, const Spot *p) {
  int compound = site_is_sum(md->m, p->site) || p->ast->kind == AST_MUL || p->ast->kind == AST_DIV;
  if (p->site->role == SITE_NUMERATOR && !compound) return 0.1;
  return p->site->role == SITE_ROOT ? 0.05 : 0;
}

const char *edit_expr_text(const EditSearch *md, Expr e) {
  StrBuf b = strbuf(md->arena);
  expr_print(md->g, e, PRINT_TEXT, &b);
  return sb_text(&b);
}

const char *edit_spot_text(const EditSearch *md, const Spot *p) { return span_text(md->m, p->site->span); }

static int by_cost(const void *a, const void *b) {
  const Guess *x = a, *y = b;
  if (x->cost != y->cost) return x->cost < y->cost ? -1 : 1;
  uint32_t wide_x = x->caret.end - x->caret.begin, wide_y = y->caret.end - y->caret.begin;
  if (wide_x != wide_y) return wide_x < wide_y ? -1 : 1;
  return (x->caret.begin > y->caret.begin) - (x->caret.begin < y->caret.begin);
}

static int guess_is_proved(EditSearch *md, const Guess *guess) {
  const Site *s = guess->spot->site;
  AstId root = s->left ? md->x->lhs_ast : md->x->rhs_ast;
  Expr side = model_resolve_edited(md->m, md->x, root, s->node, guess->with);
  if (!side) return 0;
  Expr lhs = s->left ? side : md->x->lhs, rhs = s->left ? md->x->rhs : side;
  return prove_by_motion(md->e, lhs, rhs) == PROVED_ZERO;
}

/* The cheapest guess that is proved, or NULL; the list is empty afterwards. */
static const Guess *best_guess(EditSearch *md) {
  enum { PROOFS = 12 };
  Guess *at = md->guesses.at;
  uint32_t n = md->guesses.n;
  if (n) qsort(at, n, sizeof *at, by_cost);
  md->guesses.n = 0;
  for (uint32_t i = 0; i < n && i < PROOFS; i++)
    if (guess_is_proved(md, &at[i])) return &at[i];
  return NULL;
}

SuggestedEdit suggest_correction(const Eqns *e, const Expect *x) {
  const Model *m = e->m;
  EditSearch md = {.e = e, .m = m, .x = x, .g = e->g, .arena = m->arena};
  Name name = intern(m->ast->names, "?");
  md.stand_in = expr_declare(e->g, SYM_LOCAL, 0, name, SIGN_UNKNOWN);
  md.solver = states_new(e);
  SuggestedEdit nowhere = {.caret = ast_expr(m->ast, x->rhs_ast)->span};
  if (is_too_large(&md)) return nowhere;
  while (md.nstates < FEW)
    if (!edit_add_state(&md)) return nowhere;
  prepare_spots(&md);
  guess_local_edits(&md);
  const Guess *best = best_guess(&md);
  if (!best) {
    while (md.nstates < FEATURE_STATES)
      if (!edit_add_state(&md)) return nowhere;
    guess_edits_by_value(&md);
    best = best_guess(&md);
  }
  if (best) return (SuggestedEdit){best->caret, best->edit};
  return (SuggestedEdit){likeliest_place(&md), NULL};
}
