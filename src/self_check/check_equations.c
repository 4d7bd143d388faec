/* Residuals of the text's equations of motion along virtual displacements, with the accelerations of the program.
 * Formula: self_check.h. */
#include <math.h>

#include "self_check/self_check_impl.h"

/* --- evaluation of the text at a state --- */

static void input_jet(Jet *out, Real x, Real rate, Real second, Real direction) {
  *out = (Jet){.planes = direction != 0 ? JET_PLANES : 1};
  out->c[0][0].v = x;
  out->c[0][1].v = rate;
  out->c[0][2].v = second / 2;
  out->c[1][0].v = direction;
  out->c[2][1].v = direction;
}

/* An input, with the rates that the model has. */
static void signal_jet(const Check *c, uint32_t i, Jet *out) {
  uint32_t rate = i < c->m->inputs.n ? c->m->inputs.at[i].rate : 0, second = rate ? c->m->inputs.at[rate].rate : 0;
  if (rate) input_jet(out, c->signal[i], c->signal[rate], second ? c->signal[second] : 0, 0);
  else *out = jet_exact(c->signal[i]);
}

void check_input(void *data, InputKind kind, uint32_t i, Jet *out) {
  const Check *c = data;
  switch (kind) {
    case INPUT_TIME: input_jet(out, c->t, 1, 0, 0); return;
    case INPUT_COORD:
      input_jet(out, c->q[i], c->v[i], c->a[i], c->c[i]);
      out->c[0][2].e = c->error + c->a_error[i];
      return;
    case INPUT_STATE:
      input_jet(out, c->z[i], c->zd[i], c->zdd[i], c->m->first_order && c->m->states.at[i].coordinate ? c->c[i] : 0);
      out->c[0][1].e = c->error + c->zd_error[i];
      return;
    case INPUT_PARAM: *out = jet_exact(c->given[i]); return;
    case INPUT_SIGNAL: signal_jet(c, i, out); return;
    case INPUT_MULTIPLIER:
      *out = jet_exact(c->lambda[i]);
      out->c[0][0].e = c->lambda_error[i];
      return;
  }
}

Bounded check_coefficient(const Tape *tape, const Jet *at, Ref r, int plane, int k) {
  return r ? tape_value(tape, at, r)->c[plane][k] : (Bounded){0, 0};
}

int check_run_text(Check *c) {
  int unsure = 0;
  tape_run(c->dynamics->tape, check_input, c, c->at, &unsure);
  return !unsure;
}

/* Work of a torque along the displacement dq: 2 tau.(conj(q) dq). */
static Bounded torque_work(const Check *c, const TextForce *f) {
  const Tape *t = c->dynamics->tape;
  Bounded q[4], d[4], work = {0, 0};
  for (int k = 0; k < 4; k++) {
    q[k] = check_coefficient(t, c->at, f->point[k], 0, 0);
    d[k] = check_coefficient(t, c->at, f->point[k], 1, 0);
  }
  for (int k = 1; k < 4; k++) {
    int i = k % 3 + 1, j = i % 3 + 1;
    Bounded turn = bounded_sub(bounded_mul(q[0], d[k]), bounded_mul(q[k], d[0]));
    turn = bounded_sub(turn, bounded_sub(bounded_mul(q[i], d[j]), bounded_mul(q[j], d[i])));
    work = bounded_add(work,
                       bounded_mul(bounded_mul((Bounded){2, 0}, turn), check_coefficient(t, c->at, f->f[k - 1], 0, 0)));
  }
  return work;
}

/* r += sign Q.c, forces and dissipation. */
static void add_forces(const Check *c, Real sign, BoundedSum *r) {
  const TextDynamics *d = c->dynamics;
  for (uint32_t i = 0; i < d->forces.n; i++) {
    const TextForce *f = &d->forces.at[i];
    if (f->torque) bounded_sum_add(r, sign, torque_work(c, f));
    else
      bounded_sum_add(r, sign,
                      bounded_mul(check_coefficient(d->tape, c->at, f->f[0], 0, 0),
                                  check_coefficient(d->tape, c->at, f->point[0], 1, 0)));
  }
  bounded_sum_add(r, -sign, check_coefficient(d->tape, c->at, d->dissipation, 2, 0));
}

static void add_multipliers(const Check *c, BoundedSum *r) {
  const Constraints *k = &c->e->constraints;
  for (uint32_t i = 0; i < k->n; i++) {
    uint32_t place = (uint32_t)(k->of[i] - c->m->constraints.at);
    if (k->of[i]->inside) continue; /* displacements satisfy it: check_keep_rotations */
    bounded_sum_add(r, -1,
                    bounded_mul((Bounded){c->lambda[place], c->lambda_error[place]},
                                check_coefficient(c->dynamics->tape, c->at, c->dynamics->constraints[place],
                                                  i < k->nholonomic ? 1 : 2, 0)));
  }
}

