/* Shared by the files of --modes. x[nq + nz]: coordinates, then states, in SI. */
#ifndef LAG_APP_MODES_H
#define LAG_APP_MODES_H

#include "analysis/modes.h"
#include "app/app.h"

/* Description of coordinate or state i of x. */
const lag_var *lag_modes_variable(const lag_model *m, int i);

/* x := the coordinates and states at the equilibrium. */
void lag_modes_unknowns(const Equilibrium *r, double *x);

/* A caution about the result; NULL: none. */
const char *lag_modes_caution(const App *app, const Equilibrium *r);

/* text[n] := the reason of the verdict on stability. */
void lag_modes_reason(const Modes *s, char *text, size_t n);

/* Prints the table of modes. x[nq + nz] is scratch. */
void lag_modes_text(FILE *f, const App *app, const Equilibrium *r, const Modes *s, double *x);

#endif
