/* IrUnit -> one self-contained C99/C++ header for programs that embed the model. */
#ifndef LAGC_EMIT_HEADER_H
#define LAGC_EMIT_HEADER_H

#include "base/strbuf.h"
#include "ir/unit.h"

/* Appends the header of the unit's first scene. Its names begin with `name`, turned into an identifier, in upper
 * or lower case. equations: text for the head comment, or NULL. */
void emit_header(const IrUnit *u, const char *name, const char *equations, StrBuf *out);

#endif
