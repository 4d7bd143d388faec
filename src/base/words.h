/* Lists of words, in one string and separated by spaces; and the known word nearest to a mistyped one. */
#pragma once

#include "base/intern.h"

/* Whether `word` is one of `words`. */
int has_word(const char *words, const char *word);

/* Word i of `words`, or NULL. */
const char *word_at(Arena *a, const char *words, size_t i);

static inline int is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/* Ending of a noun after the number n. */
static inline const char *plural(unsigned long n) { return n == 1 ? "" : "s"; }

/* The candidate closest to `wrong` in edit distance (insert, delete, replace, swap neighbours), or NULL when none is
 * close: at most a third of the length, at least one edit. For "did you mean". */
Name suggest(const char *wrong, const Name *candidates, size_t n);
