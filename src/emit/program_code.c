/* Prog -> the code that runtime/evaluator executes: the operations of the C text, each with the same operands.
 *
 * A value with one use is computed where its user needs it, in the accumulator; the others have places in a frame,
 * taken again after their last use. Order among values does not matter for their bits. */
#include <stdlib.h>
#include <string.h>

#include "emit/cwriter.h"
#include "emit/program_bytes.h"
#include "numeric/functions.def"
#include "numeric/program_code.def"

/* --- tables of codes --- */

typedef enum {
#define ONE(name, kinds, ...) CODE_##name,
#define BOTH(name, kinds, ...) CODE_##name, CODE_##name##_TO,
  PROGRAM_CODES(ONE, ONE, BOTH)
#undef ONE
#undef BOTH
} Code;

static const struct {
  const char *kinds;
  int has_to; /* the next code is the same with a place for x */
} codes[] = {
#define ONE(name, kinds, ...) {kinds, 0},
#define BOTH(name, kinds, ...) {kinds, 1}, {kinds "d", 0},
    PROGRAM_CODES(ONE, ONE, BOTH)
#undef ONE
#undef BOTH
};

enum {
#define ARRAY(name) PROGRAM_##name,
  PROGRAM_ARRAYS(ARRAY)
#undef ARRAY
};

enum {
#define OP(name, operands, formula) TURN_##name,
  PROGRAM_TURN_OPS(OP, OP)
#undef OP
};

static const char *const one_functions[] = {
#define ROW(OP, name, ...) #name,
    FUNCTIONS(ROW)
#undef ROW
};
static const char *const two_functions[] = {
#define ROW(name) #name,
    PROGRAM_FUNCTIONS_2(ROW)
#undef ROW
};

/* --- constants --- */

/* A constant as the double that its C text means. */
static double emitted_constant(Arena *a, Num n) {
  const char *text = c_number(a, "", num_abs(n));
  const char *over = strchr(text, '/');
  double x = strtod(text + strcspn(text, "(") + 1, NULL);
  if (over) x = (double)num_abs(n).num / (double)n.den;
  return num_sign(n) < 0 ? -x : x;
}

/* --- the state of a translation --- */

/* Words whose operands a and d are values: slots of the Prog, or from there on temporary ones. */
typedef VEC(uint32_t) Words;

/* A table of constants, each once. */
typedef VEC(double) Constants;

typedef struct {
  const Prog *p;
  Arena *a;
  CodeStyle style;
  const uint32_t *uses;
  unsigned char *joined; /* by slot: computed where its only user is */
  unsigned char *done;   /* by slot: the sines and cosines that are computed */
  Slot *pair;            /* by slot of a sine: its cosine, and the other way */
  Words words;
  uint32_t last;   /* where the last code of `words` begins */
  uint32_t values; /* slots and temporary values */
  uint32_t *place; /* by value: its place in the frame */
  Constants constants;
  uint32_t frame;       /* size of the frame */
  uint32_t cells, work; /* places of sums, of the work space of linear systems */
} Coder;

static const Ins *ins(const Coder *w, Slot s) { return &w->p->ins.at[s]; }

static void code(Coder *w, Code c) {
  w->last = w->words.n;
  vec_push(w->a, &w->words, c);
}

static void operand(Coder *w, uint32_t x) { vec_push(w->a, &w->words, x); }

static void code_1(Coder *w, Code c, uint32_t x) {
  code(w, c);
  operand(w, x);
}

static void code_2(Coder *w, Code c, uint32_t x, uint32_t y) {
  code_1(w, c, x);
  operand(w, y);
}

static void code_3(Coder *w, Code c, uint32_t x, uint32_t y, uint32_t z) {
  code_2(w, c, x, y);
  operand(w, z);
}

/* x goes to a value, too. */
static void store(Coder *w, uint32_t value) {
  uint32_t c = w->words.at[w->last];
  if (!codes[c].has_to) {
    code_1(w, CODE_STORE, value);
    return;
  }
  w->words.at[w->last]++;
  operand(w, value);
}

static uint32_t temporary(Coder *w) { return w->values++; }

