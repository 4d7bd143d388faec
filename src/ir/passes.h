/* The passes over a program: their order, the listing of --dump=passes, and a verification after each. */
#pragma once

#include "ir/prog.h"

/* Facts that decide which passes a program goes through. */
typedef struct {
  uint32_t nests_from; /* instructions from which sums over pairs become nests; 0: never */
  /* called at every step: common factors, subproducts and the order of instructions are worth their time */
  int every_step;
  /* with every_step: each store needs values of its own, and a long program is scheduled store by store */
  int uncoupled;
  double times;        /* as in ProgramSet; 0: 1 */
  int libm;            /* with every_step: sin and cos are calls, and are scheduled first */
} PassPlan;

/* The program after its passes; p itself is released. A program that a pass leaves malformed is returned with its
 * fault, which prog_verify reports. trace: gets each pass with the program after it; or NULL. */
Prog *passes_run(Prog *p, const PassPlan *plan, StrBuf *trace);
