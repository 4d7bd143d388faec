/* Two tapes evaluate a state, M and constraints alone for projections and ranks, f, flows and energy where a motion
 * is completed; sparse elimination solves [M -A^T; A 0] and the projections. */
#include "mech/states.h"

#include <float.h>
#include <math.h>

#include "base/row_span.h"
#include "base/tolerance.h"

struct StateSolver {
  const Eqns *e;
  EvalTape *tape, *forces; /* entries of M, entries of A, c, r, demand; f, flows, energy */
  long double *out, *f, *b; /* the tapes' results; right-hand side and solution */
  SparseElements a;     /* matrix of the linear system */
  SparseVector row;     /* a scaled row of A */
  /* [n + m] exponents of states_column_scale for the system's unknowns, at the state evaluated last */
  int *scale;
  int scaled;               /* scale is known for that state */
  uint32_t nflows;
};

StateSolver *states_new(const Eqns *e) {
  Arena *arena = e->m->arena;
  StateSolver *s = ARENA_NEW(arena, StateSolver);
  const Constraints *k = &e->constraints;
  uint32_t n = e->n, count = 0, total = n + k->n;
  s->e = e;
  s->nflows = e->m->states.n;
  Expr *roots = ARENA_ARRAY(arena, Expr, e->mass.n + n + s->nflows + 1 + k->A.n + 3 * (size_t)k->n);
  for (uint32_t i = 0; i < n; i++) roots[count++] = e->f[i];
  for (uint32_t i = 0; i < s->nflows; i++) roots[count++] = e->flow[i];
  roots[count++] = e->energy;
  s->forces = eval_tape(e->g, roots, count);
  s->f = ARENA_ARRAY(arena, long double, count);
  count = 0;
  for (uint32_t i = 0; i < e->mass.n; i++) roots[count++] = e->mass.at[i].e;
  for (uint32_t i = 0; i < k->A.n; i++) roots[count++] = k->A.at[i].e;
  for (uint32_t i = 0; i < k->nholonomic; i++) roots[count++] = k->c[i];
  for (uint32_t i = 0; i < k->n; i++) roots[count++] = k->r[i];
  for (uint32_t i = 0; i < k->n; i++) roots[count++] = k->demand[i];
  s->tape = eval_tape(e->g, roots, count);
  s->out = ARENA_ARRAY(arena, long double, count);
  s->b = ARENA_ARRAY(arena, long double, total + 1);
  s->scale = ARENA_ARRAY(arena, int, total + 1);
  return s;
}

static StateValues values_of(const StateSolver *s) {
  const Constraints *k = &s->e->constraints;
  const long double *out = s->out, *A = out + s->e->mass.n, *c = A + k->A.n, *r = c + k->nholonomic;
  return (StateValues){.mass = out, .A = A, .c = c, .r = r, .demand = r + k->n};
}

StateValues states_at(StateSolver *s, const long double *symbols) {
  eval_run(s->tape, symbols, s->out);
  s->scaled = 0;
  return values_of(s);
}

void states_put_mass(const Eqns *e, const long double *values, SparseElements *a) {
  Arena *arena = e->m->arena;
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *x = &e->mass.at[k];
    sparse_put(arena, a, x->row, x->col, values[k]);
    if (x->row != x->col) sparse_put(arena, a, x->col, x->row, values[k]);
  }
}

void states_put_constraints(const Eqns *e, const long double *values, uint32_t rows, SparseElements *a) {
  const Entries *A = &e->constraints.A;
  for (uint32_t k = 0; k < A->n; k++) {
    uint32_t row = e->n + A->at[k].row, col = A->at[k].col;
    if (A->at[k].row >= rows) continue;
    sparse_put(e->m->arena, a, row, col, values[k]);
    sparse_put(e->m->arena, a, col, row, -values[k]);
  }
}

