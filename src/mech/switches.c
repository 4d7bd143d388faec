/* Switching functions from the nodes of the equations; jumps of forces and flows from sym/jump.h, and divisions by a
 * nonnegative speed that give a direction v/|v|. */
#include "mech/switches.h"

#include <math.h>

#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/jump.h"
#include "sym/print.h"
#include "sym/prove.h"

/* --- jumps with velocities and states --- */

typedef long double Real;
typedef VEC(Switch) SwitchList;
typedef VEC(Expr) ExprVec;

/* Kinds of symbols whose rates jump with a force. Rates of coordinates and time do not jump: a motion crosses a
 * surface of these. */
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
    if (is_inside(e->g, m->forces.at[k].f, node) || (nonnegative && turns_at_rest(e, m->forces.at[k].f, side)))
      return m->forces.at[k].span;
  for (uint32_t k = 0; k < m->states.n; k++)
    if (m->states.at[k].flow && is_inside(e->g, m->states.at[k].flow, node)) return m->states.at[k].flow_span;
  return m->dissipation ? m->dissipation_span : m->lagrangian_span;
}

/* Text of a span, its first line only. */
static const char *text_at(const Eqns *e, Span span) {
  Place p = source_place(e->m->ast->sources, span.begin);
  if (!p.file) return "";
  uint32_t n = p.line_len - p.line_byte, whole = span.end - span.begin;
  return arena_printf(e->m->arena, "%.*s", (int)(whole < n ? whole : n), p.line_text + p.line_byte);
}

/* Index of the switch of `side`, or of its negative (*sign := -1), not for floor; n: none. */
static uint32_t find(ExprGraph *g, const Switch *at, uint32_t n, Expr side, int is_floor, int *sign) {
  uint32_t i = 0;
  Expr other = is_floor ? side : expr_neg(g, side);
  while (i < n && !((at[i].side == side || at[i].side == other) && (at[i].kind == SWITCH_FLOOR) == is_floor)) i++;
  *sign = i < n && at[i].side != side ? -1 : 1;
  return i;
}

/* The static limit of a friction whose velocity is `side`, or its negative; 0: it has none. */
static Expr grip_of(const Eqns *e, Expr side) {
  Expr other = expr_neg(e->g, side), ratio = 0;
  for (uint32_t i = 0; i < e->m->grips.n; i++)
    if (e->m->grips.at[i].velocity == side || e->m->grips.at[i].velocity == other) ratio = e->m->grips.at[i].ratio;
  return ratio;
}

/* Adds a switch, once. node: the expression to be found in the text. */
static void add(const Eqns *e, SwitchList *to, Expr node, Expr side, SwitchKind kind, int jumps) {
  int sign;
  if (find(e->g, to->at, to->n, side, kind == SWITCH_FLOOR, &sign) < to->n) return;
  Span place = place_of(e, node, side, kind == SWITCH_SPEED);
  vec_push(e->m->arena, to, ((Switch){side, kind, jumps, grip_of(e, side), place, text_at(e, place),
                                      expr_text(e->g, side)}));
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
      if (turns_at_rest(e, x, side)) add(e, to, base, side, SWITCH_SPEED, 1);
    }
  }
}

static void add_from(const Eqns *e, Expr x, SwitchList *to) {
  ExprJumps jumps = expr_jumps(e->g, x); /* formulas of inputs jump in time */
  for (uint32_t i = 0; i < jumps.n; i++) {
    ExprOp op = expr_op(e->g, jumps.at[i].node);
    if (op != EX_TAN && op != EX_FLOOR && expr_kinds(e->g, jumps.at[i].side) & sudden)
      add(e, to, jumps.at[i].node, jumps.at[i].side, SWITCH_SIDE, 1);
  }
  add_directions(e, x, to);
}

/* Whether the model has too many equations for a search for their jumps in numbers. */
static int is_large(const Eqns *e) {
  enum { MOST = 64 };
  return e->n + e->m->states.n > MOST;
}

/* Surfaces at which forces or flows jump with velocities or states. */
static SwitchList sudden_jumps(const Eqns *e) {
  const Model *m = e->m;
  SwitchList all = {0};
  if (is_large(e)) return all;
  for (uint32_t i = 0; i < e->n; i++)
    if (expr_kinds(e->g, e->f[i]) & sudden) add_from(e, e->f[i], &all);
  for (uint32_t i = 0; i < m->states.n; i++)
    if (expr_kinds(e->g, e->flow[i]) & sudden) add_from(e, e->flow[i], &all);
  return all;
}

