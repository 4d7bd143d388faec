/* Momenta, forces and mass matrix by differentiation on the graph; the cheapest form of M q'' = f, dense or with
 * definitions as unknowns (mech/augmented_system.h); the error message for a mass matrix that is singular
 * everywhere. */
#include "mech/lagrange.h"

#include <math.h>

#include "base/sparse_solve.h"
#include "mech/mass_definiteness.h"
#include "mech/augmented_system.h"
#include "mech/elimination_order.h"
#include "mech/kinetic_squares.h"
#include "mech/states.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/prove.h"
#include "sym/simplify.h"

/* --- derivatives of L --- */

/* The direction (q', z', 1) in (q, z, t) of d/dt without its part in q'', which is M q'' on the left-hand side. */
static Expr *explicit_direction(const Eqns *e) {
  const Model *m = e->m;
  Expr *seed = ARENA_ARRAY(m->arena, Expr, expr_symbol_count(e->g) + 1);
  model_seed_time(m, seed);
  for (uint32_t i = 0; i < e->n; i++) seed[m->coords.at[i].q] = expr_symbol(e->g, m->coords.at[i].v)->node;
  for (uint32_t i = 0; i < m->states.n; i++) seed[m->states.at[i].z] = e->flow[i];
  return seed;
}

Expr *generalised_forces(const Model *m, SymKind q, SymKind v, uint32_t n) {
  ExprGraph *g = m->g;
  Expr *Q = ARENA_ARRAY(m->arena, Expr, n + 1);
  for (uint32_t i = 0; i < n; i++) Q[i] = expr_int(g, 0);
  for (uint32_t k = 0; k < m->forces.n; k++) {
    ExprPartials d = expr_gradient_sparse(g, m->forces.at[k].point, q, n);
    for (uint32_t i = 0; i < d.n; i++) {
      Expr part = expr_mul(g, m->forces.at[k].f, d.at[i].e), *Qi = &Q[d.at[i].index];
      *Qi = expr_add(g, *Qi, part);
    }
  }
  ExprPartials d = m->dissipation ? expr_gradient_sparse(g, m->dissipation, v, n) : (ExprPartials){0};
  for (uint32_t i = 0; i < d.n; i++) Q[d.at[i].index] = expr_sub(g, Q[d.at[i].index], d.at[i].e);
  return Q;
}

/* out[i] = dp[i]/dt without q''. The derivative of a definition without velocities is its full time derivative and
 * named so: I', not I_drift. */
static void convective_rates(const Eqns *e, const Expr *p, Expr *out) {
  ExprGraph *g = e->g;
  const Expr *seed = explicit_direction(e);
  uint32_t nseed = expr_symbol_count(g) + 1;
  ExprMap rates = expr_map(e->m->arena);
  VEC(Expr) still = {0};
  ExprList all = expr_topo(g, p, e->n);
  for (uint32_t i = 0; i < all.n; i++)
    if (expr_op(g, all.at[i]) == EX_DEF && !(expr_kinds(g, all.at[i]) & (1u << SYM_VEL | 1u << SYM_STATE)))
      vec_push(e->m->arena, &still, all.at[i]);
  Expr *unused = ARENA_ARRAY(e->m->arena, Expr, still.n + 1);
  expr_tangent(g, still.at, still.n, (ExprSeeds){.at = seed, .n = nseed}, "'", &rates, unused);
  expr_tangent(g, p, e->n, (ExprSeeds){.at = seed, .n = nseed}, "_drift", &rates, out);
}

/* L plus the regularising terms of Model.regularising, for rotations and constraints. */
static Expr regularised_lagrangian(const Eqns *e) {
  return e->m->regularising ? expr_add(e->g, e->m->lagrangian, e->m->regularising) : e->m->lagrangian;
}

