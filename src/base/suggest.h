/* The known word nearest to a mistyped one, for "did you mean"; membership in a list of words. */
#ifndef LAGC_SUGGEST_H
#define LAGC_SUGGEST_H

#include "base/intern.h"

/* The candidate closest to `wrong` in edit distance (insert, delete, replace, swap neighbours),
 * or NULL when none is close: at most a third of the length, at least one edit. */
Name suggest(const char *wrong, const Name *candidates, size_t n);

/* Whether `word` is one of `words`, which are separated by spaces. */
int has_word(const char *words, const char *word);

#endif
