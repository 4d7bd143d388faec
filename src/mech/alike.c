#include "mech/alike.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
  const Eqns *e;
  const StateValues *v;
  uint32_t *kind;           /* [n] the first coordinate of the same unit */
  long double *unit, *size; /* [n]; [m] of rows, by what is known */
  long double *tie;
} Alike;

static int by_size(const void *a, const void *b) {
  long double x = *(const long double *)a, y = *(const long double *)b;
  return (x > y) - (x < y);
}

/* Ties of the coordinates of a kind to what is known: one a constraint, one a product of velocities. */
static uint32_t find_ties(Alike *k, uint32_t kind) {
  const Entries *A = &k->e->constraints.A;
  uint32_t n = 0;
  for (uint32_t i = 0; i < k->e->mass.n; i++) {
    uint32_t row = k->e->mass.at[i].row, col = k->e->mass.at[i].col;
    for (int turn = 0; turn < 2 && row != col; turn++) {
      uint32_t here = turn ? col : row, other = turn ? row : col;
      long double x = fabsl(k->v->mass[i]) * k->unit[other];
      if (k->kind[here] == kind && x > 0) k->tie[n++] = x;
    }
  }
  for (uint32_t i = 0, end; i < A->n; i = end) {
    long double most = 0;
    for (end = i; end < A->n && A->at[end].row == A->at[i].row; end++)
      if (k->kind[A->at[end].col] == kind) most = fmaxl(most, fabsl(k->v->A[end]));
    if (most > 0 && k->size[A->at[i].row] > 0) k->tie[n++] = most / k->size[A->at[i].row];
  }
  return n;
}

/* Spreads what is known one turn further. Returns whether anything was found. */
static int spread(Alike *k) {
  const Entries *A = &k->e->constraints.A;
  uint32_t n = k->e->n, found = 0, unknown = UINT32_MAX;
  long double *new_unit = ARENA_ARRAY(k->e->m->arena, long double, n);
  for (uint32_t i = 0; i < k->e->constraints.n; i++) k->size[i] = 0;
  for (uint32_t i = 0; i < A->n; i++) k->size[A->at[i].row] = fmaxl(k->size[A->at[i].row], fabsl(k->v->A[i]) * k->unit[A->at[i].col]);
  for (uint32_t i = n; i-- > 0;) {
    if (k->unit[i] > 0 || k->kind[i] != i) continue;
    uint32_t ties = find_ties(k, i);
    unknown = i;
    if (!ties) continue;
    qsort(k->tie, ties, sizeof *k->tie, by_size);
    new_unit[i] = 1 / (sqrtl(k->tie[(ties - 1) / 2]) * sqrtl(k->tie[ties / 2]));
    found = 1;
  }
  if (!found && unknown != UINT32_MAX) new_unit[unknown] = found = 1; /* nothing says, nor matters */
  for (uint32_t i = 0; i < n; i++)
    if (new_unit[k->kind[i]] > 0) k->unit[i] = new_unit[k->kind[i]];
  return (int)found;
}

void alike_units(const Eqns *e, const StateValues *v, long double *unit) {
  const Model *m = e->m;
  uint32_t n = e->n;
  Alike k = {e, v, ARENA_ARRAY(m->arena, uint32_t, n + 1), unit, ARENA_ARRAY(m->arena, long double, e->constraints.n + 1),
             ARENA_ARRAY(m->arena, long double, 2 * (size_t)e->mass.n + e->constraints.A.n + 1)};
  for (uint32_t i = 0; i < n; i++) {
    while (strcmp(m->coords.at[k.kind[i]].unit.text, m->coords.at[i].unit.text) != 0) k.kind[i]++;
    unit[i] = 0;
  }
  for (uint32_t i = 0; i < e->mass.n; i++) {
    uint32_t row = e->mass.at[i].row;
    if (row == e->mass.at[i].col) unit[k.kind[row]] = fmaxl(unit[k.kind[row]], fabsl(v->mass[i]));
  }
  for (uint32_t i = n; i-- > 0;) unit[i] = unit[k.kind[i]] > 0 ? 1 / sqrtl(unit[k.kind[i]]) : 0;
  for (uint32_t turn = 0; turn <= n && spread(&k); turn++) {}
}
