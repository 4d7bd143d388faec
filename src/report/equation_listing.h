/* The equations of motion for people: text and LaTeX, in the user's names. */
#pragma once

#include "mech/eqns.h"
#include "sym/print.h"

/* Appends L, momenta, M q'' = f row by row, energy, the definitions used, facts about the model, and `cost`, a line
 * on the cost of the accelerations. */
void show_equations(const Eqns *e, const char *cost, PrintStyle style, StrBuf *out);

/* Appends the Hamiltonian side: momenta, H, Hamilton's equations; M and the energy where M is not inverted in closed
 * form. */
void show_hamiltonian(Eqns *e, PrintStyle style, StrBuf *out);

/* Appends `name = value`, a Poisson bracket. */
void show_bracket(const Eqns *e, const char *name, Expr value, PrintStyle style, StrBuf *out);

/* canonical_listing.c: appends the inverse of a canonical transformation, the new Hamiltonian and Hamilton's
 * equations. 0, reported: the inverse is not found. */
int show_canonical(Eqns *e, const Canonical *c, PrintStyle style, StrBuf *out);

/* Appends momenta and the Lagrangian of a model that gives its Hamiltonian, or where the momenta follow from
 * velocities. */
void show_lagrangian(Eqns *e, PrintStyle style, StrBuf *out);

/* Appends M, f, Q and the energy as they are computed, one entry a line, for --dump=eqns. */
void dump_equations(const Eqns *e, StrBuf *out);

/* Appends one line: coordinates, mass matrix, energy. Nothing when there are only states. */
void show_facts(const Eqns *e, StrBuf *out);
