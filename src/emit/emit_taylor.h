/* Series -> the C functions that compute a model's Taylor coefficients (lag_taylor of lag_model.h). */
#ifndef LAGC_EMIT_TAYLOR_H
#define LAGC_EMIT_TAYLOR_H

#include "base/strbuf.h"
#include "ir/unit.h"

/* Appends the functions and the const lag_taylor called `taylor`. globals: names that functions must not hide, NULL at the end;
 * math: as in CStyle. */
void emit_taylor(const Series *s, const char *const *globals, const char *math, StrBuf *out);

#endif
