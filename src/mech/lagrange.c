#include "mech/lagrange.h"

#include <math.h>

#include "sym/diff.h"
#include "sym/eval.h"
#include "sym/simplify.h"

/* --- derivatives of L --- */

static SymId *coordinate_symbols(const Model *m, int velocities) {
  SymId *s = ARENA_ARRAY(m->arena, SymId, m->coords.n + 1);
  for (uint32_t i = 0; i < m->coords.n; i++) s[i] = velocities ? m->coords.at[i].v : m->coords.at[i].q;
  return s;
}

/* The direction (q', z', 1) in which the explicit part of d/dt is taken: q'' is left out, since
 * M q'' stands on the other side. */
static Expr *explicit_direction(const Eqns *e) {
  const Model *m = e->m;
  Expr *seed = ARENA_ARRAY(m->arena, Expr, expr_symbol_count(e->g) + 1);
  seed[m->time] = expr_int(e->g, 1);
  for (uint32_t i = 0; i < e->n; i++) seed[m->coords.at[i].q] = expr_symbol(e->g, m->coords.at[i].v)->node;
  for (uint32_t i = 0; i < m->states.n; i++) seed[m->states.at[i].z] = e->flow[i];
  return seed;
}

/* Q_i = sum over forces of f d(point)/dq_i, minus dR/dq_i'. */
static const Expr *generalised_forces(const Eqns *e) {
  const Model *m = e->m;
  ExprGraph *g = e->g;
  Expr *Q = ARENA_ARRAY(m->arena, Expr, e->n + 1);
  for (uint32_t i = 0; i < e->n; i++) Q[i] = expr_int(g, 0);
  for (uint32_t k = 0; k < m->forces.n; k++) {
    ExprPartials d = expr_gradient_sparse(g, m->forces.at[k].point, SYM_COORD, e->n);
    for (uint32_t i = 0; i < d.n; i++) {
      Expr part = expr_mul(g, m->forces.at[k].f, d.at[i].e), *Qi = &Q[d.at[i].index];
      *Qi = expr_add(g, *Qi, part);
    }
  }
  if (!m->dissipation) return Q;
  ExprPartials d = expr_gradient_sparse(g, m->dissipation, SYM_VEL, e->n);
  for (uint32_t i = 0; i < d.n; i++) Q[d.at[i].index] = expr_sub(g, Q[d.at[i].index], d.at[i].e);
  return Q;
}

/* The entries of the mass matrix and the forces, as differentiated. */
typedef struct {
  VEC(MassEntry) mass;
  Expr *f;
} Raw;

static Raw differentiate(Eqns *e, const SymId *q, const SymId *v) {
  const Model *m = e->m;
  ExprGraph *g = e->g;
  Raw raw = {.f = ARENA_ARRAY(m->arena, Expr, e->n)};
  Expr *p = ARENA_ARRAY(m->arena, Expr, e->n), *dLdq = ARENA_ARRAY(m->arena, Expr, e->n);
  Expr *convective = ARENA_ARRAY(m->arena, Expr, e->n);
  expr_gradient(g, m->lagrangian, v, e->n, p);
  expr_gradient(g, m->lagrangian, q, e->n, dLdq);
  for (uint32_t i = 0; i < e->n; i++) {
    ExprPartials row = expr_gradient_sparse(g, p[i], SYM_VEL, i + 1);
    for (uint32_t k = 0; k < row.n; k++) vec_push(m->arena, &raw.mass, ((MassEntry){i, row.at[k].index, row.at[k].e}));
  }
  e->Q = generalised_forces(e);
  Expr *seed = explicit_direction(e);
  expr_tangent(g, p, e->n, seed, expr_symbol_count(g) + 1, "_drift", convective);
  for (uint32_t i = 0; i < e->n; i++) {
    Expr inertial = expr_sub(g, dLdq[i], convective[i]);
    raw.f[i] = expr_add(g, inertial, e->Q[i]);
  }
  e->p = p;
  e->dLdq = dLdq;
  return raw;
}

/* Above this many entries, what lets share is worth more than what a short form saves. */
enum { SIMPLIFY_MAX_ENTRIES = 300 };

