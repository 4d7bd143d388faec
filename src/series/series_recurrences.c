/* series_instruction: a recurrence for each operation. u, v, ... are the operands, y the result; S(a, b) is the
 * convolution sum of a and b over 0 < j < k, theta u = t du/dt has the coefficients k u[k]. Each recurrence is the
 * function's differential equation with the terms of order 0 and k taken out of the sums: theta e = e theta u for e
 * = exp u gives k e[k] = e[0] k u[k] + S(theta u, e). */
#include <string.h>

#include "series/series_impl.h"

static Slot coef(SeriesBuilder *m, Val v) { return m->values.at[v].coef; }
static Slot zero(SeriesBuilder *m, Val v) { return m->values.at[v].zero; }
static int varies(SeriesBuilder *m, Val v) { return m->values.at[v].varies; }

static Slot first_op(SeriesBuilder *m, IrOp op, Slot a, Slot b) { return prog_op(m->first, op, a, b); }
static Slot first_call(SeriesBuilder *m, const char *name, Slot a) {
  return prog_ins(m->first, (Ins){.op = IR_FN1, .a = a, .text = name});
}
static Slot first_number(SeriesBuilder *m, int64_t n) { return prog_num(m->first, num_int(n)); }

static Slot add(SeriesBuilder *m, Slot a, Slot b) { return series_op(m, IR_ADD, a, b); }
static Slot sub(SeriesBuilder *m, Slot a, Slot b) { return series_op(m, IR_SUB, a, b); }
static Slot mul(SeriesBuilder *m, Slot a, Slot b) { return series_op(m, IR_MUL, a, b); }
static Slot neg(SeriesBuilder *m, Slot a) { return series_op(m, IR_NEG, a, 0); }

/* a[0] u[k], and a[0] u[k] + x. C fixes no order of arguments: a call has at most one that makes instructions. */
static Slot lead(SeriesBuilder *m, Val a, Val u) { return mul(m, series_zero(m, a), coef(m, u)); }
static Slot lead_plus(SeriesBuilder *m, Val a, Val u, Slot x) { return add(m, lead(m, a, u), x); }
/* S(a, b) / k. */
static Slot mean(SeriesBuilder *m, Val a, Val b) { return series_per_order(m, series_sum(m, a, b)); }

/* factor * v, the factor (in `first`) constant in time. */
static Val multiple(SeriesBuilder *m, Slot factor, Val v, Slot at_zero) {
  Val y = series_value(m, at_zero, mul(m, series_constant(m, factor), coef(m, v)));
  const Value x = m->values.at[v];
  m->values.at[y].factor = x.factor ? first_op(m, IR_MUL, factor, x.factor) : factor;
  m->values.at[y].base = x.factor ? x.base : v;
  return y;
}

/* --- products and quotients --- */

static Val product(SeriesBuilder *m, Slot at_zero, Val u, Val v) {
  if (!varies(m, u)) return multiple(m, zero(m, u), v, at_zero);
  if (!varies(m, v)) return multiple(m, zero(m, v), u, at_zero);
  return series_value(m, at_zero, series_product(m, u, v));
}

static Val square(SeriesBuilder *m, Val u) { return product(m, first_op(m, IR_MUL, zero(m, u), zero(m, u)), u, u); }

/* y v = u. */
static Val quotient(SeriesBuilder *m, Slot at_zero, Val u, Val v) {
  if (!varies(m, v)) {
    Slot one = first_number(m, 1);
    return multiple(m, first_op(m, IR_DIV, one, zero(m, v)), u, at_zero);
  }
  Val y = series_open(m, at_zero);
  Slot rest = lead_plus(m, y, v, series_sum(m, y, v));
  series_set(m, y, series_over(m, sub(m, coef(m, u), rest), zero(m, v)));
  return y;
}

