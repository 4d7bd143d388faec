/* Values on the command line: -D CONST=VALUE, and `name=value` of run, plot and animate. A simulator takes plain numbers in declared units; so
 * inputs with a formula or a table, and starts of rotations, are compiled in, and values with units or formulas become numbers. */
#ifndef LAGC_COMMANDS_SETTINGS_H
#define LAGC_COMMANDS_SETTINGS_H

#include "commands/options.h"
#include "model/model.h"

/* Parses the values of constants. Returns 0 on a mistake, which is in ast->diags. */
int settings_defines(Ast *ast, Define *defines, uint32_t n);

/* A text on one line, without white space at its ends and with single spaces inside. */
const char *text_trimmed(Arena *a, const char *text, size_t n);

typedef VEC(CommandInput) GivenList;

/* Moves inputs with a formula or a table, and starts of rotations, from o->rest to *given. Returns 0 on a mistake: see *error, else ast->diags. */
int settings_compiled(Ast *ast, Options *o, GivenList *given, const char **error);

/* Replaces values with a unit (`th=90[deg]`, `--until 2[min]`) and formulas (`th=pi/3`) in o->rest by numbers. Returns 0 on a mistake, which is
 * in ast->diags. */
int settings_units(Ast *ast, const Options *o);

#endif
