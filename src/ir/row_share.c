/* Nests that threads share (row_share.h).
 *
 * A sum gets its terms in the order of rows, and of turns in each, as long as a tile follows the tiles of the same
 * turns above it, and those of the same rows before it. Two tiles of which one is above and the other before the other
 * have no order: no sum may get terms from both. So turns add to sums of their own column; a sum of a row that columns
 * meet, too, as of half sums over pairs, is reached by columns of later rows only (triangles below the diagonal) or of
 * earlier ones only (above it). */
#include "ir/row_share.h"

int nest_never_meet(const Nest *n, uint32_t i, uint32_t k) {
  const LoopRange range = {n->rows, n->skew, n->turns, n->more};
  const IrSubscript *x = &n->at[i], *y = &n->at[k];
  int64_t x0, x1, y0, y1, steps = subscript_step(&(Subscript){0, subscript_step(x), subscript_step(y)});
  if (steps && (x->first - y->first) % steps) return 1;
  return !loop_extent(&range, x, &x0, &x1) || !loop_extent(&range, y, &y0, &y1) || x0 > y1 || y0 > x1;
}

/* The column j = i + shift in which row i has the sum of a row; 0: there is none. */
static int column_of(const Nest *n, uint32_t k, uint32_t moving, int64_t *shift) {
  const IrSubscript *own = &n->at[k], *turn = &n->at[moving];
  const int64_t gap = own->first - turn->first;
  if (own->by_row != turn->by_turn || turn->by_row || gap % turn->by_turn) return 0;
  *shift = gap / turn->by_turn;
  return 1;
}

/* Whether turns of later rows alone, or of earlier ones alone, meet the sum at[k] of a row. */
static int meets_in_order(const Nest *n, uint32_t k, uint32_t moving) {
  const int64_t last = (int64_t)n->rows - 1;
  int64_t shift;
  if (!column_of(n, k, moving, &shift)) return 0;
  const int64_t end = last + shift;
  return (nest_to(n, 0) <= shift && nest_to(n, last) <= end) || (nest_from(n, 0) > shift && nest_from(n, last) > end);
}

/* The same where one thread adds up all of a member: row i is that of member nest_to, whose column it has. */
static int is_member(const Nest *n, uint32_t k, uint32_t moving) {
  int64_t shift;
  return column_of(n, k, moving, &shift) && nest_to(n, 0) == shift && n->skew + n->more == 1;
}

static int reads_own_sums(const Nest *n) {
  const Prog *p = n->body;
  for (Slot s = 1; s < p->ins.n; s++)
    for (uint32_t k = 0; k < p->stores.n && p->ins.at[s].op == IR_LOAD && p->ins.at[s].array == ARR_CELL; k++)
      if (p->stores.at[k].array != NEST_TEST && !nest_never_meet(n, p->ins.at[s].index, p->stores.at[k].index))
        return 1;
  return 0;
}

/* Whether sums of stores k and m may be added up side by side. */
static int are_apart(const Nest *n, uint32_t k, uint32_t m, int listed) {
  const int moves = nest_moves(n, k), other = nest_moves(n, m);
  if ((!moves && !other && !listed) || nest_never_meet(n, k, m)) return 1;
  if (moves == other) return 0;
  const uint32_t own = moves ? m : k, turn = moves ? k : m;
  return listed ? is_member(n, own, turn) : meets_in_order(n, own, turn);
}

static int sums_are_apart(const Nest *n, int listed) {
  const Prog *p = n->body;
  for (uint32_t k = 0; k < p->stores.n; k++) {
    const uint32_t at = p->stores.at[k].index;
    if (p->stores.at[k].array == NEST_TEST) continue;
    if (nest_moves(n, at) && n->at[at].by_row) return 0;
    for (uint32_t m = 0; m < k; m++)
      if (p->stores.at[m].array != NEST_TEST && !are_apart(n, at, p->stores.at[m].index, listed)) return 0;
  }
  return 1;
}

RowShare nest_row_share(const Nest *n, int listed, double times) {
  /* sizes from which two threads gain: turns of a nest, members of lists and trees */
  enum { TURNS = 30000, MEMBERS = 2000 };
  const int64_t last = (int64_t)n->rows - 1;
  const double rows = n->rows * times, turns = n->count * times;
  if (listed && n->far.n) return n->far.members * times < MEMBERS ? SHARE_NONE : SHARE_TREE;
  const int lists = listed && n->near.n;
  if (nest_sets(n) || n->rows < 2 || !nest_has_turns(n) || (lists ? rows + 1 < MEMBERS : turns < TURNS))
    return SHARE_NONE;
  if (n->skew < 0 || n->skew + n->more < 0 || nest_to(n, last) > INT32_MAX) return SHARE_NONE;
  if (lists && (n->skew || n->more != 1)) return SHARE_NONE;
  if (reads_own_sums(n) || !sums_are_apart(n, lists)) return SHARE_NONE;
  return lists ? SHARE_LISTS : SHARE_TILES;
}

int unit_shares(const ProgramSet *u, int listed) {
  ProgList all = program_set_programs(u);
  int some = 0;
  for (uint32_t i = 0; i < all.n; i++)
    for (uint32_t k = 0; k < all.at[i]->nests.n; k++)
      some |= nest_row_share(&all.at[i]->nests.at[k], listed, u->times) != SHARE_NONE;
  return some;
}
