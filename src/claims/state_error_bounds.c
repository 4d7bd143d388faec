/* Bounds from residuals, block by block: |K^-1| times the residual and its rounding, with K = [D -A^T; A 0], D = 1
 * for coordinates and velocities, D = M for accelerations and multipliers. */
#include "claims/state_error_bounds.h"

#include <float.h>
#include <math.h>

#include "base/dense_matrix.h"
#include "base/union_find.h"
#include "sym/prove.h"

typedef long double Real;

enum { COUPLED_MOST = 160 }; /* unknowns in one block: an inverse costs their cube */

struct StateErrorBounds {
  const Eqns *e;
  BoundTape *tape;       /* roots: M, f, A, c, r, demand */
  uint32_t width;        /* n + constraints */
  uint32_t *block;       /* [width] union-find of coupled unknowns */
  uint32_t *in;          /* [width] the unknowns of the current block */
  unsigned char *counts; /* counts[k]: constraint k is independent of those before it */
  Real *symbols;         /* with multipliers 0, as f is without them */
  Real *K, *dK;          /* [width^2] the current system, and bounds of its entries' errors */
  Real *part, *inverse;  /* a block of K, and its inverse */
};

StateErrorBounds *state_error_bounds_new(const Eqns *e) {
  Arena *a = e->m->arena;
  const Constraints *k = &e->constraints;
  StateErrorBounds *w = ARENA_NEW(a, StateErrorBounds);
  VEC(Expr) roots = {0};
  for (uint32_t i = 0; i < e->mass.n; i++) vec_push(a, &roots, e->mass.at[i].e);
  for (uint32_t i = 0; i < e->n; i++) vec_push(a, &roots, e->f[i]);
  for (uint32_t i = 0; i < k->A.n; i++) vec_push(a, &roots, k->A.at[i].e);
  for (uint32_t i = 0; i < k->nholonomic; i++) vec_push(a, &roots, k->c[i]);
  for (uint32_t i = 0; i < k->n; i++) vec_push(a, &roots, k->r[i]);
  for (uint32_t i = 0; i < k->n; i++) vec_push(a, &roots, k->demand[i]);
  *w = (StateErrorBounds){.e = e, .tape = bound_tape(e->g, roots.at, roots.n), .width = e->n + k->n};
  size_t n = w->width;
  w->block = union_find_new(a, w->width);
  w->in = ARENA_ARRAY(a, uint32_t, n + 1);
  w->counts = ARENA_ARRAY(a, unsigned char, n + 1);
  w->symbols = ARENA_ARRAY(a, Real, expr_symbol_count(e->g) + 1);
  w->K = ARENA_ARRAY(a, Real, n * n + 1);
  w->dK = ARENA_ARRAY(a, Real, n * n + 1);
  size_t most = n < COUPLED_MOST ? n : COUPLED_MOST;
  w->part = ARENA_ARRAY(a, Real, most * most + 1);
  w->inverse = ARENA_ARRAY(a, Real, most * most + 1);
  for (uint32_t i = 0; i < e->mass.n; i++) union_find_join(w->block, e->mass.at[i].row, e->mass.at[i].col);
  for (uint32_t i = 0; i < k->A.n; i++) union_find_join(w->block, e->n + k->A.at[i].row, k->A.at[i].col);
  return w;
}

static Real value_of(const StateErrorBounds *w, Expr x, Real *bound) { return bound_value(w->tape, x, bound); }

/* K = [D -A^T; A 0] with D = M or 1; the row of a constraint that depends on others is that of the unit matrix. */
static void fill_system(StateErrorBounds *w, int with_mass) {
  const Eqns *e = w->e;
  uint32_t n = e->n, width = w->width;
  for (size_t i = 0; i < (size_t)width * width; i++) w->K[i] = w->dK[i] = 0;
  for (uint32_t i = 0; i < n && !with_mass; i++) w->K[i * width + i] = 1;
  for (uint32_t i = 0; i < e->mass.n && with_mass; i++) {
    uint32_t row = e->mass.at[i].row, col = e->mass.at[i].col;
    Real bound, value = value_of(w, e->mass.at[i].e, &bound);
    w->K[row * width + col] = w->K[col * width + row] = value;
    w->dK[row * width + col] = w->dK[col * width + row] = bound;
  }
  for (uint32_t i = 0; i < e->constraints.A.n; i++) {
    uint32_t row = n + e->constraints.A.at[i].row, col = e->constraints.A.at[i].col;
    Real bound, value = value_of(w, e->constraints.A.at[i].e, &bound);
    if (!w->counts[row - n]) continue;
    w->K[row * width + col] = value;
    w->K[col * width + row] = -value;
    w->dK[row * width + col] = w->dK[col * width + row] = bound;
  }
  for (uint32_t k = 0; k < e->constraints.n; k++)
    if (!w->counts[k]) w->K[(n + k) * width + n + k] = 1;
}

/* Bounds out = 2 |K^-1| off of the unknowns for residuals of size off, block by block. The factor 2 covers errors dK
 * of the entries while |K^-1| dK is small. 0: it is not. */
