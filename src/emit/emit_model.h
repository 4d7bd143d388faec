/* IrUnit -> C for the runtime: functions and tables as lag_model.h wants them. */
#ifndef LAGC_EMIT_MODEL_H
#define LAGC_EMIT_MODEL_H

#include "base/strbuf.h"
#include "ir/unit.h"

/* The name of the lag_model for a model that the user called `name`: an identifier that neither
 * <math.h> nor the emitted file has already. */
const char *model_id(Arena *a, const char *name);

/* One file: a lag_model called NAME (a C identifier), and a lag_scene NAME_scene for each scene. */
void emit_model(const IrUnit *u, const char *name, StrBuf *out);

/* The one function that computes the accelerations. */
void emit_accel(const IrUnit *u, StrBuf *out);

/* The file that joins the scenes of several units into a lag_program and, with main set, makes it
 * a simulator. names[i] is the name given to units[i] above. gsl: link the gsl-* methods in. */
void emit_program(const IrUnit *const *units, const char *const *names, uint32_t n, int gsl, StrBuf *out);

#endif
