/* Every compilation verifies itself (translation validation: A. Pnueli, M. Siegel and E. Singerman, TACAS 1998,
 * doi:10.1007/BFb0054170).
 *
 * At random states, near the scene's start and far from it, the text's Lagrangian is evaluated by jets straight from
 * the Ast. With the accelerations of the final programs, the residual of each equation of motion,
 *   d/dt dL/dq' - dL/dq - Q - A^T lambda,
 * must be 0 up to rounding; and flows, energy, momenta, constraints, events, their actions, inputs and outputs must
 * agree.
 *
 * Virtual displacements replace derivatives by coordinates: with dL_k the change of L along q + e eta_k, eta_1 = c
 * and eta_2 = s c,
 *   (d/dt dL/dq' - dL/dq).c = d(dL_2)/ds - 2 dL_1   at s = 0. */
#pragma once

#include "ir/program_set.h"
#include "mech/eqns.h"

/* Statistics of a comparison, for `lagc check --verbose`. */
typedef struct {
  uint32_t states;      /* states with a decision */
  uint32_t far;         /* those of them far from the start */
  uint32_t directions;  /* virtual displacements at each state */
  uint32_t values;      /* values compared, in all */
  const char *unsupported; /* construct in the equations that is not evaluated here; NULL: none */
  const char *outputs;   /* names of outputs not compared, with commas; NULL: none */
} SelfCheck;

/* Compares the programs of u (hoisted or not) and of its scene number `scene`, whose equations are e, with the text.
 * 1: no disagreement; 0: an internal error in e->m->diags states the first one, with state and both values: write no
 * output. */
int self_check(const Eqns *e, const ProgramSet *u, uint32_t scene, SelfCheck *statistics);

/* 0: the equations have many coordinates and a text that is too long to be compared, or not evaluated here. */
int self_check_ends(const Eqns *e, SelfCheck *statistics);

/* Appends the statistics, in a sentence or two. */
void self_check_print(const Eqns *e, const SelfCheck *statistics, StrBuf *out);

/* nonfinite.c: finds the expression of the text without a finite value that ended a run, or was missed in it.
 * number[n] is t, q, v, z, p of a state, in the order of the scene's simulator, and behind them whether the run
 * ended there. Searches from there along the motion, for 1 + |t| seconds, for the first expression whose value or
 * derivatives are not finite, and adds a note to the model's diags. 0: none was found, or n does not fit the model.
 * */
int nonfinite_note(const Eqns *e, const ProgramSet *u, const double *number, uint32_t n);