/* --- switches of the equations --- */

static void add_entries(const Eqns *e, const Entries *from, ExprVec *to) {
  for (uint32_t i = 0; i < from->n; i++) vec_push(e->m->arena, to, from->at[i].e);
}

/* All nodes from which the program of the accelerations is made. */
static ExprList nodes_of(const Eqns *e) {
  Arena *a = e->m->arena;
  ExprVec roots = {0};
  for (uint32_t i = 0; i < e->n; i++) vec_push(a, &roots, e->system.f[i]);
  add_entries(e, &e->system.H, &roots);
  add_entries(e, &e->system.C, &roots);
  for (uint32_t i = 0; i < e->squares.n; i++) vec_push(a, &roots, e->squares.weight[i]);
  for (uint32_t i = 0; i < e->squares.n * e->n; i++)
    if (e->squares.W[i]) vec_push(a, &roots, e->squares.W[i]);
  for (uint32_t i = 0; i < e->m->states.n; i++) vec_push(a, &roots, e->flow[i]);
  return expr_topo(e->g, roots.at, roots.n);
}

/* Whether x contains an input without a rate. */
static int has_rateless_input(const Eqns *e, Expr x) {
  if (!(expr_kinds(e->g, x) & 1u << SYM_INPUT)) return 0;
  ExprList l = expr_topo(e->g, &x, 1);
  for (uint32_t i = 0; i < l.n; i++) {
    const Symbol *s = expr_op(e->g, l.at[i]) == EX_SYM ? expr_sym_of(e->g, l.at[i]) : NULL;
    if (s && s->kind == SYM_INPUT && (s->index >= e->m->inputs.n || !e->m->inputs.at[s->index].rate)) return 1;
  }
  return 0;
}

/* Switching function of a node; 0: it has none that a run can follow. */
static Expr side_of(const Eqns *e, Expr node) {
  const unsigned varying = sudden | 1u << SYM_TIME | 1u << SYM_COORD,
                 unknown = 1u << SYM_MULTIPLIER | 1u << SYM_ACC;
  ExprOp op = expr_op(e->g, node);
  Expr side = 0;
  if (op == EX_SIGN || op == EX_ABS || op == EX_FLOOR) side = expr_arg(e->g, node, 0);
  if (op == EX_MIN || op == EX_MAX || op == EX_LT || op == EX_LE)
    side = expr_sub(e->g, expr_arg(e->g, node, 1), expr_arg(e->g, node, 0));
  unsigned kinds = side ? expr_kinds(e->g, side) : 0;
  return kinds & varying && !(kinds & unknown) && !has_rateless_input(e, side) ? side : 0;
}

/* Whether factor i of a product is a root of what may be negative. */
static int is_root(ExprGraph *g, Expr product, uint32_t i) {
  Num power;
  Expr base = expr_pair(g, product, EX_PROD, i, &power);
  int root = !num_is_exact(power) || (power.den != 1 && power.den != 3);
  return root && !sign_is_nonnegative(expr_sign(g, base));
}

/* Whether a node has values for some arguments only: a root, a logarithm. */
static int is_partial(ExprGraph *g, Expr node) {
  ExprOp op = expr_op(g, node);
  if (op == EX_POW || op == EX_LOG || op == EX_ASIN || op == EX_ACOS) return !expr_is_constant(g, node);
  for (uint32_t i = 0; op == EX_PROD && i < expr_pairs(g, node, EX_PROD); i++)
    if (is_root(g, node, i)) return 1;
  return 0;
}

static int is_partial_below(ExprGraph *g, Expr root) {
  ExprList l = expr_topo(g, &root, 1);
  for (uint32_t i = 0; i < l.n; i++)
    if (is_partial(g, l.at[i])) return 1;
  return 0;
}

static void mark_below(ExprGraph *g, Expr root, ExprMap *to) {
  ExprList l = expr_topo(g, &root, 1);
  for (uint32_t i = 0; i < l.n; i++) expr_map_set(to, l.at[i], 1);
}

/* Marks the arguments for which a partial node may have no value: of a product those of its roots. */
static void mark_arguments(ExprGraph *g, Expr node, ExprMap *to) {
  Num power;
  if (expr_op(g, node) != EX_PROD) mark_below(g, node, to);
  for (uint32_t i = 0; expr_op(g, node) == EX_PROD && i < expr_pairs(g, node, EX_PROD); i++)
    if (is_root(g, node, i)) mark_below(g, expr_pair(g, node, EX_PROD, i, &power), to);
}

