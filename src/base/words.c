/* Looks words up in a list that is one string, separated by spaces. */
#include "base/words.h"

#include <string.h>

int has_word_n(const char *words, const char *word, size_t n) {
  for (const char *s = words; *s; s += strspn(s, " ")) {
    size_t len = strcspn(s, " ");
    if (len == n && strncmp(s, word, n) == 0) return 1;
    s += len;
  }
  return 0;
}

int has_word(const char *words, const char *word) { return has_word_n(words, word, strlen(word)); }

const char *word_at(Arena *a, const char *words, size_t i) {
  words += strspn(words, " ");
  for (; i && *words; i--) {
    words += strcspn(words, " ");
    words += strspn(words, " ");
  }
  return *words ? arena_strndup(a, words, strcspn(words, " ")) : NULL;
}
