/* Assembles the report, and carries generators over to the graph of the model with an effect, by names of symbols. */
#include "symmetry/noether_report.h"

#include "symmetry/charges.h"
#include "mech/discontinuity.h"
#include "sym/family_rows.h"
#include "sym/prove.h"
#include "sym/sum_nest.h"

/* --- cyclic coordinates --- */

/* Past this many coordinates those absent from the text of L are cyclic, and those that nothing acts on are decided. */
enum { PROVE_MOST = 20 };

/* x_i -> x_i + s */
static const Generator *shift(const Eqns *e, uint32_t i) {
  Expr *xi = ARENA_ARRAY(e->m->arena, Expr, e->n);
  Generator *by = ARENA_NEW(e->m->arena, Generator);
  xi[i] = expr_int(e->g, 1);
  by->xi = xi;
  return by;
}

/* Values come first: normal forms of what is not 0 may take minutes. */
static int proved_zero(ExprGraph *g, Expr e) { return !prove_nonzero(g, e) && prove_zero(g, e, NULL) == PROVED_ZERO; }

/* Coordinates that L does not contain. */
static Indices noether_cyclic(const Eqns *e) {
  Indices all = {0};
  const int jumps = discontinuities_of(e, e->lagrangian).n > 0;
  for (uint32_t i = 0; i < e->n; i++) {
    int absent = expr_is_zero(e->g, e->dLdq[i]);
    if (!absent && e->n <= PROVE_MOST) absent = proved_zero(e->g, e->dLdq[i]);
    if (absent && !(jumps && noether_moves_jumps(e, shift(e, i)))) vec_push(e->m->arena, &all, i);
  }
  return all;
}

/* Whether p_i is conserved. Where there are many coordinates a force or constraint on them counts as a change. */
static Verdict drift_of_momentum(const Eqns *e, const unsigned char *held, uint32_t i) {
  int pushed = held[i] || !expr_is_zero(e->g, e->Q[i]);
  return !pushed ? PROVED_ZERO : e->n > PROVE_MOST ? NOT_DECIDED : noether_prove(e, shift(e, i)).drift;
}

void show_cyclic(const Eqns *e, const char *before, StrBuf *out) {
  if (e->m->families.n) return; /* contacts change any momentum */
  static const char *const words[] = {
    [PROVED_ZERO] = "is conserved", [PROVED_NONZERO] = "is changed by forces and constraints alone",
    [NOT_DECIDED] = "can be changed by forces and constraints alone"};
  Indices all = noether_cyclic(e);
  StrBuf lines = strbuf(e->m->arena);
  unsigned char *held = ARENA_ARRAY(e->m->arena, unsigned char, e->n + 1); /* by constraints */
  for (uint32_t k = 0; k < e->constraints.A.n; k++) held[e->constraints.A.at[k].col] = 1;
  for (uint32_t k = 0; k < all.n; k++) {
    Name x = e->m->coords.at[all.at[k]].name;
    const char *jumps = discontinuities_of(e, eqns_momenta(e)[all.at[k]]).n ? " between jumps" : "";
    const char *is = words[drift_of_momentum(e, held, all.at[k])];
    sb_printf(&lines, "%scyclic coordinate: %s; L does not contain it, and p_%s %s%s\n", before, x, x, is, jumps);
  }
  sb_puts(out, family_rows(e->m->arena, sb_text(&lines), PRINT_TEXT));
}

/* --- the report --- */

NoetherReport *noether_report(Eqns *e, SearchLimit *limit) {
  NoetherReport *r = ARENA_NEW(e->m->arena, NoetherReport);
  r->e = e;
  r->cyclic = noether_cyclic(e);
  r->found = noether_find(e, limit);
  r->algebra = brackets_find(e, &r->found, limit);
  r->scales = noether_scaling(e, &r->scaling, limit);
  return r;
}

Name noether_declared(const NoetherReport *r, uint32_t k) {
  Expr charge = r->found.all.at[k].is.charge, minus = expr_neg(r->e->g, charge);
  for (uint32_t i = 1; i < r->e->ncharges; i++) {
    Expr declared = r->e->charges[i].proof.charge;
    if (declared == charge || declared == minus) return r->e->charges[i].name;
  }
  return NULL;
}

