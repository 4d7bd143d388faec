/* Partial derivatives on a tape, d(expr, name) of the text, by forward differentiation, instruction by instruction.
 * Deliberately independent of sym/diff.c, which it checks. */
#include <string.h>

#include "self_check/tape.h"

enum { LEVELS = 3 }; /* level 0, 1, 2: derivative by x, x', x'' */
static const uint32_t ALL = UINT32_MAX;

/* Derivatives of an instruction at each level; 0: the derivative is zero. */
typedef struct {
  Ref by[LEVELS];
} Derivatives;

struct Partial {
  Tape *t;
  InputKind kind; /* independent variable: input `index` of this kind, or a rate of it */
  uint32_t index; /* ALL: all inputs of the kind, in the direction of their rates */
  VEC(Ref) made_of;    /* instructions that `value` depends on, in order */
  VEC(Derivatives) of; /* derivatives of made_of */
  VEC(uint32_t) place; /* [Ref] index in made_of + 1; 0: not in it */
  Ref value, lowest;   /* the differentiated value; first instruction of made_of */
};
typedef struct Partial Partial;

/* --- arithmetic in which Ref 0 means the number 0 --- */

static Ref sum(Tape *t, Ref a, Ref b) { return a && b ? tape_op(t, TAPE_ADD, a, b, 0) : a ? a : b; }
static Ref negative(Tape *t, Ref a) { return a ? tape_op(t, TAPE_NEG, a, 0, 0) : 0; }
static Ref product(Tape *t, Ref a, Ref b) { return a && b ? tape_op(t, TAPE_MUL, a, b, 0) : 0; }
static Ref quotient(Tape *t, Ref a, Ref b) { return a ? tape_op(t, TAPE_DIV, a, b, 0) : 0; }
static Ref integer(Tape *t, int64_t n) { return tape_number(t, num_int(n)); }
static Ref square(Tape *t, Ref a) { return tape_power(t, a, num_int(2)); }
static Ref zero(Tape *t, Ref a) { return a ? a : integer(t, 0); }

/* --- rules --- */

/* Chain rule: f'(a) da for a function of the C library; self is f(a). */
static Ref through_function(Tape *t, const char *name, Ref self, Ref a, Ref da) {
  if (strcmp(name, "sin") == 0) return product(t, tape_function(t, "cos", a), da);
  if (strcmp(name, "cos") == 0) return negative(t, product(t, tape_function(t, "sin", a), da));
  if (strcmp(name, "tan") == 0) return quotient(t, da, square(t, tape_function(t, "cos", a)));
  if (strcmp(name, "sinh") == 0) return product(t, tape_function(t, "cosh", a), da);
  if (strcmp(name, "cosh") == 0) return product(t, tape_function(t, "sinh", a), da);
  /* bound sees cancellation */
  if (strcmp(name, "tanh") == 0) return product(t, tape_op(t, TAPE_SUB, integer(t, 1), square(t, self), 0), da);
  if (strcmp(name, "exp") == 0) return product(t, self, da);
  if (strcmp(name, "log") == 0) return quotient(t, da, a);
  if (strcmp(name, "fabs") == 0) return product(t, tape_op(t, TAPE_SIGN, a, 0, 0), da);
  Ref one = integer(t, 1);
  if (strcmp(name, "atan") == 0) return quotient(t, da, tape_op(t, TAPE_ADD, one, square(t, a), 0));
  /* 1 - a^2, for asin and acos */
  Ref rest = product(t, tape_op(t, TAPE_SUB, one, a, 0), tape_op(t, TAPE_ADD, one, a, 0));
  Ref r = quotient(t, da, tape_power(t, rest, num_ratio(1, 2)));
  return strcmp(name, "asin") == 0 ? r : negative(t, r);
}

/* a^b (b' log(a) + b a'/a); the term with log(a) only for a varying exponent, as a may be negative otherwise. */
static Ref through_pow(Tape *t, Ref self, Ref a, Ref b, Ref da, Ref db) {
  Ref less = tape_op(t, TAPE_SUB, b, integer(t, 1), 0);
  Ref base = product(t, product(t, b, tape_op(t, TAPE_POW, a, less, 0)), da);
  return db ? sum(t, base, product(t, product(t, self, tape_function(t, "log", a)), db)) : base;
}

static Ref chosen(Tape *t, Ref condition, Ref da, Ref db) {
  return da || db ? tape_op(t, TAPE_SELECT, condition, zero(t, da), zero(t, db)) : 0;
}

static Ref known(const Partial *p, Ref r, uint32_t level) { return r ? p->of.at[p->place.at[r] - 1].by[level] : 0; }