static int bound_unknowns(StateErrorBounds *w, const Real *off, Real *out) {
  uint32_t width = w->width;
  for (uint32_t b = 0; b < width; b++) {
    uint32_t n = 0;
    for (uint32_t i = 0; i < width; i++)
      if (union_find_root(w->block, i) == b) w->in[n++] = i;
    for (uint32_t i = 0; i < n && n > COUPLED_MOST; i++) out[w->in[i]] = INFINITY;
    if (!n || n > COUPLED_MOST) continue;
    for (uint32_t i = 0; i < n; i++)
      for (uint32_t k = 0; k < n; k++) w->part[i * n + k] = w->K[w->in[i] * width + w->in[k]];
    if (!dense_invert(w->e->m->arena, n, w->part, w->inverse)) return 0;
    for (uint32_t i = 0; i < n; i++) {
      Real sum = 0, loss = 0;
      for (uint32_t k = 0; k < n; k++) {
        Real size = fabsl(w->inverse[i * n + k]), row = 0;
        sum += size * off[w->in[k]];
        for (uint32_t j = 0; j < n; j++) row += w->dK[w->in[k] * width + w->in[j]];
        loss += size * row;
      }
      out[w->in[i]] = 2 * sum;
      if (!(loss < 0.1L) || !isfinite(sum)) return 0;
    }
  }
  return 1;
}

/* Bounds of coordinates (velocities) from the residuals of the constraints and the rounding in these. */
static int bound_motion(StateErrorBounds *w, int velocities, Real *errors) {
  const Eqns *e = w->e;
  const Constraints *k = &e->constraints;
  uint32_t n = e->n;
  Real *off = ARENA_ARRAY(e->m->arena, Real, w->width + 1), *out = ARENA_ARRAY(e->m->arena, Real, w->width + 1);
  bound_run(w->tape, w->symbols, errors);
  fill_system(w, 0);
  for (uint32_t i = 0; i < (velocities ? k->n : k->nholonomic); i++) {
    Real bound, value = value_of(w, velocities ? k->r[i] : k->c[i], &bound);
    if (w->counts[i]) off[n + i] = fabsl(value) + bound;
  }
  if (!bound_unknowns(w, off, out)) return 0;
  for (uint32_t i = 0; i < n; i++) errors[velocities ? e->m->coords.at[i].v : e->m->coords.at[i].q] = out[i];
  return 1;
}

static SymId unknown(const Eqns *e, uint32_t i) {
  return i < e->n ? e->m->coords.at[i].a : e->constraints.of[i - e->n]->multiplier;
}

/* Bounds of accelerations and multipliers from the residuals of the equations of motion; multipliers are free if
 * constraints are redundant. */
static int bound_solution(StateErrorBounds *w, const Real *symbols, int free, Real *errors) {
  const Eqns *e = w->e;
  uint32_t n = e->n, width = w->width;
  Real *off = ARENA_ARRAY(e->m->arena, Real, width + 1), *out = ARENA_ARRAY(e->m->arena, Real, width + 1);
  bound_run(w->tape, w->symbols, errors);
  fill_system(w, 1);
  for (uint32_t i = 0; i < width; i++) {
    Real bound, left = value_of(w, i < n ? e->f[i] : e->constraints.demand[i - n], &bound), size = fabsl(left);
    if (i >= n && !w->counts[i - n]) continue;
    for (uint32_t k = 0; k < width; k++) {
      Real x = symbols[unknown(e, k)], term = w->K[i * width + k] * x;
      left -= term;
      size += fabsl(term);
      bound += w->dK[i * width + k] * fabsl(x);
    }
    off[i] = fabsl(left) + bound + (Real)(width + 4) * LDBL_EPSILON * size;
  }
  if (!bound_unknowns(w, off, out)) return 0;
  for (uint32_t i = 0; i < width; i++) errors[unknown(e, i)] = i >= n && free ? INFINITY : out[i];
  return 1;
}

/* Whether some constraint depends on others and is not that of an open contact. */
static int dependent(const StateErrorBounds *w) {
  const Entries *A = &w->e->constraints.A;
  Real bound;
  int some = 0;
  for (uint32_t i = 0; i < A->n; i++) some |= !w->counts[A->at[i].row] && value_of(w, A->at[i].e, &bound) != 0;
  return some;
}

int state_error_bounds_at(StateErrorBounds *w, StateSolver *solver, const long double *symbols, long double *errors) {
  const Eqns *e = w->e;
  uint32_t count = expr_symbol_count(e->g) + 1;
  for (uint32_t i = 0; i < count; i++) {
    errors[i] = 0;
    w->symbols[i] = symbols[i];
  }
  for (uint32_t i = 0; i < e->constraints.n; i++) w->symbols[e->constraints.of[i]->multiplier] = 0;
  if (e->constraints.n) {
    states_at(solver, w->symbols);
    states_rank(solver, UINT32_MAX, w->counts, NULL);
    if (!bound_motion(w, 0, errors) || !bound_motion(w, 1, errors)) return 0;
  }
  bound_run(w->tape, w->symbols, errors);
  return bound_solution(w, symbols, dependent(w), errors);
}
