/* H and C by differentiating L and each definition with symbols in the place of definitions; adjoints lambda by a
 * backward sweep. */
#include "mech/augmented_system.h"

#include "sym/diff.h"

typedef struct {
  const Eqns *e;
  ExprGraph *g;
  Arena *arena;
  uint32_t n;              /* number of definitions */
  Expr *def;               /* [n] w_k, arguments before their users */
  Expr *stand_in;          /* [n] symbols in the place of the definitions */
  uint32_t first;          /* index of the first stand-in among the local symbols */
  Expr *cut;               /* [n + 1] W_k, and L last, with stand-ins */
  const Expr *back;        /* by symbol: the definition behind a stand-in */
  uint32_t nback;
  ExprPartials *gradient;  /* [n + 1] derivatives of cut by u */
} Augmentation;

/* Finds the definitions that contain velocities; writes them and L in q', stand-ins and expressions without
 * velocities. */
static void cut_definitions(Augmentation *l) {
  const Eqns *e = l->e;
  Expr lagrangian = e->m->lagrangian;
  ExprList all = expr_topo(l->g, &lagrangian, 1);
  VEC(Expr) defs = {0};
  for (uint32_t i = 0; i < all.n; i++)
    if (expr_op(l->g, all.at[i]) == EX_DEF && expr_kinds(l->g, all.at[i]) & 1u << SYM_VEL)
      vec_push(l->arena, &defs, all.at[i]);
  l->n = defs.n;
  l->def = defs.at;
  if (!l->n) return;
  l->stand_in = ARENA_ARRAY(l->arena, Expr, l->n);
  Expr *body = ARENA_ARRAY(l->arena, Expr, l->n + 1);
  SymId last = 0;
  for (uint32_t k = 0; k < l->n; k++) {
    last = expr_declare(l->g, SYM_LOCAL, l->first + k, expr_def_name(l->g, l->def[k]), SIGN_UNKNOWN);
    l->stand_in[k] = expr_symbol(l->g, last)->node;
    body[k] = expr_arg(l->g, l->def[k], 0);
  }
  body[l->n] = lagrangian;
  Expr *back = ARENA_ARRAY(l->arena, Expr, last + 1);
  for (uint32_t k = 0; k < l->n; k++) back[expr_sym_id(l->g, l->stand_in[k])] = l->def[k];
  l->back = back;
  l->nback = last + 1;
  l->cut = ARENA_ARRAY(l->arena, Expr, l->n + 1);
  expr_replace_nodes(l->g, body, l->n + 1, l->def, l->stand_in, l->n, l->cut);
}

/* Derivatives of x by u = (q', w), indices in u, ascending. */
static ExprPartials by_u(Augmentation *l, Expr x) {
  VEC(ExprPartial) all = {0};
  ExprPartials v = expr_gradient_sparse(l->g, x, SYM_VEL, l->e->n),
               w = expr_gradient_sparse(l->g, x, SYM_LOCAL, l->first + l->n);
  for (uint32_t i = 0; i < v.n; i++) vec_push(l->arena, &all, v.at[i]);
  for (uint32_t i = 0; i < w.n; i++)
    if (w.at[i].index >= l->first)
      vec_push(l->arena, &all, ((ExprPartial){l->e->n + w.at[i].index - l->first, w.at[i].e}));
  return (ExprPartials){all.at, all.n};
}

static Expr without_stand_ins(Augmentation *l, Expr x) { return expr_substitute(l->g, x, l->back, l->nback, ""); }

/* Adjoints lambda_k = dL/dw_k + sum over later definitions m of lambda_m dW_m/dw_k. */
static Expr *multipliers(Augmentation *l) {
  Expr *lambda = ARENA_ARRAY(l->arena, Expr, l->n);
  for (uint32_t k = 0; k < l->n; k++) lambda[k] = expr_int(l->g, 0);
  for (uint32_t m = l->n + 1; m-- > 0;) {
    Expr outer = m == l->n ? expr_int(l->g, 1) : lambda[m];
    for (uint32_t i = 0; i < l->gradient[m].n; i++) {
      const ExprPartial *d = &l->gradient[m].at[i];
      if (d->index < l->e->n) continue;
      Expr slope = without_stand_ins(l, d->e), part = expr_mul(l->g, outer, slope);
      Expr *to = &lambda[d->index - l->e->n];
      *to = expr_add(l->g, *to, part);
    }
  }
  return lambda;
}

/* Lower triangle of H = d2L/du2 + sum lambda_m d2W_m/du2. Definitions linear in u, the usual case, need no lambda. */
static void second_derivatives(Augmentation *l, Entries *H) {
  Expr *lambda = NULL;
  for (uint32_t m = 0; m <= l->n; m++)
    for (uint32_t i = 0; i < l->gradient[m].n; i++) {
      const ExprPartial *d = &l->gradient[m].at[i];
      ExprPartials row = by_u(l, d->e);
      for (uint32_t k = 0; k < row.n && row.at[k].index <= d->index; k++) {
        Expr x = without_stand_ins(l, row.at[k].e);
        if (m < l->n && !lambda) lambda = multipliers(l);
        if (m < l->n) x = expr_mul(l->g, lambda[m], x);
        vec_push(l->arena, H, ((MassEntry){d->index, row.at[k].index, x}));
      }
    }
  entries_collect(l->g, H, NULL);
}

LinearSystem augmented_system(const Eqns *e) {
  Augmentation l = {.e = e, .g = e->g, .arena = e->m->arena};
  for (SymId s = 1; s <= expr_symbol_count(l.g); s++) l.first += expr_symbol(l.g, s)->kind == SYM_LOCAL;
  cut_definitions(&l);
  LinearSystem s = {.n = e->n, .ndefs = l.n, .defs = l.def};
  if (!l.n) return s;
  l.gradient = ARENA_ARRAY(l.arena, ExprPartials, l.n + 1);
  for (uint32_t m = 0; m <= l.n; m++) l.gradient[m] = by_u(&l, l.cut[m]);
  second_derivatives(&l, &s.H);
  for (uint32_t m = 0; m < l.n; m++)
    for (uint32_t i = 0; i < l.gradient[m].n; i++) {
      const ExprPartial *d = &l.gradient[m].at[i];
      vec_push(l.arena, &s.C, ((MassEntry){e->n + m, d->index, without_stand_ins(&l, d->e)}));
    }
  return s;
}