BoundedSum check_residual(const Check *c) {
  const TextDynamics *d = c->dynamics;
  BoundedSum r = {0};
  bounded_sum_add(&r, 1, check_coefficient(d->tape, c->at, d->lagrangian, 2, 1));
  bounded_sum_add(&r, -2, check_coefficient(d->tape, c->at, d->lagrangian, 1, 0));
  add_forces(c, -1, &r);
  add_multipliers(c, &r);
  Bounded L = check_coefficient(d->tape, c->at, d->lagrangian, 0, 0);
  r.inner_magnitude = isfinite(L.e) ? fabsl(L.v) : NAN; /* NAN where L has no derivative: no comparison */
  r.inner_magnitude += fabsl(check_coefficient(d->tape, c->at, d->lagrangian, 2, 0).v);
  return r;
}

/* Along c->c: compares the residual with 0, and, with `variation`, dL/dq, momentum and force with the program's. */
static CheckVerdict check_direction(Check *c, const char *name, Span span, const Real *const *variation) {
  const TextDynamics *d = c->dynamics;
  BoundedSum momentum = {0}, slope = {0}, force = {0};
  if (!check_run_text(c)) return DISMISSED;
  BoundedSum residual = check_residual(c);
  CheckVerdict v = check_compare(c, &residual, 0, span, "the residual of the equation of motion of", name);
  if (!variation || v != AGREES) return v;
  Real of[3] = {0};
  for (int k = 0; k < 3; k++)
    for (uint32_t i = 0; i < c->n; i++) of[k] += variation[k][i] * c->c[i];
  bounded_sum_add(&slope, 1, check_coefficient(d->tape, c->at, d->lagrangian, 1, 0));
  bounded_sum_add(&momentum, 1, check_coefficient(d->tape, c->at, d->lagrangian, 2, 0));
  add_forces(c, 1, &force);
  for (int k = 0; k < 3; k++) { /* terms of each may cancel in it */
    BoundedSum *t = k == 0 ? &slope : k == 1 ? &momentum : &force;
    t->inner_magnitude += residual.size + residual.inner_magnitude;
  }
  v = worse(v, check_compare(c, &slope, of[0], span, "dL/dq of", name));
  v = worse(v, check_compare(c, &momentum, of[1], span, "the momentum of", name));
  return worse(v, check_compare(c, &force, of[2], span, "the force on", name));
}

void check_keep_rotations(Check *c) {
  const Declarations *b = c->m->declared;
  for (uint32_t i = 0; i < b->rotations.n; i++) {
    Real *d = c->c + b->rotations.at[i], *q = c->q + b->rotations.at[i], along = 0;
    for (int k = 0; k < 4; k++) along += d[k] * q[k];
    for (int k = 0; k < 4; k++) d[k] -= along * q[k];
  }
}

Real check_rounding_part(Check *c) {
  for (uint32_t k = 0; k < check_components(c); k++) c->c[k] = 1;
  if (!c->m->first_order) check_keep_rotations(c);
  if (!check_run_text(c)) return 0;
  BoundedSum r = check_residual(c);
  Real part = r.size > 0 ? (r.sum.e + jet_unit * r.inner_magnitude) / r.size : 0;
  return isfinite(part) ? part : 0;
}

uint32_t check_components(const Check *c) { return c->m->first_order ? c->m->states.n : c->n; }

static CheckVerdict check_coordinate(Check *c, uint32_t i, const Real *const *variation) {
  const Model *m = c->m;
  if (m->first_order && !m->states.at[i].coordinate) return AGREES;
  for (uint32_t k = 0; k < check_components(c); k++) c->c[k] = k == i;
  if (!m->first_order) check_keep_rotations(c);
  return check_direction(c, m->first_order ? m->states.at[i].name : m->coords.at[i].name, m->lagrangian_span,
                         variation);
}

/* Checks one random combination of all coordinates; on disagreement, each coordinate, to name the wrong one. */
static CheckVerdict check_combination(Check *c, const Real *const *variation) {
  for (uint32_t k = 0; k < check_components(c); k++)
    c->c[k] = check_random(c, 0.3L, 1) * (check_random(c, 0, 1) < 0.5L ? -1 : 1);
  if (c->m->first_order)
    for (uint32_t k = 0; k < check_components(c); k++) c->c[k] *= c->m->states.at[k].coordinate;
  else check_keep_rotations(c);
  uint32_t errors = c->m->diags->errors;
  Diags *heard = c->m->diags;
  Model *m = (Model *)c->m; /* only its diags: the combination's message is dropped */
  m->diags = diags_new(c->arena, c->m->ast->sources);
  CheckVerdict v = check_direction(c, "all coordinates", m->lagrangian_span, variation);
  m->diags = heard;
  for (uint32_t i = 0; v == DISAGREES && i < check_components(c) && m->diags->errors == errors; i++)
    check_coordinate(c, i, variation);
  if (v == DISAGREES && m->diags->errors == errors)
    check_direction(c, "all coordinates", m->lagrangian_span, variation);
  return v;
}

