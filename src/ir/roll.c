/* Searches straight-line code for loops, from the first instruction on: at each position the period and number of
 * iterations that cover most of the code; then the stores that loops take over, and the values that later iterations
 * or later code need. */
#include "ir/roll.h"

#include <string.h>

enum { LONGEST_PERIOD = 400, FEWEST_TURNS = 8, MOST_BACK = 2 };

/* Class by operation and kinds of operands: instructions of one class may be turns of one loop. Solves, nests,
 * tables and titles have classes of their own. */
static uint32_t class_of(const Prog *p, Slot s) {
  const Ins *i = &p->ins.at[s];
  if (i->op == IR_SOLVE || i->op == IR_SOLVED || i->op == IR_NEST || i->op == IR_TITLE || i->op == IR_TABLE)
    return UINT32_MAX - s;
  uint32_t h = (uint32_t)i->op * 31 + i->index;
  for (const char *c = i->text; c && *c; c++) h = (h ^ (unsigned char)*c) * 16777619u;
  for (int k = 0; k < 3; k++) { /* kinds of operands that must agree: none, array, number, value */
    Slot x = ins_operand(i, k);
    h = h * 5 + (!x                             ? 0
                 : !ir_is_leaf(p->ins.at[x].op) ? 1
                 : p->ins.at[x].op == IR_LOAD   ? 2 + 8 * (uint32_t)p->ins.at[x].array
                                                : 3);
  }
  return h & 0x3fffffffu;
}

typedef struct {
  Rolls *r;
  const uint32_t *cls; /* by place */
  unsigned by_index;
  /* by period: end of the run of classes that are equal a period later, as last computed by equal_classes */
  uint32_t *equal_until;
  uint32_t *failed;    /* by period: place, from 1, of an instruction that ended a group: all groups with it fail */
} Search;

static const Ins *code_at(const Rolls *r, uint32_t place) { return &r->p->ins.at[r->code[place]]; }

/* Place of x in the code; only for values that are no leaves. */
static uint32_t place_of(const Rolls *r, Slot x) { return r->place[x] - 1; }

int roll_number(const Ins *x, const Ins *y, Num *unit, int64_t *first) {
  enum { LARGEST = 1 << 22 };
  if (x->op != IR_CONST || y->op != IR_CONST || !num_is_exact(x->number) || !num_is_exact(y->number)) return 0;
  *unit = num_sub(y->number, x->number);
  if (!num_is_exact(*unit) || num_is_zero(*unit) || unit->den > LARGEST) return 0;
  Num times = num_div(x->number, *unit);
  *first = times.num;
  return num_is_exact(times) && times.den == 1 && times.num > -LARGEST && times.num < LARGEST && unit->num > -LARGEST &&
         unit->num < LARGEST;
}

uint32_t roll_constants(const Prog *p, uint32_t k) {
  const Store *x = p->stores.at + k;
  const Ins *at = p->ins.at;
  Num unit = num_int(0);
  int64_t first = 0;
  uint32_t n = 1;
  for (; k + n < p->stores.n && x[n].array == x->array && x[n].index == x->index + n; n++) {
    if (x[n].slot == x->slot && (n == 1 || num_is_zero(unit))) continue;
    if (n == 1 && !roll_number(&at[x->slot], &at[x[1].slot], &unit, &first)) break;
    if (num_is_zero(unit) || at[x[n].slot].op != IR_CONST ||
        !num_equal(at[x[n].slot].number, num_mul(unit, num_int(first + n))))
      break;
  }
  return n;
}

static Step step_between(const Rolls *r, uint32_t begin, uint32_t period, Slot x, Slot y) {
  if (x == y) return (Step){.kind = STEP_SAME};
  if (!r->place[x] && r->p->ins.at[x].op != IR_LOAD) return (Step){.kind = STEP_NUMBER};
  if (!r->place[x]) {
    int64_t d = (int64_t)r->p->ins.at[y].index - (int64_t)r->p->ins.at[x].index;
    return (Step){.kind = STEP_LOAD, .step = d};
  }
  int64_t from = place_of(r, x), d = (int64_t)place_of(r, y) - from;
  if (from >= begin) return (Step){.kind = STEP_OWN, .step = d};
  if (d == period && from + MOST_BACK * (int64_t)period >= begin) {
    uint32_t back = (uint32_t)((begin - from + period - 1) / period);
    return (Step){.kind = STEP_BEFORE, .step = d, .back = back};
  }
  return (Step){.kind = STEP_OTHER, .step = d};
}

