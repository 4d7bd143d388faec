/* What the files of --modes share. Everywhere x[nq + nz] are coordinates, then states, in SI. */
#ifndef LAG_APP_MODES_H
#define LAG_APP_MODES_H

#include "analysis/modes.h"
#include "app/app.h"

/* Coordinate, or state, i. */
const lag_var *modes_variable(const lag_model *m, int i);

/* x[nq + nz]: the state at rest without its velocities. */
void modes_unknowns(const Rest *r, double *x);

/* What makes the result less than it seems; NULL: nothing does. */
const char *modes_caution(const App *app, const Rest *r);

/* Why the verdict is what it is. */
void modes_reason(const Modes *s, char *text, size_t n);

/* The table for people. x[nq + nz] is scratch. */
void modes_text(FILE *f, const App *app, const Rest *r, const Modes *s, double *x);

#endif