/* s->a := [D -A^T; A 0] with the first rows of A; D = M or the unit matrix. */
static void fill(StateSolver *s, int with_mass, uint32_t rows) {
  const Eqns *e = s->e;
  s->a.n = 0;
  if (with_mass) states_put_mass(e, s->out, &s->a);
  for (uint32_t i = 0; i < e->n && !with_mass; i++) sparse_put(e->m->arena, &s->a, i, i, 1);
  states_put_constraints(e, values_of(s).A, rows, &s->a);
}

/* s->b[n] := the least d with A d = -g for the first rows. 0: not finite. */
static int least_change(StateSolver *s, const long double *g, uint32_t rows) {
  uint32_t n = s->e->n, m = s->e->constraints.n, w = n + m;
  fill(s, 0, rows); /* positions: holonomic rows only, since constraints on velocities do not restrict positions */
  for (uint32_t i = 0; i < w; i++) s->b[i] = i < n || i >= n + rows ? 0 : -g[i - n];
  sparse_solve(s->e->m->arena, w, &s->a, s->b, 1e-13L, NULL);
  for (uint32_t i = 0; i < n; i++)
    if (!isfinite(s->b[i])) return 0;
  return 1;
}

static long double largest(const long double *x, uint32_t n) {
  long double most = 0;
  for (uint32_t i = 0; i < n; i++) most = isnan(x[i]) ? INFINITY : fmaxl(most, fabsl(x[i]));
  return most;
}

static SymId symbol_at(const Model *m, uint32_t j, int velocities) {
  return velocities ? m->coords.at[j].v : m->coords.at[j].q;
}

/* Largest absolute value of the coordinates, or of the velocities. */
static long double motion_size(const StateSolver *s, const long double *symbols, int velocities) {
  long double most = 0;
  for (uint32_t j = 0; j < s->e->n; j++) most = fmaxl(most, fabsl(symbols[symbol_at(s->e->m, j, velocities)]));
  return most;
}

/* Whether the residuals of the first rows are rounding: smaller than relative changes of 1e-12 in the motion would
 * cause, whatever the scale of a constraint. */
static int are_small(const StateSolver *s, const long double *residual, uint32_t rows, long double size) {
  const Entries *A = &s->e->constraints.A;
  const long double *values = values_of(s).A;
  for (uint32_t k = 0, at = 0; k < rows; k++) {
    long double steepness = 0;
    for (; at < A->n && A->at[at].row == k; at++) steepness += fabsl(values[at]);
    if (!(fabsl(residual[k]) <= 1e-12L * steepness * size) && !(fabsl(residual[k]) < LONG_TOLERANCE(1e-16L))) return 0;
  }
  return 1;
}

/* Newton's method for positions or velocities, until the corrections are rounding. 0: no convergence. */
static int project(StateSolver *s, long double *symbols, int velocities) {
  enum { MOST = 60 };
  const long double rounding = 64 * LDBL_EPSILON;
  const Constraints *k = &s->e->constraints;
  uint32_t rows = velocities ? k->n : k->nholonomic;
  /* scale for a motion that ends at 0 */
  long double moved = INFINITY, size = 0, least = fminl(motion_size(s, symbols, velocities), 1);
  for (int i = 0; i < MOST && moved > rounding * size; i++) {
    StateValues v = states_at(s, symbols);
    if (!least_change(s, velocities ? v.r : v.c, rows)) return 0;
    for (uint32_t j = 0; j < s->e->n; j++) symbols[symbol_at(s->e->m, j, velocities)] += s->b[j];
    moved = largest(s->b, s->e->n);
    size = fmaxl(motion_size(s, symbols, velocities), least);
  }
  StateValues v = states_at(s, symbols);
  return moved <= LONG_TOLERANCE(1e-15L) * size && are_small(s, velocities ? v.r : v.c, rows, size);
}

int states_project(StateSolver *s, long double *symbols) { return project(s, symbols, 0) && project(s, symbols, 1); }

