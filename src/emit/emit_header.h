/* IrUnit -> one self-contained C99/C++ header for programs that embed the model. */
#ifndef LAGC_EMIT_HEADER_H
#define LAGC_EMIT_HEADER_H

#include "base/strbuf.h"
#include "ir/unit.h"

/* The header of the unit's first scene. equations: text for the comment at its head, or NULL.
 * name: as the header is called, pend for pend.h; the prefix of all its names, in upper and lower
 * case. */
void emit_header(const IrUnit *u, const char *name, const char *equations, StrBuf *out);

#endif
