/* The known word nearest to a mistyped one, for "did you mean". */
#ifndef LAGC_SUGGEST_H
#define LAGC_SUGGEST_H

#include "base/intern.h"

/* The candidate closest to `wrong` in edit distance (insert, delete, replace, swap neighbours),
 * or NULL when none is close: at most a third of the length, at least one edit. */
Name suggest(const char *wrong, const Name *candidates, size_t n);

#endif