const Expr *lagrange_short_forms(const Eqns *e, const Expr *raw, uint32_t n) {
  if (n > SIMPLIFY_MAX_ENTRIES) return raw;
  Expr *after = ARENA_ARRAY(e->m->arena, Expr, n + 1);
  for (uint32_t k = 0; k < n; k++) after[k] = simplify(e->g, raw[k]);
  return expr_ops(e->g, after, n) <= expr_ops(e->g, raw, n) ? after : raw;
}

/* The mass matrix and the forces, in the better of both forms; entries that turn out to be zero go. */
static void choose_forms(Eqns *e, const Raw *raw) {
  uint32_t nm = raw->mass.n, n = nm + e->n;
  Expr *before = ARENA_ARRAY(e->m->arena, Expr, n);
  for (uint32_t k = 0; k < n; k++) before[k] = k < nm ? raw->mass.at[k].e : raw->f[k - nm];
  const Expr *best = lagrange_short_forms(e, before, n);
  for (uint32_t k = 0; k < nm; k++)
    if (!expr_is_zero(e->g, best[k])) vec_push(e->m->arena, &e->mass, ((MassEntry){raw->mass.at[k].row, raw->mass.at[k].col, best[k]}));
  e->f = best + nm;
}

void lagrange_momenta_and_forces(Eqns *e) {
  SymId *q = coordinate_symbols(e->m, 0), *v = coordinate_symbols(e->m, 1);
  Raw raw = differentiate(e, q, v);
  choose_forms(e, &raw);
}

/* --- definiteness --- */

static int is_velocity(const Symbol *s, const void *data) {
  (void)data;
  return s->kind == SYM_VEL;
}

int lagrange_definite(const Eqns *e) {
  ExprGraph *g = e->g;
  Expr l = e->m->lagrangian;
  ExprMap moving = expr_containing(g, &l, 1, is_velocity, NULL);
  for (uint32_t i = 0; i < expr_pairs(g, l, EX_SUM); i++) {
    Num c;
    Expr term = expr_pair(g, l, EX_SUM, i, &c);
    if (!expr_map_get(&moving, term)) continue;
    ExprSign s = expr_sign(g, term);
    if (num_sign(c) < 0 || (s != SIGN_POSITIVE && s != SIGN_NONNEGATIVE)) return 0;
  }
  /* A term that is at least 0 and quadratic in q' has a Hessian that is at least 0; quadratic means
   * that the Hessian of the whole is free of velocities. */
  Expr *entries = ARENA_ARRAY(e->m->arena, Expr, e->mass.n + 1);
  for (uint32_t i = 0; i < e->mass.n; i++) entries[i] = e->mass.at[i].e;
  ExprList all = expr_topo(g, entries, e->mass.n);
  for (uint32_t i = 0; i < all.n; i++)
    if (expr_op(g, all.at[i]) == EX_SYM && is_velocity(expr_sym_of(g, all.at[i]), NULL)) return 0;
  return 1;
}

/* --- a mass matrix that is singular everywhere --- */

enum { TRIES = 8 };

/* Numbers in (0.5, 2), the same in every run (Knuth's MMIX generator). */
static long double next_random(uint64_t *state) {
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return 0.5L + 1.5L * (long double)(*state >> 11) / 9007199254740992.0L;
}

static void random_state(const Eqns *e, uint64_t *state, long double *values) {
  for (SymId s = 1; s <= expr_symbol_count(e->g); s++) {
    const Symbol *sym = expr_symbol(e->g, s);
    long double x = next_random(state);
    values[s] = sym->sign == SIGN_NEGATIVE || sym->sign == SIGN_NONPOSITIVE ? -x : x;
    if (sym->kind == SYM_CONST) values[s] = 3.14159265358979323846264338327950288L;
    if (sym->kind == SYM_VEL) values[s] = x * 0.1L; /* inside the light cone of relativistic models */
  }
}

/* Rank-revealing elimination with full pivoting on the dense matrix a[n*n]: 1 when regular. On
 * failure null[n] spans the kernel's first direction. */