CheckVerdict check_equations(Check *c) {
  const Real *variation[3] = {0};
  CheckVerdict v = AGREES;
  if (!c->n && !c->m->first_order) return check_run_text(c) ? AGREES : DISMISSED;
  if (c->u->variation) {
    Real *out[3];
    for (int k = 0; k < 3; k++) variation[k] = out[k] = ARENA_ARRAY(c->arena, Real, c->n + 1);
    if (!check_run(c, c->u->variation, out)) return DISMISSED;
  }
  const Real *const *given = variation[0] ? variation : NULL;
  uint32_t n = check_components(c), length = c->dynamics->tape->ins.n,
           singles = length >= LONG_TAPE ? 0
                     : n <= FEW          ? n
                                         : 1;
  if (n > FEW || !singles) v = check_combination(c, given);
  for (uint32_t i = 0; i < singles && v == AGREES; i++)
    v = worse(v, check_coordinate(c, n <= FEW ? i : (uint32_t)(check_random(c, 0, 1) * n), given));
  c->statistics->directions = singles + (n > FEW || !singles);
  return v;
}

/* --- states at which the program fails --- */

/* Entry (i, j) of the text's mass matrix, dp_i/dv_j by a central difference. */
static Real text_inertia(Check *c, uint32_t i, uint32_t j, int *known) {
  Real v = c->v[j], h = 1e-4L * (1 + fabsl(v)), p[2];
  for (uint32_t k = 0; k < c->n; k++) c->c[k] = k == i;
  for (int side = 0; side < 2; side++) {
    c->v[j] = side ? v + h : v - h;
    int sure = check_run_text(c);
    p[side] = check_coefficient(c->dynamics->tape, c->at, c->dynamics->lagrangian, 2, 0).v;
    *known &= sure && isfinite(p[side]);
  }
  c->v[j] = v;
  return (p[1] - p[0]) / (2 * h);
}

/* 1 if the text's mass matrix is positive definite by Cholesky's test, each pivot above 1e-8 of its diagonal entry. */
static int text_is_definite(Check *c) {
  Real M[FEW][FEW];
  int known = 1;
  for (uint32_t i = 0; i < c->n; i++)
    for (uint32_t j = 0; j <= i; j++) M[i][j] = text_inertia(c, i, j, &known);
  for (uint32_t k = 0; k < c->n && known; k++) {
    Real diagonal = M[k][k];
    for (uint32_t j = 0; j < k; j++) M[k][k] -= M[k][j] * M[k][j] / M[j][j];
    known &= diagonal > 1e-200L && M[k][k] > 1e-8L * diagonal;
    for (uint32_t i = k + 1; i < c->n; i++)
      for (uint32_t j = 0; j < k; j++) M[i][k] -= M[i][j] * M[k][j] / M[j][j];
  }
  return known;
}

/* 1 if the text's forces, flows and dissipation are finite at this state. */
static int text_is_finite(Check *c) {
  const TextDynamics *d = c->dynamics;
  for (uint32_t k = 0; k < c->n; k++) c->c[k] = 1;
  int sure = check_run_text(c);
  BoundedSum r = check_residual(c);
  for (uint32_t i = 0; i < c->m->states.n; i++)
    sure &= isfinite(check_coefficient(d->tape, c->at, d->flows[i], 0, 0).v);
  return sure && isfinite(r.sum.v) && isfinite(r.inner_magnitude) &&
         isfinite(check_coefficient(d->tape, c->at, d->dissipation, 0, 0).v) && r.size < 1e150L;
}

/* The program has no finite accelerations: an error if the text's equations are finite with a positive definite mass
 * matrix. */
CheckVerdict check_failure(Check *c) {
  if (!c->n || c->n > FEW || c->dynamics->why || c->dynamics->tape->ins.n > LONG_TAPE || c->m->constraints.n)
    return DISMISSED;
  c->error = 0;
  for (uint32_t i = 0; i < c->n; i++) c->a[i] = 0;
  for (uint32_t i = 0; i < c->m->states.n; i++) c->zd[i] = 0;
  if (!text_is_finite(c) || !text_is_definite(c)) return DISMISSED;
  diag_error(c->m->diags, c->m->lagrangian_span,
             "internal error: the compiled program has no finite accelerations where the text has");
  diag_help(c->m->diags, "at %s; nothing was written. This is a mistake in lagc, not in the model: please report it",
            check_state_text(c));
  return DISAGREES;
}