Step roll_step(const Rolls *r, const Loop *l, uint32_t offset, int which) {
  Slot x = ins_operand(code_at(r, l->begin + offset), which),
       y = ins_operand(code_at(r, l->begin + l->period + offset), which);
  Step s = step_between(r, l->begin, l->period, x, y);
  if (s.kind == STEP_OTHER) s.step /= (int64_t)r->loops.at[r->loop[place_of(r, x)] - 1].period;
  return s;
}

/* Number of turns, at most `most`, in which the operand follows the step from its first to its second value. */
static uint32_t turns_of(const Search *f, uint32_t begin, uint32_t period, uint32_t offset, int which, uint32_t most) {
  const Rolls *r = f->r;
  Slot x = ins_operand(code_at(r, begin + offset), which), y = ins_operand(code_at(r, begin + period + offset), which);
  Step s = step_between(r, begin, period, x, y);
  const Ins *first = &r->p->ins.at[x];
  uint32_t in = 0; /* the loop of x, from 1, for STEP_OTHER */
  Num unit = {0};
  int64_t multiple = 0;
  /* a value of the first iteration, which later iterations cannot use */
  if (s.kind == STEP_SAME && r->place[x] && place_of(r, x) >= begin) return 1;
  if (s.kind == STEP_NUMBER && !roll_number(first, &r->p->ins.at[y], &unit, &multiple)) return 1;
  if (s.kind == STEP_LOAD && (first->op != IR_LOAD || !(f->by_index >> first->array & 1))) return 1;
  if (s.kind == STEP_OWN && s.step != period) return 1;
  if (s.kind == STEP_OTHER) {
    in = r->loop[place_of(r, x)];
    if (!in) return 1;
    if (s.step % (int64_t)r->loops.at[in - 1].period != 0) return 1;
  }
  for (uint32_t t = 1; t < most; t++) {
    Slot z = ins_operand(code_at(r, begin + t * period + offset), which);
    const Ins *now = &r->p->ins.at[z];
    int follows =
        s.kind == STEP_SAME     ? z == x
        : s.kind == STEP_NUMBER ? now->op == IR_CONST && num_equal(now->number, num_mul(unit, num_int(multiple + t)))
        : s.kind == STEP_LOAD   ? now->op == IR_LOAD && now->index == (uint32_t)((int64_t)first->index + t * s.step)
                                : r->place[z] && (int64_t)place_of(r, z) == (int64_t)place_of(r, x) + t * s.step &&
                                    (!in || r->loop[place_of(r, z)] == in);
    if (!follows) return t;
  }
  return most;
}

/* Whether operands that are one value in the first turn are one value in the second. */
static int same_sharing(const Rolls *r, uint32_t begin, uint32_t period, uint32_t offset) {
  const Ins *x = code_at(r, begin + offset), *y = code_at(r, begin + period + offset);
  return (x->a == x->b) == (y->a == y->b) && (x->a == x->c) == (y->a == y->c) && (x->b == x->c) == (y->b == y->c);
}

/* Number of instructions from `begin` on whose classes equal those a period later. The search only moves forward, so
 * that each period is compared once. */
static uint32_t equal_classes(const Search *f, uint32_t begin, uint32_t period) {
  uint32_t *to = &f->equal_until[period];
  if (*to <= begin)
    for (*to = begin; *to + period < f->r->n && f->cls[*to] == f->cls[*to + period];) ++*to;
  return *to - begin;
}

/* Number of turns, at most `most`, in which all instructions of the group go on; records failures. */
static uint32_t turns_within(const Search *f, uint32_t begin, uint32_t period, uint32_t most) {
  const Rolls *r = f->r;
  uint32_t turns = equal_classes(f, begin, period) / period + 1;
  if (turns > most) turns = most;
  for (uint32_t k = 0; k < period && turns >= FEWEST_TURNS; k++) {
    if (!same_sharing(r, begin, period, k)) turns = 1;
    for (int which = 0; which < 3 && turns >= FEWEST_TURNS; which++)
      if (ins_operand(code_at(r, begin + k), which)) turns = turns_of(f, begin, period, k, which, turns);
    if (turns < FEWEST_TURNS) f->failed[period] = begin + k + 1;
  }
  return turns;
}

