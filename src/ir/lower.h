/* Eqns -> Prog: the only reader of mech/eqns.h here.
 *
 * Each function below makes the program of one emitted function. Output arrays are numbered in the
 * order of that function's declaration in lag_model.h. */
#ifndef LAGC_LOWER_H
#define LAGC_LOWER_H

#include "ir/prog.h"
#include "ir/series.h"
#include "ir/series.h"
#include "ir/unit.h"
#include "mech/eqns.h"
#include "mech/switching_surfaces.h"
#include "mech/variation.h"

Prog *lower_accel(const Eqns *e, int libm); /* out 0: a[nq], out 1: zd[nz]; libm: functions are called, not in the text */
IrSystem lower_system(const Eqns *e); /* M, f and the rates of the states, with the formulas of inputs put in */
IrSystem lower_system(const Eqns *e); /* the same before it is solved, and solved, with the formulas of inputs put in */
Prog *lower_energy(const Eqns *e);  /* out 0: e[2] */
Prog *lower_charges(const Eqns *e); /* out 0: value and scale of each charge but the energy */
Prog *lower_powers(const Eqns *e);  /* out 0: by what each charge changes, the energy first; NULL: all are conserved */
Prog *lower_variation(const Eqns *e, const Variation *x); /* out 0, 1, 2: dL/dq[nq], dL/dq'[nq], Q[nq] */
Prog *lower_second(const Eqns *e, const Variation *x);    /* out 0: h[number of entries] */
Prog *lower_events(const Eqns *e);  /* out 0: g[nev] */
Prog *lower_switches(const Eqns *e, SwitchingSurfaces all); /* out 0: one for each */
Prog *lower_action(const Eqns *e, uint32_t event); /* out 0, 1, 2: q1, v1, z1; only what is set */
Prog *lower_inputs(const Eqns *e);  /* out 0: u[nu] */
Prog *lower_linear(const Eqns *e, Partials dr); /* out 0: dr, in the order of the entries, out 1: M, likewise; reads q'' */
Prog *lower_jumps(const Eqns *e, Jumps jumps); /* out 0: in the order of the entries */
/* Of a model with constraints (lower_constraints.c): out 0, 1: c, r; out 0, 1: A and M, the entries that are not zero; out 0, 1: the least
 * change d[nq] of the state with A d = g for the first nrows constraints, and the forces that make it. */
Prog *lower_residuals(const Eqns *e);
Prog *lower_matrices(const Eqns *e);
Prog *lower_change(const Eqns *e, uint32_t nrows);
Prog *lower_multipliers(const Eqns *e); /* out 0: lambda of each constraint, in the order of e->constraints */
Prog *lower_impact(const Eqns *e, const Contact *c); /* out 1: v1, after the impact */
Prog *lower_outputs(const Eqns *e); /* out 0: out[nout] */
Prog *lower_plain_outputs(const Eqns *e); /* likewise, of those without closed forms */
int output_is_plain(const Eqns *e, uint32_t i);
Prog *lower_exact(const Eqns *e);   /* out 0: one for each closed form, of the state at the start */
Prog *lower_param(const Eqns *e, uint32_t i); /* out 0: p[i], of earlier parameters */
Prog *lower_start(const Eqns *e);   /* out 0, 1, 2: q, v, z; only what a start gives */

/* The unit of these equations without scenes, and a scene added to it: e must come from the same
 * file with the same effects in use, the same inputs and the same numbers in place of parameters. source: the file's path as the user gave it; libm: sin and cos
 * are the C library's. */
IrUnit *unit_new(const Eqns *e, const char *source, int libm);
int unit_shares(const IrUnit *a, const IrUnit *b); /* whether scenes of b fit into a */
void unit_add_scene(IrUnit *u, const Eqns *e);

/* Adds the programs of WANT_... that are not there yet. */
void unit_want(IrUnit *u, Eqns *e, unsigned wants);

#endif