/* y y = u. */
static Val square_root(SeriesBuilder *m, Slot at_zero, Val u) {
  Val y = series_open(m, at_zero);
  Slot twice = first_op(m, IR_MUL, first_number(m, 2), at_zero), rest = sub(m, coef(m, u), series_sum(m, y, y));
  series_set(m, y, series_over(m, rest, twice));
  return y;
}

/* y s = u with s = y y: 3 y[0]^2 y[k] = u[k] - S(y, s) - y[0] S(y, y). */
static Val cubic_root(SeriesBuilder *m, Slot at_zero, Val u) {
  Val y = series_open(m, at_zero), s = series_open(m, first_op(m, IR_MUL, at_zero, at_zero));
  Slot yy = series_sum(m, y, y), y0 = series_zero(m, y), thrice = first_op(m, IR_MUL, first_number(m, 3), zero(m, s));
  Slot rest = sub(m, coef(m, u), series_sum(m, y, s));
  series_set(m, y, series_over(m, sub(m, rest, mul(m, y0, yy)), thrice));
  Slot one = mul(m, y0, coef(m, y));
  series_set(m, s, add(m, yy, add(m, one, one)));
  return y;
}

/* --- exponentials, logarithms, powers --- */

/* y = exp u, with y[0] given: theta y = y theta u. */
static Val exponential(SeriesBuilder *m, Slot at_zero, Val u) {
  Val y = series_open(m, at_zero);
  series_set(m, y, lead_plus(m, y, u, mean(m, series_theta(m, u), y)));
  return y;
}

/* y = log u: u theta y = theta u; theta y is a value of its own, whose sums give y[k]. */
static Val logarithm(SeriesBuilder *m, Slot at_zero, Val u) {
  Val y = series_open(m, at_zero), slope = series_open(m, 0);
  m->values.at[y].theta = slope;
  series_set(m, y, series_over(m, sub(m, coef(m, u), mean(m, slope, u)), zero(m, u)));
  series_set(m, slope, mul(m, series_order(m), coef(m, y)));
  return y;
}

/* y = u^n, n constant in time: u theta y = n y theta u. */
static Val constant_power(SeriesBuilder *m, Slot at_zero, Val u, Val n) {
  Val y = series_open(m, at_zero), slope = series_open(m, 0);
  m->values.at[y].theta = slope;
  Slot power = series_zero(m, n), own = mul(m, power, lead_plus(m, y, u, mean(m, series_theta(m, u), y)));
  series_set(m, y, series_over(m, sub(m, own, mean(m, slope, u)), zero(m, u)));
  series_set(m, slope, mul(m, series_order(m), coef(m, y)));
  return y;
}

/* u^v = exp(v log u). */
static Val power(SeriesBuilder *m, Slot at_zero, Val u, Val v) {
  if (!varies(m, v)) return constant_power(m, at_zero, u, v);
  Slot log_zero = first_call(m, "log", zero(m, u));
  Val l = varies(m, u) ? logarithm(m, log_zero, u) : series_value(m, log_zero, 0);
  return exponential(m, at_zero, product(m, first_op(m, IR_MUL, zero(m, v), log_zero), v, l));
}

/* --- circular and hyperbolic functions --- */

/* theta s = c theta u, theta c = -s theta u (circular) or s theta u. Each recurrence needs the other, so both are
 * made. */
static void sine_and_cosine(SeriesBuilder *m, Val u, int circular, Val *sine, Val *cosine) {
  Val s = series_open(m, first_call(m, circular ? "sin" : "sinh", zero(m, u)));
  Val c = series_open(m, first_call(m, circular ? "cos" : "cosh", zero(m, u))), slope = series_theta(m, u);
  Slot other = lead_plus(m, s, u, mean(m, slope, s));
  series_set(m, s, lead_plus(m, c, u, mean(m, slope, c)));
  series_set(m, c, circular ? neg(m, other) : other);
  *sine = s;
  *cosine = c;
}

