/* The commands of lagc, one a file. Each returns an exit status; those that compile find the model in c->ast. */
#ifndef LAGC_COMMANDS_COMMANDS_H
#define LAGC_COMMANDS_COMMANDS_H

#include "commands/compiler.h"

int command_check(Compiler *c);
int command_derive(Compiler *c);
int command_noether(Compiler *c);
int command_emit(Compiler *c);
int command_header(Compiler *c);
int command_build(Compiler *c);
int command_run(Compiler *c); /* run, plot, animate, modes, lyapunov, cost */
int command_effects(Compiler *c);

/* These read no model. */
int command_help(Compiler *c);
int command_methods(Compiler *c);
int command_completion(Compiler *c);
int command_cache(Compiler *c);

#endif
