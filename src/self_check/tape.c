/* Tape: appending with constant folding, slots by liveness, evaluation. Contract: tape.h. */
#include "self_check/tape.h"

#include <float.h>
#include <math.h>

Tape *tape_new(Arena *a) {
  Tape *t = ARENA_NEW(a, Tape);
  *t = (Tape){.arena = a};
  vec_push(a, &t->ins, (TapeIns){0});
  return t;
}

static Ref append(Tape *t, TapeIns i) {
  if (t->ins.n >= TAPE_LIMIT) {
    t->too_long = 1;
    return 0;
  }
  i.at = t->node;
  vec_push(t->arena, &t->ins, i);
  return t->ins.n - 1;
}

static Ref append_with_number(Tape *t, TapeIns i, Num n) {
  i.fraction = !num_is_exact(n) || n.den != 1;
  if (i.fraction) {
    Num *kept = ARENA_NEW(t->arena, Num);
    *kept = n;
    i.number = kept;
  } else {
    i.integer = n.num;
  }
  return append(t, i);
}

Ref tape_number(Tape *t, Num n) { return append_with_number(t, (TapeIns){.op = TAPE_NUMBER}, n); }
Ref tape_pi(Tape *t) { return append(t, (TapeIns){.op = TAPE_PI}); }
Ref tape_input(Tape *t, InputKind kind, uint32_t index) {
  return append(t, (TapeIns){.op = TAPE_INPUT, .input = (uint8_t)kind, .index = index});
}

int tape_is_number(const Tape *t, Ref a, Num *n) {
  if (!a || t->ins.at[a].op != TAPE_NUMBER) return 0;
  *n = tape_ins_number(&t->ins.at[a]);
  return num_is_exact(*n);
}

/* Folds an operation on exact numbers; 0: the result is not an exact number. */
static int fold_exact(TapeOp op, Num x, Num y, Num *r) {
  switch (op) {
    case TAPE_ADD: *r = num_add(x, y); break;
    case TAPE_SUB: *r = num_sub(x, y); break;
    case TAPE_MUL: *r = num_mul(x, y); break;
    case TAPE_DIV:
      if (num_is_zero(y)) return 0;
      *r = num_div(x, y);
      break;
    case TAPE_NEG: *r = num_neg(x); break;
    case TAPE_LT: *r = num_int(num_cmp(x, y) < 0); break;
    case TAPE_LE: *r = num_int(num_cmp(x, y) <= 0); break;
    case TAPE_EQ: *r = num_int(num_cmp(x, y) == 0); break;
    case TAPE_NOT: *r = num_int(num_is_zero(x)); break;
    case TAPE_AND: *r = num_int(!num_is_zero(x) && !num_is_zero(y)); break;
    case TAPE_OR: *r = num_int(!num_is_zero(x) || !num_is_zero(y)); break;
    case TAPE_MIN: *r = num_cmp(x, y) < 0 ? x : y; break;
    case TAPE_MAX: *r = num_cmp(x, y) > 0 ? x : y; break;
    default: return 0;
  }
  return num_is_exact(*r);
}

static int is_unary(TapeOp op) {
  return op == TAPE_NEG || op == TAPE_NOT || op == TAPE_RATE || op == TAPE_SIGN || op == TAPE_FLOOR;
}

Ref tape_op(Tape *t, TapeOp op, Ref a, Ref b, Ref c) {
  Num x, y = num_int(0), r;
  if (!a || (!b && !is_unary(op)) || (op == TAPE_SELECT && !c)) return 0;
  if (tape_is_number(t, a, &x) && (is_unary(op) || tape_is_number(t, b, &y)) && fold_exact(op, x, y, &r))
    return tape_number(t, r);
  return append(t, (TapeIns){.op = (uint8_t)op, .a = a, .b = b, .c = c});
}

Ref tape_function(Tape *t, const char *name, Ref a) {
  return a ? append(t, (TapeIns){.op = TAPE_FUNCTION, .a = a, .text = name}) : 0;
}

