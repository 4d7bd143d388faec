#include "mech/states.h"

#include <math.h>

#include "base/dense.h"
#include "mech/alike.h"

struct StateSolver {
  const Eqns *e;
  EvalTape *tape; /* the entries of M, then f, the flows, the energy; of constraints A, c, r, what A q'' is */
  uint32_t first_entry; /* of A in it */
  long double *out, *a, *b; /* its results; a system of equations, its right-hand side */
  long double *unit;        /* [n] of alike.h, at the state that was looked at last; unit[0] is 0: not known */
  uint32_t *column;
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
  for (uint32_t i = 0; i < e->mass.n; i++) roots[count++] = e->mass.at[i].e;
  for (uint32_t i = 0; i < n; i++) roots[count++] = e->f[i];
  for (uint32_t i = 0; i < s->nflows; i++) roots[count++] = e->flow[i];
  roots[count++] = e->energy;
  s->first_entry = count;
  for (uint32_t i = 0; i < k->A.n; i++) roots[count++] = k->A.at[i].e;
  for (uint32_t i = 0; i < k->nholonomic; i++) roots[count++] = k->c[i];
  for (uint32_t i = 0; i < k->n; i++) roots[count++] = k->r[i];
  for (uint32_t i = 0; i < k->n; i++) roots[count++] = k->demand[i];
  s->tape = eval_tape(e->g, roots, count);
  s->out = ARENA_ARRAY(arena, long double, count);
  s->a = ARENA_ARRAY(arena, long double, (size_t)total * total + 1);
  s->b = ARENA_ARRAY(arena, long double, total + 1);
  s->unit = ARENA_ARRAY(arena, long double, n + 1);
  s->column = ARENA_ARRAY(arena, uint32_t, total + 1);
  return s;
}

/* Values at a state: the tape's results. */
static const long double *run(StateSolver *s, const long double *symbols) {
  eval_run(s->tape, symbols, s->out);
  s->unit[0] = 0;
  return s->out;
}

static StateValues values_of(const StateSolver *s) {
  const Constraints *k = &s->e->constraints;
  const long double *out = s->out, *A = out + s->first_entry, *c = A + k->A.n, *r = c + k->nholonomic;
  return (StateValues){.mass = out, .A = A, .c = c, .r = r, .demand = r + k->n};
}

StateValues states_at(StateSolver *s, const long double *symbols) {
  run(s, symbols);
  return values_of(s);
}

/* The system [D -A^T; A 0] into a[(n + m)^2], D = M or 1. */
static void fill(StateSolver *s, int with_mass) {
  const Eqns *e = s->e;
  uint32_t n = e->n, w = n + e->constraints.n;
  const Entries *A = &e->constraints.A;
  const long double *values = s->out + s->first_entry;
  for (size_t i = 0; i < (size_t)w * w; i++) s->a[i] = 0;
  for (uint32_t i = 0; i < n && !with_mass; i++) s->a[i * w + i] = 1;
  for (uint32_t k = 0; k < e->mass.n && with_mass; k++) {
    const MassEntry *x = &e->mass.at[k];
    s->a[x->row * w + x->col] = s->a[x->col * w + x->row] = s->out[k];
  }
  for (uint32_t k = 0; k < A->n; k++) {
    uint32_t row = n + A->at[k].row, col = A->at[k].col;
    s->a[row * w + col] = values[k];
    s->a[col * w + row] = -values[k];
  }
}

/* The least change with A d = -g of the first rows; others are 0. 0 where there is none. */
static int change(StateSolver *s, const long double *g, uint32_t rows) {
  uint32_t n = s->e->n, m = s->e->constraints.n, w = n + m;
  fill(s, 0);
  for (uint32_t i = 0; i < w; i++) s->b[i] = i < n || i >= n + rows ? 0 : -g[i - n];
  for (uint32_t k = rows; k < m; k++) /* constraints on velocities do not hold back positions */
    for (uint32_t j = 0; j < n; j++) s->a[(n + k) * w + j] = s->a[j * w + n + k] = 0;
  dense_solve(w, s->a, s->b, 1e-13L, s->column, NULL);
  for (uint32_t i = 0; i < n; i++)
    if (!isfinite(s->b[i])) return 0;
  return 1;
}

static long double largest(const long double *x, uint32_t n) {
  long double most = 0;
  for (uint32_t i = 0; i < n; i++) most = isnan(x[i]) ? INFINITY : fmaxl(most, fabsl(x[i]));
  return most;
}

int states_obey(StateSolver *s, long double *symbols) {
  enum { MOST = 60 };
  const Constraints *k = &s->e->constraints;
  const Model *m = s->e->m;
  for (int i = 0; i < MOST; i++) {
    const long double *c = states_at(s, symbols).c;
    if (largest(c, k->nholonomic) < 1e-16L) break;
    if (i + 1 == MOST || !change(s, c, k->nholonomic)) return 0;
    for (uint32_t j = 0; j < s->e->n; j++) symbols[m->coords.at[j].q] += s->b[j];
  }
  if (!change(s, states_at(s, symbols).r, k->n)) return 0;
  for (uint32_t j = 0; j < s->e->n; j++) symbols[m->coords.at[j].v] += s->b[j];
  return largest(states_at(s, symbols).r, k->n) < 1e-12L;
}

uint32_t states_rank(StateSolver *s, uint32_t without, unsigned char *counts) {
  const long double independent = 6e-6L; /* a double's eps^(1/3), as in runtime/core/consistent.c: singular places are found to eps^(1/2) */
  const Eqns *e = s->e;
  const Entries *A = &e->constraints.A;
  uint32_t n = e->n, rank = 0, at = 0;
  StateValues v = values_of(s);
  if (!(s->unit[0] > 0)) alike_units(e, &v, s->unit);
  for (uint32_t k = 0; k < e->constraints.n; k++) {
    long double *row = s->a + (size_t)rank * n;
    for (uint32_t j = 0; j < n; j++) row[j] = 0;
    for (; at < A->n && A->at[at].row == k; at++) row[A->at[at].col] = v.A[at] * s->unit[A->at[at].col];
    counts[k] = k != without && dense_reduce(n, row, s->a, rank) > independent;
    rank += counts[k];
  }
  return rank;
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
  if (k->n && !states_obey(s, symbols)) return 0;
  const long double *demand = states_at(s, symbols).demand, *f = s->out + e->mass.n, *flow = f + n;
  fill(s, 1);
  for (uint32_t i = 0; i < n + k->n; i++) s->b[i] = i < n ? f[i] : demand[i - n];
  rank = dense_solve(n + k->n, s->a, s->b, k->n ? 1e-13L : 0, s->column, NULL);
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
