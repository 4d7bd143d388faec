/* Switches on the branch that a run holds: sign, abs, min, max, comparisons and floor read their mode, an input
 * behind those of the model.
 *
 * Mode 1 or -1: the branch where the switching function is positive or negative, at any state; between: the branch
 * of a sliding motion; of floor: its value; FREE: none is held, and the state decides as the text says. */
#include "lower/lower_impl.h"
#include "mech/switches.h"

static Slot select(Lower *l, Slot c, Slot a, Slot b) {
  return prog_ins(l->p, (Ins){.op = IR_SELECT, .a = c, .b = a, .c = b});
}

static Slot load_mode(Lower *l, const Switch *s) {
  uint32_t k = (uint32_t)(s - l->e->switches.at);
  return prog_ins(l->p, (Ins){.op = IR_LOAD,
                              .array = ARR_U,
                              .index = l->e->m->inputs.n + k,
                              .name = arena_printf(l->p->arena, "side_%u", k + 1)});
}

/* The mode where one is held, else `otherwise`. by_slips: where a motion slides; its mode is no branch, which is 1. */
static Slot held_or(Lower *l, Slot mode, int sign, Slot otherwise) {
  Slot most = prog_num(l->p, num_double(HELD_MOST)), held = op(l, IR_LT, mode, most),
       value = sign < 0 ? op(l, IR_NEG, mode, 0) : mode;
  if (l->by_slips) {
    Slot one = prog_num(l->p, num_int(1)), square = op(l, IR_MUL, mode, mode);
    held = op(l, IR_AND, held, op(l, IR_OR, op(l, IR_LT, square, one), op(l, IR_LT, one, square)));
  }
  return select(l, held, value, otherwise);
}

static Slot arg(const Lower *l, Expr e, uint32_t i) { return lower_slot(l, expr_arg(l->g, e, i)); }

/* The switch of a comparison, or of a function of one switching function; NULL: none. */
static const Switch *any_switch_at(const Lower *l, Expr e, int *sign) {
  ExprOp o = expr_op(l->g, e);
  if (o == EX_SIGN || o == EX_ABS || o == EX_FLOOR) return switch_of(l->e, expr_arg(l->g, e, 0), o == EX_FLOOR, sign);
  if (o != EX_LT && o != EX_LE && o != EX_MIN && o != EX_MAX) return NULL;
  return switch_of(l->e, expr_sub(l->g, expr_arg(l->g, e, 1), expr_arg(l->g, e, 0)), 0, sign);
}

/* The same, of those whose mode is held. */
static const Switch *switch_at(const Lower *l, Expr e, int *sign) {
  if (!l->e->switches.nmodes || l->by_text || expr_map_get(l->e->switches.by_text, e)) return NULL;
  const Switch *s = any_switch_at(l, e, sign);
  return s && l->by_slips && !s->jumps ? NULL : s;
}

/* A choice on a surface where the motion slides: the mean of both branches, weighted by the mode. */
static Slot sliding_choice(Lower *l, Expr e, const Switch *s, int sign, Slot otherwise) {
  Slot mode = load_mode(l, s), one = prog_num(l->p, num_int(1)), half = prog_num(l->p, num_ratio(1, 2)),
       below = prog_num(l->p, num_int(-1));
  Slot over = op(l, IR_LT, below, mode), under = op(l, IR_LT, mode, one), slides = op(l, IR_AND, over, under);
  Slot sum = op(l, sign < 0 ? IR_SUB : IR_ADD, one, mode), weight = op(l, IR_MUL, half, sum),
       rest = op(l, IR_SUB, one, weight);
  Slot a = op(l, IR_MUL, weight, arg(l, e, 1)), b = op(l, IR_MUL, rest, arg(l, e, 2)), mean = op(l, IR_ADD, a, b);
  return select(l, slides, mean, otherwise);
}

Slot lower_held_branch(Lower *l, Expr e) {
  int sign;
  ExprOp o = expr_op(l->g, e);
  if (o == EX_SELECT) {
    const Switch *s = switch_at(l, expr_arg(l->g, e, 0), &sign);
    return s && s->jumps ? sliding_choice(l, e, s, sign, select(l, arg(l, e, 0), arg(l, e, 1), arg(l, e, 2)))
                         : NOT_A_SLOT;
  }
  const Switch *s = switch_at(l, e, &sign);
  if (!s) return NOT_A_SLOT;
  Slot mode = load_mode(l, s), a = arg(l, e, 0);
  if (o == EX_FLOOR) return held_or(l, mode, 1, prog_ins(l->p, (Ins){.op = IR_FN1, .a = a, .text = "floor"}));
  if (o == EX_SIGN) return held_or(l, mode, sign, op(l, IR_SIGN, a, 0));
  if (o == EX_ABS) {
    Slot side = held_or(l, mode, sign, op(l, IR_SIGN, a, 0));
    return op(l, IR_MUL, side, a);
  }
  Slot b = arg(l, e, 1), side = held_or(l, mode, sign, op(l, IR_SUB, b, a));
  if (o == EX_LT || o == EX_LE) return op(l, o == EX_LT ? IR_LT : IR_LE, 0, side);
  Slot larger = op(l, IR_LT, 0, side); /* b is the larger one */
  return o == EX_MIN ? select(l, larger, a, b) : select(l, larger, b, a);
}