/* Fills p, dLdq and Q; returns the forces f as differentiated. */
static Expr *differentiate(Eqns *e) {
  const Model *m = e->m;
  ExprGraph *g = e->g;
  SymId *q = eqns_symbols(e, 0), *v = eqns_symbols(e, 1);
  Expr *p = ARENA_ARRAY(m->arena, Expr, e->n), *dLdq = ARENA_ARRAY(m->arena, Expr, e->n);
  Expr *convective = ARENA_ARRAY(m->arena, Expr, e->n), *f = ARENA_ARRAY(m->arena, Expr, e->n);
  Expr l = regularised_lagrangian(e);
  expr_gradient(g, l, v, e->n, p);
  expr_gradient(g, l, q, e->n, dLdq);
  e->p = p;
  e->Q = generalised_forces(m, SYM_COORD, SYM_VEL, e->n);
  convective_rates(e, p, convective);
  for (uint32_t i = 0; i < e->n; i++) {
    Expr inertial = expr_sub(g, dLdq[i], convective[i]);
    f[i] = expr_add(g, inertial, e->Q[i]);
  }
  e->dLdq = dLdq;
  return f;
}

/* The entries of the mass matrix as differentiated. */
static Entries raw_mass(const Eqns *e) {
  Entries mass = {0};
  for (uint32_t i = 0; i < e->n; i++) {
    ExprPartials row = expr_gradient_sparse(e->g, e->p[i], SYM_VEL, i + 1);
    for (uint32_t k = 0; k < row.n; k++) vec_push(e->m->arena, &mass, ((MassEntry){i, row.at[k].index, row.at[k].e}));
  }
  return mass;
}

void eqns_derive_mass(Eqns *e) {
  if (e->mass_known || !e->n) return;
  e->mass = raw_mass(e);
  e->mass_known = 1;
}

/* --- the form that is solved --- */

/* Above this many entries, sharing by lets saves more than short forms do. */
enum { SIMPLIFY_MAX_ENTRIES = 300 };

/* *best := rule(raw[k]) for all k if these take no more operations than *best. */
static void try_short(const Eqns *e, const Expr *raw, uint32_t n, Expr (*rule)(ExprGraph *, Expr), const Expr **best) {
  Expr *after = ARENA_ARRAY(e->m->arena, Expr, n + 1);
  for (uint32_t k = 0; k < n; k++) after[k] = rule(e->g, raw[k]);
  if (expr_ops(e->g, after, n) <= expr_ops(e->g, *best, n)) *best = after;
}

const Expr *lagrange_short_forms(const Eqns *e, const Expr *raw, uint32_t n) {
  const Expr *best = raw;
  try_short(e, raw, n, simplify_shallow, &best);
  if (n <= SIMPLIFY_MAX_ENTRIES) try_short(e, raw, n, simplify, &best);
  return best;
}

/* Operations of a system: evaluation of its entries together, and solution. */
static uint64_t system_ops(Eqns *e, LinearSystem *s) {
  VEC(Expr) roots = {0};
  for (uint32_t k = 0; k < s->H.n; k++) vec_push(e->m->arena, &roots, s->H.at[k].e);
  for (uint32_t k = 0; k < s->C.n; k++) vec_push(e->m->arena, &roots, s->C.at[k].e);
  for (uint32_t i = 0; i < s->n; i++) vec_push(e->m->arena, &roots, s->f[i]);
  elimination_order_best(e->m->arena, e->g, s);
  return expr_ops(e->g, roots.at, roots.n) + s->ops;
}

static Entries rewritten(const Eqns *e, const Entries *from, Expr (*rule)(ExprGraph *, Expr)) {
  Entries to = {0};
  for (uint32_t k = 0; k < from->n; k++) {
    MassEntry x = from->at[k];
    x.e = rule(e->g, x.e);
    if (!expr_is_zero(e->g, x.e)) vec_push(e->m->arena, &to, x);
  }
  return to;
}

/* Whether the rule changes a force. Of more than 64 forces a sample is tried: sums over all other bodies are slow to
 * rewrite and look alike. */
