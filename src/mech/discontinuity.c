/* Surfaces from the jumps of forces and flows (sym/jump.h), and from divisions by a nonnegative speed that give a direction v/|v|; jumps of L, of
 * momenta, constraints and forces, each as a warning at its place in the text. */
#include "mech/discontinuity.h"

#include <math.h>

#include "mech/constrain.h"
#include "sym/eval.h"
#include "sym/print.h"
#include "sym/prove.h"

ExprJumps discontinuities_of(const Eqns *e, Expr x) {
  const Model *m = e->m;
  ExprGraph *g = e->g;
  if (expr_kinds(g, x) & 1u << SYM_INPUT) {
    Expr *formula = ARENA_ARRAY(m->arena, Expr, expr_symbol_count(g) + 1);
    for (uint32_t i = 0; i < m->inputs.n; i++) formula[m->inputs.at[i].sym] = m->inputs.at[i].value;
    x = expr_substitute(g, x, formula, expr_symbol_count(g) + 1, "");
  }
  return expr_jumps(g, x);
}

/* --- switching surfaces --- */

typedef long double Real;
typedef VEC(SwitchingSurface) SwitchList;

/* Kinds of symbols whose rates jump with a force. Rates of coordinates and time do not jump: a motion crosses a surface of these. */
static const unsigned sudden = 1u << SYM_VEL | 1u << SYM_STATE | 1u << SYM_RATE;

static int is_inside(ExprGraph *g, Expr whole, Expr node) {
  ExprList l = expr_topo(g, &whole, 1);
  uint32_t i = 0;
  while (i < l.n && l.at[i] != node) i++;
  return i < l.n;
}

/* symbols := from, with velocities, states and rates multiplied by `by`. */
static void scale_rates(const Eqns *e, Real *symbols, const Real *from, Real by) {
  for (uint32_t i = 1; i <= expr_symbol_count(e->g); i++)
    symbols[i] = sudden & 1u << expr_symbol(e->g, i)->kind ? by * from[i] : from[i];
}

/* Whether x jumps, as v/|v|, between velocities +dv and -dv as dv goes to 0, and side goes to 0. */
static int turns_at_rest(const Eqns *e, Expr x, Expr side) {
  const Real near[] = {1e-4L, 1e-6L}, alike = 0.02L;
  Expr roots[] = {x, side};
  Real jump[2], above[2], below[2], *state = ARENA_ARRAY(e->m->arena, Real, expr_symbol_count(e->g) + 1);
  Real *symbols = ARENA_ARRAY(e->m->arena, Real, expr_symbol_count(e->g) + 1);
  sample_state(e->g, 1, state);
  for (int i = 0; i < 2; i++) {
    scale_rates(e, symbols, state, near[i]);
    expr_eval(e->g, roots, 2, symbols, above);
    scale_rates(e, symbols, state, -near[i]);
    expr_eval(e->g, roots, 2, symbols, below);
    jump[i] = above[0] - below[0];
  }
  return isfinite(jump[1]) && fabsl(above[1]) < 1e-3L && fabsl(jump[1]) > 1e-9L * (fabsl(above[0]) + fabsl(below[0])) &&
         fabsl(jump[1] - jump[0]) <= alike * fabsl(jump[1]);
}

/* Span of the node in the text; else that of the statement with it. */
static Span place_of(const Eqns *e, Expr node, Expr side, int nonnegative) {
  const Model *m = e->m;
  AstId written = expr_map_get(&m->written, node);
  if (written) return ast_expr(m->ast, written)->span;
  for (uint32_t k = 0; k < m->forces.n; k++)
    if (is_inside(e->g, m->forces.at[k].f, node) || (nonnegative && turns_at_rest(e, m->forces.at[k].f, side))) return m->forces.at[k].span;
  return m->dissipation ? m->dissipation_span : m->lagrangian_span;
}

/* Text of a span, its first line only. */
static const char *text_at(const Eqns *e, Span span) {
  Place p = source_place(e->m->ast->sources, span.begin);
  if (!p.file) return "";
  uint32_t n = p.line_len - p.line_byte, whole = span.end - span.begin;
  return arena_printf(e->m->arena, "%.*s", (int)(whole < n ? whole : n), p.line_text + p.line_byte);
}

/* Adds a surface, once. side: switching function; node: the expression to be found in the text. */
static void add(const Eqns *e, SwitchList *to, Expr node, Expr side, int nonnegative) {
  if (!(expr_kinds(e->g, side) & sudden)) return;
  for (uint32_t i = 0; i < to->n; i++)
    if (to->at[i].side == side) return;
  Span place = place_of(e, node, side, nonnegative);
  StrBuf surface = strbuf(e->m->arena);
  expr_print(e->g, side, PRINT_TEXT, &surface);
  vec_push(e->m->arena, to, ((SwitchingSurface){side, nonnegative, place, text_at(e, place), sb_text(&surface)}));
}

