/* IrUnit -> C: for the runtime, the functions and tables of lag_model.h; or one self-contained C99/C++ header for programs that embed the model. */
#pragma once

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

/* emit_header.c: appends the header of the unit's first scene. Its names begin with `name`, turned into an identifier, in upper
 * or lower case. equations: text for the head comment, or NULL. */
void emit_header(const IrUnit *u, const char *name, const char *equations, StrBuf *out);
