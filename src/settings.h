/* What the command line gives to names. -D CONST=VALUE; and what `name=value` behind run, plot and animate says that a simulator, which takes plain numbers in declared units,
 * cannot: inputs with a formula or a table, and starts of rotations, are compiled in, values with units and formulas of numbers become numbers. */
#ifndef LAGC_SETTINGS_H
#define LAGC_SETTINGS_H

#include "cli/options.h"
#include "model/model.h"

/* Parses the values of constants. 0 on a mistake, which is in ast->diags. */
int settings_defines(Ast *ast, Define *defines, uint32_t n);

typedef VEC(Given) GivenList;

/* Takes inputs with a formula or a table, and how rotations start, out of o->rest. 0 on a mistake: *error says what it is, or it is in ast->diags. */
int settings_compiled(Ast *ast, Options *o, GivenList *given, const char **error);

/* Puts numbers in place of what has a unit (`th=90[deg]`, `--until 2[min]`) or is a formula (`th=pi/3`). 0 on a mistake, which
 * is in ast->diags. */
int settings_units(Ast *ast, const Options *o);

#endif
