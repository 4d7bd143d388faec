/* Curves of a phase space and their actions: separation, derivatives of H, the scene's start. The integral is
 * numeric/action_integral.c's, in long double. */
#include "phase_space/action_variables.h"

#include <math.h>

#include "mech/consistent_start.h"
#include "mech/discontinuity.h"
#include "numeric/action_integral.h"
#include "sym/diff.h"
#include "sym/expr_eval.h"
#include "sym/simplify.h"

typedef long double Real;

/* --- the integral --- */

/* H of one pair, the others as at the start. */
typedef struct {
  EvalTape *tape; /* action_roots */
  Real *symbols;
  SymId q, p;
} Curve;

static lag_phase_point point_at(void *context, Real q, Real p) {
  Curve *c = context;
  Real out[4];
  c->symbols[c->q] = q;
  c->symbols[c->p] = p;
  eval_run(c->tape, c->symbols, out);
  return (lag_phase_point){out[0], out[1], out[2], out[3]};
}

/* --- the state --- */

static Real *start_state(const PhaseSpace *s) {
  const Model *m = s->e->m;
  Real *found = start_requested(s->e), *symbols = ARENA_ARRAY(m->arena, Real, expr_symbol_count(s->e->g) + 1);
  for (SymId k = 1; k <= expr_symbol_count(s->e->g); k++) symbols[k] = found[k];
  for (uint32_t i = 0; i < m->inputs.n; i++)
    if (m->inputs.at[i].value) expr_eval(s->e->g, &m->inputs.at[i].value, 1, symbols, &symbols[m->inputs.at[i].sym]);
  for (uint32_t i = 0; i < s->n && s->rate; i++) expr_eval(s->e->g, &s->e->p[i], 1, symbols, &symbols[s->p[i]]);
  return symbols;
}

void action_roots(const PhaseSpace *s, uint32_t i, Expr *roots) {
  ExprGraph *g = s->e->g;
  Expr slope = expr_diff(g, s->H, s->p[i]), bend = expr_diff(g, slope, s->p[i]), force = expr_diff(g, s->H, s->q[i]);
  roots[0] = s->H, roots[1] = simplify(g, slope), roots[2] = simplify(g, bend), roots[3] = simplify(g, force);
}

/* Digits of a number with this relative error, up to 16. */
static int digits_of(Real error) { return error < 1e-12L ? 16 : error < 0.1L ? (int)-log10l(error) : 1; }

static void pair_action(const PhaseSpace *s, uint32_t i, const Real *start, ActionVariable *out) {
  const Real pi = 3.14159265358979323846264338327950288L;
  ExprGraph *g = s->e->g;
  uint32_t count = expr_symbol_count(g) + 1;
  Curve c = {.q = s->q[i], .p = s->p[i], .symbols = ARENA_ARRAY(expr_arena(g), Real, count)};
  Expr roots[4];
  action_roots(s, i, roots);
  for (uint32_t k = 0; k < count; k++) c.symbols[k] = start[k];
  c.tape = eval_tape(g, roots, 4);
  lag_action_integral x =
      lag_action_of_curve(point_at, &c, start[c.q], start[c.p], model_is_periodic(s->e->m, s->q[i]));
  *out = (ActionVariable){.why_not = x.why_not,
                          .rests = x.rests, .rotates = x.rotates, .J = x.J, .omega = 2 * pi / x.time, .low = x.low,
                          .high = x.high};
  out->digits = digits_of(x.error);
  out->omega_digits = digits_of(x.time_error);
}

/* NULL: a cyclic coordinate has its momentum as its action. */
static const char *reason_against_cyclic(const PhaseSpace *s, uint32_t i) {
  return model_is_periodic(s->e->m, s->q[i]) ? NULL
                                             : "it is cyclic, and not declared periodic: its motion does not turn";
}

static void cyclic_action(const PhaseSpace *s, uint32_t i, const Real *start, ActionVariable *out) {
  out->cyclic = 1;
  out->J = start[s->p[i]];
  out->omega = NAN;
  out->why_not = reason_against_cyclic(s, i);
}

static const char *reason_of_tie(const PhaseSpace *s, const Separation *x) {
  const ExprGraph *g = s->e->g;
  Arena *a = s->e->m->arena;
  Name qi = expr_symbol(g, s->q[x->i])->name, qj = expr_symbol(g, s->q[x->j])->name;
  if (x->i == x->j)
    return arena_printf(a, "H does not separate in these coordinates: it contains %s, and not its momentum", qi);
  return arena_printf(a, "H does not separate in these coordinates: Levi-Civita's condition for %s and %s %s%s", qi, qj,
                      x->refuted ? "fails" : "is not decided",
                      x->refuted && s->e->m->params.n ? ", for general values of the parameters" : "");
}

/* Whether H jumps where a coordinate or a momentum crosses some value: derivatives do not show it. */
static int jumps_with_the_state(const PhaseSpace *s) {
  ExprJumps jumps = discontinuities_of(s->e, s->H);
  for (uint32_t k = 0; k < jumps.n; k++)
    for (uint32_t i = 0; i < s->n; i++)
      if (expr_contains_sym(s->e->g, jumps.at[k].side, s->q[i]) ||
          expr_contains_sym(s->e->g, jumps.at[k].side, s->p[i]))
        return 1;
  return 0;
}

/* Reason against an action of the pair, whatever its state is. */
static const char *reason_against_action(const PhaseSpace *s, const Separation *x, int jumps, uint32_t i) {
  if (jumps) return "H jumps with the coordinates or momenta, and its derivatives do not show it";
  if (x->kind[i] == PAIR_TIED) return reason_of_tie(s, x);
  return x->kind[i] == PAIR_CYCLIC ? reason_against_cyclic(s, i) : NULL;
}

PairKind pair_with_action(const PhaseSpace *s, uint32_t i, const char **why_not) {
  Separation x = separation_of(s);
  *why_not = reason_against_action(s, &x, jumps_with_the_state(s), i);
  return x.kind[i];
}

int action_variables(Eqns *e, ActionVariables *out) {
  Arena *a = e->m->arena;
  PhaseSpace *s = ARENA_NEW(a, PhaseSpace);
  if (!phase_space_of(e, e->m->span, s)) return 0;
  s->H = expr_expand_defs(e->g, s->H);
  ActionVariable *all = ARENA_ARRAY(a, ActionVariable, s->n + 1);
  *out = (ActionVariables){.space = s, .at = all, .separation = separation_of(s)};
  Separation *x = &out->separation;
  int jumps = jumps_with_the_state(s);
  x->separates = x->separates && !jumps;
  Real *start = start_state(s); /* after all symbols are made */
  expr_eval(e->g, &s->H, 1, start, &out->E);
  for (uint32_t i = 0; i < s->n; i++) {
    if (!jumps && x->kind[i] == PAIR_CYCLIC) cyclic_action(s, i, start, &all[i]);
    else if ((all[i].why_not = reason_against_action(s, x, jumps, i)) == NULL) pair_action(s, i, start, &all[i]);
    if (x->tangled[i]) all[i].omega = NAN;
  }
  return 1;
}
