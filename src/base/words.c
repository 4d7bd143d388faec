/* Words: lists in one string, separated by spaces; the nearest of several names, of at most 63 bytes each. */
#include "base/words.h"

#include <string.h>

#include "numeric/edit_distance.h"

int has_word(const char *words, const char *word) {
  size_t n = strlen(word);
  for (const char *s = words; n && (s = strstr(s, word)) != NULL; s += n)
    if ((s == words || s[-1] == ' ') && (s[n] == ' ' || !s[n])) return !strchr(word, ' ');
  return 0;
}

const char *word_at(Arena *a, const char *words, size_t i) {
  words += strspn(words, " ");
  for (; i && *words; i--) {
    words += strcspn(words, " ");
    words += strspn(words, " ");
  }
  return *words ? arena_strndup(a, words, strcspn(words, " ")) : NULL;
}

Name suggest(const char *wrong, const Name *candidates, size_t n) {
  size_t len = strlen(wrong);
  if (len > LAG_LONGEST_WORD) return NULL;
  /* one letter for another is a guess, not a typing mistake: only its case may differ */
  int best = len == 1 ? 2 : (len < 3 ? 2 : 2 * ((int)len / 3)) + 1;
  Name found = NULL;
  for (size_t i = 0; i < n; i++) {
    size_t other = strlen(candidates[i]);
    if (other > LAG_LONGEST_WORD || strcmp(wrong, candidates[i]) == 0) continue;
    int d = lag_edit_distance(wrong, len, candidates[i], other, 1);
    if (d < best) {
      best = d;
      found = candidates[i];
    }
  }
  return found;
}