/* Nodes that no run may hold on a branch, as it may have no value past the surface: those inside roots and
 * logarithms, and choices between such values, as if(x < 0, (-x)^1.5, 0). */
static const ExprMap *nodes_by_text(const Eqns *e, ExprList nodes) {
  ExprGraph *g = e->g;
  ExprMap *to = ARENA_NEW(e->m->arena, ExprMap);
  *to = expr_map(e->m->arena);
  for (uint32_t i = 0; i < nodes.n; i++) {
    Expr node = nodes.at[i];
    ExprOp op = expr_op(g, node);
    uint32_t choice = op == EX_SELECT;
    if (is_partial(g, node)) mark_arguments(g, node, to);
    if (!choice && op != EX_MIN && op != EX_MAX) continue;
    if (!is_partial_below(g, expr_arg(g, node, choice)) && !is_partial_below(g, expr_arg(g, node, choice + 1)))
      continue;
    expr_map_set(to, node, 1);
    if (choice) mark_below(g, expr_arg(g, node, 0), to);
  }
  return to;
}

void switches_find(Eqns *e) {
  enum { MOST = 256 };
  SwitchList all = {0}, jumps = sudden_jumps(e);
  ExprList nodes = nodes_of(e);
  const ExprMap *by_text = nodes_by_text(e, nodes);
  int sign;
  for (uint32_t i = 0; i < nodes.n; i++) {
    Expr side = expr_map_get(by_text, nodes.at[i]) ? 0 : side_of(e, nodes.at[i]);
    if (!side) continue;
    int is_floor = expr_op(e->g, nodes.at[i]) == EX_FLOOR;
    uint32_t k = find(e->g, jumps.at, jumps.n, side, 0, &sign);
    int found = k < jumps.n && jumps.at[k].kind == SWITCH_SIDE,
        may_jump = is_large(e) && expr_kinds(e->g, side) & sudden && expr_op(e->g, nodes.at[i]) == EX_SIGN;
    add(e, &all, nodes.at[i], side, is_floor ? SWITCH_FLOOR : SWITCH_SIDE, !is_floor && (found || may_jump));
  }
  if (all.n > MOST) all.n = 0;
  uint32_t nmodes = all.n;
  for (uint32_t i = 0; i < jumps.n; i++) /* those that no run follows */
    if (find(e->g, all.at, nmodes, jumps.at[i].side, 0, &sign) == nmodes) vec_push(e->m->arena, &all, jumps.at[i]);
  e->switches = (Switches){all.at, by_text, all.n, nmodes};
}

const Switch *switch_of(const Eqns *e, Expr side, int is_floor, int *sign) {
  uint32_t i = find(e->g, e->switches.at, e->switches.nmodes, side, is_floor, sign);
  return i < e->switches.nmodes ? &e->switches.at[i] : NULL;
}

Expr switches_keep(const Eqns *e, Expr x, Expr (*rewrite)(ExprGraph *g, Expr x)) {
  ExprGraph *g = e->g;
  ExprVec nodes = {0}, names = {0};
  VEC(SymId) symbols = {0};
  ExprList all = expr_topo(g, &x, 1), known = {0};
  ExprMap equations = expr_map(e->m->arena);
  for (uint32_t i = 0; i < all.n; i++) {
    if (!side_of(e, all.at[i])) continue;
    if (!known.n) known = nodes_of(e);
    for (uint32_t k = 0; k < known.n && !nodes.n; k++) expr_map_set(&equations, known.at[k], 1);
    if (!expr_map_get(&equations, all.at[i])) continue;
    SymId s = expr_declare(g, SYM_LOCAL, 0, arena_printf(e->m->arena, "held_%u", all.at[i]), expr_sign(g, all.at[i]));
    vec_push(e->m->arena, &nodes, all.at[i]);
    vec_push(e->m->arena, &symbols, s);
    vec_push(e->m->arena, &names, expr_symbol(g, s)->node);
  }
  if (!nodes.n) return rewrite(g, x);
  expr_replace_nodes(g, &x, 1, nodes.at, names.at, nodes.n, &x);
  return expr_replace(g, rewrite(g, x), symbols.at, nodes.at, nodes.n);
}