Ref tape_power(Tape *t, Ref a, Num exponent) {
  Num x, r;
  int exact = 0;
  if (!a) return 0;
  if (tape_is_number(t, a, &x) && !(num_is_zero(x) && num_sign(exponent) <= 0)) {
    r = num_pow(x, exponent, &exact);
    if (exact && num_is_exact(r)) return tape_number(t, r);
  }
  return append_with_number(t, (TapeIns){.op = TAPE_POWER, .a = a}, exponent);
}

/* --- slots --- */

void tape_finish(Tape *t, const Ref *roots, uint32_t n) {
  uint32_t *last = ARENA_ARRAY(t->arena, uint32_t, t->ins.n), *idle = ARENA_ARRAY(t->arena, uint32_t, t->ins.n),
           nidle = 0;
  for (uint32_t i = 1; i < t->ins.n; i++) {
    const TapeIns *x = &t->ins.at[i];
    last[i] = i;
    last[x->a] = last[x->b] = last[x->c] = i;
  }
  for (uint32_t k = 0; k < n; k++) last[roots[k]] = UINT32_MAX;
  for (uint32_t i = 1; i < t->ins.n; i++) {
    TapeIns *x = &t->ins.at[i];
    /* allocated before operands are freed: a result never overwrites an operand */
    x->slot = nidle ? idle[--nidle] : t->slots++;
    Ref used[4] = {x->a, x->b, x->c, i};
    for (int k = 0; k < 4; k++) {
      int again = 0;
      for (int j = 0; j < k; j++) again |= used[j] == used[k];
      if (used[k] && !again && last[used[k]] == i) idle[nidle++] = t->ins.at[used[k]].slot;
    }
  }
  arena_release(t->arena, idle, t->ins.n * sizeof *idle);
  arena_release(t->arena, last, t->ins.n * sizeof *last);
}

/* --- running --- */

static Jet number_jet(Num n) {
  if (!num_is_exact(n)) return (Jet){.c[0][0] = {num_value(n), num_error(n) + jet_unit * fabsl((JetReal)num_value(n))}};
  return n.den == 1 ? jet_exact((JetReal)n.num) : jet_rounded((JetReal)n.num / (JetReal)n.den);
}

static Jet jet_of_bool(int yes) { return jet_exact(yes != 0); }

/* Gives a value an infinite error bound (near: decided by rounding, or out of range); results computed from it
 * inherit it. */
static void mark_unsure(Jet *out, int near, int *unsure) {
  if (!near) return;
  out->c[0][0].e = INFINITY;
  *unsure = 1;
}

static JetReal value(const Jet *x) { return x->c[0][0].v; }

/* 1 if rounding decides which of x and y is larger, or one is NaN. Equal exact numbers are not near. */
static int is_near(const Jet *x, const Jet *y) {
  JetReal error = x->c[0][0].e + y->c[0][0].e;
  if (isnan(value(x)) || isnan(value(y))) return 1;
  return error > 0 && fabsl(value(x) - value(y)) <= 4096 * error;
}

static void run_power(Num n, const Jet *x, Jet *out) {
  JetReal exponent = num_is_exact(n) ? (JetReal)n.num / (JetReal)n.den : (JetReal)num_value(n);
  jet_power(out, x, exponent, num_is_exact(n) && n.den == 3);
}

