/* Integrability by Frobenius' theorem in numbers, on the kernel of all forms at random states; proved where all
 * forms are closed. Potentials of single exact forms by integration. */
#include "mech/frobenius.h"

#include <math.h>

#include "base/dense_matrix.h"
#include "sym/diff.h"
#include "sym/integrate.h"
#include "sym/prove.h"
#include "sym/simplify.h"

enum { MOST_COORDINATES = 64 };

/* The one-forms in coordinates (q, t), w = n + 1: coefficients form[m * w] and exterior derivatives d[m * w * w],
 * antisymmetric. A zero coefficient is the null Expr. */
typedef struct {
  const Eqns *e;
  ExprGraph *g;
  uint32_t m, w;
  Expr *form, *d;
} Forms;

/* Adds x = d_j omega_k, the contribution of coefficient k to d omega_jk = d_j omega_k - d_k omega_j. */
static void add_derivative(Forms *f, uint32_t i, uint32_t j, uint32_t k, Expr x) {
  Expr *d = f->d + (size_t)i * f->w * f->w, *jk = &d[j * f->w + k], *kj = &d[k * f->w + j];
  if (j == k) return;
  *jk = *jk ? expr_add(f->g, *jk, x) : x;
  *kj = *kj ? expr_sub(f->g, *kj, x) : expr_neg(f->g, x);
}

static void differentiate(Forms *f, uint32_t i) {
  const Eqns *e = f->e;
  Expr rate, *in_time = ARENA_ARRAY(e->m->arena, Expr, expr_symbol_count(f->g) + 1);
  model_seed_time(e->m, in_time);
  for (uint32_t k = 0; k < f->w; k++) {
    Expr x = f->form[i * f->w + k];
    if (!x) continue;
    ExprPartials by_q = expr_gradient_sparse(f->g, x, SYM_COORD, e->n);
    for (uint32_t j = 0; j < by_q.n; j++) add_derivative(f, i, by_q.at[j].index, k, by_q.at[j].e);
    expr_tangent(f->g, &x, 1, (ExprSeeds){.at = in_time, .n = expr_symbol_count(f->g) + 1}, "'", NULL, &rate);
    add_derivative(f, i, e->n, k, rate);
  }
  for (uint32_t p = 0; p < f->w * f->w; p++) {
    Expr *x = &f->d[(size_t)i * f->w * f->w + p];
    if (*x) *x = simplify(f->g, *x);
    if (*x && expr_is_zero(f->g, *x)) *x = 0;
  }
}

static Forms make_forms(const Eqns *e) {
  const Constraints *all = &e->constraints;
  Forms f = {.e = e, .g = e->g, .m = all->n, .w = e->n + 1};
  f.form = ARENA_ARRAY(e->m->arena, Expr, (size_t)f.m * f.w);
  f.d = ARENA_ARRAY(e->m->arena, Expr, (size_t)f.m * f.w * f.w);
  for (uint32_t k = 0; k < all->A.n; k++) f.form[all->A.at[k].row * f.w + all->A.at[k].col] = all->A.at[k].e;
  for (uint32_t i = 0; i < all->n; i++) {
    Expr b = eqns_at_rest(e, all->r[i]);
    if (!expr_is_zero(e->g, b)) f.form[i * f.w + e->n] = b;
    if (i >= all->nholonomic) differentiate(&f, i);
  }
  return f;
}

/* --- by value --- */

/* Orthonormal basis[w * w]: first the span of the forms, then the directions that all forms allow. Returns the first
 * row of the latter. */
static uint32_t allowed(const Forms *f, const long double *form, long double *basis) {
  const long double independent = 1e-9L;
  uint32_t n = 0, first;
  for (uint32_t i = 0; i < f->m; i++) {
    for (uint32_t j = 0; j < f->w; j++) basis[n * f->w + j] = form[i * f->w + j];
    n += dense_gram_schmidt(f->w, basis + n * f->w, basis, n) > independent;
  }
  first = n;
  for (uint32_t i = 0; i < f->w && n < f->w; i++) {
    for (uint32_t j = 0; j < f->w; j++) basis[n * f->w + j] = j == i;
    n += dense_gram_schmidt(f->w, basis + n * f->w, basis, n) > independent;
  }
  return first;
}

