/* Elementary functions and the KKT solver embedded in emitted files: sections of runtime/include/lag_math.h and lag_kkt.h. */
#ifndef LAGC_EMIT_EMBEDDED_MATH_H
#define LAGC_EMIT_EMBEDDED_MATH_H

#include "base/strbuf.h"
#include "ir/unit.h"

/* Vector lanes (PREFIX_LANES): mask type, selection, functions lane by lane. Must precede everything that has a default. */
void math_lanes(const char *prefix, const char *lower, StrBuf *out);

/* Functions that the unit calls and that do not come from the C library: lower_sincos, lower_sin, lower_cos, and exp and log
 * over lanes. Must follow PREFIX_FN and PREFIX_C. */
void math_functions(const IrUnit *u, const char *prefix, const char *lower, StrBuf *out);

/* `static LAG_MASK lower_kkt(n, m, coarse, w)`, if the model has constraints. */
void math_kkt_solver(const IrUnit *u, const char *prefix, const char *lower, StrBuf *out);

/* Prefix of sincos, sin and cos in emitted code of the unit (`lower`); NULL: the C library's sin and cos. */
const char *math_prefix(const IrUnit *u, const char *lower);

/* Sentence for the head of the file: where its elementary functions come from. */
const char *math_source_text(const IrUnit *u);

#endif
