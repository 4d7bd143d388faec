/* Values of the text against those of the programs: flows, constraints, energy; events, outputs, inputs. */
#include <float.h>
#include <math.h>

#include "self_check/self_check_impl.h"

/* Compares value r of the text's outputs, if it has one, with the program's. */
static CheckVerdict check_output_value(Check *c, Ref r, Real program, Span span, const char *what, const char *name) {
  return r ? check_value(c, check_coefficient(c->outputs->tape, c->at_outputs, r, 0, 0), program, span, what, name)
           : AGREES;
}

/* --- dynamics: values from the last check_run_text, whatever its direction --- */

static CheckVerdict check_flows(Check *c) {
  const TextDynamics *d = c->dynamics;
  CheckVerdict v = AGREES;
  for (uint32_t i = 0; i < c->m->states.n; i++)
    if (d->flows[i])
      v = worse(v, check_value(c, check_coefficient(d->tape, c->at, d->flows[i], 0, 0), c->zd[i],
                               c->m->states.at[i].span, "the rate of", c->m->states.at[i].name));
  return v;
}

/* c'' of holonomic constraints and c' of velocity constraints must be 0. */
static CheckVerdict check_constraints(Check *c) {
  const Constraints *k = &c->e->constraints;
  CheckVerdict v = AGREES;
  for (uint32_t i = 0; i < k->n; i++) {
    Ref r = c->dynamics->constraints[k->of[i] - c->m->constraints.at];
    if (!r) continue;
    Bounded rate = check_coefficient(c->dynamics->tape, c->at, r, 0, i < k->nholonomic ? 2 : 1);
    BoundedSum t = {rate, 0, 0};
    /* magnitude of the terms: accelerations, */
    for (uint32_t j = 0; j < c->n; j++) t.size += fabsl(c->a[j]) + c->v[j] * c->v[j];
    /* and the multipliers' forces in them */
    for (uint32_t j = 0; j < c->m->constraints.n; j++) t.size += fabsl(c->lambda[j]);
    v = worse(v, check_compare(c, &t, 0, k->of[i]->span, "the rate of the constraint", k->of[i]->name));
  }
  return v;
}

/* The potential that completes the energy, from its expression: its rate is proved to be minus the power of forces
 * and of explicit time, which are compared on their own. */
static Bounded potential(const Check *c) {
  const Model *m = c->m;
  long double bound, *symbols = model_constants(m);
  symbols[m->time] = (long double)c->t;
  for (uint32_t i = 0; i < c->n; i++) symbols[m->coords.at[i].q] = (long double)c->q[i];
  for (uint32_t i = 0; i < m->states.n; i++) symbols[m->states.at[i].z] = (long double)c->z[i];
  for (uint32_t i = 0; i < m->params.n; i++) symbols[m->params.at[i].sym] = (long double)c->given[i];
  long double value = eqns_potential_at(c->e, symbols, &bound);
  return (Bounded){(Real)value, (Real)bound};
}

/* Energy p q' - L, and the potential of forces; p q' is the change of L under the displacement along the velocity. */
static CheckVerdict check_energy(Check *c) {
  const TextDynamics *d = c->dynamics;
  Real value[2] = {0};
  BoundedSum t = {0};
  if (!c->u->energy || !d->lagrangian) return AGREES;
  for (uint32_t i = 0; i < check_components(c); i++)
    c->c[i] = c->m->first_order ? c->zd[i] * c->m->states.at[i].coordinate : c->v[i];
  if (!check_run_text(c) || !check_run(c, c->u->energy, (Real *const[]){value})) return DISMISSED;
  bounded_sum_add(&t, 1, check_coefficient(d->tape, c->at, d->lagrangian, 2, 0));
  bounded_sum_add(&t, -1, check_coefficient(d->tape, c->at, d->lagrangian, 0, 0));
  if (c->e->potential) bounded_sum_add(&t, 1, potential(c));
  c->energy = t;
  c->has_energy = 1;
  return check_compare(c, &t, value[0], c->m->lagrangian_span, "the energy", NULL);
}

static CheckVerdict check_events(Check *c) {
  const TextOutputs *o = c->outputs;
  const Model *m = c->m;
  Real *g = ARENA_ARRAY(c->arena, Real, m->events.n + 1), *set[3];
  CheckVerdict v = AGREES;
  if (!m->events.n || !check_run(c, c->u->event_values, (Real *const[]){g})) return AGREES;
  for (uint32_t i = 0; i < m->events.n; i++)
    v = worse(v, check_output_value(c, o->events[i], g[i], m->events.at[i].span, "the event", m->events.at[i].name));
  for (int k = 0; k < 3; k++) set[k] = ARENA_ARRAY(c->arena, Real, (k < 2 ? m->coords.n : m->states.n) + 1);
  for (uint32_t i = 0; i < o->actions.n; i++) {
    const TextAction *a = &o->actions.at[i];
    if (!a->value || !check_run(c, c->u->events.at[a->event].action, set)) continue;
    v = worse(v, check_output_value(c, a->value, set[a->kind == SYM_COORD ? 0 : a->kind == SYM_VEL ? 1 : 2][a->index],
                               m->events.at[a->event].span, "the value set by the event", m->events.at[a->event].name));
  }
  return v;
}

