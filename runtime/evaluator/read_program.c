/* Programs from bytes, checked: no index leaves what it indexes, and every program ends. */
#include "evaluator/read_program.h"

#include <math.h>
#include <string.h>

enum { FRAME_MOST = 1 << 27, LARGEST = INT32_MAX };

static const struct {
  const char *kinds;
} codes[] = {
#define ONE(name, kinds, ...) {kinds},
#define BOTH(name, kinds, ...) {kinds}, {kinds "d"},
    PROGRAM_CODES(ONE, ONE, BOTH)
#undef ONE
#undef BOTH
};

static const int operands_of[] = {
#define OP(name, operands, formula) operands,
    PROGRAM_TURN_OPS(OP, OP)
#undef OP
};

static int ends_within(uint64_t at, uint64_t n, int64_t length) {
  return length > 0 && n > 0 && at + n <= (uint64_t)length;
}

/* --- parts --- */

static const Curve *read_curves(Bytes *b, uint32_t n) {
  Curve *c = lag_bytes_room(b, n, sizeof *c);
  for (uint32_t k = 0; c && k < n; k++) {
    c[k].order = lag_bytes_int(b, 0, 2);
    c[k].columns = lag_bytes_int(b, 3, 4);
    c[k].n = (int)lag_bytes_count(b, 24);
    lag_bytes_need(b, c[k].n >= 2 && (c[k].columns == 4 || !c[k].order), "a table is too short");
    c[k].row = lag_bytes_numbers(b, (size_t)c[k].n * (size_t)c[k].columns);
  }
  return c;
}

/* Work space that lag_solve and lag_kkt use, in doubles. */
static int64_t work_of(int64_t n, int64_t m) {
  int64_t system = n * n + m * n + n + m;
  return system + (m ? n * n + m * n + m * m + 2 * n + 9 * m : 0);
}

static const System *read_systems(Bytes *b, const Program *p, uint32_t n) {
  enum { MOST = 1 << 13 };
  System *s = lag_bytes_room(b, n, sizeof *s);
  for (uint32_t k = 0; s && k < n; k++) {
    s[k].n = lag_bytes_int(b, 0, MOST);
    s[k].m = lag_bytes_int(b, 0, MOST);
    s[k].coarse = lag_bytes_int(b, 0, 1);
    s[k].entries = lag_bytes_count(b, 8);
    s[k].entry = lag_bytes_words(b, 2 * s[k].entries);
    lag_bytes_need(b, work_of(s[k].n, s[k].m) <= p->nwork, "a system has too little room");
    uint64_t size = (uint64_t)(s[k].n + s[k].m) * (uint64_t)(s[k].n + 1);
    for (uint32_t i = 0; !b->why && i < s[k].entries; i++)
      lag_bytes_need(b, s[k].entry[2 * i] < size && s[k].entry[2 * i + 1] < p->frame, "a system reads out of range");
    for (uint32_t i = 1; !b->why && i < s[k].entries; i++)
      lag_bytes_need(b, s[k].entry[2 * i] > s[k].entry[2 * i - 2], "the elements of a system are out of order");
  }
  return s;
}

/* --- nests --- */

typedef struct {
  double least, most;
} Range;

static void widen(Range *r, double x) {
  r->least = fmin(r->least, x);
  r->most = fmax(r->most, x);
}

/* Indices of a subscript in all turns, at the corners of the loops. Sizes below 2^52 keep the sums exact. */
static Range range_of(Bytes *b, const Nest *n, uint32_t k) {
  const Subscript *s = &n->at[k];
  const double limit = 4503599627370496.0;
  Range r = {INFINITY, -INFINITY};
  for (int corner = 0; corner < 4; corner++) {
    double i = corner & 1 ? (double)(n->rows - 1) : 0, from = (double)n->skew * i,
           end = (double)(n->skew + n->more) * i + (double)n->turns,
           j = corner & 2 ? end - 1 : from,
           rows = (double)s->by_row * i, turns = (double)s->by_turn * j;
    lag_bytes_need(b, end > from, "a loop has no turns");
    lag_bytes_need(b, fabs(rows) < limit && fabs(j) < limit && fabs(turns) < limit, "a loop is too long");
    widen(&r, (double)s->first + rows + turns);
  }
  return r;
}

