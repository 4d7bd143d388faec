/* Jumps of L, of momenta and of constraints, each as a warning at its place in the text. */
#include "mech/discontinuity.h"

#include <math.h>

#include "mech/consistent_start.h"
#include "mech/constrain.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/sum_nest.h"

/* ---- The cut of sum(j in near(i, r_cut), f): values of f there */

typedef struct {
  long double value, force; /* of a pair at the cut, with the scene's parameters; 0: it vanishes there */
} NearCut;

typedef long double Real;

/* A pair at distances cut*part along a line: its value, and the force along the line. */
typedef struct {
  const Eqns *e;
  const NearTest *t;
  Expr inside, slope[3];
  Real *symbols, cut;
} Pair;

static void pair_at(Pair *p, Real part, int line, Real *value, Real *force) {
  static const Real direction[2][3] = {{0.6L, 0.64L, 0.48L}, {-0.28L, 0.96L, 0}};
  ExprGraph *g = p->e->g;
  Real length = 0;
  *force = 0;
  for (uint32_t c = 0; c < p->t->n; c++) length += direction[line][c] * direction[line][c];
  for (uint32_t c = 0; c < p->t->n; c++) {
    p->symbols[expr_sym_id(g, p->t->at_j[c])] = 0;
    p->symbols[expr_sym_id(g, p->t->at_i[c])] = part * p->cut * direction[line][c] / sqrtl(length);
  }
  expr_eval(g, &p->inside, 1, p->symbols, value);
  for (uint32_t c = 0; c < p->t->n; c++) {
    Real slope;
    expr_eval(g, &p->slope[c], 1, p->symbols, &slope);
    *force += slope * direction[line][c] / sqrtl(length);
  }
}

static Real value_of(const Eqns *e, Expr x, const Real *symbols) {
  Real v;
  expr_eval(e->g, &x, 1, symbols, &v);
  return v;
}

/* Value of a pair at the cut of a sum over neighbours: a share of s, which has a test. */
static NearCut near_cut(const Eqns *e, const SumNest *s, Expr value) {
  enum { LINES = 2, PARTS = 8 };
  const NearTest *t = s->near;
  Expr yes = expr_int(e->g, 1);
  Pair p = {.e = e, .t = t, .symbols = start_requested(e)};
  NearCut r = {0};
  Real most = 0, strongest = 0;
  expr_replace_nodes(e->g, &value, 1, &t->test, &yes, 1, &p.inside);
  p.cut = value_of(e, t->cut, p.symbols);
  for (uint32_t c = 0; c < t->n; c++) p.slope[c] = expr_diff(e->g, p.inside, expr_sym_id(e->g, t->at_i[c]));
  for (int line = 0; line < LINES; line++)
    for (int k = PARTS / 2; k <= PARTS; k++) {
      Real v, f;
      pair_at(&p, (Real)k / PARTS, line, &v, &f);
      most = fmaxl(most, fabsl(v));
      strongest = fmaxl(strongest, fabsl(f));
      if (k == PARTS && fabsl(v) > fabsl(r.value)) r.value = v;
      if (k == PARTS && fabsl(f) > fabsl(r.force)) r.force = f;
    }
  if (!(fabsl(r.value) > 1e-9L * most)) r.value = 0; /* rounding */
  if (!(fabsl(r.force) > 1e-9L * strongest)) r.force = 0;
  return r;
}

/* ---- Jumps */

/* Jumps of the values of a sum; at the cut of near(...), which lines through random states seldom meet, by value. */
static ExprJumps jumps_of_sum(const Eqns *e, const SumNest *s) {
  ExprGraph *g = e->g;
  ExprJumps all = {0};
  Expr yes = expr_int(g, 1);
  for (uint32_t i = 0; i < s->nshares && !all.n; i++) {
    Expr value = s->shares[i].value;
    if (s->near && near_cut(e, s, value).value != 0) {
      ExprJump *cut = ARENA_NEW(e->m->arena, ExprJump);
      *cut = (ExprJump){.node = s->near->test, .side = expr_sub(g, s->near->at_i[0], s->near->at_j[0])};
      return (ExprJumps){cut, 1};
    }
    if (s->near) expr_replace_nodes(g, &value, 1, &s->near->test, &yes, 1, &value);
    all = expr_jumps(g, value);
  }
  return all;
}

ExprJumps discontinuities_of(const Eqns *e, Expr x) {
  const Model *m = e->m;
  ExprGraph *g = e->g;
  if (expr_kinds(g, x) & 1u << SYM_INPUT) {
    Expr *formula = ARENA_ARRAY(m->arena, Expr, expr_symbol_count(g) + 1);
    for (uint32_t i = 0; i < m->inputs.n; i++) formula[m->inputs.at[i].sym] = m->inputs.at[i].value;
    x = expr_substitute(g, x, formula, expr_symbol_count(g) + 1, "");
  }
  ExprJumps all = expr_jumps(g, x);
  ExprList l = expr_topo(g, &x, 1);
  for (uint32_t k = 0; k < l.n && !all.n; k++) {
    const SumNest *s = expr_op(g, l.at[k]) == EX_NEST ? expr_sum_nest(g, l.at[k]) : NULL;
    if (s) all = jumps_of_sum(e, s);
  }
  expr_list_free(g, l);
  return all;
}