/* --- which values are joined to their users --- */

static int is_arithmetic(IrOp op) { return op >= IR_ADD && op <= IR_FN1; }

/* Joins values that one operation of arithmetic uses, up to a depth that recursion stands. */
static void find_joined(Coder *w) {
  enum { DEEPEST = 60 };
  const Prog *p = w->p;
  unsigned char *depth = ARENA_ARRAY(w->a, unsigned char, p->ins.n);
  Slot *user = ARENA_ARRAY(w->a, Slot, p->ins.n);
  for (Slot s = 1; s < p->ins.n; s++)
    for (int k = 0; k < 3; k++) user[ins_operand(ins(w, s), k)] = s;
  for (uint32_t k = 0; k < p->stores.n; k++) user[p->stores.at[k].slot] = 0;
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = ins(w, s);
    for (int k = 0; k < 3; k++) {
      Slot x = ins_operand(i, k);
      if (w->joined[x] && depth[x] >= depth[s]) depth[s] = (unsigned char)(depth[x] + 1);
    }
    w->joined[s] = is_arithmetic(i->op) && w->uses[s] == 1 && user[s] && is_arithmetic(ins(w, user[s])->op) &&
                   !w->pair[s] && !w->pair[user[s]] && depth[s] < DEEPEST;
  }
}

/* Pairs of sine and cosine of one value, as the C text has. */
static void find_pairs(Coder *w) {
  const Prog *p = w->p;
  Slot *sine = ARENA_ARRAY(w->a, Slot, p->ins.n);
  for (int turn = 0; turn < 2 && w->style.own; turn++)
    for (Slot s = 1; s < p->ins.n; s++) {
      const Ins *i = ins(w, s);
      if (i->op != IR_FN1 || strcmp(i->text, turn ? "cos" : "sin") != 0) continue;
      if (!turn) sine[i->a] = s;
      else if (sine[i->a]) w->pair[w->pair[s] = sine[i->a]] = s;
    }
}

/* --- values --- */

static void compute(Coder *w, Slot s);

/* x = the value. */
static void bring(Coder *w, Slot s) {
  if (w->joined[s]) compute(w, s);
  else code_1(w, CODE_LOAD, s);
}

/* A joined product of two values of the frame. */
static const Ins *product(const Coder *w, Slot s) {
  const Ins *i = ins(w, s);
  return s && w->joined[s] && i->op == IR_MUL && !w->joined[i->a] && !w->joined[i->b] ? i : NULL;
}

/* x = a op b by codes for: both in the frame, b in the frame, a in the frame. */
static void binary(Coder *w, const Ins *i, Code both, Code right, Code left) {
  if (!w->joined[i->a] && !w->joined[i->b]) {
    code_2(w, both, i->a, i->b);
  } else if (!w->joined[i->b]) {
    bring(w, i->a);
    code_1(w, right, i->b);
  } else if (!w->joined[i->a]) {
    bring(w, i->b);
    code_1(w, left, i->a);
  } else {
    uint32_t t = temporary(w);
    bring(w, i->b);
    store(w, t);
    bring(w, i->a);
    code_1(w, right, t);
  }
}

/* a + b or a - b with a product among its operands; 0: there is none. */
static int sum_with_product(Coder *w, const Ins *i) {
  const Ins *pa = product(w, i->a), *pb = product(w, i->b);
  int minus = i->op == IR_SUB;
  if (pa && pb) {
    code_2(w, minus ? CODE_MUL_SUB_4 : CODE_MUL_ADD_4, pa->a, pa->b);
    operand(w, pb->a);
    operand(w, pb->b);
  } else if (pa && !w->joined[i->b]) {
    code_3(w, minus ? CODE_MUL_SUB_3 : CODE_MUL_ADD_3, pa->a, pa->b, i->b);
  } else if (pb && !w->joined[i->a]) {
    code_3(w, minus ? CODE_SUB_MUL_3 : CODE_MUL_ADD_3, pb->a, pb->b, i->a);
  } else if (pb) {
    bring(w, i->a);
    code_2(w, minus ? CODE_SUB_MUL : CODE_ADD_MUL, pb->a, pb->b);
  } else if (pa) {
    bring(w, i->b);
    code_2(w, minus ? CODE_MUL_SUB : CODE_ADD_MUL, pa->a, pa->b);
  } else {
    return 0;
  }
  return 1;
}