/* sin u or cos u; sinh u or cosh u. Recorded in u, so that each is made once. */
static Val circular(SeriesBuilder *m, Val u, int wants_sine, int is_circular) {
  Val s = is_circular ? m->values.at[u].sine : m->values.at[u].sinh,
      c = is_circular ? m->values.at[u].cosine : m->values.at[u].cosh;
  if (!s) sine_and_cosine(m, u, is_circular, &s, &c);
  Value *x = &m->values.at[u];
  *(is_circular ? &x->sine : &x->sinh) = s;
  *(is_circular ? &x->cosine : &x->cosh) = c;
  return wants_sine ? s : c;
}

/* y = tan u: theta y = z theta u with z = 1 + y y; tanh: z = 1 - y y. */
static Val tangent(SeriesBuilder *m, Slot at_zero, Val u, int circular) {
  IrOp sign = circular ? IR_ADD : IR_SUB;
  Slot yy = first_op(m, IR_MUL, at_zero, at_zero);
  Val y = series_open(m, at_zero), z = series_open(m, first_op(m, sign, first_number(m, 1), yy));
  Slot own = series_sum(m, y, y);
  series_set(m, y, lead_plus(m, z, u, mean(m, series_theta(m, u), z)));
  Slot one = lead(m, y, y), rest = add(m, own, add(m, one, one));
  series_set(m, z, circular ? rest : neg(m, rest));
  return y;
}

/* Inverse functions, with derivative 1/d or -1/d: d theta y = theta u or -theta u. */
static Val inverse(SeriesBuilder *m, Slot at_zero, Val u, Val d, int negative) {
  Val y = series_open(m, at_zero), slope = series_open(m, 0);
  m->values.at[y].theta = slope;
  Slot rest = mean(m, slope, d), top = negative ? neg(m, add(m, coef(m, u), rest)) : sub(m, coef(m, u), rest);
  series_set(m, y, series_over(m, top, zero(m, d)));
  series_set(m, slope, mul(m, series_order(m), coef(m, y)));
  return y;
}

/* asin, acos: d = sqrt(1 - u u), computed as (1 - u)(1 + u) at order 0. */
static Val arc_sine(SeriesBuilder *m, Slot at_zero, Val u, int cosine) {
  Slot one = first_number(m, 1), u0 = zero(m, u), minus = first_op(m, IR_SUB, one, u0),
       plus = first_op(m, IR_ADD, one, u0);
  Slot inside = first_op(m, IR_MUL, minus, plus);
  Val w = series_value(m, inside, neg(m, coef(m, square(m, u))));
  return inverse(m, at_zero, u, square_root(m, first_op(m, IR_SQRT, inside, 0), w), cosine);
}

static Val arc_tangent(SeriesBuilder *m, Slot at_zero, Val u) {
  Val uu = square(m, u), d = series_value(m, first_op(m, IR_ADD, first_number(m, 1), zero(m, uu)), coef(m, uu));
  return inverse(m, at_zero, u, d, 0);
}

/* u u + v v. */
static Val norm_square(SeriesBuilder *m, Val u, Val v) {
  Val uu = square(m, u), vv = square(m, v);
  Slot both = first_op(m, IR_ADD, zero(m, uu), zero(m, vv));
  return series_value(m, both, add(m, coef(m, uu), coef(m, vv)));
}

/* y = atan2(v, u): (u u + v v) theta y = u theta v - v theta u. */
static Val angle(SeriesBuilder *m, Slot at_zero, Val v, Val u) {
  Val y = series_open(m, at_zero), slope = series_open(m, 0), d = norm_square(m, u, v);
  m->values.at[y].theta = slope;
  Slot forth = series_sum(m, u, series_theta(m, v)), back = series_sum(m, v, series_theta(m, u)),
       own = series_sum(m, slope, d);
  Slot sums = series_per_order(m, sub(m, sub(m, forth, back), own)), there = lead(m, u, v), here = lead(m, v, u);
  Slot top = add(m, sub(m, there, here), sums);
  series_set(m, y, series_over(m, top, zero(m, d)));
  series_set(m, slope, mul(m, series_order(m), coef(m, y)));
  return y;
}

/* --- dispatch --- */