static int is_within(Range r, int64_t length) { return r.least >= 0 && r.most < (double)length; }

static void check_load(Bytes *b, const Program *p, const Lengths *of, const Nest *n, TurnIns *i) {
  if (i->op == TURN_CONSTANT) lag_bytes_need(b, i->number < p->nconstants, "a turn reads out of range");
  if (i->op == TURN_OUTER) lag_bytes_need(b, i->number < n->nouter, "a turn reads out of range");
  if (i->op == TURN_SCALAR)
    lag_bytes_need(b, i->a < PROGRAM_CONSTANTS && of->in[i->a] > 0, "a turn reads out of range");
  if (i->op != TURN_ELEMENT && i->op != TURN_CELL && i->op != TURN_INDEX) return;
  if (i->op == TURN_INDEX) i->a = 0;
  if (!lag_bytes_need(b, i->number < n->nsubscripts && i->a <= PROGRAM_CONSTANTS, "a turn reads out of range")) return;
  int64_t length = i->op == TURN_CELL ? p->ncells : i->a < PROGRAM_CONSTANTS ? of->in[i->a] : 0;
  lag_bytes_need(b, i->op == TURN_INDEX || is_within(range_of(b, n, i->number), length), "a turn reads out of range");
  if (b->why) return;
  int rows = n->at[i->number].by_row != 0 || i->op == TURN_CELL; /* rows may change sums */
  i->level = n->at[i->number].by_turn ? IN_TURN : rows ? IN_ROW : IN_NEST;
}

static void check_turn(Bytes *b, const Program *p, const Lengths *of, const Nest *n, uint32_t s, TurnIns *all) {
  TurnIns *i = &all[s - 1];
  if (!lag_bytes_need(b, i->op < TURN_OPS, "a turn has an unknown operation")) return;
  int operands = operands_of[i->op];
  if (!operands) check_load(b, p, of, n, i);
  if (operands < 1) i->a = i->op == TURN_ELEMENT || i->op == TURN_SCALAR ? i->a : 0;
  if (operands < 2) i->b = 0;
  if (operands < 3) i->c = 0;
  const uint32_t of_op[] = {operands ? i->a : 0, i->b, i->c};
  for (int k = 0; k < 3; k++)
    if (lag_bytes_need(b, of_op[k] < s, "a turn reads what comes later") && of_op[k] &&
        all[of_op[k] - 1].level > i->level)
      i->level = all[of_op[k] - 1].level;
  if (i->op == TURN_FUNCTION) lag_bytes_need(b, i->number < lag_functions_1_count, "an unknown function");
  if (i->op == TURN_FUNCTION_2) lag_bytes_need(b, i->number < lag_functions_2_count, "an unknown function");
}

/* Turns that read a sum come after those that may add to it. */
static TurnOrder order_of_turns(Bytes *b, const Nest *n) {
  TurnOrder order = ANY_ORDER;
  for (uint32_t s = 0; s < n->nins; s++)
    for (uint32_t k = 0; n->ins[s].op == TURN_CELL && k < n->nsums; k++) {
      Range x = range_of(b, n, n->ins[s].number), y = range_of(b, n, n->sum[k].subscript);
      if (x.least > y.most || y.least > x.most) continue;
      if (n->sum[k].moves) return TURN_BY_TURN;
      order = ROW_BY_ROW;
    }
  return order;
}

/* Whether two sums have no element in common in a row: their ranges are apart, or their indices differ modulo their
 * common stride. */
static int are_apart(Bytes *b, const Nest *n, uint32_t i, uint32_t k) {
  Range x = range_of(b, n, i), y = range_of(b, n, k);
  const Subscript *s = &n->at[i], *t = &n->at[k];
  int64_t step = s->by_turn, rows = s->by_row - t->by_row;
  return x.least > y.most || y.least > x.most ||
         (step == t->by_turn && step != 0 && rows % step == 0 && (s->first - t->first) % step != 0);
}