const SparseElements *states_system(StateSolver *s) {
  fill(s, 1, s->e->constraints.n);
  return &s->a;
}

const int *states_column_scale(StateSolver *s) {
  if (!s->scaled) {
    sparse_equilibrate(s->e->m->arena, s->e->n + s->e->constraints.n, states_system(s), NULL, s->scale);
    s->scaled = 1;
  }
  return s->scale;
}

const SparseVector *states_row(StateSolver *s, uint32_t k, uint32_t *at) {
  const Entries *A = &s->e->constraints.A;
  const int *scale = states_column_scale(s);
  const long double *values = values_of(s).A;
  s->row.n = 0;
  for (; *at < A->n && A->at[*at].row == k; ++*at)
    vec_push(s->e->m->arena, &s->row, ((RowElement){A->at[*at].col, ldexpl(values[*at], scale[A->at[*at].col])}));
  return &s->row;
}

uint32_t states_rank(StateSolver *s, uint32_t without, unsigned char *counts, long double *held) {
  /* a double's eps^(1/3), as in runtime/constraints/nearest_start.c: singular places are found to eps^(1/2) */
  const long double independent = 6e-6L;
  uint32_t at = 0, n = s->e->n;
  RowSpan span = row_span(s->e->m->arena, n);
  for (uint32_t j = 0; held && j < n; j++) held[j] = 0;
  for (uint32_t k = 0; k < s->e->constraints.n; k++) {
    const SparseVector *row = states_row(s, k, &at);
    counts[k] = k != without && row_span_add(&span, row->at, row->n, independent) > independent;
    for (uint32_t j = 0; held && counts[k] && j < n; j++) held[j] += span.left[j] * span.left[j];
  }
  return span.rank;
}

int states_complete(StateSolver *s, long double *symbols) {
  const Eqns *e = s->e;
  const Model *m = e->m;
  const Constraints *k = &e->constraints;
  uint32_t n = e->n, rank;
  for (uint32_t i = 0; i < k->n; i++) symbols[k->of[i]->multiplier] = 0;
  for (uint32_t i = 0; i < m->contacts.n; i++) {
    SymId closed = m->contacts.at[i].closed;
    symbols[closed] = e->definitions && !expr_is_zero(e->g, e->definitions[closed]);
  }
  if (k->n && !states_project(s, symbols)) return 0;
  const long double *demand = states_at(s, symbols).demand, *f = s->f, *flow = f + n;
  eval_run(s->forces, symbols, s->f);
  for (uint32_t i = 0; i < n + k->n; i++) s->b[i] = i < n ? f[i] : demand[i - n];
  rank = sparse_solve(m->arena, n + k->n, states_system(s), s->b, k->n ? 1e-13L : 0, NULL);
  if (rank < n + k->n && !k->n) return 0;
  for (uint32_t i = 0; i < n + k->n; i++)
    if (!isfinite(s->b[i])) return 0;
  for (uint32_t i = 0; i < n; i++) symbols[m->coords.at[i].a] = s->b[i];
  for (uint32_t i = 0; i < k->n; i++) symbols[k->of[i]->multiplier] = s->b[n + i];
  for (uint32_t i = 0; i < s->nflows; i++) {
    symbols[m->states.at[i].rate] = flow[i];
    if (!isfinite(flow[i])) return 0;
  }
  symbols[m->energy_sym] = flow[s->nflows];
  return 1;
}

Expr states_substitute(const Eqns *e, Expr x) {
  const Model *m = e->m;
  Expr *with = ARENA_ARRAY(m->arena, Expr, expr_symbol_count(e->g) + 1);
  with[m->energy_sym] = e->energy;
  for (uint32_t i = 0; i < m->states.n; i++) with[m->states.at[i].rate] = e->flow[i];
  return expr_substitute(e->g, x, with, expr_symbol_count(e->g) + 1, "");
}