/* Whether d omega_i vanishes on all pairs of allowed directions at this state. */
static int vanishes(const Forms *f, uint32_t i, const long double *symbols, const long double *basis, uint32_t first) {
  const long double nothing = 1e-9L;
  uint32_t w = f->w;
  long double *d = ARENA_ARRAY(f->e->m->arena, long double, (size_t)w * w);
  expr_eval(f->g, f->d + (size_t)i * w * w, w * w, symbols, d);
  for (uint32_t a = first; a < w; a++)
    for (uint32_t b = first; b < a; b++) {
      long double sum = 0, size = 0;
      for (uint32_t j = 0; j < w; j++)
        for (uint32_t k = 0; k < w; k++) {
          long double term = basis[a * w + j] * d[j * w + k] * basis[b * w + k];
          sum += term;
          size += fabsl(d[j * w + k]);
        }
      if (!(fabsl(sum) <= nothing * size)) return 0;
    }
  return 1;
}

/* Whether d omega_i vanishes on the allowed directions at a few random states; -1: no state on the constraints was
 * found. */
static int looks_integrable(const Forms *f, StateSolver *solver) {
  enum { TRIES = 12, ENOUGH = 4 };
  Arena *arena = f->e->m->arena;
  long double *symbols = ARENA_ARRAY(arena, long double, expr_symbol_count(f->g) + 1),
              *form = ARENA_ARRAY(arena, long double, (size_t)f->m * f->w);
  long double *basis = ARENA_ARRAY(arena, long double, (size_t)(f->w + 1) * f->w);
  int seen = 0;
  for (uint32_t seed = 1; seed <= TRIES && seen < ENOUGH; seed++) {
    sample_state(f->g, seed, symbols);
    if (!states_project(solver, symbols)) continue;
    expr_eval(f->g, f->form, f->m * f->w, symbols, form);
    uint32_t first = allowed(f, form, basis);
    for (uint32_t i = f->e->constraints.nholonomic; i < f->m; i++)
      if (!vanishes(f, i, symbols, basis, first)) return 0;
    seen++;
  }
  return seen ? 1 : -1;
}

/* --- proved --- */

static int is_closed(const Forms *f, uint32_t i) {
  for (uint32_t p = 0; p < f->w * f->w; p++)
    if (f->d[(size_t)i * f->w * f->w + p]) return 0;
  return 1;
}

/* Whether every d omega_i is 0, or there are too few dimensions for a nonholonomic constraint. */
static int is_proved(const Forms *f) {
  for (uint32_t i = f->e->constraints.nholonomic; i < f->m; i++)
    if (!is_closed(f, i) && f->m + 2 <= f->w) return 0;
  return 1;
}

Integrable frobenius(const Eqns *e, StateSolver *solver) {
  if (e->n > MOST_COORDINATES) return INTEGRABLE_UNDECIDED;
  Forms f = make_forms(e);
  int looks = looks_integrable(&f, solver);
  return looks == 0 ? INTEGRABLE_NO : is_proved(&f) ? INTEGRABLE_PROVED : INTEGRABLE_UNDECIDED;
}

Expr frobenius_leaf(const Eqns *e, Expr r) {
  const Model *m = e->m;
  ExprGraph *g = e->g;
  uint32_t n = e->n;
  for (uint32_t i = 0; i < m->inputs.n; i++) /* what u' integrates to is not known from u */
    if (!model_is_contact_switch(m, m->inputs.at[i].sym) && expr_contains_sym(g, r, m->inputs.at[i].sym)) return 0;
  if (n > MOST_COORDINATES) return 0;
  Expr *a = ARENA_ARRAY(m->arena, Expr, n + 1), rate = expr_int(g, 0);
  SymId *q = ARENA_ARRAY(m->arena, SymId, n + 1);
  for (uint32_t i = 0; i < n; i++) a[i] = expr_int(g, 0), q[i] = m->coords.at[i].q;
  ExprPartials row = expr_gradient_sparse(g, r, SYM_VEL, n);
  for (uint32_t i = 0; i < row.n; i++) a[row.at[i].index] = row.at[i].e;
  a[n] = eqns_at_rest(e, r), q[n] = m->time;
  Expr leaf = expr_potential(g, a, q, n + 1, 0);
  for (uint32_t i = 0; i <= n; i++) {
    Expr x = expr_diff(g, leaf, q[i]);
    rate = expr_add(g, rate, i < n ? expr_mul(g, x, expr_symbol(g, m->coords.at[i].v)->node) : x);
  }
  return prove_zero(g, expr_sub(g, rate, r), NULL) == PROVED_ZERO ? leaf : 0;
}