static void multiply(Coder *w, const Ins *i) {
  const Ins *pa = product(w, i->a), *pb = product(w, i->b), *top = ins(w, i->a);
  if (pa && !w->joined[i->b]) {
    code_3(w, CODE_MUL_3, pa->a, pa->b, i->b);
  } else if (pb && !w->joined[i->a]) {
    code_3(w, CODE_MUL_3, pb->a, pb->b, i->a);
  } else if (w->joined[i->a] && !w->joined[i->b] && top->op == IR_MUL && w->joined[top->a] && !w->joined[top->b]) {
    bring(w, top->a);
    code_2(w, CODE_MUL_MUL, top->b, i->b);
  } else {
    binary(w, i, CODE_MUL_2, CODE_MUL, CODE_MUL);
  }
}

static uint32_t function_number(const char *const *names, uint32_t n, const char *name) {
  uint32_t k = 0;
  while (k + 1 < n && strcmp(names[k], name) != 0) k++;
  return k;
}
#define NUMBER_OF(names, name) function_number(names, sizeof(names) / sizeof *(names), name)

static void function(Coder *w, const Ins *i) {
  bring(w, i->a);
  if (strcmp(i->text, "fabs") == 0) code(w, CODE_ABS);
  else if (strcmp(i->text, "floor") == 0) code(w, CODE_FLOOR);
  else if (w->style.own && strcmp(i->text, "sin") == 0) code(w, CODE_SIN);
  else if (w->style.own && strcmp(i->text, "cos") == 0) code(w, CODE_COS);
  else code_1(w, CODE_FUNCTION, NUMBER_OF(one_functions, i->text));
}

static void compute(Coder *w, Slot s) {
  const Ins *i = ins(w, s);
  switch (i->op) {
  case IR_ADD:
    if (!sum_with_product(w, i)) binary(w, i, CODE_ADD_2, CODE_ADD, CODE_ADD);
    break;
  case IR_SUB:
    if (!sum_with_product(w, i)) binary(w, i, CODE_SUB_2, CODE_SUB, CODE_SUB_FROM);
    break;
  case IR_MUL: multiply(w, i); break;
  case IR_DIV: binary(w, i, CODE_DIV_2, CODE_DIV, CODE_DIV_INTO); break;
  case IR_NEG: bring(w, i->a), code(w, CODE_NEG); break;
  case IR_SQRT: bring(w, i->a), code(w, CODE_SQRT); break;
  case IR_FN1: function(w, i); break;
  case IR_FN2: code_3(w, CODE_FUNCTION_2, NUMBER_OF(two_functions, i->text), i->a, i->b); break;
  case IR_MIN: code_2(w, CODE_MIN, i->a, i->b); break;
  case IR_MAX: code_2(w, CODE_MAX, i->a, i->b); break;
  case IR_SIGN: bring(w, i->a), code(w, CODE_SIGN); break;
  case IR_LT: code_2(w, CODE_LESS, i->a, i->b); break;
  case IR_LE: code_2(w, CODE_LESS_EQUAL, i->a, i->b); break;
  case IR_EQ: code_2(w, CODE_EQUAL, i->a, i->b); break;
  case IR_NOT: code_1(w, CODE_NOT, i->a); break;
  case IR_AND: code_2(w, CODE_AND, i->a, i->b); break;
  case IR_OR: code_2(w, CODE_OR, i->a, i->b); break;
  case IR_SELECT: code_3(w, CODE_SELECT, i->a, i->b, i->c); break;
  case IR_TABLE: bring(w, i->a), code_1(w, CODE_TABLE, i->index); break;
  case IR_CONST: case IR_PI: case IR_LOAD: case IR_PIVOT: case IR_SOLVE: case IR_SOLVED: case IR_NEST:
  case IR_TITLE: break;
  }
}