static int sums_are_apart(Bytes *b, const Nest *n) {
  for (uint32_t i = 0; i < n->nsums; i++)
    for (uint32_t k = 0; k < i && n->sum[i].moves; k++)
      if (n->sum[k].moves && !are_apart(b, n, n->sum[i].subscript, n->sum[k].subscript)) return 0;
  return 1;
}

/* The order of execution within a level: loads come first, as in C. */
static void order_turn(Bytes *b, Nest *n) {
  uint32_t *order = lag_bytes_room(b, n->nins, sizeof *order), at = 0;
  for (int part = 0; order && part < 2 * LEVELS; part++) {
    for (uint32_t s = 1; s <= n->nins; s++)
      if ((int)n->ins[s - 1].level == part / 2 && (n->ins[s - 1].op > TURN_OUTER) == part % 2) order[at++] = s;
    n->end[part / 2] = at;
  }
  n->order = order;
}

/* Rows of neighbours: turn j of row i is member j of the place of which row i is member `turns` + i, in q. */
static void read_near(Bytes *b, const Lengths *of, Nest *n) {
  Near *x = &n->near;
  x->n = lag_bytes_below(b, 4);
  for (uint32_t k = 0; k < x->n; k++) {
    x->at_i[k] = lag_bytes_below(b, n->nsubscripts);
    x->at_j[k] = lag_bytes_below(b, n->nsubscripts);
    x->side[k] = lag_bytes_below(b, n->nouter + 1);
    if (b->why) return;
    const Subscript *i = &n->at[x->at_i[k]], *j = &n->at[x->at_j[k]];
    lag_bytes_need(b, is_within(range_of(b, n, x->at_i[k]), of->in[PROGRAM_Q]) && j->first >= 0 && j->by_turn > 0 &&
                          j->by_turn < LARGEST && !j->by_row && !i->by_turn && i->by_row == j->by_turn &&
                          i->first == j->first + n->turns * j->by_turn,
                   "neighbours are out of range");
  }
  if (!x->n) return;
  x->cut = lag_bytes_below(b, n->nouter);
  x->test = lag_bytes_below(b, n->nins + 1);
  lag_bytes_need(b, n->skew == 0 && n->more == 1 && n->turns > 0, "neighbours are out of range");
  x->members = (int)(n->rows + n->turns);
}

static int64_t bounded(Bytes *b) {
  int64_t x = lag_bytes_signed(b);
  return lag_bytes_need(b, x > -LARGEST && x < LARGEST, "a loop is too long") ? x : 0;
}

/* Elements first, first + by ... of n are of an array with so many. */
static int reaches_within(int first, int by, int n, int64_t length) {
  return first >= 0 && by > 0 && first + (int64_t)by * (n - 1) < length;
}

static void read_far(Bytes *b, const Program *p, const Lengths *of, Nest *n) {
  Far *x = &n->far;
  x->n = (int)lag_bytes_below(b, 4);
  if (!x->n || b->why) return;
  x->members = lag_bytes_int(b, 1, LARGEST), x->charge = lag_bytes_int(b, 0, LARGEST);
  x->step = (int)bounded(b), x->by = (int)bounded(b), x->energy = (int)bounded(b);
  int fits = reaches_within(x->charge, 1, x->members, p->ncells) && x->energy >= -1 && x->energy < (int64_t)p->ncells;
  for (int k = 0; k < 3; k++) x->numbers[k] = lag_bytes_below(b, n->nouter);
  for (int k = 0; k < x->n; k++) {
    x->first[k] = (int)bounded(b), x->slope[k] = (int)bounded(b);
    fits &= reaches_within(x->first[k], x->step, x->members, of->in[PROGRAM_Q]);
    fits &= x->slope[k] == -1 || reaches_within(x->slope[k], x->by, x->members, p->ncells);
  }
  lag_bytes_need(b, fits, "a tree is out of range");
}