static Ref derivative(const Partial *p, Ref r, uint32_t level) {
  Tape *t = p->t;
  TapeIns i = t->ins.at[r]; /* a copy: the tape grows */
  Num power;
  Ref da = known(p, i.a, level), db = known(p, i.b, level), dc = known(p, i.c, level);
  if (i.op == TAPE_INPUT && (level || i.input != p->kind)) return 0;
  if (i.op == TAPE_INPUT)
    return p->index == ALL ? tape_op(t, TAPE_RATE, r, 0, 0) : i.index == p->index ? integer(t, 1) : 0;
  /* d(a')/dx' = (da/dx')' + da/dx, where a' is the rate along the motion. */
  if (i.op == TAPE_RATE) return sum(t, da ? tape_op(t, TAPE_RATE, da, 0, 0) : 0, level ? known(p, i.a, level - 1) : 0);
  if (!da && !db && !dc) return 0;
  switch ((TapeOp)i.op) {
    case TAPE_ADD: return sum(t, da, db);
    case TAPE_SUB: return sum(t, da, negative(t, db));
    case TAPE_NEG: return negative(t, da);
    case TAPE_MUL: return sum(t, product(t, da, i.b), product(t, i.a, db));
    case TAPE_DIV: return quotient(t, sum(t, da, negative(t, product(t, r, db))), i.b);
    case TAPE_POWER:
      power = tape_ins_number(&i);
      return product(t, product(t, tape_number(t, power), tape_power(t, i.a, num_sub(power, num_int(1)))), da);
    case TAPE_POW: return through_pow(t, r, i.a, i.b, da, db);
    case TAPE_FUNCTION: return through_function(t, i.text, r, i.a, da);
    case TAPE_ATAN2: /* (x y' - y x')/(x^2 + y^2) of y = a, x = b */
      return quotient(t, sum(t, product(t, i.b, da), negative(t, product(t, i.a, db))),
                      sum(t, square(t, i.a), square(t, i.b)));
    case TAPE_HYPOT: return quotient(t, sum(t, product(t, i.a, da), product(t, i.b, db)), r);
    case TAPE_MIN: return chosen(t, tape_op(t, TAPE_LT, i.a, i.b, 0), da, db);
    case TAPE_MAX: return chosen(t, tape_op(t, TAPE_LT, i.b, i.a, 0), da, db);
    case TAPE_SELECT: return chosen(t, i.a, db, dc);
    case TAPE_NUMBER:
    case TAPE_PI:
    case TAPE_INPUT:
    case TAPE_RATE:
    case TAPE_SIGN:
    case TAPE_FLOOR:
    case TAPE_LT:
    case TAPE_LE:
    case TAPE_EQ:
    case TAPE_NOT:
    case TAPE_AND: case TAPE_OR: break; /* piecewise constant */
  }
  return 0;
}

/* --- whole values --- */

static void mark(Partial *p, Ref r) {
  if (r && r < p->lowest) p->lowest = r;
  p->place.at[r] = r != 0;
}

/* Sets made_of and place to the instructions that `of` depends on, operands first. */
static void collect(Partial *p, Ref of) {
  const Tape *t = p->t;
  if (p->value == of) return;
  for (uint32_t k = 0; k < p->made_of.n; k++) p->place.at[p->made_of.at[k]] = 0;
  while (p->place.n <= of) vec_push(t->arena, &p->place, 0);
  p->made_of.n = 0;
  p->value = p->lowest = of;
  mark(p, of);
  for (Ref r = of; r >= p->lowest; r--) {
    const TapeIns *i = &t->ins.at[r];
    if (!p->place.at[r]) continue;
    mark(p, i->a);
    mark(p, i->b);
    mark(p, i->c);
  }
  for (Ref r = p->lowest; r <= of; r++) {
    if (!p->place.at[r]) continue;
    vec_push(t->arena, &p->made_of, r);
    p->place.at[r] = p->made_of.n;
  }
}

static Ref by_level(Tape *t, Ref of, InputKind kind, uint32_t index, uint32_t level) {
  if (!t->partial) t->partial = ARENA_NEW(t->arena, Partial);
  Partial *p = t->partial;
  p->t = t;
  p->kind = kind;
  p->index = index;
  collect(p, of);
  p->of.n = 0;
  for (uint32_t k = 0; k < p->made_of.n; k++) {
    Derivatives d = {{0}};
    vec_push(t->arena, &p->of, d);
    for (uint32_t l = 0; l <= level; l++) p->of.at[k].by[l] = derivative(p, p->made_of.at[k], l);
  }
  Ref r = zero(t, known(p, of, level));
  return t->too_long ? 0 : r;
}

Ref tape_partial(Tape *t, Ref of, Ref by) {
  uint32_t level = 0;
  for (; by && t->ins.at[by].op == TAPE_RATE; by = t->ins.at[by].a) level++;
  if (!of || !by || t->ins.at[by].op != TAPE_INPUT || level >= LEVELS) return 0;
  return by_level(t, of, t->ins.at[by].input, t->ins.at[by].index, level);
}

/* With index ALL, level 1 is the derivative by q' in the direction q': sum of q' dL/dq' = p q'. */
Ref tape_energy(Tape *t, Ref lagrangian, InputKind kind) {
  if (!lagrangian) return 0;
  Ref pv = by_level(t, lagrangian, kind, ALL, 1);
  return pv ? tape_op(t, TAPE_SUB, pv, lagrangian, 0) : 0;
}