const Expr *switch_rates(const Eqns *e) {
  const Model *m = e->m;
  uint32_t n = e->switches.nmodes, nseed = expr_symbol_count(e->g) + 1;
  Expr *seed = ARENA_ARRAY(m->arena, Expr, nseed), *sides = ARENA_ARRAY(m->arena, Expr, n + 1),
       *rates = ARENA_ARRAY(m->arena, Expr, n + 1);
  model_seed_time(m, seed);
  for (uint32_t i = 0; i < m->coords.n; i++) {
    seed[m->coords.at[i].q] = expr_symbol(e->g, m->coords.at[i].v)->node;
    seed[m->coords.at[i].v] = expr_symbol(e->g, m->coords.at[i].a)->node;
  }
  for (uint32_t i = 0; i < m->states.n; i++) seed[m->states.at[i].z] = expr_symbol(e->g, m->states.at[i].rate)->node;
  for (uint32_t i = 0; i < n; i++) sides[i] = e->switches.at[i].side;
  expr_tangent(e->g, sides, n, (ExprSeeds){.at = seed, .n = nseed}, "'", NULL, rates);
  return rates;
}

/* Power of the friction of contacts that slip. */
static Expr contact_friction_power(const Eqns *e) {
  ExprGraph *g = e->g;
  Expr power = expr_int(g, 0);
  for (uint32_t i = 0; i < e->m->contacts.n; i++) {
    const Contact *c = &e->m->contacts.at[i];
    if (!c->is_tangent) continue;
    Expr moved = expr_sub(g, c->gap, eqns_at_rest(e, c->gap)),
         part = expr_mul(g, expr_symbol(g, c->force)->node, moved);
    power = expr_add(g, power, part);
  }
  return power;
}

Expr switch_power(const Eqns *e) {
  ExprGraph *g = e->g;
  Arena *a = e->m->arena;
  ExprVec signs = {0}, zeros = {0};
  uint32_t n = e->Q ? eqns_coordinates(e) : 0;
  Expr power = contact_friction_power(e), *smooth = ARENA_ARRAY(a, Expr, n + 1);
  int sign;
  ExprList nodes = expr_topo(g, e->Q, e->switches.nmodes ? n : 0);
  for (uint32_t i = 0; i < nodes.n; i++) {
    const Switch *s = expr_op(g, nodes.at[i]) == EX_SIGN ? switch_of(e, expr_arg(g, nodes.at[i], 0), 0, &sign) : NULL;
    if (!s || !s->jumps) continue;
    vec_push(a, &signs, nodes.at[i]);
    vec_push(a, &zeros, expr_int(g, 0));
  }
  if (!signs.n) return power;
  expr_replace_nodes(g, e->Q, n, signs.at, zeros.at, signs.n, smooth);
  for (uint32_t i = 0; i < n; i++) {
    Expr dry = expr_sub(g, e->Q[i], smooth[i]),
         v = e->n ? expr_symbol(g, e->m->coords.at[i].v)->node : e->flow[e->first.at[i]], part = expr_mul(g, dry, v);
    power = expr_add(g, power, part);
  }
  return power;
}

/* --- messages --- */

static const char *value_at(const Switch *s) { return s->kind == SWITCH_FLOOR ? "a whole number" : "0"; }

void switches_warn(const Eqns *e) {
  const Switches *all = &e->switches;
  for (uint32_t i = all->nmodes; i < all->n; i++) {
    diag_warning(e->m->diags, all->at[i].span,
                 "a force jumps where `%s` is %s; a motion that sticks there, as under dry friction, cannot be "
                 "followed: the run ends where it sticks",
                 all->at[i].surface, value_at(&all->at[i]));
    diag_help(e->m->diags, "smooth it, as tanh(v/w) for sign(v) with a small velocity w, and take radau; or let an "
                           "event stop the run there");
  }
}

void switches_show(const Eqns *e, StrBuf *out) {
  enum { MOST = 8 };
  const Switches *all = &e->switches;
  for (uint32_t i = 0; i < all->nmodes && i < MOST; i++) {
    Place place = source_place(e->m->ast->sources, all->at[i].span.begin);
    sb_printf(out, "switching surface: `%s` = %s (line %u)%s\n", all->at[i].surface, value_at(&all->at[i]), place.line,
              all->at[i].jumps ? ", where a motion may stick" : "");
  }
  if (all->nmodes > MOST) sb_printf(out, "switching surfaces: %u more\n", all->nmodes - MOST);
}