static void read_turn(Bytes *b, const Program *p, const Lengths *of, Nest *n) {
  n->nins = lag_bytes_count(b, 20);
  TurnIns *ins = lag_bytes_room(b, n->nins, sizeof *ins);
  for (uint32_t s = 1; ins && s <= n->nins; s++) {
    const uint32_t *x = lag_bytes_words(b, 5);
    if (x) ins[s - 1] = (TurnIns){x[0], x[1], x[2], x[3], x[4], IN_NEST};
    if (x) check_turn(b, p, of, n, s, ins);
  }
  n->ins = ins;
  read_near(b, of, n);
  read_far(b, p, of, n);
  n->nsums = lag_bytes_count(b, 12);
  TurnSum *sum = lag_bytes_room(b, n->nsums, sizeof *sum);
  for (uint32_t k = 0; sum && k < n->nsums; k++) {
    sum[k].how = lag_bytes_below(b, NEST_SETS + PROGRAM_OUTPUTS);
    sum[k].subscript = lag_bytes_below(b, n->nsubscripts);
    sum[k].value = lag_bytes_below(b, n->nins + 1);
    if (b->why) return;
    sum[k].moves = n->at[sum[k].subscript].by_turn != 0;
    int sets = sum[k].how >= NEST_SETS;
    lag_bytes_need(b, sum[k].how < 2 || (sets && sum[k].moves && !n->near.n), "a turn stores a sum");
    lag_bytes_need(b, is_within(range_of(b, n, sum[k].subscript), sets ? of->out[sum[k].how - NEST_SETS] : p->ncells),
                   "a turn adds out of range");
  }
  n->sum = sum;
  if (!b->why) order_turn(b, n);
  if (!b->why) n->turn_order = order_of_turns(b, n), n->apart = sums_are_apart(b, n);
}

/* Refuses damaged sizes that would run for ever: no sum has more turns than its arrays have pairs of elements, but for
 * short ones over indices alone. */
static void check_turns(Bytes *b, const Program *p, const Lengths *of, const Nest *n) {
  const double short_ones = 0x1p26;
  double longest = p->ncells, rows = (double)n->rows, last = (double)n->turns + (double)n->more * (rows - 1);
  for (int k = 0; k < PROGRAM_ARRAY_COUNT; k++) longest = fmax(longest, (double)of->in[k]);
  double turns = rows * fmax(1, fmax((double)n->turns, last));
  lag_bytes_need(b, turns <= fmax(longest * longest, short_ones), "a loop has more turns than elements");
}

static void read_nest(Bytes *b, const Program *p, const Lengths *of, Nest *n) {
  n->rows = lag_bytes_int(b, 1, LARGEST);
  int has_turns = lag_bytes_int(b, 0, 1);
  n->skew = bounded(b), n->turns = bounded(b), n->more = bounded(b);
  if (!has_turns) n->turns = n->rows, n->rows = 1, n->skew = n->more = 0;
  n->nsubscripts = lag_bytes_count(b, 24);
  Subscript *at = lag_bytes_room(b, n->nsubscripts, sizeof *at);
  for (uint32_t k = 0; at && k < n->nsubscripts; k++)
    at[k].first = bounded(b), at[k].by_row = bounded(b), at[k].by_turn = bounded(b);
  for (uint32_t k = 0; at && !has_turns && k < n->nsubscripts; k++) at[k].by_turn = at[k].by_row, at[k].by_row = 0;
  n->at = at;
  n->nouter = lag_bytes_count(b, 4);
  n->outer = lag_bytes_words(b, n->nouter);
  for (uint32_t k = 0; !b->why && k < n->nouter; k++)
    lag_bytes_need(b, n->outer[k] < p->frame, "a nest reads out of range");
  if (!b->why) check_turns(b, p, of, n);
  if (!b->why) read_turn(b, p, of, n);
}

static const Nest *read_nests(Bytes *b, const Program *p, const Lengths *of, uint32_t count) {
  Nest *n = lag_bytes_room(b, count, sizeof *n);
  for (uint32_t k = 0; n && !b->why && k < count; k++) read_nest(b, p, of, &n[k]);
  return n;
}

/* --- words --- */

/* Elements that a code moves between an array and the frame. */
static uint32_t moved(uint32_t c, const uint32_t *at) {
  if (c == CODE_READ || c == CODE_WRITE) return at[3];
  return c == CODE_READ_2 || c == CODE_WRITE_2 ? 2 : 1;
}

