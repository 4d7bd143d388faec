/* What run --observe, plot and animate ask for: outputs of the scene, and arguments of its simulator.
 *
 * Needs the options and the parsed file. An expression is parsed here and given its meaning by model_build, like
 * any output of a scene; mistakes in it are reported with its text and a caret. */
#ifndef LAGC_PICTURE_H
#define LAGC_PICTURE_H

#include "cli/options.h"
#include "model/model.h"

typedef struct {
  VEC(Asked) asked;
  Section section;  /* where rows are put out; or none */
  Name scene;       /* that is run; NULL: the first */
  VEC(char *) argv; /* of the simulator, NULL-terminated */
  const char *note; /* what was chosen for the user, or NULL */
} Picture;

/* 0 on a mistake: *error says what it is, or it is in ast->diags. */
int picture_prepare(Picture *p, Ast *ast, const Options *o, const char **error);

#endif
