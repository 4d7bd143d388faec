/* The reference of the language, grammar/LANGUAGE.md, as it was when lagc was built: chapters for `lagc help`.
 *
 * A chapter is what stands from a heading (## or ###) to the next. Below its heading a comment names the words that it
 * explains, the first of which names the chapter: <!-- help: scenes scene start span --> */
#ifndef LAGC_REFERENCE_H
#define LAGC_REFERENCE_H

#include "base/strbuf.h"
#include "base/vec.h"

typedef struct {
  const char *const *lines; /* the heading first */
  size_t n;
  const char *words; /* "scenes scene start span"; "" where there is no comment */
} Chapter;

typedef VEC(Chapter) Chapters;

void reference_chapters(Arena *a, Chapters *out);

/* The text of its heading. */
const char *chapter_title(Arena *a, const Chapter *c);

/* Word i of a text of words, or NULL. */
const char *word_at(Arena *a, const char *words, size_t i);

/* What a chapter says of a word: the rows of its tables that begin with it; of its own words also items of lists that
 * do, or, where there are none, all of it. 0 when it says nothing. */
int chapter_print(StrBuf *out, const Chapter *c, const char *word);

#endif