static int changes_forces(const Eqns *e, const LinearSystem *s, Expr (*rule)(ExprGraph *, Expr)) {
  enum { MANY = 64, SAMPLE = 16 };
  uint32_t step = e->n > MANY ? e->n / SAMPLE : 1;
  for (uint32_t i = 0; i < e->n; i += step)
    if (rule(e->g, s->f[i]) != s->f[i]) return 1;
  return 0;
}

/* Replaces *best if s with all entries rewritten takes no more operations. Operations are counted for all entries
 * together: entries that are shorter alone may share less. */
static void try_form(Eqns *e, const LinearSystem *s, Expr (*rule)(ExprGraph *, Expr), LinearSystem *best,
                     uint64_t *ops) {
  LinearSystem t = {
      .n = s->n, .ndefs = s->ndefs, .defs = s->defs, .H = rewritten(e, &s->H, rule), .C = rewritten(e, &s->C, rule)};
  Expr *f = ARENA_ARRAY(e->m->arena, Expr, e->n);
  int some = changes_forces(e, s, rule);
  for (uint32_t i = 0; i < e->n; i++) f[i] = some ? rule(e->g, s->f[i]) : s->f[i];
  t.f = f;
  uint64_t mine = system_ops(e, &t);
  if (mine > *ops) return;
  *best = t;
  *ops = mine;
}

static Expr as_differentiated(ExprGraph *g, Expr x) {
  (void)g;
  return x;
}

enum { LOOK_THROUGH = 1 };

/* Cheapest form of s, its operations in *ops. how: LOOK_THROUGH or 0; looking through lets grows with the square of
 * a chain's length. */
static LinearSystem best_form(Eqns *e, const LinearSystem *s, int how, uint64_t *ops) {
  LinearSystem best = *s;
  *ops = UINT64_MAX;
  try_form(e, s, as_differentiated, &best, ops);
  try_form(e, s, simplify_shallow, &best, ops);
  if (how == LOOK_THROUGH && s->H.n + s->C.n + e->n <= SIMPLIFY_MAX_ENTRIES) try_form(e, s, simplify, &best, ops);
  return best;
}

/* Whether solving with the dense mass matrix takes more than MANY_TIMES the operations of the augmented system; M is
 * then not derived. */
static int dense_is_too_costly(Eqns *e, LinearSystem *lifted) {
  enum { FEW_COORDINATES = 12, MANY_TIMES = 3 };
  if (e->n <= FEW_COORDINATES || !lifted->ndefs || e->m->expects.n) return 0;
  elimination_order_best(e->m->arena, e->g, lifted);
  LinearSystem dense = *lifted;
  uint64_t many = MANY_TIMES * lifted->ops;
  elimination_order(e->m->arena, e->g, &dense, ORDER_DEFINITIONS_FIRST, many);
  return dense.ops > many;
}

static int is_definite(Eqns *e, const LinearSystem *s) {
  Expr l = regularised_lagrangian(e);
  e->definite_mass = mass_is_definite(e, s, l);
  e->definite_by_values = e->definite_mass || mass_is_definite_by_values(e, s, l);
  return e->definite_by_values;
}

/* Forces keep the digits that the text has near a removable singularity. */
static void stabilise(const Eqns *e, const Expr *raw, LinearSystem *s) {
  Expr *f = ARENA_ARRAY(e->m->arena, Expr, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++) f[i] = simplify_stable_quotients(e->g, s->f[i], raw[i]);
  s->f = f;
}

/* The augmented system is used only where its pivots are known to be positive. */
void lagrange_momenta_and_forces(Eqns *e) {
  uint64_t dense_ops, lifted_ops;
  const Expr *f = differentiate(e);
  LinearSystem lifted = augmented_system(e);
  lifted.f = f;
  int constrained = e->m->constraints.n > 0; /* then M itself is needed */
  if (!constrained && dense_is_too_costly(e, &lifted) && is_definite(e, &lifted)) {
    e->system = best_form(e, &lifted, 0, &lifted_ops);
    e->f = e->system.f;
    return;
  }
  LinearSystem raw = {.n = e->n, .H = raw_mass(e), .f = f}, dense = best_form(e, &raw, LOOK_THROUGH, &dense_ops);
  stabilise(e, f, &dense);
  e->mass = dense.H;
  e->mass_known = 1;
  e->f = dense.f;
  e->system = dense;
  if (!is_definite(e, &dense) || constrained || !lifted.ndefs) return;
  lifted = best_form(e, &lifted, LOOK_THROUGH, &lifted_ops);
  stabilise(e, f, &lifted);
  if (lifted_ops < dense_ops) e->system = lifted;
}

