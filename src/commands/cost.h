/* `lagc cost`: the reference that errors are measured against. */
#ifndef LAGC_COMMANDS_COST_H
#define LAGC_COMMANDS_COST_H

#include "commands/simulator.h"

/* Runs a simulator in quadruple precision, where there is one, and gives its solution to the simulator that follows on its standard input. */
void cost_give_reference(Compiler *c, const Units *units);

#endif
