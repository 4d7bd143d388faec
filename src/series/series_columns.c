/* series_columns: assigns a column to each sum and an index to each constant that `next` uses; the linear system
 * makes more than it uses. */
#include "series/series_impl.h"

/* Sums are accumulated in groups that stay in registers: up to 16 numbers, in vectors of 2 or 4. */
enum { LANES = 4, LEAST_GROUP = 8, MOST_GROUP = 16 };
enum { LEAST_SQUARES = 8 }; /* from so many squares on they get a loop of their own */

typedef struct {
  SeriesBuilder *m;
  unsigned char *slot, *pair; /* by slot of `next`, by pair: whether needed */
  VEC(Slot) open;
} Need;

static void need(Need *n, Slot s) {
  if (!s || n->slot[s]) return;
  n->slot[s] = 1;
  vec_push(n->m->arena, &n->open, s);
}

/* Marks slots and pairs that stores and solves need, backwards; a convolution sum needs coefficient k of both its
 * factors. */
static Need find_needed(SeriesBuilder *m) {
  const Prog *p = m->next;
  Need n = {.m = m,
            .slot = ARENA_ARRAY(m->arena, unsigned char, p->ins.n),
            .pair = ARENA_ARRAY(m->arena, unsigned char, m->pairs.n + 1)};
  for (uint32_t k = 0; k < p->stores.n; k++) need(&n, p->stores.at[k].slot);
  for (uint32_t k = 0; k < p->solves.n; k++) {
    for (uint32_t i = 0; i < solve_unknowns(&p->solves.at[k]); i++) need(&n, p->solves.at[k].rhs[i]);
    for (uint32_t i = 0; i < p->solves.at[k].list.n; i++) need(&n, p->solves.at[k].list.at[i].x);
  }
  while (n.open.n) {
    const Ins *i = &p->ins.at[n.open.at[--n.open.n]];
    need(&n, i->a);
    need(&n, i->b);
    need(&n, i->c);
    if (i->op != IR_LOAD || i->array != ARR_SUMS) continue;
    n.pair[i->index] = 1;
    need(&n, m->values.at[m->pairs.at[i->index].a].coef);
    need(&n, m->values.at[m->pairs.at[i->index].b].coef);
  }
  return n;
}

static int is_square(const SeriesBuilder *m, uint32_t pair) { return m->pairs.at[pair].a == m->pairs.at[pair].b; }
static uint32_t rounded(uint32_t n, uint32_t group) { return (n + group - 1) / group * group; }

/* The size of groups with the fewest columns of padding; of equal ones the largest. */
static void choose_group(Series *s, uint32_t sums, uint32_t squares) {
  uint32_t n = sums + squares, least = UINT32_MAX;
  s->sums = sums;
  s->squares = squares;
  for (uint32_t g = n <= LANES ? LANES : LEAST_GROUP; g <= MOST_GROUP; g += LANES) {
    uint32_t first = rounded(sums ? sums : 1, g), width = first + rounded(squares, g);
    if (width > least) continue;
    s->group = g;
    s->first_square = first;
    s->width = least = width;
  }
}

/* Assigns a column to each pair that is needed; squares come last where they are many. */
static void place_sums(SeriesBuilder *m, const Need *n, Series *s, uint32_t *column) {
  uint32_t pairs = 0, squares = 0;
  for (uint32_t i = 0; i < m->pairs.n; i++) {
    pairs += n->pair[i];
    squares += n->pair[i] && is_square(m, i);
  }
  if (squares < LEAST_SQUARES) squares = 0;
  choose_group(s, pairs - squares, squares);
  for (int turn = 0; turn <= (squares > 0); turn++) {
    while (turn && m->columns.n < s->first_square) vec_push(m->arena, &m->columns, UINT32_MAX);
    for (uint32_t i = 0; i < m->pairs.n; i++) {
      if (!n->pair[i] || (squares && is_square(m, i) != turn)) continue;
      column[i] = m->columns.n;
      vec_push(m->arena, &m->columns, i);
    }
  }
}

/* Renumbers the loads of sums and constants, and drops constants that are not needed. */
static void tell_loads(SeriesBuilder *m, const Need *n, const uint32_t *column, Series *out) {
  uint32_t *place = ARENA_ARRAY(m->arena, uint32_t, m->constants.n + 1), left = 0;
  for (Slot s = 1; s < m->next->ins.n; s++) {
    const Ins *i = &m->next->ins.at[s];
    if (n->slot[s] && i->op == IR_LOAD && i->array == ARR_STEP) place[i->index] = 1;
  }
  for (uint32_t i = 0; i < m->constants.n; i++) {
    if (!place[i]) continue;
    m->constants.at[left] = m->constants.at[i];
    place[i] = left++;
  }
  m->constants.n = out->constants = left;
  for (Slot s = 1; s < m->next->ins.n; s++) {
    Ins *i = &m->next->ins.at[s];
    if (i->op == IR_LOAD && i->array == ARR_SUMS) i->index = column[i->index];
    if (i->op == IR_LOAD && i->array == ARR_STEP) i->index = place[i->index];
  }
}

void series_columns(SeriesBuilder *m, Series *s) {
  uint32_t *column = ARENA_ARRAY(m->arena, uint32_t, m->pairs.n + 1);
  Need n = find_needed(m);
  place_sums(m, &n, s, column);
  tell_loads(m, &n, column, s);
  for (uint32_t c = 0; c < m->columns.n; c++) {
    uint32_t i = m->columns.at[c];
    if (i != UINT32_MAX) prog_store(m->next, 2, c, m->values.at[m->pairs.at[i].a].coef, "");
  }
  for (uint32_t c = 0; c < s->sums; c++)
    prog_store(m->next, 3, c, m->values.at[m->pairs.at[m->columns.at[c]].b].coef, "");
  for (uint32_t i = 0; i < m->constants.n; i++) prog_store(m->first, 1, i, m->constants.at[i], "");
}
