/* Eqns -> the partial derivatives of the equations of motion: a row of residuals at a time, each in reverse
 * over its own graph, so that the work follows what is not zero. */
#include "mech/lagrange.h"
#include "sym/diff.h"

typedef VEC(Expr) Terms;

/* f_i - sum_j M_ij q_j'' for each coordinate i, then the flows. */
static Expr *residuals(const Eqns *e) {
  const Model *m = e->m;
  Arena *arena = m->arena;
  ExprGraph *g = e->g;
  Terms *terms = ARENA_ARRAY(arena, Terms, e->n + 1);
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *M = &e->mass.at[k];
    Expr at_row = expr_mul(g, M->e, expr_symbol(g, m->coords.at[M->col].a)->node);
    vec_push(arena, &terms[M->row], at_row);
    if (M->row == M->col) continue;
    Expr at_col = expr_mul(g, M->e, expr_symbol(g, m->coords.at[M->row].a)->node);
    vec_push(arena, &terms[M->col], at_col);
  }
  Expr *r = ARENA_ARRAY(arena, Expr, e->n + m->states.n + 1);
  for (uint32_t i = 0; i < e->n; i++) {
    Expr inertia = expr_add_n(g, terms[i].at, terms[i].n);
    r[i] = expr_sub(g, e->f[i], inertia);
  }
  for (uint32_t k = 0; k < m->states.n; k++) r[e->n + k] = e->flow[k];
  return r;
}

Partials eqns_linearise(Eqns *e) {
  const Model *m = e->m;
  eqns_derive_mass(e);
  VEC(Partial) found = {0};
  VEC(Expr) entries = {0};
  const Expr *r = residuals(e);
  const struct {
    SymKind kind;
    uint32_t n, first; /* first column */
  } blocks[] = {{SYM_COORD, e->n, 0}, {SYM_VEL, e->n, e->n}, {SYM_STATE, m->states.n, 2 * e->n}};
  for (uint32_t i = 0; i < e->n + m->states.n; i++)
    for (int b = 0; b < 3; b++) {
      ExprPartials d = expr_gradient_sparse(e->g, r[i], blocks[b].kind, blocks[b].n);
      for (uint32_t k = 0; k < d.n; k++) {
        vec_push(m->arena, &found, ((Partial){i, blocks[b].first + d.at[k].index, d.at[k].e}));
        vec_push(m->arena, &entries, d.at[k].e);
      }
    }
  const Expr *best = lagrange_short_forms(e, entries.at, entries.n);
  uint32_t n = 0;
  for (uint32_t k = 0; k < found.n; k++) {
    if (expr_is_zero(e->g, best[k])) continue;
    found.at[n] = found.at[k];
    found.at[n++].e = best[k];
  }
  return (Partials){found.at, n};
}
