/* Potentials of forces and explicit time, which complete an energy. Enters: their power along
 * motions, linear in velocities; leaves: V(q, t), or whether there is one. Holds: single-valued
 * over periodic coordinates, without jumps, with values wherever the forces have them. */
#include "symmetry/noether_theorem_impl.h"

#include <math.h>

#include "mech/discontinuity.h"
#include "mech/motion_proof.h"
#include "sym/diff.h"
#include "sym/integrate.h"
#include "sym/prove.h"
#include "sym/sides.h"

/* Whether V has one value at each position: coordinates declared periodic enter by periodic functions. */
static int is_single_valued(const ProofWork *w, Expr V) {
  Expr turn = expr_mul(w->g, expr_int(w->g, 2), expr_symbol(w->g, w->m->pi)->node);
  for (uint32_t i = 0; i < w->n; i++) {
    if (!model_is_periodic(w->m, w->q[i]) || !expr_contains_sym(w->g, V, w->q[i])) continue;
    Expr there = expr_add(w->g, proof_node(w, w->q[i]), turn), moved = expr_replace(w->g, V, &w->q[i], &there, 1);
    if (prove_zero(w->g, expr_sub(w->g, moved, V), NULL) != PROVED_ZERO) return 0;
  }
  return 1;
}

/* A power a q' + b that forces and explicit time give, by coordinates and t; a[n] is b. */
typedef struct {
  Expr *a;
  SymId *q;
} LinearPower;

/* Whether it has forces of pairs with velocities, whose power is not linear in them. */
static int has_moving_sums(ExprGraph *g, Expr power) {
  ExprList l = expr_topo_to_sums(g, &power, 1);
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(g, l.at[k]) == EX_CELL && expr_kinds(g, l.at[k]) & 1u << SYM_VEL) return 1;
  return 0;
}

/* Whether the power has that form: velocities enter it linearly, and nothing but q and t otherwise. */
static int linear_power(const ProofWork *w, Expr power, LinearPower *to) {
  const unsigned other = 1u << SYM_INPUT | 1u << SYM_MULTIPLIER, moving = 1u << SYM_VEL | 1u << SYM_RATE;
  Arena *arena = w->m->arena;
  ExprGraph *g = w->g;
  if (expr_kinds(g, power) & other || expr_contains(g, power, is_no_coordinate, w->m->states.at)) return 0;
  if (has_moving_sums(g, power)) return 0;
  *to = (LinearPower){ARENA_ARRAY(arena, Expr, w->n + 1), ARENA_ARRAY(arena, SymId, w->n + 1)};
  expr_gradient(g, power, w->v, w->n, to->a);
  to->a[w->n] = noether_at_rest(w, power);
  memcpy(to->q, w->q, w->n * sizeof *w->q);
  to->q[w->n] = w->m->time;
  for (uint32_t i = 0; i < w->n; i++) {
    if (expr_kinds(g, to->a[i]) & moving) to->a[i] = noether_shorten(w, to->a[i]);
    if (expr_kinds(g, to->a[i]) & moving) return 0;
  }
  return 1;
}

static int may_jump(const ProofWork *w, Expr x) {
  ExprList l = expr_topo(w->g, &x, 1);
  int may = switch_in(w->g, x, 0) != 0;
  for (uint32_t i = 0; i < l.n && !may; i++)
    may = expr_op(w->g, l.at[i]) == EX_FLOOR || expr_op(w->g, l.at[i]) == EX_ATAN2;
  return may;
}

/* Whether x jumps: then forces that are the gradient of x beside the jumps leave no energy conserved. */
static int jumps_somewhere(const ProofWork *w, Expr x) {
  return may_jump(w, x) && discontinuities_of(w->e, x).n > 0;
}

/* Whether a force on a periodic coordinate does work over a turn, by values at a random state: the
 * trapezoidal and the midpoint rule, which errors of the sums move apart, agree on it. A switch
 * shifts both by the width of an interval, so that only more work than that counts. */
static int works_over_a_turn(const ProofWork *w, uint32_t i, Expr force) {
  enum { POINTS = 256 };
  const long double turn = 6.28318530717958647692528676655900577L;
  const long double rounding = may_jump(w, force) ? 0.05L : 1e-9L;
  long double bound, sum[2] = {0, 0}, size = 0;
  long double *symbols = ARENA_ARRAY(w->m->arena, long double, expr_symbol_count(w->g) + 1);
  BoundTape *tape = bound_tape(w->g, &force, 1);
  sample_state(w->g, 1, symbols);
  for (int k = 0; k < 2 * POINTS; k++) {
    symbols[w->q[i]] = turn * k / (2 * POINTS);
    bound_run(tape, symbols, NULL);
    long double value = bound_value(tape, force, &bound);
    sum[k % 2] += value;
    size += fabsl(value);
  }
  long double work = fabsl(sum[0] + sum[1]);
  return !(work <= rounding * size) && !(fabsl(sum[0] - sum[1]) > work / 4);
}