void lagrange_squares(Eqns *e) {
  if (!e->n || !e->mass_known || !e->definite_by_values) return;
  e->squares = kinetic_squares(e);
  if (!e->squares.n) return;
  e->system = (LinearSystem){.n = e->n, .H = e->mass, .f = e->f};
  elimination_order_best(e->m->arena, e->g, &e->system);
}

/* --- a mass matrix that is singular everywhere --- */

enum { TRIES = 8 };

/* A sample state with slow velocities, inside the light cone of relativistic models. */
static void slow_state(const Eqns *e, uint32_t seed, long double *values) {
  sample_state(e->g, seed, values);
  for (uint32_t i = 0; i < e->n; i++) values[e->m->coords.at[i].v] *= 0.1L;
}

/* Names of the coordinates whose rows of the mass matrix are zero, if L contains the velocity of one of them; else
 * NULL. */
static const char *coordinates_without_inertia(const Eqns *e) {
  const Model *m = e->m;
  StrBuf names = strbuf(m->arena);
  uint8_t *heavy = ARENA_ARRAY(m->arena, uint8_t, e->n);
  for (uint32_t k = 0; k < e->mass.n; k++) heavy[e->mass.at[k].row] = heavy[e->mass.at[k].col] = 1;
  int linear = 0;
  for (uint32_t i = 0; i < e->n; i++) {
    if (heavy[i]) continue;
    sb_printf(&names, "%s`%s`", names.n ? ", " : "", m->coords.at[i].name);
    linear |= expr_contains_sym(e->g, m->lagrangian, m->coords.at[i].v);
  }
  return linear ? sb_text(&names) : NULL;
}

static void report_singular(const Eqns *e, const long double *null) {
  const Model *m = e->m;
  Diags *d = m->diags;
  StrBuf names = strbuf(m->arena);
  uint32_t involved = 0, last = 0;
  for (uint32_t i = 0; i < e->n; i++)
    if (fabsl(null[i]) > 1e-9L) {
      sb_printf(&names, "%s`%s'`", involved++ ? ", " : "", m->coords.at[i].name);
      last = i;
    }
  const char *light = coordinates_without_inertia(e);
  if (e->mass.n == 0 && !(expr_kinds(e->g, m->lagrangian) & 1u << SYM_VEL)) {
    diag_error(d, m->lagrangian_span, "the mass matrix is zero: L does not contain velocities");
    diag_help(
        d, "nothing moves without kinetic energy, or terms like x*y' that make a coordinate the momentum of another");
  } else if (e->mass.n == 0) {
    diag_error(d, m->lagrangian_span,
               "the mass matrix is zero: all terms that are not linear in the velocities cancel");
    diag_help(d, "write L linear in the velocities: the equations are then of first order, without accelerations");
  } else if (light) {
    diag_error(d, m->lagrangian_span,
               "the mass matrix is singular in every state: without inertia: %s; L is linear in these velocities, not "
               "in the others",
               light);
    diag_help(d, "Lagrangians of mixed order are not supported: give all coordinates inertia, or none, or declare a "
                 "coordinate that follows at once as a `state` with a `flow`");
  } else if (involved == 1) {
    diag_error(d, m->coords.at[last].span, "the mass matrix is singular in every state: `%s` has no inertia%s",
               m->coords.at[last].name, m->constraints.n ? ", and no constraint moves it" : "");
    diag_help(d, "L contains no `%s'^2`; add its kinetic energy, or declare it as a `let` or a `state`",
              m->coords.at[last].name);
  } else {
    diag_error(d, m->kinetic_span.end ? m->kinetic_span : m->lagrangian_span,
               "the mass matrix is singular in every state: one combination of %s has no inertia%s", sb_text(&names),
               m->constraints.n ? ", and no constraint moves it" : "");
    diag_help(d, "the kinetic energy depends on fewer combinations of velocities than there are coordinates");
  }
}