static void run_one(const TapeIns *i, const Jet *x, const Jet *y, const Jet *z, Jet *out, int *unsure) {
  static const Jet zero = {.planes = 0};
  int near = 0;
  switch ((TapeOp)i->op) {
    case TAPE_ADD: jet_add(out, x, y); return;
    case TAPE_SUB: jet_sub(out, x, y); return;
    case TAPE_MUL: jet_mul(out, x, y); return;
    case TAPE_DIV: jet_div(out, x, y); return;
    case TAPE_NEG: jet_neg(out, x); return;
    case TAPE_RATE: jet_rate(out, x); return;
    case TAPE_POWER: run_power(tape_ins_number(i), x, out); return;
    case TAPE_POW: jet_pow(out, x, y); return;
    case TAPE_FUNCTION: if (!jet_function(out, i->text, x)) *out = jet_exact(NAN); return;
    case TAPE_ATAN2: /* on the cut the sign of a zero decides, which a rewrite need not keep */
      near = value(y) < 0 && (value(x) == 0 || is_near(x, &zero));
      jet_atan2(out, x, y);
      break;
    case TAPE_HYPOT: jet_hypot(out, x, y); return;
    case TAPE_SELECT: near = isinf(x->c[0][0].e); *out = value(x) != 0 ? *y : *z; break;
    case TAPE_NOT: near = isinf(x->c[0][0].e); *out = jet_of_bool(value(x) == 0); break;
    case TAPE_AND: case TAPE_OR:
      near = isinf(x->c[0][0].e) || isinf(y->c[0][0].e);
      *out = jet_of_bool((value(x) != 0) + (value(y) != 0) >= (i->op == TAPE_AND ? 2 : 1));
      break;
    case TAPE_SIGN: near = is_near(x, &zero); *out = jet_exact((value(x) > 0) - (value(x) < 0)); break;
    case TAPE_FLOOR: {
      Jet whole = jet_exact(roundl(value(x)));
      near = is_near(x, &whole);
      *out = jet_exact(floorl(value(x)));
      break;
    }
    case TAPE_MIN: near = is_near(x, y); *out = value(x) < value(y) ? *x : *y; break;
    case TAPE_MAX: near = is_near(x, y); *out = value(x) > value(y) ? *x : *y; break;
    case TAPE_LT: near = is_near(x, y); *out = jet_of_bool(value(x) < value(y)); break;
    case TAPE_LE: near = is_near(x, y); *out = jet_of_bool(value(x) <= value(y)); break;
    case TAPE_EQ: near = is_near(x, y); *out = jet_of_bool(value(x) == value(y)); break;
    case TAPE_NUMBER: case TAPE_PI: case TAPE_INPUT: return; /* handled by run_any */
  }
  mark_unsure(out, near, unsure);
}

static void run_any(const Tape *t, Ref r, TapeInput *input, void *data, Jet *at, int *unsure) {
  const TapeIns *i = &t->ins.at[r];
  Jet *out = &at[i->slot];
  if (i->op == TAPE_NUMBER) *out = number_jet(tape_ins_number(i));
  else if (i->op == TAPE_PI) *out = jet_rounded(3.14159265358979323846264338327950288L);
  else if (i->op == TAPE_INPUT) input(data, i->input, i->index, out);
  else run_one(i, tape_value(t, at, i->a), tape_value(t, at, i->b), tape_value(t, at, i->c), out, unsure);
}

void tape_run(const Tape *t, TapeInput *input, void *data, Jet *at, int *unsure) {
  for (Ref r = 1; r < t->ins.n; r++) {
    run_any(t, r, input, data, at, unsure);
    mark_unsure(&at[t->ins.at[r].slot], fabsl(value(tape_value(t, at, r))) > DBL_MAX, unsure);
  }
}

void tape_run_to(const Tape *t, Ref last, TapeInput *input, void *data, Jet *at) {
  int unsure = 0;
  for (Ref r = 1; r <= last; r++) run_any(t, r, input, data, at, &unsure);
}

static int is_finite(const Jet *x, int derivatives) {
  int finite = fabsl(value(x)) <= DBL_MAX;
  for (int p = 0; p < JET_PLANES && derivatives; p++)
    for (int k = 0; k < JET_ORDERS; k++) finite &= isfinite(x->c[p][k].v) != 0;
  return finite;
}

Ref tape_first_nonfinite(const Tape *t, TapeInput *input, void *data, int derivatives, Jet *at) {
  int unsure = 0;
  for (Ref r = 1; r < t->ins.n; r++) {
    const TapeIns *i = &t->ins.at[r];
    run_any(t, r, input, data, at, &unsure);
    const Ref made_of[3] = {i->a, i->b, i->c};
    int known = i->op != TAPE_INPUT && i->op != TAPE_NUMBER && !is_finite(tape_value(t, at, r), derivatives);
    for (int k = 0; k < 3; k++) known = known && (!made_of[k] || is_finite(tape_value(t, at, made_of[k]), derivatives));
    if (known) return r;
  }
  return 0;
}
