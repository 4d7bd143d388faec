/* The elementary functions that emitted files bring along: sections of lag_math.h; and the solver of lag_kkt.h. */
#ifndef LAGC_CMATH_H
#define LAGC_CMATH_H

#include "base/strbuf.h"
#include "ir/unit.h"

/* What vectors of lanes (PREFIX_LANES) mean: type of masks, choices, functions lane by lane. Goes before all that has a default. */
void cmath_lanes(const char *prefix, const char *lower, StrBuf *out);

/* The functions that the unit calls and that are not left to the C library: lower_sincos, lower_sin, lower_cos, and exp and log
 * over lanes. Goes after PREFIX_FN and PREFIX_C. */
void cmath_functions(const IrUnit *u, const char *prefix, const char *lower, StrBuf *out);

/* `static LAG_MASK lower_kkt(n, m, w)`, where the model has constraints. */
void cmath_kkt(const IrUnit *u, const char *prefix, const char *lower, StrBuf *out);

/* "lag" where emitted code of the unit calls lag_sincos instead of sin and cos; NULL where not. */
const char *cmath_prefix(const IrUnit *u, const char *lower);

/* Whose functions the unit calls, as a sentence for its head. */
const char *cmath_text(const IrUnit *u);

#endif
