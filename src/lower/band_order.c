/* The order of coupled coordinates in which a mass matrix has a narrow band: a search in breadth from an end of each
 * block (E. Cuthill, J. McKee, Proc. 24th ACM Nat. Conf. (1969) 157, DOI 10.1145/800195.805928), so that rings,
 * lattices and families of several coordinates a body are bands, too, for the loop of lag_solve. */
#include "lower/lower_impl.h"

/* Neighbours of coordinate i: to[from[i]] .. to[from[i + 1] - 1]. */
typedef struct {
  uint32_t *from, *to;
} Couplings;

static Couplings couplings_of(const Eqns *e, Arena *a) {
  const Entries *H = &e->system.H;
  Couplings c = {ARENA_ARRAY(a, uint32_t, e->n + 2), ARENA_ARRAY(a, uint32_t, 2 * (size_t)H->n + 1)};
  uint32_t *next = ARENA_ARRAY(a, uint32_t, e->n + 1);
  for (uint32_t k = 0; k < H->n; k++) c.from[H->at[k].row + 1]++, c.from[H->at[k].col + 1]++;
  for (uint32_t i = 0; i < e->n; i++) c.from[i + 1] += c.from[i], next[i] = c.from[i];
  for (uint32_t k = 0; k < H->n; k++) {
    c.to[next[H->at[k].row]++] = H->at[k].col;
    c.to[next[H->at[k].col]++] = H->at[k].row;
  }
  return c;
}

/* order := the coordinates of the block of `start`, nearest first; their number. */
static uint32_t in_breadth(const Couplings *c, uint32_t start, uint32_t *order, unsigned char *seen) {
  uint32_t n = 1;
  order[0] = start;
  seen[start] = 1;
  for (uint32_t k = 0; k < n; k++)
    for (uint32_t j = c->from[order[k]]; j < c->from[order[k] + 1]; j++) {
      if (seen[c->to[j]]) continue;
      seen[c->to[j]] = 1;
      order[n++] = c->to[j];
    }
  for (uint32_t k = 0; k < n; k++) seen[order[k]] = 0;
  return n;
}

/* Largest distance of coupled coordinates. */
static uint32_t band(const Couplings *c, const uint32_t *order, uint32_t n, const uint32_t *place) {
  uint32_t widest = 0;
  for (uint32_t k = 0; k < n; k++)
    for (uint32_t j = c->from[order[k]]; j < c->from[order[k] + 1]; j++) {
      uint32_t here = place[order[k]], there = place[c->to[j]];
      if (here > there + widest) widest = here - there;
    }
  return widest;
}

void lower_band_order(Lower *l, const uint32_t *first, uint32_t blocks, uint32_t *place) {
  const Eqns *e = l->e;
  Arena *a = l->p->arena;
  Couplings c = couplings_of(e, a);
  uint32_t *order = ARENA_ARRAY(a, uint32_t, e->n + 1), *other = ARENA_ARRAY(a, uint32_t, e->n + 1);
  unsigned char *seen = ARENA_ARRAY(a, unsigned char, e->n + 1);
  for (uint32_t k = 0; k < blocks; k++) {
    uint32_t n = in_breadth(&c, first[k], order, seen);
    n = in_breadth(&c, order[n - 1], order, seen);
    for (uint32_t i = 0; i < n; i++) other[order[i]] = i;
    if (2 * band(&c, order, n, other) >= band(&c, order, n, place)) continue; /* keeps the order of the text */
    for (uint32_t i = 0; i < n; i++) place[order[i]] = i;
  }
}
