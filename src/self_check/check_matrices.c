/* Programs of matrices: mass matrix with bias and inverse dynamics, by the text's residual at accelerations that are
 * no solution; derivatives by state, inputs and parameters, by finite differences of the text's residuals. Enters: a
 * state whose motion was compared. Leaves: a verdict, the state as it was. */
#include <math.h>

#include "self_check/self_check_impl.h"
#include "lower/lower.h"

static void random_displacement(Check *c) {
  for (uint32_t i = 0; i < c->n; i++) c->c[i] = check_random(c, -1, 1);
  check_keep_rotations(c);
}

/* --- forces M a + b --- */

/* Value along c->c of the forces that the program says are needed, and the size of their terms. */
static Real along(const Check *c, const Real *M, const Real *force, Real *size) {
  Real sum = 0;
  for (uint32_t i = 0; i < c->n; i++) {
    sum += c->c[i] * force[i];
    *size += fabsl(c->c[i] * force[i]);
    for (uint32_t j = 0; M && j < c->n; j++) {
      sum += c->c[i] * M[i * c->n + j] * c->a[j];
      *size += fabsl(c->c[i] * M[i * c->n + j] * c->a[j]);
    }
  }
  return sum;
}

/* Compares M a + b and the forces of inverse dynamics with the text's residual at these accelerations and no
 * multipliers. */
static CheckVerdict compare_forces(Check *c, const Real *M, const Real *bias, const Real *inverse) {
  Real size = 0, program = bias ? along(c, M, bias, &size) : 0, other = inverse ? along(c, NULL, inverse, &size) : 0;
  if (!check_run_text(c)) return AGREES;
  BoundedSum t = check_residual(c);
  t.size += size;
  CheckVerdict v =
      bias ? check_compare(c, &t, program, c->m->lagrangian_span, "the mass matrix and the bias", NULL) : AGREES;
  return inverse && v != DISAGREES
             ? worse(v, check_compare(c, &t, other, c->m->lagrangian_span, "inverse dynamics", NULL))
             : v;
}

static CheckVerdict check_forces(Check *c) {
  const ProgramSet *u = c->u;
  Real *M = check_reals(c, c->n * c->n), *bias = check_reals(c, c->n), *inverse = check_reals(c, c->n),
       *a = check_reals(c, c->n),
       *lambda = check_reals(c, c->m->constraints.n);
  CheckVerdict v = AGREES;
  for (uint32_t i = 0; i < c->n; i++) a[i] = c->a[i];
  for (uint32_t i = 0; i < c->m->constraints.n; i++) lambda[i] = c->lambda[i], c->lambda[i] = 0;
  random_displacement(c); /* of the accelerations, within the constraint on rotations */
  for (uint32_t i = 0; i < c->n; i++) c->a[i] += c->c[i] * (1 + fabsl(a[i]));
  if (c->m->declared->rotations.n)
    for (uint32_t i = 0; i < c->n; i++) c->a[i] = a[i] + c->c[i];
  random_displacement(c);
  int ran = (!u->mass || (check_run(c, u->mass, (Real *const[]){M}) && check_run(c, u->bias, (Real *const[]){bias}))) &&
            (!u->inverse || check_run(c, u->inverse, (Real *const[]){inverse}));
  if (ran) v = compare_forces(c, M, u->mass ? bias : NULL, u->inverse ? inverse : NULL);
  for (uint32_t i = 0; i < c->n; i++) c->a[i] = a[i];
  for (uint32_t i = 0; i < c->m->constraints.n; i++) c->lambda[i] = lambda[i];
  return v;
}

/* --- derivatives --- */

/* A program of derivatives, the positions of its entries, and the number of its columns. */
typedef struct {
  const Prog *p;
  const IrEntry *at;
  uint32_t n, columns;
  PartialsBy by;
  const char *what;
} Derivatives;

/* The variable of a column, where the text reads it. */
static Real *variable(const Check *c, PartialsBy by, uint32_t i) {
  uint32_t k = 0;
  if (by == BY_INPUTS) return &c->signal[i];
  if (by == BY_STATE) return i < c->n ? &c->q[i] : i < 2 * c->n ? &c->v[i - c->n] : &c->z[i - 2 * c->n];
  while (c->m->params.at[k].fixed || c->m->params.at[k].place != i) k++;
  return &c->given[k];
}

/* Weights of the residuals: equations of motion, then flows, then constraints, without those of unit length, which
 * the text leaves out. */
static Real *weights(Check *c) {
  const Constraints *k = &c->e->constraints;
  uint32_t nz = c->m->states.n;
  Real *w = check_reals(c, c->n + nz + k->n);
  random_displacement(c);
  for (uint32_t i = 0; i < c->n; i++) w[i] = c->c[i];
  for (uint32_t i = 0; i < nz; i++) w[c->n + i] = c->dynamics->flows[i] ? check_random(c, -1, 1) : 0;
  for (uint32_t i = 0; i < k->n; i++)
    if (c->dynamics->constraints[k->of[i] - c->m->constraints.at] && !k->of[i]->inside)
      w[c->n + nz + i] = check_random(c, -1, 1);
  return w;
}

/* The text's residuals times their weights at a perturbed state, with the unperturbed accelerations and multipliers;
 * 0: not finite or unsure. */