/* Sine and cosine of one angle, or of two that are known by now. */
static void sines(Coder *w, Slot s) {
  enum { NEAR = 400 };
  Slot other = 0;
  if (w->done[s]) return;
  w->done[s] = w->done[w->pair[s]] = 1;
  for (Slot k = s + 1; k < w->p->ins.n && k < s + NEAR && !other; k++)
    if (w->pair[k] > k && !w->done[k] && (ins(w, k)->a < s || ir_is_leaf(ins(w, ins(w, k)->a)->op))) other = k;
  code(w, other ? CODE_SINCOS_2 : CODE_SINCOS);
  for (Slot now = s; now; now = now == other ? 0 : other) {
    int in_order = strcmp(ins(w, now)->text, "sin") == 0;
    w->done[now] = w->done[w->pair[now]] = 1;
    operand(w, ins(w, now)->a);
    operand(w, in_order ? now : w->pair[now]);
    operand(w, in_order ? w->pair[now] : now);
  }
}

/* Components of the solution of s: values of their own where another system follows. */
static void solution(Coder *w, Slot s) {
  const Solve *k = &w->p->solves.at[ins(w, s)->index];
  code_1(w, CODE_SOLVE, ins(w, s)->index);
  for (Slot x = s + 1; x < w->p->ins.n && w->p->solves.n > 1; x++) {
    if (ins(w, x)->op != IR_SOLVED || ins(w, x)->a != s) continue;
    uint32_t from = temporary(w);
    w->place[from] = w->work + solve_elements(k) + ins(w, x)->index;
    code_1(w, CODE_LOAD, from);
    code_1(w, CODE_STORE, x);
  }
}

/* Instructions that are no values; 0: s is one. */
static int effect(Coder *w, Slot s) {
  const Ins *i = ins(w, s);
  if (i->op == IR_PIVOT) code_1(w, i->index ? CODE_POSITIVE : CODE_NONZERO, i->a);
  else if (i->op == IR_SOLVE) solution(w, s);
  else if (i->op == IR_NEST) code_1(w, CODE_NEST, i->index);
  else return ir_is_leaf(i->op) || i->op == IR_TITLE || i->op == IR_SOLVED;
  return 1;
}

static void instruction(Coder *w, Slot s) {
  if (effect(w, s) || w->joined[s]) return;
  if (w->pair[s]) {
    sines(w, s);
    return;
  }
  compute(w, s);
  store(w, s);
}

/* --- places --- */

static uint32_t take(Coder *w, uint32_t n) {
  w->frame += n;
  return w->frame - n;
}

static void read(Coder *w, uint32_t array, uint32_t index, uint32_t at, uint32_t n) {
  uint32_t to = temporary(w);
  w->place[to] = at;
  code_3(w, n == 1 ? CODE_READ_1 : n == 2 ? CODE_READ_2 : CODE_READ, array, index, to);
  if (n > 2) operand(w, n);
}

static void place_constants(Coder *w) {
  for (Slot s = 1; s < w->p->ins.n; s++) {
    const Ins *i = ins(w, s);
    if ((i->op != IR_CONST && i->op != IR_PI) || !w->uses[s]) continue;
    double x = i->op == IR_PI ? 3.14159265358979323846264338327950288 : emitted_constant(w->a, i->number);
    vec_push(w->a, &w->constants, x);
    w->place[s] = take(w, 1);
  }
  if (w->constants.n) read(w, PROGRAM_CONSTANTS, 0, 1, w->constants.n);
}

/* Elements of an array that are read, in runs with small gaps. */
static void place_loads(Coder *w, IrArray array) {
  enum { GAP = 3 };
  uint32_t n = 0;
  for (Slot s = 1; s < w->p->ins.n; s++)
    if (ins(w, s)->op == IR_LOAD && ins(w, s)->array == array && w->uses[s] && ins(w, s)->index >= n)
      n = ins(w, s)->index + 1;
  Slot *at = ARENA_ARRAY(w->a, Slot, n + 1);
  for (Slot s = 1; s < w->p->ins.n; s++)
    if (ins(w, s)->op == IR_LOAD && ins(w, s)->array == array && w->uses[s]) at[ins(w, s)->index] = s;
  for (uint32_t i = 0, first; i < n; i++) {
    if (!at[i]) continue;
    uint32_t end = first = i;
    for (; i < n && i <= end + GAP; i++)
      if (at[i]) end = i;
    uint32_t to = take(w, end + 1 - first);
    for (uint32_t k = first; k <= end; k++) w->place[at[k]] = at[k] ? to + k - first : 0;
    read(w, array, first, to, end + 1 - first);
    i = end;
  }
}

