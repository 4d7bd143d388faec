/* Tables of names, units and values of emitted C. Runs of names that count up (u[1], u[2], ...) are written by macros,
 * so that the text does not grow with the length of families. */
#ifndef LAGC_CTABLE_H
#define LAGC_CTABLE_H

#include "ir/unit.h"

/* Whether the table is written with macros: then ctable_macros comes before it. */
int ctable_is_long(const IrVar *v, uint32_t n);

void ctable_macros(StrBuf *out);

/* `static const lag_var NAME[] = {...};`, or nothing for an empty table. */
void ctable_vars(const char *name, const IrVar *v, uint32_t n, Arena *a, StrBuf *out);

/* A number of a table in the precision of the model: `digits` (NULL: none) where they are more than a double's, integers as they are. */
const char *ctable_number(Arena *a, double x, const char *digits);

#endif
