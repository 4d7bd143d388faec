/* `lagc cost --budget`. */
#pragma once

#include "commands/compiler.h"

/* Prints the cheapest combination. Returns a STATUS; STATUS_RUN: no combination keeps the budget. */
int cost_budget(Compiler *c);
