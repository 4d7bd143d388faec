/* Search of `lagc help WORDS` over commands, options, the reference, the tutorial, README and the page on Python,
 * with synonyms. */
#pragma once

#include "base/strbuf.h"

/* Appends the passages that answer the words, the best first. Returns 0 when there are none. */
int help_search(StrBuf *out, const char *words);

/* The way to do what a word from elsewhere means, as a sentence: "jacobian", "fit"; NULL. */
const char *help_way(Arena *a, const char *word);