static int residual_beside(Check *c, const Real *w, Real *out, Real *size, Real *rounding) {
  const TextDynamics *d = c->dynamics;
  const Constraints *k = &c->e->constraints;
  uint32_t nz = c->m->states.n;
  if (!check_run_text(c)) return 0;
  for (uint32_t i = 0; i < nz; i++) c->zd[i] = check_coefficient(d->tape, c->at, d->flows[i], 0, 0).v;
  if (!check_run_text(c)) return 0;
  BoundedSum r = {0};
  if (c->n) r = check_residual(c);
  for (uint32_t i = 0; i < nz; i++)
    bounded_sum_add(&r, -w[c->n + i], check_coefficient(d->tape, c->at, d->flows[i], 0, 0));
  for (uint32_t i = 0; i < k->n; i++) { /* coefficient 2 is half of c'' */
    int holonomic = i < k->nholonomic;
    Ref of = d->constraints[k->of[i] - c->m->constraints.at];
    bounded_sum_add(&r, w[c->n + nz + i] * (holonomic ? 2 : 1),
                    check_coefficient(d->tape, c->at, of, 0, holonomic ? 2 : 1));
  }
  *out = r.sum.v;
  *size += r.size + r.inner_magnitude;
  *rounding += r.sum.e;
  return isfinite(r.sum.v);
}

/* The program's derivative of the weighted residuals along d, and the size of its terms; 0: the program fails. */
static int derivative_said(Check *c, const Derivatives *x, const Real *w, const Real *d, Real *said, Real *size) {
  const Constraints *k = &c->e->constraints;
  Real *entry = check_reals(c, x->n), *M = check_reals(c, c->u->linear_mass.n), *A = check_reals(c, k->A.n);
  for (uint32_t i = 0; i < k->n; i++) c->gap[i] = c->lambda[k->of[i] - c->m->constraints.at];
  if (!check_run(c, x->p, (Real *const[]){entry, M, A})) return 0;
  for (uint32_t i = 0; i < x->n; i++) {
    Real term = w[x->at[i].row] * entry[i] * d[x->at[i].col];
    *said -= term;
    *size += fabsl(term);
  }
  return 1;
}

/* Sum w_i dr_i/dx_j d_j for random w and d, against finite differences of the text's residuals along d. */
static CheckVerdict check_derivatives(Check *c, const Derivatives *x) {
  Real *d = check_reals(c, x->columns), *base = check_reals(c, x->columns), *zd = check_reals(c, c->m->states.n);
  Real at[4], h = 1e-5L, said = 0, size = 0, inner_magnitude = 0, rounding = 0;
  Real *w = weights(c);
  for (uint32_t i = 0; i < x->columns; i++) {
    Real y = base[i] = *variable(c, x->by, i);
    int angle = x->by == BY_STATE && i < c->n && c->m->coords.at[i].periodic;
    d[i] = check_random(c, -1, 1) * (y != 0 && !angle ? fabsl(y) : 1);
    if (fabsl(y) * jet_unit > 1e-6L * h) return AGREES; /* rounding of y would swamp the difference */
  }
  if (!derivative_said(c, x, w, d, &said, &size)) return AGREES;
  for (uint32_t i = 0; i < c->m->states.n; i++) zd[i] = c->zd[i];
  Real middle, scale = 0, none = 0;
  int ran = residual_beside(c, w, &middle, &scale, &none);
  /* a fast phase, as cos(w t) with a large w t: differences over a small part of a turn */
  if (ran && fabsl(said) * h > h * scale) h *= scale / fabsl(said);
  if (jet_unit > 1e-6L * h) return AGREES;
  for (int k = 0; k < 4 && ran; k++) {
    for (uint32_t i = 0; i < x->columns; i++)
      *variable(c, x->by, i) = base[i] + (k % 2 ? h : -h) * (k < 2 ? 1 : 2) * d[i];
    ran = residual_beside(c, w, &at[k], &inner_magnitude, &rounding);
  }
  for (uint32_t i = 0; i < x->columns; i++) *variable(c, x->by, i) = base[i];
  for (uint32_t i = 0; i < c->m->states.n; i++) c->zd[i] = zd[i];
  if (!ran) return AGREES;
  BoundedSum t = check_derivative(at, h, inner_magnitude, rounding);
  t.size = size;
  t.sum.e /= 64;
  return check_compare(c, &t, said, c->m->lagrangian_span, x->what, NULL);
}

CheckVerdict check_matrices(Check *c) {
  const ProgramSet *u = c->u;
  const Derivatives all[] = {
    {u->linear, u->linear_dr.at, u->linear_dr.n, 2 * c->n + c->m->states.n, BY_STATE, "the linearisation"},
    {u->by_inputs, u->by_inputs_dr.at, u->by_inputs_dr.n, c->m->inputs.n, BY_INPUTS, "the derivatives by inputs"},
    {u->by_params, u->by_params_dr.at, u->by_params_dr.n, u->p.n, BY_PARAMS, "the derivatives by parameters"},
  };
  CheckVerdict v = AGREES;
  if (c->m->first_order || c->dynamics->why || (c->n && !c->dynamics->lagrangian)) return AGREES;
  if (c->n && (u->mass || u->inverse)) v = check_forces(c);
  for (size_t i = 0; i < sizeof all / sizeof *all && v != DISAGREES; i++) {
    int turns = all[i].by == BY_STATE && c->m->declared->rotations.n; /* displacements would turn with the state */
    if (all[i].p && !turns) v = worse(v, check_derivatives(c, &all[i]));
  }
  return v;
}