/* --- generators in the graph of another model --- */

/* The symbol of that name in another model; NULL: there is none. */
static const Symbol *symbol_in(const Eqns *to, const Symbol *s) {
  for (SymId k = 1; k <= expr_symbol_count(to->g); k++) {
    const Symbol *x = expr_symbol(to->g, k);
    if (strcmp(x->name, s->name) == 0 && (x->kind == SYM_LOCAL) == (s->kind == SYM_LOCAL)) return x;
  }
  return NULL;
}

static Expr in_graph(const Eqns *to, ExprGraph *g, Expr x);

/* Replaces expressions of a body by the same in the graph of another model; 0 means none. */
static int body_in(const Eqns *to, ExprGraph *g, Expr *x, uint32_t n) {
  for (uint32_t k = 0; k < n; k++)
    if (x[k] && !(x[k] = in_graph(to, g, x[k]))) return 0;
  return 1;
}

/* A CELL, and its body, in the graph of another model, arguments by `map`. */
static Expr cell_in(const Eqns *to, ExprGraph *g, Expr x, const ExprMap *map) {
  Arena *a = to->m->arena;
  Expr nest = expr_cell_nest(g, x);
  SumNest s = *expr_sum_nest(g, nest);
  Expr *args = ARENA_ARRAY(a, Expr, s.nargs + 1);
  NestRead *reads = ARENA_ARRAY(a, NestRead, s.nreads + 1);
  NestShare *shares = ARENA_ARRAY(a, NestShare, s.nshares + 1);
  NearTest *near = ARENA_NEW(a, NearTest);
  if (s.near) *near = *s.near;
  for (uint32_t k = 0; k < s.nargs; k++) args[k] = expr_map_get(map, expr_sum_arg(g, nest, k));
  for (uint32_t k = 0; k < s.nreads; k++) {
    const Symbol *same = symbol_in(to, expr_symbol(g, s.reads[k].symbol));
    if (!same) return 0;
    reads[k] = s.reads[k];
    reads[k].symbol = expr_sym_id(to->g, same->node);
  }
  for (uint32_t k = 0; k < s.nshares; k++) {
    shares[k] = s.shares[k];
    if (!body_in(to, g, &shares[k].value, 1)) return 0;
  }
  if (!body_in(to, g, &near->test, 1) || !body_in(to, g, &near->cut, 1) || !body_in(to, g, near->at_i, 3) ||
      !body_in(to, g, near->at_j, 3) || !body_in(to, g, near->side, 3))
    return 0;
  s.reads = reads, s.shares = shares, s.near = s.near ? near : NULL, s.far = NULL, s.slopes = NULL;
  return expr_sum_cell(to->g, &s, args, expr_cell_number(g, x));
}

/* Node x in the graph of another model, arguments by `map`, definitions expanded. 0: a symbol is missing. */
static Expr node_in(const Eqns *to, ExprGraph *g, Expr x, const ExprMap *map) {
  ExprGraph *other = to->g;
  ExprOp op = expr_op(g, x);
  if (op == EX_NUM) return expr_num(other, expr_number(g, x));
  if (op == EX_NEST) return 0; /* its cells are carried over */
  if (op == EX_CELL) return cell_in(to, g, x, map);
  if (op == EX_SYM) {
    const Symbol *same = symbol_in(to, expr_sym_of(g, x));
    return same ? same->node : 0;
  }
  if (op == EX_SUM || op == EX_PROD) {
    Expr all = expr_int(other, op == EX_PROD);
    for (ExprPair pair = {0}; expr_next_pair(g, x, op, &pair);) {
      Expr part = expr_map_get(map, pair.of);
      if (!part) return 0;
      part = op == EX_SUM ? expr_scale(other, pair.num, part) : expr_pow_num(other, part, pair.num);
      all = op == EX_SUM ? expr_add(other, all, part) : expr_mul(other, all, part);
    }
    return all;
  }
  Expr arg[3] = {0};
  for (uint32_t i = 0; i < expr_nargs(g, x); i++)
    if (!(arg[i] = expr_map_get(map, expr_arg(g, x, i)))) return 0;
  if (op == EX_DEF) return arg[0];
  return op == EX_SELECT ? expr_select(other, arg[0], arg[1], arg[2]) : op == EX_POW ? expr_pow(other, arg[0], arg[1])
         : arg[1] ? expr_fn2(other, op, arg[0], arg[1]) : expr_fn(other, op, arg[0]);
}

