/* Shared by the files of --modes. x[nq + nz]: coordinates, then states, in SI. */
#ifndef LAG_APP_MODES_H
#define LAG_APP_MODES_H

#include "analysis/modes.h"
#include "app/app.h"

/* Description of coordinate or state i of x. */
const lag_var *modes_variable(const lag_model *m, int i);

/* x := the coordinates and states at the equilibrium. */
void modes_unknowns(const Rest *r, double *x);

/* A caution about the result; NULL: none. */
const char *modes_caution(const App *app, const Rest *r);

/* text[n] := the reason of the verdict on stability. */
void modes_reason(const Modes *s, char *text, size_t n);

/* Prints the table of modes. x[nq + nz] is scratch. */
void modes_text(FILE *f, const App *app, const Rest *r, const Modes *s, double *x);

#endif