static int regular(long double *a, uint32_t n, uint32_t *perm, long double *null) {
  long double largest = 0;
  for (uint32_t i = 0; i < n * n; i++) largest = fmaxl(largest, fabsl(a[i]));
  for (uint32_t i = 0; i < n; i++) perm[i] = i;
  for (uint32_t k = 0; k < n; k++) {
    uint32_t pr = k, pc = k;
    for (uint32_t i = k; i < n; i++)
      for (uint32_t j = k; j < n; j++)
        if (fabsl(a[i * n + j]) > fabsl(a[pr * n + pc])) pr = i, pc = j;
    if (!(fabsl(a[pr * n + pc]) > 1e-13L * largest)) {
      for (uint32_t i = 0; i < n; i++) null[i] = 0;
      null[perm[k]] = 1;
      for (uint32_t i = k; i-- > 0;) {
        long double s = a[i * n + k];
        for (uint32_t j = i + 1; j < k; j++) s += a[i * n + j] * null[perm[j]];
        null[perm[i]] = -s / a[i * n + i];
      }
      return 0;
    }
    for (uint32_t j = 0; j < n; j++) { long double t = a[k * n + j]; a[k * n + j] = a[pr * n + j]; a[pr * n + j] = t; }
    for (uint32_t i = 0; i < n; i++) { long double t = a[i * n + k]; a[i * n + k] = a[i * n + pc]; a[i * n + pc] = t; }
    uint32_t t = perm[k]; perm[k] = perm[pc]; perm[pc] = t;
    for (uint32_t i = k + 1; i < n; i++) {
      long double factor = a[i * n + k] / a[k * n + k];
      for (uint32_t j = k; j < n; j++) a[i * n + j] -= factor * a[k * n + j];
    }
  }
  return 1;
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
  if (e->mass.n == 0) {
    diag_error(d, m->lagrangian_span, "the mass matrix is zero: L is linear in the velocities, or does not contain them");
    diag_help(d, "not yet: Lagrangians of first order; a quantity without inertia can be a `state` with a `flow`");
  } else if (involved == 1) {
    diag_error(d, m->coords.at[last].span, "the mass matrix is singular in every state: `%s` has no inertia", m->coords.at[last].name);
    diag_help(d, "L contains no `%s'^2`; add its kinetic energy, or declare it as a `let` or a `state`", m->coords.at[last].name);
  } else {
    diag_error(d, m->lagrangian_span, "the mass matrix is singular in every state: one combination of %s has no inertia", sb_text(&names));
    diag_help(d, "the kinetic energy depends on fewer combinations of velocities than there are coordinates");
  }
}

/* Every state tried is singular; a determinant that is not identically zero vanishes at a random
 * point with probability zero. Large matrices are judged by their factorization when running. */
int lagrange_check_mass(Eqns *e) {
  enum { LARGEST = 200 };
  uint32_t n = e->n;
  if (n == 0 || n > LARGEST) return 1;
  Arena *arena = e->m->arena;
  Expr *entries = ARENA_ARRAY(arena, Expr, e->mass.n + 1);
  for (uint32_t k = 0; k < e->mass.n; k++) entries[k] = e->mass.at[k].e;
  long double *symbols = ARENA_ARRAY(arena, long double, expr_symbol_count(e->g) + 1);
  long double *values = ARENA_ARRAY(arena, long double, e->mass.n + 1), *a = ARENA_ARRAY(arena, long double, n * n);
  long double *null = ARENA_ARRAY(arena, long double, n);
  uint32_t *perm = ARENA_ARRAY(arena, uint32_t, n);
  uint64_t seed = 1;
  int judged = 0;
  for (int t = 0; t < TRIES; t++) {
    random_state(e, &seed, symbols);
    expr_eval(e->g, entries, e->mass.n, symbols, values);
    int finite = 1;
    for (uint32_t i = 0; i < n * n; i++) a[i] = 0;
    for (uint32_t k = 0; k < e->mass.n; k++) {
      a[e->mass.at[k].row * n + e->mass.at[k].col] = a[e->mass.at[k].col * n + e->mass.at[k].row] = values[k];
      finite &= isfinite(values[k]) != 0;
    }
    if (!finite) continue;
    if (regular(a, n, perm, null)) return 1;
    judged = 1;
  }
  if (!judged) return 1; /* the tries all lay outside the model's domain: runs will tell */
  report_singular(e, null);
  return 0;
}
