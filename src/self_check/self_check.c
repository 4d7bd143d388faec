/* Self-check: choice of states, comparison of two values, report. A value agrees if the difference is within SLACK
 * times the text's error bound, or within a fixed part of the terms' size. Contract: self_check.h. */
#include "self_check/self_check_impl.h"

#include <float.h>
#include <math.h>

/* Programs are evaluated in the precision of jets, but constants folded at compile time are doubles, 2^11 times
 * coarser. A factor of 2^16 on the jets' bound leaves 16 for the program's own roundings. */
static const Real SLACK = 65536;

/* Relative tolerance, as a part of the terms' size: a program may cancel where the text does not. Far from the start
 * cancellation is worse. */
static const Real NEAR_PART = 1e-9L, FAR_PART = 1e-4L;

enum { STATES_WANTED = 5, STATES_FEW = 3, SHORT_TAPE = 300, ATTEMPTS = 24, ENDLESS_TAPE = 600000 };

void bounded_sum_add(BoundedSum *t, Real factor, Bounded x) {
  Bounded term = bounded_mul((Bounded){factor, 0}, x);
  t->sum = bounded_add(t->sum, term);
  t->size += fabsl(term.v);
}

/* --- comparing --- */

const char *check_state_text(const Check *c) {
  enum { MOST = 8 };
  StrBuf s = strbuf(c->arena);
  for (uint32_t i = 0; i < c->m->coords.n && i < MOST; i++)
    sb_printf(&s, "%s = %.17Lg, %s' = %.17Lg, ", c->m->coords.at[i].name, c->q[i], c->m->coords.at[i].name, c->v[i]);
  for (uint32_t i = 0; i < c->m->states.n && i < MOST; i++)
    sb_printf(&s, "%s = %.17Lg, ", c->m->states.at[i].name, c->z[i]);
  for (uint32_t i = 0; i < c->m->params.n && i < 2 * MOST; i++)
    sb_printf(&s, "%s = %.17Lg, ", c->m->params.at[i].name, c->given[i]);
  sb_printf(&s, "t = %.17Lg", c->t);
  return sb_text(&s);
}

/* Text: t->sum.v with error t->sum.e, a sum of terms of total size t->size; program: `program`. */
CheckVerdict check_compare(Check *c, const BoundedSum *t, Real program, Span span, const char *what, const char *name) {
  Real difference = fabsl(t->sum.v - program), size = t->size + fabsl(program),
       bound = SLACK * (t->sum.e + jet_unit * t->inner_magnitude);
  if (!isfinite(t->sum.v) || !isfinite(t->sum.e) || !isfinite(t->inner_magnitude) || t->size > DBL_MAX)
    return DISMISSED;
  if (isfinite(program) && bound > 1e-3L * (size + t->inner_magnitude)) return DISMISSED; /* rounding left no digits */
  c->statistics->values++;
  if (difference <= bound || difference <= (c->far ? FAR_PART : NEAR_PART) * size) return AGREES;
  diag_error(c->m->diags, span, "internal error: %s%s%s: the text gives %.12Lg, the compiled program %.12Lg", what,
             name ? " " : "", name ? name : "", t->sum.v, program);
  diag_help(c->m->diags, "at %s; nothing was written. This is a mistake in lagc, not in the model: please report it",
            check_state_text(c));
  return DISAGREES;
}

CheckVerdict check_value(Check *c, Bounded text, Real program, Span span, const char *what, const char *name) {
  BoundedSum t = {text, fabsl(text.v), 0};
  return check_compare(c, &t, program, span, what, name);
}

static int is_finite(const Real *x, uint32_t n) {
  while (n > 0 && isfinite(x[n - 1])) n--;
  return n == 0;
}

/* Long output formulas are compared at the first state and at far states only. */
static int asks_outputs(const Check *c) {
  return c->outputs->tape->ins.n <= SHORT_TAPE || c->statistics->states == 0 || c->far;
}

static CheckVerdict check_state(Check *c, int dynamics) {
  CheckVerdict v = DISMISSED;
  c->has_energy = 0;
  if (dynamics && !c->dynamics->why) v = worse(check_equations(c), AGREES);
  if (v == AGREES) v = check_dynamic_values(c);
  if (v != DISAGREES && asks_outputs(c) && check_other_values(c) == DISAGREES) v = DISAGREES;
  return v == AGREES ? check_motion(c) : v;
}