/* Number of turns of the group; 1 when there are fewer than FEWEST_TURNS. */
static uint32_t turns_at(const Search *f, uint32_t begin, uint32_t period) {
  if (begin < f->failed[period] || turns_within(f, begin, period, FEWEST_TURNS) < FEWEST_TURNS) return 1;
  return turns_within(f, begin, period, f->r->n / period + 1);
}

/* Number of operands that a loop takes from earlier turns. */
static uint32_t carried(const Rolls *r, const Loop *l) {
  uint32_t n = 0;
  for (uint32_t k = 0; k < l->period; k++)
    for (int which = 0; which < 3; which++) {
      Slot x = ins_operand(code_at(r, l->begin + k), which),
           y = ins_operand(code_at(r, l->begin + l->period + k), which);
      n += x && step_between(r, l->begin, l->period, x, y).kind == STEP_BEFORE;
    }
  return n;
}

/* Moves the loop's start so that the fewest values pass between iterations; this may cost one iteration. */
static Loop best_rotation(const Search *f, Loop l) {
  Loop best = l;
  uint32_t least = carried(f->r, &l);
  for (uint32_t k = 1; k < l.period && l.count > FEWEST_TURNS; k++) {
    Loop x = {.begin = l.begin + k, .period = l.period, .count = l.count - 1};
    uint32_t n = carried(f->r, &x);
    if (n >= least || turns_at(f, x.begin, x.period) < x.count) continue;
    least = n;
    best = x;
  }
  return best;
}

/* The loop at `begin` that covers most code; of about equal ones the shorter period. */
static Loop longest_at(const Search *f, uint32_t begin) {
  Loop best = {.begin = begin, .period = 1};
  for (uint32_t period = 1; period <= LONGEST_PERIOD && begin + period < f->r->n; period++) {
    if (equal_classes(f, begin, period) <= best.count * best.period) continue; /* too short a code to win */
    uint32_t turns = turns_at(f, begin, period);
    if (turns >= FEWEST_TURNS && turns * period > best.count * best.period + period)
      best = (Loop){.begin = begin, .period = period, .count = turns};
  }
  return best;
}

/* --- values that loops store, keep and carry --- */

/* Stores of one value of a loop. by_turn: 1 + the number of the store; 0: none. */
typedef struct {
  uint32_t *by_turn;
  int twice; /* a turn stores the value at two places */
} Stored;

static int is_even(const Rolls *r, const Loop *l, const uint32_t *by_turn) {
  const Store *at = r->p->stores.at;
  for (uint32_t t = 0; t < l->count; t++)
    if (!by_turn[t]) return 0;
  const Store *first = &at[by_turn[0] - 1], *second = &at[by_turn[1] - 1];
  int64_t step = (int64_t)second->index - first->index;
  for (uint32_t t = 0; t < l->count; t++) {
    const Store *now = &at[by_turn[t] - 1];
    if (now->array != first->array || (int64_t)now->index != first->index + t * step) return 0;
  }
  return 1;
}

/* Moves into the loop the stores of values that each turn stores once, at equally spaced indices. */
static void find_stores(Rolls *r) {
  Arena *a = r->p->arena;
  Stored **of = ARENA_ARRAY(a, Stored *, r->loops.n + 1);
  for (uint32_t k = 0; k < r->p->stores.n; k++) {
    Slot x = r->p->stores.at[k].slot;
    uint32_t place = x && r->place[x] ? place_of(r, x) : 0, in = x && r->place[x] ? r->loop[place] : 0;
    if (!in) continue;
    const Loop *l = &r->loops.at[in - 1];
    if (!of[in - 1]) of[in - 1] = ARENA_ARRAY(a, Stored, l->period);
    Stored *s = &of[in - 1][loop_offset(l, place)];
    if (!s->by_turn) s->by_turn = ARENA_ARRAY(a, uint32_t, l->count);
    uint32_t *turn = &s->by_turn[loop_turn(l, place)];
    if (*turn) s->twice = 1;
    *turn = k + 1;
  }
  for (uint32_t in = 0; in < r->loops.n; in++) {
    Loop *l = &r->loops.at[in];
    for (uint32_t k = 0; of[in] && k < l->period; k++) {
      const Stored *s = &of[in][k];
      if (!s->by_turn || s->twice || !is_even(r, l, s->by_turn)) continue;
      const Store *first = &r->p->stores.at[s->by_turn[0] - 1], *second = &r->p->stores.at[s->by_turn[1] - 1];
      LoopStore now = {k, first->array, first->index, (int64_t)second->index - first->index, first->comment,
                       r->p->stores.at[s->by_turn[l->count - 1] - 1].comment};
      vec_push(a, &l->stores, now);
      for (uint32_t t = 0; t < l->count; t++) r->stored[s->by_turn[t] - 1] = 1;
    }
  }
}

