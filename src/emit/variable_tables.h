/* Tables of variables (names, units, factors) in emitted C. Runs of numbered names (u[1], u[2], ...) are written by
 * macros, so that the text does not grow with the length of families. */
#ifndef LAGC_EMIT_VARIABLE_TABLES_H
#define LAGC_EMIT_VARIABLE_TABLES_H

#include "ir/unit.h"

/* Whether the table is written with macros; if so, table_macros must precede it. */
int table_needs_macros(const IrVar *v, uint32_t n);

void table_macros(StrBuf *out);

/* `static const lag_var NAME[] = {...};`, or nothing for an empty table. */
void table_vars(const char *name, const IrVar *v, uint32_t n, Arena *a, StrBuf *out);

/* Number of a table in the model's precision: digits (or NULL) if longer than the double's text; integers stay plain. */
const char *table_number(Arena *a, double x, const char *digits);

#endif
