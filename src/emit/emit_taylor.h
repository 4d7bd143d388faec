/* Series -> the C functions of a model's Taylor coefficients, as lag_taylor in lag_model.h wants them. */
#ifndef LAGC_EMIT_TAYLOR_H
#define LAGC_EMIT_TAYLOR_H

#include "base/strbuf.h"
#include "ir/series.h"

/* Functions and the const lag_taylor called `taylor`. globals: names that functions must not hide, NULL at the end. */
void emit_taylor(const Series *s, const char *const *globals, const char *math, StrBuf *out);

#endif
