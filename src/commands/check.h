/* The report of `lagc check`. */
#ifndef LAGC_COMMANDS_CHECK_H
#define LAGC_COMMANDS_CHECK_H

#include "commands/deriver.h"

/* Appends facts, every scene (or the one named), effects that no scene uses, inferred units, symmetries and expectations. Returns 0, with nothing
 * to print, when the model is wrong; the reasons, and refuted claims, are in the diags of the text. */
int check_print(const Deriver *d, Ast *ast, const char *scene, int allow_numeric, StrBuf *out);

#endif
