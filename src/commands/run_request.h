/* Requests of run --observe, plot and animate, turned into outputs of the scene and arguments of its simulator.
 *
 * In: the options and the parsed file. Expressions are parsed here; model_build resolves them like any output of a
 * scene, so mistakes in them are reported with their text and a caret. */
#ifndef LAGC_COMMANDS_RUN_REQUEST_H
#define LAGC_COMMANDS_RUN_REQUEST_H

#include "commands/options.h"
#include "model/model.h"

typedef struct {
  VEC(CommandOutput) asked;
  Section section;  /* Poincare section that chooses the rows; or none */
  Name scene;       /* scene of the run; NULL: the first */
  VEC(char *) argv; /* the simulator's, NULL-terminated */
  const char *note; /* points that were chosen for the user, or NULL */
} RunRequest;

/* Returns 0 on a mistake, which *error or ast->diags describes. */
int run_request_prepare(RunRequest *p, Ast *ast, const Options *o, const char **error);

#endif