/* Whether the form a dq + b dt has a potential: 2, each part depends on its own coordinate alone;
 * 1, it has no curl, so that there is one near each position; 0, it has a curl. */
static int has_potential(const ProofWork *w, const LinearPower *by) {
  ExprGraph *g = w->g;
  ExprMap place = expr_map(w->m->arena);
  int is = 2;
  for (uint32_t i = 0; i <= w->n; i++) expr_map_set(&place, proof_node(w, by->q[i]), i + 1);
  for (uint32_t i = 0; i <= w->n; i++) {
    ExprList l = expr_topo(g, &by->a[i], 1);
    int turns = i < w->n && model_is_periodic(w->m, w->q[i]) && !expr_is_zero(g, by->a[i]);
    if (turns && (!is_single_valued(w, by->a[i]) || works_over_a_turn(w, i, by->a[i]))) return 0;
    if (turns) is = 1;
    for (uint32_t k = 0; k < l.n; k++) {
      uint32_t j = expr_map_get(&place, l.at[k]);
      if (!j || j - 1 == i) continue;
      if (jumps_somewhere(w, by->a[i])) return 0;
      is = 1;
      Expr one = expr_diff(g, by->a[i], by->q[j - 1]), other = expr_diff(g, by->a[j - 1], by->q[i]);
      if (!zero_on_sides(g, expr_sub(g, one, other))) return 0;
    }
  }
  return is;
}

/* Whether forces contain too many coordinates to be integrated: some 50 that all depend on each other, or 16 each. */
static int couples_many(const ProofWork *w, const LinearPower *by) {
  enum { MOST = 2500, MOST_EACH = 16 };
  uint64_t couplings = 0;
  for (uint32_t i = 0; i < w->n; i++) {
    ExprList l = expr_topo(w->g, &by->a[i], 1);
    for (uint32_t k = 0; k < l.n; k++)
      couplings += expr_op(w->g, l.at[k]) == EX_SYM && expr_sym_of(w->g, l.at[k])->kind == SYM_COORD;
    expr_list_free(w->g, l);
    if (couplings > MOST && couplings > (uint64_t)MOST_EACH * w->n) return 1;
  }
  return 0;
}

/* Divisors in x: marks them, or returns whether one is neither marked nor proved to be other than 0. */
static int find_divisors(ExprGraph *g, Expr x, ExprMap *marked, int marks) {
  ExprList l = expr_topo(g, &x, 1);
  for (uint32_t i = 0; i < l.n; i++)
    for (uint32_t k = 0; expr_op(g, l.at[i]) == EX_PROD && k < expr_nargs(g, l.at[i]); k += 2) {
      Expr of = expr_arg(g, l.at[i], k);
      if (num_sign(expr_number(g, expr_arg(g, l.at[i], k + 1))) >= 0) continue;
      if (marks) expr_map_set(marked, of, 1);
      else if (!expr_map_get(marked, of) && !expr_is_nonzero(g, of)) return 1;
    }
  return 0;
}

/* Whether V may have no value where the forces have one: -F/b*sin(b*x) of F*cos(b*x) at b = 0. */
static int may_lack_values(ExprGraph *g, Expr V, Expr power) {
  ExprMap divisors = expr_map(expr_arena(g));
  find_divisors(g, power, &divisors, 1);
  return find_divisors(g, V, &divisors, 0);
}

Expr noether_potential(const ProofWork *w, Expr power, int *exists) {
  ExprGraph *g = w->g;
  Expr *slope = ARENA_ARRAY(w->m->arena, Expr, w->n + 1);
  LinearPower by;
  *exists = 0;
  if (!linear_power(w, expr_neg(g, power), &by)) return 0;
  if (couples_many(w, &by)) return *exists = 3, 0;
  Expr V = noether_shorten(w, expr_potential(g, by.a, by.q, w->n + 1, 1));
  int found = !expr_is_zero(g, V), single = is_single_valued(w, V);
  expr_gradient(g, V, by.q, w->n + 1, slope);
  for (uint32_t i = 0; i <= w->n; i++) {
    by.a[i] = expr_sub(g, by.a[i], slope[i]);
    found = found && zero_on_sides(g, by.a[i]);
  }
  if (!found && proof_is_constrained(w) && !expr_is_zero(g, V))
    found = motion_verdict(w->e, expr_add(g, power, noether_total(w, V))) == PROVED_ZERO;
  /* branches that are integrated apart may still have no work over a turn */
  if (!single) linear_power(w, expr_neg(g, power), &by);
  if (single && found && may_lack_values(g, V, power)) return *exists = 2, 0;
  *exists = single && found ? 0 : has_potential(w, &by);
  return single && found && !jumps_somewhere(w, V) ? V : 0;
}
