/* The equations of motion for people: text and LaTeX, in the user's names. */
#ifndef LAGC_EMIT_TEXT_H
#define LAGC_EMIT_TEXT_H

#include "ir/unit.h"
#include "mech/eqns.h"
#include "sym/print.h"

/* Appends coordinates, L, momenta, M q'' = f row by row, energy, and the operation count. */
void emit_text(const Eqns *e, const IrUnit *u, PrintStyle style, StrBuf *out);

#endif