static Expr in_graph(const Eqns *to, ExprGraph *g, Expr x) {
  ExprMap map = expr_map(to->m->arena);
  ExprList all = expr_topo(g, &x, 1);
  for (uint32_t i = 0; i < all.n; i++) {
    Expr same = node_in(to, g, all.at[i], &map);
    if (same) expr_map_set(&map, all.at[i], same);
  }
  return expr_map_get(&map, x);
}

/* The same generator for another model, whose further coordinates stay fixed. 0: a name is missing there. */
static int generator_in(const Eqns *to, const Eqns *from, const Generator *by, Generator *same) {
  uint32_t n = eqns_coordinates(to), placed = 0;
  Expr *xi = ARENA_ARRAY(to->m->arena, Expr, n + 1);
  for (uint32_t i = 0; i < n; i++)
    for (uint32_t k = 0; k < eqns_coordinates(from); k++) {
      Name here = expr_symbol(to->g, eqns_coordinate(to, i))->name,
           there = expr_symbol(from->g, eqns_coordinate(from, k))->name;
      if (strcmp(here, there) != 0) continue;
      if (!(xi[i] = in_graph(to, from->g, by->xi[k]))) return 0;
      placed++;
    }
  *same = (Generator){.xi = xi, .tau = in_graph(to, from->g, by->tau)};
  return same->tau && placed == eqns_coordinates(from);
}

void noether_report_effect(NoetherReport *r, Name effect, const Eqns *with) {
  Noether *is = ARENA_ARRAY(r->e->m->arena, Noether, r->found.all.n + 1);
  for (uint32_t k = 0; k < r->found.all.n; k++) {
    Generator same;
    if (generator_in(with, r->e, &r->found.all.at[k].by, &same)) is[k] = noether_prove(with, &same);
  }
  vec_push(r->e->m->arena, &r->effects, ((EffectVerdict){effect, with, is}));
}

int noether_same_charge(const NoetherReport *r, const EffectVerdict *v, uint32_t k) {
  Expr before = in_graph(v->e, r->e->g, r->found.all.at[k].is.charge);
  return before && prove_zero(v->e->g, expr_sub(v->e->g, before, v->is[k].charge), NULL) != PROVED_NONZERO;
}

static void add_condition(const Eqns *e, Conditions *to, Expr base) {
  ExprSign sign = expr_sign(e->g, base);
  int constant = expr_is_constant(e->g, base);
  if (!constant || sign_is_nonnegative(sign)) return;
  for (uint32_t i = 0; i < to->n; i++)
    if (to->at[i] == base) return;
  vec_push(e->m->arena, to, base);
}

Conditions noether_conditions(const NoetherReport *r, uint32_t k) {
  const Eqns *e = r->e;
  const FoundSymmetry *s = &r->found.all.at[k];
  uint32_t n = eqns_coordinates(e);
  Conditions all = {0};
  Expr *roots = ARENA_ARRAY(e->m->arena, Expr, n + 3);
  for (uint32_t i = 0; i < n; i++) roots[i] = s->by.xi[i];
  roots[n] = s->by.tau, roots[n + 1] = s->is.charge, roots[n + 2] = s->is.F;
  ExprList nodes = expr_topo(e->g, roots, n + 3);
  for (uint32_t i = 0; i < nodes.n; i++)
    for (uint32_t j = 0; expr_op(e->g, nodes.at[i]) == EX_PROD && j < expr_pairs(e->g, nodes.at[i], EX_PROD); j++) {
      Num power;
      Expr base = expr_pair(e->g, nodes.at[i], EX_PROD, j, &power);
      if (power.den % 2 == 0) add_condition(e, &all, base);
    }
  return all;
}
