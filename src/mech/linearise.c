/* Eqns -> partial derivatives of the equations of motion: reverse mode over the graph of each residual, so that the
 * work follows the nonzero entries. M q'' in two forms, entries in three; the fewest operations win. */
#include "mech/linearise.h"

#include <string.h>

#include "mech/lagrange.h"
#include "sym/simplify.h"

typedef VEC(Partial) PartialList;

/* --- the residuals f - M q'', and demand - A q'' of constraints --- */

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
  Expr *seed = ARENA_ARRAY(m->arena, Expr, expr_symbol_count(e->g) + 1),
       *inertia = ARENA_ARRAY(m->arena, Expr, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++) seed[m->coords.at[i].v] = expr_symbol(e->g, m->coords.at[i].a)->node;
  expr_tangent(e->g, e->p, e->n, (ExprSeeds){.at = seed, .n = expr_symbol_count(e->g) + 1}, "_inertia", NULL, inertia);
  return inertia;
}

/* --- their derivatives --- */

/* Derivatives of x by inputs, or by parameters, columns ascending. */
static ExprPartials by_others(const Eqns *e, Expr x, PartialsBy by) {
  const Model *m = e->m;
  VEC(ExprPartial) all = {0};
  ExprPartials d = by == BY_INPUTS ? expr_gradient_sparse(e->g, x, SYM_INPUT, m->inputs.n)
                                   : expr_gradient_sparse(e->g, x, SYM_PARAM, m->params.n);
  for (uint32_t k = 0; k < d.n; k++) {
    if (by == BY_PARAMS && m->params.at[d.at[k].index].fixed) continue;
    uint32_t col = by == BY_PARAMS ? m->params.at[d.at[k].index].place : d.at[k].index;
    vec_push(m->arena, &all, ((ExprPartial){col, d.at[k].e}));
  }
  return (ExprPartials){all.at, all.n};
}

/* Derivatives of x by the components of y = (q, q', z), columns ascending. */
static ExprPartials by_state(const Eqns *e, Expr x) {
  const Model *m = e->m;
  const struct {
    SymKind kind;
    uint32_t n, first; /* first column */
  } blocks[] = {{SYM_COORD, e->n, 0}, {SYM_VEL, e->n, e->n}, {SYM_STATE, m->states.n, 2 * e->n}};
  VEC(ExprPartial) all = {0};
  for (int b = 0; b < 3; b++) {
    ExprPartials d = expr_gradient_sparse(e->g, x, blocks[b].kind, blocks[b].n);
    for (uint32_t k = 0; k < d.n; k++)
      vec_push(m->arena, &all, ((ExprPartial){blocks[b].first + d.at[k].index, d.at[k].e}));
  }
  return (ExprPartials){all.at, all.n};
}

/* Residuals of the constraints, demand - A q''. */
static const Expr *constraint_residuals(const Eqns *e) {
  const Constraints *k = &e->constraints;
  Expr *r = ARENA_ARRAY(e->m->arena, Expr, k->n + 1);
  for (uint32_t i = 0; i < k->n; i++) r[i] = k->demand[i];
  for (uint32_t i = 0; i < k->A.n; i++) {
    const MassEntry *x = &k->A.at[i];
    Expr part = expr_mul(e->g, x->e, expr_symbol(e->g, e->m->coords.at[x->col].a)->node);
    r[x->row] = expr_sub(e->g, r[x->row], part);
  }
  return r;
}

static PartialList differentiate(const Eqns *e, const Expr *inertia, PartialsBy by) {
  PartialList found = {0};
  uint32_t nz = e->m->states.n;
  const Expr *constraints = constraint_residuals(e);
  for (uint32_t i = 0; i < e->n + nz + e->constraints.n; i++) {
    Expr x = i < e->n        ? expr_sub(e->g, e->f[i], inertia[i])
             : i < e->n + nz ? e->flow[i - e->n]
                             : constraints[i - e->n - nz];
    ExprPartials d = by == BY_STATE ? by_state(e, x) : by_others(e, x, by);
    for (uint32_t k = 0; k < d.n; k++) vec_push(e->m->arena, &found, ((Partial){i, d.at[k].index, d.at[k].e}));
  }
  return found;
}

/* Replaces *best by the list with its entries rewritten (rule NULL: as they are) if M and list together take fewer
 * operations. */