static CheckVerdict check_outputs(Check *c) {
  const TextOutputs *o = c->outputs;
  const Scene *scene = &c->e->m->scene;
  Real *value = ARENA_ARRAY(c->arena, Real, scene->outputs.n + 1);
  CheckVerdict v = AGREES;
  if (!scene->outputs.n || !check_run(c, c->u->scenes.at[c->scene].observe, (Real *const[]){value})) return AGREES;
  for (uint32_t i = 0; i < scene->outputs.n; i++) {
    const Output *of = &scene->outputs.at[i];
    v = worse(v, check_output_value(c, o->outputs[i], value[i], of->span, "the output", of->name));
    if (o->is_energy[i] && c->has_energy)
      v = worse(v, check_compare(c, &c->energy, value[i], of->span, "the output", of->name));
  }
  return v;
}

/* --- families of contacts --- */

static int64_t read_index(const IrRead *x, const TextMember *of) {
  return x->first + x->by_row * of->row + x->by_turn * of->turn;
}

/* The program of a member at the state, its velocities times `factor`. */
static int run_member(const Check *c, const TextMember *of, Real factor, Real *out) {
  const IrContactFamily *f = &c->u->families.at[of->family];
  Real *q = ARENA_ARRAY(c->arena, Real, f->coords.n + 1), *v = ARENA_ARRAY(c->arena, Real, f->coords.n + 1),
       *z = ARENA_ARRAY(c->arena, Real, f->params.n + 1);
  for (uint32_t k = 0; k < f->coords.n; k++) {
    q[k] = c->q[read_index(&f->coords.at[k], of)];
    v[k] = factor * c->v[read_index(&f->coords.at[k], of)];
  }
  for (uint32_t k = 0; k < f->params.n; k++) z[k] = c->p[read_index(&f->params.at[k], of)];
  const Real *in[ARR_COUNT] = {[ARR_T] = &c->t, [ARR_Q] = q, [ARR_V] = v, [ARR_Z] = z, [ARR_P] = c->p,
                               [ARR_U] = c->signal};
  return prog_eval(f->values, in, (Real *const[]){out}) == 0;
}

/* A rate less its value at rest is its row of A times the velocities. */
static CheckVerdict check_row(Check *c, const TextMember *of, const Real *row, Real rate, Real rest) {
  const IrContactFamily *f = &c->u->families.at[of->family];
  const ContactFamily *text = &c->m->families.at[of->family];
  BoundedSum t = {0};
  for (uint32_t k = 0; k < f->coords.n; k++) {
    Real v = c->v[read_index(&f->coords.at[k], of)];
    bounded_sum_add(&t, 1, (Bounded){row[k] * v, LDBL_EPSILON * fabsl(row[k] * v)});
  }
  t.size += fabsl(rate) + fabsl(rest);
  return check_compare(c, &t, rate - rest, text->span, "the row of the contacts", text->name);
}

static CheckVerdict check_member(Check *c, const TextMember *of) {
  const IrContactFamily *f = &c->u->families.at[of->family];
  const ContactFamily *text = &c->m->families.at[of->family];
  const Tape *tape = c->outputs->tape;
  static const uint32_t place[] = {0, 2, 3, 4, 5, 6, 7};
  uint32_t rates = FAMILY_VALUES + f->tangents;
  Real *out = ARENA_ARRAY(c->arena, Real, rates + (1 + f->tangents) * f->coords.n + 1),
       *rest = ARENA_ARRAY(c->arena, Real, rates + (1 + f->tangents) * f->coords.n + 1);
  CheckVerdict v = AGREES;
  if (!run_member(c, of, 1, out) || !run_member(c, of, 0, rest)) return DISMISSED;
  for (uint32_t k = 0; k < 5 + f->tangents; k++)
    v = worse(v, check_output_value(c, of->value[k], out[place[k]], text->span, "the contacts", text->name));
  if (of->value[0])
    v = worse(v, check_value(c, check_coefficient(tape, c->at_outputs, of->value[0], 0, 1), out[1], text->span,
                             "the rate of the contacts", text->name));
  for (uint32_t j = 0; j <= f->tangents; j++) {
    uint32_t at = j ? FAMILY_VALUES - 1 + j : 1;
    v = worse(v, check_row(c, of, out + rates + j * f->coords.n, out[at], rest[at]));
  }
  return v;
}

static CheckVerdict check_families(Check *c) {
  CheckVerdict v = AGREES;
  for (uint32_t i = 0; i < c->outputs->members.n && c->u->families.n; i++)
    v = worse(v, check_member(c, &c->outputs->members.at[i]));
  return v;
}

static CheckVerdict check_signals(Check *c) {
  const TextOutputs *o = c->outputs;
  Real *value = ARENA_ARRAY(c->arena, Real, c->m->inputs.n + 1);
  CheckVerdict v = AGREES;
  if (!c->m->inputs.n || !check_run(c, c->u->inputs, (Real *const[]){value})) return AGREES;
  for (uint32_t i = 0; i < c->m->inputs.n; i++)
    v = worse(v, check_output_value(c, o->signals[i], value[i], c->m->inputs.at[i].span, "the input",
                                    c->m->inputs.at[i].name));
  return v;
}

CheckVerdict check_dynamic_values(Check *c) {
  CheckVerdict v = worse(check_flows(c), check_constraints(c));
  if (v != DISAGREES) v = check_energy(c);
  return v == DISAGREES ? v : AGREES; /* DISMISSED values decide nothing */
}

CheckVerdict check_other_values(Check *c) {
  int unsure = 0;
  for (uint32_t i = 0; i < check_components(c); i++) c->c[i] = 0; /* no displacement */
  tape_run(c->outputs->tape, check_input, c, c->at_outputs, &unsure);
  /* unsure values have infinite error bounds, and are dismissed */
  return worse(worse(check_events(c), check_outputs(c)), worse(check_signals(c), check_families(c)));
}