/* M and all = [M -A^T; A 0] at a state. 0: an entry of M is not finite. */
static int system_at(const Eqns *e, const Expr *entries, const long double *symbols, long double *values,
                     SparseElements *M, SparseElements *all) {
  int finite = 1;
  M->n = all->n = 0;
  expr_eval(e->g, entries, e->mass.n + e->constraints.A.n, symbols, values);
  states_put_mass(e, values, M);
  states_put_mass(e, values, all);
  states_put_constraints(e, values + e->mass.n, e->constraints.n, all);
  for (uint32_t k = 0; k < e->mass.n; k++) finite &= isfinite(values[k]) != 0;
  return finite;
}

/* Whether each row of M, or column of A but for contacts, has an entry; null: a coordinate without. */
static int has_all_rows(const Eqns *e, long double *null) {
  const Constraints *k = &e->constraints;
  const Model *m = e->m;
  Arena *a = m->arena;
  uint8_t *moved = ARENA_ARRAY(a, uint8_t, e->n + 1), *opens = ARENA_ARRAY(a, uint8_t, m->constraints.n + 1);
  for (uint32_t i = 0; i < m->contacts.n; i++) opens[m->contacts.at[i].constraint] = 1;
  for (uint32_t i = 0; i < e->mass.n; i++) moved[e->mass.at[i].row] = moved[e->mass.at[i].col] = 1;
  for (uint32_t i = 0; i < k->A.n; i++)
    if (!opens[k->of[k->A.at[i].row] - m->constraints.at]) moved[k->A.at[i].col] = 1;
  for (uint32_t i = 0; i < e->n; i++)
    if (!moved[i]) return null[i] = 1, 0;
  return 1;
}

/* A determinant that is not identically zero vanishes at a random state with probability zero. Large matrices are
 * judged by their empty rows, and in the run, by their factorization. */
int lagrange_check_mass(Eqns *e) {
  enum { LARGEST = 200 };
  uint32_t n = e->n;
  if (n == 0 || !e->mass_known) return 1;
  Arena *arena = e->m->arena;
  long double *null = ARENA_ARRAY(arena, long double, n);
  if (n > LARGEST && has_all_rows(e, null)) return 1;
  if (n > LARGEST) return report_singular(e, null), 0;
  const Entries *A = &e->constraints.A;
  uint32_t m = e->constraints.n, roots = e->mass.n + A->n;
  Expr *entries = ARENA_ARRAY(arena, Expr, roots + 1);
  for (uint32_t k = 0; k < roots; k++) entries[k] = k < e->mass.n ? e->mass.at[k].e : A->at[k - e->mass.n].e;
  long double *symbols = ARENA_ARRAY(arena, long double, expr_symbol_count(e->g) + 1),
              *values = ARENA_ARRAY(arena, long double, roots + 1);
  SparseElements M = {0}, all = {0};
  int judged = 0;
  for (uint32_t seed = 1; seed <= TRIES; seed++) {
    slow_state(e, seed, symbols);
    for (uint32_t i = 0; i < e->m->contacts.n; i++) symbols[e->m->contacts.at[i].closed] = 0;
    if (!system_at(e, entries, symbols, values, &M, &all)) continue;
    if (m) e->singular_mass = sparse_solve(arena, n, &M, NULL, 1e-13L, NULL) < n;
    if (sparse_is_regular_on_kernel(arena, n, m, &all, null)) return 1;
    judged = 1;
  }
  if (!judged) return 1; /* all tries lay outside the model's domain: left to the run */
  return report_singular(e, null), 0;
}
