#include "mech/states.h"

#include <math.h>

struct StateSolver {
  const Eqns *e;
  EvalTape *tape; /* the entries of M, then f, then the flows, then the energy */
  long double *out, *a; /* its results; M with f as its last column */
  uint32_t nflows;
};

StateSolver *states_new(const Eqns *e) {
  Arena *arena = e->m->arena;
  StateSolver *s = ARENA_NEW(arena, StateSolver);
  uint32_t n = e->n, count = 0;
  s->e = e;
  s->nflows = e->m->states.n;
  Expr *roots = ARENA_ARRAY(arena, Expr, e->mass.n + n + s->nflows + 1);
  for (uint32_t i = 0; i < e->mass.n; i++) roots[count++] = e->mass.at[i].e;
  for (uint32_t i = 0; i < n; i++) roots[count++] = e->f[i];
  for (uint32_t i = 0; i < s->nflows; i++) roots[count++] = e->flow[i];
  roots[count++] = e->energy;
  s->tape = eval_tape(e->g, roots, count);
  s->out = ARENA_ARRAY(arena, long double, count);
  s->a = ARENA_ARRAY(arena, long double, n * (n + 1) + 1);
  return s;
}

static void swap_rows(long double *a, uint32_t w, uint32_t x, uint32_t y) {
  for (uint32_t k = 0; x != y && k < w; k++) {
    long double kept = a[x * w + k];
    a[x * w + k] = a[y * w + k];
    a[y * w + k] = kept;
  }
}

/* Gauss-Jordan with row exchange on n rows of n + 1; the last column becomes the solution. */
static int solve(long double *a, uint32_t n) {
  uint32_t w = n + 1;
  for (uint32_t c = 0; c < n; c++) {
    uint32_t best = c;
    for (uint32_t i = c + 1; i < n; i++)
      if (fabsl(a[i * w + c]) > fabsl(a[best * w + c])) best = i;
    if (!(fabsl(a[best * w + c]) > 0) || !isfinite(a[best * w + c])) return 0;
    swap_rows(a, w, c, best);
    for (uint32_t i = 0; i < n; i++) {
      long double ratio = a[i * w + c] / a[c * w + c];
      for (uint32_t k = c; i != c && k < w; k++) a[i * w + k] -= ratio * a[c * w + k];
    }
  }
  for (uint32_t i = 0; i < n; i++) {
    a[i * w + n] /= a[i * w + i];
    if (!isfinite(a[i * w + n])) return 0;
  }
  return 1;
}

int states_complete(StateSolver *s, long double *symbols) {
  const Eqns *e = s->e;
  const Model *m = e->m;
  uint32_t n = e->n, w = n + 1;
  eval_run(s->tape, symbols, s->out);
  const long double *f = s->out + e->mass.n, *flow = f + n;
  for (uint32_t i = 0; i < n * w; i++) s->a[i] = 0;
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *x = &e->mass.at[k];
    s->a[x->row * w + x->col] = s->a[x->col * w + x->row] = s->out[k];
  }
  for (uint32_t i = 0; i < n; i++) s->a[i * w + n] = f[i];
  if (!solve(s->a, n)) return 0;
  for (uint32_t i = 0; i < n; i++) symbols[m->coords.at[i].a] = s->a[i * w + n];
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
