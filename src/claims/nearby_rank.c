/* Singular starts: constraints that are dependent at a state but not a hundredth away, as for bars in one line. Ranks by orthogonalising
 * the scaled rows of A. */
#include "claims/nearby_rank.h"

#include <math.h>

#include "mech/consistent_start.h"
#include "numeric/consistent_state.h"

/* Rank of the constraints at the state evaluated last. held[n]: squared length of each coordinate direction's projection on the rows of A. */
static uint32_t rank_of(const Eqns *e, StateSolver *s, long double *held) {
  const long double independent = 6e-6L; /* as states_rank */
  uint32_t n = e->n, at = 0;
  RowSpan span = row_span(e->m->arena, n);
  for (uint32_t j = 0; j < n; j++) held[j] = 0;
  for (uint32_t k = 0; k < e->constraints.n; k++) {
    const SparseVector *row = states_row(s, k, &at);
    if (!(row_span_add(&span, row->at, row->n, independent) > independent)) continue;
    for (uint32_t j = 0; j < n; j++) held[j] += span.left[j] * span.left[j];
  }
  return span.rank;
}

uint32_t nearby_rank(const Eqns *e, StateSolver *s, const long double *symbols, long double *loose) {
  Arena *arena = e->m->arena;
  uint32_t n = e->n, all = expr_symbol_count(e->g) + 1;
  long double *held = ARENA_ARRAY(arena, long double, n + 1), *held_beside = ARENA_ARRAY(arena, long double, n + 1), *there = ARENA_ARRAY(arena, long double, all);
  states_at(s, symbols);
  uint32_t here = rank_of(e, s, held), rank = here;
  for (uint32_t i = 0; i < all; i++) there[i] = symbols[i];
  if (n > 1 && start_beside(e, s, there)) rank = rank_of(e, s, held_beside);
  for (uint32_t i = 0; i < n; i++) loose[i] = 0;
  if (rank <= here) return here;
  lag_loose_directions((int)n, held, held_beside, loose);
  return rank;
}
