/* Eqns -> partial derivatives of the equations of motion: reverse mode over the graph of each residual, so that the work
 * follows the nonzero entries. M q'' in two forms, entries in three; the fewest operations win. */
#include "mech/linearise.h"

#include "mech/lagrange.h"
#include "sym/diff.h"
#include "sym/simplify.h"

typedef VEC(Partial) PartialList;

/* --- the residuals f - M q'' --- */

/* M q'' from the entries of M. */
static Expr *inertia_of_mass(const Eqns *e) {
  const Model *m = e->m;
  Arena *arena = m->arena;
  ExprGraph *g = e->g;
  typedef VEC(Expr) Terms;
  Terms *terms = ARENA_ARRAY(arena, Terms, e->n + 1);
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *M = &e->mass.at[k];
    Expr at_row = expr_mul(g, M->e, expr_symbol(g, m->coords.at[M->col].a)->node);
    vec_push(arena, &terms[M->row], at_row);
    if (M->row == M->col) continue;
    Expr at_col = expr_mul(g, M->e, expr_symbol(g, m->coords.at[M->row].a)->node);
    vec_push(arena, &terms[M->col], at_col);
  }
  Expr *inertia = ARENA_ARRAY(arena, Expr, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++) inertia[i] = expr_add_n(g, terms[i].at, terms[i].n);
  return inertia;
}

/* M q'' as the directional derivative of p along q' += q'': as long as the text of L, even where M is full. */
static Expr *inertia_of_momenta(const Eqns *e) {
  const Model *m = e->m;
  Expr *seed = ARENA_ARRAY(m->arena, Expr, expr_symbol_count(e->g) + 1), *inertia = ARENA_ARRAY(m->arena, Expr, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++) seed[m->coords.at[i].v] = expr_symbol(e->g, m->coords.at[i].a)->node;
  expr_tangent(e->g, e->p, e->n, seed, expr_symbol_count(e->g) + 1, "_inertia", NULL, inertia);
  return inertia;
}

/* --- their derivatives --- */

static PartialList differentiate(const Eqns *e, const Expr *inertia) {
  const Model *m = e->m;
  PartialList found = {0};
  const struct {
    SymKind kind;
    uint32_t n, first; /* first column */
  } blocks[] = {{SYM_COORD, e->n, 0}, {SYM_VEL, e->n, e->n}, {SYM_STATE, m->states.n, 2 * e->n}};
  for (uint32_t i = 0; i < e->n + m->states.n; i++) {
    Expr r = i < e->n ? expr_sub(e->g, e->f[i], inertia[i]) : e->flow[i - e->n];
    for (int b = 0; b < 3; b++) {
      ExprPartials d = expr_gradient_sparse(e->g, r, blocks[b].kind, blocks[b].n);
      for (uint32_t k = 0; k < d.n; k++) vec_push(m->arena, &found, ((Partial){i, blocks[b].first + d.at[k].index, d.at[k].e}));
    }
  }
  return found;
}

/* Replaces *best by the list with its entries rewritten (rule NULL: as they are) if M and list together take fewer operations. */
static void try_form(const Eqns *e, const PartialList *from, Expr (*rule)(ExprGraph *, Expr), PartialList *best, uint64_t *ops) {
  PartialList to = {0};
  VEC(Expr) roots = {0};
  for (uint32_t k = 0; k < from->n; k++) {
    Partial x = from->at[k];
    if (rule) x.e = rule(e->g, x.e);
    if (expr_is_zero(e->g, x.e)) continue;
    vec_push(e->m->arena, &to, x);
    vec_push(e->m->arena, &roots, x.e);
  }
  for (uint32_t k = 0; k < e->mass.n; k++) vec_push(e->m->arena, &roots, e->mass.at[k].e); /* M is evaluated, too */
  uint64_t mine = expr_ops(e->g, roots.at, roots.n);
  if (mine >= *ops) return;
  *best = to;
  *ops = mine;
}

Partials eqns_linearise(Eqns *e) {
  enum { SIMPLIFY_MAX_ENTRIES = 300 };
  PartialList best = {0};
  uint64_t ops = UINT64_MAX;
  eqns_derive_mass(e);
  for (int by_momenta = 0; by_momenta <= 1; by_momenta++) {
    PartialList raw = differentiate(e, by_momenta ? inertia_of_momenta(e) : inertia_of_mass(e));
    if (raw.n <= SIMPLIFY_MAX_ENTRIES) {
      try_form(e, &raw, simplify, &best, &ops);
      try_form(e, &raw, simplify_shallow, &best, &ops);
    }
    try_form(e, &raw, NULL, &best, &ops);
  }
  return (Partials){best.at, best.n};
}
