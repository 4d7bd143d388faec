/* What `lagc check` says. */
#ifndef LAGC_CHECK_H
#define LAGC_CHECK_H

#include "deriver.h"

/* Facts, every scene (or the one named), effects that no scene uses, units that were found, symmetries, expectations. 0: the model is wrong, and
 * nothing is worth printing; the reasons, and false claims, are in the diags of the text. */
int check_print(const Deriver *d, Ast *ast, const char *scene, int allow_numeric, StrBuf *out);

#endif