/* Places of what the program reads, of its work space, and of what it writes. */
static void place_fixed(Coder *w) {
  const Prog *p = w->p;
  w->frame = 1;
  place_constants(w);
  for (int k = 0; k < ARR_CELL; k++) place_loads(w, (IrArray)k);
  w->cells = take(w, p->cells);
  w->work = take(w, prog_work_size(p));
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *i = ins(w, s);
    if (i->op == IR_LOAD && i->array == ARR_CELL) w->place[s] = w->cells + i->index;
    if (i->op == IR_SOLVED && p->solves.n == 1) w->place[s] = w->work + solve_elements(p->solves.at) + i->index;
  }
  for (uint32_t k = 0; k < p->stores.n; k++) {
    Slot s = p->stores.at[k].slot;
    if (s && !w->place[s]) w->place[s] = take(w, 1);
  }
}

static void write_stores(Coder *w) {
  const Store *st = w->p->stores.at;
  for (uint32_t k = 0, n; k < w->p->stores.n; k += n) {
    for (n = 1; k + n < w->p->stores.n; n++)
      if (st[k + n].array != st[k].array || st[k + n].index != st[k].index + n ||
          w->place[st[k + n].slot] != w->place[st[k].slot] + n)
        break;
    code_3(w, n == 1 ? CODE_WRITE_1 : n == 2 ? CODE_WRITE_2 : CODE_WRITE, st[k].array, st[k].index, st[k].slot);
    if (n > 2) operand(w, n);
  }
  code(w, CODE_END);
}

/* The values that the solve or nest at this code uses, besides operands. */
static void each_hidden_use(const Coder *w, const uint32_t *at, uint32_t position, uint32_t *last) {
  if (at[0] == CODE_SOLVE) {
    const Solve *k = &w->p->solves.at[at[1]];
    for (uint32_t j = 0; j < k->list.n; j++) last[k->list.at[j].x] = position;
    for (uint32_t j = 0; j < solve_unknowns(k); j++) last[k->rhs[j]] = position;
  }
  if (at[0] == CODE_NEST) {
    const Nest *n = &w->p->nests.at[at[1]];
    for (uint32_t j = 0; j < n->nouter; j++) last[n->outer[j]] = position;
  }
}

static uint32_t width(char kind) { return kind == 'i' || kind == 'o' ? 2 : 1; }

/* Gives the other values places; a place is free again after the last use of its value. */
static void place_others(Coder *w) {
  uint32_t *last = ARENA_ARRAY(w->a, uint32_t, w->values), *at = w->words.at;
  unsigned char *fixed = ARENA_ARRAY(w->a, unsigned char, w->values);
  Words unused = {0};
  for (uint32_t v = 0; v < w->values; v++) fixed[v] = !v || w->place[v];
  for (uint32_t k = 0; k < w->words.n;) {
    each_hidden_use(w, at + k, k, last);
    const char *kinds = codes[at[k]].kinds;
    uint32_t begin = k++;
    for (; *kinds; k += width(*kinds++))
      if (*kinds == 'a') last[at[k]] = begin;
  }
  for (uint32_t k = 0; k < w->words.n;) {
    const char *kinds = codes[at[k]].kinds;
    uint32_t begin = k++, next = k;
    for (const char *c = kinds; *c; next += width(*c++))
      if (*c == 'a' && !fixed[at[next]] && last[at[next]] == begin) {
        vec_push(w->a, &unused, w->place[at[next]]);
        fixed[at[next]] = 1; /* once */
      }
    next = k;
    for (const char *c = kinds; *c; next += width(*c++))
      if (*c == 'd' && !fixed[at[next]]) w->place[at[next]] = unused.n ? unused.at[--unused.n] : take(w, 1);
    for (; *kinds; k += width(*kinds++))
      if (*kinds == 'a' || *kinds == 'd') at[k] = w->place[at[k]];
  }
}

