/* Known runs: a command that lagc has carried out before starts its simulator without parsing and deriving.
 *
 * An entry of the cache, named by a hash of the model's text, the words of the command line, lagc's own build, runtime
 * and compiler, has the simulator, its arguments, the other files that were read, and what was printed; beside it,
 * where lag-run evaluates them, the programs as bytes. Words
 * name=NUMBER that went to the simulator as they stood are no part of the name: a run with other numbers is known. */
#pragma once

#include "commands/simulator.h"

/* Starts the simulator of a known run, in this process. *known := 1, and a STATUS is returned, if that failed. */
int known_run_start(Compiler *c, int *known);

/* Begins the simulator at `path` with c->picture.argv: messages, the listener for its last state, exec. With an entry
 * in the cache for the next time. Returns a STATUS, if that failed. */
int known_run_keep_and_start(Compiler *c, const char *path);

/* The same with lag-run, which evaluates the units (simulator_evaluate). */
int known_run_evaluate(Compiler *c, const EvaluatedRun *by, const Units *units);
