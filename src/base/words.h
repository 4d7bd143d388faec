/* Lists of words, in one string and separated by spaces. */
#ifndef LAGC_WORDS_H
#define LAGC_WORDS_H

#include "base/arena.h"

/* Whether `word`, of n bytes or up to its NUL, is one of `words`. */
int has_word_n(const char *words, const char *word, size_t n);
int has_word(const char *words, const char *word);

/* Word i of `words`, or NULL. */
const char *word_at(Arena *a, const char *words, size_t i);

/* Ending of a noun after the number n. */
static inline const char *plural(unsigned long n) { return n == 1 ? "" : "s"; }

#endif
