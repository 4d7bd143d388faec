/* The parts of Lagrange's equations: momenta, mass matrix, forces. */
#pragma once

#include "mech/eqns.h"

/* Fills e's momenta, forces, mass matrix and linear system. */
void lagrange_momenta_and_forces(Eqns *e);

/* Fills e->squares. Call last: nodes made here must not change the order of terms in what is printed. */
void lagrange_squares(Eqns *e);

/* Short forms of raw[n] if they take no more operations together, else raw: entries that are shorter one by one may
 * share less. */
const Expr *lagrange_short_forms(const Eqns *e, const Expr *raw, uint32_t n);

/* 0: the mass matrix is singular on the kernel of the constraints at every state tried, and m->diags says why. Sets
 * e->singular_mass. */
int lagrange_check_mass(Eqns *e);

/* Fills e->mass where the program does without it. */
void eqns_derive_mass(Eqns *e);

/* Q_i = sum over forces of f d(point)/dq_i, minus dR/dq_i', for n coordinates and velocities of these kinds. */
Expr *generalised_forces(const Model *m, SymKind q, SymKind v, uint32_t n);