/* Adds surfaces where a direction v/|v| jumps: factors that divide by a nonnegative function of velocities. */
static void add_directions(const Eqns *e, Expr x, SwitchList *to) {
  ExprGraph *g = e->g;
  ExprList nodes = expr_topo(g, &x, 1);
  for (uint32_t k = 0; k < nodes.n; k++) {
    for (uint32_t i = 0; expr_op(g, nodes.at[k]) == EX_PROD && i < expr_pairs(g, nodes.at[k], EX_PROD); i++) {
      Num power;
      Expr base = expr_pair(g, nodes.at[k], EX_PROD, i, &power);
      ExprSign sign = num_sign(power) < 0 && expr_kinds(g, base) & sudden ? expr_sign(g, base) : SIGN_UNKNOWN;
      if (sign != SIGN_NONNEGATIVE && sign != SIGN_POSITIVE) continue;
      Expr side = expr_pow(g, base, expr_num(g, num_neg(power)));
      if (turns_at_rest(e, x, side)) add(e, to, base, side, 1);
    }
  }
}

static void add_from(const Eqns *e, Expr x, SwitchList *to) {
  ExprJumps jumps = discontinuities_of(e, x);
  for (uint32_t i = 0; i < jumps.n; i++)
    if (expr_op(e->g, jumps.at[i].node) != EX_TAN) add(e, to, jumps.at[i].node, jumps.at[i].side, 0);
  add_directions(e, x, to);
}

SwitchingSurfaces switching_surfaces(const Eqns *e) {
  enum { MOST = 64 };
  const Model *m = e->m;
  SwitchList all = {0};
  if (e->n + m->states.n > MOST) return (SwitchingSurfaces){0};
  for (uint32_t i = 0; i < e->n; i++)
    if (expr_kinds(e->g, e->f[i]) & sudden) add_from(e, e->f[i], &all);
  for (uint32_t i = 0; i < m->states.n; i++)
    if (expr_kinds(e->g, e->flow[i]) & sudden) add_from(e, e->flow[i], &all);
  return (SwitchingSurfaces){all.at, all.n};
}

/* --- warnings --- */

/* Symbols of the motion: coordinates, velocities, rates, and states that are coordinates of a model of first order. */
static int is_of_motion(const Symbol *s, const void *model) {
  const Model *m = model;
  return s->kind == SYM_COORD || s->kind == SYM_VEL || s->kind == SYM_RATE || (s->kind == SYM_STATE && m->states.at[s->index].coordinate);
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
    diag_warning(m->diags, place_in_text(m, all.at[k].node), "the momentum of `%s` jumps here, and the equations of motion lack the impulse of the jump",
                 q);
    diag_help(m->diags, "smooth it, or let an event of the same place set the velocity: `event NAME: t - 1 [s] rising { %s' = ... }`", q);
  }
}

/* Constraints with a corner, as y = abs(x). A projection behind the corner gives the velocity after an impact without rebound, or, if a step
 * ends on the corner, an arbitrary one. */
static void warn_of_corners(const Eqns *e) {
  const Model *m = e->m;
  const Constraints *all = &e->constraints;
  for (uint32_t k = 0; k < all->n; k++) {
    if (contact_of_constraint(m, all->of[k])) continue;
    ExprJumps jumps = discontinuities_of(e, all->r[k]);
    for (uint32_t i = 0; i < jumps.n; i++) {
      if (!expr_contains(e->g, jumps.at[i].side, is_of_motion, m)) continue;
      Span place = expr_map_get(&m->written, jumps.at[i].node) ? place_in_text(m, jumps.at[i].node) : all->of[k]->span;
      diag_warning(m->diags, place, "the constraint `%s` has a corner here, and no equation says how a motion passes it", all->of[k]->name);
      diag_help(m->diags, "round it, as sqrt(x^2 + w^2) for abs(x); or use contacts, whose impacts have a law");
    }
  }
}

/* Dry friction and relays: a motion may stick where such a force jumps. */
static void warn_of_switches(const Eqns *e) {
  const Model *m = e->m;
  SwitchingSurfaces all = switching_surfaces(e);
  for (uint32_t i = 0; i < all.n; i++) {
    diag_warning(m->diags, all.at[i].span, "a force jumps where `%s` is 0; a motion that sticks there, as under dry friction, cannot be followed: the run ends where it sticks",
                 all.at[i].surface);
    diag_help(m->diags, "smooth it, as tanh(v/w) for sign(v) with a small velocity w, and take radau; or let an event stop the run there");
  }
}

void discontinuity_warn(const Eqns *e) {
  enum { COORDINATES_MOST = 64 };
  const Model *m = e->m;
  uint32_t n = eqns_coordinates(e);
  VEC(ExprJump) said = {0};
  warn_of_switches(e);
  if (!m->lagrangian) return;
  ExprJumps all = discontinuities_of(e, m->lagrangian);
  for (uint32_t i = 0; i < all.n; i++) {
    if (!expr_contains(e->g, all.at[i].side, is_of_motion, m)) continue;
    diag_warning(m->diags, place_in_text(m, all.at[i].node), "L jumps here, and the equations of motion lack the impulse of the jump");
    diag_help(m->diags, "forces are derivatives on each side of the jump: smooth it, as tanh(x/w) for sign(x), or let an event or a contact give the impulse");
    vec_push(m->arena, &said, all.at[i]);
  }
  ExprJumps known = {said.at, said.n};
  for (uint32_t i = 0; i < n && n <= COORDINATES_MOST; i++) warn_of_momentum(e, i, &known);
  if (n <= COORDINATES_MOST) warn_of_corners(e);
}
