/* Eqns -> Prog and ProgramSet: the only reader of mech/eqns.h in src/ir.
 *
 * Each function below makes the program of one emitted function. Output arrays are numbered in the
 * order of that function's declaration in lag_model.h. */
#pragma once

#include "ir/prog.h"
#include "mech/linearise.h"
#include "series/series.h"
#include "ir/program_set.h"
#include "mech/eqns.h"
#include "mech/lagrangian_hessian.h"

Prog *lower_accel_traced(const Eqns *e, int libm, StrBuf *trace); /* the same, with a listing after each pass */
/* out 0: a[nq], out 1: zd[nz]; libm: sin and cos are calls of the C library, not inline */
Prog *lower_accel(const Eqns *e, int libm);
/* M, f and the rates of the states, with inputs replaced by their formulas; both unsolved and solved */
IrSystem lower_system(const Eqns *e);
Prog *lower_energy(const Eqns *e);  /* out 0: e[2], the energy and its scale */
Prog *lower_charges(const Eqns *e); /* out 0: value and scale of each charge but the energy */
int lower_rubs(const Eqns *e); /* friction takes energy, of contacts, too */
/* out 0: time derivative of each charge, the energy first, and the power of friction; NULL: there is none, all 0 */
Prog *lower_charge_rates(const Eqns *e);
Prog *lower_variation(const Eqns *e, const Variation *x); /* out 0, 1, 2: dL/dq[nq], dL/dq'[nq], Q[nq] */
Prog *lower_second_derivatives(const Eqns *e, const Variation *x);    /* out 0: h[number of entries] */
Prog *lower_events(const Eqns *e);  /* out 0: g[nev] */
Prog *lower_switches(const Eqns *e); /* out 0: value of each switching function */
Prog *lower_sizes(const Eqns *e, int moving); /* out 0: those of e->sizes that move, or not; NULL: none */
Prog *lower_contact_laws(const Eqns *e); /* out 0: as contact_laws of lag_model.h; NULL: no contact has friction */
/* as lower_projection, out 2: as guide_loads of lag_model.h; NULL: no contact may load a guide */
Prog *lower_guide_loads(const Eqns *e);
Prog *lower_contact_coefficients(const Eqns *e); /* the same without multipliers, two numbers each */
/* out 0: the largest mode of a sliding motion, for each that has a mode; NULL: all are 1 */
Prog *lower_switch_grips(const Eqns *e);
Prog *lower_switch_rates(const Eqns *e); /* out 0: total time derivative of each that has a mode */
Prog *lower_action(const Eqns *e, uint32_t event); /* out 0, 1, 2: q1, v1, z1; only components that the event sets */
Prog *lower_inputs(const Eqns *e);  /* out 0: u[nu] */
/* out 0: entries of dr, out 1: entries of M, out 2: entries of A, in their order; reads q'' and, as g, the
 * multipliers */
Prog *lower_linear(const Eqns *e, Partials dr, PartialsBy by);

/* out 0: x^T dF/dy [2 nq + nz], out 1: by inputs, then parameters [nu + np], out 2: entries of `formulas`; F: the
 * accelerations and rates of states, x: read as g [nq + nz]; reads q''. */
Prog *lower_adjoint(const Eqns *e, const AdjointPartials *d);
/* With constraints, whose multipliers lower_adjoint reads behind g: out 0, 1: as lower_accel, out 2: the multipliers;
 * and the transpose of the projection onto the constraints, for x read as g [2 nq + nz], with the outputs of
 * lower_adjoint. */
Prog *lower_rates_and_multipliers(const Eqns *e);
Prog *lower_adjoint_projection(const Eqns *e, const AdjointPartials *d);

/* Derivatives d of the outputs without closed forms, of the formulas of free parameters, and of those of inputs, 0
 * for a table: rows in this order (eqns_output_partials). Accelerations are computed inside. */
Prog *lower_output_partials(const Eqns *e, Partials *d);
Prog *lower_mass(const Eqns *e);     /* out 0: M[nq*nq], entries that are not 0 */
Prog *lower_forces(const Eqns *e, const Expr *x); /* out 0: x[nq]; may read q'' */
Prog *lower_event_derivatives(const Eqns *e, EventPartials jumps); /* out 0: entries of jumps, in their order */
/* lower_families.c: families of contacts, and M, which their impulses move. */
void lower_families(ProgramSet *u, const Eqns *e);
/* u->kepler, where L has a Kepler part. */
void lower_kepler(ProgramSet *u, const Eqns *e);
/* Models with constraints (lower_constraints.c). */
Prog *lower_residuals(const Eqns *e); /* out 0: c[nkept], out 1: r: their rates, then nonholonomic constraints */
Prog *lower_matrices(const Eqns *e);  /* out 0: nonzero entries of A, out 1: of M */
/* out 0: the change d[nq] with A d = g for the first nrows constraints that is least in the metric M; out 1: A^T mu
 * = M d. */
Prog *lower_projection(const Eqns *e, uint32_t nrows);
Prog *lower_multipliers(const Eqns *e); /* out 0: lambda of each constraint, in the order of e->constraints */
/* out 0: v1, the velocities after the impact of the contact whose entry of g is 1, the others 0; NULL: no contact
 * strikes */
Prog *lower_impact(const Eqns *e);
Prog *lower_outputs(const Eqns *e); /* out 0: out[nout] */
Prog *lower_plain_outputs(const Eqns *e); /* out 0: outputs without closed forms and actions, in their order */
Prog *lower_action_curve(const Eqns *e, uint32_t i); /* out 0: roots[4] of e->actions[i] */
Prog *lower_momenta(const Eqns *e); /* out 0: dL/dq'[nq] */
int output_is_plain(const Eqns *e, uint32_t i);
Prog *lower_closed_forms(const Eqns *e);   /* out 0: value of each closed form, from the state at the start */
IrParams lower_params(const Eqns *e, uint32_t *i); /* of Model.params from *i on, which moves behind them */
Prog *lower_start(const Eqns *e);   /* out 0, 1, 2: q, v, z; only components with a start value */

/* unit_new: the unit of these equations, without scenes; source: path of the file as the user gave it; libm as in
 * lower_accel. unit_add_scene adds the scene of e, which must come from the same file, with the same effects, inputs
 * and fixed parameters. */
ProgramSet *unit_new(const Eqns *e, const char *source, int libm);
/* The two parts of unit_new: names, flags and inputs, which unit_accepts_scenes compares; and the programs of
 * equations. */
ProgramSet *unit_head(const Eqns *e, const char *source, int libm);
void unit_add_programs(ProgramSet *u, const Eqns *e);
int unit_accepts_scenes(const ProgramSet *a, const ProgramSet *b); /* whether scenes of b may be added to a */
void unit_add_scene(ProgramSet *u, const Eqns *e);

/* Makes the programs of the WANT_... bits that are still missing. */
void unit_require(ProgramSet *u, Eqns *e, unsigned wants);