static void keep(Rolls *r, uint32_t place, uint32_t back) {
  const Loop *l = &r->loops.at[r->loop[place] - 1];
  uint32_t *kept = &l->kept[loop_offset(l, place)];
  if (*kept < back + 1) *kept = back + 1;
}

/* Keeps a value of a loop that an instruction or store outside of the loop needs. */
static void keep_from(Rolls *r, Slot x, uint32_t user) {
  if (!x || !r->place[x]) return;
  uint32_t at = place_of(r, x), in = r->loop[at];
  if (!in || (user < r->n && r->loop[user] == in)) return;
  const Loop *l = &r->loops.at[in - 1];
  keep(r, at, 0);
  if (loop_turn(l, at) + 1 < l->count) l->carried[loop_offset(l, at)] = 0;
}

/* Keeps the values that turns take from earlier turns. */
static void keep_carried(Rolls *r) {
  for (uint32_t k = 0; k < r->loops.n; k++) {
    const Loop *l = &r->loops.at[k];
    for (uint32_t offset = 0; offset < l->period; offset++)
      for (int which = 0; which < 3; which++) {
        if (!ins_operand(code_at(r, l->begin + offset), which)) continue;
        Step s = roll_step(r, l, offset, which);
        if (s.kind != STEP_BEFORE) continue;
        uint32_t from = place_of(r, ins_operand(code_at(r, l->begin + offset), which)) + s.back * l->period;
        keep(r, from, s.back);
      }
    for (uint32_t offset = 0; offset < l->period; offset++) l->carried[offset] &= l->kept[offset] == 2;
  }
}

static void find_kept(Rolls *r) {
  for (uint32_t k = 0; k < r->loops.n; k++) memset(r->loops.at[k].carried, 1, r->loops.at[k].period);
  for (uint32_t k = 0; k < r->n; k++) {
    const Ins *i = code_at(r, k);
    for (uint32_t j = 0; j < prog_operands(r->p, i); j++) keep_from(r, prog_operand(r->p, i, j), k);
  }
  for (uint32_t k = 0; k < r->p->stores.n; k++)
    if (!r->stored[k]) keep_from(r, r->p->stores.at[k].slot, UINT32_MAX);
  keep_carried(r);
}

Rolls roll_find(const Prog *p, unsigned by_index, uint32_t from, int early) {
  Arena *a = p->arena;
  Rolls r = {.p = p};
  Slot *code = ARENA_ARRAY(a, Slot, p->ins.n);
  uint32_t *place = ARENA_ARRAY(a, uint32_t, p->ins.n), *cls = ARENA_ARRAY(a, uint32_t, p->ins.n),
           *loop = ARENA_ARRAY(a, uint32_t, p->ins.n);
  for (Slot s = 1; s < p->ins.n; s++) {
    if (ir_is_leaf(p->ins.at[s].op)) continue;
    cls[r.n] = class_of(p, s);
    code[r.n++] = s;
    place[s] = r.n;
  }
  r.code = code;
  r.place = place;
  r.loop = loop;
  Search f = {&r, cls, by_index, ARENA_ARRAY(a, uint32_t, LONGEST_PERIOD + 1),
              ARENA_ARRAY(a, uint32_t, LONGEST_PERIOD + 1)};
  for (uint32_t i = 0; i < r.n && r.n >= from;) {
    Loop l = longest_at(&f, i);
    if (!l.count) {
      i++;
      continue;
    }
    l = best_rotation(&f, l);
    i = l.begin;
    l.kept = ARENA_ARRAY(a, uint32_t, l.period);
    l.carried = ARENA_ARRAY(a, unsigned char, l.period);
    vec_push(a, &r.loops, l);
    for (uint32_t k = 0; k < l.period * l.count; k++) loop[i + k] = r.loops.n;
    i += l.period * l.count;
    /* operands in the new loop may now follow its turns */
    memset(f.failed, 0, (LONGEST_PERIOD + 1) * sizeof *f.failed);
  }
  r.stored = ARENA_ARRAY(a, unsigned char, p->stores.n + 1);
  if (early) find_stores(&r);
  find_kept(&r);
  return r;
}