static Val refuse(SeriesBuilder *m, const char *what) {
  if (!m->why) m->why = what;
  return 0;
}

static Val function(SeriesBuilder *m, const char *name, Slot at_zero, Val u) {
  if (strcmp(name, "sin") == 0) return circular(m, u, 1, 1);
  if (strcmp(name, "cos") == 0) return circular(m, u, 0, 1);
  if (strcmp(name, "sinh") == 0) return circular(m, u, 1, 0);
  if (strcmp(name, "cosh") == 0) return circular(m, u, 0, 0);
  if (strcmp(name, "tan") == 0) return tangent(m, at_zero, u, 1);
  if (strcmp(name, "tanh") == 0) return tangent(m, at_zero, u, 0);
  if (strcmp(name, "exp") == 0) return exponential(m, at_zero, u);
  if (strcmp(name, "log") == 0) return logarithm(m, at_zero, u);
  if (strcmp(name, "cbrt") == 0) return cubic_root(m, at_zero, u);
  if (strcmp(name, "asin") == 0) return arc_sine(m, at_zero, u, 0);
  if (strcmp(name, "acos") == 0) return arc_sine(m, at_zero, u, 1);
  if (strcmp(name, "atan") == 0) return arc_tangent(m, at_zero, u);
  return refuse(m, strcmp(name, "fabs") == 0 ? "abs" : name);
}

static Val function2(SeriesBuilder *m, const char *name, Slot at_zero, Val u, Val v) {
  if (strcmp(name, "pow") == 0) return power(m, at_zero, u, v);
  if (strcmp(name, "atan2") == 0) return angle(m, at_zero, u, v);
  if (strcmp(name, "hypot") == 0) return square_root(m, at_zero, norm_square(m, u, v));
  return refuse(m, name);
}

/* A selection whose condition is constant in time. */
static Val choice(SeriesBuilder *m, Slot at_zero, Slot condition, Val u, Val v) {
  Slot one = first_number(m, 1), flag = prog_ins(m->first, (Ins){.op = IR_SELECT, .a = condition, .b = one});
  Slot holds = series_op(m, IR_LT, 0, series_constant(m, flag));
  return series_value(m, at_zero,
                      prog_ins(m->next, (Ins){.op = IR_SELECT, .a = holds, .b = coef(m, u), .c = coef(m, v)}));
}

static Val linear(SeriesBuilder *m, IrOp op, Slot at_zero, Val u, Val v) {
  return series_value(m, at_zero, series_op(m, op, coef(m, u), coef(m, v)));
}

Val series_instruction(SeriesBuilder *m, const Ins *i, Slot at_zero, Val u, Val v, Val w) {
  if (!varies(m, u) && !varies(m, v) && !varies(m, w)) return series_value(m, at_zero, 0);
  switch (i->op) {
    case IR_ADD: case IR_SUB: return linear(m, i->op, at_zero, u, v);
    case IR_NEG: return multiple(m, first_number(m, -1), u, at_zero);
    case IR_MUL: return product(m, at_zero, u, v);
    case IR_DIV: return quotient(m, at_zero, u, v);
    case IR_SQRT: return square_root(m, at_zero, u);
    case IR_FN1: return function(m, i->text, at_zero, u);
    case IR_FN2: return function2(m, i->text, at_zero, u, v);
    case IR_MIN: return refuse(m, "min");
    case IR_MAX: return refuse(m, "max");
    case IR_SIGN: return refuse(m, "sign");
    case IR_TABLE: return refuse(m, "a table");
    case IR_LT: case IR_LE: case IR_EQ: case IR_NOT: case IR_AND: case IR_OR: return refuse(m, "if");
    case IR_SELECT: return choice(m, at_zero, i->a, v, w);
    case IR_CONST:
    case IR_PI:
    case IR_LOAD:
    case IR_PIVOT:
    case IR_SOLVE:
    case IR_SOLVED:
    case IR_NEST:
    case IR_TITLE: break;
  }
  return 0;
}
