/* IrUnit -> C for the runtime: the functions and tables of lag_model.h. */
#ifndef LAGC_EMIT_MODEL_H
#define LAGC_EMIT_MODEL_H

#include "base/strbuf.h"
#include "ir/unit.h"

/* Identifier of the lag_model for a model that the user called `name`; free in <math.h> and in the emitted file. */
const char *model_id(Arena *a, const char *name);

/* Appends one file: a lag_model called NAME (a C identifier), and a lag_scene NAME_scene for each scene. */
void emit_model(const IrUnit *u, const char *name, StrBuf *out);

/* Appends only the function that computes the accelerations. */
void emit_accel(const IrUnit *u, StrBuf *out);

/* Appends the main file of a simulator: a lag_program of the scenes of n units, and main(). names[i]: the name of
 * units[i] in emit_model. gsl: link the gsl-* methods in. */
void emit_program(const IrUnit *const *units, const char *const *names, uint32_t n, int gsl, StrBuf *out);

#endif
