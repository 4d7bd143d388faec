/* Optimal string alignment distance, on bytes, for names of at most 63 bytes. */
#include "base/suggest.h"

#include <ctype.h>
#include <stdint.h>
#include <string.h>

enum { LONGEST = 63 };

static uint32_t min3(uint32_t a, uint32_t b, uint32_t c) {
  uint32_t m = a < b ? a : b;
  return m < c ? m : c;
}

/* Twice the number of edits; a change of letter case alone counts half an edit. */
static uint32_t distance(const char *a, size_t na, const char *b, size_t nb) {
  uint32_t d[3][LONGEST + 1];
  for (size_t j = 0; j <= nb; j++) d[0][j] = (uint32_t)(2 * j);
  for (size_t i = 1; i <= na; i++) {
    uint32_t *row = d[i % 3], *up = d[(i + 2) % 3], *up2 = d[(i + 1) % 3];
    row[0] = (uint32_t)(2 * i);
    for (size_t j = 1; j <= nb; j++) {
      int x = (unsigned char)a[i - 1], y = (unsigned char)b[j - 1];
      uint32_t change = x == y ? 0 : tolower(x) == tolower(y) ? 1 : 2;
      row[j] = min3(up[j] + 2, row[j - 1] + 2, up[j - 1] + change);
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1] && up2[j - 2] + 2 < row[j])
        row[j] = up2[j - 2] + 2;
    }
  }
  return d[na % 3][nb];
}

Name suggest(const char *wrong, const Name *candidates, size_t n) {
  size_t len = strlen(wrong);
  if (len > LONGEST) return NULL;
  /* one letter for another is a guess, not a typing mistake: only its case may differ */
  uint32_t best = len == 1 ? 2 : (uint32_t)(len < 3 ? 2 : 2 * (len / 3)) + 1;
  Name found = NULL;
  for (size_t i = 0; i < n; i++) {
    size_t other = strlen(candidates[i]);
    if (other > LONGEST || strcmp(wrong, candidates[i]) == 0) continue;
    uint32_t d = distance(wrong, len, candidates[i], other);
    if (d < best) {
      best = d;
      found = candidates[i];
    }
  }
  return found;
}
