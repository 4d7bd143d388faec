/* Each entry alone; where a common denominator of several roots would be too long, their radicands lose t first. */
#include "mech/idle_time.h"

#include "sym/simplify.h"

enum { COORDINATES_MOST = 64 };

static int has_time(const Eqns *e, Expr x) { return (expr_kinds(e->g, x) & 1u << SYM_TIME) != 0; }

typedef struct {
  VEC(Expr) of, without; /* a base, and its form without t */
  VEC(SymId) symbol;     /* stands for it */
  VEC(Expr) node;
} Bases;

static void add_base(const Eqns *e, Expr base, Bases *to) {
  for (uint32_t i = 0; i < to->of.n; i++)
    if (to->of.at[i] == base) return;
  Expr other = simplify(e->g, base);
  if (has_time(e, other)) return;
  SymId s = expr_declare(e->g, SYM_LOCAL, 0, intern(e->m->ast->names, "?"), expr_sign(e->g, base));
  vec_push(e->m->arena, &to->of, base);
  vec_push(e->m->arena, &to->without, other);
  vec_push(e->m->arena, &to->symbol, s);
  vec_push(e->m->arena, &to->node, expr_symbol(e->g, s)->node);
}

/* Sums with t in x that stand in denominators or under roots. */
static Bases bases_in(const Eqns *e, Expr x) {
  ExprGraph *g = e->g;
  Bases all = {0};
  ExprList nodes = expr_topo(g, &x, 1);
  for (uint32_t i = 0; i < nodes.n; i++)
    for (uint32_t k = 0; expr_op(g, nodes.at[i]) == EX_PROD && k < expr_pairs(g, nodes.at[i], EX_PROD); k++) {
      Num power;
      Expr base = expr_pair(g, nodes.at[i], EX_PROD, k, &power);
      int whole = num_is_int(power) && num_sign(power) > 0;
      if (expr_op(g, base) == EX_SUM && has_time(e, base) && !whole) add_base(e, base, &all);
    }
  return all;
}

static Expr without_time(const Eqns *e, Expr x) {
  if (!x || !has_time(e, x)) return x;
  Expr other = simplify(e->g, x), open = expr_expand_defs(e->g, x);
  if (!has_time(e, other)) return other;
  Bases all = bases_in(e, open);
  if (!all.of.n) return x;
  expr_replace_nodes(e->g, &open, 1, all.of.at, all.node.at, all.of.n, &other);
  other = expr_replace(e->g, simplify(e->g, other), all.symbol.at, all.without.at, all.symbol.n);
  return has_time(e, other) ? x : other;
}

static void drop_from(const Eqns *e, Entries *x) {
  for (uint32_t k = 0; k < x->n; k++) x->at[k].e = without_time(e, x->at[k].e);
}

static const Expr *dropped(const Eqns *e, const Expr *x, uint32_t n) {
  Expr *out = ARENA_ARRAY(e->m->arena, Expr, n + 1);
  for (uint32_t i = 0; i < n; i++) out[i] = without_time(e, x[i]);
  return out;
}

void drop_idle_time(Eqns *e) {
  Constraints *c = &e->constraints;
  uint32_t flows = e->m->states.n;
  int left = 0;
  if (e->n + flows > COORDINATES_MOST) return;
  drop_from(e, &e->mass);
  drop_from(e, &e->system.H);
  drop_from(e, &e->system.C);
  drop_from(e, &c->A);
  e->f = dropped(e, e->f, e->n);
  e->system.f = dropped(e, e->system.f, e->n);
  e->flow = dropped(e, e->flow, flows);
  c->c = dropped(e, c->c, c->nkept);
  c->r = dropped(e, c->r, c->n);
  c->demand = dropped(e, c->demand, c->n);
  for (uint32_t i = 0; i < e->n; i++) left |= has_time(e, e->f[i]);
  for (uint32_t i = 0; i < flows; i++) left |= has_time(e, e->flow[i]);
  for (uint32_t k = 0; k < e->mass.n; k++) left |= has_time(e, e->mass.at[k].e);
  if (!left) e->lagrangian = without_time(e, e->lagrangian);
}
