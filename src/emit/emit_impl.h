/* Parts of the emitted model file that emit_model.c puts together: Taylor recurrences (emit_taylor.c), tables of variables (variable_tables.c). */
#pragma once

#include "emit/cfunction.h"
#include "ir/unit.h"

/* Series -> the functions that compute a model's Taylor coefficients, and the const lag_taylor called `taylor`. globals, math: as in CStyle. */
void emit_taylor(const Series *s, const char *const *globals, const char *math, StrBuf *out);

/* Whether a table of variables (names, units, factors) is written with macros, as runs of numbered names (u[1], u[2], ...) are, so that the
 * text does not grow with the length of families; if so, table_macros must precede it. */
int table_needs_macros(const IrVar *v, uint32_t n);
void table_macros(StrBuf *out);

/* `static const lag_var NAME[] = {...};`, or nothing for an empty table. */
void table_vars(const char *name, const IrVar *v, uint32_t n, Arena *a, StrBuf *out);

/* Number of a table in the model's precision: digits (or NULL) if longer than the double's text; integers stay plain. */
const char *table_number(Arena *a, double x, const char *digits);
