/* Words: the edit distance of two, and whether a text has one. */
#pragma once

#include <ctype.h>
#include <stddef.h>

enum { LAG_LONGEST_WORD = 63 };

/* Twice the number of edits (insert, delete, replace, swap of neighbours) from a[na] to b[nb], bytes, at most
 * LAG_LONGEST_WORD of them: optimal string alignment. A letter that changes its case only costs `other_case`. */
static inline int lag_edit_distance(const char *a, size_t na, const char *b, size_t nb, int other_case) {
  int d[3][LAG_LONGEST_WORD + 1];
  for (size_t j = 0; j <= nb; j++) d[0][j] = 2 * (int)j;
  for (size_t i = 1; i <= na; i++) {
    int *row = d[i % 3], *up = d[(i + 2) % 3], *up2 = d[(i + 1) % 3];
    row[0] = 2 * (int)i;
    for (size_t j = 1; j <= nb; j++) {
      int x = (unsigned char)a[i - 1], y = (unsigned char)b[j - 1];
      int replaced = up[j - 1] + (x == y ? 0 : tolower(x) == tolower(y) ? other_case : 2);
      int added = (up[j] < row[j - 1] ? up[j] : row[j - 1]) + 2;
      row[j] = replaced < added ? replaced : added;
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && up2[j - 2] + 2 < row[j])
        row[j] = up2[j - 2] + 2;
    }
  }
  return d[na % 3][nb];
}

/* Whether the text has the word, or the words that - or _ join, in letters of any case: "leapfrog",
 * "semi_implicit_euler" in "semi-implicit Euler". */
static inline int lag_text_has_word(const char *text, const char *word) {
  enum { SHORTEST = 4 };
  size_t n = 0;
  for (const char *s = text; *s; s++) {
    if (s > text && isalnum((unsigned char)s[-1])) continue;
    for (n = 0;
         word[n] && (isalnum((unsigned char)word[n]) ? tolower((unsigned char)s[n]) == tolower((unsigned char)word[n])
                                                     : s[n] == ' ' || s[n] == '-');
         n++)
      continue;
    if (!word[n] && n >= SHORTEST && !isalnum((unsigned char)s[n])) return 1;
  }
  return 0;
}
