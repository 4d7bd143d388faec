/* Extrapolates the motion from a run's last good state, q + h v + h^2/2 a with h doubling, and evaluates the text's
 * tapes along it until an instruction with finite operands is not finite. Contract: self_check.h. */
#include "self_check/self_check.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

#include "self_check/self_check_impl.h"

typedef struct {
  const double *number;
  uint32_t n;
  int ended; /* the run, at this state */
} Numbers;

static void copy_numbers(Real *to, uint32_t n, const double **from) {
  for (uint32_t i = 0; i < n; i++) to[i] = *(*from)++;
}

/* Sets the state from the numbers; 0: their count does not fit the model. */
static int read_numbers(Check *c, const Numbers *of) {
  const Model *m = c->m;
  uint32_t variables = 1 + 2 * c->n + m->states.n, parameters = of->n - variables;
  const double *at = of->number;
  if (of->n < variables || parameters > m->params.n + c->u->nderived) return 0;
  copy_numbers(&c->t, 1, &at);
  copy_numbers(c->q, c->n, &at);
  copy_numbers(c->v, c->n, &at);
  copy_numbers(c->z, m->states.n, &at);
  copy_numbers(c->p, parameters, &at);
  if (c->u->derived && !check_run(c, c->u->derived, (Real *const[]){c->p})) return 0;
  for (uint32_t i = 0; i < m->params.n; i++)
    c->given[i] = m->params.at[i].fixed ? (Real)num_value(m->params.at[i].number) : c->p[m->params.at[i].place];
  for (uint32_t i = 0; i < c->n + m->states.n; i++) c->c[i] = 1;
  return 1;
}

/* Notes the expression, its operands, and the state. */
static void note_expression(Check *c, const Tape *t, const Jet *at, Ref r, int ended) {
  const TapeIns *i = &t->ins.at[r];
  const Real x = tape_value(t, at, i->a)->c[0][0].v, y = i->b ? tape_value(t, at, i->b)->c[0][0].v : 0,
             value = tape_value(t, at, r)->c[0][0].v;
  const char *of = fabsl(value) <= DBL_MAX ? "the derivatives of this expression have" : "this expression has",
             *format = i->op == TAPE_DIV ? ": %.6Lg divided by %.6Lg"
                       : i->b            ? " at %.6Lg and %.6Lg"
                                         : " at %.6Lg";
  char operands[80];
  Diags *d = c->m->diags;
  snprintf(operands, sizeof operands, format, x, y);
  diag_note(d, ast_expr(c->m->ast, i->at)->span, "%s%s no finite value%s", ended ? "the run ends here, where " : "", of,
            operands);
  diag_help(d, "at %s", check_state_text(c));
}

static int search_tape(Check *c, const Tape *t, int derivatives, Jet *at, int ended) {
  Ref r = tape_first_nonfinite(t, check_input, c, derivatives, at);
  if (!r || !t->ins.at[r].at) return 0;
  note_expression(c, t, at, r, ended);
  return 1;
}

static int search_motion(Check *c, const void *data) {
  const Numbers *of = data;
  check_prepare(c);
  if (!read_numbers(c, of)) return 0;
  const Check start = *c;
  Real *q = ARENA_ARRAY(c->arena, Real, c->n + 1), *v = ARENA_ARRAY(c->arena, Real, c->n + 1),
       *z = ARENA_ARRAY(c->arena, Real, c->m->states.n + 1);
  if (!check_solve_motion(c))
    for (uint32_t i = 0; i < c->n; i++) c->a[i] = 0;
  for (uint32_t i = 0; i < c->n; i++) q[i] = c->q[i], v[i] = c->v[i], c->a[i] = isfinite(c->a[i]) ? c->a[i] : 0;
  for (uint32_t i = 0; i < c->m->states.n; i++) z[i] = c->z[i], c->zd[i] = isfinite(c->zd[i]) ? c->zd[i] : 0;
  const Real shortest = 1e-14L * (1 + fabsl(start.t)), longest = 1 + fabsl(start.t);
  for (int derivatives = 0; derivatives < 2; derivatives++) /* values before derivatives, which overflow earlier */
    for (Real h = 0; h < longest; h = h > 0 ? 2 * h : shortest) {
      c->t = start.t + h;
      for (uint32_t i = 0; i < c->n; i++) c->q[i] = q[i] + h * (v[i] + h / 2 * c->a[i]), c->v[i] = v[i] + h * c->a[i];
      for (uint32_t i = 0; i < c->m->states.n; i++) c->z[i] = z[i] + h * c->zd[i];
      if (!check_run(c, c->u->inputs, (Real *const[]){c->signal})) continue;
      if (search_tape(c, c->dynamics->tape, derivatives, c->at, of->ended) ||
          search_tape(c, c->outputs->tape, derivatives, c->at_outputs, of->ended))
        return 1;
    }
  return 0;
}

int nonfinite_note(const Eqns *e, const ProgramSet *u, const double *number, uint32_t n) {
  SelfCheck statistics;
  return check_with(e, u, 0, &statistics, search_motion, &(Numbers){number, n ? n - 1 : 0, n && number[n - 1] > 0});
}
