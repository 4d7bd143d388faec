/* Scan of a logarithmic grid along axes and random lines, then bisection for sign changes, golden section for minima of |u|. */
#include "mech/switching_functions.h"

#include <math.h>

#include "sym/eval.h"
#include "sym/prove.h"

typedef long double Real;

#define STEPS_MOST 1e7

enum { SWITCHES_MOST = 24, AXES_MOST = 12, LINES = 4, DECADES = 24, PER_DECADE = 4, SIDE = DECADES * PER_DECADE + 1, GRID = 2 * SIDE + 1 };

SwitchingFunctions switching_functions(ExprGraph *g, const Expr *roots, uint32_t n) {
  VEC(Expr) found = {0};
  ExprList l = expr_topo(g, roots, n);
  for (uint32_t i = 0; i < l.n && found.n < SWITCHES_MOST; i++) {
    ExprOp op = expr_op(g, l.at[i]);
    int two = op == EX_LT || op == EX_LE || op == EX_EQ || op == EX_MIN || op == EX_MAX;
    if (!two && op != EX_ABS && op != EX_SIGN) continue;
    Expr u = expr_arg(g, l.at[i], 0);
    if (two) u = expr_sub(g, u, expr_arg(g, l.at[i], 1));
    uint32_t k = 0;
    while (k < found.n && found.at[k] != u) k++;
    if (k == found.n && !expr_is_num(g, u)) vec_push(expr_arena(g), &found, u);
  }
  return (SwitchingFunctions){found.at, found.n};
}

void switch_line_set(SwitchLine line, long double t, long double *symbols) {
  if (line.axis) symbols[line.axis] = t;
  for (uint32_t i = 0; i < line.count && !line.axis; i++) symbols[i] = line.base[i] + t * line.slope[i];
}

typedef struct {
  EvalTape *u;
  Real *symbols; /* values on the line */
  Real *base;
  SwitchLine line;
} Scan;

static Real value_at(Scan *s, Real t) {
  Real u;
  switch_line_set(s->line, t, s->symbols);
  eval_run(s->u, s->symbols, &u);
  return u;
}

/* Bisects [below, above] down to neighbouring numbers; u < 0 (negative) or u > 0 at `below`. Returns the end where u no longer has that sign. */
static Real bisect(Scan *s, Real below, Real above, int negative) {
  for (int i = 0; i < 300; i++) {
    Real middle = below + (above - below) / 2;
    if (middle == below || middle == above) break;
    Real u = value_at(s, middle);
    if (negative ? u < 0 : u > 0) below = middle;
    else above = middle;
  }
  return above;
}

/* Minimum of |u| in [from, to], by golden section. */
static Real minimise_abs(Scan *s, Real from, Real to) {
  const Real ratio = 0.61803398874989484820L;
  for (int i = 0; i < 90; i++) {
    Real a = to - ratio * (to - from), b = from + ratio * (to - from);
    if (fabsl(value_at(s, a)) < fabsl(value_at(s, b))) to = b;
    else from = a;
  }
  return from + (to - from) / 2;
}

/* Grid point i: -1e12 ... -1e-12, 0, 1e-12 ... 1e12. */
static Real grid(int i) { return i == SIDE ? 0 : i < SIDE ? -grid(2 * SIDE - i) : powl(10, (Real)(i - SIDE - 1) / PER_DECADE - 12); }

static int scan(Scan *s, int from, int to, SwitchTry *try, void *data) {
  Real t[GRID], u[GRID];
  for (int i = from; i < to; i++) {
    t[i] = grid(i);
    u[i] = value_at(s, t[i]);
  }
  for (int i = from + 1; i < to; i++) {
    if (!isfinite(u[i - 1]) || !isfinite(u[i])) continue;
    int changes = (u[i - 1] < 0) != (u[i] < 0) || (u[i - 1] > 0) != (u[i] > 0);
    int dips = i + 1 < to && fabsl(u[i]) < fabsl(u[i - 1]) && fabsl(u[i]) <= fabsl(u[i + 1]);
    if (changes && try(data, s->base, s->line, u[i - 1] == 0 ? t[i - 1] : u[i] == 0 ? t[i] : bisect(s, t[i - 1], t[i], u[i - 1] < 0), 1)) return 1;
    if (changes || !dips) continue;
    Real least = minimise_abs(s, t[i - 1], t[i + 1]);
    if (try(data, s->base, s->line, least, 0)) return 1;
    if ((value_at(s, least) < 0) != (u[i] < 0) && try(data, s->base, s->line, bisect(s, t[i - 1], least, u[i - 1] < 0), 1)) return 1;
  }
  return 0;
}

int switching_functions_search(ExprGraph *g, const SwitchingFunctions *all, const SymId *free, uint32_t nfree, long double *base, uint32_t seed, SwitchTry *try, void *data) {
  Arena *a = expr_arena(g);
  uint32_t count = expr_symbol_count(g) + 1;
  Real *symbols = ARENA_ARRAY(a, Real, count), *slope = ARENA_ARRAY(a, Real, count);
  double steps = 0; /* evaluated nodes so far */
  for (uint32_t k = 0; k < all->n && steps < STEPS_MOST; k++) {
    Scan s = {.u = eval_tape(g, &all->at[k], 1), .symbols = symbols, .base = base};
    uint32_t axes = 0;
    double cost = 2.0 * GRID * expr_topo(g, &all->at[k], 1).n;
    for (uint32_t i = 0; i < nfree && axes < AXES_MOST; i++) {
      if (!expr_contains_sym(g, all->at[k], free[i])) continue;
      ExprSign sign = expr_symbol(g, free[i])->sign;
      int positive = sign == SIGN_POSITIVE || sign == SIGN_NONNEGATIVE, negative = sign == SIGN_NEGATIVE || sign == SIGN_NONPOSITIVE;
      axes++;
      steps += cost;
      memcpy(symbols, base, count * sizeof *symbols);
      s.line = (SwitchLine){.axis = free[i]};
      if (scan(&s, positive ? SIDE + 1 : 0, negative ? SIDE : GRID, try, data)) return 1;
    }
    for (uint32_t line = 0; line < LINES && axes > 1; line++) {
      for (uint32_t i = 0; i < nfree; i++)
        slope[free[i]] = expr_symbol(g, free[i])->sign == SIGN_UNKNOWN ? sample_symbol(g, free[i], 1000 + LINES * seed + line) : 0;
      steps += cost;
      memcpy(symbols, base, count * sizeof *symbols);
      s.line = (SwitchLine){.base = base, .slope = slope, .count = count};
      if (scan(&s, 0, GRID, try, data)) return 1;
    }
  }
  return 0;
}