/* --- nests --- */

static const unsigned char turn_ops[] = {
    [IR_CONST] = TURN_CONSTANT, [IR_PI] = TURN_CONSTANT,   [IR_ADD] = TURN_ADD,      [IR_SUB] = TURN_SUB,
    [IR_MUL] = TURN_MUL,        [IR_DIV] = TURN_DIV,       [IR_NEG] = TURN_NEG,      [IR_SQRT] = TURN_SQRT,
    [IR_FN2] = TURN_FUNCTION_2, [IR_MIN] = TURN_MIN,       [IR_MAX] = TURN_MAX,      [IR_SIGN] = TURN_SIGN,
    [IR_LT] = TURN_LESS,        [IR_LE] = TURN_LESS_EQUAL, [IR_EQ] = TURN_EQUAL,     [IR_NOT] = TURN_NOT,
    [IR_AND] = TURN_AND,        [IR_OR] = TURN_OR,         [IR_SELECT] = TURN_SELECT};

/* Code and number of a function of one argument. */
static uint32_t turn_function(const Coder *w, const char *name, uint32_t *number) {
  if (strcmp(name, "fabs") == 0) return TURN_ABS;
  if (strcmp(name, "floor") == 0) return TURN_FLOOR;
  if (w->style.own && strcmp(name, "sin") == 0) return TURN_SIN;
  if (w->style.own && strcmp(name, "cos") == 0) return TURN_COS;
  *number = NUMBER_OF(one_functions, name);
  return TURN_FUNCTION;
}

/* Five words an instruction: operation, a, b, c, number. */
static void put_turn(Coder *w, StrBuf *out, const Ins *i) {
  uint32_t op = turn_ops[i->op < sizeof turn_ops ? i->op : 0], a = i->a, number = i->index;
  if (i->op == IR_FN1) op = turn_function(w, i->text, &number);
  if (i->op == IR_FN2) number = NUMBER_OF(two_functions, i->text);
  if (i->op == IR_LOAD) {
    op = i->array == ARR_CELL     ? TURN_CELL
         : i->array == ARR_OUTER  ? TURN_OUTER
         : i->array == ARR_INDEX  ? TURN_INDEX
         : ir_is_scalar(i->array) ? TURN_SCALAR
                                  : TURN_ELEMENT;
    a = i->array;
  }
  if (i->op == IR_CONST || i->op == IR_PI) {
    double x = i->op == IR_PI ? 3.14159265358979323846264338327950288 : emitted_constant(w->a, i->number);
    number = w->constants.n;
    vec_push(w->a, &w->constants, x);
  }
  put_word(out, op), put_word(out, a), put_word(out, i->b), put_word(out, i->c), put_word(out, number);
}

static void put_far(StrBuf *out, const IrFar *far) {
  put_word(out, far->n);
  if (!far->n) return;
  put_word(out, far->members), put_word(out, far->charge);
  put_signed(out, far->step), put_signed(out, far->by), put_signed(out, far->energy);
  for (uint32_t k = 0; k < 3; k++) put_word(out, far->numbers[k]);
  for (uint32_t k = 0; k < far->n; k++) put_signed(out, far->first[k]), put_signed(out, far->slope[k]);
}