/* --- warnings --- */

/* Symbols of the motion: coordinates, velocities, rates, and states that are coordinates of a model of first order. */
static int is_of_motion(const Symbol *s, const void *model) {
  const Model *m = model;
  return s->kind == SYM_COORD || s->kind == SYM_VEL || s->kind == SYM_RATE ||
         (s->kind == SYM_STATE && m->states.at[s->index].coordinate);
}

/* Span of the node in the text; if the text does not contain it, that of L. */
static Span place_in_text(const Model *m, Expr node) {
  AstId written = expr_map_get(&m->written, node);
  return written ? ast_expr(m->ast, written)->span : m->lagrangian_span;
}

static int is_among(const ExprJumps *all, Expr node) {
  uint32_t i = 0;
  while (i < all->n && all->at[i].node != node) i++;
  return i < all->n;
}

static void warn_of_momentum(const Eqns *e, uint32_t i, const ExprJumps *said) {
  const Model *m = e->m;
  ExprJumps all = discontinuities_of(e, eqns_momenta(e)[i]);
  Name q = expr_symbol(e->g, eqns_coordinate(e, i))->name;
  for (uint32_t k = 0; k < all.n; k++) {
    if (is_among(said, all.at[k].node)) continue;
    diag_warning(m->diags, place_in_text(m, all.at[k].node),
                 "the momentum of `%s` jumps here, and the equations of motion lack the impulse of the jump", q);
    diag_help(
        m->diags,
        "smooth it, or let an event of the same place set the velocity: `event NAME: t - 1 [s] rising { %s' = ... }`",
        q);
  }
}

/* Sums over neighbours whose pairs have energy or force at the cut. 1: L has energy there, or a switch. */
static int warn_of_cuts(const Eqns *e) {
  const Model *m = e->m;
  ExprList l = expr_topo(e->g, &m->lagrangian, 1);
  int some = 0;
  for (uint32_t k = 0; k < l.n; k++) {
    const SumNest *s = expr_op(e->g, l.at[k]) == EX_NEST ? expr_sum_nest(e->g, l.at[k]) : NULL;
    if (!s || !s->near || !s->nshares) continue;
    NearCut cut = near_cut(e, s, s->shares[0].value);
    Span where = place_in_text(m, s->near->test);
    some |= cut.value != 0;
    if (cut.value != 0) {
      diag_warning(m->diags, where, "a pair has the energy %.3g at the cut, and loses it as it passes",
                   (double)cut.value);
      diag_help(m->diags, "subtract what it is there, `f(d) - f(r_cut)`, and (d - r_cut) times its slope, so that the "
                          "force vanishes as well");
    } else if (cut.force != 0) {
      diag_warning(m->diags, where, "the force jumps at the cut, by %.3g", fabs((double)cut.force));
      diag_help(m->diags, "the energy is kept to the first order of the step as pairs pass: add (d - r_cut) times the "
                          "slope there, so that the force vanishes");
    }
  }
  return some;
}

/* Constraints with a corner, as y = abs(x). A projection behind the corner gives the velocity after an impact
 * without rebound, or, if a step ends on the corner, an arbitrary one. */
static void warn_of_corners(const Eqns *e) {
  const Model *m = e->m;
  const Constraints *all = &e->constraints;
  for (uint32_t k = 0; k < all->n; k++) {
    if (contact_of_constraint(m, all->of[k])) continue;
    ExprJumps jumps = discontinuities_of(e, all->r[k]);
    for (uint32_t i = 0; i < jumps.n; i++) {
      if (!expr_contains(e->g, jumps.at[i].side, is_of_motion, m)) continue;
      Span place = expr_map_get(&m->written, jumps.at[i].node) ? place_in_text(m, jumps.at[i].node) : all->of[k]->span;
      diag_warning(m->diags, place,
                   "the constraint `%s` has a corner here, and no equation says how a motion passes it",
                   all->of[k]->name);
      diag_help(m->diags, "round it, as sqrt(x^2 + w^2) for abs(x); or use contacts, whose impacts have a law");
    }
  }
}

void discontinuity_warn(const Eqns *e) {
  enum { COORDINATES_MOST = 64 };
  const Model *m = e->m;
  uint32_t n = eqns_coordinates(e);
  VEC(ExprJump) said = {0};
  if (!m->lagrangian) return;
  ExprJumps all = warn_of_cuts(e) ? (ExprJumps){0} : discontinuities_of(e, m->lagrangian);
  for (uint32_t i = 0; i < all.n; i++) {
    if (!expr_contains(e->g, all.at[i].side, is_of_motion, m)) continue;
    diag_warning(m->diags, place_in_text(m, all.at[i].node),
                 "L jumps here, and the equations of motion lack the impulse of the jump");
    diag_help(m->diags, "forces are derivatives on each side of the jump: smooth it, as tanh(x/w) for sign(x), or let "
                        "an event or a contact give the impulse");
    vec_push(m->arena, &said, all.at[i]);
  }
  ExprJumps known = {said.at, said.n};
  for (uint32_t i = 0; i < n && n <= COORDINATES_MOST; i++) warn_of_momentum(e, i, &known);
  if (n <= COORDINATES_MOST) warn_of_corners(e);
}
