/* Shapes of expressions. A name is its letters and, apart, the indices in its brackets; a quantified sum is its body,
 * and the places of its terms (sym/sum_terms.c). */
#include "sym/text_shape.h"

#include <ctype.h>
#include <stdlib.h>

#include "sym/sum_nest.h"

/* Fowler, Noll, Vo: FNV-1a, by words. */
void expr_shape_add_number(ExprShape *to, uint64_t x) {
  to->structure = (to->structure ^ x) * 0x100000001b3u;
  to->structure ^= to->structure >> 29;
  to->parts++;
}

void expr_shape_add_name(Arena *a, const char *name, ExprShape *to) {
  uint64_t text = 0xcbf29ce484222325u;
  for (const char *s = name; *s;) {
    int inside = s > name && (s[-1] == '[' || s[-1] == ',' || (s[-1] == '{' && s > name + 1 && s[-2] == '_'));
    int is_index = inside && isdigit((unsigned char)*s);
    text = (text ^ (is_index ? '#' : (unsigned char)*s)) * 0x100000001b3u;
    if (!is_index) {
      s++;
      continue;
    }
    char *end;
    int64_t index = strtoll(s, &end, 10);
    vec_push(a, &to->index, index);
    s = end;
  }
  expr_shape_add_number(to, text);
}

static void add_value(ExprShape *to, Num c) {
  expr_shape_add_number(to, (uint64_t)c.num);
  expr_shape_add_number(to, (uint64_t)c.den);
  if (num_is_exact(c)) return;
  uint64_t bits;
  double value = num_value(c);
  memcpy(&bits, &value, sizeof bits);
  expr_shape_add_number(to, bits);
}

typedef VEC(Expr) Pending;

static void add_cell(ExprGraph *g, Arena *a, Expr cell, ExprShape *to, Pending *next) {
  SumPlaces all = expr_sum_places(g, cell);
  expr_shape_add_number(to, expr_nest_number(g, expr_cell_nest(g, cell)));
  for (uint32_t k = 0; k < all.n; k++) {
    const SumPlace *x = &all.at[k];
    expr_shape_add_number(to, 4 * (uint64_t)x->share + 2 * (uint64_t)x->fixed_row + (uint64_t)x->fixed_turn);
    int64_t numbers[4] = {x->fixed_row ? x->row : 0, x->fixed_turn ? x->turn : 0, x->fixed_row ? 0 : x->rows[0],
                          x->fixed_row ? 0 : x->rows[1]};
    for (int i = 0; i < 4; i++) vec_push(a, &to->index, numbers[i]);
    for (uint32_t i = 0; i < x->nargs; i++) vec_push(a, next, x->args[i]);
  }
}

void expr_shape_add(ExprGraph *g, Arena *a, Expr e, ExprShape *to) {
  Pending next = {0};
  vec_push(a, &next, e);
  while (next.n && expr_shape_is_known(to)) {
    Expr x = next.at[--next.n];
    ExprOp op = expr_op(g, x);
    expr_shape_add_number(to, op);
    if (op == EX_NUM) add_value(to, expr_number(g, x));
    else if (op == EX_SYM) expr_shape_add_name(a, expr_sym_of(g, x)->name, to);
    else if (op == EX_DEF) expr_shape_add_name(a, expr_def_name(g, x), to);
    else if (op == EX_CELL) add_cell(g, a, x, to, &next);
    else if (op == EX_SUM || op == EX_PROD) {
      expr_shape_add_number(to, expr_pairs(g, x, op));
      for (ExprPair pair = {0}; expr_next_pair(g, x, op, &pair);) {
        add_value(to, pair.num);
        vec_push(a, &next, pair.of);
      }
    } else
      for (uint32_t i = 0; i < expr_nargs(g, x); i++) vec_push(a, &next, expr_arg(g, x, i));
  }
}