static void try_form(const Eqns *e, const PartialList *from, Expr (*rule)(ExprGraph *, Expr), PartialList *best,
                     uint64_t *ops) {
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

Partials eqns_linearise(Eqns *e) { return eqns_partials(e, BY_STATE); }

const Expr *eqns_forces(const Eqns *e) {
  uint32_t n = expr_symbol_count(e->g) + 1;
  Expr *with = ARENA_ARRAY(e->m->arena, Expr, n), *f = ARENA_ARRAY(e->m->arena, Expr, e->n + 1);
  for (uint32_t k = 0; k < e->constraints.n; k++) with[e->constraints.of[k]->multiplier] = expr_int(e->g, 0);
  for (uint32_t i = 0; i < e->n; i++) f[i] = e->constraints.n ? expr_substitute(e->g, e->f[i], with, n, "") : e->f[i];
  return f;
}

const Expr *eqns_inverse_dynamics(Eqns *e) {
  const Expr *f = eqns_forces(e);
  const Expr *best = NULL;
  uint64_t least = UINT64_MAX;
  eqns_derive_mass(e);
  for (int by_momenta = 0; by_momenta <= 1; by_momenta++) {
    Expr *x = by_momenta ? inertia_of_momenta(e) : inertia_of_mass(e);
    for (uint32_t i = 0; i < e->n; i++) x[i] = simplify_shallow(e->g, expr_sub(e->g, x[i], f[i]));
    uint64_t ops = expr_ops(e->g, x, e->n);
    if (ops < least) best = x, least = ops;
  }
  return best;
}

Partials eqns_partials(Eqns *e, PartialsBy by) {
  enum { SIMPLIFY_MAX_ENTRIES = 300 };
  PartialList best = {0};
  uint64_t ops = UINT64_MAX;
  eqns_derive_mass(e);
  const Expr *const inertia[] = {inertia_of_mass(e), inertia_of_momenta(e)};
  int forms = memcmp(inertia[0], inertia[1], e->n * sizeof **inertia) ? 2 : 1;
  for (int k = 0; k < forms; k++) {
    PartialList raw = differentiate(e, inertia[k], by);
    if (raw.n <= SIMPLIFY_MAX_ENTRIES) {
      try_form(e, &raw, simplify, &best, &ops);
      try_form(e, &raw, simplify_shallow, &best, &ops);
    }
    try_form(e, &raw, NULL, &best, &ops);
  }
  return (Partials){best.at, best.n};
}

/* Operations of the derivatives of S, with those of M. */
static uint64_t adjoint_ops(const Eqns *e, const SumPartials *x) {
  const ExprPartials *const parts[] = {&x->by_state, &x->by_inputs, &x->by_params};
  VEC(Expr) roots = {0};
  for (int b = 0; b < 3; b++)
    for (uint32_t k = 0; k < parts[b]->n; k++) vec_push(e->m->arena, &roots, parts[b]->at[k].e);
  for (uint32_t k = 0; k < e->mass.n; k++) vec_push(e->m->arena, &roots, e->mass.at[k].e);
  return expr_ops(e->g, roots.at, roots.n);
}

/* sum w_i x_i */
static Expr weighted_sum(const Eqns *e, const SymId *w, const Expr *x, uint32_t n) {
  VEC(Expr) terms = {0};
  for (uint32_t i = 0; i < n; i++) {
    Expr term = expr_mul(e->g, expr_symbol(e->g, w[i])->node, x[i]);
    vec_push(e->m->arena, &terms, term);
  }
  return expr_add_n(e->g, terms.at, terms.n);
}

/* S with this M q''. */
static Expr weighted_residuals(const Eqns *e, const AdjointPartials *of, const Expr *inertia) {
  uint32_t n = e->n + e->m->states.n;
  Expr *r = ARENA_ARRAY(e->m->arena, Expr, n + 1);
  for (uint32_t i = 0; i < n; i++) r[i] = i < e->n ? expr_sub(e->g, e->f[i], inertia[i]) : e->flow[i - e->n];
  Expr motion = weighted_sum(e, of->w, r, n),
       held = weighted_sum(e, of->l, constraint_residuals(e), e->constraints.n);
  return expr_sub(e->g, motion, held);
}

static SumPartials sum_partials(const Eqns *e, Expr S) {
  SumPartials x = {.by_state = by_state(e, S)};
  x.by_inputs = by_others(e, S, BY_INPUTS);
  x.by_params = by_others(e, S, BY_PARAMS);
  return x;
}

static const SymId *weights(const Eqns *e, const char *stem, uint32_t n) {
  SymId *w = ARENA_ARRAY(e->m->arena, SymId, n + 1);
  for (uint32_t i = 0; i < n; i++)
    w[i] = expr_declare(e->g, SYM_LOCAL, i, arena_printf(e->m->arena, "%s_%u", stem, i + 1), SIGN_UNKNOWN);
  return w;
}

AdjointPartials eqns_adjoint(Eqns *e) {
  Arena *a = e->m->arena;
  const Constraints *of = &e->constraints;
  AdjointPartials best = {.w = weights(e, "weight", e->n + e->m->states.n),
                          .l = weights(e, "held", of->n),
                          .k = weights(e, "kept", of->nholonomic)};
  PartialList formulas = {0};
  uint64_t least = UINT64_MAX;
  eqns_derive_mass(e);
  for (int by_momenta = 0; by_momenta <= 1; by_momenta++) {
    Expr S = weighted_residuals(e, &best, by_momenta ? inertia_of_momenta(e) : inertia_of_mass(e));
    SumPartials x = sum_partials(e, S);
    uint64_t ops = adjoint_ops(e, &x);
    if (ops < least) best.S = x, least = ops;
  }
  if (of->n) {
    best.r = sum_partials(e, weighted_sum(e, best.l, of->r, of->n));
    best.c = sum_partials(e, weighted_sum(e, best.k, of->c, of->nholonomic));
  }
  for (uint32_t i = 0; i < e->m->inputs.n; i++) {
    ExprPartials d = e->m->inputs.at[i].value ? by_others(e, e->m->inputs.at[i].value, BY_PARAMS) : (ExprPartials){0};
    for (uint32_t k = 0; k < d.n; k++) vec_push(a, &formulas, ((Partial){i, d.at[k].index, d.at[k].e}));
  }
  best.formulas = (Partials){formulas.at, formulas.n};
  return best;
}

Partials eqns_output_partials(const Eqns *e, const Expr *x, uint32_t n) {
  const Model *m = e->m;
  uint32_t ny = 2 * e->n + m->states.n;
  const struct {
    SymKind kind;
    uint32_t n, first; /* first column */
  } blocks[] = {{SYM_INPUT, m->inputs.n, ny},
                {SYM_ACC, e->n, ny + m->inputs.n},
                {SYM_RATE, m->states.n, ny + m->inputs.n + e->n}};
  uint32_t first_param = ny + m->inputs.n + e->n + m->states.n;
  PartialList found = {0};
  for (uint32_t i = 0; i < n; i++) {
    ExprPartials d = by_state(e, x[i]);
    for (uint32_t k = 0; k < d.n; k++)
      vec_push(m->arena, &found, ((Partial){i, d.at[k].index, simplify_shallow(e->g, d.at[k].e)}));
    for (int b = 0; b < 3; b++) {
      d = expr_gradient_sparse(e->g, x[i], blocks[b].kind, blocks[b].n);
      for (uint32_t k = 0; k < d.n; k++)
        vec_push(m->arena, &found, ((Partial){i, blocks[b].first + d.at[k].index, simplify_shallow(e->g, d.at[k].e)}));
    }
    d = by_others(e, x[i], BY_PARAMS);
    for (uint32_t k = 0; k < d.n; k++)
      vec_push(m->arena, &found, ((Partial){i, first_param + d.at[k].index, simplify_shallow(e->g, d.at[k].e)}));
  }
  return (Partials){found.at, found.n};
}

/* --- events and their actions, for saltation matrices (runtime/core/saltation.c) --- */

typedef VEC(EventPartial) EventPartialList;

static void add_event(const Eqns *e, EventPartialList *to, uint32_t event, int row, uint32_t col, Expr value) {
  value = simplify_shallow(e->g, value);
  if (!expr_is_zero(e->g, value) || row == (int)col)
    vec_push(e->m->arena, to, ((EventPartial){event, row, col, value}));
}

/* Derivatives of one value by the state, then by the time. */
static void differentiate_event(const Eqns *e, Expr value, uint32_t event, int row, EventPartialList *to) {
  ExprPartials d = by_state(e, value);
  int own = 0;
  for (uint32_t k = 0; k < d.n; k++) {
    own |= row == (int)d.at[k].index;
    add_event(e, to, event, row, d.at[k].index, d.at[k].e);
  }
  if (row >= 0 && !own) add_event(e, to, event, row, (uint32_t)row, expr_int(e->g, 0));
  add_event(e, to, event, row, 2 * e->n + e->m->states.n, expr_diff(e->g, value, e->m->time));
}

EventPartials eqns_event_derivatives(const Eqns *e) {
  const Model *m = e->m;
  EventPartialList found = {0};
  for (uint32_t k = 0; k < m->events.n; k++) {
    const Event *ev = &m->events.at[k];
    unsigned kinds = expr_kinds(e->g, ev->g);
    for (uint32_t i = 0; i < ev->actions.n; i++) kinds |= expr_kinds(e->g, ev->actions.at[i].value);
    if (!ev->actions.n || kinds & 1u << SYM_INPUT) continue;
    differentiate_event(e, ev->g, k, -1, &found);
    for (uint32_t i = 0; i < ev->actions.n; i++) {
      const Symbol *s = expr_symbol(e->g, ev->actions.at[i].target);
      uint32_t first = s->kind == SYM_COORD ? 0 : s->kind == SYM_VEL ? e->n : 2 * e->n;
      differentiate_event(e, ev->actions.at[i].value, k, (int)(first + s->index), &found);
    }
  }
  return (EventPartials){found.at, found.n};
}
