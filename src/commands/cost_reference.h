/* The reference motion of `lagc cost`. */
#pragma once

#include "commands/simulator.h"

/* A reference on its way: a process that builds a simulator with more digits and runs it. */
typedef struct {
  FILE *out;  /* what it prints */
  long process;
} CostReference;

/* Begins the computation beside the caller's own work, for at most `seconds` of the run's processor time. NULL in
 * r->out: this machine has no more digits, or the user gave a reference with --against. */
void cost_reference_begin(Compiler *c, double seconds, CostReference *r);

/* Waits for it, but no longer than `seconds`. Returns 1 with the reference as standard input of this process; 0
 * where there is none, or none in time. */
int cost_reference_end(CostReference *r, double seconds);