/* Names of outputs that are not compared (charges, closed forms), or NULL. */
static const char *outputs_left_out(const Check *c) {
  enum { MOST = 8 };
  const Scene *scene = &c->m->scene;
  StrBuf s = strbuf(c->m->arena);
  uint32_t n = 0;
  for (uint32_t i = 0; i < scene->outputs.n; i++) {
    const Output *of = &scene->outputs.at[i];
    if (c->outputs->outputs[i] || !of->from.id || (c->outputs->is_energy[i] && !c->dynamics->why)) continue;
    if (n++ < MOST) sb_printf(&s, "%s%s", n > 1 ? ", " : "", of->name);
  }
  if (n > MOST) sb_printf(&s, " and %u more", n - MOST);
  return n ? sb_text(&s) : NULL;
}

static int check_states(Check *c, const void *data) {
  (void)data;
  c->samples = !expr_writes_sums_out(c->e->g);
  check_prepare(c);
  uint32_t length = c->dynamics->tape->ins.n, wanted = length > LONG_TAPE                           ? 1
                                                       : length > SHORT_TAPE || c->m->constraints.n ? STATES_FEW
                                                                                                    : STATES_WANTED;
  c->statistics->unsupported = c->dynamics->why;
  c->statistics->outputs = outputs_left_out(c);
  int attempts = c->dynamics->tape->too_long ? 1 : ATTEMPTS; /* outputs alone are compared: no state would count */
  for (int attempt = 0; attempt < attempts && c->statistics->states < wanted; attempt++) {
    if (!check_choose_state(c, attempt)) continue;
    int solved = check_solve_motion(c) && is_finite(c->a, c->n) && is_finite(c->zd, c->m->states.n);
    CheckVerdict v = !solved ? check_failure(c) : check_state(c, length <= ENDLESS_TAPE);
    if (v == DISAGREES) return 0;
    c->statistics->states += v == AGREES;
    c->statistics->far += v == AGREES && c->far;
  }
  int plain = c->n && !c->m->first_order && !c->m->constraints.n && !c->m->declared->rotations.n && !c->u->nmodes;
  if (plain && !c->dynamics->why && length <= SHORT_TAPE) check_zeros(c);
  return 1;
}

int check_with(const Eqns *e, const ProgramSet *u, uint32_t scene, SelfCheck *statistics,
               int (*run)(Check *c, const void *data), const void *data) {
  jmp_buf out_of_memory;
  Arena *scratch = arena_new(NULL);
  if (!scratch) arena_fail(e->m->arena);
  if (setjmp(out_of_memory)) {
    arena_free(scratch);
    arena_fail(e->m->arena);
  }
  arena_guard(scratch, &out_of_memory);
  *statistics = (SelfCheck){0};
  Check c = {.e = e,
             .m = e->m, .u = u, .scene = scene, .arena = scratch, .random = 20261122, .reach = 1,
             .statistics = statistics};
  int result = run(&c, data);
  arena_free(scratch);
  return result;
}

int self_check_ends(const Eqns *e, SelfCheck *statistics) {
  enum { MANY = 10000 }; /* texts of fewer coordinates are shorter */
  *statistics = (SelfCheck){0};
  if (e->n > MANY) statistics->unsupported = text_dynamics(e->m, !expr_writes_sums_out(e->g), e->m->arena)->why;
  return !statistics->unsupported;
}

int self_check(const Eqns *e, const ProgramSet *u, uint32_t scene, SelfCheck *statistics) {
  return check_with(e, u, scene, statistics, check_states, NULL);
}

void self_check_print(const Eqns *e, const SelfCheck *statistics, StrBuf *out) {
  const Model *m = e->m;
  sb_printf(out, "compared with the text%s%s: %u value%s at %u state%s, %u of them far from the start",
            m->scene.name ? ", scene " : "", m->scene.name ? m->scene.name : "", statistics->values,
            statistics->values == 1 ? "" : "s", statistics->states, statistics->states == 1 ? "" : "s",
            statistics->far);
  if (statistics->directions)
    sb_printf(out, "; equations of motion along %u displacement%s at each", statistics->directions,
              statistics->directions == 1 ? "" : "s");
  sb_puts(out, statistics->states ? "\n" : ": no state allowed a comparison\n");
  if (statistics->unsupported)
    sb_printf(out,
              "  not compared: the equations of motion, whose text has `%s`, which the comparison does not evaluate\n",
              statistics->unsupported);
  if (statistics->outputs) sb_printf(out, "  not compared: the outputs %s\n", statistics->outputs);
}