static int moves_within(const Program *p, int64_t length, const uint32_t *at, uint32_t n) {
  return ends_within(at[1], n, length) && (uint64_t)at[2] + n <= p->frame;
}

static int is_operand(const Program *p, const Lengths *of, uint32_t c, char kind, const uint32_t *at) {
  switch (kind) {
  case 'a':
  case 'd': return at[0] < p->frame;
  case 'f': return at[0] < lag_functions_1_count;
  case 'F': return at[0] < lag_functions_2_count;
  case 't': return at[0] < p->ncurves;
  case 's': return at[0] < p->nsystems;
  case 'n': return at[0] < p->nnests;
  case 'i':
    return at[0] <= PROGRAM_CONSTANTS &&
           moves_within(p, at[0] == PROGRAM_CONSTANTS ? p->nconstants : of->in[at[0]], at, moved(c, at));
  case 'o': return at[0] < PROGRAM_OUTPUTS && moves_within(p, of->out[at[0]], at, moved(c, at));
  default: return 1; /* k, with the array */
  }
}

static void check_words(Bytes *b, const Program *p, const Lengths *of) {
  int ended = 0;
  for (uint32_t k = 0; !b->why && k < p->nwords;) {
    uint32_t c = p->words[k++];
    if (!lag_bytes_need(b, c < CODES && !ended, "an unknown code")) return;
    ended = c == CODE_END;
    const char *kinds = codes[c].kinds;
    uint32_t wide = (uint32_t)strlen(kinds) + (strpbrk(kinds, "io") != NULL);
    if (!lag_bytes_need(b, p->nwords - k >= wide, "a program ends too early")) return;
    for (; *kinds; k += *kinds == 'i' || *kinds == 'o' ? 2 : 1, kinds++)
      lag_bytes_need(b, is_operand(p, of, c, *kinds, p->words + k), "an operand is out of range");
  }
  lag_bytes_need(b, ended, "a program ends too early");
}

static int part_of_frame(const Program *p, uint32_t at, uint32_t n) { return (uint64_t)at + n <= p->frame; }

/* Room for the values of the turns of a nest: of one nest at a time. */
static void add_scratch(Bytes *b, Program *p) {
  uint64_t most = 0;
  for (uint32_t k = 0; !b->why && k < p->nnests; k++) {
    uint64_t need = ((uint64_t)p->nests[k].nins + 1) * NEST_BLOCK + p->nests[k].nsums + 1;
    if (p->nests[k].near.n) need += lag_near_room(p->nests[k].near.members);
    if (p->nests[k].far.n) need += lag_tree_room(p->nests[k].far.members);
    if (need > most) most = need;
  }
  lag_bytes_need(b, most < FRAME_MOST, "a nest is too large");
  p->scratch = p->frame;
  p->frame += (uint32_t)most;
}

const Program *lag_read_program(Bytes *b, const Lengths *of) {
  if (!lag_bytes_below(b, 2)) return NULL;
  Program *p = lag_bytes_room(b, 1, sizeof *p);
  if (!p) return NULL;
  p->frame = lag_bytes_below(b, FRAME_MOST);
  p->regular = lag_bytes_int(b, 0, 1);
  p->cells = lag_bytes_word(b), p->ncells = lag_bytes_word(b);
  p->work = lag_bytes_word(b), p->nwork = lag_bytes_word(b);
  lag_bytes_need(b, p->frame >= 1 && part_of_frame(p, p->cells, p->ncells) && part_of_frame(p, p->work, p->nwork),
                 "a frame is too small");
  p->nconstants = lag_bytes_count(b, 8);
  p->constants = lag_bytes_numbers(b, p->nconstants);
  p->ncurves = lag_bytes_count(b, 12);
  p->curves = read_curves(b, p->ncurves);
  p->nsystems = lag_bytes_count(b, 16);
  p->systems = read_systems(b, p, p->nsystems);
  p->nnests = lag_bytes_count(b, 40);
  p->nests = read_nests(b, p, of, p->nnests);
  p->nwords = lag_bytes_count(b, 4);
  p->words = lag_bytes_words(b, p->nwords);
  if (!b->why) check_words(b, p, of);
  if (!b->why) add_scratch(b, p);
  return b->why ? NULL : p;
}
