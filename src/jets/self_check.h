/* Every compilation verifies itself (translation validation: A. Pnueli, M. Siegel and E. Singerman, TACAS 1998, doi:10.1007/BFb0054170).
 *
 * At random states, near the scene's start and far, the text's Lagrangian is evaluated straight from the Ast by jets, and with the accelerations
 * that the final programs compute the residual of each equation of motion,
 *   d/dt dL/dq' - dL/dq - Q - A^T lambda,
 * must be 0; so must differences between text and program of flows, energy, momenta, constraints, events, their actions, inputs and outputs.
 *
 * Virtual displacements take the place of derivatives by coordinates: with dL_k the change of L along q + e eta_k, eta_1 = c and eta_2 = s c,
 *   (d/dt dL/dq' - dL/dq).c = d(dL_2)/ds - 2 dL_1   at s = 0. */
#ifndef LAGC_SELF_CHECK_H
#define LAGC_SELF_CHECK_H

#include "ir/unit.h"
#include "mech/eqns.h"

/* Report of what was compared, and what was not, for `lagc check --verbose`. */
typedef struct {
  uint32_t states;      /* at which something was decided, */
  uint32_t far;         /* of them, far from the start */
  uint32_t directions;  /* virtual displacements at each */
  uint32_t values;      /* compared in all */
  const char *not_known; /* what the text has that is not evaluated here; NULL: nothing */
  const char *outputs;   /* those that are not compared, with commas; NULL: all are */
} SelfCheck;

/* Compares the programs of u, hoisted or not, and those of one of its scenes, whose equations are e, with the text. 1: they agree; 0: an internal error in e->m->diags tells the first that
 * does not, with the state and both values, and nothing may be written. */
int self_check(const Eqns *e, const IrUnit *u, uint32_t scene, SelfCheck *told);

/* Appends what was compared, in a sentence or two. */
void self_check_print(const Eqns *e, const SelfCheck *told, StrBuf *out);

#endif