static void put_nest(Coder *w, StrBuf *out, const Nest *n) {
  const Prog *body = n->body;
  int turns = nest_has_turns(n), rows = n->rows > 1;
  put_word(out, n->rows), put_word(out, (uint32_t)turns);
  put_signed(out, n->skew), put_signed(out, n->turns), put_signed(out, n->more), put_word(out, n->n);
  for (uint32_t k = 0; k < n->n; k++)
    put_signed(out, n->at[k].first), put_signed(out, rows ? n->at[k].by_row : 0),
        put_signed(out, turns ? n->at[k].by_turn : 0);
  put_word(out, n->nouter);
  for (uint32_t k = 0; k < n->nouter; k++) put_word(out, w->place[n->outer[k]]);
  put_word(out, body->ins.n - 1);
  for (Slot s = 1; s < body->ins.n; s++) put_turn(w, out, &body->ins.at[s]);
  const IrNear *near = &n->near;
  uint32_t sums = body->stores.n - (near->n > 0); /* the last store is the test */
  put_word(out, near->n);
  for (uint32_t k = 0; k < near->n; k++)
    put_word(out, near->at_i[k]), put_word(out, near->at_j[k]), put_word(out, near->boxed ? near->side[k] + 1 : 0);
  if (near->n) put_word(out, near->cut), put_word(out, body->stores.at[sums].slot);
  put_far(out, &n->far);
  put_word(out, sums);
  for (uint32_t k = 0; k < sums; k++) {
    const Store *st = &body->stores.at[k];
    put_word(out, st->array), put_word(out, st->index), put_word(out, st->slot);
  }
}

/* --- the program --- */

static void put_solve(const Coder *w, StrBuf *out, const Solve *k) {
  uint32_t b = solve_elements(k), n = 0;
  for (uint32_t j = 0; j < solve_unknowns(k); j++) n += k->rhs[j] != 0;
  put_word(out, k->n), put_word(out, k->m), put_word(out, (uint32_t)k->coarse), put_word(out, k->list.n + n);
  for (uint32_t j = 0; j < k->list.n; j++)
    put_word(out, k->list.at[j].at), put_word(out, w->place[k->list.at[j].x]);
  for (uint32_t j = 0; j < solve_unknowns(k); j++)
    if (k->rhs[j]) put_word(out, b + j), put_word(out, w->place[k->rhs[j]]);
}

static void put_table(StrBuf *out, const IrTable *t) {
  const Spline *c = t->curve;
  int columns = c->jet ? 4 : 3;
  put_word(out, (uint32_t)t->order), put_word(out, (uint32_t)columns), put_word(out, c->n);
  for (uint32_t k = 0; k < c->n; k++)
    for (int i = 0; i < columns; i++) put_number(out, c->jet ? c->jet[k][i] : c->row[k][i]);
}

static void put_code(Coder *w, StrBuf *out) {
  const Prog *p = w->p;
  StrBuf nests = strbuf(w->a);
  for (uint32_t k = 0; k < p->nests.n; k++) put_nest(w, &nests, &p->nests.at[k]);
  put_word(out, 1);
  put_word(out, w->frame), put_word(out, (uint32_t)w->style.regular), put_word(out, w->cells);
  put_word(out, p->cells), put_word(out, w->work), put_word(out, prog_work_size(p)), put_word(out, w->constants.n);
  for (uint32_t k = 0; k < w->constants.n; k++) put_number(out, w->constants.at[k]);
  put_word(out, p->tables.n);
  for (uint32_t k = 0; k < p->tables.n; k++) put_table(out, &p->tables.at[k]);
  put_word(out, p->solves.n);
  for (uint32_t k = 0; k < p->solves.n; k++) put_solve(w, out, &p->solves.at[k]);
  put_word(out, p->nests.n);
  sb_putn(out, sb_text(&nests), nests.n);
  put_words(out, w->words.at, w->words.n);
}

void put_program(StrBuf *out, const Prog *p, CodeStyle style) {
  if (!p) {
    put_word(out, 0);
    return;
  }
  Coder w = {.p = p, .a = out->arena, .style = style, .uses = prog_uses(p), .values = p->ins.n};
  w.joined = ARENA_ARRAY(w.a, unsigned char, p->ins.n);
  w.done = ARENA_ARRAY(w.a, unsigned char, p->ins.n);
  w.pair = ARENA_ARRAY(w.a, Slot, p->ins.n);
  w.place = ARENA_ARRAY(w.a, uint32_t, 3 * (size_t)p->ins.n + 3 * ARR_COUNT + 8);
  find_pairs(&w);
  find_joined(&w);
  place_fixed(&w);
  for (Slot s = 1; s < p->ins.n; s++) instruction(&w, s);
  write_stores(&w);
  place_others(&w);
  put_code(&w, out);
}
