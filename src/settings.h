/* What `name=value` behind run, plot and animate says that a simulator cannot: inputs with a formula or a table, which
 * are compiled in. All else is the simulator's. */
#ifndef LAGC_SETTINGS_H
#define LAGC_SETTINGS_H

#include "cli/options.h"
#include "model/model.h"

typedef VEC(Given) GivenList;

/* Takes those settings out of o->rest. 0 on a mistake: *error says what it is, or it is in ast->diags. */
int settings_take(Ast *ast, Options *o, GivenList *given, const char **error);

#endif
