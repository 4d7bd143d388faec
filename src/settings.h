/* Values with units at the command line of run, plot and animate: a simulator takes plain numbers in declared
 * units, so what is more than a number is converted before it is called. */
#ifndef LAGC_SETTINGS_H
#define LAGC_SETTINGS_H

#include "cli/options.h"
#include "model/model.h"

/* Puts numbers in place of what o->rest gives with a unit (`th=90[deg]`, `--until 2[min]`) or as a formula
 * (`th=pi/3`). 0 on a mistake, reported in ast->diags. */
int settings_convert(Options *o, Ast *ast);

#endif
