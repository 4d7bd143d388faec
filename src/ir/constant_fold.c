/* Constant folding in programs in which fixed parameters are numbers. */
#include <math.h>

#include "ir/prog.h"

int prog_is_number(const Prog *p, Slot s) { return s && p->ins.at[s].op == IR_CONST; }

/* sqrt(2), sin(0.7) as a double; left to the program where it is not finite. */
static Slot reckon_function(Prog *p, const Ins *i) {
  if (!prog_is_number(p, i->a)) return NOT_A_SLOT;
  Num x = p->ins.at[i->a].number;
  long double at = num_is_exact(x) ? (long double)x.num / (long double)x.den : (long double)x.approx;
  long double y = i->op == IR_SQRT ? sqrtl(at) : prog_call1(i->text, at);
  return isfinite(y) ? prog_num(p, num_double((double)y)) : NOT_A_SLOT;
}

/* The slot without its sign; toggles *minus where it had one. */
static Slot without_sign(Prog *p, Slot s, int *minus) {
  const Ins *i = &p->ins.at[s];
  int negative = i->op == IR_NEG || (i->op == IR_CONST && num_sign(i->number) < 0);
  if (!negative) return s;
  *minus = !*minus;
  return i->op == IR_NEG ? i->a : prog_num(p, num_neg(i->number));
}

/* For numbers a, b, c: a + b, a - b, a*b, a/b, exact for fractions; x/b becomes x*(1/b), c*(b*x) becomes (c*b)*x.
 * Signs move in front of products, where a sum absorbs them. */
Slot prog_constant_fold(Prog *p, const Ins *i) {
  if (i->op == IR_SQRT || i->op == IR_FN1) return reckon_function(p, i);
  if ((i->op != IR_ADD && i->op != IR_SUB && i->op != IR_MUL && i->op != IR_DIV) || !i->a || !i->b) return NOT_A_SLOT;
  if (i->op == IR_MUL || i->op == IR_DIV) {
    int minus = 0;
    Slot a = without_sign(p, i->a, &minus), b = without_sign(p, i->b, &minus);
    if (a != i->a || b != i->b) {
      Slot size = prog_op(p, i->op, a, b);
      return minus ? prog_op(p, IR_NEG, size, 0) : size;
    }
  }
  if (i->op == IR_MUL && prog_is_number(p, i->a) && !prog_is_number(p, i->b))
    return prog_constant_fold(p, &(Ins){.op = IR_MUL, .a = i->b, .b = i->a});
  if (!prog_is_number(p, i->b)) return NOT_A_SLOT;
  Num b = p->ins.at[i->b].number;
  if (i->op == IR_MUL && num_is_zero(b)) return 0;
  if (i->op == IR_DIV && num_is_zero(b)) return NOT_A_SLOT;
  if (prog_is_number(p, i->a)) {
    Num a = p->ins.at[i->a].number;
    return prog_num(p, i->op == IR_ADD   ? num_add(a, b)
                       : i->op == IR_SUB ? num_sub(a, b)
                       : i->op == IR_MUL ? num_mul(a, b)
                                         : num_div(a, b));
  }
  if (i->op == IR_DIV) return prog_op(p, IR_MUL, i->a, prog_num(p, num_div(num_int(1), b)));
  const Ins *inner = &p->ins.at[i->a];
  if (i->op != IR_MUL || inner->op != IR_MUL) return NOT_A_SLOT;
  Slot number = prog_is_number(p, inner->a) ? inner->a : prog_is_number(p, inner->b) ? inner->b : 0;
  if (!number) return NOT_A_SLOT;
  Slot rest = number == inner->a ? inner->b : inner->a;
  return prog_op(p, IR_MUL, rest, prog_num(p, num_mul(b, p->ins.at[number].number)));
}
